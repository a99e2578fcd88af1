/** Panel "Light groups": how bright, and of which colour, each group of lights is shown. Only the switch asks for a render. */

import { linearOf } from './color';
import { h, isPressed, row, section, setPressed, setText } from './dom';
import { MOST_GROUPS } from './groups';
import { numberField } from './number';
import type { FrameEnd, PageMessage, State } from './protocol';
import type { View } from './view';

/** Stops by which a group is brightened or dimmed at most. */
const STOPS = 6;
const WHITE = '#ffffff';
const ABOUT = 'Renders the light of each lamp, or of lamps of the same name, apart. What they add up to is then mixed without a render.';
const KEPT = 'The mix is of this page: previews, B and saved files are without it; an EXR has a layer for each group.';

/** A group in the mixer. */
class Strip {
  readonly element: HTMLElement;
  stops = 0;
  readonly mute: HTMLButtonElement;
  readonly solo: HTMLButtonElement;
  readonly color: HTMLInputElement;
  private readonly field;

  constructor(name: string, changed: () => void) {
    this.field = numberField({
      label: `${name}: intensity in EV`,
      value: 0,
      range: [-STOPS, STOPS],
      slider: [-STOPS, STOPS],
      step: 0.1,
      unit: 'EV',
      change: (v) => {
        this.stops = v;
        changed();
      },
    });
    const toggle = (letter: string, what: string, title: string) => {
      const press = () => {
        setPressed(button, !isPressed(button));
        changed();
      };
      const attributes = { class: 'small', title, 'aria-label': `${name}: ${what}`, 'aria-pressed': 'false', onclick: press };
      const button = h('button', attributes, letter);
      return button;
    };
    this.mute = toggle('M', 'mute', 'Mute: put this group out');
    this.solo = toggle('S', 'solo', 'Solo: put all groups out that are not solo');
    this.color = h('input', {
      type: 'color',
      value: WHITE,
      title: 'Colour that the light is multiplied by',
      'aria-label': `${name}: colour`,
      oninput: changed,
    });
    const head = h('div', { class: 'strip-head' }, h('span', { class: 'id', title: name }, name), this.color, this.mute, this.solo);
    this.element = h('div', { class: 'strip' }, head, this.field.element);
  }

  reset(): void {
    this.stops = 0;
    this.field.set(0);
    this.color.value = WHITE;
    for (const button of [this.mute, this.solo]) setPressed(button, false);
  }
}

export class Mixer {
  readonly element: HTMLElement;
  private readonly on: HTMLInputElement;
  private readonly facts = h('p', { class: 'facts' }, ABOUT);
  private readonly list = h('div', { role: 'group', 'aria-label': 'Mixer' });
  private readonly buttons = h('div', { class: 'buttons' }, h('button', { onclick: () => this.reset() }, 'Reset mix'));
  /** Those that were there before keep their places. */
  private readonly strips = new Map<string, Strip>();
  private names: string[] = [];
  /** Of which scene. */
  private scene = '';

  constructor(
    private readonly view: View,
    send: (message: PageMessage) => boolean,
    private readonly changed: () => void,
  ) {
    this.on = h('input', { type: 'checkbox', onchange: () => send({ type: 'settings', lightGroups: this.on.checked }) });
    this.element = section('Light groups', false, row('Mix', this.on, ABOUT), this.facts, this.list, this.buttons);
  }

  update({ scene, settings }: State): void {
    const isOn = settings.lightGroups;
    const of = `${scene.path} ${scene.name}`;
    if (of !== this.scene) {
      this.scene = of;
      this.names = [];
      this.strips.clear();
    }
    this.element.hidden = scene.lights === 0;
    this.on.checked = isOn;
    if (!isOn) {
      this.view.groups.clear();
      this.names = [];
      this.list.replaceChildren();
    }
    this.buttons.hidden = this.names.length === 0;
    setText(this.facts, isOn ? KEPT : ABOUT);
  }

  /** Shows the groups of a frame; of one that came without, those stay that were there. */
  takeFrame({ lightGroups }: FrameEnd): void {
    const isSame = lightGroups.length === this.names.length && lightGroups.every((name, g) => name === this.names[g]);
    if (lightGroups.length === 0 || isSame) return;
    this.names = lightGroups;
    const strips = lightGroups.map((name) => {
      const strip = this.strips.get(name) ?? new Strip(name, () => this.mix());
      this.strips.set(name, strip);
      return strip.element;
    });
    this.list.replaceChildren(...strips);
    this.buttons.hidden = false;
    this.mix();
  }

  private reset(): void {
    for (const strip of this.strips.values()) strip.reset();
    this.mix();
  }

  private mix(): void {
    const strips = this.names.map((name) => this.strips.get(name)!);
    const someSolo = strips.some((s) => isPressed(s.solo));
    const weights = new Float32Array(3 * MOST_GROUPS);
    strips.forEach((s, g) => {
      if (isPressed(s.mute) || (someSolo && !isPressed(s.solo))) return;
      weights.set(
        linearOf(s.color.value).map((v) => v * 2 ** s.stops),
        3 * g,
      );
    });
    this.view.mix(weights);
    this.changed();
  }
}
