/** Moving the camera and the picture. */

import type { Page } from '@playwright/test';
import type { Pixel } from '../src/protocol';
import { codes, expect, middle, sent, test } from './fixture';
import type { Mock } from './mock';

const sub = (a: number[], b: number[]) => a.map((v, i) => v - b[i]!);
const length = (a: number[]) => Math.hypot(...a);

test('a drag orbits about the target, and ends with moving: false', async ({ mock, ready }) => {
  const [x, y] = await middle(ready);
  await ready.mouse.move(x, y);
  await ready.mouse.down();
  for (let i = 1; i <= 10; i++) await ready.mouse.move(x + 10 * i, y);
  await ready.mouse.up();
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  const all = sent(mock, 'camera');
  expect(all.filter((c) => !c.moving)).toHaveLength(1);
  const { eye, target, up } = all.at(-1)!;
  expect(target).toEqual([0, 1, 0]);
  expect(up).toEqual([0, 1, 0]);
  expect(length(sub(eye, target))).toBeCloseTo(5, 6);
  // What is in front goes to the right with the pointer when the camera goes to the left: −x.
  expect(eye[0]).toBeLessThan(-0.5);
  expect(eye[1]).toBeCloseTo(1, 6);
  await expect.poll(() => ready.locator('.status-facts').textContent()).toContain('rendering');
});

test('dragging down shows the top, with the middle button too', async ({ mock, ready }) => {
  const [x, y] = await middle(ready);
  await ready.mouse.move(x, y);
  await ready.mouse.down({ button: 'middle' });
  await ready.mouse.move(x, y + 60, { steps: 4 });
  await ready.mouse.up({ button: 'middle' });
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  expect(sent(mock, 'camera').at(-1)!.eye[1]).toBeGreaterThan(2);
});

test('the next camera waits for the picture of the last', async ({ mock, ready }) => {
  mock.answersCamera = false;
  const [x, y] = await middle(ready);
  await ready.mouse.move(x, y);
  await ready.mouse.down();
  for (let i = 1; i <= 10; i++) await ready.mouse.move(x + 10 * i, y);
  await expect.poll(() => sent(mock, 'camera').length).toBe(1);
  await ready.waitForTimeout(300);
  expect(sent(mock, 'camera')).toHaveLength(1);
  mock.frame({ kind: 'preview', reduced: 2 });
  await expect.poll(() => sent(mock, 'camera').length).toBe(2);
  const [first, second] = sent(mock, 'camera');
  expect(length(sub(first!.eye, second!.eye))).toBeGreaterThan(0.1);
  await ready.mouse.up();
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
});

test('Shift pans by what is under the pointer, the wheel dollies', async ({ mock, ready }) => {
  const [x, y] = await middle(ready);
  await ready.keyboard.down('Shift');
  await ready.mouse.move(x, y);
  await ready.mouse.down();
  await ready.mouse.move(x + 16, y, { steps: 4 });
  await ready.mouse.up();
  await ready.keyboard.up('Shift');
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  // A quarter of the smaller side (64 pixels), 2 · 5 · tan(20°) across the target, to the left.
  const { target } = sent(mock, 'camera').at(-1)!;
  expect(target[0]).toBeCloseTo(-0.25 * 10 * Math.tan(Math.PI / 9), 4);
  mock.received = [];
  await ready.mouse.wheel(0, 100);
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  const last = sent(mock, 'camera').at(-1)!;
  expect(length(sub(last.eye, last.target))).toBeCloseTo(5 * Math.exp(0.1), 4);
});

