/** The nearest half float of a number, ties to even. */
export function toHalf(v: number): number {
  if (Number.isNaN(v)) return 0x7e00;
  const sign = v < 0 || Object.is(v, -0) ? 0x8000 : 0;
  const a = Math.abs(v);
  if (a >= 65520) return sign | 0x7c00;
  const exponent = Math.max(Math.floor(Math.log2(a)), -14);
  const unit = 2 ** (exponent - 10);
  let steps = Math.floor(a / unit);
  const rest = a / unit - steps;
  if (rest > 0.5 || (rest === 0.5 && steps % 2 === 1)) steps++;
  // Steps of 1024 and more are normal numbers; a carry into the exponent is right by itself.
  return a === 0 ? sign : sign | (steps + (exponent + 14) * 1024);
}
