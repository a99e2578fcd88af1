/** A beside B: split, in turn, their difference, the map of errors. */

import type { Page } from '@playwright/test';
import { codes, expect, largest, open, srgb, test } from './fixture';
import { pattern, type Mock } from './mock';

/** Keeps the pattern as B, and lets a grey A come. */
async function keep(mock: Mock, page: Page, grey = 0.5): Promise<void> {
  await open(page, 'Compare');
  await page.getByRole('button', { name: 'Keep as B' }).click();
  await expect(page.getByText('B: kept at 64 spp, 96 × 64')).toBeVisible();
  mock.shade = () => [grey, grey, grey];
  mock.frame();
}

const show = (page: Page, mode: string) => page.getByLabel('Compare with B').selectOption(mode);
const ofB = (x: number, y: number) => pattern(x, y).map((v) => srgb(Math.min(v, 1)));
const ofA = Array<number>(3).fill(srgb(0.5));

test('B is at the right of a line that keys and the pointer move', async ({ mock, ready }) => {
  await expect(ready.getByLabel('Compare with B')).toHaveCount(1);
  await keep(mock, ready);
  const divider = ready.getByRole('slider', { name: 'Divider' });
  await expect(divider).toHaveAttribute('aria-valuenow', '50');
  const row = [[47, 20], [48, 20]]; // prettier-ignore
  await expect.poll(() => codes(ready, row)).toEqual([...ofA, ...ofB(48, 20)]);
  await divider.press('ArrowRight');
  await expect(divider).toHaveAttribute('aria-valuenow', '51');
  expect(await codes(ready, row)).toEqual([...ofA, ...ofA]);
  await divider.press('Home');
  await expect(divider).toHaveAttribute('aria-valuenow', '0');
  expect(await codes(ready, row)).toEqual([...ofB(47, 20), ...ofB(48, 20)]);
  await divider.press('End');
  await divider.press('Shift+ArrowLeft');
  await expect(divider).toHaveAttribute('aria-valuenow', '90');
  const [box, stage] = [(await divider.boundingBox())!, (await ready.locator('.stage').boundingBox())!];
  await ready.mouse.move(box.x + box.width / 2, box.y + 300);
  await ready.mouse.down();
  await ready.mouse.move(stage.x + stage.width / 2 - 20, box.y + 300, { steps: 3 });
  await ready.mouse.up();
  expect(await codes(ready, [[27, 20], [28, 20]])).toEqual([...ofA, ...ofB(28, 20)]); // prettier-ignore
  // Nothing of it moved the camera.
  expect(mock.received.filter((m) => m.type === 'camera')).toEqual([]);
  await ready.getByRole('button', { name: 'Clear B' }).click();
  await expect(divider).toBeHidden();
  expect(await codes(ready, row)).toEqual([...ofA, ...ofA]);
});

test('A and B take turns by the key, or by themselves, through the same exposure', async ({ mock, ready }) => {
  await keep(mock, ready);
  const canvas = ready.locator('canvas.picture');
  await canvas.press('b');
  await expect(ready.getByLabel('Compare with B')).toHaveValue('flip');
  await expect(ready.locator('.tag')).toHaveText('B');
  const place = [[3, 2]];
  await expect.poll(() => codes(ready, place)).toEqual(ofB(3, 2));
  await ready.getByLabel('Exposure in EV, slider').fill('1');
  expect(await codes(ready, place)).toEqual(pattern(3, 2).map((v) => srgb(Math.min(2 * v, 1))));
  await canvas.press('\\');
  await canvas.press('b');
  await expect(ready.locator('.tag')).toHaveText('A');
  await expect.poll(() => codes(ready, place)).toEqual(ofA);
  await ready.getByLabel('By itself').check();
  await expect(ready.locator('.tag')).toHaveText('B');
  await expect(ready.locator('.tag')).toHaveText('A');
});

