/** Panel "Compare": the shown picture, A, beside B, in turn with it, minus it, or as a map of the differences one sees. */

import { Divider } from './divider';
import { h, row, section, setText, show } from './dom';
import { FlipMap } from './flipmap';
import { numberField } from './number';
import type { AboutReference, Figures, FrameEnd, Message, ToneChoice } from './protocol';
import type { Pieces } from './reference';
import { toneText } from './tone';
import type { Comparison, View } from './view';

/** Milliseconds that A and B are shown in turn. */
const TURN = 500;

/** Source of B. */
export interface Source {
  /** B with its tiles; `null` where there is none. */
  fetch(): Promise<Pieces<AboutReference> | null>;
  /** The map of FLIP errors of what is displayed. */
  flip(tone: string, exposure: number): Promise<Pieces<Figures>>;
  /** Control that chooses B; `act` carries out a change of it, and takes the new one. */
  controls(act: (change: () => Promise<void>) => void): HTMLElement[];
  /** True if there is a B to be taken away. */
  update?(hasOther: boolean): void;
}

export class Compare {
  readonly element: HTMLElement;
  readonly divider: Divider;
  /** Which of the two is shown, over the picture. */
  readonly tag = h('div', { class: 'tag', hidden: true });
  about: AboutReference | null = null;
  /** Whether this page is changing B. */
  private acts = false;
  /** Called when there is another B, or none. */
  changed: () => void = () => {};

  private readonly facts = h('p', { class: 'facts' }, 'Nothing is kept as B.');
  private readonly figures = h('p', { class: 'facts', hidden: true });
  private readonly mode = h(
    'select',
    { 'aria-label': 'Compare with B', onchange: () => this.choose(this.mode.value as Comparison) },
    ...(
      [
        ['off', 'off'],
        ['split', 'split'],
        ['flip', 'A and B in turn'],
        ['difference', 'difference A − B'],
        ['map', 'FLIP map'],
      ] as const
    ).map(([value, text]) => h('option', { value }, text)),
  );
  private readonly gain: HTMLElement;
  private readonly automatic = h('input', { type: 'checkbox', onchange: () => this.update() });
  private readonly automaticRow = row('By itself', this.automatic, 'A and B take turns of half a second; else by key B');
  private readonly map: FlipMap;
  private tones: ToneChoice[] = [];
  /** Why there is no B. */
  private fault = '';
  private timer = 0;
  /** Number of the last question for B. */
  private turn = 0;
  private isPreview = true;

  constructor(
    private readonly view: View,
    private readonly tell: (message: Message) => void,
    private readonly source: Source,
  ) {
    this.divider = new Divider((part) => {
      view.split = part;
      view.redraw();
    });
    this.map = new FlipMap(
      view,
      () => toneText(view.tone, this.tones),
      source.flip,
      (figures) => this.showFigures(figures),
    );
    const field = numberField({
      label: 'Gain of the difference',
      value: 1,
      range: [0.001, 1e6],
      slider: [0.1, 1000],
      change: (v) => {
        view.differenceGain = v;
        view.redraw();
      },
    });
    this.gain = row('Gain', field.element, 'Grey where both are the same; with the exposure, 1 is a difference of 1 to white or black');
    this.element = section(
      'Compare',
      false,
      this.facts,
      ...source.controls((change) => void this.act(change)),
      row('Show', this.mode),
      this.gain,
      this.automaticRow,
      this.figures,
    );
    this.update();
    void this.take();
  }

  /** The tone curves, or the film, may have changed. */
  takeTones(tones: ToneChoice[]): void {
    this.tones = tones;
    this.place();
  }

  takeFrame({ kind }: Pick<FrameEnd, 'kind'>): void {
    this.isPreview = kind === 'preview';
    this.refresh();
  }

  /** How pictures are displayed, or the picture, has changed: so has the map. */
  refresh(): void {
    if (this.view.comparison === 'map' && this.about && !this.isPreview) this.map.update();
  }

