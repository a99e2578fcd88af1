/** Finished pictures: the list, layers, values, differences, files that change, and dropped ones. */

import AxeBuilder from '@axe-core/playwright';
import type { Page } from '@playwright/test';
import { copyFile, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { canvas, expect, open, place, test as base } from './fixture';
import { Program } from './program';

/** Two renders of 96 × 64 pixels with layers, a small PNG, and a file that is broken, in a folder. */
const test = base.extend<{ folder: string; viewer: Program; pictures: Page }>({
  folder: async ({}, use) => {
    const folder = await mkdtemp(join(tmpdir(), 'steradian-pictures-'));
    const maker = await Program.start('builtin:cornell-box', '--size', '8x8', '--spp', '1');
    const render = 'steradian render builtin:cornell-box --size 96x64 --quiet';
    await maker.run(`${render} --spp 4 --aov normal,depth -o ${folder}/a.exr`);
    await maker.run(`${render} --spp 1 --seed 7 -o ${folder}/b.exr`);
    await maker.run(`${render.replace('96x64', '8x6')} --spp 1 -o ${folder}/small.png`);
    await writeFile(`${folder}/broken.exr`, 'no picture');
    await use(folder);
    await maker.stop();
    await rm(folder, { recursive: true, force: true });
  },
  viewer: async ({ folder }, use) => {
    const viewer = await Program.start(folder);
    await use(viewer);
    await viewer.stop();
  },
  pictures: async ({ viewer, page }, use) => {
    await page.goto(viewer.url);
    await expect(page.locator('.status-facts')).toContainText('a.exr · 96 × 64');
    await page.locator('canvas.picture').press('1');
    await use(page);
  },
});

/** Tests in which the server refuses something, which the console tells. */
const refusing = test.extend({ allowed: async ({}, use) => use([/404|422/]) });

const items = (page: Page) => page.getByRole('listbox', { name: 'Pictures' }).getByRole('option');
const item = (page: Page, name: string) => items(page).filter({ hasText: name });
const facts = (page: Page) => page.locator('.status-facts');

/** Differing canvases of two states of the page. */
async function changed(page: Page, before: number[]): Promise<boolean> {
  const now = await canvas(page);
  return now.some((v, i) => v !== before[i]);
}

test('the list is stepped through and filtered', async ({ pictures }) => {
  await expect(items(pictures)).toHaveCount(4);
  const a = await canvas(pictures);
  expect(new Set(a).size, 'a picture of something').toBeGreaterThan(30);
  await pictures.locator('canvas.picture').press('ArrowDown');
  await expect(facts(pictures)).toContainText('b.exr');
  await expect(item(pictures, 'b.exr')).toHaveAttribute('aria-selected', 'true');
  expect(await changed(pictures, a)).toBe(true);
  await pictures.locator('canvas.picture').press('ArrowUp');
  await expect(facts(pictures)).toContainText('a.exr');
  expect(await changed(pictures, a)).toBe(false);
  await pictures.getByLabel('Filter the pictures').fill('small');
  await expect(pictures.getByText('1 of 4')).toBeVisible();
  await pictures.getByLabel('Filter the pictures').press('ArrowDown');
  await expect(facts(pictures)).toContainText('small.png · 8 × 6');
});

test('values of all channels, and numbers in pixels', async ({ pictures, viewer, folder }) => {
  await copyFile(`${folder}/a.exr`, `${viewer.folder}/a.exr`);
  const { rgb } = await viewer.values('a.exr');
  const [x, y] = [40, 30];
  await pictures.mouse.move(...(await place(pictures, x, y)));
  await expect(pictures.locator('.pin')).toContainText(`Pixel ${x}, ${y}`);
  const cells = async (name: string) => (await pictures.getByRole('row', { name }).locator('td').textContent())!.split('  ').map(Number);
  const shown = await cells('picture');
  for (const i of [0, 1, 2]) expect(shown[i]).toBeCloseTo(rgb[3 * (96 * y + x) + i]!, 5);
  expect(await cells('N')).toHaveLength(3);

  const numbered = async () => Number(await pictures.locator('canvas.pixel-numbers').getAttribute('data-numbered'));
  expect(await numbered()).toBe(0);
  await pictures.mouse.click(...(await place(pictures, x, y)));
  await expect(pictures.getByRole('button', { name: 'Unpin the pixel' })).toBeVisible();
  for (let i = 0; i < 16; i++) await pictures.mouse.wheel(0, -100);
  await expect.poll(numbered).toBeGreaterThan(10);
  // Pinned: other pixels under the pointer change nothing.
  await pictures.mouse.move(...(await place(pictures, 10, 10)));
  await expect(pictures.locator('.pin')).toContainText(`Pixel ${x}, ${y}`);
});

refusing('a layer is shown, and a picture without it shows its colours', async ({ pictures }) => {
  const before = await canvas(pictures);
  await pictures.getByLabel('Layer', { exact: true }).selectOption('N');
  await expect(facts(pictures)).toContainText('· N');
  expect(await changed(pictures, before)).toBe(true);
  await pictures.getByLabel('Layer', { exact: true }).selectOption('R');
  await expect(facts(pictures)).toContainText('· R');
  const red = await canvas(pictures);
  for (let i = 0; i < red.length; i += 3) expect([red[i + 1], red[i + 2]]).toEqual([red[i], red[i]]);
  await pictures.getByLabel('Layer', { exact: true }).selectOption('N');
  await expect(facts(pictures)).toContainText('· N');
  await item(pictures, 'b.exr').click();
  await expect(pictures.locator('.toast')).toContainText("has no layer 'N'");
  await expect(facts(pictures)).toContainText('b.exr · 96 × 64');
  await expect(pictures.getByLabel('Layer', { exact: true })).toHaveValue('picture');
});

test('differences from another picture of the list', async ({ pictures, folder }) => {
  await open(pictures, 'Compare');
  const before = await canvas(pictures);
  await pictures.getByLabel('Picture B', { exact: true }).selectOption({ label: `${folder}/b.exr` });
  await expect(pictures.getByText('b.exr, 96 × 64')).toBeVisible();
  await pictures.getByLabel('Compare with B').selectOption('difference');
  await expect(pictures.locator('.tag')).toHaveText('A − B');
  expect(await changed(pictures, before)).toBe(true);
  await pictures.getByLabel('Compare with B').selectOption('map');
  await expect(pictures.getByText(/^FLIP: mean 0\.\d+/)).toBeVisible();
  // The same picture: no difference at all.
  await pictures.getByLabel('Picture B', { exact: true }).selectOption({ label: `${folder}/a.exr` });
  await expect(pictures.getByText(/^FLIP: mean 0, /)).toBeVisible();
  await pictures.getByLabel('Compare with B').selectOption('difference');
  expect(new Set(await canvas(pictures))).toEqual(new Set([128]));
  await pictures.getByLabel('Picture B', { exact: true }).selectOption({ label: `${folder}/small.png` });
  await expect(pictures.getByText('they are not compared')).toContainText("small.png' has 8 × 6 pixels");
  await expect(pictures.getByLabel('Compare with B')).toBeDisabled();
});

refusing('a broken file has a message in the list, and is shown once it is whole', async ({ pictures, folder }) => {
  await item(pictures, 'broken.exr').click();
  await expect(item(pictures, 'broken.exr').locator('.fault')).toBeVisible();
  await expect(facts(pictures)).toHaveText('no picture');
  await copyFile(`${folder}/b.exr`, `${folder}/broken.exr`);
  await expect(facts(pictures)).toContainText('broken.exr · 96 × 64');
  await expect(item(pictures, 'broken.exr').locator('.fault')).toHaveCount(0);
  await item(pictures, 'a.exr').click();
  await expect(facts(pictures)).toContainText('a.exr');
  // A file that changes is read anew.
  const before = await canvas(pictures);
  await copyFile(`${folder}/b.exr`, `${folder}/a.exr`);
  await expect.poll(() => changed(pictures, before)).toBe(true);
  await rm(`${folder}/small.png`);
  await expect(item(pictures, 'small.png').locator('.fault')).toHaveText('there is no such file');
});

refusing('dropped pictures come to the list', async ({ pictures, viewer, folder }) => {
  await copyFile(`${folder}/b.exr`, `${viewer.folder}/b.exr`);
  const drop = async (name: string, bytes: Buffer) => {
    const base64 = bytes.toString('base64');
    const files = await pictures.evaluateHandle(
      ([name, base64]) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([Uint8Array.from(atob(base64!), (c) => c.charCodeAt(0))], name!));
        return transfer;
      },
      [name, base64],
    );
    await pictures.dispatchEvent('main.stage', 'drop', { dataTransfer: files });
  };
  await drop('dropped.exr', await viewer.read('b.exr'));
  await expect(facts(pictures)).toHaveText('dropped.exr · 96 × 64');
  await expect(items(pictures)).toHaveCount(5);
  await drop('notes.txt', Buffer.from('no picture'));
  await expect(pictures.locator('.toast')).toContainText('there is no picture among the files');
  await expect(items(pictures)).toHaveCount(5);
});

