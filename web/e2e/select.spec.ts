/** A click on the picture selects: the outline, the nodes, and their names; edits of what is selected. */

import type { Page } from '@playwright/test';
import type { NodeState, Outline, Pixel } from '../src/protocol';
import AxeBuilder from '@axe-core/playwright';
import { anew, canvas, differing, expect, generation, open, place, test } from './fixture';
import type { Program } from './program';

const ask = async <T>(program: Program, what: string): Promise<T> => (await (await fetch(`${program.url}api/${what}`)).json()) as T;
const chosen = (page: Page) => page.getByRole('group', { name: 'Selected' });
const outline = (page: Page) => page.locator('.outline path.line');
/** Clicks a pixel; again, where the layout moved meanwhile and another one was met. */
const click = (page: Page, x: number, y: number) =>
  expect(async () => {
    await page.mouse.click(...(await place(page, x, y)));
    await expect(page.locator('.pin')).toContainText(`Pixel ${x}, ${y}`, { timeout: 2000 });
  }).toPass();
/** In the sphere at the left, and on the wall at the left. */
const [SPHERE, WALL] = [
  [30, 55],
  [2, 2],
] as const;

test('a click selects the object: outline, material and shape, by the same names everywhere', async ({ program, view }) => {
  await click(view, ...SPHERE);
  await expect(chosen(view)).toContainText('Selected: sphere 1');
  const { object, material } = await ask<Pixel>(program, `pixel?x=${SPHERE[0]}&y=${SPHERE[1]}`);
  expect(object).toBe('sphere 1');
  await expect(view.locator('.pin')).toContainText(`${object}`);
  await expect(view.locator('.pin')).toContainText(`${material}`);
  // The shape first, then its material, which is unfolded and in view.
  await expect(chosen(view).locator('.node .id')).toHaveText([object!, material!]);
  await expect(view.getByLabel(`${material}: reflectance`, { exact: true })).toBeInViewport();
  const nodes = await ask<NodeState[]>(program, 'nodes');
  expect(nodes.filter((n) => n.id === object || n.id === material).map((n) => n.family)).toEqual(['material', 'shape']);
  expect(new Set(nodes.map((n) => n.id)).size).toBe(nodes.length);
  expect(nodes.filter((n) => /[#_]/.test(n.id))).toEqual([]);

  // It lies around the pixels of the sphere.
  const { runs } = await ask<Outline>(program, 'outline?shape=sphere%201');
  const box = await outline(view).evaluate((path: SVGPathElement) => {
    const [{ x, y, width }, at] = [path.getBBox(), path.getScreenCTM()!];
    return [at.e + at.a * x, at.f + at.d * y, at.a * width];
  });
  const [from, to] = [Math.min(...runs.map((r) => r[1])), Math.max(...runs.map((r) => r[2]))];
  const [left, top] = await place(view, from - 0.5, runs[0]![0] - 0.5);
  expect(box.map(Math.round)).toEqual([left, top, to - from]);

  await click(view, ...WALL);
  await expect(chosen(view)).toContainText('Selected: plane 1');
  await expect(view.getByLabel('red: reflectance', { exact: true })).toBeInViewport();
  await view.locator('canvas.picture').press('Escape');
  await expect(chosen(view)).toBeHidden();
  await expect(outline(view)).toHaveCount(0);
  await expect(view.locator('.pin')).toBeEmpty();
  // All nodes are where they were.
  await expect(view.locator('.family .node')).toHaveCount(nodes.length);
});

test('the outline follows the camera, and ends beside the picture', async ({ view }) => {
  await click(view, ...SPHERE);
  await expect(outline(view)).toHaveCount(1);
  const before = await outline(view).getAttribute('d');
  await anew(view, () => view.locator('canvas.picture').press('ArrowRight'));
  await expect(outline(view)).toHaveCount(1);
  await expect.poll(() => outline(view).getAttribute('d')).not.toBe(before);
  await expect(chosen(view)).toContainText('sphere 1');
  const box = (await view.locator('canvas.picture').boundingBox())!;
  await view.mouse.click(box.x + 20, box.y + box.height - 60);
  await expect(chosen(view)).toBeHidden();
  await expect(outline(view)).toHaveCount(0);
});

test('what is selected is edited by its name, and a shape without one is placed', async ({ view }) => {
  const before = await canvas(view);
  await click(view, ...SPHERE);
  const color = chosen(view).locator('.color input[type=color]').first();
  await anew(view, () => color.fill('#20ff20'));
  expect(differing(await canvas(view), before)).toBeGreaterThan(200);
  await expect(chosen(view)).toContainText('sphere 1');
  const box = await outline(view).boundingBox();
  await chosen(view).locator('.node', { hasText: 'sphere 1' }).locator('> summary').click();
  const field = chosen(view).getByLabel('sphere 1: to_world, location y');
  await anew(view, async () => {
    await field.fill('0.4');
    await field.press('Enter');
  });
  await expect.poll(async () => (await outline(view).boundingBox())!.y).toBeLessThan(box!.y - 5);
  for (let i = 0; i < 2; i++) await anew(view, () => view.locator('canvas.picture').press('Control+Z'));
  expect(differing(await canvas(view), before)).toBe(0);
});

test('an arrow moves the shape along its axis, and one undo takes it back', async ({ program, view }) => {
  const before = await canvas(view);
  await click(view, ...SPHERE);
  await expect(view.locator('.gizmo .arrow.x')).toHaveCount(1);
  const { handle, runs } = await ask<Outline>(program, 'outline?shape=sphere%201');
  const [from, axis] = [handle!.at, handle!.axes[0]];
  const to = (pixels: number) => place(view, from[0] + pixels * Math.sign(axis[0]) - 0.5, from[1] - 0.5);
  await view.mouse.move(...(await to(40)));
  await view.mouse.down();
  await view.mouse.move(...(await to(46)));
  await anew(view, async () => {
    await view.mouse.move(...(await to(52)));
    await view.mouse.up();
  });
  await chosen(view).locator('.node', { hasText: 'sphere 1' }).locator('> summary').click();
  const located = async (name: string) => Number(await chosen(view).getByLabel(`sphere 1: to_world, location ${name}`).inputValue());
  await expect.poll(() => located('x')).toBeCloseTo(12 / Math.abs(axis[0]), 3);
  expect([await located('y'), await located('z')]).toEqual([0, 0]);
  const left = (runs: Outline['runs']) => Math.min(...runs.map((r) => r[1]));
  const moved = await ask<Outline>(program, 'outline?shape=sphere%201');
  expect(Math.abs(left(moved.runs) - left(runs) - 12 * Math.sign(axis[0]))).toBeLessThanOrEqual(2);
  await expect(view.locator('.gizmo .arrow.x')).toHaveCount(1);
  await anew(view, () => view.locator('canvas.picture').press('Control+Z'));
  expect(differing(await canvas(view), before)).toBe(0);
  await expect(view.getByRole('button', { name: 'Undo' })).toBeDisabled();
});

test('of a material the parameters that matter first, names whole, numbers not cut', async ({ view }) => {
  await click(view, ...SPHERE);
  const material = chosen(view).locator('.node').last();
  await expect(material.locator('> .body > .parameter .name')).toHaveText(['reflectance']);
  const name = material.locator('.more .name', { hasText: 'normal map strength' });
  await expect(name.first()).toBeHidden();
  await material.locator('.more > summary').click();
  await expect(name.first()).toBeVisible();
  expect((await name.first().getAttribute('title'))!.split('\n')[0]).toContain('normal_map_strength');
  await chosen(view).locator('.node').first().locator('> summary').click();
  await expect(chosen(view).getByLabel('sphere 1: to_world, scale z')).toBeVisible();
  const cut = await view.evaluate(() => {
    const fields = [...document.querySelectorAll<HTMLInputElement>('.nodes input.number, .chosen input[type=number]')];
    for (const field of fields) field.value = '-12.34567';
    const names = [...document.querySelectorAll<HTMLElement>('.chosen .name')];
    const isCut = (e: HTMLElement) => e.offsetParent !== null && e.scrollWidth > e.clientWidth;
    const inside = fields.filter((f) => f.offsetParent !== null);
    return [inside.length > 6, ...[...inside, ...names].filter(isCut).map((e) => e.getAttribute('aria-label') ?? e.textContent)];
  });
  expect(cut).toEqual([true]);
  const { violations } = await new AxeBuilder({ page: view }).analyze();
  expect(violations.map((v) => [v.id, v.nodes.map((n) => n.html)])).toEqual([]);
});

test('while paths are drawn a click selects nothing', async ({ view }) => {
  await open(view, 'Scene');
  const before = await generation(view);
  await view.locator('canvas.picture').press('t');
  await click(view, ...SPHERE);
  await expect(view.locator('.pin')).toContainText('sphere 1');
  await expect(chosen(view)).toBeHidden();
  expect(await generation(view)).toBe(before);
});

test('a click on an arrow is about what lies beneath', async ({ view }) => {
  await view.mouse.click(...(await place(view, 48, 32)));
  const arrow = view.locator('.gizmo .arrow .hit').first();
  await expect(arrow).toBeAttached();
  const box = (await arrow.boundingBox())!;
  const answered = view.waitForResponse((r) => r.url().includes('/api/pixel?'));
  await view.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  expect((await answered).ok()).toBe(true);
});