  /** Shows the other one of A and B. */
  alternate(): void {
    if (!this.about) return this.tell({ severity: 'note', text: 'nothing is kept as B' });
    const isTurn = this.view.comparison === 'flip';
    this.view.showsOther = isTurn ? !this.view.showsOther : true;
    this.choose('flip');
  }

  private choose(mode: Comparison): void {
    this.mode.value = mode;
    this.view.comparison = mode;
    this.update();
    this.refresh();
  }

  /** B is another one; by another page, unless this one is about to take it. */
  changedElsewhere(): void {
    if (!this.acts) void this.take();
  }

  /** Carries out what changes B, and takes the new one. */
  private async act(change: () => Promise<void>): Promise<void> {
    this.acts = true;
    try {
      await change();
      await this.take();
      if (this.about && this.view.comparison === 'off') this.choose('split');
    } catch (error) {
      this.tell({ severity: 'error', text: error instanceof Error ? error.message : String(error) });
    } finally {
      this.acts = false;
    }
  }

  private async take(): Promise<void> {
    const turn = ++this.turn;
    let fault = '';
    const found = await this.source.fetch().catch((error: unknown) => {
      fault = error instanceof Error ? error.message : String(error);
      return null;
    });
    // Another one was asked for meanwhile.
    if (turn !== this.turn) return;
    this.fault = fault;
    this.about = found?.head ?? null;
    this.map.clear();
    if (found) {
      for (const tile of found.tiles) this.view.others.tile('reference', tile);
      this.view.others.swap([0, 0, 1, 1], 'reference');
    } else this.view.others.keep([]);
    this.place();
    this.update();
    this.refresh();
    this.changed();
  }

  /** B lies where it was rendered; a file on the whole film, or on the region that is as large as it. */
  private place(): void {
    const [picture, about] = [this.view.others.shown('reference'), this.about];
    if (!picture || !about) return;
    const { film, region } = this.view;
    const isRegion = region && about.width === region[2] - region[0] && about.height === region[3] - region[1];
    const isFilm = about.width === film.width && about.height === film.height;
    picture.crop = about.crop ?? (isRegion && !isFilm ? region : [0, 0, film.width, film.height]);
    const size = isFilm || isRegion || about.crop ? '' : `; the picture has ${film.width} × ${film.height}`;
    setText(this.facts, `B: ${about.name}, ${about.width} × ${about.height}${size}`);
  }

  private update(): void {
    const { view, about } = this;
    const mode = about ? view.comparison : 'off';
    if (!about) setText(this.facts, this.fault || 'Nothing is kept as B.');
    this.mode.disabled = about === null;
    this.source.update?.(about !== null);
    this.divider.element.hidden = mode !== 'split';
    this.gain.hidden = mode !== 'difference';
    this.automaticRow.hidden = mode !== 'flip';
    if (mode !== 'map') this.figures.hidden = true;
    clearInterval(this.timer);
    if (mode === 'flip' && this.automatic.checked) {
      this.timer = window.setInterval(() => {
        view.showsOther = !view.showsOther;
        this.label(mode);
        view.redraw();
      }, TURN);
    }
    this.label(mode);
    view.redraw();
  }

  private label(mode: Comparison): void {
    this.tag.hidden = mode === 'off' || mode === 'split';
    setText(this.tag, mode === 'flip' ? (this.view.showsOther ? 'B' : 'A') : mode === 'map' ? 'FLIP' : 'A − B');
  }

  private showFigures(figures: Figures | string): void {
    this.figures.hidden = this.view.comparison !== 'map';
    const number = (v: number | null) => (v === null ? '∞' : show(v));
    setText(
      this.figures,
      typeof figures === 'string'
        ? figures
        : `FLIP: mean ${number(figures.mean)}, 95 % below ${number(figures.quantile95)}; relMSE ${number(figures.relmse)}; PSNR ${number(figures.psnr)} dB`,
    );
  }
}
