/** Fields for numbers: one to type in, with a slider where a range is known. */

import { h, setValue } from './dom';

export interface NumberField {
  element: HTMLElement;
  set(value: number): void;
}

/** Ends; `null` for one that is infinite. */
type Range = [number | null, number | null];

export interface NumberOptions {
  label: string;
  value: number;
  range: Range | null;
  whole?: boolean;
  unit?: string;
  /** Ends of the slider, where they are narrower than the range. */
  slider?: [number, number];
  step?: number;
  /** Called with each new value within the range; `done` is false while a slider is held. */
  change(value: number, done: boolean): void;
}

/** Wider ranges than this, from above zero, slide by their logarithm. */
const WIDE = 1000;

/** Wider ranges than this have no slider. */
const MOST = 1e4;

export function numberField(options: NumberOptions): NumberField {
  const { label, range, whole = false, unit = '', change } = options;
  const [low, high] = (options.slider ?? range ?? []).map((v) => v ?? NaN) as [number, number] | [];
  const ends = low !== undefined && high !== undefined && low < high && high - low <= MOST ? ([low, high] as const) : null;
  const isLog = ends !== null && ends[0] > 0 && ends[1] / ends[0] >= WIDE;
  const place = (v: number) => (isLog ? Math.log(v) : v);
  const value = (p: number) => {
    const v = isLog ? Math.exp(p) : p;
    return whole ? Math.round(v) : Number(v.toPrecision(6));
  };
  const field = h('input', {
    type: 'number',
    class: 'number',
    step: whole ? 1 : 'any',
    min: range && Number.isFinite(range[0]) ? range[0] : null,
    max: range && Number.isFinite(range[1]) ? range[1] : null,
    'aria-label': label,
    required: true,
    onchange: () => {
      if (field.checkValidity()) take(field.valueAsNumber, true);
      else field.reportValidity();
    },
  });
  const slider = !ends
    ? null
    : h('input', {
        type: 'range',
        min: place(ends[0]),
        max: place(ends[1]),
        step: whole && !isLog ? 1 : (options.step ?? (place(ends[1]) - place(ends[0])) / 500),
        'aria-label': `${label}, slider`,
        oninput: () => slide(false),
        onchange: () => slide(true),
      });
  function slide(done: boolean): void {
    const v = value(Number(slider!.value));
    setValue(field, String(v));
    change(v, done);
  }
  function take(v: number, done: boolean): void {
    if (slider) setValue(slider, String(place(v)));
    change(v, done);
  }
  function set(v: number): void {
    setValue(field, String(Number(v.toPrecision(7))));
    if (slider) setValue(slider, String(place(v)));
  }
  const element = h('span', { class: slider ? 'slide' : 'plain' }, slider, field, unit ? h('span', { class: 'unit' }, unit) : null);
  set(options.value);
  return { element, set };
}
