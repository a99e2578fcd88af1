/** The shaders that draw the picture. */

import { FALSE_COLOR_GLSL } from './falsecolor';
import { MIX_GLSL } from './groups';
import { MAGMA_GLSL } from './magma';
import { TONE_GLSL } from './tone';

const VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

const FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D picture;
uniform vec2 canvasSize, corner, shownSize;  // in device pixels; the picture's left upper corner, and its size there
uniform bool isGrey, isOtherGrey, isNearest, isFalse, isMarked;
uniform float gain;                          // 2 to the exposure
uniform sampler2D other;                     // the other picture, or a map of errors
uniform vec2 otherCorner, otherSize;
uniform int comparison;                      // 1 split, 2 the other one, 3 difference, 4 map
uniform float split;                         // in device pixels
uniform float differenceGain;
out vec4 color;
${TONE_GLSL}
${FALSE_COLOR_GLSL}
${MAGMA_GLSL}
${MIX_GLSL}
bool isFinite(float v) { return (floatBitsToUint(v) & 0x7f800000u) != 0x7f800000u; }
float sanitized(float v) { return v > 0.0 ? min(v, 1e9) : 0.0; }

bool isOutside(vec2 at) { return any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(1.0))); }
bool isFinite(vec3 v) { return isFinite(v.r) && isFinite(v.g) && isFinite(v.b); }
vec3 colorAt(sampler2D from, vec2 at) {
  ivec2 size = textureSize(from, 0);
  return isNearest ? texelFetch(from, min(ivec2(at * vec2(size)), size - 1), 0).rgb : texture(from, at).rgb;
}

void main() {
  vec2 place = vec2(gl_FragCoord.x, canvasSize.y - gl_FragCoord.y);
  vec2 at = (place - corner) / shownSize;
  vec2 atOther = (place - otherCorner) / otherSize;
  bool isOther = comparison == 2 || comparison == 1 && place.x >= split;
  if (isOutside(at) || (isOther || comparison > 2) && isOutside(atOther)) {
    color = vec4(0.0);
    return;
  }
  vec3 v = groupCount > 0 ? mixedAt(at) : colorAt(picture, at);
  if (isGrey) v = v.rrr;
  vec3 o = comparison > 0 ? colorAt(other, atOther) : v;
  if (isOtherGrey) o = o.rrr;
  if (comparison == 3) {
    vec3 d = v - o;
    bool isOdd = !isFinite(d);
    color = isOdd ? vec4(1.0, isMarked ? 0.0 : 1.0, 1.0, 1.0) : vec4(clamp(0.5 + 0.5 * gain * differenceGain * d, 0.0, 1.0), 1.0);
    return;
  }
  if (comparison == 4) {
    color = vec4(isFinite(o.r) ? magma(o.r) : vec3(1.0, 0.0, 1.0), 1.0);
    return;
  }
  if (isOther) v = o;
  bool isOdd = !isFinite(v);
  if (isOdd && (isMarked || isFalse)) {
    color = vec4(1.0, 0.0, 1.0, 1.0);
    return;
  }
  if (isFalse) color = vec4(falseColor(luminance(v)), 1.0);
  else {
    vec3 exposed = v * gain;
    vec3 shown = toneCurve(vec3(sanitized(exposed.r), sanitized(exposed.g), sanitized(exposed.b)));
    color = vec4(floor(shown * 255.0 + 0.5) / 255.0, 1.0);
  }
}`;

/** The program of both. */
export function link(gl: WebGL2RenderingContext): WebGLProgram {
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, VERTEX],
    [gl.FRAGMENT_SHADER, FRAGMENT],
  ] as const) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader) ?? 'no shader');
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) ?? 'no program');
  return program;
}
