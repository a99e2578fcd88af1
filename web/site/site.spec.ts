/** Pages of the documentation's site: formulas are typeset, nothing is wider than a phone, and axe finds nothing. */

import { readFile, readdir } from 'node:fs/promises';
import { createServer, type Server } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { expect, test } from '@playwright/test';
import AxeBuilder from '@axe-core/playwright';

const SITE = join(import.meta.dirname, '../../target/site');
const TYPES: Record<string, string> = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.json': 'application/json',
  '.svg': 'image/svg+xml',
};
let server: Server;
let address: string;

test.beforeAll(async () => {
  server = createServer(async (request, response) => {
    const path = normalize(new URL(request.url ?? '/', 'http://site').pathname);
    try {
      const body = await readFile(join(SITE, path));
      response.writeHead(200, { 'content-type': TYPES[extname(path)] ?? 'application/octet-stream' }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise<void>((ready) => server.listen(0, '127.0.0.1', ready));
  const place = server.address();
  address = typeof place === 'object' ? `http://127.0.0.1:${place?.port}` : '';
});
test.afterAll(() => server.close());

/** The pages of the course, and some of the documentation. */
async function pages(): Promise<string[]> {
  const course = await readdir(join(SITE, 'course')).catch(() => []);
  const chapters = course.filter((name) => name.endsWith('.html')).map((name) => `course/${name}`);
  return [...chapters, 'index.html', 'recipes.html', 'pipeline.html', 'gallery.html', 'integrators/bdpt.html'];
}

for (const scheme of ['light', 'dark'] as const)
  test(`axe finds nothing, ${scheme}`, async ({ page }) => {
    await page.emulateMedia({ colorScheme: scheme, reducedMotion: 'reduce' });
    for (const path of ['course/index.html', 'index.html', 'pipeline.html'].slice((await pages()).includes('course/index.html') ? 0 : 1)) {
      await page.goto(`${address}/${path}`);
      const { violations } = await new AxeBuilder({ page }).include('article').analyze();
      expect(violations.map((v) => [path, v.id, v.nodes.map((n) => n.html)])).toEqual([]);
    }
  });

test('formulas are typeset, and every page and its pictures are as wide as a phone', async ({ page }) => {
  await page.setViewportSize({ width: 360, height: 740 });
  const missing: string[] = [];
  page.on('response', (response) => {
    if (response.status() >= 400) missing.push(response.url());
  });
  for (const path of await pages()) {
    await page.goto(`${address}/${path}`);
    await page.evaluate(() => document.fonts.ready);
    const found = await page.evaluate(() => ({
      wide: document.documentElement.scrollWidth > innerWidth,
      faults: [...document.querySelectorAll('.katex-error')].map((e) => e.textContent),
      bare: [...document.querySelectorAll('.arithmatex')].filter((e) => !e.querySelector('.katex')).length,
    }));
    expect({ path, ...found }).toEqual({ path, wide: false, faults: [], bare: 0 });
  }
  expect(missing).toEqual([]);
});

test('a page is found by its words', async ({ page }) => {
  await page.goto(`${address}/index.html`);
  await page.locator('.md-search__input').fill('photon map');
  await expect(page.locator('.md-search-result__link').first()).toBeVisible();
  await page.locator('.md-search-result__link').first().click();
  await expect(page.locator('article')).toContainText(/photon/i);
});
