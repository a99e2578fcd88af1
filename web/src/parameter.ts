/** A field for a node's parameter, by its type and value. */

import { hexOf, linearOf } from './color';
import { h, setValue } from './dom';
import { numberField } from './number';
import { placeOf } from './place';
import { placeField } from './placefield';
import type { ParameterState } from './protocol';

export interface Field {
  element: HTMLElement;
  /** What kind of field it is; another kind needs another field. */
  kind: string;
  set(parameter: ParameterState): void;
}

/** Called with the new value in Steradian's language; `null` for what holds when nothing is given. */
export type Edit = (value: string | null, done: boolean) => void;

const NUMBER = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i;

/** The three numbers of a text, `[r, g, b]` or `{rgb: [r, g, b]}`, or `null`. */
function triple(text: string): number[] | null {
  const parts = /^(?:\{rgb: )?\[([^[\]{}]*)\]\}?$/
    .exec(text.trim())?.[1]
    ?.split(',')
    .map((p) => p.trim());
  return parts?.length === 3 && parts.every((p) => NUMBER.test(p)) ? parts.map(Number) : null;
}

/** What holds; of a default without what is said of exceptions. */
const current = (p: ParameterState) => p.value ?? p.default.split(';')[0] ?? '';

export function kindOf(p: ParameterState): string {
  const text = current(p);
  if (p.type.startsWith('true or false')) return 'flag';
  if (p.words.length > 0 && (p.value === null || p.words.includes(p.value))) return 'word';
  if (/spectrum/.test(p.type) && triple(text)) return 'color';
  if (/^(whole )?number/.test(p.type) && NUMBER.test(text)) return 'number';
  if (p.type === 'transform' && placeOf(text)) return 'place';
  return 'text';
}

export function parameterField(p: ParameterState, label: string, edit: Edit): Field {
  const kind = kindOf(p);
  const make = { flag, word, color, number, place, text }[kind]!;
  return { kind, ...make(p, label, edit) };
}

type Made = Omit<Field, 'kind'>;

function flag(p: ParameterState, label: string, edit: Edit): Made {
  const box = h('input', { type: 'checkbox', 'aria-label': label, onchange: () => edit(String(box.checked), true) });
  const set = (p: ParameterState) => void (box.checked = current(p) === 'true');
  set(p);
  return { element: box, set };
}

function word(p: ParameterState, label: string, edit: Edit): Made {
  const own = p.words.includes(current({ ...p, value: null })) ? [] : [h('option', { value: '' }, p.default || '–')];
  const options = p.words.map((w) => h('option', { value: w }, w));
  const select = h('select', { 'aria-label': label, onchange: () => edit(select.value || null, true) }, ...own, ...options);
  const set = (p: ParameterState) => setValue(select, p.words.includes(current(p)) ? current(p) : '');
  set(p);
  return { element: select, set };
}

function number(p: ParameterState, label: string, edit: Edit): Made {
  const field = numberField({
    label,
    value: Number(current(p)),
    range: p.range,
    whole: p.type.startsWith('whole'),
    unit: p.unit,
    change: (v, done) => edit(String(v), done),
  });
  const set = (p: ParameterState) => {
    field.set(Number(current(p)));
    if (picker) setValue(picker, hexOf([1, 1, 1].map((v) => v * Number(current(p)))));
  };
  // Where a spectrum may be, the grey may become a colour.
  const isColorful = /spectrum/.test(p.type) && p.unit === '' && p.range?.[0] === 0 && p.range[1] === 1;
  const send = (picker: HTMLInputElement) => edit(`[${linearOf(picker.value).join(', ')}]`, true);
  const picker = !isColorful ? null : h('input', { type: 'color', 'aria-label': `${label}, colour`, onchange: () => send(picker!) });
  if (picker) field.element.prepend(picker);
  set(p);
  return { element: field.element, set };
}

function color(p: ParameterState, label: string, edit: Edit): Made {
  const send = (rgb: number[], done: boolean) => edit(`[${rgb.join(', ')}]`, done);
  const take = (done: boolean) => {
    const rgb = linearOf(picker.value);
    fields.forEach((f, i) => (f.value = String(rgb[i])));
    send(rgb, done);
  };
  const picker = h('input', { type: 'color', 'aria-label': label, oninput: () => take(false), onchange: () => take(true) });
  const fields = ['red', 'green', 'blue'].map((name) =>
    h('input', {
      type: 'number',
      class: 'number',
      step: 'any',
      required: true,
      'aria-label': `${label}, ${name}`,
      onchange: () => {
        const rgb = fields.map((f) => f.valueAsNumber);
        if (!rgb.every(Number.isFinite)) return;
        picker.value = hexOf(rgb);
        send(rgb, true);
      },
    }),
  );
  const set = (p: ParameterState) => {
    const rgb = triple(current(p))!;
    setValue(picker, hexOf(rgb));
    fields.forEach((f, i) => setValue(f, String(rgb[i])));
  };
  set(p);
  return { element: h('span', { class: 'color' }, picker, ...fields), set };
}

function place(p: ParameterState, label: string, edit: Edit): Made {
  const field = placeField(label, current(p), edit);
  return { element: field.element, set: (p) => field.set(current(p)) };
}

function text(p: ParameterState, label: string, edit: Edit): Made {
  const field = h('input', {
    type: 'text',
    spellcheck: 'false',
    'aria-label': label,
    onchange: () => edit(field.value.trim() || null, true),
  });
  const set = (p: ParameterState) => {
    setValue(field, p.value ?? '');
    field.placeholder = p.default;
  };
  set(p);
  return { element: field, set };
}
