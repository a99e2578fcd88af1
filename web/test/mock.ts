/** A server that speaks the protocol: pictures of a pattern, state, nodes, pixels. The page's tests talk to it. */

import { createServer, type IncomingMessage, type ServerResponse } from 'node:http';
import { readFile } from 'node:fs/promises';
import type { AddressInfo } from 'node:net';
import { WebSocketServer, type WebSocket } from 'ws';
import type { FrameEnd, NodeState, Outline, PageMessage, Pixel, State } from '../src/protocol';
import { toHalf } from './half';
import { pathOf } from './path';
import { Reference } from './reference';
import { firstNodes, firstState } from './scene';

const PAGE = new URL('../../crates/server/page/', import.meta.url);
const TOKEN = 'token';
const TILE_ROWS = 20;
const TYPES: Record<string, string> = { html: 'text/html; charset=utf-8', js: 'text/javascript', css: 'text/css' };
const CSP = "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; connect-src 'self'";

/** The pattern's pixel: linear RGB up to 4. `tones.py` has the same. */
export function pattern(x: number, y: number, width = 96, height = 64): [number, number, number] {
  return [(4 * x) / (width - 1), (4 * y) / (height - 1), ((x * 7 + y * 13) % 64) / 16];
}

/** A plane of the whole film that is none of a frame. */
const FILM = { width: 0, height: 0, layer: 0xffff, generation: 0 };

type Shade = (x: number, y: number) => [number, number, number];

export class Mock {
  /** What pages sent. */
  received: PageMessage[] = [];
  /** Bodies that were posted, by path. */
  posted: { path: string; body: string }[] = [];
  state: State = firstState();
  nodes: NodeState[] = firstNodes();
  /** What the picture is of. */
  shade: Shade = (x, y) => pattern(x, y, this.state.film.width, this.state.film.height);
  /** Whether a camera is answered by a picture. */
  answersCamera = true;
  samples = 64;
  /** Why settings are refused, where they are. */
  refuses: string | null = null;
  /** What is waited for before a request is carried out. */
  delay: Promise<void> | null = null;
  /** The light of groups by their names, sent where they are asked for. */
  groups: [string, Shade][] = [];
  /** Where the point of a pixel is, as channels. */
  places: (x: number, y: number) => Pixel['channels'] = () => ({});
  /** The object of all pixels, and the pixels of its outline. */
  object: string | null = 'sphere 2';
  runs: Outline['runs'] = [
    [0, 1, 3],
    [1, 0, 4],
  ];
  /** How many paths were asked for. */
  paths = 0;
  readonly reference = new Reference(this);

  private readonly sockets = new Set<WebSocket>();
  private readonly http = createServer((request, response) => void this.answer(request, response));
  private readonly ws = new WebSocketServer({ server: this.http, path: `/${TOKEN}/api/socket` });
  private port = 0;

  async start(port = 0): Promise<void> {
    this.ws.on('connection', (socket) => {
      this.sockets.add(socket);
      socket.on('close', () => this.sockets.delete(socket));
      socket.on('message', (data) => void this.carryOut(JSON.parse(String(data)) as PageMessage, socket));
      socket.send(this.stateText());
      this.frame({}, [socket]);
    });
    await new Promise<void>((resolve) => this.http.listen(port, '127.0.0.1', resolve));
    this.port = (this.http.address() as AddressInfo).port;
  }

  get url(): string {
    return `http://127.0.0.1:${this.port}/${TOKEN}/`;
  }

  /** Cuts all connections. */
  drop(): void {
    for (const socket of this.sockets) socket.terminate();
  }

  async stop(): Promise<void> {
    this.drop();
    this.ws.close();
    this.http.closeAllConnections();
    await new Promise((resolve) => this.http.close(resolve));
  }

  broadcast(message: object): void {
    for (const socket of this.sockets) socket.send(JSON.stringify(message));
  }

  /** A change of state is told. */
  change(change: Partial<State>): void {
    this.state = { ...this.state, ...change, generation: this.state.generation + 1 };
    for (const socket of this.sockets) socket.send(this.stateText());
  }

