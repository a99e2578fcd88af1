/** Panels: inspector, settings, nodes, saving, messages, region, connection. */

import { codes, expect, largest, middle, open, sent, srgb, test } from './fixture';
import { pattern } from './mock';

test('the inspector shows values under the pointer, and pins a pixel', async ({ mock, ready }) => {
  const [x, y] = await middle(ready);
  const box = (await ready.locator('canvas.picture').boundingBox())!;
  const left = Math.round((box.width - 96) / 2) + box.x;
  const top = Math.round((box.height - 64) / 2) + box.y;
  await ready.mouse.move(left + 95.5, top + 63.5);
  await expect(ready.locator('.values')).toContainText('95, 63:  4  4');
  await ready.mouse.click(left + 10.5, top + 20.5);
  const pin = ready.locator('.pin');
  await expect(pin).toContainText('Pixel 10, 20');
  // The raw float, not the half: 40/95.
  await expect(pin.getByRole('row', { name: /^picture/ })).toContainText('0.4210526');
  await expect(pin.getByRole('row', { name: /^albedo/ })).toContainText('0.8');
  await expect(pin).toContainText('red glass');
  await expect(pin).toContainText('1.23 %');
  await expect(ready.locator('.mark')).toBeVisible();
  expect(sent(mock, 'camera')).toHaveLength(0);
  await ready.getByLabel('Unpin the pixel').click();
  await expect(pin).toBeEmpty();
  await ready.mouse.click(x, y - 200);
  await expect(pin).toBeEmpty();
});

test('a pinned value that is not finite is told', async ({ mock, ready }) => {
  mock.shade = () => [NaN, Infinity, -Infinity];
  const [x, y] = await middle(ready);
  await ready.mouse.click(x, y);
  await expect(ready.locator('.pin')).toContainText('NaN  Infinity  -Infinity');
});

test('settings are sent and shown', async ({ mock, ready }) => {
  await ready.getByLabel('Integrator').selectOption('bdpt');
  await ready.getByLabel('Samples per pixel').fill('32');
  await ready.getByLabel('Samples per pixel').press('Enter');
  await ready.getByLabel('Most bounces').fill('7');
  await ready.getByLabel('Most bounces').press('Enter');
  await ready.getByLabel('Most bounces').fill('');
  await ready.getByLabel('Most bounces').press('Enter');
  await ready.getByLabel('Denoise').selectOption('atrous');
  await ready.getByLabel('Denoise').selectOption('no');
  await ready.getByLabel('Width in pixels').fill('128');
  await ready.getByLabel('Width in pixels').press('Enter');
  const settings = [
    { integrator: 'bdpt' },
    { spp: 32 },
    { maxDepth: 7 },
    { maxDepth: null },
    { denoise: 'atrous' },
    { denoise: null },
    { width: 128, height: 64 },
  ];
  await expect.poll(() => sent(mock, 'settings')).toEqual(settings.map((s) => ({ type: 'settings', ...s })));
  await expect(ready.locator('.status-facts')).toContainText('bdpt');
  await expect(ready.locator('.status-facts')).toContainText('128 × 64');
  // What isn't a whole number above 0 is not sent.
  await ready.getByLabel('Samples per pixel').fill('0');
  await ready.getByLabel('Samples per pixel').press('Enter');
  await ready.waitForTimeout(100);
  expect(sent(mock, 'settings')).toHaveLength(settings.length);
});

