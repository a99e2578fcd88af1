/** What lies over the picture: the region's frame, the pinned pixel's mark, the selected shape's outline and arrows, and a path. */

import { h } from './dom';
import { Drawing } from './drawing';
import { Gizmo } from './gizmo';
import { OutlineDrawing } from './outline';
import type { Box } from './vector';
import type { View } from './view';

export class Overlay {
  readonly element = h('div', { class: 'overlay', 'aria-hidden': 'true' });
  /** The region that's rendered, or that is being drawn. */
  region: Box | null = null;
  pin: [number, number] | null = null;
  readonly drawing: Drawing;
  readonly outline: OutlineDrawing;
  readonly gizmo: Gizmo;
  private readonly frame = h('div', { class: 'region' });
  private readonly mark = h('div', { class: 'mark' });

  constructor(private readonly view: View) {
    this.drawing = new Drawing(view);
    this.outline = new OutlineDrawing(view);
    this.gizmo = new Gizmo(view);
    this.element.append(this.outline.element, this.frame, this.mark, this.drawing.element, this.gizmo.element);
  }

  /** Puts all where the picture is. */
  place(): void {
    this.put(this.frame, this.region);
    this.put(this.mark, this.pin && [this.pin[0], this.pin[1], this.pin[0] + 1, this.pin[1] + 1]);
    this.outline.place();
    this.drawing.place();
    this.gizmo.place();
  }

  private put(element: HTMLElement, box: Box | null): void {
    element.hidden = box === null;
    if (!box) return;
    const { left, top, scale } = this.view.placement;
    const at = (v: number, start: number) => (start + v * scale) / devicePixelRatio;
    const [x, y] = [at(box[0], left), at(box[1], top)];
    Object.assign(element.style, { left: `${x}px`, top: `${y}px`, width: `${at(box[2], left) - x}px`, height: `${at(box[3], top) - y}px` });
  }
}

/** The region between two corners in any order, both included, within the film; `null` where nothing is left. */
export function regionOf([ax, ay]: [number, number], [bx, by]: [number, number], film: { width: number; height: number }): Box | null {
  const clamp = (v: number, high: number) => Math.min(Math.max(v, 0), high);
  const [x0, x1] = [clamp(Math.min(ax, bx), film.width), clamp(Math.max(ax, bx) + 1, film.width)];
  const [y0, y1] = [clamp(Math.min(ay, by), film.height), clamp(Math.max(ay, by) + 1, film.height)];
  return x1 - x0 >= 2 && y1 - y0 >= 2 ? [x0, y0, x1, y1] : null;
}
