/** Questions to the server of finished pictures. */

import type { AboutPicture, Figures, FirstLook, Listing, PicturePixel } from './protocol';
import { checked, parsePieces, type Pieces } from './reference';

const json = async <T>(address: string): Promise<T> => (await checked(await fetch(address))).json() as Promise<T>;

export const fetchLook = (): Promise<FirstLook> => json('./api/look');

/** The list, after the server has looked for changed files. */
export const fetchList = (): Promise<Listing[]> => json('./api/pictures');

/** All channels of a pixel. */
export const fetchPixel = (id: number, [x, y]: [number, number]): Promise<PicturePixel> => json(`./api/pixel?id=${id}&x=${x}&y=${y}`);

/** A layer of a picture; `null` where it has none of that name. */
export async function fetchPicture(id: number, layer: string): Promise<Pieces<AboutPicture> | null> {
  const response = await fetch(`./api/picture?${new URLSearchParams({ id: String(id), layer })}`);
  if (response.status === 404 && layer !== 'picture') return null;
  return parsePieces<AboutPicture>(await (await checked(response)).arrayBuffer());
}

/** The map of FLIP errors of what is displayed of a layer. */
export async function fetchFlip(a: number, b: number, layer: string, tone: string, exposure: number): Promise<Pieces<Figures>> {
  const query = new URLSearchParams({ a: String(a), b: String(b), layer, metric: 'flip', tone, exposure: String(exposure) });
  return parsePieces<Figures>(await (await checked(await fetch(`./api/difference?${query}`))).arrayBuffer());
}
