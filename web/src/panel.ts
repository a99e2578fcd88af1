/** Panels "Render" and "Camera": what the server is asked to render. */

import { Bookmarks } from './bookmarks';
import { h, row, section, setOptions, setValue, show } from './dom';
import { numberField } from './number';
import type { PageMessage, SettingsChange, State } from './protocol';

type Send = (message: PageMessage) => boolean;

/** A field for a whole number of the settings; empty for none where `optional`. */
function whole(label: string, low: number, optional: boolean, change: (v: number | null) => void): HTMLInputElement {
  const field = h('input', {
    type: 'number',
    class: 'number',
    min: low,
    step: 1,
    required: !optional,
    'aria-label': label,
    placeholder: optional ? 'default' : null,
    onchange: () => {
      if (field.checkValidity()) change(field.value === '' ? null : field.valueAsNumber);
      else field.reportValidity();
    },
  });
  return field;
}

type Choice = 'integrator' | 'sampler' | 'color' | 'denoise';

export class RenderPanel {
  readonly element: HTMLElement;
  private readonly choices: Record<Choice, HTMLSelectElement>;
  private readonly spp;
  private readonly seed;
  private readonly depth;
  private readonly width;
  private readonly height;

  constructor(private readonly send: Send) {
    const set = (change: SettingsChange) => this.send({ type: 'settings', ...change });
    const choice = (key: Choice, label: string) => {
      const select = h('select', { 'aria-label': label, onchange: () => set({ [key]: select.value || null }) });
      return select;
    };
    this.choices = {
      integrator: choice('integrator', 'Integrator'),
      sampler: choice('sampler', 'Sampler'),
      color: choice('color', 'Colour'),
      denoise: choice('denoise', 'Denoise'),
    };
    this.spp = whole('Samples per pixel', 1, false, (v) => set({ spp: v! }));
    this.seed = whole('Seed', 0, true, (v) => set({ seed: v }));
    this.depth = whole('Most bounces', 0, true, (v) => set({ maxDepth: v }));
    this.width = whole('Width in pixels', 1, false, () => set(this.size()));
    this.height = whole('Height in pixels', 1, false, () => set(this.size()));
    const size = h('span', { class: 'plain' }, this.width, '×', this.height);
    this.element = section(
      'Render',
      true,
      row('Integrator', this.choices.integrator),
      row('Samples', this.spp, 'Samples for each pixel'),
      row('Sampler', this.choices.sampler),
      row('Colour', this.choices.color),
      h('div', { class: 'row' }, h('span', {}, 'Size'), size),
      row('Seed', this.seed),
      row('Max depth', this.depth, 'Bounces at most'),
      row('Denoise', this.choices.denoise),
    );
  }

  update({ settings, choices, film }: State): void {
    const named = (list: { name: string; doc: string }[]) => list.map((c) => ({ value: c.name, title: c.doc }));
    // What holds may be the scene's own, or have parameters.
    const { integrator } = settings;
    const isListed = choices.integrators.some((c) => c.name === integrator);
    const own = isListed ? [] : [{ value: integrator, text: integrator || 'the scene’s' }];
    setOptions(this.choices.integrator, [...own, ...named(choices.integrators)]);
    setOptions(this.choices.sampler, [{ value: '', text: 'automatic' }, ...named(choices.samplers)]);
    setOptions(
      this.choices.color,
      choices.colors.map((value) => ({ value })),
    );
    setOptions(this.choices.denoise, [{ value: '', text: 'no' }, ...named(choices.denoisers)]);
    for (const key of ['integrator', 'sampler', 'color', 'denoise'] as const) {
      const select = this.choices[key];
      setValue(select, settings[key] ?? '');
      select.title = select.selectedOptions[0]?.title ?? '';
    }
    setValue(this.spp, String(settings.spp));
    setValue(this.seed, settings.seed === null ? '' : String(settings.seed));
    setValue(this.depth, settings.maxDepth === null ? '' : String(settings.maxDepth));
    setValue(this.width, String(film.width));
    setValue(this.height, String(film.height));
  }

  private size(): { width: number; height: number } {
    return { width: this.width.valueAsNumber, height: this.height.valueAsNumber };
  }
}

export type Side = 'front' | 'right' | 'top';

export interface CameraActions {
  from(side: Side): void;
  fly(): void;
  fov(degrees: number, done: boolean): void;
}

export class CameraPanel {
  readonly element: HTMLElement;
  private readonly names = h('select', {
    'aria-label': 'Camera',
    onchange: () => this.send({ type: 'camera-name', name: this.names.value }),
  });
  private readonly nameRow = row('Camera', this.names);
  private readonly facts = h('p', { class: 'facts' });
  private readonly buttons: HTMLButtonElement[];
  private readonly fovRow;
  private readonly fov;
  private readonly bookmarks;

  constructor(
    private readonly send: Send,
    actions: CameraActions,
  ) {
    const button = (text: string, title: string, act: () => void) => h('button', { title, onclick: act }, text);
    this.buttons = [
      button('Reset', 'Back to the scene’s camera (Home)', () => this.send({ type: 'camera-reset' })),
      button('Front', 'From the front (Numpad 1)', () => actions.from('front')),
      button('Right', 'From the right (Numpad 3)', () => actions.from('right')),
      button('Top', 'From above (Numpad 7)', () => actions.from('top')),
      button('Fly', 'Fly with W A S D Q E and the mouse (Shift+`)', () => actions.fly()),
    ];
    this.fov = numberField({
      label: 'Angle of view',
      value: 50,
      range: [0.01, 179],
      slider: [5, 150],
      step: 0.5,
      unit: '°',
      change: actions.fov,
    });
    this.fovRow = row('Angle of view', this.fov.element);
    this.bookmarks = new Bookmarks(send);
    const buttons = h('div', { class: 'buttons' }, ...this.buttons);
    this.element = section('Camera', false, this.nameRow, this.fovRow, buttons, this.bookmarks.element, this.facts);
  }

  update({ camera, scene }: State): void {
    this.bookmarks.update(scene.path ?? scene.name, camera);
    this.nameRow.hidden = camera.names.length < 2;
    setOptions(
      this.names,
      camera.names.map((value) => ({ value })),
    );
    if (camera.name !== null) setValue(this.names, camera.name);
    for (const button of this.buttons) button.disabled = !camera.movable;
    this.buttons[0]!.disabled = !camera.moved;
    this.fovRow.hidden = camera.fov === null || !camera.movable;
    if (camera.fov !== null) this.fov.set(camera.fov);
    const place = (v: number[]) => v.map(show).join(', ');
    const fixed = camera.movable ? '' : '; it cannot be moved here';
    this.facts.textContent = `${camera.kind}, from ${place(camera.eye)} to ${place(camera.target)}${fixed}`;
  }
}
