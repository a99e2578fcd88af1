/** The page of `steradian view PICTURES`: puts the list, the picture and its panels together. */

import './style.css';
import { fetchFlip, fetchList, fetchLook, fetchPicture } from './album';
import { Compare, type Source } from './compare';
import { h, row, setOptions, setText, trackEditing } from './dom';
import { Drop } from './drop';
import { falseScale, Legend } from './falsecolor';
import { Histogram } from './histogram';
import { Keys, place } from './keys';
import { List } from './list';
import { Look } from './look';
import { FLIP_SCALE } from './magma';
import { Messages } from './messages';
import { Navigate } from './navigate';
import { Numbers } from './numbers';
import { pictureKeys } from './picturekeys';
import { PixelPanel } from './pixelpanel';
import type { AboutPicture, AboutReference, FirstLook, Listing, Message } from './protocol';
import type { Pieces } from './reference';
import { themeButton } from './theme';
import { View } from './view';

/** Milliseconds between two looks for changed files. */
const PAUSE = 1000;

const POINTER: [string, string][] = [
  ['Drag, one finger', 'move the picture'],
  ['Wheel, two fingers', 'zoom; far in, pixels have their numbers'],
  ['Click', 'pin a pixel'],
];

class Pictures {
  private readonly canvas = h('canvas', {
    class: 'picture',
    tabindex: 0,
    role: 'img',
    'aria-label': 'Picture; up and down choose another',
  });
  private readonly view = new View(this.canvas);
  private readonly numbers = new Numbers(this.view);
  private readonly legend = new Legend();
  private readonly messages = new Messages();
  private readonly histogram = new Histogram();
  private readonly list = new List((id) => this.choose(id));
  private readonly pixel = new PixelPanel(
    () => this.about?.id ?? null,
    () => {
      this.numbers.pin = this.pixel.pinned;
      this.view.redraw();
    },
  );
  private readonly look: Look;
  private readonly compare: Compare;
  private readonly other = h('select', { 'aria-label': 'Picture B' });
  private readonly lost = h('span', { role: 'status' });
  private readonly facts = h('span', { class: 'status-facts' });
  private readonly status = h('footer', { class: 'status' }, h('span', { class: 'dot', 'aria-hidden': 'true' }), this.lost, this.facts);
  /** The picture in view. */
  private about: AboutPicture | null = null;
  private listings: Listing[] = [];
  /** The picture, and the version of it, that was asked for last. */
  private asked: { id: number; version: number } | null = null;
  private turn = 0;
  /** B as it was fetched last. */
  private kept: { key: string; pieces: Pieces<AboutReference> } | null = null;

  constructor(private readonly first: FirstLook) {
    const { view } = this;
    view.comparesLayers = true;
    this.look = new Look(
      view,
      () => void this.show(),
      () => {
        this.showHistogram();
        this.compare.refresh();
      },
    );
    this.compare = new Compare(view, this.tell, this.source());
    this.compare.takeTones(first.tones);
    this.compare.takeFrame({ kind: 'render' });
    this.histogram.element.addEventListener('toggle', this.showHistogram);
    view.drawn = () => this.drawn();
    new Navigate(view, null, {
      hover: (at) => this.pixel.show(at, at && view.values(...at)),
      click: (at) => {
        const values = view.values(...at);
        this.pixel.show(values ? at : null, values);
        this.pixel.pin(values ? at : null);
      },
      region: () => {},
      drawsRegion: () => false,
      isMovable: () => false,
    });
    this.compose();
    void this.watch();
  }

  private readonly tell = (message: Message): void => this.messages.add(message);

  private readonly showHistogram = (): void => this.histogram.update(() => this.view.statistics(), this.view.tone.exposure);

