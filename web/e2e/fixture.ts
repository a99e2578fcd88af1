/** The page at the program, and what tests ask of both. */

import { expect, test as base, type Page } from '@playwright/test';
import { largest, open } from '../test/fixture';
import { Program } from './program';

export { expect, open };

export const FILM = { width: 96, height: 64 };

interface Watched {
  /** What a console may say in this test: answers that refuse are told there. */
  allowed: RegExp[];
}

export const test = base.extend<{ program: Program; view: Page } & Watched>({
  allowed: async ({}, use) => use([]),
  program: async ({}, use) => {
    const program = await Program.start('builtin:cornell-box', '--size', `${FILM.width}x${FILM.height}`, '--spp', '4');
    await use(program);
    await program.stop();
  },
  /** Any page; it fails on whatever its console complains of. */
  page: async ({ page, allowed, context }, use) => {
    const faults: string[] = [];
    const note = (text: string) => allowed.some((a) => a.test(text)) || faults.push(text);
    const watch = (page: Page) => {
      page.on('pageerror', (error) => note(String(error)));
      page.on('console', (message) => ['error', 'warning'].includes(message.type()) && !isOfGl(message.text()) && note(message.text()));
    };
    await context.addInitScript(keepTold);
    watch(page);
    context.on('page', watch);
    await context.grantPermissions(['clipboard-read', 'clipboard-write']);
    await use(page);
    expect(faults, 'the console').toEqual([]);
  },
  /** The page with its final picture, one pixel for each. */
  view: async ({ program, page }, use) => {
    await show(page, program);
    await use(page);
  },
});

/** What software drivers say of reading pixels back is about these tests. */
const isOfGl = (text: string) => /GL Driver Message|Automatic fallback to software WebGL/.test(text);

export async function show(page: Page, program: Program): Promise<void> {
  await page.goto(program.url);
  await done(page);
  await page.locator('canvas.picture').press('1');
}

/** Waits until the picture has all its samples. */
export async function done(page: Page): Promise<void> {
  await expect(page.locator('.status')).toHaveAttribute('data-what', 'done');
}

/** What the server told, in its order, kept by the page for these tests. */
interface Told {
  type: string;
  generation: number;
  kind?: string;
  done?: boolean;
}

/** Keeps what the server tells, before the page takes it. */
function keepTold(): void {
  const told: Told[] = [];
  Object.assign(window, { told });
  window.WebSocket = class extends WebSocket {
    constructor(...of: ConstructorParameters<typeof WebSocket>) {
      super(...of);
      this.addEventListener('message', ({ data }) => {
        if (typeof data !== 'string') return;
        const { type, generation, kind, done } = JSON.parse(data) as Told;
        told.push({ type, generation, ...(type === 'frame' ? { kind: kind!, done: done! } : {}) });
      });
    }
  };
}

const told = (page: Page): Promise<Told[]> => page.evaluate(() => (window as unknown as { told: Told[] }).told);

/** The generation of the newest state. */
export const generation = async (page: Page): Promise<number> =>
  Math.max(0, ...(await told(page)).filter((t) => t.type === 'state').map((t) => t.generation));

/** A change that renders anew: waits for the finished picture of it. The frames that came, `preview` or `render`. */
export async function anew(page: Page, change: () => Promise<unknown>): Promise<string[]> {
  const before = await generation(page);
  await change();
  await page.waitForFunction((before) => {
    const { told } = window as unknown as { told: Told[] };
    const newest = Math.max(...told.filter((t) => t.type === 'state').map((t) => t.generation));
    return newest > before && told.some((t) => t.type === 'frame' && t.generation === newest && t.kind === 'render' && t.done);
  }, before);
  return (await told(page)).flatMap((t) => (t.generation > before ? (t.kind ?? []) : []));
}

/** The canvas's codes of all pixels of the film, rows from the top: R, G, B, …. */
export function canvas(page: Page, film = FILM): Promise<number[]> {
  return page.evaluate(
    (film) =>
      new Promise<number[]>((resolve) => {
        // The view draws in the next frame of the screen, and this reads right after.
        dispatchEvent(new Event('resize'));
        requestAnimationFrame(() => {
          const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
          const gl = canvas.getContext('webgl2')!;
          const { width, height } = film;
          const [left, top] = [Math.round((canvas.width - width) / 2), Math.round((canvas.height - height) / 2)];
          const rgba = new Uint8Array(4 * width * height);
          gl.readPixels(left, canvas.height - top - height, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
          const row = (y: number) => [...rgba.subarray(4 * width * y, 4 * width * (y + 1))].filter((_, i) => i % 4 < 3);
          resolve(Array.from({ length: height }, (_, y) => row(height - 1 - y)).flat());
        });
      }),
    film,
  );
}

/** The codes of a PNG, as browsers decode it. */
export function codesOf(page: Page, png: Buffer): Promise<number[]> {
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]), { colorSpaceConversion: 'none' });
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d')!;
    context.drawImage(bitmap, 0, 0);
    return [...context.getImageData(0, 0, bitmap.width, bitmap.height).data].filter((_, i) => i % 4 < 3);
  }, png.toString('base64'));
}

/** The command that the page gives for its picture. */
export async function command(page: Page): Promise<string> {
  await open(page, 'Save');
  await page.evaluate(() => navigator.clipboard.writeText(''));
  await page.getByRole('button', { name: 'Copy command' }).click();
  await expect.poll(() => page.evaluate(() => navigator.clipboard.readText())).toMatch(/^steradian render /);
  return page.evaluate(() => navigator.clipboard.readText());
}

/** Renders by the page's own command, and finds the same codes on the canvas as in the PNG; the EXR is `OUT.exr`. */
export async function expectSame(page: Page, program: Program, out: string, ...look: string[]): Promise<void> {
  const shown = await canvas(page);
  await program.run(await command(page), '-o', `${out}.exr`, '-o', `${out}.png`, ...look);
  const codes = await codesOf(page, await program.read(`${out}.png`));
  expect(new Set(codes).size, 'a picture of something').toBeGreaterThan(30);
  expect(largest(shown, codes), `canvas against ${out}.png`).toBeLessThanOrEqual(1);
}

/** A file that the page lets one download, as it is in the program's folder then. */
export async function download(page: Page, program: Program, link: string, name: string): Promise<void> {
  const coming = page.waitForEvent('download');
  await page.getByRole('link', { name: link, exact: true }).click();
  await (await coming).saveAs(`${program.folder}/${name}`);
}

/** The middle of a pixel of the film in the window, at 1:1. */
export async function place(page: Page, x: number, y: number): Promise<[number, number]> {
  const box = (await page.locator('canvas.picture').boundingBox())!;
  const start = (whole: number, part: number) => Math.round((whole - part) / 2);
  return [box.x + start(box.width, FILM.width) + x + 0.5, box.y + start(box.height, FILM.height) + y + 0.5];
}

/** How many of the film's pixels have another code. */
export function differing(a: number[], b: number[]): number {
  expect(a.length).toBe(b.length);
  return a.filter((v, i) => i % 3 === 0 && (v !== b[i] || a[i + 1] !== b[i + 1] || a[i + 2] !== b[i + 2])).length;
}
