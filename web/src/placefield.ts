/** A field for a transform: location, rotation and scale, each number to be typed, or dragged by its letter. */

import { h, setValue } from './dom';
import { placeOf, textOf, type Place } from './place';
import type { Vec3 } from './vector';

const PARTS = ['location', 'rotation', 'scale'] as const;
const AXES = ['x', 'y', 'z'] as const;

export interface PlaceField {
  element: HTMLElement;
  set(text: string): void;
}

/** `change` is called with each new place in Steradian's language; `done` is false while a number is dragged. */
export function placeField(label: string, text: string, change: (text: string, done: boolean) => void): PlaceField {
  let place = placeOf(text)!;

  /** By how much a pixel of dragging changes a number. */
  function step(part: (typeof PARTS)[number], axis: number): number {
    if (part === 'rotation') return 0.5;
    if (part === 'scale') return Math.abs(place.scale[axis]!) / 200;
    return Math.max(Math.hypot(...place.location), Math.hypot(...place.scale), 1e-3) / 300;
  }

  function take(part: (typeof PARTS)[number], axis: number, value: number, done: boolean): void {
    const changed = [...place[part]] as Vec3;
    changed[axis] = value;
    // What has no size is nowhere.
    if (!Number.isFinite(value) || (part === 'scale' && value === 0)) return show();
    place = { ...place, [part]: changed };
    show();
    change(textOf(place), done);
  }

  function number(part: (typeof PARTS)[number], axis: number) {
    const name = AXES[axis]!;
    const field = h('input', {
      type: 'number',
      class: 'number',
      step: 'any',
      required: true,
      'aria-label': `${label}, ${part} ${name}`,
      onchange: () => (field.checkValidity() ? take(part, axis, field.valueAsNumber, true) : field.reportValidity()),
    });
    const handle = h('span', { class: `axis ${name}`, title: 'Drag to change', 'aria-hidden': 'true' }, name);
    handle.addEventListener('pointerdown', (down) => {
      if (down.button !== 0) return;
      down.preventDefault();
      handle.setPointerCapture(down.pointerId);
      const [from, by] = [place[part][axis]!, step(part, axis)];
      const at = (event: PointerEvent) => Number((from + by * (event.clientX - down.clientX)).toPrecision(6));
      const move = (event: PointerEvent) => take(part, axis, at(event), false);
      const end = (event: PointerEvent) => {
        handle.removeEventListener('pointermove', move);
        handle.removeEventListener('pointerup', end);
        handle.removeEventListener('pointercancel', end);
        if (event.clientX !== down.clientX) take(part, axis, at(event), true);
      };
      handle.addEventListener('pointermove', move);
      handle.addEventListener('pointerup', end);
      handle.addEventListener('pointercancel', end);
    });
    return { field, element: h('span', { class: 'axis-field' }, handle, field) };
  }

  const numbers = PARTS.map((part) => AXES.map((_, axis) => number(part, axis)));
  function show(): void {
    PARTS.forEach((part, i) => place[part].forEach((v, axis) => setValue(numbers[i]![axis]!.field, String(Number(v.toPrecision(7))))));
  }
  show();
  const rows = PARTS.map((part, i) =>
    h('div', { class: 'place-row' }, h('span', { class: 'part' }, part), ...numbers[i]!.map((n) => n.element)),
  );
  const set = (text: string) => {
    const now: Place | null = placeOf(text);
    if (now) place = now;
    show();
  };
  return { element: h('div', { class: 'place' }, ...rows), set };
}
