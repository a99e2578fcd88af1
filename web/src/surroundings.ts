/** Panel "Surroundings": light, ground and background of a model or glTF scene, and the moment of its animation. */

import { h, row, section, setOptions, setPressed, isPressed, setValue, show } from './dom';
import { numberField } from './number';
import type { PageMessage, State, Surroundings } from './protocol';

/** Frames of a second while an animation plays. */
const RATE = 24;
/** The colour that a background of one begins with. */
const BACKGROUND = '#ffffff';

/** Words of the ground, by "" where the scene has it as usual. */
const GROUNDS = [
  { value: '', text: 'usual' },
  { value: 'true', text: 'grey' },
  { value: 'shadow', text: 'its shadow alone' },
  { value: 'false', text: 'none' },
];

export class SurroundingsPanel {
  readonly element: HTMLElement;
  private readonly sky = this.choice('sky', 'Sky');
  private readonly background = h('select', { 'aria-label': 'Background', onchange: () => this.setBackground(this.background.value) });
  private readonly color = h('input', {
    type: 'color',
    value: BACKGROUND,
    'aria-label': 'Colour of the background',
    onchange: () => this.define('background', this.color.value),
  });
  private readonly turn = numberField({
    label: 'Turn of the sky in degrees',
    value: 0,
    range: [-360, 360],
    slider: [-180, 180],
    step: 1,
    unit: '°',
    change: (v, done) => this.define('turn', v === 0 ? null : String(v), !done),
  });
  private readonly strength = numberField({
    label: 'Strength of the sky',
    value: 1,
    range: [0, 1e6],
    slider: [0.01, 100],
    change: (v, done) => this.define('strength', v === 1 ? null : String(v), !done),
  });
  private readonly ground = this.choice('ground', 'Ground');
  private readonly material = this.choice('material', 'Material of all');
  private readonly materialRow = row('Material', this.material, 'A finish for a model, in place of its own materials');
  private readonly animation = this.choice('animation', 'Animation');
  private readonly time = h('input', { type: 'range', step: 0.001, 'aria-label': 'Time in seconds' });
  private readonly seconds = h('output', {});
  private readonly play = h(
    'button',
    { class: 'small', 'aria-pressed': 'false', onclick: () => this.setPlaying(!isPressed(this.play)) },
    'Play',
  );
  private readonly moment = h(
    'div',
    {},
    row('Animation', this.animation),
    row('Time', this.time),
    h('div', { class: 'buttons' }, this.play, this.seconds),
  );
  /** Edited scenes are saved in a form that has a camera of its own: there is no turntable of those. */
  private readonly copyFilm = h('button', { onclick: () => void this.copy(this.film()) }, 'Copy turntable command');
  private surroundings: Surroundings | null = null;
  private command = '';
  private sentAt: number | null = null;
  private began = 0;

  constructor(
    private readonly send: (message: PageMessage) => boolean,
    private readonly copy: (text: string) => Promise<void>,
  ) {
    this.time.addEventListener('input', () => this.pose(this.time.valueAsNumber, true));
    this.time.addEventListener('change', () => this.pose(this.time.valueAsNumber, false));
    this.element = section(
      'Surroundings',
      false,
      row('Sky', this.sky, 'Light from all sides; a dropped picture takes its place'),
      row('Turn', this.turn.element, 'The sky, turned to the right'),
      row('Strength', this.strength.element, 'Factor on the light of the sky'),
      row('Ground', this.ground),
      row('Background', h('span', { class: 'plain' }, this.background, this.color), 'Behind the scene; the light stays that of the sky'),
      this.materialRow,
      this.moment,
      h('div', { class: 'buttons' }, this.copyFilm),
    );
  }

