/** B, the picture that the shown one is compared with: the server keeps it. */

import type { AboutReference, Figures } from './protocol';
import { parseTile, type Tile } from './tile';

/** An answer of JSON and tiles, each after its length. */
export function parsePieces<T>(buffer: ArrayBuffer): { head: T; tiles: Tile[] } {
  const view = new DataView(buffer);
  const pieces: ArrayBuffer[] = [];
  for (let at = 0; at + 4 <= buffer.byteLength; ) {
    const end = at + 4 + view.getUint32(at, true);
    // A copy, so that halves begin at an even place.
    pieces.push(buffer.slice(at + 4, end));
    at = end;
  }
  const head = JSON.parse(new TextDecoder().decode(pieces[0])) as T;
  return { head, tiles: pieces.slice(1).flatMap((piece) => parseTile(piece) ?? []) };
}

async function checked(response: Response): Promise<Response> {
  if (response.ok) return response;
  const body = (await response.json().catch(() => ({}))) as { error?: string };
  throw new Error(body.error ?? response.statusText);
}

/** B with its tiles; `null` where there is none. */
export async function fetchReference(): Promise<{ head: AboutReference; tiles: Tile[] } | null> {
  const response = await checked(await fetch('./api/reference'));
  return response.status === 204 ? null : parsePieces<AboutReference>(await response.arrayBuffer());
}

/** Makes the shown picture B, or a file. */
export async function keepReference(file: File | null): Promise<void> {
  const body = new FormData();
  if (file) body.append('file', file, file.name);
  await checked(await fetch(`./api/reference${file ? '' : '?from=current'}`, file ? { method: 'POST', body } : { method: 'POST' }));
}

export async function clearReference(): Promise<void> {
  await checked(await fetch('./api/reference', { method: 'DELETE' }));
}

/** The map of FLIP errors of what is displayed. */
export async function fetchFlip(tone: string, exposure: number): Promise<{ head: Figures; tiles: Tile[] }> {
  const query = new URLSearchParams({ metric: 'flip', tone, exposure: String(exposure) });
  const response = await checked(await fetch(`./api/difference?${query}`));
  return parsePieces<Figures>(await response.arrayBuffer());
}
