/** `steradian view` as a process, and connections to it. */

import { spawn } from 'node:child_process';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { WebSocket } from 'ws';

const PROGRAM = resolve(process.env.STERADIAN ?? '../target/debug/steradian');
/** Ticks of `/proc/PID/stat` in a second: Linux has this many on all its machines. */
const TICKS = 100;

/** Starts it; `address` comes when it is printed, or fails with what was said. */
export function start(words, patience = 60) {
  const from = performance.now();
  const child = spawn(PROGRAM, ['view', ...words], { stdio: ['ignore', 'pipe', 'pipe'] });
  // Whatever fails here, it does not outlive this.
  process.on('exit', () => child.kill('SIGKILL'));
  let [out, said] = ['', ''];
  child.stderr.on('data', (text) => (said += text));
  const address = new Promise((done, fail) => {
    const ended = (why) => fail(new Error(`${why}: ${said.trim().split('\n')[0]}`));
    setTimeout(() => ended(`no address after ${patience} s`), 1000 * patience).unref();
    child.on('error', fail).on('exit', () => ended('it ended'));
    child.stdout.on('data', (text) => (out += text).includes('\n') && done(out.split('\n')[0]));
  });
  const stop = () =>
    new Promise((done) => {
      if (child.exitCode !== null || child.signalCode !== null) return done();
      child.on('exit', done).kill('SIGKILL');
    });
  return { from, pid: child.pid, address, stop, said: () => said };
}

/** User and system time of a process or a thread, seconds. */
export function cpu(task) {
  const fields = readFileSync(`${task}/stat`, 'utf8').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / TICKS;
}

/** The thread that serves pages, for `cpu`; of the process's first threads, which stay. A thread names itself when it first runs. */
export async function server(pid, patience = 60) {
  for (let left = patience; left > 0; left -= 0.1) {
    const tasks = readdirSync(`/proc/${pid}/task`).map((t) => `/proc/${pid}/task/${t}`);
    const found = tasks.find((task) => existsSync(`${task}/comm`) && readFileSync(`${task}/comm`, 'utf8').trim() === 'server');
    if (found) return found;
    await pause(0.1);
  }
  throw new Error('there is no thread of the name "server"');
}

/** Resident memory of a process, MiB. */
export const resident = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;

/** A page's connection: `told` gets every text, and the bytes of tiles since the last one. */
export function connect(address, told, failed) {
  const socket = new WebSocket(`${address.replace('http', 'ws')}api/socket`);
  let [bytes, closing] = [0, false];
  socket.on('message', (data, isBinary) => {
    if (isBinary) bytes += data.length;
    else {
      told(JSON.parse(String(data)), bytes);
      bytes = 0;
    }
  });
  socket.on('error', (e) => closing || failed(`socket: ${e.message}`));
  socket.on('close', (code) => closing || failed(`socket closed, ${code}`));
  const close = () => {
    closing = true;
    socket.terminate();
  };
  return { send: (message) => socket.send(JSON.stringify(message)), close };
}

/** The eye turned about the target, around `up`. */
export function turned({ eye, target, up }, degrees) {
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  const length = Math.hypot(...up);
  const k = up.map((v) => v / length);
  const v = eye.map((e, i) => e - target[i]);
  const dot = k.reduce((sum, ki, i) => sum + ki * v[i], 0);
  const cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
  return { eye: target.map((t, i) => t + v[i] * c + cross[i] * s + k[i] * dot * (1 - c)), target, up };
}

export function quantile(values, q) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted.length === 0 ? NaN : sorted[Math.round(q * (sorted.length - 1))];
}

export const pause = (seconds) => new Promise((done) => setTimeout(done, 1000 * seconds));

/** `--name value` of the command line, and the words without a name. */
export function options(known) {
  const [found, words] = [{ ...known }, []];
  for (let i = 2; i < process.argv.length; i++) {
    const name = process.argv[i].startsWith('--') ? process.argv[i].slice(2) : null;
    if (name === null) words.push(process.argv[i]);
    else if (name in known) found[name] = typeof known[name] === 'number' ? Number(process.argv[++i]) : process.argv[++i];
    else
      throw new Error(
        `unknown option --${name}; known are ${Object.keys(known)
          .map((k) => `--${k}`)
          .join(' ')}`,
      );
  }
  return { ...found, words };
}
