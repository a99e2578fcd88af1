/** Panel "Pixel": the values under the pointer, and all that the server knows of a pixel that was clicked. */

import { h, section, setText, show } from './dom';
import type { Path } from './path';
import type { Pixel, Sample } from './protocol';

/** Milliseconds between two questions about a pixel while it changes. */
const PAUSE = 1000;

export class Inspector {
  readonly element: HTMLElement;
  /** The pixel that's pinned. */
  pinned: [number, number] | null = null;
  /** Called with what is known of the pinned pixel. */
  told: (pixel: Pixel) => void = () => {};
  private readonly hover = h('p', { class: 'values' }, 'Point at the picture; click to pin a pixel and select.');
  private readonly pin = h('div', { class: 'pin', 'aria-live': 'polite' });
  private asked = 0;
  private timer = 0;

  /** `path` shows the path of a sample of the pinned pixel. */
  constructor(
    private readonly path: Path,
    private readonly changed: () => void,
  ) {
    this.element = section('Pixel', true, this.hover, path.element, this.pin);
  }

  /** Values under the pointer. */
  show(pixel: [number, number] | null, values: number[] | null, isMixed: boolean): void {
    if (!pixel || !values) return setText(this.hover, 'Point at the picture; click to pin a pixel and select.');
    setText(this.hover, `${pixel[0]}, ${pixel[1]}:  ${values.map(show).join('  ')}${isMixed ? '  (mixed)' : ''}`);
  }

  set(pixel: [number, number] | null): void {
    this.pinned = pixel;
    this.pin.replaceChildren();
    this.changed();
    this.path.set(pixel);
    if (pixel) void this.ask();
  }

  /** The picture has changed. */
  refresh(): void {
    if (!this.pinned || this.timer) return;
    this.timer = window.setTimeout(() => void this.ask(), Math.max(0, this.asked + PAUSE - performance.now()));
  }

  private async ask(): Promise<void> {
    clearTimeout(this.timer);
    this.timer = 0;
    this.asked = performance.now();
    const pixel = this.pinned;
    if (!pixel) return;
    try {
      const response = await fetch(`./api/pixel?x=${pixel[0]}&y=${pixel[1]}`);
      const body = (await response.json()) as Pixel | { error: string };
      if (this.pinned !== pixel) return;
      if ('channels' in body) {
        this.fill(body);
        this.told(body);
      } else this.pin.replaceChildren(this.head(pixel), h('p', { class: 'facts' }, body.error ?? response.statusText));
    } catch {
      if (this.pinned === pixel && this.pin.childElementCount === 0)
        this.pin.replaceChildren(this.head(pixel), h('p', { class: 'facts' }, 'no answer'));
    }
  }

  private head([x, y]: [number, number]): HTMLElement {
    const unpin = h(
      'button',
      { class: 'small', title: 'Unpin the pixel', 'aria-label': 'Unpin the pixel', onclick: () => this.set(null) },
      '×',
    );
    return h('div', { class: 'pin-head' }, h('strong', {}, `Pixel ${x}, ${y}`), unpin);
  }

  private fill(pixel: Pixel): void {
    const facts = [
      ['samples', show(pixel.samples)],
      ['error', pixel.error === null ? null : `${show(100 * pixel.error)} %`],
      ['object', pixel.object],
      ['material', pixel.material],
      ['light', pixel.light],
    ].filter((f): f is [string, string] => f[1] !== null);
    this.pin.replaceChildren(this.head([pixel.x, pixel.y]), channelTable(pixel.channels, facts));
  }
}

/** A table of a pixel's channels, those of a layer (`albedo.R`) in one row, and of facts. */
export function channelTable(channels: Record<string, Sample>, facts: [string, string][] = []): HTMLElement {
  const rows = new Map<string, string[]>();
  for (const [name, value] of Object.entries(channels)) {
    const dot = name.lastIndexOf('.');
    const layer = dot < 0 ? (/^[RGB]$/.test(name) ? 'picture' : name) : name.slice(0, dot);
    rows.set(layer, [...(rows.get(layer) ?? []), text(value)]);
  }
  const line = (name: string, values: string[]) => h('tr', {}, h('th', { scope: 'row' }, name), h('td', {}, values.join('  ')));
  return h('table', {}, h('tbody', {}, ...[...rows].map(([n, v]) => line(n, v)), ...facts.map(([n, v]) => line(n, [v]))));
}

/** A float's shortest digits. */
function text(value: Sample): string {
  if (typeof value !== 'number') return value;
  const short = Number(value.toPrecision(7));
  return Math.abs(short) < 1e-4 && short !== 0 ? short.toExponential() : String(short);
}
