/** The scene is edited, and other scenes are dropped onto the page. */

import { readFileSync } from 'node:fs';
import { anew, canvas, command, differing, done, download, expect, expectSame, open, test } from './fixture';

test('a material is edited by colour and slider, saved, and taken back', async ({ program, view }) => {
  const before = await canvas(view);
  await open(view, 'Scene');
  await view.locator('.node', { hasText: 'green' }).locator('> summary').click();
  await anew(view, () => view.getByLabel('green: reflectance', { exact: true }).fill('#2040ff'));
  await view.locator('.node', { hasText: 'perspective 1' }).locator('> summary').click();
  await anew(view, () => view.getByLabel('perspective 1: fov, slider').fill('50'));
  const edited = await canvas(view);
  expect(differing(edited, before)).toBeGreaterThan(1000);
  // The command is of the scene's file, once it is saved.
  const words = await command(view);
  expect(words).toContain('cornell-box-edited.steradian');
  await download(view, program, 'Scene', 'cornell-box-edited.steradian');
  await expectSame(view, program, 'edited');

  await anew(view, () => view.getByRole('button', { name: 'Undo' }).click());
  await anew(view, () => view.getByRole('button', { name: 'Undo' }).click());
  expect(differing(await canvas(view), before)).toBe(0);
  await expect(view.getByRole('button', { name: 'Undo' })).toBeDisabled();
  await anew(view, () => view.locator('canvas.picture').press('Control+Shift+Z'));
  await anew(view, () => view.locator('canvas.picture').press('Control+Shift+Z'));
  expect(differing(await canvas(view), edited)).toBe(0);
});

test('what cannot be is refused in words, and the picture stays', async ({ view }) => {
  const before = await canvas(view);
  await open(view, 'Scene');
  await view.locator('.node', { hasText: 'green' }).locator('> summary').click();
  await view.locator('.node', { hasText: 'green' }).locator('.more > summary').click();
  const map = view.getByLabel('green: normal_map', { exact: true });
  await map.fill('nowhere.png');
  await map.press('Enter');
  await expect(view.getByRole('alert')).not.toBeEmpty();
  await expect(view.locator('.status')).toHaveAttribute('data-what', 'done');
  expect(differing(await canvas(view), before)).toBe(0);
});

test('a shape is placed elsewhere, as the command line renders it', async ({ program, view }) => {
  const before = await canvas(view);
  await open(view, 'Scene');
  const sphere = view.locator('.node', { hasText: 'sphere' }).first();
  await sphere.locator('> summary').click();
  const field = sphere.getByLabel(/to_world, location y$/);
  await anew(view, async () => {
    await field.fill(String(Number(await field.inputValue()) + 0.4));
    await field.press('Enter');
  });
  expect(differing(await canvas(view), before)).toBeGreaterThan(300);
  expect(await command(view)).toContain('cornell-box-edited.steradian');
  await download(view, program, 'Scene', 'cornell-box-edited.steradian');
  await expectSame(view, program, 'placed');
});

const GEM = readFileSync(new URL('./gem.obj', import.meta.url), 'utf8');

/** An environment map, green. */
const GREEN = `PF\n1 1\n-1.0\n\0\0\0\0\0\0\x80?\0\0\0\0`;

/** Files dropped in the window, with their texts. */
const drop = (files: Record<string, string>) => {
  const data = new DataTransfer();
  const bytes = (text: string) => Uint8Array.from(text, (c) => c.charCodeAt(0));
  for (const [name, text] of Object.entries(files)) data.items.add(new File([bytes(text)], name));
  for (const type of ['dragenter', 'dragover', 'drop'])
    dispatchEvent(new DragEvent(type, { dataTransfer: data, cancelable: true, bubbles: true }));
};

test.describe('dropped', () => {
  // A broken file is answered with 422, which the console tells, too.
  test.use({ allowed: [/status of 422/] });

  test('a model is opened, a broken one told and the other kept', async ({ view }) => {
    await view.evaluate(drop, { 'gem.obj': GEM, 'gem.mtl': 'newmtl ruby\nKd 0.8 0.1 0.1\n' });
    await expect(view).toHaveTitle(/^gem\.obj/);
    // Its preview may be over before one looks.
    await expect(view.locator('.status-facts')).not.toContainText('96 × 64');
    await view.getByLabel('Samples per pixel').fill('2');
    await view.getByLabel('Samples per pixel').press('Enter');
    await view.getByLabel('Width in pixels').fill('48');
    await view.getByLabel('Height in pixels').fill('32');
    await view.getByLabel('Height in pixels').press('Enter');
    await expect(view.locator('.status-facts')).toContainText('48 × 32');
    await done(view);
    const film = { width: 48, height: 32 };
    const gem = await canvas(view, film);
    const middle = gem.slice(3 * (48 * 16 + 24), 3 * (48 * 16 + 25));
    expect(middle[0]! - middle[1]!, 'ruby in the middle').toBeGreaterThan(60);

    await view.evaluate(drop, { 'broken.obj': 'v 0 0 0\nf 1 2 99\n' });
    await expect(view.getByRole('alert')).toContainText('broken.obj');
    await expect(view).toHaveTitle(/^gem\.obj/);
    await view.evaluate(drop, { 'notes.txt': 'no scene' });
    await expect(view.getByRole('alert')).toContainText('no scene among the files');
    expect(differing(await canvas(view, film), gem)).toBe(0);

    await anew(view, () => view.evaluate(drop, { 'green.pfm': GREEN }));
    const [red, green] = (await canvas(view, film)).slice(0, 2);
    expect(green! - red!, 'green around it').toBeGreaterThan(60);
    await anew(view, () => view.locator('canvas.picture').press('Control+Z'));
    expect(differing(await canvas(view, film), gem)).toBe(0);
  });
});
