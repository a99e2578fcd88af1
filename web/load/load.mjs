/** Many pages at one program: `npm run load -- --seconds 600 --clients 20`. In the first half one of them moves the camera every two
 *  seconds (`--every`); in the second all watch, and all but one go and come back, which tells what they cost. Fails on a request
 *  that fails, on memory that grows, and on serving that costs; on what a sample costs more with `--most-cpu PERCENT`. */

import { connect, cpu, options, pause, quantile, resident, server, start, turned } from './program.mjs';

const {
  seconds,
  clients,
  every,
  scene,
  size,
  'most-cpu': mostCpu,
} = options({ seconds: 20, clients: 20, every: 2, scene: 'builtin:cornell-box', size: '320x200', 'most-cpu': 0 });
/** Growth of the memory at its peaks, in per cent, and in MiB what an allocator may keep: while the camera moves, when previews and
 *  renders without noise come and go (a leak of half a MiB a move is beyond it), and while all watch. */
const MOST = [
  [15, 24],
  [2, 4],
];
/** Part of the CPU time that serving may take: unlike that of a sample, whatever else the machine does. */
const MOST_SHARE = 0.05;

const program = start([scene, '--size', size, '--spp', '16777216']);
const address = await program.address;
const [whole, serving] = [`/proc/${program.pid}`, await server(program.pid)];
const [width, height] = size.split('x').map(Number);
const failures = [];
const failed = (why) => failures.push(why);
const frames = Array(clients).fill(0);
const requests = { count: 0 };
const pages = Array(clients).fill(null);
let camera = null;
/** Times, CPU seconds and samples as the first page's frames come. */
let ticks = [];

function open(i) {
  pages[i] ??= connect(
    address,
    (message) => {
      if (message.type === 'message' && message.severity === 'error') failed(message.text);
      if (i === 0 && message.type === 'state') camera ??= message.camera;
      if (message.type !== 'frame') return;
      frames[i]++;
      if (i === 0 && message.kind === 'render' && message.samples > 1)
        ticks.push({
          at: performance.now(),
          cpu: cpu(whole),
          serving: cpu(serving),
          samples: message.samples,
          generation: message.generation,
        });
    },
    failed,
  );
}
function close(i) {
  pages[i]?.close();
  pages[i] = null;
}

/** What pages ask beside the socket. */
async function ask() {
  const paths = ['', 'assets/app.js', 'api/state', `api/pixel?x=${width >> 1}&y=${height >> 1}`, 'api/picture.png'];
  for (const path of paths) {
    requests.count++;
    const answer = await fetch(address + path).catch((e) => ({ status: e.message }));
    if (answer.status !== 200) failed(`GET ${path}: ${answer.status}`);
    await answer.arrayBuffer?.();
  }
}

const memory = [];
const watch = setInterval(() => memory.push({ at: performance.now(), mib: resident(program.pid) }), 200);
const started = performance.now();
const end = started + 1000 * seconds;
for (let i = 0; i < clients; i++) open(i);
while ((camera === null || ticks.length === 0) && performance.now() < end) await pause(0.01);
requests.count += clients;

for (let step = 0; performance.now() < started + 500 * seconds; step++) {
  requests.count++;
  pages[0].send({ type: 'camera', ...turned(camera, 3 * Math.sin(step)), moving: step % 2 === 0 });
  await ask();
  await pause(every);
}
requests.count++;
pages[0].send({ type: 'camera-reset' });
await pause(Math.min(3, seconds / 8));
const moved = [...frames];

