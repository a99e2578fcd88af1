/** The plot of errors: curves of renders, their table, B. */

import type { Page } from '@playwright/test';
import { expect, open, test } from './fixture';
import type { Mock } from './mock';

/** A render whose error falls as it should. */
async function render(mock: Mock, page: Page, scale: number, integrator: string): Promise<void> {
  mock.change({ settings: { ...mock.state.settings, integrator } });
  for (const samples of [1, 4, 16, 64]) mock.frame({ samples, seconds: 0.5 * samples, error: scale / Math.sqrt(samples) });
  await expect(page.locator('.curves li').filter({ hasText: integrator })).toBeVisible();
}

/** Both ends of a path, in the plot's units. */
async function endsOf(page: Page, selector: string): Promise<[number, number, number, number]> {
  const d = (await page.locator(selector).getAttribute('d'))!;
  const places = d.slice(1).split('L').map((p) => p.split(' ').map(Number)); // prettier-ignore
  const [a, b] = [places[0]!, places.at(-1)!];
  return [a[0]!, a[1]!, b[0]!, b[1]!];
}

test('errors that fall as the root of time lie along the slope', async ({ mock, ready }) => {
  await open(ready, 'Error');
  await render(mock, ready, 0.4, 'bdpt');
  const plot = ready.getByRole('img', { name: 'Relative error against seconds' });
  await expect(plot).toHaveAccessibleDescription(/slope −1\/2. bdpt, estimated: 0.05 at 32 seconds/);
  await expect(ready.locator('.curve')).toHaveCount(1);
  await expect.poll(async () => ((await ready.locator('.curve').getAttribute('d')) ?? '').split('L').length).toBe(4);
  const rise = ([x0, y0, x1, y1]: number[]) => (y1! - y0!) / (x1! - x0!);
  expect(rise(await endsOf(ready, '.curve'))).toBeCloseTo(rise(await endsOf(ready, '.slope')), 2);
  await ready.getByLabel('Error against', { exact: true }).selectOption('samples');
  await expect(ready.getByRole('img', { name: 'Relative error against samples' })).toHaveAccessibleDescription(/0.05 at 64 samples/);
  await ready.getByText('Table', { exact: true }).click();
  await expect(ready.locator('table.errors tbody tr')).toHaveCount(4);
  await expect(ready.locator('table.errors tbody tr').last()).toHaveText('bdpt32640.05–');
});

test('renders are compared, four at most, and taken away', async ({ mock, ready }) => {
  await open(ready, 'Error');
  for (const [i, name] of ['path', 'bdpt', 'direct', 'ao', 'raster'].entries()) await render(mock, ready, 0.2 + 0.1 * i, name);
  const items = ready.locator('.curves li');
  await expect(items).toHaveText([/bdpt/, /direct/, /ao/, /raster/]);
  const styles = await ready.locator('.plot .curve').evaluateAll((curves) => curves.map((c) => getComputedStyle(c).stroke));
  expect(new Set(styles).size).toBe(4);
  await ready.getByRole('button', { name: 'Remove the curve of direct' }).click();
  await expect(items).toHaveText([/bdpt/, /ao/, /raster/]);
  // The same integrator again replaces its curve; previews, and frames of the same samples, add nothing.
  await render(mock, ready, 0.9, 'bdpt');
  await expect(items).toHaveText([/ao/, /raster/, /bdpt/]);
  mock.frame({ kind: 'preview', samples: 128, seconds: 90 });
  mock.frame({ samples: 64, seconds: 99 });
  await ready.getByText('Table', { exact: true }).click();
  await expect(ready.locator('table.errors tbody tr')).toHaveCount(12);
});

test('the error to B is the root of the relMSE', async ({ mock, ready }) => {
  mock.shade = () => [0.5, 0.5, 0.5];
  mock.frame();
  await open(ready, 'Compare');
  await ready.getByRole('button', { name: 'Keep as B' }).click();
  await expect(ready.getByText('B: kept at 64 spp, 96 × 64')).toBeVisible();
  await open(ready, 'Error');
  mock.shade = (x) => (x < 48 ? [0.75, 0.5, 0.25] : [0.5, NaN, 0.5]);
  await render(mock, ready, 0.4, 'bdpt');
  await expect(ready.locator('.curve.measured')).toHaveCount(1);
  await ready.getByText('Table', { exact: true }).click();
  // Of a pixel at the left and one at the right five components are finite, and two differ by 0.25.
  const expected = Math.sqrt((2 * 0.0625) / 0.26 / 5);
  await expect(ready.locator('table.errors tbody tr').first()).toHaveText(`bdpt0.510.4${expected.toPrecision(4)}`);
  await ready.getByRole('button', { name: 'Clear B' }).click();
  await expect(ready.locator('.curve.measured')).toHaveCount(0);
});
