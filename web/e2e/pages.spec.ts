/** Pages come back, are more than one, and are of any width, for everybody. */

import AxeBuilder from '@axe-core/playwright';
import { anew, canvas, differing, done, expect, expectSame, open, show, test } from './fixture';

test('a page that is loaded again, and a second one, show what holds', async ({ program, view, context }) => {
  await anew(view, () => view.getByLabel('Integrator').selectOption('direct'));
  const before = await canvas(view);
  await view.reload();
  await done(view);
  await expect(view.getByLabel('Integrator')).toHaveValue('direct');
  await view.locator('canvas.picture').press('1');
  expect(differing(await canvas(view), before)).toBe(0);

  const second = await context.newPage();
  await show(second, program);
  expect(differing(await canvas(second), before)).toBe(0);
  await anew(second, () => second.getByLabel('Integrator').selectOption('path'));
  await expect(view.getByLabel('Integrator')).toHaveValue('path');
  expect(differing(await canvas(second), before)).toBeGreaterThan(1000);
  await second.close();
  await view.bringToFront();
  await expectSame(view, program, 'path');
});

test('axe finds nothing in the page of a real scene', async ({ view }) => {
  for (const title of ['Camera', 'Scene', 'Save', 'Messages']) await open(view, title);
  await view.locator('.node', { hasText: 'green' }).locator('> summary').click();
  const found = async () => (await new AxeBuilder({ page: view }).analyze()).violations.map((v) => [v.id, v.nodes.map((n) => n.html)]);
  expect(await found()).toEqual([]);
});

test('on a phone the picture and the panel fit', async ({ program, page }) => {
  await page.setViewportSize({ width: 360, height: 740 });
  await page.goto(program.url);
  await done(page);
  await page.getByRole('button', { name: 'Panel' }).click();
  for (const title of ['Camera', 'Scene', 'Save', 'Messages']) await open(page, title);
  await page.locator('.node', { hasText: 'green' }).locator('> summary').click();
  const wide = await page.evaluate(() =>
    [document.documentElement, ...document.querySelectorAll<HTMLElement>('.panel, .section, .body, .toolbar, .row')]
      .filter((e) => e.scrollWidth > e.clientWidth + 1)
      .map((e) => `${e.tagName}.${e.className} ${e.scrollWidth} > ${e.clientWidth}`),
  );
  expect(wide).toEqual([]);
});
