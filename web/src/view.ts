/** The canvas: draws the shown layer through exposure and tone curve, or in false colour, with WebGL2. */

import { FALSE_COLOR_GLSL, scaleEnds } from './falsecolor';
import { statistics, VALUES, type Statistics } from './half';
import { Layers, type Picture } from './layers';
import { Placement } from './placement';
import type { Box, FrameMessage, Tile } from './protocol';
import { CURVES, TONE_GLSL, type Tone } from './tone';

const VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

const FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D picture;
uniform vec2 canvasSize, corner, shownSize;  // in device pixels; the picture's left upper corner, and its size there
uniform bool isGrey, isNearest, isFalse, isMarked;
uniform float gain;                          // 2 to the exposure
out vec4 color;
${TONE_GLSL}
${FALSE_COLOR_GLSL}
bool isFinite(float v) { return (floatBitsToUint(v) & 0x7f800000u) != 0x7f800000u; }
float sanitized(float v) { return v > 0.0 ? min(v, 1e9) : 0.0; }

void main() {
  vec2 at = (vec2(gl_FragCoord.x, canvasSize.y - gl_FragCoord.y) - corner) / shownSize;
  if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(1.0)))) {
    color = vec4(0.0);
    return;
  }
  ivec2 size = textureSize(picture, 0);
  vec3 v = isNearest ? texelFetch(picture, min(ivec2(at * vec2(size)), size - 1), 0).rgb : texture(picture, at).rgb;
  if (isGrey) v = v.rrr;
  bool isOdd = !(isFinite(v.r) && isFinite(v.g) && isFinite(v.b));
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

export class View {
  readonly canvas: HTMLCanvasElement;
  readonly placement = new Placement();
  readonly layers: Layers;
  tone: Tone = { name: 'none', values: [], exposure: 0 };
  layer = 'picture';
  isFalse = false;
  isMarked = true;
  film = { width: 1, height: 1 };
  /** The part of the film that's rendered. */
  region: Box | null = null;
  /** Called after each drawing. */
  drawn: () => void = () => {};

  private readonly gl: WebGL2RenderingContext;
  private readonly program: WebGLProgram;
  private readonly uniforms = new Map<string, WebGLUniformLocation | null>();
  private known: { picture: Picture; version: number; statistics: Statistics } | null = null;
  private version = 0;
  private queued = 0;

  constructor(canvas: HTMLCanvasElement) {
    this.canvas = canvas;
    const gl = canvas.getContext('webgl2', { antialias: false, depth: false, powerPreference: 'low-power' });
    if (!gl) throw new Error('this browser has no WebGL 2, which the picture is drawn with');
    gl.getExtension('OES_texture_half_float_linear');
    this.gl = gl;
    this.layers = new Layers(gl);
    this.program = link(gl);
    new ResizeObserver(() => this.redraw()).observe(canvas);
    addEventListener('resize', () => this.redraw());
  }

  /** The frame that's shown: the layer's, or until it comes the picture's. */
  get picture(): Picture | null {
    return this.layers.shown(this.layer) ?? this.layers.shown('picture');
  }

  tile(layer: string, tile: Tile): void {
    this.layers.tile(layer, tile);
  }

  /** A frame's tiles are all there. */
  frame(message: FrameMessage): void {
    this.layers.swap(cropOf(message, this.film, this.region), message.layer);
    this.version++;
    this.redraw();
  }

  /** What the shown frame's pixels are like; counted once for each frame. */
  statistics(): Statistics | null {
    const picture = this.picture;
    if (!picture) return null;
    if (this.known?.picture !== picture || this.known.version !== this.version) {
      this.known = { picture, version: this.version, statistics: statistics(picture.halves, picture.components) };
    }
    return this.known.statistics;
  }

  /** The scale of false colour, when that's shown. */
  scale(): [number, number] | null {
    const found = this.isFalse ? this.statistics() : null;
    return found && scaleEnds(found);
  }

  /** The shown values at a pixel of the film. */
  values(x: number, y: number): number[] | null {
    const picture = this.picture;
    if (!picture) return null;
    const [x0, y0, x1, y1] = picture.crop;
    if (x < x0 || y < y0 || x >= x1 || y >= y1) return null;
    const column = Math.floor(((x - x0) * picture.width) / (x1 - x0));
    const line = Math.floor(((y - y0) * picture.height) / (y1 - y0));
    const at = (line * picture.width + column) * picture.components;
    return Array.from(picture.halves.subarray(at, at + picture.components), (bits) => VALUES[bits]!);
  }

