/** False colour of luminance, as crates/image/src/false_color has it: viridis on a logarithmic scale, and its legend. */

import { percentile, type Statistics } from './half';
import { h, show } from './dom';

/** Every fifth of viridis' 256 colours (N. Smith and S. van der Walt 2015, CC0), sRGB. */
const COLORS = [
  0x440154, 0x46085c, 0x471063, 0x481769, 0x481d6f, 0x482475, 0x472a7a, 0x46307e, 0x453781, 0x433d84, 0x414287, 0x3f4889, 0x3d4e8a,
  0x3a538b, 0x38598c, 0x355e8d, 0x33638d, 0x31688e, 0x2e6d8e, 0x2c718e, 0x2a768e, 0x297b8e, 0x27808e, 0x25848e, 0x23898e, 0x218e8d,
  0x20928c, 0x1f978b, 0x1e9c89, 0x1fa188, 0x21a585, 0x24aa83, 0x28ae80, 0x2eb37c, 0x35b779, 0x3dbc74, 0x46c06f, 0x50c46a, 0x5ac864,
  0x65cb5e, 0x70cf57, 0x7cd250, 0x89d548, 0x95d840, 0xa2da37, 0xb0dd2f, 0xbddf26, 0xcae11f, 0xd8e219, 0xe5e419, 0xf1e51d, 0xfde725,
];

/** Red, green and blue of a colour. */
export const bytes = (c: number) => [c >> 16, (c >> 8) & 255, c & 255];

/** `falseColor(luminance)`: between the ends of the scale. */
export const FALSE_COLOR_GLSL = `
uniform vec2 scaleEnds;
const vec3 viridis[52] = vec3[52](${COLORS.map(
  (c) =>
    `vec3(${bytes(c)
      .map((v) => `${v}.0`)
      .join(', ')})`,
).join(', ')});

vec3 falseColor(float l) {
  float t = l > 0.0 ? clamp(log(l / scaleEnds.x) / log(scaleEnds.y / scaleEnds.x), 0.0, 1.0) : 0.0;
  int i = min(int(t * 51.0), 50);
  return floor(mix(viridis[i], viridis[i + 1], t * 51.0 - float(i)) + 0.5) / 255.0;
}
`;

/** cd/m² of a luminance of 1 W/(m² sr nm): the integral of CIE ȳ times 683 lm/W. */
export const WHITE = 72983.26;

/** The scale's ends: 1 % and 99.9 % of the pixels above zero, or a decade where those are the same. */
export function scaleEnds(of: Statistics): [number, number] {
  const low = percentile(of, 0.01) ?? 1;
  const high = percentile(of, 0.999) ?? 1;
  return low < high ? [low, high] : [low, 10 * low];
}

/** What the legend shows: a bar of colours from its bottom, and what is beside it. */
export interface Scale {
  label: string;
  unit: string;
  colors: number[];
  /** Places from 0 to 1, and what is there. */
  ticks: [number, string][];
}

/** The scale of false colour: powers of ten (with 2 and 5 where few). */
export function falseScale(ends: [number, number], white: number, unit: string): Scale {
  const [low, high] = [ends[0] * white, ends[1] * white];
  const place = (v: number) => Math.log(v / low) / Math.log(high / low);
  const ticks = ticksOf(low, high).map((v): [number, string] => [place(v), show(v)]);
  return { label: `False colour from ${show(low)} to ${show(high)} ${unit}`, unit: unit || 'value', colors: COLORS, ticks };
}

export class Legend {
  readonly element = h('div', { class: 'legend', hidden: true, role: 'img' });

  update(scale: Scale | null): void {
    this.element.hidden = scale === null;
    if (!scale || this.element.getAttribute('aria-label') === scale.label) return;
    this.element.setAttribute('aria-label', scale.label);
    const stops = scale.colors.map((c) => `rgb(${bytes(c).join(' ')})`).join(', ');
    const bar = h('div', { class: 'bar', style: `background: linear-gradient(to top, ${stops})` });
    const ticks = scale.ticks.map(([place, text]) => h('span', { style: `bottom: ${100 * place}%` }, text));
    this.element.replaceChildren(
      h('div', { class: 'unit' }, scale.unit),
      h('div', { class: 'scale' }, bar, h('div', { class: 'ticks' }, ...ticks)),
    );
  }
}

function ticksOf(low: number, high: number): number[] {
  const decades = Math.log10(high / low);
  const step = Math.max(1, Math.ceil(decades / 8));
  const factors = decades > 3 ? [1] : decades > 1.5 ? [1, 3] : [1, 2, 5];
  const ticks = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); e += step) {
    for (const f of factors) if (f * 10 ** e >= low && f * 10 ** e <= high) ticks.push(f * 10 ** e);
  }
  return ticks.length > 1 ? ticks : [low, high];
}
