/** Sends the camera as it moves: once a frame of the screen at most, and only when the picture of the last one came. */

import type { Camera } from './camera';
import type { CameraState, PageMessage } from './protocol';
import { length, sub } from './vector';

/** Milliseconds after which a picture that didn't come is no longer waited for. */
const PATIENCE = 4000;

export class Moving {
  private isDirty = false;
  private queued = 0;
  private sentAt: number | null = null;
  private sentGeneration = 0;
  private generation = 0;
  private stopTimer = 0;
  private isMoving = false;
  private nextFov: number | null = null;

  constructor(
    private readonly camera: Camera,
    private readonly send: (message: PageMessage) => boolean,
  ) {}

  /** The camera has been moved. */
  moved(): void {
    this.isMoving = true;
    this.isDirty = true;
    clearTimeout(this.stopTimer);
    this.schedule();
  }

  /** The movement has ended, now or when nothing moves for some milliseconds. */
  stop(after = 0): void {
    clearTimeout(this.stopTimer);
    if (after > 0) {
      this.stopTimer = window.setTimeout(() => this.stop(), after);
    } else if (this.isMoving) {
      this.isMoving = this.isDirty = false;
      this.sentAt = null;
      this.post(false);
    }
  }

  /** The server is asked for another camera: this one's movement is over, and the next state counts. */
  release(): void {
    clearTimeout(this.stopTimer);
    this.isMoving = this.isDirty = false;
    this.sentAt = this.nextFov = null;
  }

  /** A picture came. */
  frame(generation: number): void {
    this.generation = Math.max(this.generation, generation);
    if (this.sentAt !== null && generation > this.sentGeneration) {
      this.sentAt = null;
      if (this.isDirty) this.schedule();
    }
  }

  /** What holds now: takes its camera, unless this page is moving it. */
  state(generation: number, state: CameraState, isNew: boolean): void {
    if (isNew) this.generation = generation;
    const { camera } = this;
    const off = length(sub(state.eye, camera.eye)) + length(sub(state.target, camera.target));
    const isOther = off > 1e-4 * camera.distance;
    if (isNew || (!this.isMoving && (!state.moved || isOther))) camera.adopt(state);
  }

  /** Another angle of view, in degrees. */
  fov(degrees: number): void {
    this.nextFov = degrees;
    this.moved();
    this.stop(250);
  }

  private schedule(): void {
    this.queued ||= requestAnimationFrame(() => {
      this.queued = 0;
      const waits = this.sentAt !== null && performance.now() - this.sentAt < PATIENCE;
      if (waits) window.setTimeout(() => this.isDirty && this.schedule(), PATIENCE);
      else if (this.isDirty) this.post(true);
    });
  }

  private post(moving: boolean): void {
    const { eye, target, up } = this.camera;
    if (moving) {
      this.isDirty = false;
      this.sentAt = performance.now();
      this.sentGeneration = this.generation;
    }
    this.send({ type: 'camera', eye, target, up, ...(this.nextFov === null ? {} : { fov: this.nextFov }), moving });
    if (!moving) this.nextFov = null;
  }
}
