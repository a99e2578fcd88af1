/** Viewpoints that are kept in the browser, for each scene. */

import { h, row, setOptions, show } from './dom';
import type { CameraState, PageMessage } from './protocol';

type Viewpoint = Pick<CameraState, 'eye' | 'target' | 'up' | 'fov'>;

/** Viewpoints of a scene at most. */
const MOST = 32;

export class Bookmarks {
  readonly element: HTMLElement;
  private readonly list = h('select', { 'aria-label': 'Kept viewpoints', onchange: () => this.go() });
  private readonly keep = h('button', { title: 'Keep this viewpoint in the browser', onclick: () => this.add() }, 'Keep');
  private readonly forget = h('button', { title: 'Forget the chosen viewpoint', onclick: () => this.remove() }, 'Forget');
  private key = '';
  private camera: CameraState | null = null;

  constructor(private readonly send: (message: PageMessage) => boolean) {
    this.element = h('div', {}, row('Viewpoints', this.list), h('div', { class: 'buttons' }, this.keep, this.forget));
  }

  update(scene: string, camera: CameraState): void {
    this.key = `viewpoints of ${scene}`;
    this.camera = camera;
    const kept = this.kept();
    this.element.hidden = !camera.movable;
    const place = ({ eye }: Viewpoint) => eye.map(show).join(', ');
    setOptions(this.list, [
      { value: '', text: '–' },
      ...kept.map((view, i) => ({ value: String(i), text: `${i + 1}: from ${place(view)}` })),
    ]);
    const at = kept.findIndex((view) => same(view, camera));
    this.list.value = at < 0 ? '' : String(at);
    this.list.disabled = kept.length === 0;
    this.keep.disabled = at >= 0 || kept.length >= MOST;
    this.forget.disabled = at < 0;
  }

  private add(): void {
    if (!this.camera) return;
    const { eye, target, up, fov } = this.camera;
    this.store([...this.kept(), { eye, target, up, fov }]);
  }

  private remove(): void {
    const at = Number(this.list.value);
    if (this.list.value !== '') this.store(this.kept().filter((_, i) => i !== at));
  }

  private go(): void {
    const view = this.kept()[Number(this.list.value)];
    if (this.list.value === '' || !view) return;
    const { eye, target, up, fov } = view;
    this.send({ type: 'camera', eye, target, up, ...(fov === null ? {} : { fov }), moving: false });
  }

  private kept(): Viewpoint[] {
    try {
      const kept = JSON.parse(localStorage.getItem(this.key) ?? '[]') as unknown;
      return Array.isArray(kept) ? (kept as Viewpoint[]).filter((view) => Array.isArray(view?.eye)) : [];
    } catch {
      return [];
    }
  }

  private store(views: Viewpoint[]): void {
    try {
      localStorage.setItem(this.key, JSON.stringify(views));
    } catch {
      // A browser without storage keeps nothing.
    }
    if (this.camera) this.update(this.key.slice('viewpoints of '.length), this.camera);
  }
}

/** Whether two viewpoints are one but for the last digits, which the way to the server and back may change. */
function same(a: Viewpoint, b: Viewpoint): boolean {
  const numbers = ({ eye, target, up, fov }: Viewpoint) => [...eye, ...target, ...up, fov ?? 0];
  const [p, q] = [numbers(a), numbers(b)];
  return p.every((v, i) => Math.abs(v - q[i]!) <= 1e-9 * (1 + Math.abs(v)));
}