test('nodes are edited by kind of parameter, undone and redone', async ({ mock, ready }) => {
  await open(ready, 'Scene');
  await ready.locator('.node', { hasText: 'red glass' }).locator('> summary').click();
  await ready.locator('.node', { hasText: 'red glass' }).locator('.more > summary').click();
  const edits = () => sent(mock, 'edit').map(({ parameter, value }) => [parameter, value]);
  await ready.getByLabel('red glass: eta', { exact: true }).fill('1.7');
  await ready.getByLabel('red glass: eta', { exact: true }).press('Enter');
  await expect.poll(edits).toEqual([['eta', '1.7']]);
  await ready.getByLabel('red glass: thin').check();
  await ready.getByLabel('red glass: distribution').selectOption('beckmann');
  await ready.getByLabel('red glass: tint', { exact: true }).fill('#ff0000');
  await expect.poll(() => edits().at(-1)).toEqual(['tint', '[1, 0, 0]']);
  await ready.getByLabel('red glass: tint, green').fill('2.5');
  await ready.getByLabel('red glass: tint, green').press('Enter');
  await expect.poll(() => edits().at(-1)).toEqual(['tint', '[1, 2.5, 0]']);
  await ready.getByLabel('red glass: grey, colour').fill('#0000ff');
  await expect.poll(() => edits().at(-1)).toEqual(['grey', '[0, 0, 1]']);
  await expect(ready.getByLabel('red glass: grey, blue')).toHaveValue('1');
  await ready.getByLabel('What holds when eta is not given').click();
  await expect.poll(() => edits().at(-1)).toEqual(['eta', null]);
  await expect(ready.getByLabel('red glass: eta', { exact: true })).toHaveValue('1.5');
  expect(edits().map(([p]) => p)).toEqual(expect.arrayContaining(['thin', 'distribution']));
  // Beyond the range: told, not sent.
  const count = edits().length;
  await ready.getByLabel('red glass: eta', { exact: true }).fill('5');
  await ready.getByLabel('red glass: eta', { exact: true }).press('Enter');
  await ready.waitForTimeout(100);
  expect(edits()).toHaveLength(count);
  await ready.locator('.node', { hasText: 'floor' }).locator('> summary').click();
  await expect(ready.getByLabel('floor: reflectance')).toHaveValue('{texture: checker}');
  await ready.locator('canvas.picture').press('Control+z');
  await expect.poll(() => sent(mock, 'undo')).toHaveLength(1);
  await ready.locator('canvas.picture').press('Control+Shift+Z');
  await expect.poll(() => sent(mock, 'redo')).toHaveLength(1);
  await ready.getByRole('button', { name: 'Undo' }).click();
  await expect.poll(() => sent(mock, 'undo')).toHaveLength(2);
});

/** What can be waited for until it is let go. */
function gate(): { opened: Promise<void>; open: () => void } {
  let open = () => {};
  const opened = new Promise<void>((resolve) => (open = resolve));
  return { opened, open };
}

test('a state on its way does not undo what was changed meanwhile', async ({ mock, ready }) => {
  const requests = gate();
  mock.delay = requests.opened;
  await ready.getByLabel('Width in pixels').fill('48');
  await ready.getByLabel('Width in pixels').press('Enter');
  await expect.poll(() => sent(mock, 'settings')).toHaveLength(1);
  // Another page renames the scene.
  mock.change({ scene: { ...mock.state.scene, name: 'balls' } });
  await expect(ready).toHaveTitle(/^balls/);
  await ready.getByLabel('Height in pixels').fill('32');
  await ready.getByLabel('Height in pixels').press('Enter');
  await ready.getByRole('button', { name: 'Pause' }).click();
  await ready.getByRole('button', { name: 'Pause' }).click();
  requests.open();
  await expect(ready.locator('.status-facts')).toContainText('48 × 32');
  await expect.poll(() => sent(mock, 'pause').map((p) => p.on)).toEqual([true, false]);
  await expect(ready.getByRole('button', { name: 'Pause' })).toHaveAttribute('aria-pressed', 'false');
  // What another page chooses is shown again.
  mock.change({ film: { width: 64, height: 64 } });
  await expect(ready.getByLabel('Width in pixels')).toHaveValue('64');
});

test('nodes on their way do not undo what was edited meanwhile', async ({ mock, ready }) => {
  await open(ready, 'Scene');
  await ready.locator('.node', { hasText: 'red glass' }).locator('> summary').click();
  await ready.locator('.node', { hasText: 'red glass' }).locator('.more > summary').click();
  const [requests, nodes] = [gate(), gate()];
  mock.delay = requests.opened;
  let isAsked = false;
  await ready.route(/api\/nodes/, async (route) => {
    const response = await route.fetch();
    isAsked = true;
    await nodes.opened;
    await route.fulfill({ response });
  });
  mock.change({ undo: 7 });
  await expect.poll(() => isAsked).toBe(true);
  await ready.getByLabel('red glass: tint, red').fill('0.1');
  await ready.getByLabel('red glass: tint, red').press('Enter');
  const arrived = ready.waitForResponse(/api\/nodes/);
  nodes.open();
  await (await arrived).finished();
  // The page knows it, too.
  await ready.evaluate(() => new Promise((resolve) => setTimeout(resolve)));
  // Nor are others asked for that cannot know of it.
  isAsked = false;
  mock.change({ undo: 8 });
  await ready.getByLabel('red glass: tint, green').fill('0.6');
  await ready.getByLabel('red glass: tint, green').press('Enter');
  expect(isAsked).toBe(false);
  requests.open();
  await expect.poll(() => sent(mock, 'edit').map((e) => e.value)).toEqual(['[0.1, 0.2, 0.1]', '[0.1, 0.6, 0.1]']);
});

