/** How soon there is a picture: `npm run latency -- SCENE…` prints a table of times since the program's start, and of the times from a
 *  camera to its preview over 20 moves of one degree. */

import { connect, options, quantile, start, turned } from './program.mjs';

const MOVES = 20;
const { patience, words: scenes } = options({ patience: 30 });

/** Waits until a message is as wanted; `null` when it's not in time. */
function mailbox() {
  const waiting = new Set();
  const told = (message) => waiting.forEach((w) => w(message));
  const next = (wanted, seconds) =>
    new Promise((done) => {
      const end = (message) => (clearTimeout(timer), waiting.delete(look), done(message));
      const look = (message) => wanted(message) && end(message);
      const timer = setTimeout(() => end(null), 1000 * seconds);
      waiting.add(look);
    });
  return { told, next };
}

async function measure(scene) {
  const program = start([scene], patience);
  const since = () => performance.now() - program.from;
  try {
    const address = await program.address;
    const times = { address: since(), preview: null, fine: null };
    const { told, next } = mailbox();
    const from = (message) => message.type === 'frame' && (message.kind === 'preview' || message.samples > 0);
    const first = next(from, patience).then((m) => ((times.preview = m && since()), m));
    const state = next((m) => m.type === 'state', patience);
    const page = connect(address, told, () => {});
    const { camera, film } = (await state) ?? {};
    const preview = await first;
    const fine = await next((m) => from(m) && (m.kind === 'render' || m.width === film?.width), patience);
    times.fine = fine?.kind === 'preview' ? since() : null;
    const moves = [];
    let size = '–';
    for (let i = 1; camera?.movable && preview && i <= MOVES; i++) {
      const sent = performance.now();
      const answer = next((m) => m.type === 'frame' && m.kind === 'preview', patience);
      page.send({ type: 'camera', ...turned(camera, i), moving: true });
      const frame = await answer;
      if (!frame) break;
      moves.push(performance.now() - sent);
      size = `${frame.width} × ${frame.height}`;
    }
    page.close();
    // Paths that came before the page did have taken the first preview's place.
    const early = preview?.kind === 'render' ? '≤ ' : '';
    return [
      `${film?.width} × ${film?.height}`,
      times.address,
      early + show(times.preview),
      times.fine,
      quantile(moves, 0.5),
      quantile(moves, 0.9),
      size,
    ];
  } finally {
    await program.stop();
  }
}

const show = (v) => (typeof v === 'string' ? v : v === null || Number.isNaN(v) ? '–' : v.toFixed(0));

console.log('| Scene | Film | Address, ms | First preview, ms | Whole preview, ms | Camera to preview, ms | 90 %, ms | Preview |');
console.log('| --- | --- | ---: | ---: | ---: | ---: | ---: | --- |');
for (const scene of scenes) {
  const cells = await measure(scene).catch((e) => [`not shown: ${e.message.replaceAll('|', '/')}`]);
  console.log(`| ${scene.split('/').slice(-2).join('/')} | ${cells.map(show).join(' | ')} |`);
}