test('the difference is grey where there is none', async ({ mock, ready }) => {
  await keep(mock, ready);
  await show(ready, 'difference');
  await ready.getByLabel('Gain of the difference', { exact: true }).fill('2');
  await ready.getByLabel('Gain of the difference', { exact: true }).press('Enter');
  const places = [[0, 0], [12, 5], [20, 8], [95, 63]]; // prettier-ignore
  const code = (b: number) => Math.round(255 * Math.min(Math.max(0.5 + 0.5 * 2 * (0.5 - b), 0), 1));
  const wanted = places.flatMap(([x, y]) => pattern(x!, y!).map(code));
  await expect.poll(async () => largest(await codes(ready, places), wanted)).toBeLessThanOrEqual(1);
  mock.shade = (x, y) => pattern(x, y);
  mock.frame();
  await expect.poll(async () => largest(await codes(ready, places), Array(12).fill(128))).toBeLessThanOrEqual(1);
});

test('the FLIP map comes with its scale and figures, once for each frame at most', async ({ mock, ready }) => {
  await keep(mock, ready);
  await ready.getByLabel('Tone curve').selectOption('agx');
  await show(ready, 'map');
  await expect(ready.locator('.legend')).toHaveAttribute('aria-label', 'FLIP error from 0, the same, to 1');
  await expect(ready.getByText('FLIP: mean 0.1234, 95 % below 0.5; relMSE 0.02; PSNR ∞ dB')).toBeVisible();
  expect(Object.fromEntries(mock.reference.asked.at(-1)!)).toEqual({ metric: 'flip', tone: 'agx', exposure: '0' });
  const magma = [0, 0, 4, 28, 16, 68, 79, 18, 123, 129, 37, 129, 181, 54, 122, 229, 89, 100, 251, 135, 97, 254, 194, 135, 252, 253, 191];
  const places = [0, 1, 2, 3, 4, 5, 6, 7, 8].map((x) => [x, 7]);
  expect(await codes(ready, places)).toEqual(magma);
  const before = mock.reference.asked.length;
  mock.frame();
  await expect.poll(() => mock.reference.asked.length).toBe(before + 1);
  // What is coarse is not compared.
  mock.frame({ kind: 'preview', reduced: 2 });
  await expect(ready.locator('.status-facts')).toContainText('preview');
  expect(mock.reference.asked.length).toBe(before + 1);
  await show(ready, 'off');
  await expect(ready.locator('.legend')).toBeHidden();
});

test('a file becomes B, and what is none is told', async ({ mock, ready }) => {
  await open(ready, 'Compare');
  const file = ready.getByLabel('Picture to load as B');
  await file.setInputFiles({ name: 'bad.exr', mimeType: 'image/x-exr', buffer: Buffer.from('v/1') });
  await expect(ready.locator('.toast.error')).toHaveText('bad.exr: the file ends early');
  await expect(ready.getByText('Nothing is kept as B.')).toBeVisible();
  await expect(ready.getByLabel('Compare with B')).toBeDisabled();
  await file.setInputFiles({ name: 'good.exr', mimeType: 'image/x-exr', buffer: Buffer.from('v/1\x01') });
  await expect(ready.getByText('B: good.exr, 96 × 64')).toBeVisible();
  await expect.poll(() => codes(ready, [[60, 1]])).toEqual([0.25, 0.5, 1].map(srgb));
  // It is there again after the page was loaded anew.
  await ready.reload();
  await open(ready, 'Compare');
  await expect(ready.getByText('B: good.exr, 96 × 64')).toBeVisible();
  mock.change({ film: { width: 48, height: 64 } });
  await expect(ready.getByText('B: good.exr, 96 × 64; the picture has 48 × 64')).toBeVisible();
});

test('what another page keeps as B is there, and is gone when that page clears it', async ({ mock, ready }) => {
  await open(ready, 'Compare');
  // As another page asks.
  const ask = (method: string) => ready.evaluate((method) => fetch('./api/reference?from=current', { method }).then((r) => r.ok), method);
  expect(await ask('POST')).toBe(true);
  mock.broadcast({ type: 'reference' });
  await expect(ready.getByText('B: kept at 64 spp, 96 × 64')).toBeVisible();
  expect(await ask('DELETE')).toBe(true);
  mock.broadcast({ type: 'reference' });
  await expect(ready.getByText('Nothing is kept as B.')).toBeVisible();
});
