/** Keys, and the page that lists them. */

import { h } from './dom';

export interface Key {
  /** How the key is written in the list. */
  shown: string;
  doc: string;
  group: 'Picture' | 'Camera' | 'Render';
  /** Whether an event is this key. */
  is(event: KeyboardEvent): boolean;
  act(event: KeyboardEvent): void;
}

/** What the pointer does, for the list. */
const POINTER: [string, string][] = [
  ['Drag, middle drag', 'orbit'],
  ['Shift + drag', 'pan the camera'],
  ['Wheel', 'dolly'],
  ['Ctrl + wheel', 'zoom the picture'],
  ['Ctrl + drag', 'move the picture'],
  ['Click', 'pin a pixel, select the object'],
  ['One finger', 'orbit'],
  ['Two fingers', 'pan and dolly'],
  ['W A S D Q E, mouse', 'fly, once started; Shift is faster, the wheel changes the speed, Escape ends'],
];

/** A plain key, by the character it writes. */
export const character =
  (...keys: string[]) =>
  (event: KeyboardEvent) =>
    !event.ctrlKey && !event.metaKey && !event.altKey && keys.includes(event.key);

/** A key by its place, whatever else is held but Alt. */
export const place =
  (...codes: string[]) =>
  (event: KeyboardEvent) =>
    !event.altKey && codes.includes(event.code);

/** Whether what has the focus wants the keys for itself. */
function isTyping(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement) return !['checkbox', 'range', 'color'].includes(target.type);
  return target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement;
}

export class Keys {
  readonly help: HTMLDialogElement;

  /** `pointer` is what the pointer does, for the list. */
  constructor(
    private readonly keys: Key[],
    pointer = POINTER,
  ) {
    const rows = (list: [string, string][]) => list.map(([key, doc]) => h('div', {}, h('dt', {}, h('kbd', {}, key)), h('dd', {}, doc)));
    const groups = (['Picture', 'Camera', 'Render'] as const).flatMap((group) => {
      const list = keys.filter((k) => k.group === group).map((k): [string, string] => [k.shown, k.doc]);
      return list.length === 0 ? [] : h('section', {}, h('h3', {}, group), h('dl', {}, ...rows(list)));
    });
    const close = h('button', { onclick: () => this.help.close(), 'aria-label': 'Close' }, 'Close');
    this.help = h(
      'dialog',
      { class: 'help', 'aria-labelledby': 'help-title' },
      h('header', {}, h('h2', { id: 'help-title' }, 'Keys and pointer'), close),
      h('div', { class: 'columns' }, h('section', {}, h('h3', {}, 'Pointer'), h('dl', {}, ...rows(pointer))), ...groups),
    );
    this.help.addEventListener('click', (event) => event.target === this.help && this.help.close());
    addEventListener('keydown', (event) => this.press(event));
  }

  toggle(): void {
    if (this.help.open) this.help.close();
    else this.help.showModal();
  }

  private press(event: KeyboardEvent): void {
    if (event.defaultPrevented || isTyping(event.target) || (this.help.open && event.key !== '?')) return;
    // Arrows move sliders.
    if (event.target instanceof HTMLInputElement && /^(Arrow|Page|Home|End)/.test(event.key)) return;
    const key = this.keys.find((k) => k.is(event));
    if (!key) return;
    event.preventDefault();
    key.act(event);
  }
}
