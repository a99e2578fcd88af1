/** The point of the scene under the pointer: the camera turns to it, or is focused on it. */

import type { Camera } from './camera';
import type { CameraState, Message, PageMessage, Pixel } from './protocol';
import { dot, sub, type Vec3 } from './vector';

export class Pick {
  /** The pixel under the pointer. */
  pixel: [number, number] | null = null;

  constructor(
    private readonly camera: Camera,
    private readonly move: (change: () => void) => void,
    private readonly send: (message: PageMessage) => boolean,
    private readonly tell: (message: Message) => void,
  ) {}

  /** Turns the camera to the point, about which it turns from then on. */
  async center(): Promise<void> {
    const point = await this.point();
    if (point) this.move(() => this.camera.center(point));
  }

  /** Makes sharp what is as far along the axis as the point. */
  async focus({ id, unit, lens }: CameraState): Promise<void> {
    if (lens === null) return this.tell({ severity: 'note', text: 'this kind of camera has no focal distance' });
    const point = await this.point();
    if (!point) return;
    const far = dot(sub(point, this.camera.eye), this.camera.forward) / unit;
    if (!(far > 0)) return this.tell({ severity: 'note', text: 'the point is not in front of the camera' });
    this.send({ type: 'edit', node: id, parameter: 'focal_distance', value: String(Number(far.toPrecision(7))), moving: false });
    if (lens <= 0)
      this.tell({ severity: 'note', text: `all is sharp through a pinhole: 'lens_radius' of ${id} above 0 shows where the focus is` });
  }

  private async point(): Promise<Vec3 | null> {
    const none = (text: string) => (this.tell({ severity: 'note', text }), null);
    if (!this.pixel) return none('there is no point under the pointer');
    const [x, y] = this.pixel;
    try {
      const pixel = (await (await fetch(`./api/pixel?x=${x}&y=${y}`)).json()) as Pixel | { error: string };
      if (!('channels' in pixel)) return none(pixel.error);
      const { 'P.X': px, 'P.Y': py, 'P.Z': pz, Z: depth } = pixel.channels;
      if (px === undefined) return none('points are not known of a preview: try again in a moment');
      const isHit = [px, py, pz, depth].every((v) => typeof v === 'number');
      return isHit ? ([px, py, pz] as Vec3) : none('there is no surface under the pointer');
    } catch {
      return none('no answer');
    }
  }
}