test('Numpad keys look from the sides', async ({ mock, ready }) => {
  for (const [key, eye, up] of [
    ['Numpad3', [5, 1, 0], [0, 1, 0]],
    ['Numpad1', [0, 1, 5], [0, 1, 0]],
    ['Control+Numpad3', [-5, 1, 0], [0, 1, 0]],
    ['Numpad7', [0, 6, 0], [0, 0, -1]],
    ['Control+Numpad7', [0, -4, 0], [0, 0, 1]],
  ] as const) {
    mock.received = [];
    await ready.locator('canvas.picture').press(key);
    await expect.poll(() => sent(mock, 'camera').at(-1)?.moving, key).toBe(false);
    const camera = sent(mock, 'camera').at(-1)!;
    expect(length(sub(camera.eye, [...eye])), `${key}: ${camera.eye}`).toBeLessThan(1e-6);
    expect(length(sub(camera.up, [...up])), `${key}: ${camera.up}`).toBeLessThan(1e-6);
  }
});

test('flying', async ({ mock, ready }) => {
  await ready.locator('canvas.picture').press('Shift+Backquote');
  await expect(ready.locator('.hint')).toBeVisible();
  await ready.keyboard.down('w');
  await expect.poll(() => (sent(mock, 'camera').at(-1)?.eye[2] ?? 5) < 4.5).toBe(true);
  await ready.keyboard.up('w');
  await ready.keyboard.press('Escape');
  await expect(ready.locator('.hint')).toBeHidden();
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  const { eye, target } = sent(mock, 'camera').at(-1)!;
  expect(length(sub(eye, target))).toBeCloseTo(5, 5);
});

test('the picture is zoomed and moved with Ctrl, without the server', async ({ mock, ready }) => {
  const [x, y] = await middle(ready);
  mock.shade = (x, y) => (x === 48 && y === 32 ? [1, 1, 1] : [0, 0, 0]);
  mock.frame();
  await expect.poll(() => codes(ready, [[48, 32]])).toEqual([255, 255, 255]);
  await ready.keyboard.down('Control');
  await ready.mouse.move(x, y);
  await ready.mouse.wheel(0, -100);
  await ready.mouse.wheel(0, -100);
  await ready.mouse.wheel(0, -100);
  await ready.mouse.wheel(0, -100);
  await ready.keyboard.up('Control');
  // e^1.2 = 3.3 canvas pixels wide, around the pointer.
  const columns = async () => {
    const places = Array.from({ length: 21 * 80 }, (_, i) => [20 + (i % 80), 22 + Math.floor(i / 80)]);
    const all = await codes(ready, places);
    return [...new Set(places.flatMap(([x], i) => (all[3 * i] === 255 ? [x!] : [])))].sort((a, b) => a - b);
  };
  await expect.poll(async () => [3, 4].includes((await columns()).length)).toBe(true);
  const before = await columns();
  expect(Math.abs(before[0]! - 48)).toBeLessThan(4);
  await ready.keyboard.down('Control');
  await ready.mouse.down();
  await ready.mouse.move(x + 30, y, { steps: 3 });
  await ready.mouse.up();
  await ready.keyboard.up('Control');
  await expect.poll(columns).toEqual(before.map((x) => x + 30));
  expect(sent(mock, 'camera')).toHaveLength(0);
});

test('a camera that cannot be moved is left alone', async ({ mock, ready }) => {
  mock.change({ camera: { ...mock.state.camera, movable: false } });
  const [x, y] = await middle(ready);
  await expect(ready.locator('details.section', { hasText: 'it cannot be moved here' })).toHaveCount(1);
  await ready.mouse.move(x, y);
  await ready.mouse.down();
  await ready.mouse.move(x + 40, y, { steps: 3 });
  await ready.mouse.up();
  await ready.locator('canvas.picture').press('Numpad1');
  await ready.waitForTimeout(200);
  expect(sent(mock, 'camera')).toHaveLength(0);
});

