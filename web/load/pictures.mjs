// The pictures of the view in docs/view: `npm run pictures` in web/, with STERADIAN the program (target/release/steradian). The
// scene is the repository's own, so that they are made anew wherever the page changes.

import { spawn } from 'node:child_process';
import { chromium } from '@playwright/test';

const program = process.env.STERADIAN ?? '../target/release/steradian';
const folder = new URL('../../docs/view/', import.meta.url).pathname;
const system = (await import('node:fs')).existsSync('/usr/bin/chromium') ? { executablePath: '/usr/bin/chromium' } : {};
const browser = await chromium.launch({ ...system, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });

/** A page of a view of some scene, when its picture is done. */
async function page(words, viewport) {
  const child = spawn(program, ['view', ...words], { cwd: new URL('../..', import.meta.url).pathname, stdio: ['ignore', 'pipe', 'inherit'] });
  const address = await new Promise((done) => child.stdout.on('data', (text) => done(String(text).trim())));
  const page = await browser.newPage({ viewport });
  await page.goto(address);
  await page.locator('.status[data-what="done"]').waitFor({ timeout: 900_000 });
  return { page, close: () => page.close().then(() => child.kill()) };
}

const scene = ['scenes/showcase.pbrt', '--size', '800x500', '--spp', '24'];
const desktop = await page(scene, { width: 1280, height: 800 });
await desktop.page.mouse.click(430, 330);
await desktop.page.waitForTimeout(1500);
await desktop.page.screenshot({ path: `${folder}desktop.jpg`, type: 'jpeg', quality: 85 });
await desktop.close();

const phone = await page(scene, { width: 360, height: 740 });
await phone.page.screenshot({ path: `${folder}phone.jpg`, type: 'jpeg', quality: 85 });
await phone.close();
await browser.close();
