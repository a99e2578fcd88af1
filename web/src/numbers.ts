/** Numbers in the pixels of a picture that is enlarged a lot, and the mark of the pinned one. */

import { h } from './dom';
import { valuesIn, type View } from './view';

/** CSS pixels of the smallest pixel with numbers in it. */
const LEAST = 38;
const COLORS = ['#ffb0a8', '#b4f0a6', '#b5cdff'];

export class Numbers {
  readonly element = h('canvas', { class: 'pixel-numbers', 'aria-hidden': 'true' });
  pin: [number, number] | null = null;

  constructor(private readonly view: View) {}

  /** Draws anew, where the picture is. */
  draw(): void {
    const { element, view } = this;
    const { canvas, placement, film } = view;
    const { left, top, scale } = placement;
    const { width, height } = canvas;
    if (element.width !== width || element.height !== height) Object.assign(element, { width, height });
    const context = element.getContext('2d')!;
    context.clearRect(0, 0, width, height);
    const cell = scale / devicePixelRatio;
    let count = 0;
    if (cell >= LEAST) {
      const range = (start: number, room: number, size: number) => [
        Math.max(0, Math.floor(-start / scale)),
        Math.min(size, Math.ceil((room - start) / scale)),
      ];
      const [x0, x1] = range(left, width, film.width);
      const [y0, y1] = range(top, height, film.height);
      context.font = `${Math.min(12, cell / 4) * devicePixelRatio}px system-ui, sans-serif`;
      Object.assign(context, { textAlign: 'center', textBaseline: 'middle', lineJoin: 'round', strokeStyle: '#000' });
      context.lineWidth = 3 * devicePixelRatio;
      for (let y = y0!; y < y1!; y++) {
        for (let x = x0!; x < x1!; x++) {
          const values = this.at(x, y);
          if (!values) continue;
          count++;
          values.forEach((v, i) => {
            const text = brief(v);
            const [u, w] = [left + (x + 0.5) * scale, top + (y + (i + 1) / (values.length + 1)) * scale];
            context.strokeText(text, u, w, scale - 4 * devicePixelRatio);
            context.fillStyle = values.length === 3 ? COLORS[i]! : '#fff';
            context.fillText(text, u, w, scale - 4 * devicePixelRatio);
          });
        }
      }
    }
    element.dataset.numbered = String(count);
    if (this.pin) this.mark(context, this.pin);
  }

  /** Values shown of a pixel: of A, of B, or how far they are apart. */
  private at(x: number, y: number): number[] | null {
    const { view } = this;
    const a = view.values(x, y);
    const [way, other] = view.compared();
    const b = other && valuesIn(other, x, y);
    if (!a || !b || way === 0) return a;
    const isRight = view.placement.left + (x + 0.5) * view.placement.scale >= view.split * view.canvas.width;
    if (way === 3) return a.map((v, i) => v - (b[i] ?? b[0]!));
    return way === 1 && !isRight ? a : b;
  }

  private mark(context: CanvasRenderingContext2D, [x, y]: [number, number]): void {
    const { left, top, scale } = this.view.placement;
    const size = Math.max(scale, 9 * devicePixelRatio);
    for (const [color, out] of [
      ['#000', 1],
      ['#fff', 0],
    ] as const) {
      Object.assign(context, { strokeStyle: color, lineWidth: devicePixelRatio });
      context.strokeRect(left + x * scale - out - 0.5, top + y * scale - out - 0.5, size + 2 * out, size + 2 * out);
    }
  }
}

/** A number of three digits. */
function brief(v: number): string {
  if (!Number.isFinite(v)) return Number.isNaN(v) ? 'NaN' : v > 0 ? '∞' : '−∞';
  const short = Number(v.toPrecision(3));
  return short !== 0 && (Math.abs(short) < 1e-3 || Math.abs(short) >= 1e6) ? short.toExponential() : String(short);
}
