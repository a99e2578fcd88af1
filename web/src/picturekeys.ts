/** Keys for what a picture is shown with, in the views of scenes and of finished pictures. */

import type { Compare } from './compare';
import { character, type Key } from './keys';
import type { Look } from './look';
import type { View } from './view';

export interface Shown {
  view: View;
  look: Look;
  compare: Compare;
  panel(): void;
  help(): void;
}

export function pictureKeys({ view, look, compare, panel, help }: Shown): Key[] {
  const key = (shown: string, doc: string, is: Key['is'], act: Key['act']): Key => ({ shown, doc, group: 'Picture', is, act });
  const place = (change: () => void) => (change(), view.redraw());
  const zoom = (factor: number) => place(() => view.placement.zoom(factor));
  return [
    key('[  ]', 'exposure by half an EV', character('[', ']'), (e) => look.expose(view.tone.exposure + (e.key === '[' ? -0.5 : 0.5))),
    key('\\', 'exposure 0', character('\\'), () => look.expose(0)),
    key('+  −', 'zoom', character('+', '=', '-'), (e) => zoom(e.key === '-' ? 1 / 1.5 : 1.5)),
    key('F', 'fit the picture into the window', character('f'), () => place(() => view.placement.fit())),
    key('1', 'one pixel for each pixel', character('1'), () => place(() => view.placement.actual())),
    key('C', 'false colour', character('c'), () => look.setFalse(!view.isFalse)),
    key('L', 'next layer; with Shift the one before', character('l', 'L'), (e) => look.stepLayer(e.shiftKey ? -1 : 1)),
    key('B', 'picture A or B, the one it is compared with', character('b'), () => compare.alternate()),
    key('N', 'show or hide the panel', character('n'), panel),
    key('?', 'this list', character('?'), help),
  ];
}
