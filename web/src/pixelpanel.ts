/** Panel "Pixel" of finished pictures: all channels of the pixel under the pointer, or of the one that is pinned. */

import { fetchPixel } from './album';
import { h, section, setText, show } from './dom';
import { channelTable } from './inspector';

const HINT = 'Point at the picture; click to pin a pixel.';

export class PixelPanel {
  readonly element: HTMLElement;
  pinned: [number, number] | null = null;
  private readonly hover = h('p', { class: 'values' }, HINT);
  private readonly table = h('div', { class: 'pin' });
  private isBusy = false;
  private next: [number, number] | null = null;

  /** `picture` is the number of the one that is shown. */
  constructor(
    private readonly picture: () => number | null,
    private readonly changed: () => void,
  ) {
    this.element = section('Pixel', true, this.hover, this.table);
  }

  /** Values under the pointer. */
  show(pixel: [number, number] | null, values: number[] | null): void {
    setText(this.hover, pixel && values ? `${pixel[0]}, ${pixel[1]}:  ${values.map(show).join('  ')}` : HINT);
    if (pixel && values && !this.pinned) this.ask(pixel);
  }

  pin(pixel: [number, number] | null): void {
    this.pinned = pixel;
    this.table.replaceChildren();
    if (pixel) this.ask(pixel);
    this.changed();
  }

  /** There is another picture. */
  refresh(): void {
    this.table.replaceChildren();
    if (this.pinned) this.ask(this.pinned);
  }

  /** Asks for a pixel, once the question before is answered. */
  private ask(pixel: [number, number]): void {
    this.next = pixel;
    if (!this.isBusy) void this.answer();
  }

  private async answer(): Promise<void> {
    this.isBusy = true;
    for (let pixel = this.next; pixel; pixel = this.next) {
      this.next = null;
      const id = this.picture();
      if (id === null) break;
      const found = await fetchPixel(id, pixel).catch((error: unknown) => String(error instanceof Error ? error.message : error));
      if (this.next || id !== this.picture()) continue;
      const content = typeof found === 'string' ? h('p', { class: 'facts' }, found) : channelTable(found.channels);
      this.table.replaceChildren(this.head(pixel), content);
    }
    this.isBusy = false;
  }

  private head([x, y]: [number, number]): HTMLElement {
    const label = { title: 'Unpin the pixel', 'aria-label': 'Unpin the pixel' };
    const unpin = this.pinned ? h('button', { class: 'small', ...label, onclick: () => this.pin(null) }, '×') : null;
    return h('div', { class: 'pin-head' }, h('strong', {}, `Pixel ${x}, ${y}`), unpin);
  }
}