for (const scheme of ['dark', 'light'] as const) {
  refusing(`axe finds nothing, ${scheme}`, async ({ pictures, folder }) => {
    await pictures.emulateMedia({ colorScheme: scheme });
    for (const title of ['Compare', 'Messages']) await open(pictures, title);
    await item(pictures, 'broken.exr').click();
    await expect(item(pictures, 'broken.exr').locator('.fault')).toBeVisible();
    await item(pictures, 'a.exr').click();
    await expect(facts(pictures)).toContainText('a.exr');
    await pictures.getByLabel('Picture B', { exact: true }).selectOption({ label: `${folder}/b.exr` });
    await expect(pictures.getByRole('slider', { name: 'Divider' })).toBeVisible();
    await pictures.getByLabel('False colour').check();
    const check = async () =>
      (await new AxeBuilder({ page: pictures }).analyze()).violations.map((v) => [v.id, v.nodes.map((n) => n.html)]);
    expect(await check()).toEqual([]);
    await pictures.locator('canvas.picture').press('?');
    await expect(pictures.getByRole('dialog')).toBeVisible();
    expect(await check()).toEqual([]);
  });
}

test('on a phone the list and the panels fit', async ({ viewer, page, folder }) => {
  await page.setViewportSize({ width: 400, height: 740 });
  await page.goto(viewer.url);
  await expect(facts(page)).toContainText('a.exr');
  await page.getByRole('button', { name: 'Panel' }).click();
  for (const title of ['Compare', 'Messages']) await open(page, title);
  await page.getByLabel('Picture B', { exact: true }).selectOption({ label: `${folder}/b.exr` });
  await expect(page.getByText('b.exr, 96 × 64')).toBeVisible();
  const wide = await page.evaluate(() =>
    [document.documentElement, ...document.querySelectorAll<HTMLElement>('.panel, .section, .body, .toolbar, .row, .pictures')]
      .filter((e) => e.scrollWidth > e.clientWidth + 1)
      .map((e) => `${e.tagName}.${e.className} ${e.scrollWidth} > ${e.clientWidth}`),
  );
  expect(wide).toEqual([]);
});
