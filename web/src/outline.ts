/** The outline of the selected shape over the picture, along the edges of its pixels. */

import { svg } from './drawing';
import type { Outline } from './protocol';
import type { View } from './view';

type Runs = Outline['runs'];

/** The edges between pixels of the shape and others, as a path of SVG; a pixel is one long. */
export function edges(runs: Runs): string {
  const rows = new Map<number, number[]>();
  for (const [row, from, to] of runs) rows.set(row, [...(rows.get(row) ?? []), from, to]);
  const upright = runs.flatMap(([row, from, to]) => [`M${from} ${row}v1`, `M${to} ${row}v1`]);
  const between = new Set([...rows.keys()].flatMap((row) => [row, row + 1]));
  const level = [...between].flatMap((row) => {
    // In one of the two rows and not in the other, from each odd end to the next even one.
    const ends = [...(rows.get(row - 1) ?? []), ...(rows.get(row) ?? [])].sort((a, b) => a - b);
    return ends.flatMap((end, i) => (i % 2 === 0 && ends[i + 1]! > end ? `M${end} ${row}H${ends[i + 1]}` : []));
  });
  return [...upright, ...level].join('');
}

export class OutlineDrawing {
  readonly element = svg('svg', { class: 'outline' });
  private readonly group = svg('g', {});
  private outline: Outline | null = null;

  constructor(private readonly view: View) {
    this.element.append(this.group);
  }

  show(outline: Outline | null): void {
    this.outline = outline;
    const d = outline ? edges(outline.runs) : '';
    this.group.replaceChildren(...(d ? ['edge', 'line'].map((name) => svg('path', { class: name, d })) : []));
    this.place();
  }

  /** Puts it where the picture is. */
  place(): void {
    if (!this.outline) return;
    const { left, top, scale } = this.view.placement;
    const { origin, pixel } = this.outline;
    const at = (start: number, from: number) => (start + from * scale) / devicePixelRatio;
    const sizes = pixel.map((size) => (size * scale) / devicePixelRatio);
    this.group.setAttribute('transform', `matrix(${sizes[0]} 0 0 ${sizes[1]} ${at(left, origin[0])} ${at(top, origin[1])})`);
  }
}
