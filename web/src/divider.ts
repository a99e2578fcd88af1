/** The line between the picture and B: dragged, or moved by keys. */

import { h } from './dom';

export class Divider {
  readonly element: HTMLElement;

  /** `moved` is given the part of the width that is the picture's. */
  constructor(private readonly moved: (part: number) => void) {
    const names = [h('span', { class: 'side' }, 'A'), h('span', { class: 'side' }, 'B')];
    this.element = h(
      'div',
      {
        class: 'divider',
        role: 'slider',
        tabindex: 0,
        hidden: true,
        'aria-label': 'Divider: A at its left, B at its right',
        'aria-orientation': 'horizontal',
        'aria-valuemin': 0,
        'aria-valuemax': 100,
        onkeydown: (event) => this.press(event as KeyboardEvent),
        onpointerdown: (event) => this.element.setPointerCapture((event as PointerEvent).pointerId),
        onpointermove: (event) => this.drag(event as PointerEvent),
      },
      ...names,
    );
    this.set(0.5);
  }

  private part = 0.5;

  private set(part: number): void {
    this.part = Math.min(Math.max(part, 0), 1);
    this.element.style.left = `${100 * this.part}%`;
    this.element.setAttribute('aria-valuenow', String(Math.round(100 * this.part)));
    this.element.setAttribute('aria-valuetext', `${Math.round(100 * this.part)} % of the width are A`);
    this.moved(this.part);
  }

  private drag(event: PointerEvent): void {
    if (!this.element.hasPointerCapture(event.pointerId)) return;
    const box = this.element.parentElement!.getBoundingClientRect();
    this.set((event.clientX - box.left) / box.width);
  }

  private press(event: KeyboardEvent): void {
    const step = event.shiftKey ? 0.1 : 0.01;
    const parts: Record<string, number> = {
      ArrowLeft: this.part - step,
      ArrowDown: this.part - step,
      ArrowRight: this.part + step,
      ArrowUp: this.part + step,
      PageDown: this.part - 0.1,
      PageUp: this.part + 0.1,
      Home: 0,
      End: 1,
    };
    const part = parts[event.key];
    if (part === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.set(part);
  }
}
