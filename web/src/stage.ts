/** The picture with what lies over it, the camera that it is seen by, and the pointer on it. */

import { Camera } from './camera';
import type { Connection } from './connection';
import { h } from './dom';
import { falseScale, Legend, WHITE } from './falsecolor';
import { Fly } from './fly';
import { FIRST_PLANE } from './groups';
import { Inspector } from './inspector';
import { FLIP_SCALE } from './magma';
import { Moving } from './moving';
import { Navigate } from './navigate';
import { Overlay, regionOf } from './overlay';
import type { Side } from './panel';
import { Path } from './path';
import { Pick } from './pick';
import type { FrameEnd, Message, PageMessage, State } from './protocol';
import { Selection } from './selection';
import type { Tile } from './tile';
import { Toolbar } from './toolbar';
import { View } from './view';

/** Milliseconds without a movement by a key after which it has ended. */
const STOP = 150;

/** Actions of buttons over the picture that are other parts'. */
export interface StageActions {
  tell(message: Message): void;
  help(): void;
}

export class Stage {
  readonly canvas = h('canvas', {
    class: 'picture',
    tabindex: 0,
    role: 'img',
    'aria-label': 'Rendered picture; arrow keys orbit the camera',
  });
  readonly view = new View(this.canvas);
  readonly camera = new Camera();
  readonly moving: Moving;
  readonly overlay = new Overlay(this.view);
  readonly legend = new Legend();
  readonly path: Path;
  readonly inspector: Inspector;
  readonly pick: Pick;
  readonly selection: Selection;
  readonly toolbar: Toolbar;
  readonly flying = h('div', { class: 'hint', hidden: true }, 'Flying: W A S D Q E and the mouse; Escape ends');
  /** Called when there is another theme. */
  themed: () => void = () => {};
  private readonly flight: Fly;

  constructor(
    private readonly connection: Connection,
    actions: StageActions,
  ) {
    const { view, overlay } = this;
    this.moving = new Moving(this.camera, (message) => connection.send(message));
    this.flight = new Fly(this.canvas, this.camera, this.moving);
    this.flight.changed = (on) => (this.flying.hidden = !on);
    this.path = new Path(overlay.drawing, () => this.inspector.set([view.film.width >> 1, view.film.height >> 1]));
    this.inspector = new Inspector(this.path, () => {
      overlay.pin = this.inspector.pinned;
      overlay.place();
    });
    this.selection = new Selection(overlay.outline, overlay.gizmo);
    this.inspector.told = (pixel) => this.selection.take(pixel);
    this.pick = new Pick(this.camera, this.move, this.send, actions.tell);
    this.toolbar = new Toolbar({
      fit: () => (view.placement.fit(), view.redraw()),
      actual: () => (view.placement.actual(), view.redraw()),
      pause: (on) => this.send({ type: 'pause', on }) && this.toolbar.setPaused(on),
      clearRegion: () => this.send({ type: 'region', pixels: null }),
      help: actions.help,
      panel: () => this.toolbar.setPanel(document.body.classList.toggle('no-panel')),
      themed: () => this.themed(),
    });
    view.drawn = () => this.drawn();
    this.navigate();
  }

  /** Sends; what asks for another camera ends the movement of this one. */
  readonly send = (message: PageMessage): boolean => {
    if (['camera-name', 'camera-reset', 'undo', 'redo'].includes(message.type)) this.moving.release();
    return this.connection.send(message);
  };

  /** Moves the camera, if it may be moved. */
  readonly move = (change: () => void): void => {
    if (!this.isMovable) return;
    change();
    this.moving.moved();
    this.moving.stop(STOP);
  };

  readonly from = (side: Side, opposite = false): void => this.move(() => this.camera.from(side, opposite));

  readonly fly = (): void => {
    if (this.isMovable) this.flight.start();
  };

  readonly focus = (): void => {
    const { state } = this.connection;
    if (state) void this.pick.focus(state.camera);
  };

  private get isMovable(): boolean {
    return this.connection.state?.camera.movable ?? false;
  }

  private navigate(): void {
    const { view, overlay, inspector, path, pick, selection, toolbar } = this;
    const click = (pixel: [number, number]) => {
      const inside = view.values(...pixel) !== null;
      // A click that traces leaves its table in view.
      if (!inside) selection.set(null);
      else if (!path.isOn) selection.click();
      inspector.set(inside ? pixel : null);
      if (inside) inspector.show(pixel, view.values(...pixel), view.isMixed);
    };
    overlay.gizmo.clicked = (x, y) => click(view.pixelAt(x, y));
    new Navigate(
      view,
      { camera: this.camera, moving: this.moving, fly: this.flight },
      {
        hover: (pixel) => {
          pick.pixel = pixel;
          inspector.show(pixel, pixel && view.values(...pixel), view.isMixed);
        },
        click,
        region: (a, b, done) => {
          overlay.region = regionOf(a, b, view.film);
          overlay.place();
          if (!done) return;
          toolbar.setRegion(false);
          if (overlay.region) this.send({ type: 'region', pixels: overlay.region });
          else overlay.region = this.connection.state?.region ?? null;
        },
        drawsRegion: () => toolbar.region,
        isMovable: () => this.isMovable,
      },
    );
  }

  private drawn(): void {
    const { view } = this;
    this.overlay.place();
    const isPicture = view.layer === 'picture';
    const ends = view.scale();
    if (view.showsMap) this.legend.update(FLIP_SCALE);
    else this.legend.update(ends && falseScale(ends, isPicture ? WHITE : 1, isPicture ? 'cd/m²' : ''));
  }

  takeState(state: State): void {
    this.view.film = { ...state.film };
    this.view.region = state.region;
    this.path.update(state);
    this.selection.state(state);
  }

  takeFields(state: State, isNew: boolean): void {
    if (!this.toolbar.region) this.overlay.region = state.region;
    this.moving.state(state.generation, state.camera, isNew);
    this.toolbar.update(state);
    this.overlay.place();
  }

  takeTile(tile: Tile): void {
    const { view } = this;
    if (tile.layer >= FIRST_PLANE) return view.groups.tile(tile.layer - FIRST_PLANE, tile);
    const layer = tile.layer === 0 ? 'picture' : this.connection.state?.layers[tile.layer - 1];
    if (layer !== undefined) view.tile(layer, tile);
  }

  takeFrame(frame: FrameEnd): void {
    this.view.frame(frame);
    this.moving.frame(frame.generation);
    this.selection.frame(frame);
  }
}
