/** Which key does what. */

import type { Camera } from './camera';
import type { Compare } from './compare';
import type { Inspector } from './inspector';
import { character, place, type Key } from './keys';
import type { Look } from './look';
import type { Side } from './panel';
import type { Path } from './path';
import type { Pick } from './pick';
import { pictureKeys } from './picturekeys';
import type { PageMessage } from './protocol';
import type { Selection } from './selection';
import type { Toolbar } from './toolbar';
import type { View } from './view';

export interface Bound {
  view: View;
  camera: Camera;
  toolbar: Toolbar;
  look: Look;
  compare: Compare;
  inspector: Inspector;
  pick: Pick;
  selection: Selection;
  focus(): void;
  path: Path;
  /** Moves the camera, if it may be moved. */
  move(change: () => void): void;
  from(side: Side, opposite: boolean): void;
  fly(): void;
  send(message: PageMessage): boolean;
  help(): void;
}

/** CSS pixels of a drag that an arrow key stands for. */
const STEP = 20;

export function bindings({
  view,
  camera,
  toolbar,
  look,
  compare,
  inspector,
  pick,
  selection,
  path,
  focus,
  move,
  from,
  fly,
  send,
  help,
}: Bound): Key[] {
  const side = (code: string, shown: string, of: Side): Key => ({
    shown,
    doc: `from the ${of}; with Ctrl from the opposite side`,
    group: 'Camera',
    is: place(code),
    act: (e) => from(of, e.ctrlKey),
  });
  const history = (shown: string, type: 'undo' | 'redo', is: Key['is']): Key => ({
    shown,
    doc: type,
    group: 'Render',
    is,
    act: () => send({ type }),
  });
  const isZ = (event: KeyboardEvent) => (event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 'z';
  return [
    side('Numpad1', 'Numpad 1', 'front'),
    side('Numpad3', 'Numpad 3', 'right'),
    side('Numpad7', 'Numpad 7', 'top'),
    ...pictureKeys({ view, look, compare, panel: () => toolbar.press('panel'), help }),
    { shown: 'T', doc: 'draw the path of a sample of the pinned pixel', group: 'Picture', is: character('t'), act: () => path.toggle() },
    {
      shown: 'Arrows',
      doc: 'orbit; with Shift pan',
      group: 'Camera',
      is: place('ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'),
      act: ({ code, shiftKey }) => {
        const [dx, dy] = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, -STEP], ArrowDown: [0, STEP] }[code] as [
          number,
          number,
        ];
        move(() => (shiftKey ? camera.pan(dx, dy, view.canvas.clientHeight) : camera.orbit(dx, dy)));
      },
    },
    {
      shown: 'Page up, down',
      doc: 'dolly',
      group: 'Camera',
      is: place('PageUp', 'PageDown'),
      act: (e) => move(() => camera.dolly(e.code === 'PageUp' ? 0.9 : 1 / 0.9)),
    },
    {
      shown: '.',
      doc: 'turn to the point under the pointer, and about it; with Shift focus there',
      group: 'Camera',
      is: place('Period', 'NumpadDecimal'),
      act: (e) => (e.shiftKey ? focus() : void pick.center()),
    },
    { shown: 'Shift + `', doc: 'fly', group: 'Camera', is: (e) => e.shiftKey && e.code === 'Backquote', act: fly },
    { shown: 'Home', doc: 'back to the scene’s camera', group: 'Camera', is: place('Home'), act: () => send({ type: 'camera-reset' }) },
    { shown: 'R', doc: 'frame a region to render', group: 'Render', is: character('r'), act: () => toolbar.setRegion(!toolbar.region) },
    { shown: 'P', doc: 'pause, go on', group: 'Render', is: character('p'), act: () => toolbar.press('pause') },
    history('Ctrl + Z', 'undo', (e) => isZ(e) && !e.shiftKey),
    history('Ctrl + Shift + Z', 'redo', (e) => (isZ(e) && e.shiftKey) || (e.ctrlKey && e.key === 'y')),
    {
      shown: 'Escape',
      doc: 'put the tool down, unpin the pixel, select nothing',
      group: 'Render',
      is: place('Escape'),
      act: () => (toolbar.region ? toolbar.setRegion(false) : (inspector.set(null), selection.set(null))),
    },
  ];
}