  private compose(): void {
    const { view } = this;
    const panel = h('button', { title: 'Show or hide the panel (N)', 'aria-expanded': 'true' }, 'Panel');
    const setPanel = (hidden: boolean) => panel.setAttribute('aria-expanded', String(!hidden));
    const togglePanel = () => setPanel(document.body.classList.toggle('no-panel'));
    panel.addEventListener('click', togglePanel);
    const step = (shown: string, doc: string, by: number, ...codes: string[]) =>
      ({ shown, doc, group: 'Picture', is: place(...codes), act: () => this.list.step(by) }) as const;
    const help = () => keys.toggle();
    const keys: Keys = new Keys(
      [
        step('↑, Page up', 'the picture before', -1, 'ArrowUp', 'PageUp'),
        step('↓, Page down', 'the next picture', 1, 'ArrowDown', 'PageDown'),
        ...pictureKeys({ view, look: this.look, compare: this.compare, panel: togglePanel, help }),
        { shown: 'Escape', doc: 'unpin the pixel', group: 'Picture', is: place('Escape'), act: () => this.pixel.pin(null) },
      ],
      POINTER,
    );
    const button = (text: string, title: string, act: () => void, label?: string) =>
      h('button', { title, 'aria-label': label, onclick: act }, text);
    const toolbar = h(
      'div',
      { class: 'toolbar', role: 'toolbar', 'aria-label': 'Picture' },
      button('Fit', 'Fit the picture into the window (F)', () => (view.placement.fit(), view.redraw())),
      button('1:1', 'One pixel for each pixel (1)', () => (view.placement.actual(), view.redraw())),
      button('◂', 'The picture before (↑)', () => this.list.step(-1), 'Picture before'),
      button('▸', 'The next picture (↓)', () => this.list.step(1), 'Next picture'),
      h('span', { class: 'gap' }),
      themeButton(this.showHistogram),
      button('?', 'Keys and pointer (?)', help, 'Keys and pointer'),
      panel,
    );
    const drop = new Drop(this.tell, 'Drop pictures, or folders of them', ({ added }) => void this.dropped(added ?? []));
    document.body.append(
      h(
        'main',
        { class: 'stage' },
        h('h1', { class: 'hidden' }, 'Steradian'),
        this.canvas,
        this.numbers.element,
        this.compare.divider.element,
        this.compare.tag,
        toolbar,
        this.legend.element,
        this.messages.toast,
        drop.hint,
      ),
      this.status,
      h(
        'aside',
        { class: 'panel', 'aria-label': 'Panels' },
        this.list.element,
        this.look.element,
        this.pixel.element,
        this.compare.element,
        this.histogram.element,
        this.messages.element,
      ),
      keys.help,
    );
    setPanel(document.body.classList.toggle('no-panel', innerWidth < 720));
  }

  /** Looks for changed files, again and again. */
  private async watch(): Promise<void> {
    await this.refresh();
    setTimeout(() => void this.watch(), PAUSE);
  }

  /** Takes the list; what has changed is shown anew. */
  private async refresh(): Promise<void> {
    try {
      this.take(await fetchList());
      setText(this.lost, '');
    } catch {
      setText(this.lost, 'no connection');
    }
    this.status.classList.toggle('lost', this.lost.textContent !== '');
  }

  private take(listings: Listing[]): void {
    const version = (id: number | null) => listings.find((l) => l.id === id)?.version;
    const b = this.otherId;
    const isOtherNew = b !== null && version(b) !== this.listings.find((l) => l.id === b)?.version;
    this.listings = listings;
    this.list.update(listings);
    setOptions(this.other, [{ value: '', text: 'none' }, ...listings.map(({ id, name }) => ({ value: String(id), text: name }))]);
    this.other.value = b === null ? '' : String(b);
    const { asked } = this;
    if (!asked) {
      const first = listings.find(({ fault }) => fault === null) ?? listings[0];
      if (first) this.choose(first.id);
    } else if (version(asked.id) !== asked.version) this.choose(asked.id);
    if (isOtherNew) this.compare.changedElsewhere();
  }

  private async dropped(ids: number[]): Promise<void> {
    await this.refresh();
    if (ids[0] !== undefined) this.choose(ids[0]);
  }

  private choose(id: number): void {
    this.asked = { id, version: this.listings.find((l) => l.id === id)?.version ?? 0 };
    this.list.mark(id);
    void this.show();
  }