  /** Sends a frame of the picture and the chosen layers, tile by tile, at 1/`reduced` of the size of what's rendered. */
  frame(more: Partial<FrameEnd> & { reduced?: number } = {}, to: Iterable<WebSocket> = this.sockets): void {
    const { reduced = 1, ...message } = more;
    const { film, generation, settings, region, layers } = this.state;
    const [x0, y0, x1, y1] = region ?? [0, 0, film.width, film.height];
    const [width, height] = [Math.ceil((x1 - x0) / reduced), Math.ceil((y1 - y0) / reduced)];
    for (const [index, layer] of ['picture', ...layers].entries()) {
      const components = layer === 'depth' ? 1 : 3;
      for (let y = 0; y < height; y += TILE_ROWS) {
        // Tiles of two widths try every offset.
        for (const [x, w] of width > 40
          ? ([
              [0, 33],
              [33, width - 33],
            ] as const)
          : ([[0, width]] as const)) {
          const h = Math.min(TILE_ROWS, height - y);
          const tile = this.tile(layer, components, { generation, index, width, height, x, y, w, h, reduced, x0, y0 });
          for (const socket of to) socket.send(tile);
        }
      }
    }
    // A preview is without.
    const groups = settings.lightGroups && reduced === 1 ? this.groups : [];
    groups.forEach(([, shade], group) => {
      const tiles = this.plane(3, shade, { width, height, layer: 256 + group, generation });
      for (const socket of to) for (const tile of tiles) socket.send(tile);
    });
    const frame: FrameEnd = {
      generation,
      width,
      height,
      origin: [x0, y0],
      crop: [x0, y0, x1, y1],
      kind: 'render',
      samples: this.samples,
      target: settings.spp,
      error: 0.021,
      seconds: 1.25,
      done: this.samples >= settings.spp,
      denoised: false,
      nonfinite: 0,
      lightGroups: groups.map(([name]) => name),
      ...message,
    };
    for (const socket of to) socket.send(JSON.stringify({ type: 'frame', ...frame }));
  }

  private tile(
    layer: string,
    components: number,
    t: Record<'generation' | 'index' | 'width' | 'height' | 'x' | 'y' | 'w' | 'h' | 'reduced' | 'x0' | 'y0', number>,
  ): Buffer {
    const buffer = Buffer.alloc(24 + 2 * t.w * t.h * components);
    buffer.writeUInt32LE(0x54525453, 0);
    buffer.writeUInt32LE(t.generation, 4);
    [t.index, components, t.width, t.height, t.x, t.y, t.w, t.h].forEach((v, i) => buffer.writeUInt16LE(v, 8 + 2 * i));
    let at = 24;
    for (let y = t.y; y < t.y + t.h; y++) {
      for (let x = t.x; x < t.x + t.w; x++) {
        const rgb =
          layer === 'picture'
            ? this.shade(t.x0 + x * t.reduced, t.y0 + y * t.reduced)
            : layer === 'depth'
              ? [x / t.width]
              : [0.8, 0.25, y / t.height];
        for (const v of rgb) at = buffer.writeUInt16LE(toHalf(v), at);
      }
    }
    return buffer;
  }

