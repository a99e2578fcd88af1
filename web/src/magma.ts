/** Errors as colours, as crates/image/src/metrics/difference.rs has them, and their scale. */

import { bytes, type Scale } from './falsecolor';

/** Nine evenly spaced colours of the map "magma" (S. van der Walt, N. Smith 2015, CC0), sRGB. */
const COLORS = [0x000004, 0x1c1044, 0x4f127b, 0x812581, 0xb5367a, 0xe55964, 0xfb8761, 0xfec287, 0xfcfdbf];

/** `magma(x)`: the colour of a number from 0 to 1. */
export const MAGMA_GLSL = `
const vec3 magmaColors[9] = vec3[9](${COLORS.map(
  (c) =>
    `vec3(${bytes(c)
      .map((v) => v.toFixed(1))
      .join(', ')})`,
).join(', ')});

vec3 magma(float x) {
  float t = clamp(x, 0.0, 1.0) * 8.0;
  int i = min(int(t), 7);
  return floor(mix(magmaColors[i], magmaColors[i + 1], t - float(i)) + 0.5) / 255.0;
}
`;

/** The scale of FLIP errors. */
export const FLIP_SCALE: Scale = {
  label: 'FLIP error from 0, the same, to 1',
  unit: 'FLIP',
  colors: COLORS,
  ticks: [0, 0.2, 0.4, 0.6, 0.8, 1].map((v) => [v, String(v)]),
};
