/** Whether everybody can use it: axe, keys, narrow windows. */

import AxeBuilder from '@axe-core/playwright';
import type { Page } from '@playwright/test';
import { expect, middle, open, test } from './fixture';
import type { Mock } from './mock';

/** Two groups in the mixer, one with a long name. */
async function mixed(mock: Mock, page: Page): Promise<void> {
  mock.groups = ['key', 'a lamp with a name that is longer than the panel is wide'].map((name) => [name, () => [0.25, 0.25, 0.25]]);
  await page.getByLabel('Mix', { exact: true }).click();
  await expect(page.getByLabel('key: solo')).toBeVisible();
}

for (const scheme of ['dark', 'light'] as const) {
  test(`axe finds nothing, ${scheme}`, async ({ mock, ready }) => {
    await ready.emulateMedia({ colorScheme: scheme });
    for (const title of ['Compare', 'Error', 'Light groups', 'Camera', 'Scene', 'Save', 'Messages']) await open(ready, title);
    await mixed(mock, ready);
    await ready.getByLabel('key: solo').click();
    await ready.getByRole('button', { name: 'Keep as B' }).click();
    await expect(ready.getByRole('slider', { name: 'Divider' })).toBeVisible();
    mock.shade = () => [0.5, 0.5, 0.5];
    for (const samples of [65, 70, 80]) mock.frame({ samples, seconds: samples });
    await ready.getByText('Table', { exact: true }).click();
    await expect(ready.locator('.plot .measured.curve')).toHaveCount(1);
    await ready.locator('.node', { hasText: 'red glass' }).locator('> summary').click();
    await ready.locator('.node', { hasText: 'red glass' }).locator('.more > summary').click();
    const [x, y] = await middle(ready);
    // The divider is in the middle.
    await ready.mouse.click(x - 30, y);
    await expect(ready.locator('.pin')).toContainText('red glass');
    await ready.getByLabel('False colour').check();
    mock.broadcast({ type: 'message', severity: 'error', text: 'a message' });
    await expect(ready.locator('.toast')).toBeVisible();
    const check = async () => (await new AxeBuilder({ page: ready }).analyze()).violations.map((v) => [v.id, v.nodes.map((n) => n.html)]);
    expect(await check()).toEqual([]);
    await ready.locator('canvas.picture').press('?');
    await expect(ready.getByRole('dialog')).toBeVisible();
    expect(await check()).toEqual([]);
  });
}

test('the theme is chosen over the system’s', async ({ ready }) => {
  await ready.emulateMedia({ colorScheme: 'light' });
  const back = () => ready.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await back();
  await ready.getByRole('button', { name: 'Theme: auto' }).click();
  const dark = await back();
  expect(dark).not.toBe(light);
  await ready.reload();
  await expect(ready.getByRole('button', { name: 'Theme: dark' })).toBeVisible();
  expect(await back()).toBe(dark);
});

test('keys do not act while typing', async ({ ready }) => {
  await open(ready, 'Scene');
  await ready.getByLabel('Filter the nodes').pressSequentially('c?n]');
  await expect(ready.locator('.panel')).toBeVisible();
  await expect(ready.locator('.legend')).toBeHidden();
  await expect(ready.getByRole('dialog')).toBeHidden();
  await expect(ready.getByLabel('Exposure in EV', { exact: true })).toHaveValue('0');
});

test('a window of 360 pixels: nothing is cut, the panel is a sheet', async ({ mock, page }) => {
  await page.setViewportSize({ width: 360, height: 740 });
  await page.goto(mock.url);
  await expect(page.locator('.status-facts')).toContainText('64 / 256 spp');
  await expect(page.locator('.panel')).toBeHidden();
  await page.getByRole('button', { name: 'Panel' }).click();
  await expect(page.locator('.panel')).toBeVisible();
  for (const title of ['Compare', 'Error', 'Light groups', 'Camera', 'Scene', 'Save', 'Messages']) await open(page, title);
  await mixed(mock, page);
  await page.getByRole('button', { name: 'Keep as B' }).click();
  for (const mode of ['flip', 'difference', 'split']) await page.getByLabel('Compare with B').selectOption(mode);
  await page.locator('.node', { hasText: 'red glass' }).locator('> summary').click();
  await page.locator('.node', { hasText: 'red glass' }).locator('.more > summary').click();
  const wide = await page.evaluate(() => {
    const all = [
      document.documentElement,
      document.body,
      ...document.querySelectorAll<HTMLElement>('.panel, .section, .body, .toolbar, .row, .strip, .strip-head'),
    ];
    return all
      .filter((e) => e.scrollWidth > e.clientWidth + 1)
      .map((e) => `${e.tagName}.${e.className} ${e.scrollWidth} > ${e.clientWidth}`);
  });
  expect(wide).toEqual([]);
  const stage = (await page.locator('.stage').boundingBox())!;
  expect(stage.height).toBeGreaterThan(280);
});
