/** A page at a fresh mock server, and what tests ask of both. */

import { expect, test as base, type Page } from '@playwright/test';
import type { PageMessage } from '../src/protocol';
import { Mock } from './mock';

export { expect };

export const test = base.extend<{ mock: Mock; ready: Page }>({
  mock: async ({}, use) => {
    const mock = new Mock();
    await mock.start();
    await use(mock);
    await mock.stop();
  },
  /** The page with its first picture at 1:1; fails on anything the page's console complains of. */
  ready: async ({ mock, page }, use) => {
    const faults: string[] = [];
    page.on('pageerror', (error) => faults.push(String(error)));
    page.on(
      'console',
      (message) => message.type() === 'error' && !/WebSocket|Failed to load/.test(message.text()) && faults.push(message.text()),
    );
    await page.goto(mock.url);
    await expect(page.locator('.status-facts')).toContainText('64 / 256 spp');
    await page.locator('canvas.picture').press('1');
    await use(page);
    expect(faults).toEqual([]);
  },
});

/** Codes of the canvas at pixels of the film, in one row: R, G, B, …; `scale` in canvas pixels a film pixel. */
export function codes(page: Page, places: number[][], film = { width: 96, height: 64 }): Promise<number[]> {
  return page.evaluate(
    ([places, film]) =>
      new Promise<number[]>((resolve) => {
        // The view draws in the next frame of the screen, and this reads right after.
        dispatchEvent(new Event('resize'));
        requestAnimationFrame(() => {
          const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
          const gl = canvas.getContext('webgl2')!;
          const [left, top] = [Math.round((canvas.width - film.width) / 2), Math.round((canvas.height - film.height) / 2)];
          const pixel = new Uint8Array(4);
          resolve(
            places.flatMap(([x, y]) => {
              gl.readPixels(left + x!, canvas.height - 1 - top - y!, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
              return [...pixel.slice(0, 3)];
            }),
          );
        });
      }),
    [places, film] as const,
  );
}

/** The largest difference of two lists of the same length. */
export function largest(a: number[], b: number[]): number {
  expect(a.length).toBe(b.length);
  return Math.max(...a.map((v, i) => Math.abs(v - b[i]!)));
}

/** Messages of a type that the page sent. */
export function sent<T extends PageMessage['type']>(mock: Mock, type: T): Extract<PageMessage, { type: T }>[] {
  return mock.received.filter((m): m is Extract<PageMessage, { type: T }> => m.type === type);
}

/** The middle of the picture in the window. */
export async function middle(page: Page): Promise<[number, number]> {
  const box = (await page.locator('canvas.picture').boundingBox())!;
  return [box.x + box.width / 2, box.y + box.height / 2];
}

/** Opens a folded section of the panel. */
export async function open(page: Page, title: string): Promise<void> {
  const section = page.locator('details.section', { has: page.locator('h2', { hasText: new RegExp(`^${title}`) }) });
  if (!(await section.evaluate((s: HTMLDetailsElement) => s.open))) await section.locator('> summary').click();
}

/** The 8-bit sRGB code of a linear value. */
export const srgb = (v: number): number => Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
