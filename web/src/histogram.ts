/** Panel "Histogram": luminance by powers of two, the share that is clipped, and what isn't finite. */

import { h, section, setText, show } from './dom';
import { octaves, type Statistics } from './half';

const LOW = -14;
const HIGH = 10;
const STEPS = 4;
const WIDTH = 280;
const HEIGHT = 72;

export class Histogram {
  readonly element: HTMLDetailsElement;
  private readonly canvas = h('canvas', { width: 2 * WIDTH, height: 2 * HEIGHT, role: 'img', 'aria-label': 'Histogram of luminance' });
  private readonly facts = h('p', { class: 'facts' });
  private last = 0;
  private timer = 0;

  constructor() {
    this.element = section('Histogram', true, this.canvas, this.facts);
  }

  /** Shows statistics, at most a few times a second; `exposure` in EV. */
  update(of: () => Statistics | null, exposure: number): void {
    if (!this.element.open) return;
    clearTimeout(this.timer);
    const wait = this.last + 200 - performance.now();
    if (wait > 0) {
      this.timer = window.setTimeout(() => this.update(of, exposure), wait);
      return;
    }
    const found = of();
    if (found) this.draw(found, exposure);
    this.last = performance.now();
  }

  private draw(found: Statistics, exposure: number): void {
    const bins = octaves(found, LOW, HIGH, STEPS);
    const most = Math.max(...bins, 1);
    const context = this.canvas.getContext('2d')!;
    const style = getComputedStyle(this.canvas);
    const color = (name: string) => style.getPropertyValue(name);
    context.setTransform(2, 0, 0, 2, 0, 0);
    context.clearRect(0, 0, WIDTH, HEIGHT);
    const at = (ev: number) => ((ev - LOW) / (HIGH - LOW)) * WIDTH;
    const bottom = HEIGHT - 14;
    context.fillStyle = color('--muted');
    context.font = '10px system-ui, sans-serif';
    context.textAlign = 'center';
    for (let ev = LOW + 2; ev < HIGH; ev += 4) {
      context.fillRect(at(ev), bottom, 1, 3);
      context.fillText(String(ev).replace('-', '−'), at(ev), HEIGHT - 2);
    }
    // What's above 1 after exposure is clipped without a curve.
    const white = -exposure;
    let clipped = 0;
    bins.forEach((count, i) => {
      const ev = LOW + i / STEPS;
      if (ev >= white) clipped += count;
      if (count === 0) return;
      context.fillStyle = ev >= white ? color('--warn') : color('--accent');
      const height = Math.max(1, (bottom - 2) * Math.sqrt(count / most));
      context.fillRect(at(ev), bottom - height, WIDTH / bins.length - 0.5, height);
    });
    context.fillStyle = color('--text');
    if (white > LOW && white < HIGH) context.fillRect(at(white), 0, 1, bottom);
    const share = (count: number) => `${((100 * count) / found.pixels).toFixed(count === 0 ? 0 : 2)} %`;
    const odd = found.nonfinite > 0 ? `; not finite: ${found.nonfinite}` : '';
    setText(
      this.facts,
      `EV of luminance; above 1: ${share(clipped)}; zero or below: ${share(found.dark)}; largest ${show(found.maximum)}${odd}`,
    );
  }
}
