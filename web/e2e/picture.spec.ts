/** What is shown, and how it is asked for, against the same program at the command line. */

import { anew, canvas, differing, download, expect, expectSame, generation, open, place, test } from './fixture';

test('the canvas, the values of pixels and the saved file are those of the copied command', async ({ program, view }) => {
  await expect(view.getByLabel('Tone curve')).toHaveValue('none');
  await expectSame(view, program, 'none');
  await view.getByLabel('Tone curve').selectOption('agx');
  await view.getByLabel('Exposure in EV', { exact: true }).fill('1');
  await view.getByLabel('Exposure in EV', { exact: true }).press('Enter');
  await expectSame(view, program, 'agx', '--tonemap', 'agx', '--exposure', '1');

  await download(view, program, 'EXR', 'saved.exr');
  const [rendered, saved] = [await program.values('none.exr'), await program.values('saved.exr')];
  expect(Buffer.from(saved.rgb.buffer).equals(Buffer.from(rendered.rgb.buffer)), 'every bit of the EXR').toBe(true);
  await download(view, program, 'PNG', 'saved.png');
  await program.run('steradian compare saved.png agx.png --fail-above max_abs=0');

  for (const [x, y] of [
    [0, 0],
    [40, 30],
    [95, 63],
    [28, 55],
  ] as const) {
    const answered = view.waitForResponse((r) => r.url().includes('/api/pixel?'));
    await view.mouse.click(...(await place(view, x, y)));
    const pixel = await (await answered).json();
    expect([pixel.x, pixel.y, pixel.samples]).toEqual([x, y, 4]);
    const wanted = [...rendered.rgb.slice(3 * (y * rendered.width + x)).slice(0, 3)];
    // What JSON says is a double: the float next to it is meant.
    expect(['R', 'G', 'B'].map((c) => Math.fround(pixel.channels[c]))).toEqual(wanted);
    const row = view.locator('.pin tr', { has: view.locator('th', { hasText: /^picture$/ }) }).locator('td');
    // Seven digits of the shortest decimal, which is not the float itself.
    const shown = (await row.textContent())!.split('  ').map(Number);
    wanted.forEach((v, c) => expect(Math.abs(shown[c]! - v)).toBeLessThanOrEqual(1e-6 * Math.abs(v)));
  }
});

test('the mouse orbits: previews at once, then the render of where the camera stands', async ({ program, view }) => {
  const before = await canvas(view);
  const [x, y] = await place(view, 48, 32);
  const kinds = await anew(view, async () => {
    await view.mouse.move(x, y);
    await view.mouse.down();
    for (let i = 1; i <= 5; i++) await view.mouse.move(x + i, y + i);
    await expect(view.locator('.status')).toHaveAttribute('data-what', 'preview');
    await view.mouse.up();
  });
  expect(kinds.slice(0, 2)).toEqual(['preview', 'preview']);
  expect(differing(await canvas(view), before)).toBeGreaterThan(1000);
  await expectSame(view, program, 'orbit');
  await expect(view.locator('code.command')).toContainText('--look-at');
});

test('exposure changes what is shown alone; an integrator and a seed the picture', async ({ program, view }) => {
  const [asked, before] = [[] as string[], await generation(view)];
  view.on('request', (r) => asked.push(r.url()));
  await view.getByLabel('Exposure in EV, slider').fill('-1');
  await expectSame(view, program, 'dark', '--exposure', '-1');
  expect([asked, await generation(view)]).toEqual([[], before]);
  await view.getByLabel('Exposure in EV, slider').fill('0');
  await anew(view, () => view.getByLabel('Integrator').selectOption('direct'));
  await anew(view, async () => {
    await view.getByLabel('Seed').fill('7');
    await view.getByLabel('Seed').press('Enter');
  });
  await expectSame(view, program, 'direct');
  const words = await view.locator('code.command').textContent();
  expect(words).toContain('--integrator direct');
  expect(words).toContain('--seed 7');
});

test('each denoiser has the last word with the bits of its command; one that is not there is refused', async ({ program, view }) => {
  const denoise = view.getByLabel('Denoise');
  for (const name of ['atrous', 'nlm']) {
    await anew(view, () => denoise.selectOption(name));
    await expect(view.locator('.status')).toContainText('denoised');
    await expect(view.locator('code.command')).toContainText(`--denoise=${name}`);
    await expectSame(view, program, name);
    await download(view, program, 'EXR', 'saved.exr');
    const [rendered, saved] = [await program.values(`${name}.exr`), await program.values('saved.exr')];
    expect(Buffer.from(saved.rgb.buffer).equals(Buffer.from(rendered.rgb.buffer)), name).toBe(true);
  }
  await denoise.selectOption('oidn');
  await expect(view.locator('.messages')).toContainText('pip install');
  await expect(denoise).toHaveValue('nlm');
  await anew(view, () => denoise.selectOption('no'));
  await expect(view.locator('.status')).not.toContainText('denoised');
});

test('a region is rendered alone, to the same bits', async ({ program, view }) => {
  await anew(view, async () => {
    await view.getByRole('button', { name: 'Region' }).click();
    await view.mouse.move(...(await place(view, 20, 10)));
    await view.mouse.down();
    await view.mouse.move(...(await place(view, 59, 41)), { steps: 3 });
    await view.mouse.up();
  });
  await expect(view.locator('code.command')).toContainText('--crop 20,10,60,42');
  const words = (await view.locator('code.command').textContent())!;
  await program.run(words, '-o', 'part.exr');
  await open(view, 'Save');
  await download(view, program, 'EXR', 'saved.exr');
  const [rendered, saved] = [await program.values('part.exr'), await program.values('saved.exr')];
  expect([saved.width, saved.height]).toEqual([40, 32]);
  expect(Buffer.from(saved.rgb.buffer).equals(Buffer.from(rendered.rgb.buffer)), 'every bit of the region').toBe(true);
  const shown = await canvas(view);
  expect(
    shown.slice(0, 3 * 96 * 10).every((v) => v === 0),
    'nothing above the region',
  ).toBe(true);
  expect(shown.some((v) => v > 0)).toBe(true);
  await anew(view, () => view.getByRole('button', { name: 'Whole' }).click());
  await expectSame(view, program, 'whole');
});
