/** Flying: keys move, the mouse turns, until Escape or a click. */

import type { Camera } from './camera';
import type { Moving } from './moving';
import { add, scale, type Vec3 } from './vector';

/** Distances to the target for each second. */
const SPEED = 0.7;

export class Fly {
  /** Called when flying begins or ends. */
  changed: (on: boolean) => void = () => {};
  private isOn = false;
  private readonly held = new Set<string>();
  private last = 0;
  private speed = 1;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly camera: Camera,
    private readonly moving: Moving,
  ) {
    addEventListener('keydown', (event) => this.key(event, true), { capture: true });
    addEventListener('keyup', (event) => this.key(event, false), { capture: true });
    addEventListener('blur', () => this.held.clear());
    document.addEventListener('pointerlockchange', () => document.pointerLockElement === null && this.stop());
  }

  get on(): boolean {
    return this.isOn;
  }

  start(): void {
    if (this.isOn) return;
    this.isOn = true;
    this.speed = SPEED * this.camera.distance;
    this.last = performance.now();
    // Without the lock the pointer turns the view as far as the window goes.
    void Promise.resolve(this.canvas.requestPointerLock?.()).catch(() => {});
    this.changed(true);
    requestAnimationFrame((time) => this.step(time));
  }

  stop(): void {
    if (!this.isOn) return;
    this.isOn = false;
    this.held.clear();
    if (document.pointerLockElement) document.exitPointerLock();
    this.moving.stop();
    this.changed(false);
  }

  look(dx: number, dy: number): void {
    this.camera.look(dx, dy);
    this.moving.moved();
    this.moving.stop(250);
  }

  wheel(delta: number): void {
    this.speed *= Math.exp(-0.002 * delta);
  }

  private key(event: KeyboardEvent, down: boolean): void {
    if (!this.isOn) return;
    if (event.code === 'Escape') this.stop();
    else if (/^(Key[WASDQE]|Shift(Left|Right))$/.test(event.code)) down ? this.held.add(event.code) : this.held.delete(event.code);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private step(time: number): void {
    if (!this.isOn) return;
    const seconds = Math.min(Math.max((time - this.last) / 1000, 0), 0.1);
    this.last = time;
    const along = (plus: string, minus: string) => Number(this.held.has(plus)) - Number(this.held.has(minus));
    const { camera } = this;
    const parts: [Vec3, number][] = [
      [camera.forward, along('KeyW', 'KeyS')],
      [camera.right, along('KeyD', 'KeyA')],
      [camera.axis, along('KeyE', 'KeyQ')],
    ];
    const fast = this.held.has('ShiftLeft') || this.held.has('ShiftRight') ? 4 : 1;
    if (parts.some(([, s]) => s !== 0)) {
      const by = parts.map(([v, s]) => scale(v, s * fast * this.speed * seconds)).reduce(add);
      camera.move(by);
      this.moving.moved();
      this.moving.stop(250);
    }
    requestAnimationFrame((next) => this.step(next));
  }
}
