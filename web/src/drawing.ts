/** The path of a sample over the picture: its vertices numbered, the rays between them, and those towards lights. */

import type { PathVertex, TracedPath } from './protocol';
import type { Place } from './vector';
import type { View } from './view';

/** Vertices that are numbered at most; the rays between further ones are drawn, too. */
export const MOST_NUMBERED = 100;
/** Lengths in CSS pixels: of arrows, and of a vertex' radius. */
const ARROW = 46;
const RADIUS = 8;

const SVG = 'http://www.w3.org/2000/svg';

/** An element of SVG. */
export function svg<K extends keyof SVGElementTagNameMap>(tag: K, attributes: Record<string, string | number>): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  return element;
}

/** Whether light arrives. */
export const isLit = (light: readonly number[]): boolean => light.some((v) => v !== 0);

export class Drawing {
  readonly element = svg('svg', { class: 'path' });
  private path: TracedPath | null = null;
  private isWrapped = false;
  private marked = -1;

  constructor(private readonly view: View) {}

  /** `isWrapped`: the picture's left and right edge are neighbours. */
  show(path: TracedPath | null, isWrapped = false): void {
    [this.path, this.isWrapped, this.marked] = [path, isWrapped, -1];
    this.place();
  }

  /** Stresses a vertex, or none. */
  mark(index: number): void {
    this.marked = index;
    this.place();
  }

  /** Puts all where the picture is. */
  place(): void {
    this.element.replaceChildren(...(this.path ? this.draw(this.path.vertices) : []));
  }

  private draw(vertices: PathVertex[]): SVGElement[] {
    const [lights, rays, dots]: SVGElement[][] = [[], [], []];
    for (const [index, vertex] of vertices.entries()) {
      if (!vertex.place) continue;
      const from = this.at(vertex.place);
      const { direct, event } = vertex;
      const next = vertices[index + 1];
      if (direct) {
        const way = isLit(direct.light) ? 'light' : 'light blocked';
        if (direct.place) lights!.push(...this.line(way, from, this.at(direct.place)));
        else if (direct.onwards) lights!.push(...this.arrow(way, from, direct.onwards));
      }
      if (next?.place && !this.wraps(vertex.place, next.place)) rays!.push(...this.line('ray', from, this.at(next.place)));
      else if (next && vertex.onwards) rays!.push(...this.arrow(next.kind === 'escaped' ? 'ray escaping' : 'ray', from, vertex.onwards));
      if (index <= MOST_NUMBERED) dots!.push(this.dot(index, from, next === undefined || event === null));
    }
    return [...lights!, ...rays!, ...dots!];
  }

  private wraps([x]: Place, [u]: Place): boolean {
    return this.isWrapped && Math.abs(x - u) > this.view.film.width / 2;
  }

  /** CSS pixels of a place in the picture. */
  private at([x, y]: Place): Place {
    const { left, top, scale } = this.view.placement;
    // SVG knows no numbers of any size.
    const css = (v: number, start: number) => Math.min(Math.max((start + v * scale) / devicePixelRatio, -1e5), 1e5);
    return [css(x, left), css(y, top)];
  }

  /** A line with a dark edge, so that it is seen on anything. */
  private line(way: string, [x1, y1]: Place, [x2, y2]: Place): SVGElement[] {
    return ['edge', way].map((name) => svg('line', { class: name === 'edge' ? `edge ${way}` : way, x1, y1, x2, y2 }));
  }

  private arrow(way: string, [x, y]: Place, [dx, dy]: Place): SVGElement[] {
    const [ex, ey] = [x + ARROW * dx, y + ARROW * dy];
    const corner = (turn: number) => `${ex - 9 * dx + turn * dy},${ey - 9 * dy - turn * dx}`;
    const points = `${ex + dx},${ey + dy} ${corner(5)} ${corner(-5)}`;
    return [...this.line(way, [x, y], [ex - 6 * dx, ey - 6 * dy]), svg('polygon', { class: `head ${way}`, points })];
  }

  private dot(index: number, [cx, cy]: Place, isLast: boolean): SVGElement {
    const group = svg('g', { class: `vertex${isLast ? ' last' : ''}${index === this.marked ? ' marked' : ''}` });
    const text = svg('text', { x: cx, y: cy });
    text.textContent = String(index);
    group.append(svg('circle', { cx, cy, r: index > 9 ? RADIUS + 2 : RADIUS }), text);
    return group;
  }
}
