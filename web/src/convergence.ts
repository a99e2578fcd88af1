/** Errors against time or samples: what a render's frames tell, kept to compare renders. */

import { VALUES } from './half';
import type { Picture } from './layers';
import type { FrameEnd } from './protocol';

/** What a frame tells. */
export interface Point {
  seconds: number;
  samples: number;
  /** The estimate of the relative error. */
  error: number | null;
  /** The root of the relMSE to B. */
  toReference: number | null;
}

/** A render. */
export interface Curve {
  label: string;
  generation: number;
  points: Point[];
}

/** Curves that are kept, the one that grows among them. */
export const MOST_CURVES = 4;
/** A render of fewer frames is none that is kept. */
const FEWEST_POINTS = 3;
/** Frames come this much later than the one before, in time or samples, to count. */
const APART = 1.04;

export class Convergence {
  /** The last one grows. */
  curves: Curve[] = [];

  /** Takes a frame of a render, whose error to B is computed where it counts. */
  take(frame: FrameEnd, label: string, toReference: () => number | null): boolean {
    const { generation, seconds, samples, error, done } = frame;
    if (frame.kind === 'preview' || samples <= 0 || seconds <= 0) return false;
    let curve = this.curves.at(-1);
    const last = curve?.points.at(-1);
    // A state of another generation may go on with the same picture.
    const goesOn = curve && last && curve.label === label && (curve.generation === generation || samples > last.samples);
    if (!curve || !goesOn || (last && (samples < last.samples || seconds < last.seconds))) curve = this.begin(label, generation);
    else if (last && (samples <= last.samples || (!done && seconds < APART * last.seconds && samples < APART * last.samples))) return false;
    curve.generation = generation;
    curve.points.push({ seconds, samples, error, toReference: toReference() });
    return true;
  }

  /** B is another one: errors to the old one mean nothing. */
  forgetReference(): void {
    for (const curve of this.curves) for (const point of curve.points) point.toReference = null;
  }

  remove(curve: Curve): void {
    this.curves = this.curves.filter((c) => c !== curve);
  }

  private begin(label: string, generation: number): Curve {
    const curve: Curve = { label, generation, points: [] };
    const kept = this.curves.filter((c) => c.label !== label && c.points.length >= FEWEST_POINTS);
    this.curves = [...kept.slice(1 - MOST_CURVES), curve];
    return curve;
  }
}

/** The relMSE, mean of (x − r)² / (r² + 0.01), of two pictures of a size; `null` where nothing is finite in both. */
export function relMse(picture: Picture, reference: Picture): number | null {
  const [a, b] = [picture.halves, reference.halves];
  if (a.length !== b.length || picture.width !== reference.width || picture.crop.join() !== reference.crop.join()) return null;
  let [sum, count] = [0, 0];
  for (let i = 0; i < a.length; i++) {
    const [x, r] = [VALUES[a[i]!]!, VALUES[b[i]!]!];
    const e = ((x - r) * (x - r)) / (r * r + 0.01);
    if (e < Infinity) {
      sum += e;
      count++;
    }
  }
  return count > 0 ? sum / count : null;
}
