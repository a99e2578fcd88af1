/** Light groups: what the page mixes, against the layers that the command line writes. */

import { fileURLToPath } from 'node:url';
import { anew, canvas, codesOf, expect, expectSame, FILM, generation, open, test as base } from './fixture';
import { largest } from '../test/fixture';
import { Program } from './program';

const LAMPS = fileURLToPath(new URL('./lamps.steradian', import.meta.url));

const test = base.extend({
  program: async ({}, use) => {
    const program = await Program.start(LAMPS, '--size', `${FILM.width}x${FILM.height}`, '--spp', '4');
    await use(program);
    await program.stop();
  },
});

test('groups add up to the picture of the command, and alone are its layers', async ({ program, view }) => {
  await open(view, 'Light groups');
  await anew(view, () => view.getByLabel('Mix', { exact: true }).click());
  await expect(view.getByLabel('sky: mute')).toBeVisible();
  await expect(view.locator('code.command')).toContainText('--aov light_groups');
  await expectSame(view, program, 'mixed');

  const [asked, before] = [[] as string[], await generation(view)];
  view.on('request', (r) => asked.push(r.url()));
  for (const [name, stops] of [
    ['lamp', 0],
    ['window', 1],
    ['sky', 2],
  ] as const) {
    await view.getByLabel(`${name}: solo`).click();
    await view.getByLabel(`${name}: intensity in EV, slider`).fill(String(stops));
    await program.run(`steradian convert mixed.exr ${name}.png --layer RGBA_${name} --exposure ${stops}`);
    const codes = await codesOf(view, await program.read(`${name}.png`));
    expect(new Set(codes).size, `light of ${name}`).toBeGreaterThan(20);
    expect(largest(await canvas(view), codes), name).toBeLessThanOrEqual(1);
    await view.getByLabel(`${name}: solo`).click();
  }
  await view.getByRole('button', { name: 'Reset mix' }).click();
  expect([asked, await generation(view)]).toEqual([[], before]);
  await expectSame(view, program, 'again');
});

test('methods that cannot keep lights apart say so, and the picture stays', async ({ view }) => {
  await anew(view, () => view.getByLabel('Integrator').selectOption('bdpt'));
  const before = await canvas(view);
  await open(view, 'Light groups');
  await view.getByLabel('Mix', { exact: true }).click();
  await expect(view.getByRole('alert')).toContainText('layers of groups of lights');
  await expect(view.getByLabel('Mix', { exact: true })).not.toBeChecked();
  expect(largest(await canvas(view), before)).toBe(0);
});
