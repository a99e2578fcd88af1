/** Pointer, wheel and touch on the picture: orbit, pan, dolly, zoom, the region tool, and clicks. */

import type { Camera } from './camera';
import type { Fly } from './fly';
import type { Moving } from './moving';
import type { View } from './view';

export interface Actions {
  /** The pointer is over this pixel of the film; `null` when it left. */
  hover(pixel: [number, number] | null): void;
  click(pixel: [number, number]): void;
  /** A region's opposite corners, while it's drawn and (`done`) after. */
  region(from: [number, number], to: [number, number], done: boolean): void;
  /** Whether the region tool is in hand. */
  drawsRegion(): boolean;
  /** Whether the camera may be moved. */
  isMovable(): boolean;
}

/** Camera controls of the stage. */
export interface Hands {
  camera: Camera;
  moving: Moving;
  fly: Fly;
}

type Drag = 'orbit' | 'pan' | 'picture' | 'region';

/** CSS pixels that a click may move. */
const STILL = 4;

export class Navigate {
  private drag: Drag | null = null;
  private start: [number, number] = [0, 0];
  private last: [number, number] = [0, 0];
  private isClick = false;
  private readonly touches = new Map<number, [number, number]>();

  constructor(
    private readonly view: View,
    /** The camera, where there is one. */
    private readonly hands: Hands | null,
    private readonly actions: Actions,
  ) {
    const { canvas } = view;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.up(event));
    canvas.addEventListener('pointercancel', (event) => this.up(event));
    canvas.addEventListener('pointerleave', () => actions.hover(null));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    // No scrolling by the middle button.
    canvas.addEventListener('mousedown', (event) => event.button === 1 && event.preventDefault());
  }

  private down(event: PointerEvent): void {
    if (this.hands?.fly.on) return this.hands.fly.stop();
    if (event.button > 1) return;
    this.view.canvas.focus({ preventScroll: true });
    this.view.canvas.setPointerCapture(event.pointerId);
    const at: [number, number] = [event.clientX, event.clientY];
    if (event.pointerType === 'touch') this.touches.set(event.pointerId, at);
    this.isClick = event.button === 0 && this.touches.size < 2;
    this.start = this.last = at;
    if (this.actions.drawsRegion() && event.button === 0) this.drag = 'region';
    else if (event.ctrlKey || event.metaKey || !this.actions.isMovable()) this.drag = 'picture';
    else this.drag = event.shiftKey ? 'pan' : 'orbit';
  }

  private move(event: PointerEvent): void {
    const at: [number, number] = [event.clientX, event.clientY];
    if (this.hands?.fly.on) return this.hands.fly.look(event.movementX, event.movementY);
    if (event.pointerType !== 'touch') this.actions.hover(this.view.pixelAt(...at));
    if (!this.drag) return;
    if (Math.hypot(at[0] - this.start[0], at[1] - this.start[1]) > STILL) this.isClick = false;
    if (this.touches.size === 2) return this.pinch(event.pointerId, at);
    if (this.touches.has(event.pointerId)) this.touches.set(event.pointerId, at);
    if (this.isClick) return;
    const [dx, dy] = [at[0] - this.last[0], at[1] - this.last[1]];
    this.last = at;
    if (this.drag === 'region') return this.actions.region(this.view.pixelAt(...this.start), this.view.pixelAt(...at), false);
    if (this.drag === 'picture') {
      this.view.placement.pan(Math.round(dx * devicePixelRatio), Math.round(dy * devicePixelRatio));
      return this.view.redraw();
    }
    if (this.drag === 'orbit') this.hands?.camera.orbit(dx, dy);
    else this.hands?.camera.pan(dx, dy, this.pictureSize());
    this.hands?.moving.moved();
  }

  private up(event: PointerEvent): void {
    const wasPinch = this.touches.size > 1;
    this.touches.delete(event.pointerId);
    if (wasPinch) {
      // The finger that stays goes on from where it is.
      for (const at of this.touches.values()) this.last = this.start = at;
      return;
    }
    const { drag } = this;
    this.drag = null;
    if (!drag) return;
    const at: [number, number] = [event.clientX, event.clientY];
    if (event.type === 'pointercancel') this.hands?.moving.stop();
    else if (drag === 'region') this.actions.region(this.view.pixelAt(...this.start), this.view.pixelAt(...at), true);
    else if (this.isClick) this.actions.click(this.view.pixelAt(...at));
    else this.hands?.moving.stop();
  }

  /** Two fingers: their middle pans, their distance dollies. */
  private pinch(id: number, at: [number, number]): void {
    const other = [...this.touches].find(([key]) => key !== id)?.[1];
    const before = this.touches.get(id);
    this.touches.set(id, at);
    if (!other || !before) return;
    const apart = (a: [number, number]) => Math.max(Math.hypot(a[0] - other[0], a[1] - other[1]), 1);
    const [dx, dy] = [(at[0] - before[0]) / 2, (at[1] - before[1]) / 2];
    if (this.actions.isMovable()) {
      this.hands?.camera.pan(dx, dy, this.pictureSize());
      this.hands?.camera.dolly(apart(before) / apart(at));
      this.hands?.moving.moved();
    } else {
      this.view.placement.pan(dx * devicePixelRatio, dy * devicePixelRatio);
      const middle = this.view.devicePixel((at[0] + other[0]) / 2, (at[1] + other[1]) / 2);
      this.view.placement.zoom(apart(at) / apart(before), ...middle);
      this.view.redraw();
    }
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const delta = event.deltaY * (event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1);
    if (this.hands?.fly.on) return this.hands.fly.wheel(delta);
    if (event.ctrlKey || event.metaKey || !this.actions.isMovable()) {
      const factor = Math.exp(-Math.max(-100, Math.min(100, delta)) * 0.003);
      this.view.placement.zoom(factor, ...this.view.devicePixel(event.clientX, event.clientY));
      return this.view.redraw();
    }
    this.hands?.camera.dolly(Math.exp(delta * 0.001));
    this.hands?.moving.moved();
    this.hands?.moving.stop(250);
  }

  /** The picture's smaller side, CSS pixels. */
  private pictureSize(): number {
    const { film, placement } = this.view;
    return (Math.min(film.width, film.height) * placement.scale) / devicePixelRatio;
  }
}
