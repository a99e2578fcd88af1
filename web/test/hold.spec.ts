/** `npm run mock`: the page at the mock server until the program is ended, to work on the page by hand. */

import { test } from '@playwright/test';
import { balls } from './balls';
import { Mock } from './mock';

test('hold', async () => {
  test.skip(process.env['STERADIAN_MOCK'] === undefined, 'only for work by hand');
  test.setTimeout(0);
  const mock = new Mock();
  mock.state.film = { width: 640, height: 400 };
  mock.shade = (x, y) => balls(x, y, mock.state.film.width, mock.state.film.height);
  await mock.start(5180);
  console.log(`the page is at ${mock.url}`);
  await new Promise(() => {});
});