// One page, then all, then one: windows side by side, as machines are not always equally fast.
const costs = [];
const window = Math.min(15, (end - performance.now()) / 1000 / 3.6);
for (let all = true; performance.now() + 900 * window < end; all = !all) {
  for (let i = 1; i < clients; i++) all ? open(i) : close(i);
  await pause(Math.min(1, window / 5));
  ticks = ticks.slice(-1);
  await pause(0.9 * window);
  const last = ticks.at(-1);
  const first = ticks.find((t) => t.generation === last?.generation);
  if (last?.samples > first?.samples)
    costs.push({
      all,
      cost: (last.cpu - first.cpu) / (last.samples - first.samples),
      share: (last.serving - first.serving) / (last.cpu - first.cpu),
    });
}
for (let i = 1; i < clients; i++) open(i);
await ask();
clearInterval(watch);
const took = (performance.now() - started) / 1000;
for (let i = 0; i < clients; i++) close(i);
await program.stop();

// Each window with all pages against the mean of its neighbours with one.
const ratios = costs.flatMap(({ all, cost }, i) => {
  const beside = [costs[i - 1], costs[i + 1]].filter((c) => c && !c.all).map((c) => c.cost);
  return all && beside.length > 0 ? [cost / (beside.reduce((a, b) => a + b) / beside.length)] : [];
});
const more = 100 * (quantile(ratios, 0.5) - 1);
// Peaks: memory goes up and down with what is being made. While the camera moves it is something else than while all watch.
const tenth = (m) => Math.floor((10 * (m.at - started)) / (1000 * took));
const peak = (i) =>
  quantile(
    memory.flatMap((m) => (tenth(m) === i ? [m.mib] : [])),
    0.95,
  );
const tenths = Array.from({ length: 10 }, (_, i) => peak(i));
const growths = [0, 5].map((half) => [Math.max(...tenths.slice(half + 1, half + 3)), Math.max(...tenths.slice(half + 3, half + 5))]);
const percent = ([before, after]) => 100 * (after / before - 1);
const spread = (values) => `${Math.min(...values)} to ${Math.max(...values)}`;
const median = (all) =>
  quantile(
    costs.flatMap((c) => (c.all === all ? [c.cost] : [])),
    0.5,
  );
const share = quantile(
  costs.flatMap((c) => (c.all ? [c.share] : [])),
  0.5,
);
const nanoseconds = (all) => ((1e9 * median(all)) / (width * height)).toFixed(0);

console.log(`${clients} pages, ${took.toFixed(0)} s, ${scene} at ${size}: ${requests.count} requests, ${failures.length} failed`);
for (const why of new Set(failures)) console.log(`  ${why}`);
console.log(`frames of a page while the camera moves: ${spread(moved)}`);
console.log(
  `memory at its peaks by tenths of the time, MiB: ${tenths.map((m) => m.toFixed(1)).join(' ')}; growth ${growths.map((g) => `${percent(g).toFixed(2)} %`).join(' and ')}`,
);
if (ratios.length === 0) console.log('CPU time of a sample: too short a time to compare');
else {
  console.log(`CPU time of a sample, ns: ${nanoseconds(false)} with one page, ${nanoseconds(true)} with ${clients}`);
  console.log(`  pairs of windows: ${ratios.map((r) => `${(100 * (r - 1)).toFixed(2)} %`).join(' ')}; in the median ${more.toFixed(2)} %`);
}
console.log(`CPU time of the thread that serves ${clients} pages: of all ${(100 * share).toFixed(2)} %`);
const wrong = [
  failures.length > 0 && 'requests failed',
  Math.min(...frames) === 0 && 'a page got no frame',
  ...growths.map((g, i) => percent(g) > MOST[i][0] && g[1] - g[0] > MOST[i][1] && `memory grows by ${percent(g).toFixed(1)} %`),
  !(share <= MOST_SHARE) && `serving takes ${(100 * share).toFixed(1)} % of the CPU time`,
  mostCpu > 0 && !(more <= mostCpu) && `pages cost ${more.toFixed(1)} %`,
].filter(Boolean);
if (wrong.length > 0) console.log(`FAILED: ${wrong.join('; ')}`);
process.exitCode = wrong.length > 0 ? 1 : 0;
