/** Frames as textures: one is shown while the next one's tiles come. */

import type { Tile } from './tile';
import type { Box } from './vector';

/** A picture of halves, on the GPU and here. */
export interface Picture {
  texture: WebGLTexture;
  width: number;
  height: number;
  components: number;
  halves: Uint16Array;
  /** The part of the film that it shows. */
  crop: Box;
}

/** Puts a tile's halves among those of its frame. */
export function put(halves: Uint16Array, tile: Tile): void {
  const row = tile.width * tile.components;
  for (let y = 0; y < tile.height; y++) {
    halves.set(tile.halves.subarray(y * row, (y + 1) * row), ((tile.y + y) * tile.frameWidth + tile.x) * tile.components);
  }
}

interface Layer {
  front: Picture | null;
  back: Picture | null;
  /** Whether tiles came since the last frame. */
  isFresh: boolean;
}

export class Layers {
  private readonly layers = new Map<string, Layer>();

  constructor(private readonly gl: WebGL2RenderingContext) {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
  }

  /** The frame of a layer to be shown. */
  shown(layer: string): Picture | null {
    return this.layers.get(layer)?.front ?? null;
  }

  /** Takes a tile of the frame that comes. */
  tile(name: string, tile: Tile): void {
    const { gl } = this;
    const layer = this.layers.get(name) ?? { front: null, back: null, isFresh: false };
    this.layers.set(name, layer);
    const [width, height, components] = [tile.frameWidth, tile.frameHeight, tile.components];
    const back = layer.back;
    if (!back || back.width !== width || back.height !== height || back.components !== components) {
      if (back) gl.deleteTexture(back.texture);
      layer.back = this.create(width, height, components);
    }
    const picture = layer.back!;
    layer.isFresh = true;
    gl.bindTexture(gl.TEXTURE_2D, picture.texture);
    const format = components === 1 ? gl.RED : gl.RGB;
    gl.texSubImage2D(gl.TEXTURE_2D, 0, tile.x, tile.y, tile.width, tile.height, format, gl.HALF_FLOAT, tile.halves);
    put(picture.halves, tile);
  }

  /** A frame is whole: shows the layers that came with it, or this one of them, as a part of the film. */
  swap(crop: Box, only?: string): void {
    for (const [name, layer] of this.layers) {
      if (!layer.back || !layer.isFresh || (only !== undefined && name !== only)) continue;
      layer.back.crop = crop;
      layer.isFresh = false;
      [layer.front, layer.back] = [layer.back, layer.front];
    }
  }

  /** Forgets layers but these. */
  keep(names: string[]): void {
    for (const [name, layer] of this.layers) {
      if (names.includes(name)) continue;
      for (const picture of [layer.front, layer.back]) if (picture) this.gl.deleteTexture(picture.texture);
      this.layers.delete(name);
    }
  }

  private create(width: number, height: number, components: number): Picture {
    const { gl } = this;
    const texture = gl.createTexture()!;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, components === 1 ? gl.R16F : gl.RGB16F, width, height);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    return { texture, width, height, components, halves: new Uint16Array(width * height * components), crop: [0, 0, width, height] };
  }
}
