/** B, the picture that the shown one is compared with: the server keeps it. */

import type { Source } from './compare';
import { h } from './dom';
import type { AboutReference, Figures } from './protocol';
import { parseTile, type Tile } from './tile';

/** JSON and tiles. */
export interface Pieces<T> {
  head: T;
  tiles: Tile[];
}

/** An answer of JSON and tiles, each after its length. */
export function parsePieces<T>(buffer: ArrayBuffer): Pieces<T> {
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

/** An answer that does not refuse. */
export async function checked(response: Response): Promise<Response> {
  if (response.ok) return response;
  const body = (await response.json().catch(() => ({}))) as { error?: string };
  throw new Error(body.error ?? response.statusText);
}

/** B with its tiles; `null` where there is none. */
async function fetchReference(): Promise<Pieces<AboutReference> | null> {
  const response = await checked(await fetch('./api/reference'));
  return response.status === 204 ? null : parsePieces<AboutReference>(await response.arrayBuffer());
}

/** Makes the shown picture B, or a file. */
async function keepReference(file: File | null): Promise<void> {
  const body = new FormData();
  if (file) body.append('file', file, file.name);
  await checked(await fetch(`./api/reference${file ? '' : '?from=current'}`, file ? { method: 'POST', body } : { method: 'POST' }));
}

async function clearReference(): Promise<void> {
  await checked(await fetch('./api/reference', { method: 'DELETE' }));
}

/** The map of FLIP errors of what is displayed. */
async function fetchFlip(tone: string, exposure: number): Promise<Pieces<Figures>> {
  const query = new URLSearchParams({ metric: 'flip', tone, exposure: String(exposure) });
  const response = await checked(await fetch(`./api/difference?${query}`));
  return parsePieces<Figures>(await response.arrayBuffer());
}

/** B as the server keeps it: the shown picture as it was, or a file. */
export function keptReference(): Source {
  const clear = h('button', { disabled: true }, 'Clear B');
  return {
    fetch: fetchReference,
    flip: fetchFlip,
    controls: (act) => {
      const file = h('input', { type: 'file', hidden: true, tabindex: -1, 'aria-label': 'Picture to load as B' });
      file.addEventListener('change', () => {
        const chosen = file.files?.[0];
        file.value = '';
        if (chosen) act(() => keepReference(chosen));
      });
      const load = h('button', { title: 'EXR, PNG, HDR, PFM, JPEG, …', onclick: () => file.click() }, 'Load B');
      const keep = h('button', { title: 'Keep the picture as it is now', onclick: () => act(() => keepReference(null)) }, 'Keep as B');
      clear.addEventListener('click', () => act(clearReference));
      return [h('div', { class: 'buttons' }, keep, load, clear, file)];
    },
    update: (hasOther) => (clear.disabled = !hasOther),
  };
}