  update(state: State): void {
    const { surroundings } = state;
    this.surroundings = surroundings;
    this.element.hidden = surroundings === null;
    this.command = state.command;
    this.copyFilm.disabled = state.undo > 0;
    if (!surroundings) return this.setPlaying(false);
    const { defines, skies, backgrounds, finishes, animations } = surroundings;
    setOptions(this.sky, [{ value: '', text: 'usual' }, ...withOwn(skies, defines['sky'])]);
    setValue(this.sky, defines['sky'] ?? '');
    this.turn.set(Number(defines['turn'] ?? 0));
    this.strength.set(Number(defines['strength'] ?? 1));
    setOptions(this.ground, GROUNDS);
    setValue(this.ground, defines['ground'] ?? '');
    const isColor = defines['background'] !== undefined && !backgrounds.includes(defines['background']);
    setOptions(this.background, [...backgrounds.map((value) => ({ value })), { value: 'colour' }]);
    setValue(this.background, isColor ? 'colour' : (defines['background'] ?? 'sky'));
    this.color.hidden = !isColor;
    if (isColor && defines['background']!.startsWith('#')) setValue(this.color, defines['background']!);
    this.materialRow.hidden = finishes.length === 0;
    setOptions(this.material, [{ value: '', text: 'its own' }, ...withOwn(finishes, defines['material'])]);
    setValue(this.material, defines['material'] ?? '');
    this.moment.hidden = animations.length === 0;
    const names = animations.map((a, i) => ({ value: i === 0 ? '' : (a.name ?? String(i)), text: a.name ?? `animation ${i}` }));
    setOptions(this.animation, names);
    setValue(this.animation, defines['animation'] ?? '');
    const [from, to] = this.times();
    Object.assign(this.time, { min: String(from), max: String(to) });
    const at = Number(defines['at'] ?? from);
    if (!isPressed(this.play)) setValue(this.time, String(at));
    this.seconds.textContent = `${show(at)} s`;
  }

  /** A picture came: the next moment may be asked for. */
  frame(): void {
    if (this.sentAt === null || !isPressed(this.play)) return;
    const next = Math.max(0, this.sentAt + 1000 / RATE - performance.now());
    this.sentAt = null;
    window.setTimeout(() => this.step(), next);
  }

  private setPlaying(on: boolean): void {
    if (on === isPressed(this.play)) return;
    setPressed(this.play, on);
    this.play.textContent = on ? 'Stop' : 'Play';
    if (!on) {
      this.sentAt = null;
      if (this.surroundings) this.pose(this.time.valueAsNumber, false);
      return;
    }
    const [from, to] = this.times();
    const at = this.time.valueAsNumber;
    this.began = performance.now() - 1000 * (at < to ? at - from : 0);
    this.step();
  }

  /** The moment that plays now: the animation is repeated. */
  private step(): void {
    if (!isPressed(this.play)) return;
    const [from, to] = this.times();
    const length = Math.max(to - from, 1 / RATE);
    const at = from + (((performance.now() - this.began) / 1000) % length);
    this.time.value = String(at);
    this.sentAt = performance.now();
    this.pose(this.time.valueAsNumber, true);
  }

  private pose(at: number, moving: boolean): void {
    this.seconds.textContent = `${show(at)} s`;
    this.define('at', String(at), moving);
  }

  /** Times of the first and last key frame of the animation. */
  private times(): [number, number] {
    const { animations = [], defines = {} } = this.surroundings ?? {};
    const named = animations.find((a, i) => (a.name ?? String(i)) === defines['animation']);
    return (named ?? animations[0])?.times ?? [0, 0];
  }

  private setBackground(word: string): void {
    this.define('background', word === 'colour' ? this.color.value : word === 'sky' ? null : word);
  }

  private choice(name: string, label: string): HTMLSelectElement {
    const select = h('select', { 'aria-label': label, onchange: () => this.define(name, select.value || null) });
    return select;
  }

  private define(name: string, value: string | null, moving = false): void {
    this.send({ type: 'define', name, value, moving });
  }

  /** The command of a film of the scene that turns once, which places the camera and shows one moment. */
  private film(): string {
    const still = this.command.replace(/ (--look-at|--camera) ('[^']*'|\S+)/g, '').replace(/ -D at=\S+/, '');
    return `${still} --turntable 96 -o turntable.gif`;
  }
}

/** Words, and the one that the program was started with. */
function withOwn(words: readonly string[], own: string | undefined): { value: string }[] {
  return [...words, ...(own === undefined || words.includes(own) ? [] : [own])].map((value) => ({ value }));
}
