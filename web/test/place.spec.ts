/** Places of shapes: transforms as location, rotation and scale. */

import { placeOf, textOf, type Place } from '../src/place';
import { expect, open, sent, test } from './fixture';

type Pair = [number, number];

/** The matrix of steps that are made one after the other, each by its own matrix. */
function matrix({ location: [x, y, z], rotation, scale: [a, b, c] }: Place): number[][] {
  const times = (m: number[][], n: number[][]) => m.map((row) => n[0]!.map((_, k) => row.reduce((sum, v, i) => sum + v * n[i]![k]!, 0)));
  const [[s, t], [u, v], [p, q]] = rotation.map((r) => [Math.sin((r * Math.PI) / 180), Math.cos((r * Math.PI) / 180)]) as [
    Pair,
    Pair,
    Pair,
  ];
  const rows = (text: string, ...numbers: number[]) => {
    let k = 0;
    return text.split(' ').map((row) => [...row].map((c) => (c === '.' ? numbers[k++]! : Number(c))));
  };
  const steps = [
    rows('.000 0.00 00.0 0001', a, b, c),
    rows('1000 0..0 0..0 0001', t, -s, s, t),
    rows('.0.0 0100 .0.0 0001', v, u, -u, v),
    rows('..00 ..00 0010 0001', q, -p, p, q),
    rows('100. 010. 001. 0001', x, y, z),
  ];
  return steps.reduce((all, step) => times(step, all));
}

const numbers = (text: string) =>
  text
    .replace(/^[^[]*\[|\]\}$/g, '')
    .split(',')
    .map(Number);

test('places are transforms and back', () => {
  const places: Place[] = [
    { location: [1, -2, 3], rotation: [10, 20, 30], scale: [1, 2, 3] },
    { location: [0, 0, 0], rotation: [-170, 80, 100], scale: [0.5, 0.5, 0.5] },
    { location: [1e6, 0, 1e-6], rotation: [0, 0, 0], scale: [-1, 1, 1] },
    { location: [0, 0, 0], rotation: [25, 90, 0], scale: [1, 2, 3] },
    { location: [0, 0, 0], rotation: [25, -90, 0], scale: [-4, 2, 3] },
  ];
  for (const place of places) {
    const text = textOf(place);
    numbers(text).forEach((v, i) => expect(v).toBeCloseTo(matrix(place).flat()[i]!, 12));
    const back = placeOf(text)!;
    for (const part of ['location', 'rotation', 'scale'] as const)
      back[part].forEach((v, i) => expect(v, `${part} of ${text}`).toBeCloseTo(place[part][i]!, 6));
  }
  // Any matrix without shear is kept, whatever angles it is said by.
  const text = textOf({ location: [0, 0, 0], rotation: [120, 200, -300], scale: [2, -1, -1] });
  numbers(textOf(placeOf(text)!)).forEach((v, i) => expect(v).toBeCloseTo(numbers(text)[i]!, 12));
  expect(numbers(textOf({ location: [0, 0, 0], rotation: [90, 0, 180], scale: [1, 1, 1] })).slice(0, 3)).toEqual([-1, 0, 0]);
  for (const none of ['{matrix: [1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}', '{matrix: [1, 2]}', '7', ''])
    expect(placeOf(none), none).toBeNull();
});

test('a shape is placed by numbers, and by dragging', async ({ mock, ready }) => {
  await open(ready, 'Scene');
  await ready.locator('.node', { hasText: 'sphere 2' }).locator('> summary').click();
  const field = (name: string) => ready.getByLabel(`sphere 2: to_world, ${name}`, { exact: true });
  await expect(field('location x')).toHaveValue('1.5');
  await expect(field('rotation z')).toHaveValue('90');
  await expect(field('scale y')).toHaveValue('2');
  await field('rotation z').fill('0');
  await field('rotation z').press('Enter');
  const edits = () => sent(mock, 'edit').map(({ parameter, value }) => [parameter, value]);
  await expect.poll(edits).toEqual([['to_world', '{matrix: [2, 0, 0, 1.5, 0, 2, 0, 0, 0, 0, 2, -3, 0, 0, 0, 1]}']]);
  // Nothing is nowhere.
  await field('scale x').fill('0');
  await field('scale x').press('Enter');
  await expect(field('scale x')).toHaveValue('2');
  const handle = (await field('location y').locator('..').locator('.axis').boundingBox())!;
  await ready.mouse.move(handle.x + 5, handle.y + 5);
  await ready.mouse.down();
  await ready.mouse.move(handle.x + 65, handle.y + 5, { steps: 4 });
  await ready.mouse.up();
  // A three-hundredth of the larger of its size and its distance for each pixel.
  const moved = Number((0.2 * Math.hypot(2, 2, 2)).toPrecision(6));
  await expect.poll(() => numbers(String(edits().at(-1)![1]))[7]).toBeCloseTo(moved, 5);
  expect(sent(mock, 'edit').filter((e) => e.moving).length).toBeGreaterThan(0);
  // The last one, to stay, may come after the one that moves to the same place.
  await expect.poll(() => sent(mock, 'edit').filter((e) => !e.moving).length).toBe(2);
});
