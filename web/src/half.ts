/** IEEE half floats, and what a picture of them is like. */

/** The value of every half. */
export const VALUES = (() => {
  const table = new Float32Array(65536);
  for (let bits = 0; bits < 65536; bits++) {
    const sign = bits & 0x8000 ? -1 : 1;
    const exponent = (bits >> 10) & 31;
    const fraction = bits & 1023;
    if (exponent === 31) table[bits] = fraction ? NaN : sign * Infinity;
    else table[bits] = sign * (exponent === 0 ? fraction * 2 ** -24 : (1024 + fraction) * 2 ** (exponent - 25));
  }
  return table;
})();

/** Luminances counted by the first 20 bits of their float: 11 bits of precision, as halves have. */
const SHIFT = 12;
const BINS = 0x7f800000 >>> SHIFT;

/** What the pixels of a layer are like. */
export interface Statistics {
  /** The largest finite component, or 0. */
  maximum: number;
  /** Pixels with a component that isn't finite. */
  nonfinite: number;
  /** Finite pixels with a luminance of zero or below. */
  dark: number;
  pixels: number;
  counts: Uint32Array;
}

const counts = new Uint32Array(BINS);
const float = new Float32Array(1);
const bits = new Uint32Array(float.buffer);

/** Statistics; its counts hold until the next call. */
export function statistics(halves: Uint16Array, components: number): Statistics {
  counts.fill(0);
  let [largest, nonfinite, dark] = [0, 0, 0];
  const pixels = halves.length / components;
  const [g, b] = components === 3 ? [1, 2] : [0, 0];
  for (let i = 0; i < halves.length; i += components) {
    const [hr, hg, hb] = [halves[i]!, halves[i + g]!, halves[i + b]!];
    // Halves above zero are in the order of their bits.
    if (hr < 0x7c00 && hr > largest) largest = hr;
    if (hg < 0x7c00 && hg > largest) largest = hg;
    if (hb < 0x7c00 && hb > largest) largest = hb;
    if ((hr & 0x7c00) === 0x7c00 || (hg & 0x7c00) === 0x7c00 || (hb & 0x7c00) === 0x7c00) {
      nonfinite++;
      continue;
    }
    const luminance = 0.2126 * VALUES[hr]! + 0.7152 * VALUES[hg]! + 0.0722 * VALUES[hb]!;
    if (luminance > 0) {
      float[0] = luminance;
      counts[bits[0]! >>> SHIFT]!++;
    } else dark++;
  }
  return { maximum: VALUES[largest]!, nonfinite, dark, pixels, counts };
}

/** The nearest half of a number; what is beyond their range is the largest. */
export function halfOf(v: number): number {
  float[0] = v;
  const word = bits[0]!;
  const sign = (word >>> 16) & 0x8000;
  if (Number.isNaN(v)) return 0x7e00;
  const a = Math.abs(v);
  if (a > 65504) return sign | 0x7bff;
  return sign | (a < 2 ** -14 ? Math.round(a * 2 ** 24) : ((word & 0x7fffffff) - 0x38000000 + 0x1000) >>> 13);
}

/** The middle of a bin. */
function middle(bin: number): number {
  bits[0] = (bin << SHIFT) | (1 << (SHIFT - 1));
  return float[0]!;
}

/** Luminances of the pixels above zero, with their numbers of pixels. */
export function* bins({ counts }: Statistics): Generator<[number, number]> {
  for (let bin = 0; bin < BINS; bin++) if (counts[bin]! > 0) yield [middle(bin), counts[bin]!];
}

/** The luminance that this part of the pixels above zero doesn't exceed, or `null` where there are none. */
export function percentile({ counts, pixels, nonfinite, dark }: Statistics, part: number): number | null {
  const bright = pixels - nonfinite - dark;
  if (bright === 0) return null;
  let left = Math.round(part * (bright - 1));
  for (let bin = 0; bin < BINS; bin++) {
    left -= counts[bin]!;
    if (left < 0) return middle(bin);
  }
  return null;
}

/** Pixels by log2 of their luminance: `steps` bins for each power of two from `low` to `high`; the ends hold what is beyond. */
export function octaves({ counts }: Statistics, low: number, high: number, steps: number): number[] {
  const bins = new Array<number>((high - low) * steps).fill(0);
  for (let bin = 0; bin < BINS; bin++) {
    const count = counts[bin]!;
    if (count === 0) continue;
    const at = Math.floor((Math.log2(middle(bin)) - low) * steps);
    bins[Math.min(Math.max(at, 0), bins.length - 1)]! += count;
  }
  return bins;
}
