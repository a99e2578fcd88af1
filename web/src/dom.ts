/** Elements without a framework. */

type Child = Node | string | null;
type Attributes = Record<string, string | number | boolean | ((event: Event) => void) | null | undefined>;

/** An element with attributes (functions are listeners: `onclick`) and children. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, String(value));
  }
  element.append(...children.filter((c): c is Node | string => c !== null));
  return element;
}

/** Sets a property only where it changes, so that nothing under the user's hands is disturbed. */
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** Sets what a field shows, unless the user is typing there or holds it. */
export function setValue(field: HTMLInputElement | HTMLSelectElement, value: string): void {
  if (field.dataset.editing === undefined && field.value !== value) field.value = value;
}

/** Keeps track of the field that is being edited. */
export function trackEditing(): void {
  const ends = ({ target }: Event) => target instanceof HTMLElement && delete target.dataset.editing;
  document.addEventListener('input', ({ target }) => target instanceof HTMLInputElement && (target.dataset.editing = ''), true);
  document.addEventListener('change', ends, true);
  document.addEventListener('focusout', ends, true);
}

/** What choices have. */
const shownOptions = new WeakMap<HTMLSelectElement, string>();

/** The options of a choice; the same ones are kept. */
export function setOptions(select: HTMLSelectElement, options: { value: string; text?: string; title?: string }[]): void {
  const key = JSON.stringify(options);
  if (shownOptions.get(select) === key) return;
  shownOptions.set(select, key);
  select.replaceChildren(...options.map((o) => h('option', { value: o.value, title: o.title }, o.text ?? o.value)));
}

/** Whether a button that stays pressed is. */
export const isPressed = (button: HTMLElement): boolean => button.getAttribute('aria-pressed') === 'true';

export const setPressed = (button: HTMLElement, on: boolean): void => button.setAttribute('aria-pressed', String(on));

/** A section that folds. */
export function section(title: string, open: boolean, ...children: Child[]): HTMLDetailsElement {
  return h('details', { class: 'section', open }, h('summary', {}, h('h2', {}, title)), h('div', { class: 'body' }, ...children));
}

/** A field with its label at the left. */
export function row(label: string, field: HTMLElement, title?: string): HTMLLabelElement {
  return h('label', { class: 'row', title }, h('span', {}, label), field);
}

/** A number for people: about four digits. */
export function show(v: number): string {
  if (!Number.isFinite(v)) return String(v);
  const a = Math.abs(v);
  if (a === 0) return '0';
  return a >= 1e6 || a < 1e-3 ? Number(v.toPrecision(3)).toExponential() : String(Number(v.toPrecision(4)));
}
