/** Panel "Error": how it falls as a render goes on, beside the renders before. */

import { Convergence, MOST_CURVES, relMse, type Curve, type Point } from './convergence';
import { h, row, section, show } from './dom';
import { plot, type Line } from './plot';
import type { FrameEnd, State } from './protocol';
import type { View } from './view';

type Axis = 'seconds' | 'samples';
/** Milliseconds between drawings. */
const PAUSE = 250;

export class Errors {
  readonly element: HTMLDetailsElement;
  private readonly convergence = new Convergence();
  private readonly axis = h(
    'select',
    { 'aria-label': 'Error against', onchange: () => this.draw() },
    ...['seconds', 'samples'].map((value) => h('option', { value }, value)),
  );
  private readonly place = h('div', { class: 'plots' });
  private readonly list = h('ul', { class: 'curves' });
  private readonly table = h('details', { class: 'numbers', ontoggle: () => this.fillTable() }, h('summary', {}, 'Table'));
  private state: State | null = null;
  private timer = 0;
  /** Which colour each curve has. */
  private readonly colors = new Map<Curve, number>();

  constructor(private readonly view: View) {
    this.element = section('Error', false, row('Against', this.axis), this.place, this.list, this.table);
    this.element.addEventListener('toggle', () => this.draw());
    this.draw();
  }

  takeState(state: State): void {
    this.state = state;
  }

  /** A frame that's shown now. */
  takeFrame(frame: FrameEnd): void {
    const taken = this.convergence.take(frame, this.state?.settings.integrator || 'the scene’s', () => this.toReference());
    if (taken && !this.timer) this.timer = window.setTimeout(() => this.draw(), PAUSE);
  }

  /** There is another B, or none. */
  changeReference(): void {
    this.convergence.forgetReference();
    this.draw();
  }

  private toReference(): number | null {
    const [picture, reference] = [this.view.layers.shown('picture'), this.view.others.shown('reference')];
    const found = picture && reference && relMse(picture, reference);
    return found === null ? null : Math.sqrt(found);
  }

  private draw(): void {
    clearTimeout(this.timer);
    this.timer = 0;
    if (!this.element.open) return;
    const { curves } = this.convergence;
    for (const curve of [...this.colors.keys()]) if (!curves.includes(curve)) this.colors.delete(curve);
    for (const curve of curves) {
      const used = [...this.colors.values()];
      if (!this.colors.has(curve)) this.colors.set(curve, [...Array(MOST_CURVES).keys()].find((c) => !used.includes(c)) ?? 0);
    }
    const axis = this.axis.value as Axis;
    const lines = curves.flatMap((curve) => this.lines(curve, axis));
    this.table.hidden = lines.length === 0;
    if (lines.length === 0) this.place.replaceChildren(h('p', { class: 'facts' }, 'A render of some frames is drawn here.'));
    else {
      const ends = lines.map((l) => `${l.label}: ${show(l.points.at(-1)![1])} at ${show(l.points.at(-1)![0])} ${axis}`);
      const about = `Both axes are logarithmic; the dotted line has the slope −1/2. ${ends.join('; ')}.`;
      const isMeasured = lines.some((l) => l.style.includes('measured'));
      const key = isMeasured ? 'Lines: the estimate. Dashes: the root of the relMSE to B. ' : '';
      this.place.replaceChildren(
        plot(`Relative error against ${axis}`, about, axis === 'samples' ? 'samples per pixel' : axis, lines),
        h('p', { class: 'facts' }, `${key}Dots: slope −1/2.`),
      );
    }
    this.list.replaceChildren(...curves.filter((c) => this.lines(c, axis).length > 0).map((curve) => this.item(curve)));
    this.fillTable();
  }

  /** The estimate, and the error to B where there is one. */
  private lines(curve: Curve, axis: Axis): Line[] {
    const color = `curve-${this.colors.get(curve)}`;
    const of = (key: 'error' | 'toReference', style: string, label: string): Line[] => {
      const points = curve.points.flatMap((p: Point): [number, number][] => {
        const v = p[key];
        return v !== null && v > 0 ? [[p[axis], v]] : [];
      });
      return points.length > 0 ? [{ style: `${color} ${style}`, label, points }] : [];
    };
    return [
      ...of('error', 'estimated', `${curve.label}, estimated`),
      ...of('toReference', 'measured', `${curve.label}, root of the relMSE to B`),
    ];
  }

  private item(curve: Curve): HTMLElement {
    const remove = () => {
      this.convergence.remove(curve);
      this.draw();
    };
    const name = `Remove the curve of ${curve.label}`;
    return h(
      'li',
      {},
      h('span', { class: `swatch curve-${this.colors.get(curve)}` }),
      h('span', { class: 'id' }, curve.label),
      h('button', { class: 'small', title: name, 'aria-label': name, onclick: remove }, '×'),
    );
  }

  private fillTable(): void {
    if (!this.table.open) return;
    const value = (v: number | null) => (v === null ? '–' : show(v));
    const head = ['render', 'seconds', 'spp', 'error', 'to B'].map((text) => h('th', { scope: 'col' }, text));
    const rows = this.convergence.curves.flatMap((curve) =>
      curve.points.map((p) =>
        h(
          'tr',
          {},
          h('th', { scope: 'row' }, curve.label),
          ...[p.seconds, p.samples, p.error, p.toReference].map((v) => h('td', {}, value(v))),
        ),
      ),
    );
    const table = h('table', { class: 'errors' }, h('thead', {}, h('tr', {}, ...head)), h('tbody', {}, ...rows));
    this.table.replaceChildren(this.table.firstElementChild!, table);
  }
}