  /** A plane as one tile. */
  plane(components: 1 | 3, shade: (x: number, y: number) => number[], of: Partial<typeof FILM> = {}): Buffer[] {
    const { width, height, layer, generation } = { ...FILM, ...this.state.film, ...of };
    const buffer = Buffer.alloc(24 + 2 * width * height * components);
    buffer.writeUInt32LE(0x54525453, 0);
    buffer.writeUInt32LE(generation, 4);
    [layer, components, width, height, 0, 0, width, height].forEach((v, i) => buffer.writeUInt16LE(v, 8 + 2 * i));
    let at = 24;
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) for (const v of shade(x, y)) at = buffer.writeUInt16LE(toHalf(v), at);
    }
    return [buffer];
  }

  private stateText(): string {
    return JSON.stringify({ type: 'state', ...this.state });
  }

  private async carryOut(message: PageMessage, socket: WebSocket): Promise<void> {
    this.received.push(message);
    if (this.delay) await this.delay;
    this.take(message);
    socket.send(JSON.stringify({ type: 'answered' }));
  }

  private take(message: PageMessage): void {
    const { state } = this;
    if (message.type === 'camera') {
      const { eye, target, up, fov } = message;
      this.change({ camera: { ...state.camera, eye, target, up, fov: fov ?? state.camera.fov, moved: true } });
      if (this.answersCamera) this.frame(message.moving ? { kind: 'preview', reduced: 2, error: null, done: false } : {});
    } else if (message.type === 'settings' && this.refuses !== null) {
      this.broadcast({ type: 'message', severity: 'error', text: this.refuses });
    } else if (message.type === 'settings') {
      const { type: _, width = state.film.width, height = state.film.height, spp, ...settings } = message;
      this.change({ settings: { ...state.settings, ...settings, spp: spp ?? state.settings.spp }, film: { width, height } });
      this.frame();
    } else if (message.type === 'layers') {
      this.change({ layers: message.names });
      this.frame();
    } else if (message.type === 'edit') {
      const parameter = this.nodes.find((n) => n.id === message.node)?.parameters.find((p) => p.name === message.parameter);
      if (!parameter) return this.broadcast({ type: 'message', severity: 'error', text: `no parameter '${message.parameter}'` });
      parameter.value = message.value;
      this.change({ undo: state.undo + 1, redo: 0 });
      this.frame();
    } else if (message.type === 'undo') this.change({ undo: Math.max(0, state.undo - 1), redo: state.redo + 1 });
    else if (message.type === 'redo') this.change({ undo: state.undo + 1, redo: Math.max(0, state.redo - 1) });
    else if (message.type === 'region') {
      this.change({ region: message.pixels });
      this.frame();
    } else if (message.type === 'pause') this.change({ paused: message.on });
    else if (message.type === 'camera-reset') this.change({ camera: firstState().camera });
    else if (message.type === 'camera-name') this.change({ camera: { ...firstState().camera, name: message.name } });
  }

  private async answer(request: IncomingMessage, response: ServerResponse): Promise<void> {
    const url = new URL(request.url ?? '', this.url);
    const path = url.pathname.slice(TOKEN.length + 2);
    const json = (body: unknown, status = 200) =>
      response.writeHead(status, { 'content-type': 'application/json' }).end(JSON.stringify(body));
    if (!url.pathname.startsWith(`/${TOKEN}/`)) return void json({ error: 'not found' }, 404);
    let body = '';
    if (request.method === 'POST') {
      const chunks: Buffer[] = [];
      for await (const chunk of request) chunks.push(chunk as Buffer);
      body = Buffer.concat(chunks).toString('latin1');
      this.posted.push({ path, body });
      if (path === 'api/save') return void json({ saved: `/scenes/${(JSON.parse(body) as { name: string }).name}` });
      if (path === 'api/open') return void json({ messages: ['no scene among the files'] }, 422);
    }
    if (this.reference.answer(request, url, path, body, response)) return;
    if (path === 'api/state') return void json(this.state);
    if (path === 'api/nodes') return void json(this.nodes);
    if (path === 'api/outline')
      return void json({ generation: this.state.generation, origin: [8, 8], pixel: [2, 2], runs: this.runs, handle: null });
    if (path === 'api/pixel') return void this.pixel(url.searchParams, json);
    if (path === 'api/path') {
      this.paths++;
      const told = pathOf(this.state, url.searchParams);
      return void json(told, 'error' in told ? 400 : 200);
    }
    if (/^api\/(picture|scene)\./.test(path))
      return void response.writeHead(200, { 'content-type': 'application/octet-stream' }).end('file');
    const name = path === '' ? 'index.html' : path;
    const type = TYPES[name.split('.').pop() ?? ''];
    const file = type && !name.includes('..') ? await readFile(new URL(name, PAGE)).catch(() => null) : null;
    if (!file) return void json({ error: 'not found' }, 404);
    response.writeHead(200, { 'content-type': type, 'content-security-policy': CSP, 'cache-control': 'no-store' }).end(file);
  }

  private pixel(query: URLSearchParams, json: (body: unknown, status?: number) => unknown): void {
    const [x, y] = [Number(query.get('x')), Number(query.get('y'))];
    const { film, generation } = this.state;
    if (!(x >= 0 && y >= 0 && x < film.width && y < film.height)) return void json({ error: `the picture has no pixel ${x}, ${y}` }, 404);
    const value = (v: number) => (Number.isFinite(v) ? v : String(v));
    const [R, G, B] = this.shade(x, y).map(value);
    const channels = { R, G, B, 'albedo.R': 0.8, 'albedo.G': 0.25, 'albedo.B': y / film.height, depth: 3.25, ...this.places(x, y) };
    json({
      x,
      y,
      generation,
      samples: this.samples,
      error: 0.0123,
      object: this.object,
      material: 'red glass',
      light: null,
      hasSurface: true,
      channels,
    });
  }
}
