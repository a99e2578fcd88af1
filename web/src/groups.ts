/** The light of each group of lights: planes beside the picture, mixed by the shader, and here for single pixels. */

import { halfOf, VALUES } from './half';
import { put } from './layers';
import type { Tile } from './tile';

/** The number of the first group's plane; smaller ones are those of the picture and its layers. */
export const FIRST_PLANE = 256;
/** Most groups: the shader has a weight for each. */
export const MOST_GROUPS = 32;

export class Groups {
  /** Those of the shown frame, in the order of their planes; none where it came without. */
  names: string[] = [];
  /** All planes, as layers of one texture. */
  texture: WebGLTexture;
  /** Factors of red, green and blue for each group. */
  weights: Float32Array = new Float32Array(3 * MOST_GROUPS).fill(1);
  private size = [1, 1, 1];
  private front: Uint16Array[] = [];
  private back: Uint16Array[] = [];

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.texture = this.create();
  }

  /** Takes a tile of the frame that comes. */
  tile(group: number, tile: Tile): void {
    if (group >= MOST_GROUPS || tile.components !== 3) return;
    const count = 3 * tile.frameWidth * tile.frameHeight;
    if (this.back[group]?.length !== count) this.back[group] = new Uint16Array(count);
    put(this.back[group]!, tile);
  }

  /** A frame is whole: shows the planes that came with it, if any did. */
  swap(names: string[], width: number, height: number): void {
    const isWhole = names.length <= MOST_GROUPS && names.every((_, g) => this.back[g]?.length === 3 * width * height);
    this.names = isWhole ? names : [];
    if (this.names.length === 0) return;
    [this.front, this.back] = [this.back, this.front];
    const { gl } = this;
    const size = [width, height, names.length];
    if (size.some((n, i) => n !== this.size[i])) {
      this.size = size;
      gl.deleteTexture(this.texture);
      this.texture = this.create();
    }
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture);
    for (let g = 0; g < names.length; g++)
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, g, width, height, 1, gl.RGB, gl.HALF_FLOAT, this.front[g]!);
  }

  /** Forgets all planes. */
  clear(): void {
    if (this.front.length + this.back.length === 0) return;
    [this.names, this.front, this.back, this.size] = [[], [], [], [1, 1, 1]];
    this.gl.deleteTexture(this.texture);
    this.texture = this.create();
  }

  /** The mixed colour of a pixel, by its number. */
  at(pixel: number): [number, number, number] {
    const sum: [number, number, number] = [0, 0, 0];
    for (let g = 0; g < this.names.length; g++) {
      for (let c = 0; c < 3; c++) {
        const weight = this.weights[3 * g + c]!;
        if (weight > 0) sum[c]! += weight * VALUES[this.front[g]![3 * pixel + c]!]!;
      }
    }
    return sum;
  }

  /** The mixed picture. */
  mixed(): Uint16Array {
    const sums = new Float32Array(this.front[0]?.length ?? 0);
    for (let g = 0; g < this.names.length; g++) {
      const plane = this.front[g]!;
      for (let c = 0; c < 3; c++) {
        const weight = this.weights[3 * g + c]!;
        if (weight > 0) for (let i = c; i < sums.length; i += 3) sums[i]! += weight * VALUES[plane[i]!]!;
      }
    }
    return Uint16Array.from(sums, halfOf);
  }

  private create(): WebGLTexture {
    const { gl } = this;
    const [width, height, depth] = this.size as [number, number, number];
    const texture = gl.createTexture()!;
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGB16F, width, height, depth);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    return texture;
  }
}

/** `mixedAt(at)`: the weighted sum of all groups. One that's put out adds nothing, whatever it holds. */
export const MIX_GLSL = `
uniform highp sampler2DArray groups;
uniform int groupCount;                      // 0 where the picture is shown as it is
uniform vec3 weights[${MOST_GROUPS}];

vec3 mixedAt(vec2 at) {
  ivec2 size = textureSize(groups, 0).xy;
  ivec2 texel = min(ivec2(at * vec2(size)), size - 1);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < groupCount; i++) {
    vec3 v = isNearest ? texelFetch(groups, ivec3(texel, i), 0).rgb : texture(groups, vec3(at, float(i))).rgb;
    sum += mix(vec3(0.0), weights[i] * v, greaterThan(weights[i], vec3(0.0)));
  }
  return sum;
}
`;