test('one finger orbits, two pan and dolly', async ({ mock, browser }) => {
  const context = await browser.newContext({ hasTouch: true, viewport: { width: 360, height: 740 } });
  const page = await context.newPage();
  await page.goto(mock.url);
  await expect(page.locator('.status-facts')).toContainText('64 / 256 spp');
  const client = await context.newCDPSession(page);
  const touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', ...touchPoints: { x: number; y: number; id: number }[]) =>
    client.send('Input.dispatchTouchEvent', { type, touchPoints });
  await touch('touchStart', { x: 180, y: 300, id: 0 });
  for (let i = 1; i <= 5; i++) await touch('touchMove', { x: 180 + 12 * i, y: 300, id: 0 });
  await touch('touchEnd');
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  const orbited = sent(mock, 'camera').at(-1)!;
  expect(length(sub(orbited.eye, orbited.target))).toBeCloseTo(5, 5);
  expect(orbited.eye[0]).toBeLessThan(-0.3);
  mock.received = [];
  await touch('touchStart', { x: 140, y: 300, id: 0 }, { x: 220, y: 300, id: 1 });
  for (let i = 1; i <= 8; i++) await touch('touchMove', { x: 140 - 5 * i, y: 300, id: 0 }, { x: 220 + 5 * i, y: 300, id: 1 });
  await touch('touchEnd');
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  // Twice as far apart: half as far away.
  const pinched = sent(mock, 'camera').at(-1)!;
  expect(length(sub(pinched.eye, pinched.target))).toBeCloseTo(2.5, 1);
  await context.close();
});

/** Points at the middle of the picture, where this point is. */
async function pointAt(mock: Mock, page: Page, at: Pixel['channels']): Promise<void> {
  mock.places = () => at;
  await page.mouse.move(...(await middle(page)));
  await page.locator('canvas.picture').focus();
}

test('the camera turns to the point under the pointer, and about it', async ({ mock, ready }) => {
  await pointAt(mock, ready, { 'P.X': 1, 'P.Y': 2, 'P.Z': -1, Z: 6 });
  await ready.keyboard.press('.');
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  expect(sent(mock, 'camera').at(-1)).toMatchObject({ eye: [0, 1, 5], target: [1, 2, -1], up: [0, 1, 0] });
  await ready.keyboard.press('ArrowRight');
  await expect.poll(() => sent(mock, 'camera').filter((c) => !c.moving)).toHaveLength(2);
  const { eye, target } = sent(mock, 'camera').at(-1)!;
  expect(target).toEqual([1, 2, -1]);
  expect(length(sub(eye, target))).toBeCloseTo(Math.sqrt(38), 6);
  expect(eye[0]).toBeLessThan(-0.1);
});

test('with Shift the lens is focused as far as the point is along the axis', async ({ mock, ready }) => {
  // From (0, 1, 5) along −z, in a camera of half the scale.
  mock.change({ camera: { ...mock.state.camera, unit: 0.5 } });
  await pointAt(mock, ready, { 'P.X': 1, 'P.Y': 2, 'P.Z': -1.25, Z: 6.25 });
  await ready.keyboard.press('Shift+Period');
  const edit = { type: 'edit', node: 'main', parameter: 'focal_distance', value: '12.5', moving: false };
  await expect.poll(() => sent(mock, 'edit')).toEqual([edit]);
  expect(sent(mock, 'camera')).toEqual([]);

  mock.change({ camera: { ...mock.state.camera, lens: null } });
  mock.broadcast({ type: 'message', severity: 'note', text: 'the state came' });
  await expect(ready.locator('.toast')).toHaveText('the state came');
  await ready.keyboard.press('Shift+Period');
  await expect(ready.locator('.toast')).toHaveText('this kind of camera has no focal distance');
  await pointAt(mock, ready, { 'P.X': 0, 'P.Y': 0, 'P.Z': 0, Z: 'Infinity' });
  await ready.keyboard.press('.');
  await expect(ready.locator('.toast')).toHaveText('there is no surface under the pointer');
  await pointAt(mock, ready, {});
  await ready.keyboard.press('.');
  await expect(ready.locator('.toast')).toContainText('not known of a preview');
  expect([sent(mock, 'edit').length, sent(mock, 'camera').length]).toEqual([1, 0]);
});