test('a slider that is held sends values as pictures come, and the last one to stay, so that one undo takes it back', async ({
  mock,
  ready,
}) => {
  await open(ready, 'Scene');
  await ready.locator('.node', { hasText: 'red glass' }).locator('> summary').click();
  await ready.locator('.node', { hasText: 'red glass' }).locator('.more > summary').click();
  const slider = ready.getByLabel('red glass: alpha, slider');
  await slider.scrollIntoViewIfNeeded();
  const box = (await slider.boundingBox())!;
  await ready.mouse.move(box.x + 8, box.y + box.height / 2);
  await ready.mouse.down();
  for (let i = 1; i <= 20; i++) await ready.mouse.move(box.x + 8 + ((box.width - 16) * i) / 20, box.y + box.height / 2);
  await ready.mouse.up();
  await expect
    .poll(() =>
      sent(mock, 'edit')
        .filter((e) => !e.moving)
        .map((e) => e.value),
    )
    .toEqual(['1']);
  const moving = sent(mock, 'edit').filter((e) => e.moving);
  expect(moving.length).toBeGreaterThan(0);
  expect(moving.length).toBeLessThanOrEqual(20);
  expect(sent(mock, 'edit').at(-1)!.moving ?? false).toBe(false);
});

test('the scene is filtered', async ({ ready }) => {
  await open(ready, 'Scene');
  await expect(ready.locator('.node:visible')).toHaveCount(4);
  await ready.getByLabel('Filter the nodes').fill('glass');
  await expect(ready.locator('.node:visible')).toHaveCount(1);
});

test('a region is drawn, sent, and given up', async ({ mock, ready }) => {
  const [x, y] = await middle(ready);
  await ready.getByRole('button', { name: 'Region' }).click();
  await ready.mouse.move(x - 20, y - 10);
  await ready.mouse.down();
  await ready.mouse.move(x + 10, y + 10, { steps: 3 });
  await ready.mouse.up();
  await expect.poll(() => sent(mock, 'region')).toHaveLength(1);
  const [x0, y0, x1, y1] = sent(mock, 'region')[0]!.pixels!;
  expect([x1 - x0, y1 - y0]).toEqual([31, 21]);
  expect(Math.abs(x0 - 28)).toBeLessThanOrEqual(1);
  expect(Math.abs(y0 - 22)).toBeLessThanOrEqual(1);
  await expect(ready.locator('.region')).toBeVisible();
  // The region's frame lies where the region is, and nothing is shown elsewhere.
  const inside = [
    [x0, y0],
    [x1 - 1, y1 - 1],
  ];
  const wanted = inside.flatMap((p) => pattern(p[0]!, p[1]!).map((v) => srgb(Math.min(v, 1))));
  await expect.poll(async () => largest(await codes(ready, [...inside, [x0 - 2, y0 - 2]]), [...wanted, 0, 0, 0])).toBeLessThanOrEqual(1);
  expect(sent(mock, 'camera')).toHaveLength(0);
  await ready.getByRole('button', { name: 'Whole' }).click();
  await expect.poll(() => sent(mock, 'region').at(-1)?.pixels).toBe(null);
  await expect(ready.locator('.region')).toBeHidden();
});

