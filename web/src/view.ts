/** The canvas: draws the shown layer through exposure and tone curve, or in false colour, alone or with another picture. */

import { scaleEnds } from './falsecolor';
import { Groups } from './groups';
import { statistics, VALUES, type Statistics } from './half';
import { Layers, type Picture } from './layers';
import { Placement } from './placement';
import type { FrameEnd } from './protocol';
import type { Tile } from './tile';
import type { Box } from './vector';
import { link } from './shader';
import { CURVES, type Tone } from './tone';

/** How the picture is shown with the other one. */
export type Comparison = 'off' | 'split' | 'flip' | 'difference' | 'map';

/** The number of a picture's pixel at a pixel of the film; `null` outside of it. */
function indexIn({ crop: [x0, y0, x1, y1], width, height }: Picture, x: number, y: number): number | null {
  if (x < x0 || y < y0 || x >= x1 || y >= y1) return null;
  return Math.floor(((y - y0) * height) / (y1 - y0)) * width + Math.floor(((x - x0) * width) / (x1 - x0));
}

/** A picture's values at a pixel of the film; `null` outside of it. */
export function valuesIn(picture: Picture, x: number, y: number): number[] | null {
  const { components, halves } = picture;
  const pixel = indexIn(picture, x, y);
  return pixel === null ? null : Array.from(halves.subarray(pixel * components, (pixel + 1) * components), (bits) => VALUES[bits]!);
}

export class View {
  readonly canvas: HTMLCanvasElement;
  readonly placement = new Placement();
  readonly layers: Layers;
  /** `reference`, the picture's other one, and `map`, of how far they are apart. */
  readonly others: Layers;
  /** The light of each group of lights, where the server sends it. */
  readonly groups: Groups;
  comparison: Comparison = 'off';
  /** True if the other one has the shown layer, too, and not the picture alone. */
  comparesLayers = false;
  /** Where the picture ends and the other one begins, as a part of the canvas' width. */
  split = 0.5;
  /** Whether it's the other one's turn. */
  showsOther = false;
  differenceGain = 1;
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
    this.others = new Layers(gl);
    this.groups = new Groups(gl);
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
  frame(message: Pick<FrameEnd, 'crop' | 'lightGroups' | 'width' | 'height'>): void {
    this.layers.swap(message.crop);
    this.groups.swap(message.lightGroups, message.width, message.height);
    this.version++;
    this.redraw();
  }

  /** Pixels of the longest edge of a picture that can be drawn. */
  get longest(): number {
    return this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE) as number;
  }

  /** Whether a mix of groups of lights is shown. */
  get isMixed(): boolean {
    return this.layer === 'picture' && this.groups.names.length > 0;
  }

  /** Mixes groups of lights by these factors of red, green and blue. */
  mix(weights: Float32Array): void {
    this.groups.weights = weights;
    this.version++;
    this.redraw();
  }

  /** What the shown frame's pixels are like; counted once for each frame. */
  statistics(): Statistics | null {
    const picture = this.picture;
    if (!picture) return null;
    if (this.known?.picture !== picture || this.known.version !== this.version) {
      this.known = {
        picture,
        version: this.version,
        statistics: statistics(this.isMixed ? this.groups.mixed() : picture.halves, picture.components),
      };
    }
    return this.known.statistics;
  }

  /** What the picture is shown with, and how, as the shader counts. */
  compared(): [number, Picture | null] {
    const other =
      this.comparesLayers || this.layer === 'picture' ? this.others.shown(this.comparison === 'map' ? 'map' : 'reference') : null;
    const way = { off: 0, split: 1, flip: this.showsOther ? 2 : 0, difference: 3, map: 4 }[this.comparison];
    return other ? [way, other] : [0, null];
  }

  /** Whether the map of differences is shown. */
  get showsMap(): boolean {
    return this.compared()[0] === 4;
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
    const pixel = indexIn(picture, x, y);
    if (pixel !== null && this.isMixed) return this.groups.at(pixel);
    return valuesIn(picture, x, y);
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
    const [way, other] = this.compared();
    const [ox0, oy0, ox1, oy1] = (other ?? picture).crop;
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, (other ?? picture).texture);
    gl.activeTexture(gl.TEXTURE2);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.groups.texture);
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1i(this.at('other'), 1);
    gl.uniform1i(this.at('groups'), 2);
    gl.uniform1i(this.at('groupCount'), this.isMixed ? this.groups.names.length : 0);
    if (this.isMixed) gl.uniform3fv(this.at('weights'), this.groups.weights);
    gl.uniform2f(this.at('otherCorner'), left + ox0 * scale, top + oy0 * scale);
    gl.uniform2f(this.at('otherSize'), (ox1 - ox0) * scale, (oy1 - oy0) * scale);
    gl.uniform1i(this.at('comparison'), way);
    gl.uniform1f(this.at('split'), this.split * canvas.width);
    gl.uniform1f(this.at('differenceGain'), this.differenceGain);
    const gain = Math.fround(2 ** tone.exposure);
    const usesMaximum = tone.name.startsWith('equalize') && !this.isFalse;
    const maximum = usesMaximum ? Math.min((this.statistics()?.maximum ?? 1) * gain, 1e9) : 1;
    gl.uniform2f(this.at('canvasSize'), canvas.width, canvas.height);
    gl.uniform2f(this.at('corner'), left + x0 * scale, top + y0 * scale);
    gl.uniform2f(this.at('shownSize'), ...shown);
    gl.uniform1i(this.at('isGrey'), Number(picture.components === 1));
    gl.uniform1i(this.at('isOtherGrey'), Number(other?.components === 1));
    // Coarse previews are enlarged smoothly, pixels of the film are squares.
    gl.uniform1i(this.at('isNearest'), Number(shown[0] >= picture.width && picture.width >= x1 - x0));
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
