/** The path of one sample of the pinned pixel: what is asked for, and the table of its vertices. */

import { h, setPressed, setText, show } from './dom';
import { Drawing, isLit, MOST_NUMBERED } from './drawing';
import type { PathVertex, State, TracedPath } from './protocol';
import type { Vec3 } from './vector';

/** Samples of a pixel are numbered below this. */
const MOST_SAMPLES = 1 << 24;

const ENDS: Record<TracedPath['end'], string> = {
  escaped: 'leaves the scene',
  absorbed: 'absorbed',
  depth: 'greatest depth',
  roulette: 'Russian roulette',
  'not finite': 'not finite',
  'too long': 'too many vertices: the rest is left out',
};

export class Path {
  readonly element: HTMLElement;
  private readonly button: HTMLButtonElement;
  private readonly number = h('input', {
    class: 'number',
    type: 'number',
    min: 0,
    max: MOST_SAMPLES - 1,
    value: 0,
    'aria-label': 'Sample',
  });
  private readonly group: HTMLElement;
  private readonly facts = h('p', { class: 'facts', 'aria-live': 'polite' });
  private readonly table = h('div');
  private pixel: [number, number] | null = null;
  private sample = 0;
  private state: State | null = null;
  private on = false;

  /** `pin` pins a pixel where none is. */
  constructor(
    private readonly drawing: Drawing,
    private readonly pin: () => void,
  ) {
    this.button = h('button', { 'aria-pressed': 'false', title: 'Draw the path of one sample of the pinned pixel (T)' }, 'Path');
    this.button.addEventListener('click', () => this.toggle());
    const step = (by: number, text: string, name: string) =>
      h('button', { class: 'small', title: name, 'aria-label': name, onclick: () => this.go(this.sample + by) }, text);
    this.number.addEventListener('change', () => this.go(this.number.valueAsNumber));
    this.group = h(
      'div',
      { class: 'samples', role: 'group', 'aria-label': 'Sample of the pixel', hidden: true },
      h('span', { 'aria-hidden': 'true' }, 'Sample'),
      step(-1, '‹', 'Previous sample'),
      this.number,
      step(1, '›', 'Next sample'),
    );
    const bar = h('div', { class: 'path-bar' }, this.button, this.group);
    bar.addEventListener('keydown', (event) => this.press(event));
    this.element = h('div', { class: 'traced' }, bar, this.facts, this.table);
  }

  /** Whether clicks trace paths. */
  get isOn(): boolean {
    return this.on;
  }

  toggle(): void {
    this.on = !this.on;
    setPressed(this.button, this.on);
    this.group.hidden = !this.on;
    if (!this.on) return this.clear('');
    if (this.pixel) void this.ask();
    else this.pin();
  }

  /** The pinned pixel is another. */
  set(pixel: [number, number] | null): void {
    this.pixel = pixel;
    if (this.on && pixel) void this.ask();
    else if (this.on) this.clear('Click the picture to trace a pixel.');
  }

  /** What is rendered may be another. */
  update(state: State): void {
    const before = this.state;
    this.state = state;
    if (!this.on || !before || before.generation === state.generation) return;
    const seen = ({ camera: { eye, target, up, fov, name }, film }: State) => JSON.stringify([eye, target, up, fov, name, film]);
    if (seen(before) !== seen(state)) this.clear('The camera has moved: click the picture to trace a pixel.');
    else if (this.table.childElementCount) void this.ask();
  }

  private clear(why: string): void {
    this.drawing.show(null);
    this.table.replaceChildren();
    setText(this.facts, why);
  }

  private press(event: KeyboardEvent): void {
    const by = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!this.on || by === undefined) return;
    event.preventDefault();
    this.go(this.sample + by);
  }

  private go(sample: number): void {
    this.sample = Number.isFinite(sample) ? Math.min(Math.max(Math.round(sample), 0), MOST_SAMPLES - 1) : this.sample;
    this.number.value = String(this.sample);
    if (this.pixel) void this.ask();
  }

  private async ask(): Promise<void> {
    const { pixel, sample } = this;
    if (!pixel) return;
    const isAsked = () => this.on && this.pixel === pixel && this.sample === sample;
    try {
      const response = await fetch(`./api/path?x=${pixel[0]}&y=${pixel[1]}&sample=${sample}`);
      const body = (await response.json()) as TracedPath | { error: string };
      if (!isAsked()) return;
      if (!('vertices' in body)) this.clear(body.error ?? response.statusText);
      // One of before the camera moved comes too late.
      else if (!this.state || body.generation >= this.state.generation) this.fill(body);
    } catch {
      if (isAsked()) this.clear('no answer');
    }
  }

  private fill(path: TracedPath): void {
    this.drawing.show(path, this.state?.camera.kind.startsWith('spherical'));
    const last = path.vertices.length - 1;
    const whose = path.of_picture ? '' : ` The picture’s method has no such paths: this is one of the path tracer (${path.tracer}).`;
    setText(
      this.facts,
      `Pixel ${path.x}, ${path.y}: light ${triple(path.value)}; ${last} ${last === 1 ? 'vertex' : 'vertices'}, ends: ${ENDS[path.end]}.${whose}`,
    );
    const head = ['#', 'Vertex', 'Weight', 'Light'].map((name) => h('th', { scope: 'col' }, name));
    const rows = path.vertices.slice(0, MOST_NUMBERED + 1).map((v, k) => this.row(v, k));
    const more = last - MOST_NUMBERED;
    this.table.replaceChildren(
      h(
        'table',
        { class: 'vertices' },
        h('caption', { class: 'hidden' }, 'Vertices of the path'),
        h('thead', {}, h('tr', {}, ...head)),
        h('tbody', {}, ...rows),
      ),
      ...(more > 0 ? [h('p', { class: 'facts' }, `and ${more} more`)] : []),
    );
  }

  private row(v: PathVertex, index: number): HTMLElement {
    const light = v.emitted.map((e, c) => e + (v.direct?.light[c] ?? 0)) as Vec3;
    const sampled = v.direct && (isLit(v.direct.light) ? 'light sample' : 'light sample blocked');
    const lines = [v.object, v.material, v.event, isLit(v.emitted) ? 'emits' : null, sampled].filter((line) => line !== null);
    const row = h(
      'tr',
      { title: `at ${triple(v.position)}` },
      h('th', { scope: 'row' }, String(index)),
      h('td', {}, v.kind, ...lines.map((line) => h('span', {}, line))),
      values(v.weight),
      isLit(light) || v.direct ? values(light) : h('td', { class: 'rgb' }, '–'),
    );
    row.addEventListener('pointerenter', () => this.drawing.mark(index));
    row.addEventListener('pointerleave', () => this.drawing.mark(-1));
    return row;
  }
}

/** Red, green and blue below each other; one number where they are the same. */
function values(rgb: Vec3): HTMLElement {
  const isGrey = rgb[0] === rgb[1] && rgb[1] === rgb[2];
  return h('td', { class: 'rgb' }, ...(isGrey ? [rgb[0]] : rgb).map((v) => h('span', {}, number(v))));
}

/** JSON has no number that is not finite. */
const number = (v: number | null) => (v === null ? 'NaN' : show(Number(v.toPrecision(3))));
const triple = (rgb: Vec3) => rgb.map(number).join('  ');
