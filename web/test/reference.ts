/** The mock's B: what is kept or loaded, and the map of the differences. */

import type { IncomingMessage, ServerResponse } from 'node:http';
import type { AboutReference, Figures } from '../src/protocol';
import type { Mock } from './mock';

/** JSON and tiles, each after its length. */
function pieces(head: object, tiles: Buffer[]): Buffer {
  const length = (piece: Buffer) => {
    const bytes = Buffer.alloc(4);
    bytes.writeUInt32LE(piece.length);
    return bytes;
  };
  return Buffer.concat([Buffer.from(JSON.stringify(head)), ...tiles].flatMap((piece) => [length(piece), piece]));
}

export class Reference {
  about: AboutReference | null = null;
  /** Queries of maps. */
  asked: URLSearchParams[] = [];
  private tiles: Buffer[] = [];

  constructor(private readonly mock: Mock) {}

  /** Answers what is about B; whether it was. */
  answer(request: IncomingMessage, url: URL, path: string, body: string, response: ServerResponse): boolean {
    const json = (value: unknown, status = 200) =>
      response.writeHead(status, { 'content-type': 'application/json' }).end(JSON.stringify(value));
    const binary = (bytes: Buffer) => response.writeHead(200, { 'content-type': 'application/octet-stream' }).end(bytes);
    const { film, generation } = this.mock.state;
    const [width, height] = [film.width, film.height];
    if (path === 'api/difference') {
      this.asked.push(url.searchParams);
      const figures = { mean: 0.1234, quantile95: 0.5, relmse: 0.02, psnr: null };
      const head: Figures = { metric: 'flip', generation, crop: [0, 0, width, height], samples: 64, ...figures };
      // An eighth more with each pixel, and over again: the nine colours of the scale.
      binary(
        pieces(
          head,
          this.mock.plane(1, (x) => [(x % 9) / 8]),
        ),
      );
    } else if (path !== 'api/reference') return false;
    else if (request.method === 'DELETE') {
      this.about = null;
      response.writeHead(204).end();
    } else if (request.method === 'POST') {
      const name = /name="file"; filename="([^"]*)"/.exec(body)?.[1];
      if (name === 'bad.exr') json({ error: 'bad.exr: the file ends early' }, 422);
      else {
        this.about = { name: name ?? 'kept at 64 spp', width, height, crop: name === undefined ? [0, 0, width, height] : null };
        this.tiles = this.mock.plane(3, name === undefined ? this.mock.shade : () => [0.25, 0.5, 1]);
        json(this.about);
      }
    } else if (this.about) binary(pieces(this.about, this.tiles));
    else response.writeHead(204).end();
    return true;
  }
}
