/** Linear Rec.709 colours in the browser's picker, which is of sRGB in 8 bits. */

const encode = (v: number) => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
const decode = (v: number) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);

/** `#rrggbb` of a linear colour, cut to [0, 1]. */
export function hexOf(rgb: number[]): string {
  return (
    '#' +
    rgb
      .map((v) =>
        Math.round(255 * encode(Math.min(Math.max(v, 0), 1)))
          .toString(16)
          .padStart(2, '0'),
      )
      .join('')
  );
}

/** The linear colour of `#rrggbb`, to four digits. */
export function linearOf(hex: string): number[] {
  return [1, 3, 5].map((at) => Number(decode(parseInt(hex.slice(at, at + 2), 16) / 255).toPrecision(4)));
}
