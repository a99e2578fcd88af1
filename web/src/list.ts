/** Panel "Pictures": the list, with what is wrong with files, and a filter. */

import { h, section, setText } from './dom';
import type { Listing } from './protocol';

export class List {
  readonly element: HTMLElement;
  chosen: number | null = null;
  private readonly filter = h('input', { type: 'search', placeholder: 'Filter', 'aria-label': 'Filter the pictures' });
  private readonly items = h('div', { class: 'pictures', role: 'listbox', tabindex: 0, 'aria-label': 'Pictures' });
  private readonly facts = h('p', { class: 'facts' });
  private listings: Listing[] = [];
  private told = '';

  /** `choose` is told of the picture that was chosen here. */
  constructor(private readonly choose: (id: number) => void) {
    this.filter.addEventListener('input', () => this.fill());
    this.filter.addEventListener('keydown', (event) => {
      const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
      if (by === undefined) return;
      event.preventDefault();
      this.step(by);
    });
    this.element = section('Pictures', true, this.filter, this.items, this.facts);
  }

  update(listings: Listing[]): void {
    this.listings = listings;
    this.fill();
  }

  /** Marks the picture that is shown. */
  mark(id: number): void {
    this.chosen = id;
    this.fill();
    this.items.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: 'nearest' });
  }

  /** The next or previous picture of those that the filter leaves. */
  step(by: number): void {
    const found = this.found();
    if (found.length === 0) return;
    const at = found.findIndex(({ id }) => id === this.chosen);
    this.choose(found[at < 0 ? 0 : (at + by + found.length) % found.length]!.id);
  }

  private found(): Listing[] {
    const words = this.filter.value.toLowerCase().split(/\s+/);
    return this.listings.filter(({ name }) => words.every((word) => name.toLowerCase().includes(word)));
  }

  private fill(): void {
    const found = this.found();
    const told = JSON.stringify([found, this.chosen]);
    if (told === this.told) return;
    this.told = told;
    this.items.replaceChildren(...found.map((listing) => this.item(listing)));
    const isShown = found.some(({ id }) => id === this.chosen);
    if (isShown) this.items.setAttribute('aria-activedescendant', `picture-${this.chosen}`);
    else this.items.removeAttribute('aria-activedescendant');
    setText(this.facts, found.length === this.listings.length ? `${found.length} in all` : `${found.length} of ${this.listings.length}`);
  }

  private item({ id, name, fault }: Listing): HTMLElement {
    const option = { class: 'item', role: 'option', id: `picture-${id}`, title: name, 'aria-selected': String(id === this.chosen) };
    return h(
      'div',
      { ...option, onclick: () => this.choose(id) },
      // The end of a path tells more than its beginning.
      h('div', { class: 'id' }, h('bdi', {}, name)),
      fault === null ? null : h('div', { class: 'fault' }, fault),
    );
  }
}