  /** Fetches the layer of the picture that was asked for last, and shows it. */
  private async show(): Promise<void> {
    const { asked, view } = this;
    if (!asked) return;
    const turn = ++this.turn;
    try {
      let found = await fetchPicture(asked.id, view.layer);
      if (turn !== this.turn) return;
      if (!found) {
        const name = this.listings.find(({ id }) => id === asked.id)?.name ?? '';
        this.tell({ severity: 'note', text: `'${name}' has no layer '${view.layer}': its colours are shown` });
        view.layer = 'picture';
        found = await fetchPicture(asked.id, view.layer);
        if (turn !== this.turn || !found) return;
      }
      this.takePicture(found);
    } catch (error) {
      if (turn !== this.turn) return;
      this.about = null;
      view.layers.keep([]);
      view.redraw();
      setText(this.facts, 'no picture');
      this.pixel.refresh();
      const name = this.listings.find(({ id }) => id === asked.id)?.name ?? '';
      this.tell({ severity: 'error', text: `${name}: ${error instanceof Error ? error.message : String(error)}` });
      await this.refresh();
    }
  }

  private takePicture({ head, tiles }: Pieces<AboutPicture>): void {
    const { view, first } = this;
    const { width, height, layer } = head;
    const longest = Math.max(width, height);
    if (longest > view.longest) throw new Error(`${longest} pixels are too many along an edge for this browser: ${view.longest}`);
    const isOther = this.about?.id !== head.id || this.about.version !== head.version;
    this.about = head;
    view.film = { width, height };
    for (const tile of tiles) view.tile(layer, tile);
    view.frame({ crop: [0, 0, width, height], lightGroups: [], width, height });
    this.look.update({
      choices: { tones: first.tones, layers: head.layers },
      scene: { name: '', path: null },
      exposure: first.exposure,
      tone: first.tone,
      layers: [],
    });
    view.layers.keep([layer]);
    this.look.takeFrame();
    this.compare.changedElsewhere();
    this.showHistogram();
    if (isOther) {
      this.pixel.refresh();
      for (const text of head.notes) this.tell({ severity: 'note', text: `${head.name}: ${text}` });
    }
    document.title = `${head.name} – Steradian`;
    const text = `${head.name} · ${width} × ${height}${layer === 'picture' ? '' : ` · ${layer}`}`;
    setText(this.facts, text);
    this.facts.title = text;
  }

  private get otherId(): number | null {
    return this.other.value === '' ? null : Number(this.other.value);
  }

  /** B: another picture of the list, of the same size and with the shown layer. */
  private source(): Source {
    return {
      fetch: () => this.fetchOther(),
      flip: (tone, exposure) => fetchFlip(this.about!.id, this.otherId!, this.view.layer, tone, exposure),
      controls: (act) => {
        this.other.addEventListener('change', () => act(async () => {}));
        return [row('B', this.other, 'The picture that the shown one, A, is compared with')];
      },
    };
  }

  private async fetchOther(): Promise<Pieces<AboutReference> | null> {
    const [id, a] = [this.otherId, this.about];
    if (id === null || !a) return null;
    const listing = this.listings.find((l) => l.id === id);
    const key = JSON.stringify([id, listing?.version, a.layer]);
    if (this.kept?.key !== key) {
      const found = await fetchPicture(id, a.layer);
      if (!found) throw new Error(`'${listing?.name}' has no layer '${a.layer}'`);
      const { name, width, height } = found.head;
      this.kept = { key, pieces: { head: { name, width, height, crop: null }, tiles: found.tiles } };
    }
    const { head } = this.kept.pieces;
    if (head.width !== a.width || head.height !== a.height) {
      const size = (of: { name: string; width: number; height: number }) => `'${of.name}' has ${of.width} × ${of.height} pixels`;
      throw new Error(`${size(a)}, ${size(head)}: they are not compared`);
    }
    return this.kept.pieces;
  }

  private drawn(): void {
    const { view } = this;
    this.numbers.draw();
    const ends = view.scale();
    this.legend.update(view.showsMap ? FLIP_SCALE : ends && falseScale(ends, 1, ''));
  }
}

async function start(): Promise<void> {
  trackEditing();
  new Pictures(await fetchLook());
}

start().catch((error: unknown) => {
  const text = `The page cannot run: ${error instanceof Error ? error.message : String(error)}`;
  document.body.append(h('p', { class: 'fatal', role: 'alert' }, text));
});
