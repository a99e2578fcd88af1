/** A camera on a turntable: it turns about an axis, and tilts up to the axis; the horizon stays level. */

import type { CameraState } from './protocol';
import { across, add, cross, dot, length, normalize, scale, sub, turn, type Vec3 } from './vector';

const RADIANS_PER_PIXEL = 0.007;

export class Camera {
  eye: Vec3 = [0, 0, 1];
  target: Vec3 = [0, 0, 0];
  /** What is up in the scene, a unit vector. */
  axis: Vec3 = [0, 1, 0];
  private handedness = 1;
  private fov = 50;
  /** Where the camera looks, level. */
  private heading: Vec3 = [0, 0, -1];
  /** Where it looks after `aim`. */
  private direction: Vec3 = [0, 0, -1];

  /** Takes the server's camera. The axis stays where that camera's horizon is level about it. */
  adopt(state: CameraState): void {
    this.eye = [...state.eye];
    this.target = [...state.target];
    this.handedness = state.handedness;
    this.fov = state.fov ?? 50;
    const up = normalize(state.up);
    const right = normalize(cross(this.forward, up));
    const isLevel = (axis: Vec3) => Math.abs(dot(right, axis)) < 1e-3 && dot(up, axis) > -1e-3;
    if (!isLevel(this.axis) || Math.abs(dot(up, this.axis)) < 1e-3) {
      // An `up` across the view may have been made so from a principal axis.
      const principal: Vec3[] = [
        [0, 1, 0],
        [0, 0, 1],
        [1, 0, 0],
        [0, -1, 0],
        [0, 0, -1],
        [-1, 0, 0],
      ];
      const level = principal.filter(isLevel).sort((a, b) => dot(up, b) - dot(up, a));
      const isAcross = Math.abs(dot(up, this.forward)) < 1e-4;
      this.axis = isAcross && level[0] && dot(up, level[0]) > 0.1 ? level[0] : up;
    }
    const level = across(this.forward, this.axis);
    this.heading =
      length(level) > 1e-4 ? normalize(level) : normalize(across(scale(up, -Math.sign(dot(this.forward, this.axis))), this.axis));
  }

  get forward(): Vec3 {
    return normalize(sub(this.target, this.eye));
  }

  get distance(): number {
    return length(sub(this.target, this.eye)) || 1;
  }

  /** The picture's up direction; the axis, unless the camera looks nearly along it. */
  get up(): Vec3 {
    const sine = dot(this.forward, this.axis);
    if (Math.abs(sine) < 0.999) return this.axis;
    return add(scale(this.heading, -sine), scale(this.axis, Math.sqrt(Math.max(0, 1 - sine * sine))));
  }

  /** The picture's right direction. */
  get right(): Vec3 {
    return scale(normalize(cross(this.forward, this.up)), this.handedness);
  }

  /** Turns about the target: what is in front follows the pointer. Lengths in CSS pixels. */
  orbit(dx: number, dy: number): void {
    const { distance } = this;
    this.aim(-this.handedness * dx * RADIANS_PER_PIXEL, -dy * RADIANS_PER_PIXEL);
    this.eye = sub(this.target, scale(this.direction, distance));
  }

  /** Turns about the eye: the view follows the pointer. */
  look(dx: number, dy: number): void {
    const { distance } = this;
    this.aim(-this.handedness * dx * 0.5 * RADIANS_PER_PIXEL, -dy * 0.5 * RADIANS_PER_PIXEL);
    this.target = add(this.eye, scale(this.direction, distance));
  }

  /** Moves across the view; `size` is the picture's smaller side in the pixels that `dx` and `dy` are in. */
  pan(dx: number, dy: number, size: number): void {
    const perPixel = (2 * this.distance * Math.tan((this.fov * Math.PI) / 360)) / Math.max(size, 1);
    const pictureUp = scale(cross(this.right, this.forward), this.handedness);
    this.move(add(scale(this.right, -dx * perPixel), scale(pictureUp, dy * perPixel)));
  }

  /** Changes the distance by a factor. */
  dolly(factor: number): void {
    const distance = Math.min(Math.max(this.distance * factor, 1e-6), 1e9);
    this.eye = sub(this.target, scale(this.forward, distance));
  }

  /** Looks at a point, and turns about it from then on. */
  center(point: Vec3): void {
    const level = across(this.forward, this.axis);
    if (length(level) > 1e-4) this.heading = normalize(level);
    this.target = [...point];
  }

  move(by: Vec3): void {
    this.eye = add(this.eye, by);
    this.target = add(this.target, by);
  }

  /** Looks at the target from the front, the right or the top, or opposite. With Z up the front is at −Y, else at +Z. */
  from(side: 'front' | 'right' | 'top', opposite: boolean): void {
    const { distance, axis } = this;
    const s = opposite ? -1 : 1;
    const isZ = Math.abs(axis[2]) > 0.9;
    const level = (v: Vec3): Vec3 => normalize(across(length(across(v, axis)) > 0.1 ? v : [0, 0, 1], axis));
    const front = level(isZ ? [0, -1, 0] : [0, 0, 1]);
    const away = side === 'top' ? axis : side === 'front' ? front : level([1, 0, 0]);
    this.heading = side === 'top' ? scale(front, -1) : scale(away, -s);
    this.eye = add(this.target, scale(away, s * distance));
  }

  /** Turns the direction by angles about the axis and towards it, and keeps it from passing the axis. */
  private aim(around: number, upwards: number): void {
    const sine = Math.min(Math.max(dot(this.forward, this.axis), -1), 1);
    const level = across(this.forward, this.axis);
    if (length(level) > 1e-4) this.heading = normalize(level);
    this.heading = normalize(turn(this.heading, this.axis, around));
    const tilt = Math.min(Math.max(Math.asin(sine) + upwards, -Math.PI / 2), Math.PI / 2);
    this.direction = add(scale(this.heading, Math.cos(tilt)), scale(this.axis, Math.sin(tilt)));
  }
}
