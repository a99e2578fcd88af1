/** The page of `steradian view`: puts picture, panels and connection together. */

import './style.css';
import { bindings } from './bindings';
import { Connection } from './connection';
import { h, trackEditing } from './dom';
import { Drop } from './drop';
import { Keys } from './keys';
import { Panels } from './panels';
import type { State } from './protocol';
import { Stage } from './stage';

function start(): void {
  trackEditing();
  const connection = new Connection();
  const stage: Stage = new Stage(connection, { tell: (message) => panels.tell(message), help: () => keys.toggle() });
  const panels: Panels = new Panels(stage);
  const drop = new Drop(panels.tell);
  const help = () => keys.toggle();
  const keys: Keys = new Keys(bindings({ ...stage, look: panels.look, compare: panels.compare, help }));

  let isFirst = true;
  const takeState = (state: State, isNew: boolean): void => {
    const { view } = stage;
    document.title = `${state.scene.name} – Steradian`;
    stage.takeState(state);
    panels.takeState(state);
    // After a lost connection the server knows nothing of the chosen layer.
    const isForgotten = view.layer !== 'picture' && !state.layers.includes(view.layer);
    if (isNew && !isFirst && isForgotten) stage.send({ type: 'layers', names: [view.layer] });
    isFirst = false;
    view.redraw();
  };
  connection.open({
    state: takeState,
    fields: (state, isNew) => {
      stage.takeFields(state, isNew);
      panels.takeFields(state, isNew);
    },
    frame: (frame) => {
      stage.takeFrame(frame);
      panels.takeFrame(frame);
      stage.inspector.refresh();
    },
    tile: (tile) => stage.takeTile(tile),
    other: (message) => {
      if (message.type === 'message') panels.tell(message);
      else if (message.type === 'reference') panels.compare.changedElsewhere();
    },
  });

  document.body.append(
    h(
      'main',
      { class: 'stage' },
      h('h1', { class: 'hidden' }, 'Steradian'),
      stage.canvas,
      stage.overlay.element,
      panels.compare.divider.element,
      panels.compare.tag,
      stage.toolbar.element,
      stage.legend.element,
      stage.flying,
      panels.messages.toast,
      drop.hint,
    ),
    connection.status.element,
    panels.element,
    keys.help,
  );
  stage.toolbar.setPanel(document.body.classList.toggle('no-panel', innerWidth < 720));
}

try {
  start();
} catch (error) {
  document.body.append(
    h('p', { class: 'fatal', role: 'alert' }, `The page cannot run: ${error instanceof Error ? error.message : String(error)}`),
  );
}
