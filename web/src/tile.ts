/** Rectangles of pictures in binary messages. */

/** A rectangle of a frame's layer. */
export interface Tile {
  generation: number;
  layer: number;
  components: number;
  frameWidth: number;
  frameHeight: number;
  x: number;
  y: number;
  width: number;
  height: number;
  halves: Uint16Array;
}

const MAGIC = 0x54525453;
const HEADER = 24;

/** The tile in a binary message, or `null` where it isn't one. */
export function parseTile(buffer: ArrayBuffer): Tile | null {
  if (buffer.byteLength < HEADER) return null;
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== MAGIC) return null;
  const short = (at: number) => view.getUint16(at, true);
  const tile = {
    generation: view.getUint32(4, true),
    layer: short(8),
    components: short(10),
    frameWidth: short(12),
    frameHeight: short(14),
    x: short(16),
    y: short(18),
    width: short(20),
    height: short(22),
  };
  const count = tile.width * tile.height * tile.components;
  const whole = buffer.byteLength === HEADER + 2 * count && (tile.components === 1 || tile.components === 3);
  const inside = tile.x + tile.width <= tile.frameWidth && tile.y + tile.height <= tile.frameHeight;
  return whole && inside && count > 0 ? { ...tile, halves: new Uint16Array(buffer, HEADER, count) } : null;
}
