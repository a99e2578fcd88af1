/** Light, ground, background and moment of models and glTF scenes, against the commands that the page shows. */

import { fileURLToPath } from 'node:url';
import { anew, canvas, differing, expect, expectSame, FILM, show, test } from './fixture';
import { Program } from './program';

const beside = (name: string) => fileURLToPath(new URL(name, import.meta.url));
const start = (name: string, ...words: string[]) =>
  Program.start(beside(name), '--size', `${FILM.width}x${FILM.height}`, '--spp', '4', ...words);

test('a model is shown in other surroundings, as its command renders it', async ({ page }) => {
  const program = await start('gem.obj', '-D', 'turn=30');
  await show(page, program);
  const command = page.locator('code.command');
  await expect(command).toContainText('-D turn=30');
  await expectSame(page, program, 'usual');
  const before = await canvas(page);
  await page.getByRole('heading', { name: 'Surroundings' }).click();
  await anew(page, () => page.getByLabel('Sky', { exact: true }).selectOption('overcast'));
  await anew(page, () => page.getByLabel('Material of all').selectOption('gold'));
  await anew(page, () => page.getByLabel('Background', { exact: true }).selectOption('gradient'));
  await anew(page, () => page.getByLabel('Ground', { exact: true }).selectOption('shadow'));
  await anew(page, async () => {
    await page.getByLabel('Turn of the sky in degrees', { exact: true }).fill('90');
    await page.getByLabel('Turn of the sky in degrees', { exact: true }).press('Enter');
  });
  for (const define of ['sky=overcast', 'material=gold', 'background=gradient', 'ground=shadow', 'turn=90'])
    await expect(command).toContainText(`-D ${define}`);
  expect(differing(await canvas(page), before)).toBeGreaterThan(1000);
  await expectSame(page, program, 'gold');
  // The command of a film runs, also where the camera was moved.
  await page.getByRole('heading', { name: 'Camera' }).click();
  await anew(page, () => page.getByRole('button', { name: 'Top', exact: true }).click());
  await page.getByRole('button', { name: 'Copy turntable command' }).click();
  const film = await page.evaluate(() => navigator.clipboard.readText());
  await program.run(film.replace('--turntable 96', '--turntable 2'));
  expect((await program.read('turntable.gif')).subarray(0, 3).toString()).toBe('GIF');
  await program.stop();
});

test('an animation is posed by its slider and plays', async ({ page }) => {
  const program = await start('moving.gltf');
  await show(page, program);
  await page.getByRole('heading', { name: 'Surroundings' }).click();
  const before = await canvas(page);
  const time = page.getByLabel('Time in seconds');
  await anew(page, () => time.fill('1.5'));
  await expect(page.locator('code.command')).toContainText('-D at=1.5');
  expect(differing(await canvas(page), before)).toBeGreaterThan(100);
  await expectSame(page, program, 'posed');
  // It plays until it is stopped, and the picture is that of the moment then.
  const play = page.getByRole('button', { name: 'Play', exact: true });
  await anew(page, async () => {
    await play.click();
    await expect(time).not.toHaveValue('1.5');
    await page.getByRole('button', { name: 'Stop', exact: true }).click();
  });
  await expect(page.locator('code.command')).toContainText(`-D at=${await time.inputValue()}`);
  await expectSame(page, program, 'stopped');
  await program.stop();
});

test('the exposure is chosen by the picture, as the command chooses it', async ({ page }) => {
  const program = await start('gem.obj', '-D', 'strength=300');
  await show(page, program);
  // White as it is: a model is exposed by itself.
  const exposure = page.getByLabel('Exposure in EV', { exact: true });
  expect(Number(await exposure.inputValue())).toBeLessThan(-2);
  await page.getByRole('button', { name: 'Expose by the picture' }).click();
  await expectSame(page, program, 'auto', '--exposure', 'auto');
  await program.stop();
});

test('viewpoints are kept, gone back to, and forgotten', async ({ page }) => {
  const program = await start('gem.obj');
  await show(page, program);
  await page.getByRole('heading', { name: 'Camera' }).click();
  const list = page.getByLabel('Kept viewpoints');
  await expect(list).toBeDisabled();
  await page.getByRole('button', { name: 'Keep', exact: true }).click();
  const before = await canvas(page);
  await anew(page, () => page.getByRole('button', { name: 'Top', exact: true }).click());
  expect(differing(await canvas(page), before)).toBeGreaterThan(1000);
  await anew(page, () => list.selectOption('0'));
  expect(await canvas(page)).toEqual(before);
  // They stay when the page is loaded again.
  await show(page, program);
  await page.getByRole('heading', { name: 'Camera' }).click();
  await expect(list).toHaveValue('0');
  await page.getByRole('button', { name: 'Forget', exact: true }).click();
  await expect(list).toBeDisabled();
  await program.stop();
});
