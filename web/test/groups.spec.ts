/** Light groups: mixed by sliders, without a render. */

import { codes, expect, middle, open, sent, srgb, test } from './fixture';
import type { Page } from '@playwright/test';
import type { Mock } from './mock';

/** Two lights that are the picture together: constant, so that codes are known. */
async function lit(mock: Mock, page: Page): Promise<void> {
  mock.groups = [
    ['key', () => [0.25, 0.125, 0.0625]],
    ['fill', () => [0.125, 0.25, 0.5]],
  ];
  mock.shade = () => [0.375, 0.375, 0.5625];
  await open(page, 'Light groups');
  await page.getByLabel('Mix', { exact: true }).click();
  await expect(page.getByLabel('fill: solo')).toBeVisible();
}

const seen = async (page: Page) => (await codes(page, [[40, 30]])) as [number, number, number];
const code = (r: number, g: number, b: number) => [r, g, b].map(srgb);

test('weights change what is shown, and nothing is asked for', async ({ mock, ready }) => {
  await lit(mock, ready);
  expect(sent(mock, 'settings')).toEqual([{ type: 'settings', lightGroups: true }]);
  expect(await seen(ready)).toEqual(code(0.375, 0.375, 0.5625));
  const before = mock.received.length;

  await ready.getByLabel('key: intensity in EV, slider').fill('1');
  expect(await seen(ready)).toEqual(code(0.625, 0.5, 0.625));
  await ready.getByLabel('fill: mute').click();
  expect(await seen(ready)).toEqual(code(0.5, 0.25, 0.125));
  await ready.getByLabel('fill: mute').click();
  await ready.getByLabel('fill: solo').click();
  expect(await seen(ready)).toEqual(code(0.125, 0.25, 0.5));
  // sRGB's #00ff00 is the green third of white.
  await ready.getByLabel('fill: colour').fill('#00ff00');
  expect(await seen(ready)).toEqual(code(0, 0.25, 0));
  await ready.getByLabel('fill: solo').click();
  expect(await seen(ready)).toEqual(code(0.5, 0.5, 0.125));

  await ready.mouse.move(...(await middle(ready)));
  await expect(ready.locator('.values')).toContainText('0.5  0.5  0.125  (mixed)');
  // The histogram is of what is shown.
  await expect(ready.locator('details.section', { hasText: 'Histogram' })).toContainText('largest 0.5');

  await ready.getByRole('button', { name: 'Reset mix' }).click();
  expect(await seen(ready)).toEqual(code(0.375, 0.375, 0.5625));
  expect(mock.received.length).toBe(before);
});

test('previews and layers are shown as they are, and weights stay', async ({ mock, ready }) => {
  await lit(mock, ready);
  await ready.getByLabel('key: mute').click();
  expect(await seen(ready)).toEqual(code(0.125, 0.25, 0.5));
  mock.frame({ reduced: 2, kind: 'preview' });
  await expect(ready.locator('.status-facts')).toContainText('preview');
  expect(await seen(ready)).toEqual(code(0.375, 0.375, 0.5625));
  mock.frame();
  await expect(ready.locator('.status-facts')).toContainText('rendering');
  expect(await seen(ready)).toEqual(code(0.125, 0.25, 0.5));
  await ready.getByLabel('Layer').selectOption('depth');
  await expect.poll(() => seen(ready)).toEqual(code(40 / 96, 40 / 96, 40 / 96));
  await ready.getByLabel('Layer').selectOption('picture');
  await expect.poll(() => seen(ready)).toEqual(code(0.125, 0.25, 0.5));
  await ready.getByLabel('Mix', { exact: true }).click();
  await expect(ready.getByLabel('key: mute')).toBeHidden();
  expect(await seen(ready)).toEqual(code(0.375, 0.375, 0.5625));
});

test('a group that is put out hides what is not finite in it', async ({ mock, ready }) => {
  await lit(mock, ready);
  mock.groups[0]![1] = () => [NaN, Infinity, 0];
  mock.frame();
  await expect.poll(() => seen(ready)).toEqual([255, 0, 255]);
  await ready.getByLabel('key: mute').click();
  expect(await seen(ready)).toEqual(code(0.125, 0.25, 0.5));
});

test('as many groups as there may be are mixed', async ({ mock, ready }) => {
  mock.groups = Array.from({ length: 32 }, (_, k) => [`lamp ${k}`, () => [1 / 64, k === 31 ? 0.5 : 0, 0]]);
  await open(ready, 'Light groups');
  await ready.getByLabel('Mix', { exact: true }).click();
  await expect.poll(() => seen(ready)).toEqual(code(0.5, 0.5, 0));
  await ready.getByLabel('lamp 31: mute').click();
  expect(await seen(ready)).toEqual(code(31 / 64, 0, 0));
});

test('the switch is there where lights are, and goes back where it is refused', async ({ mock, ready }) => {
  const section = ready.locator('details.section', { hasText: 'Light groups' });
  mock.change({ scene: { ...mock.state.scene, lights: 0 } });
  await expect(section).toBeHidden();
  mock.change({ scene: { ...mock.state.scene, lights: 2 } });
  await open(ready, 'Light groups');
  mock.refuses = 'bdpt cannot render layers of groups of lights';
  await ready.getByLabel('Mix', { exact: true }).click();
  await expect(ready.getByRole('alert')).toContainText('layers of groups of lights');
  await expect(ready.getByLabel('Mix', { exact: true })).not.toBeChecked();
});
