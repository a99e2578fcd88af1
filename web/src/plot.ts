/** A small plot with two logarithmic axes, as SVG. */

const NAMESPACE = 'http://www.w3.org/2000/svg';
const WIDTH = 294;
const HEIGHT = 190;
const LEFT = 40;
const RIGHT = 6;
const TOP = 6;
const BOTTOM = 20;

export interface Line {
  /** Class names, for its colour. */
  style: string;
  label: string;
  points: [number, number][];
}

function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | number>,
  ...children: (Node | string)[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(NAMESPACE, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

/** Powers of ten within, with 2 and 5 where there are few. */
function ticks(low: number, high: number): number[] {
  const factors = Math.log10(high / low) < 1.7 ? [1, 2, 5] : [1];
  const step = Math.max(1, Math.ceil(Math.log10(high / low) / 6));
  const found = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); e += step) {
    for (const f of factors) {
      const v = Number(`${f}e${e}`);
      if (v >= low * 0.999 && v <= high * 1.001) found.push(v);
    }
  }
  return found;
}

/** 10 to the power where it's short. */
function text(v: number): string {
  return v >= 0.01 && v < 10000 ? String(v) : v.toExponential(0).replace('e+', 'e').replace('-', '−');
}

/** The ends of an axis around values: some room, and at least half a decade. */
function ends(values: number[]): [number, number] {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const middle = Math.sqrt(low * high);
  const factor = Math.max(Math.sqrt(high / low) * 1.15, 10 ** 0.25);
  return [middle / factor, middle * factor];
}

/** The plot of lines; a line of slope −1/2 lies beside them, from the first one's beginning. */
export function plot(title: string, description: string, xName: string, lines: Line[]): SVGSVGElement {
  const all = lines.flatMap((line) => line.points);
  const [x0, x1] = ends(all.map((p) => p[0]));
  const [y0, y1] = ends(all.map((p) => p[1]));
  const x = (v: number) => LEFT + ((WIDTH - LEFT - RIGHT) * Math.log(v / x0)) / Math.log(x1 / x0);
  const y = (v: number) => HEIGHT - BOTTOM - ((HEIGHT - TOP - BOTTOM) * Math.log(v / y0)) / Math.log(y1 / y0);
  const root = svg(
    'svg',
    {
      class: 'plot',
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      role: 'img',
      'aria-labelledby': 'plot-title',
      'aria-describedby': 'plot-description',
    },
    svg('title', { id: 'plot-title' }, title),
    svg('desc', { id: 'plot-description' }, description),
    svg('clipPath', { id: 'plot-inside' }, svg('rect', { x: LEFT, y: TOP, width: WIDTH - LEFT - RIGHT, height: HEIGHT - TOP - BOTTOM })),
  );
  for (const v of ticks(x0, x1)) {
    root.append(
      svg('line', { class: 'grid', x1: x(v), x2: x(v), y1: TOP, y2: HEIGHT - BOTTOM }),
      svg('text', { x: x(v), y: HEIGHT - 7, 'text-anchor': 'middle' }, text(v)),
    );
  }
  for (const v of ticks(y0, y1)) {
    root.append(
      svg('line', { class: 'grid', x1: LEFT, x2: WIDTH - RIGHT, y1: y(v), y2: y(v) }),
      svg('text', { x: LEFT - 4, y: y(v) + 3, 'text-anchor': 'end' }, text(v)),
    );
  }
  root.append(svg('text', { class: 'axis', x: WIDTH - RIGHT - 2, y: HEIGHT - BOTTOM - 4, 'text-anchor': 'end' }, xName));
  const inside = svg('g', { 'clip-path': 'url(#plot-inside)' });
  const first = lines[0]!.points[0]!;
  // Beside the first line, a little above.
  const slope = (v: number) => 1.5 * first[1] * Math.sqrt(first[0] / v);
  inside.append(svg('path', { class: 'slope', d: `M${x(x0)} ${y(slope(x0))}L${x(x1)} ${y(slope(x1))}` }));
  for (const line of lines) {
    const places = line.points.map(([a, b]) => `${x(a).toFixed(1)} ${y(b).toFixed(1)}`);
    inside.append(svg('path', { class: `curve ${line.style}`, d: `M${places.join('L')}` }, svg('title', {}, line.label)));
    const [a, b] = line.points.at(-1)!;
    inside.append(svg('circle', { class: `end ${line.style}`, cx: x(a).toFixed(1), cy: y(b).toFixed(1), r: 2.5 }));
  }
  root.append(inside);
  return root;
}
