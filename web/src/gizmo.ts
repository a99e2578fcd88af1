/** Arrows at the selected shape, by which it is dragged along the axes of the world. */

import { svg } from './drawing';
import type { Handle } from './protocol';
import type { View } from './view';

const AXES = ['x', 'y', 'z'];
/** Length of an arrow in CSS pixels. */
const LENGTH = 64;
/** Axes that are shorter in the picture than this part of the longest have no arrow: they point at the camera. */
const SHORTEST = 0.15;
/** CSS pixels that a click may move. */
const STILL = 4;

interface Drag {
  axis: number;
  start: [number, number];
  distance: number;
  hasMoved: boolean;
}

export class Gizmo {
  readonly element = svg('svg', { class: 'gizmo' });
  /** Called as the shape is dragged along an axis, with the distance from where it was. */
  moved: (axis: number, distance: number, done: boolean) => void = () => {};
  /** Called on a click, which is about what lies beneath. */
  clicked: (clientX: number, clientY: number) => void = () => {};
  private handle: Handle | null = null;
  private next: Handle | null = null;
  private drag: Drag | null = null;

  constructor(private readonly view: View) {
    this.element.addEventListener('pointerdown', (event) => this.down(event));
    this.element.addEventListener('pointermove', (event) => this.move(event, false));
    for (const type of ['pointerup', 'pointercancel'] as const) this.element.addEventListener(type, (event) => this.move(event, true));
  }

  /** What is dragged keeps its arrows until it is let go. */
  show(handle: Handle | null): void {
    this.next = handle;
    if (!this.drag) this.handle = handle;
    this.place();
  }

  place(): void {
    const { handle, drag } = this;
    if (!handle) return this.element.replaceChildren();
    const { left, top, scale } = this.view.placement;
    const from = handle.at.map((v, i) => {
      const along = drag ? handle.axes[drag.axis]![i]! * drag.distance : 0;
      return ([left, top][i]! + (v + along) * scale) / devicePixelRatio;
    }) as [number, number];
    const sizes = handle.axes.map(([x, y]) => Math.hypot(x, y));
    const isLong = (axis: number) => sizes[axis]! > SHORTEST * Math.max(...sizes);
    this.element.replaceChildren(...[0, 1, 2].filter(isLong).map((axis) => this.arrow(axis, from, handle.axes[axis]!, sizes[axis]!)));
  }

  private arrow(axis: number, [x, y]: [number, number], [ax, ay]: [number, number], size: number): SVGElement {
    const [dx, dy] = [ax / size, ay / size];
    const [x2, y2] = [x + LENGTH * dx, y + LENGTH * dy];
    const corner = (turn: number) => `${x2 - 11 * dx + turn * dy},${y2 - 11 * dy - turn * dx}`;
    const lines = ['edge', 'line', 'hit'].map((name) => svg('line', { class: name, x1: x, y1: y, x2, y2 }));
    const group = svg('g', { class: `arrow ${AXES[axis]}`, 'data-axis': axis });
    group.append(lines[0]!, lines[1]!, svg('polygon', { points: `${x2 + 3 * dx},${y2 + 3 * dy} ${corner(6)} ${corner(-6)}` }), lines[2]!);
    return group;
  }

  private down(event: PointerEvent): void {
    const axis = (event.target as Element).closest<SVGElement>('.arrow')?.dataset.axis;
    if (event.button !== 0 || axis === undefined) return;
    event.preventDefault();
    this.element.setPointerCapture(event.pointerId);
    this.drag = { axis: Number(axis), start: [event.clientX, event.clientY], distance: 0, hasMoved: false };
  }

  private move(event: PointerEvent, done: boolean): void {
    const { drag, handle } = this;
    if (!drag || !handle) return;
    const [ax, ay] = handle.axes[drag.axis]!;
    const factor = devicePixelRatio / this.view.placement.scale;
    const [dx, dy] = [(event.clientX - drag.start[0]) * factor, (event.clientY - drag.start[1]) * factor];
    drag.distance = Number(((dx * ax + dy * ay) / (ax * ax + ay * ay)).toPrecision(6));
    drag.hasMoved ||= Math.hypot(event.clientX - drag.start[0], event.clientY - drag.start[1]) > STILL;
    if (drag.hasMoved) this.moved(drag.axis, drag.distance, done);
    else if (event.type === 'pointerup') this.clicked(event.clientX, event.clientY);
    else drag.distance = 0;
    if (done) {
      this.drag = null;
      // Where the picture of the new place did not come yet, they come with it.
      this.handle = this.next;
    }
    this.place();
  }
}