  /** The pixel of the film at a place of the window, in CSS pixels; also outside of the film. */
  pixelAt(clientX: number, clientY: number): [number, number] {
    const [x, y] = this.devicePixel(clientX, clientY);
    const [u, v] = this.placement.pixelAt(x, y);
    return [Math.floor(u), Math.floor(v)];
  }

  /** Device pixels of the canvas at a place of the window. */
  devicePixel(clientX: number, clientY: number): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [(clientX - box.left) * devicePixelRatio, (clientY - box.top) * devicePixelRatio];
  }

  /** Draws before the next frame of the screen. */
  redraw(): void {
    this.queued ||= requestAnimationFrame(() => {
      this.queued = 0;
      this.draw();
    });
  }

  private draw(): void {
    const { gl, canvas, placement } = this;
    const width = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio));
    const height = Math.max(1, Math.round(canvas.clientHeight * devicePixelRatio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    placement.update(canvas, this.film);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const picture = this.picture;
    if (picture) {
      gl.useProgram(this.program);
      gl.bindTexture(gl.TEXTURE_2D, picture.texture);
      this.setUniforms(picture);
      // Where no picture is, nothing is computed: software drivers run the shader's whole length for such pixels, too.
      const { left, top, scale } = placement;
      const [x0, y0, x1, y1] = picture.crop;
      const [x, y] = [Math.floor(left + x0 * scale), Math.floor(top + y0 * scale)];
      const [right, bottom] = [Math.ceil(left + x1 * scale), Math.ceil(top + y1 * scale)];
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(x, height - bottom, right - x, bottom - y);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      gl.disable(gl.SCISSOR_TEST);
    }
    this.drawn();
  }

  private setUniforms(picture: Picture): void {
    const { gl, canvas, placement, tone } = this;
    const { left, top, scale } = placement;
    const [x0, y0, x1, y1] = picture.crop;
    const shown = [(x1 - x0) * scale, (y1 - y0) * scale] as const;
    const gain = Math.fround(2 ** tone.exposure);
    const usesMaximum = tone.name.startsWith('equalize') && !this.isFalse;
    const maximum = usesMaximum ? Math.min((this.statistics()?.maximum ?? 1) * gain, 1e9) : 1;
    gl.uniform2f(this.at('canvasSize'), canvas.width, canvas.height);
    gl.uniform2f(this.at('corner'), left + x0 * scale, top + y0 * scale);
    gl.uniform2f(this.at('shownSize'), ...shown);
    gl.uniform1i(this.at('isGrey'), Number(picture.components === 1));
    gl.uniform1i(this.at('isNearest'), Number(shown[0] >= picture.width));
    gl.uniform1i(this.at('isFalse'), Number(this.isFalse));
    gl.uniform1i(this.at('isMarked'), Number(this.isMarked));
    gl.uniform1f(this.at('gain'), gain);
    gl.uniform1i(this.at('curve'), Math.max(0, CURVES.indexOf(tone.name)));
    gl.uniform2f(this.at('values'), tone.values[0] ?? 1, tone.values[1] ?? 1);
    gl.uniform1f(this.at('maximum'), Math.max(maximum, 1.2e-38));
    gl.uniform2f(this.at('scaleEnds'), ...(this.scale() ?? [1, 10]));
  }

  private at(name: string): WebGLUniformLocation | null {
    if (!this.uniforms.has(name)) this.uniforms.set(name, this.gl.getUniformLocation(this.program, name));
    return this.uniforms.get(name)!;
  }
}

function link(gl: WebGL2RenderingContext): WebGLProgram {
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

/** The part of the film that a frame shows. */
function cropOf(frame: FrameMessage, film: { width: number; height: number }, region: Box | null): Box {
  if (frame.crop) return frame.crop;
  const [x, y] = frame.origin;
  // Frames of a moving camera have fewer pixels than they show.
  if (frame.kind === 'render') return [x, y, x + frame.width, y + frame.height];
  return region ?? [x, y, film.width - x, film.height - y];
}
