/** What the canvas shows: tiles, frames, exposure, tone curves, false colour. */

import { readFileSync } from 'node:fs';
import { codes, expect, largest, srgb, test } from './fixture';
import { pattern } from './mock';

interface Case {
  tone: string;
  exposure: number;
  rgb: number[];
}
const expected = JSON.parse(readFileSync(new URL('./tones.json', import.meta.url), 'utf8')) as {
  places: number[][];
  false: number[];
  cases: Case[];
};

test('tiles become pixels', async ({ ready }) => {
  const places = [
    [0, 0],
    [95, 0],
    [0, 63],
    [95, 63],
    [32, 19],
    [33, 20],
    [50, 40],
  ];
  const wanted = places.flatMap(([x, y]) => pattern(x!, y!).map((v) => srgb(Math.min(v, 1))));
  expect(largest(await codes(ready, places), wanted)).toBeLessThanOrEqual(1);
});

test('the slider and the keys change the exposure', async ({ ready }) => {
  const shown = async () => (await codes(ready, [[3, 2]]))[0]!;
  const red = pattern(3, 2)[0];
  expect(await shown()).toBe(srgb(red));
  await ready.getByLabel('Exposure in EV, slider').fill('-2');
  expect(await shown()).toBe(srgb(red / 4));
  await ready.locator('canvas.picture').press(']');
  await ready.locator('canvas.picture').press(']');
  await ready.locator('canvas.picture').press(']');
  expect(await shown()).toBe(srgb(red * 2 ** -0.5));
  await expect(ready.getByLabel('Exposure in EV', { exact: true })).toHaveValue('-0.5');
});

test('every tone curve is that of `steradian convert`', async ({ ready }) => {
  test.setTimeout(120_000);
  for (const { tone, exposure, rgb } of expected.cases) {
    const [name, parameters] = tone.split(':');
    await ready.getByLabel('Tone curve').selectOption(name!);
    for (const setting of parameters?.split(',') ?? []) {
      const [key, value] = setting.split('=');
      const field = ready.getByLabel(`${name}: ${key}`, { exact: true });
      await field.fill(value!);
      await field.press('Enter');
    }
    const field = ready.getByLabel('Exposure in EV', { exact: true });
    await field.fill(String(exposure));
    await field.press('Enter');
    expect(largest(await codes(ready, expected.places), rgb), `${tone} at ${exposure} EV`).toBeLessThanOrEqual(1);
  }
});

test('false colour is that of `steradian convert`', async ({ ready }) => {
  await ready.getByLabel('False colour').check();
  expect(largest(await codes(ready, expected.places), expected.false)).toBeLessThanOrEqual(1);
  await expect(ready.locator('.legend')).toBeVisible();
  await expect(ready.locator('.legend')).toContainText('cd/m²');
});

test('what is not finite is magenta and counted', async ({ mock, ready }) => {
  mock.shade = (x, y) => (x === 5 && y === 6 ? [NaN, 1, 1] : x === 6 && y === 6 ? [0, Infinity, 0] : [0.5, 0.5, 0.5]);
  mock.frame({ nonfinite: 2 });
  await expect(ready.locator('.status-facts')).toContainText('2 not finite');
  await expect(ready.locator('details.section', { hasText: 'Histogram' })).toContainText('not finite: 2');
  expect(
    await codes(ready, [
      [5, 6],
      [6, 6],
      [7, 6],
    ]),
  ).toEqual([255, 0, 255, 255, 0, 255, 188, 188, 188]);
  await ready.getByLabel('Mark NaN').uncheck();
  expect(
    await codes(ready, [
      [5, 6],
      [6, 6],
    ]),
  ).toEqual([0, 255, 255, 0, 255, 0]);
});

test('a frame is shown when it is whole', async ({ mock, ready }) => {
  mock.shade = () => [1, 1, 1];
  // Tiles without the message that ends the frame; then any message, to know that they have come.
  const { broadcast } = mock;
  mock.broadcast = () => {};
  const sockets = [...(mock as unknown as { sockets: Set<{ send(data: unknown): void }> }).sockets];
  mock.frame({}, sockets.map((s) => ({ send: (data: unknown) => typeof data !== 'string' && s.send(data) })) as never);
  mock.broadcast = broadcast;
  mock.broadcast({ type: 'message', severity: 'note', text: 'tiles came' });
  await expect(ready.locator('.toast')).toHaveText('tiles came');
  expect(await codes(ready, [[0, 0]])).toEqual([0, 0, 0]);
  mock.frame();
  await expect.poll(() => codes(ready, [[0, 0]])).toEqual([255, 255, 255]);
});

test('a frame of half the size fills the film, smoothly', async ({ mock, ready }) => {
  mock.shade = (x) => (x < 48 ? [1, 0, 0] : [0, 0, 1]);
  mock.frame({ reduced: 2, kind: 'preview' });
  await expect(ready.locator('.status-facts')).toContainText('preview');
  expect(
    await codes(ready, [
      [0, 0],
      [46, 63],
      [49, 0],
      [95, 63],
    ]),
  ).toEqual([255, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0, 255]);
  const [r, g, b] = await codes(ready, [[47, 30]]);
  expect([r! > b!, g, b! > 0]).toEqual([true, 0, true]);
});

test('layers are asked for and shown', async ({ mock, ready }) => {
  await ready.getByLabel('Layer').selectOption('depth');
  await expect.poll(() => mock.received).toContainEqual({ type: 'layers', names: ['depth'] });
  const grey = srgb(0.5);
  await expect.poll(() => codes(ready, [[48, 10]])).toEqual([grey, grey, grey]);
  await ready.getByLabel('Layer').selectOption('picture');
  await expect.poll(() => codes(ready, [[0, 0]])).toEqual([0, 0, 0]);
});
