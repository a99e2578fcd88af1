/** What server and page say to each other. */

export type Vec3 = [number, number, number];
/** Pixels x0, y0, x1, y1, the last two exclusive. */
export type Box = [number, number, number, number];
export type Severity = 'error' | 'warning' | 'note';
export interface Message {
  severity: Severity;
  text: string;
}
export interface Named {
  name: string;
  doc: string;
}
export interface ToneParameter {
  name: string;
  doc: string;
  default: number;
  range: [number, number];
}
export interface ToneChoice {
  name: string;
  doc: string;
  encoding: string;
  parameters: ToneParameter[];
}

export interface CameraState {
  name: string | null;
  names: string[];
  kind: string;
  eye: Vec3;
  target: Vec3;
  up: Vec3;
  fov: number | null;
  handedness: number;
  moved: boolean;
  movable: boolean;
  /** What edits call it. */
  id: string;
  /** How long one along its axis is in the world. */
  unit: number;
  /** Radius of its lens, 0 for a pinhole; `null` where it has no focal distance. */
  lens: number | null;
}

export interface Settings {
  /** A name, or `name:key=value,…`; empty for the scene's. */
  integrator: string;
  spp: number;
  /** `null` for the one that suits. */
  sampler: string | null;
  color: string;
  /** `null` for the scene's, as with `maxDepth`. */
  seed: number | null;
  maxDepth: number | null;
  /** What removes the noise in the end, `null` for none; absent where the server does not denoise. */
  denoise?: string | null;
  /** Whether the light of each group of lights is sent along; absent where the server cannot. */
  lightGroups?: boolean;
}

export interface State {
  generation: number;
  scene: { name: string; path: string | null; faces: number; lights: number; materials: number; messages: Message[] };
  film: { width: number; height: number };
  region: Box | null;
  camera: CameraState;
  settings: Settings;
  choices: { integrators: Named[]; samplers: Named[]; denoisers?: Named[]; colors: string[]; tones: ToneChoice[]; layers: Named[] };
  layers: string[];
  tone: string;
  paused: boolean;
  undo: number;
  redo: number;
  command: string;
  /** What the scene is called when it is saved. */
  saveName: string;
}

/** What ends a frame: all tiles of its picture and layers came before. */
export interface FrameMessage {
  generation: number;
  /** Of the frame; a fraction of what it shows while the camera moves. */
  width: number;
  height: number;
  /** The film's pixel that the frame's first one shows. */
  origin: [number, number];
  kind: string;
  samples: number;
  target: number;
  error: number | null;
  seconds: number;
  done: boolean;
  nonfinite: number;
  /** The part of the film that the frame shows, where the server tells: x0, y0, x1, y1. */
  crop?: Box;
  /** The one layer that it ends, where it isn't all of them. */
  layer?: string;
  denoised?: boolean;
  /** The groups of lights whose planes came with it, in their order. */
  lightGroups?: string[];
}

export type ServerMessage =
  | ({ type: 'state' } & State)
  | ({ type: 'frame' } & FrameMessage)
  | ({ type: 'message' } & Message)
  | { type: 'reference' }
  /** A request was carried out, and the state with it told, or refused. */
  | { type: 'answered' };

export type PageMessage =
  | { type: 'camera'; eye: Vec3; target: Vec3; up: Vec3; fov?: number; moving: boolean }
  | { type: 'camera-name'; name: string }
  | { type: 'camera-reset' }
  | ({ type: 'settings' } & Partial<Settings & { width: number; height: number }>)
  | { type: 'region'; pixels: Box | null }
  | { type: 'layers'; names: string[] }
  | { type: 'edit'; node: string; parameter: string; value: string | null; moving?: boolean }
  | { type: 'undo' }
  | { type: 'redo' }
  | { type: 'pause'; on: boolean };

export type Range = [number | null, number | null];

export interface NodeParameter {
  name: string;
  value: string | null;
  default: string | null;
  type: string;
  unit: string;
  doc: string;
  words: string[];
  /** Ends; `null` for one that's infinite. */
  range: Range | null;
}
export interface SceneNode {
  id: string;
  family: string;
  kind: string;
  parameters: NodeParameter[];
}

export type Sample = number | 'NaN' | 'Infinity' | '-Infinity';
export interface Pixel {
  x: number;
  y: number;
  generation: number;
  samples: number;
  error: number | null;
  object: string | null;
  material: string | null;
  channels: Record<string, Sample>;
}

/** A place or a direction in the picture, in pixels from its left upper corner. */
export type Place = [number, number];
export interface PathVertex {
  kind: 'camera' | 'surface' | 'medium' | 'escaped';
  position: Vec3;
  normal: Vec3 | null;
  object: string | null;
  material: string | null;
  /** `null` behind the camera. */
  place: Place | null;
  /** The unit direction in the picture in which the path goes on. */
  onwards: Place | null;
  /** What the path carries when it arrives. */
  weight: Vec3;
  emitted: Vec3;
  /** The light sample: black where something is before the light; without a position where that is infinitely far. */
  direct: { position: Vec3 | null; place: Place | null; onwards: Place | null; light: Vec3 } | null;
  /** How the path goes on; `null` where it ends. */
  event: string | null;
}
/** The path of one sample of a pixel. */
export interface TracedPath {
  x: number;
  y: number;
  sample: number;
  generation: number;
  tracer: string;
  /** Whether the picture is made of such paths. */
  of_picture: boolean;
  value: Vec3;
  end: 'escaped' | 'absorbed' | 'depth' | 'roulette' | 'not finite' | 'too long';
  vertices: PathVertex[];
}

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
