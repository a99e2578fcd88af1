/** Tone curves in GLSL, as crates/image/src/tone has them, and their settings. */

import type { ToneChoice } from './protocol';

/** Curves that the shader has; a curve's number there is its place here. */
export const CURVES = [
  'none',
  'clamp',
  'equalize',
  'gamma',
  'clamp-gamma',
  'equalize-gamma',
  'reinhard',
  'aces-fit',
  'agx',
  'pbr-neutral',
  'hable',
];

/** `toneCurve(rgb)`: display values in [0, 1] of linear values after exposure. */
export const TONE_GLSL = `
uniform int curve;
uniform vec2 values;     // the curve's parameters
uniform float maximum;   // the picture's largest finite component, after exposure

float srgbEncode(float x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055; }
vec3 srgbEncode(vec3 v) { return vec3(srgbEncode(v.r), srgbEncode(v.g), srgbEncode(v.b)); }
float luminance(vec3 v) { return 0.2126 * v.r + 0.7152 * v.g + 0.0722 * v.b; }
vec3 power(vec3 v, float gamma) { return mix(pow(max(v, 1e-38), vec3(1.0 / gamma)), vec3(0.0), equal(v, vec3(0.0))); }

vec3 acesFit(vec3 v) {
  vec3 x = min(v, 1e4);
  return min((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 1.0);
}

vec3 agx(vec3 v) {
  // GLSL's matrices are by columns: these are transposed rows.
  const mat3 inset = mat3(0.84247906, 0.042328242, 0.042375655, 0.0784336, 0.878468640, 0.0784336, 0.079223745, 0.07916613, 0.879143);
  const mat3 outset = mat3(1.196879, -0.05289685, -0.052971635, -0.09802088, 1.1519031, -0.09804345, -0.09902974, -0.09896118, 1.1510737);
  vec3 x = (clamp(log2(max(inset * v, 1e-10)), -12.47393, 4.026069) + 12.47393) / (4.026069 + 12.47393);
  vec3 x2 = x * x;
  vec3 x4 = x2 * x2;
  vec3 s = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
  return pow(clamp(outset * s, 1e-12, 1.0), vec3(2.2));
}

vec3 pbrNeutral(vec3 v) {
  const float start = 0.8 - 0.04;
  float least = min(v.r, min(v.g, v.b));
  vec3 c = v - (least < 0.08 ? least - 6.25 * least * least : 0.04);
  float peak = max(c.r, max(c.g, c.b));
  if (peak < start) return c;
  float d = 1.0 - start;
  float compressed = 1.0 - d * d / (peak + d - start);
  float mixed = 1.0 - 1.0 / (0.15 * (peak - compressed) + 1.0);
  return c * (compressed / peak) * (1.0 - mixed) + compressed * mixed;
}

vec3 hableCurve(vec3 x) {
  const float a = 0.15, b = 0.50, c = 0.10, d = 0.20, e = 0.02, f = 0.30;
  return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

vec3 toneCurve(vec3 v) {
  vec3 result;
  if (curve == 0) result = srgbEncode(min(v, 1.0));
  else if (curve == 1) result = min(v / values.x, 1.0);
  else if (curve == 2) result = v / maximum;
  else if (curve == 3) result = power(min(v, 1.0), values.x);
  else if (curve == 4) result = power(min(v / values.y, 1.0), values.x);
  else if (curve == 5) result = power(min(v / maximum, 1.0), values.x);
  else if (curve == 6) {
    float l = luminance(v);
    result = srgbEncode(min(v * ((1.0 + l / (values.x * values.x)) / (1.0 + l)), 1.0));
  }
  else if (curve == 7) result = srgbEncode(acesFit(v));
  else if (curve == 8) result = srgbEncode(agx(v));
  else if (curve == 9) result = srgbEncode(clamp(pbrNeutral(v), 0.0, 1.0));
  else result = srgbEncode(clamp(hableCurve(min(2.0 * v, 1e6)) / hableCurve(vec3(values.x)), 0.0, 1.0));
  return clamp(result, 0.0, 1.0);
}
`;

/** A curve with its parameters, and the exposure in EV. */
export interface Tone {
  name: string;
  values: number[];
  exposure: number;
}

/** A tone from text as the command line takes it: `reinhard:white=4,exposure=1`. */
export function parseTone(text: string, choices: ToneChoice[]): Tone {
  const [name = 'none', settings = ''] = text.split(':', 2);
  const choice = choices.find((c) => c.name === name);
  const tone: Tone = { name: choice ? name : 'none', values: choice?.parameters.map((p) => p.default) ?? [], exposure: 0 };
  for (const setting of settings.split(',')) {
    const [key, value] = setting.split('=', 2);
    const at = choice?.parameters.findIndex((p) => p.name === key) ?? -1;
    if (key === 'exposure') tone.exposure = Number(value) || 0;
    else if (at >= 0 && Number.isFinite(Number(value))) tone.values[at] = Number(value);
  }
  return tone;
}

/** The text of a tone without its exposure. */
export function toneText(tone: Tone, choices: ToneChoice[]): string {
  const parameters = choices.find((c) => c.name === tone.name)?.parameters ?? [];
  const set = parameters.flatMap((p, i) => (tone.values[i] === p.default ? [] : [`${p.name}=${tone.values[i]}`]));
  return set.length > 0 ? `${tone.name}:${set.join(',')}` : tone.name;
}
