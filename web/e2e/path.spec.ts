/** The path of a sample, as the program traces it. */

import { anew, done, expect, place, test } from './fixture';

test('the path of a pixel of the Cornell box begins there, adds up to its sample, and goes with the camera', async ({ view }) => {
  const path = async (act: () => Promise<unknown>) => {
    const answered = view.waitForResponse((r) => r.url().includes('/api/path?'));
    await act();
    return (await answered).json();
  };
  // Of the middle, where no pixel is pinned.
  const middle = await path(() => view.locator('canvas.picture').press('t'));
  expect([middle.x, middle.y]).toEqual([48, 32]);
  const [x, y] = await place(view, 40, 50);
  const first = await path(() => view.mouse.click(x, y));
  expect([first.x, first.y, first.sample, first.tracer, first.of_picture]).toEqual([40, 50, 0, 'path', true]);
  const rows = view.locator('.vertices tbody tr');
  await expect(rows).toHaveCount(first.vertices.length);
  await expect(rows.nth(1)).toContainText(first.vertices[1].object);
  for (const c of [0, 1, 2]) {
    const sum = first.vertices.reduce((s: number, v: typeof first) => s + v.emitted[c] + (v.direct?.light[c] ?? 0), 0);
    expect(Math.abs(sum - first.value[c])).toBeLessThan(1e-5 * (1 + first.value[c]));
  }
  // The first dot lies within the pixel, a point of the screen wide.
  // Measured within the page: the drawing may be drawn anew at any time.
  const [cx, cy] = await view.evaluate(() => {
    const dot = document.querySelector('.path .vertex circle')!.getBoundingClientRect();
    return [dot.x + dot.width / 2, dot.y + dot.height / 2] as const;
  });
  expect(Math.max(Math.abs(cx - x), Math.abs(cy - y))).toBeLessThanOrEqual(0.51);

  const next = await path(() => view.getByRole('button', { name: 'Next sample' }).click());
  expect(next.sample).toBe(1);
  expect(next.vertices[1].position).not.toEqual(first.vertices[1].position);

  await anew(view, () => view.locator('canvas.picture').press('ArrowLeft'));
  await done(view);
  await expect(view.locator('.traced .facts')).toContainText('The camera has moved');
  await expect(view.locator('.path > *')).toHaveCount(0);
});
