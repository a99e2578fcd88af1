/** Panel "View": exposure, tone curve with its parameters, layer, false colour. Nothing here asks for a render. */

import { h, row, section, setOptions, setValue, show } from './dom';
import { numberField, type NumberField } from './number';
import { averageStops, neededStops } from './exposure';
import type { Choices, Exposure, State } from './protocol';
import { CURVES, parseTone } from './tone';
import type { View } from './view';

/** Display in use, and the choices there are. */
export interface Shown extends Pick<State, 'exposure' | 'tone' | 'layers'> {
  choices: Pick<Choices, 'tones' | 'layers'>;
  scene: Pick<State['scene'], 'name' | 'path'>;
}

export class Look {
  readonly element: HTMLElement;
  private readonly exposure: NumberField;
  private readonly tone = h('select', { 'aria-label': 'Tone curve', onchange: () => this.choose(this.tone.value) });
  private readonly parameters = h('div');
  private readonly layer = h('select', { 'aria-label': 'Layer', onchange: () => this.chooseLayer(this.layer.value) });
  private readonly falseColor = h('input', { type: 'checkbox', onchange: () => this.setFalse(this.falseColor.checked) });
  private readonly mark = h('input', {
    type: 'checkbox',
    checked: true,
    onchange: () => this.set(() => (this.view.isMarked = this.mark.checked)),
  });
  private state: Shown | null = null;
  private scene = '';
  /** Exposure that the scene's first picture is to choose. */
  private awaited: Exposure = 'given';

  constructor(
    private readonly view: View,
    private readonly askLayers: (names: string[]) => void,
    private readonly changed: () => void,
  ) {
    this.exposure = numberField({
      label: 'Exposure in EV',
      value: 0,
      range: [-64, 64],
      slider: [-16, 16],
      step: 0.1,
      unit: 'EV',
      change: (v) => this.expose(v),
    });
    this.element = section(
      'View',
      true,
      row('Exposure', this.exposure.element, 'Powers of two; keys [ and ]'),
      h(
        'div',
        { class: 'buttons' },
        h('button', { title: 'What is lit becomes grey on average', onclick: () => this.exposeBy('auto') }, 'Expose by the picture'),
      ),
      row('Tone', this.tone),
      this.parameters,
      row('Layer', this.layer),
      row('False colour', this.falseColor, 'Luminance as a colour of viridis, on a logarithmic scale'),
      row('Mark NaN', this.mark, 'Pixels that are NaN or infinite become magenta'),
    );
  }

  update(state: Shown): void {
    const isFirst = this.state === null;
    this.state = state;
    const known = state.choices.tones.filter((t) => CURVES.includes(t.name));
    setOptions(
      this.tone,
      known.map((t) => ({ value: t.name, title: t.doc })),
    );
    const layers = state.choices.layers.filter((l) => l.name !== 'picture');
    setOptions(this.layer, [{ value: 'picture' }, ...layers.map((l) => ({ value: l.name, title: l.doc }))]);
    setValue(this.layer, this.view.layer);
    const { name, path } = state.scene;
    const scene = `${path ?? name}`;
    if (isFirst || scene !== this.scene) this.awaited = state.exposure;
    this.scene = scene;
    if (isFirst) {
      this.view.tone = parseTone(state.tone, state.choices.tones);
      this.exposure.set(this.view.tone.exposure);
      this.tone.value = this.view.tone.name;
      this.showParameters();
    }
    this.view.layers.keep(['picture', ...state.layers, this.view.layer]);
  }

  /** Takes a picture of the scene: the first one may choose the exposure. */
  takeFrame(): void {
    const { awaited } = this;
    if (awaited === 'given' || this.view.layer !== 'picture') return;
    this.awaited = 'given';
    this.exposeBy(awaited);
  }

  /** Exposes by the picture, or if that is `needed`. */
  private exposeBy(way: 'auto' | 'needed'): void {
    const found = this.view.statistics();
    const stops = found && (way === 'auto' ? averageStops(found) : neededStops(found));
    if (stops !== null) this.expose(stops);
  }

  expose(ev: number): void {
    this.awaited = 'given';
    const exposure = Math.min(Math.max(ev, -64), 64);
    this.exposure.set(exposure);
    this.set(() => (this.view.tone.exposure = exposure));
  }

  setFalse(on: boolean): void {
    this.falseColor.checked = on;
    this.set(() => (this.view.isFalse = on));
  }

  /** The next or previous layer. */
  stepLayer(by: number): void {
    const count = this.layer.options.length;
    if (count === 0) return;
    this.layer.selectedIndex = (this.layer.selectedIndex + by + count) % count;
    this.chooseLayer(this.layer.value);
  }

  private choose(name: string): void {
    const tone = parseTone(name, this.state?.choices.tones ?? []);
    this.set(() => (this.view.tone = { ...tone, exposure: this.view.tone.exposure }));
    this.showParameters();
  }

  private chooseLayer(name: string): void {
    this.set(() => (this.view.layer = name));
    if (this.state) this.askLayers(name === 'picture' ? [] : [name]);
  }

  private showParameters(): void {
    const choice = this.state?.choices.tones.find((t) => t.name === this.view.tone.name);
    this.parameters.replaceChildren(
      ...(choice?.parameters ?? []).map((p, i) => {
        const field = numberField({
          label: `${choice!.name}: ${p.name}`,
          value: this.view.tone.values[i] ?? p.default,
          range: p.range,
          slider: [Math.max(p.range[0], p.default / 100), Math.min(p.range[1], p.default * 100)],
          change: (v) => this.set(() => (this.view.tone.values[i] = v)),
        });
        return row(p.name, field.element, `${p.doc} (${show(p.range[0])} to ${show(p.range[1])}; ${show(p.default)} when not given)`);
      }),
    );
  }

  private set(change: () => void): void {
    change();
    this.view.redraw();
    this.changed();
  }
}
