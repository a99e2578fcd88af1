/** The path of a sample: over the picture, as a table, and what asks for it. */

import AxeBuilder from '@axe-core/playwright';
import type { Page } from '@playwright/test';
import { expect, middle, open, test } from './fixture';

/** A place of the 96 × 64 film at 1:1, in CSS pixels of the canvas. */
async function at(page: Page, x: number, y: number): Promise<[number, number]> {
  const box = (await page.locator('canvas.picture').boundingBox())!;
  return [Math.round((box.width - 96) / 2) + x, Math.round((box.height - 64) / 2) + y];
}

/** Centres of the numbered dots, by their numbers. */
const dots = (page: Page): Promise<Record<string, [number, number]>> =>
  page.locator('.path .vertex').evaluateAll((groups) =>
    Object.fromEntries(
      groups.map((g) => {
        const circle = g.querySelector('circle')!;
        return [g.textContent, [circle.cx.baseVal.value, circle.cy.baseVal.value]];
      }),
    ),
  );

test('a click draws the path, and a table tells it', async ({ mock, ready }) => {
  const button = ready.getByRole('button', { name: 'Path', exact: true });
  await expect(ready.getByRole('group', { name: 'Sample of the pixel' })).toBeHidden();
  await button.click();
  await expect(button).toHaveAttribute('aria-pressed', 'true');
  // Without a pinned pixel it is the middle one.
  await expect(ready.locator('.vertices tbody tr')).toHaveCount(5);
  await expect(ready.locator('.traced .facts')).toContainText('Pixel 48, 32');
  const [x, y] = await middle(ready);
  await ready.mouse.click(x - 20, y - 10);
  await expect(ready.locator('.traced .facts')).toContainText('Pixel 28, 22: light 0.75  0.75  0.875; 4 vertices, ends: leaves the scene.');
  expect(await dots(ready)).toEqual({ 1: await at(ready, 28.25, 22.75), 2: await at(ready, 0, 32), 3: await at(ready, 95, 32) });
  // Two rays, one that escapes, one light sample that arrives and one that does not, each with its edge.
  const lines = async (way: string) => ready.locator(`.path line:not(.edge).${way}`).count();
  expect([await lines('ray'), await lines('escaping'), await lines('light'), await lines('blocked')]).toEqual([3, 1, 2, 1]);
  await expect(ready.locator('.path polygon.escaping')).toHaveCount(1);
  const rows = ready.locator('.vertices tbody tr');
  await expect(rows.nth(1)).toContainText('sphere 2');
  await expect(rows.nth(1)).toContainText('specular transmission');
  await expect(rows.nth(2).locator('.rgb').first().locator('span')).toHaveText(['0.5', '0.25', '0.125']);
  await expect(rows.nth(3)).toContainText('light sample blocked');
  await expect(rows.nth(4).locator('.rgb').last().locator('span')).toHaveText(['0.25', '0.5', '0.75']);
  await rows.nth(2).hover();
  await expect(ready.locator('.path .marked')).toHaveText('2');
  const asked = mock.paths;
  await button.click();
  await expect(ready.locator('.path > *')).toHaveCount(0);
  expect(mock.paths).toBe(asked);
});

test('samples are stepped by buttons and arrow keys, which leave the camera alone', async ({ mock, ready }) => {
  await ready.locator('canvas.picture').press('t');
  const number = ready.getByRole('spinbutton', { name: 'Sample', exact: true });
  await ready.getByRole('button', { name: 'Next sample' }).click();
  await expect.poll(async () => (await dots(ready))['3']).toEqual(await at(ready, 95, 33));
  await ready.getByRole('button', { name: 'Next sample' }).press('ArrowRight');
  await expect.poll(async () => (await dots(ready))['3']).toEqual(await at(ready, 95, 34));
  await number.press('ArrowDown');
  await expect(number).toHaveValue('1');
  for (const _ of [0, 1, 2]) await ready.getByRole('button', { name: 'Previous sample' }).click();
  await expect(number).toHaveValue('0');
  await number.fill('99999999');
  await number.press('Enter');
  await expect(number).toHaveValue('16777215');
  expect(mock.received.filter((m) => m.type === 'camera')).toEqual([]);
});

test('the path follows zoom, is asked for anew after an edit, and goes when the camera moves', async ({ mock, ready }) => {
  await ready.locator('canvas.picture').press('t');
  await expect(ready.locator('.vertices tbody tr')).toHaveCount(5);
  const before = await dots(ready);
  await ready.locator('canvas.picture').press('+');
  await expect
    .poll(async () => (await dots(ready))['3']![0] - (await dots(ready))['2']![0])
    .toBe(1.5 * (before['3']![0] - before['2']![0]));
  const asked = mock.paths;
  mock.change({ settings: { ...mock.state.settings, integrator: 'bdpt' } });
  await expect.poll(() => mock.paths).toBe(asked + 1);
  await expect(ready.locator('.traced .facts')).toContainText('The picture’s method has no such paths');
  await ready.locator('canvas.picture').press('ArrowLeft');
  await expect(ready.locator('.traced .facts')).toContainText('The camera has moved');
  await expect(ready.locator('.path > *')).toHaveCount(0);
  await expect(ready.locator('.vertices')).toHaveCount(0);
  const [x, y] = await middle(ready);
  await ready.mouse.click(x, y);
  await expect(ready.locator('.vertices tbody tr')).toHaveCount(5);
});

test('axe finds nothing in the table, in both themes', async ({ ready }) => {
  await open(ready, 'Pixel');
  await ready.locator('canvas.picture').press('t');
  await expect(ready.locator('.vertices tbody tr')).toHaveCount(5);
  for (const theme of ['light', 'dark']) {
    await ready.evaluate((theme) => (document.documentElement.dataset.theme = theme), theme);
    const { violations } = await new AxeBuilder({ page: ready }).analyze();
    expect(violations.map((v) => [v.id, v.nodes.map((n) => n.html)])).toEqual([]);
  }
});