test('pause, camera choice and reset', async ({ mock, ready }) => {
  await ready.getByRole('button', { name: 'Pause' }).click();
  await expect(ready.locator('.status-facts')).toContainText('paused');
  await ready.locator('canvas.picture').press('p');
  await expect(ready.locator('.status-facts')).toContainText('rendering');
  expect(sent(mock, 'pause').map((p) => p.on)).toEqual([true, false]);
  await open(ready, 'Camera');
  await ready.getByLabel('Camera', { exact: true }).selectOption('side');
  await expect.poll(() => sent(mock, 'camera-name')).toEqual([{ type: 'camera-name', name: 'side' }]);
  await expect(ready.getByRole('button', { name: 'Reset' })).toBeDisabled();
  await ready.getByRole('button', { name: 'Top' }).click();
  await ready.getByRole('button', { name: 'Reset' }).click();
  await expect.poll(() => sent(mock, 'camera-reset')).toHaveLength(1);
  await expect(ready.getByRole('button', { name: 'Reset' })).toBeDisabled();
  mock.received = [];
  await ready.locator('canvas.picture').press('ArrowLeft');
  await expect.poll(() => sent(mock, 'camera').at(-1)?.moving).toBe(false);
  // The reset camera is the one that turns.
  expect(sent(mock, 'camera').at(-1)!.eye[1]).toBeCloseTo(1, 6);
  await ready.getByLabel('Angle of view', { exact: true }).fill('60');
  await ready.getByLabel('Angle of view', { exact: true }).press('Enter');
  await expect.poll(() => sent(mock, 'camera').at(-1)).toMatchObject({ fov: 60, moving: false });
});

test('files are saved, downloaded with the view’s tone, and the command copied', async ({ mock, ready, context }) => {
  await context.grantPermissions(['clipboard-read', 'clipboard-write']);
  await open(ready, 'Save');
  await ready.getByLabel('Tone curve').selectOption('reinhard');
  await ready.getByLabel('reinhard: white', { exact: true }).fill('2');
  await ready.getByLabel('reinhard: white', { exact: true }).press('Enter');
  await ready.locator('canvas.picture').press(']');
  const download = ready.waitForEvent('download');
  await ready.getByRole('link', { name: 'PNG' }).click();
  expect((await download).url()).toBe(`${mock.url}api/picture.png?tone=reinhard%3Awhite%3D2&exposure=0.5`);
  await ready.getByRole('button', { name: 'PNG' }).click();
  await expect(ready.locator('.toast')).toContainText('saved /scenes/picture.png');
  expect(mock.posted.map((p) => JSON.parse(p.body))).toEqual([{ name: 'picture.png', tone: 'reinhard:white=2', exposure: 0.5 }]);
  await ready.getByRole('button', { name: 'Copy command' }).click();
  await expect(ready.locator('.toast')).toContainText('command copied');
  expect(await ready.evaluate(() => navigator.clipboard.readText())).toBe(mock.state.command);
});

test('dropped files are opened', async ({ mock, ready }) => {
  await ready.evaluate(() => {
    const data = new DataTransfer();
    data.items.add(new File(['solid'], 'part.obj'));
    data.items.add(new File(['newmtl'], 'part.mtl'));
    for (const type of ['dragenter', 'dragover', 'drop'])
      dispatchEvent(new DragEvent(type, { dataTransfer: data, cancelable: true, bubbles: true }));
  });
  await expect(ready.locator('.toast.error')).toContainText('no scene among the files');
  expect(mock.posted[0]!.path).toBe('api/open');
  expect(mock.posted[0]!.body).toContain('name="file"; filename="part.obj"');
  expect(mock.posted[0]!.body).toContain('name="file"; filename="part.mtl"');
});

test('messages are listed', async ({ mock, ready }) => {
  mock.broadcast({ type: 'message', severity: 'error', text: "no parameter 'colour'" });
  await expect(ready.getByRole('alert')).toHaveText("no parameter 'colour'");
  await open(ready, 'Messages');
  await expect(ready.locator('.messages li')).toHaveText(["errorno parameter 'colour'", /held at 4$/]);
});

test('a lost connection is told and made again', async ({ mock, ready }) => {
  mock.drop();
  await expect(ready.locator('.status')).toContainText('connection lost');
  mock.samples = 128;
  await expect(ready.locator('.status-facts')).toContainText('128 / 256 spp');
  await expect(ready.locator('.status')).not.toContainText('connection lost');
  await ready.locator('canvas.picture').press('p');
  await expect.poll(() => sent(mock, 'pause')).toHaveLength(1);
});
