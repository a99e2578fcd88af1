/** The page of `steradian view`: puts its parts together. */

import './style.css';
import { Camera } from './camera';
import { Compare } from './compare';
import { h, trackEditing } from './dom';
import { Drop } from './drop';
import { Errors } from './errors';
import { falseScale, Legend, WHITE } from './falsecolor';
import { Fly } from './fly';
import { FIRST_PLANE } from './groups';
import { Histogram } from './histogram';
import { Inspector } from './inspector';
import { bindings } from './bindings';
import { Keys } from './keys';
import { Look } from './look';
import { FLIP_SCALE } from './magma';
import { Messages } from './messages';
import { Mixer } from './mixer';
import { Moving } from './moving';
import { Navigate } from './navigate';
import { Nodes } from './nodes';
import { Output } from './output';
import { Overlay, regionOf } from './overlay';
import { Pick } from './pick';
import { CameraPanel, RenderPanel, type Side } from './panel';
import { Path } from './path';
import type { FrameEnd, PageMessage, State } from './protocol';
import { Socket } from './socket';
import { Status } from './status';
import { Toolbar } from './toolbar';
import { View } from './view';

function start(): void {
  trackEditing();
  const canvas = h('canvas', { class: 'picture', tabindex: 0, role: 'img', 'aria-label': 'Rendered picture; arrow keys orbit the camera' });
  const view = new View(canvas);
  const camera = new Camera();
  const link = { socket: null as Socket | null };
  const moving = new Moving(camera, (message) => link.socket?.send(message) ?? false);
  const send = (message: PageMessage): boolean => {
    if (['camera-name', 'camera-reset', 'undo', 'redo'].includes(message.type)) moving.release();
    return link.socket?.send(message) ?? false;
  };
  const fly = new Fly(canvas, camera, moving);
  const messages = new Messages();
  const overlay = new Overlay(view);
  const legend = new Legend();
  const histogram = new Histogram();
  const path = new Path(overlay.drawing, () => pinMiddle());
  const inspector = new Inspector(path, () => {
    overlay.pin = inspector.pinned;
    overlay.place();
  });
  const pinMiddle = () => inspector.set([view.film.width >> 1, view.film.height >> 1]);
  const output = new Output(view, (message) => messages.add(message));
  const compare = new Compare(view, (message) => messages.add(message));
  const errors = new Errors(view);
  compare.changed = () => errors.changeReference();
  const showHistogram = () => histogram.update(() => view.statistics(), view.tone.exposure);
  const look = new Look(
    view,
    (names) => send({ type: 'layers', names }),
    () => {
      output.update();
      showHistogram();
      compare.refresh();
    },
  );
  histogram.element.addEventListener('toggle', showHistogram);
  const render = new RenderPanel(send);
  const mixer = new Mixer(view, send, showHistogram);
  const move = (change: () => void) => {
    if (state === null || !state.camera.movable) return;
    change();
    moving.moved();
    moving.stop(150);
  };
  const pick = new Pick(camera, move, send, (message) => messages.add(message));
  const focus = () => state && void pick.focus(state.camera);
  const from = (side: Side, opposite = false) => move(() => camera.from(side, opposite));
  const startFly = () => state?.camera.movable && fly.start();
  const cameraPanel = new CameraPanel(send, { from, fly: startFly, fov: (degrees) => moving.fov(degrees) });
  const nodes = new Nodes(send);
  const drop = new Drop((message) => messages.add(message));
  const panel = h(
    'aside',
    { class: 'panel', 'aria-label': 'Panels' },
    look.element,
    compare.element,
    errors.element,
    histogram.element,
    inspector.element,
    render.element,
    mixer.element,
    cameraPanel.element,
    nodes.element,
    output.element,
    messages.element,
  );
  const toolbar = new Toolbar({
    fit: () => (view.placement.fit(), view.redraw()),
    actual: () => (view.placement.actual(), view.redraw()),
    pause: (on) => send({ type: 'pause', on }) && toolbar.setPaused(on),
    clearRegion: () => send({ type: 'region', pixels: null }),
    help: () => keys.toggle(),
    panel: () => toolbar.setPanel(document.body.classList.toggle('no-panel')),
    themed: showHistogram,
  });
  let state: State | null = null;
  let isNew = true;

  view.drawn = () => {
    overlay.place();
    const isPicture = view.layer === 'picture';
    const ends = view.scale();
    if (view.showsMap) legend.update(FLIP_SCALE);
    else legend.update(ends && falseScale(ends, isPicture ? WHITE : 1, isPicture ? 'cd/m²' : ''));
  };
  const flying = h('div', { class: 'hint', hidden: true }, 'Flying: W A S D Q E and the mouse; Escape ends');
  fly.changed = (on) => (flying.hidden = !on);

  new Navigate(view, camera, moving, fly, {
    hover: (pixel) => {
      pick.pixel = pixel;
      inspector.show(pixel, pixel && view.values(...pixel), view.isMixed);
    },
    click: (pixel) => {
      const inside = view.values(...pixel) !== null;
      inspector.set(inside ? pixel : null);
      if (inside) inspector.show(pixel, view.values(...pixel), view.isMixed);
    },
    region: (a, b, done) => {
      overlay.region = regionOf(a, b, view.film);
      overlay.place();
      if (!done) return;
      toolbar.setRegion(false);
      if (overlay.region) send({ type: 'region', pixels: overlay.region });
      else overlay.region = state?.region ?? null;
    },
    drawsRegion: () => toolbar.region,
    isMovable: () => state?.camera.movable ?? false,
  });

  const keys = new Keys(
    bindings({
      view,
      camera,
      toolbar,
      look,
      compare,
      inspector,
      pick,
      path,
      focus,
      move,
      from,
      fly: startFly,
      send,
      help: () => keys.toggle(),
    }),
  );

  const socket = new Socket({
    message(message) {
      if (message.type === 'state') takeState(message);
      else if (message.type === 'frame') takeFrame(message);
      else if (message.type === 'message') messages.add(message);
      else if (message.type === 'reference') compare.changedElsewhere();
    },
    tile(tile) {
      if (tile.layer >= FIRST_PLANE) return view.groups.tile(tile.layer - FIRST_PLANE, tile);
      const layer = tile.layer === 0 ? 'picture' : state?.layers[tile.layer - 1];
      if (layer !== undefined) view.tile(layer, tile);
    },
    status(connected, seconds) {
      isNew ||= connected;
      status.connected(connected, seconds);
    },
    settled: () => state && takeFields(state),
  });
  const status = new Status(() => socket.retry());
  link.socket = socket;

  function takeState(next: State): void {
    const first = state === null;
    state = next;
    document.title = `${next.scene.name} – Steradian`;
    view.film = { ...next.film };
    view.region = next.region;
    look.update(next);
    compare.takeState(next);
    errors.takeState(next);
    if (isNew || socket.isSettled) takeFields(next);
    output.update(next);
    messages.scene(next.scene.messages);
    path.update(next);
    status.update(next, null);
    // After a lost connection the server knows nothing of the chosen layer.
    if (isNew && !first && view.layer !== 'picture' && !next.layers.includes(view.layer)) send({ type: 'layers', names: [view.layer] });
    isNew = false;
    view.redraw();
  }

  /** Shows what holds where it can be changed. A state that doesn't know yet of what was changed here would undo it. */
  function takeFields(state: State): void {
    if (!toolbar.region) overlay.region = state.region;
    render.update(state);
    mixer.update(state);
    cameraPanel.update(state);
    moving.state(state.generation, state.camera, isNew);
    nodes.update(state, isNew);
    toolbar.update(state);
    overlay.place();
  }

  function takeFrame(frame: FrameEnd): void {
    view.frame(frame);
    mixer.takeFrame(frame);
    moving.frame(frame.generation);
    nodes.frame();
    status.update(null, frame);
    compare.takeFrame(frame);
    errors.takeFrame(frame);
    showHistogram();
    inspector.refresh();
  }

  document.body.append(
    h(
      'main',
      { class: 'stage' },
      h('h1', { class: 'hidden' }, 'Steradian'),
      canvas,
      overlay.element,
      compare.divider.element,
      compare.tag,
      toolbar.element,
      legend.element,
      flying,
      messages.toast,
      drop.hint,
    ),
    status.element,
    panel,
    keys.help,
  );
  toolbar.setPanel(document.body.classList.toggle('no-panel', innerWidth < 720));
}

try {
  start();
} catch (error) {
  document.body.append(
    h('p', { class: 'fatal', role: 'alert' }, `The page cannot run: ${error instanceof Error ? error.message : String(error)}`),
  );
}
