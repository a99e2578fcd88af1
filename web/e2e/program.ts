/** The program: as a server of the page, and as a command. */

import { execFile, spawn, type ChildProcess } from 'node:child_process';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { promisify } from 'node:util';

const PROGRAM = resolve(process.env['STERADIAN'] ?? '../target/debug/steradian');
const START_SECONDS = 20;

/** A picture in linear RGB, rows from the top. */
export interface Values {
  width: number;
  height: number;
  rgb: Float32Array;
}

/** `steradian view`, in a folder of its own where commands run, too. */
export class Program {
  private constructor(
    readonly url: string,
    readonly folder: string,
    private readonly child: ChildProcess,
    private readonly said: () => string,
  ) {}

  static async start(...words: string[]): Promise<Program> {
    const folder = await mkdtemp(join(tmpdir(), 'steradian-e2e-'));
    // Open Image Denoise is in no usual place then.
    const env = { ...process.env, STERADIAN_OIDN: folder };
    const child = spawn(PROGRAM, ['view', ...words], { cwd: folder, env, stdio: ['ignore', 'pipe', 'pipe'] });
    let [out, said] = ['', ''];
    child.stderr.on('data', (text) => (said += text));
    const url = await new Promise<string>((done, fail) => {
      const ended = () => fail(new Error(`${PROGRAM} told no address\n${said}`));
      setTimeout(ended, 1000 * START_SECONDS).unref();
      child.on('error', fail).on('exit', ended);
      child.stdout.on('data', (text) => (out += text).includes('\n') && done(out.split('\n')[0]!));
    });
    return new Program(url, folder, child, () => said);
  }

  /** What it wrote to standard error. */
  get errors(): string {
    return this.said();
  }

  async stop(): Promise<void> {
    const ended = this.child.exitCode !== null || new Promise((done) => this.child.on('exit', done));
    this.child.kill('SIGKILL');
    await ended;
    await rm(this.folder, { recursive: true, force: true });
  }

  /** Runs a command that the page showed, `steradian …`, with more words. */
  async run(command: string, ...more: string[]): Promise<void> {
    const words = command.split(' ');
    if (words.shift() !== 'steradian') throw new Error(`not a command of the program: ${command}`);
    await promisify(execFile)(PROGRAM, [...words, ...more], { cwd: this.folder });
  }

  read(name: string): Promise<Buffer> {
    return readFile(join(this.folder, name));
  }

  /** The values of a picture's file, bit by bit. */
  async values(name: string): Promise<Values> {
    await this.run(`steradian convert ${name} ${name}.pfm`);
    const bytes = await this.read(`${name}.pfm`);
    const [head, width, height] = /^PF\n(\d+) (\d+)\n-1\.0*\n/.exec(bytes.toString('latin1')) ?? [];
    if (head === undefined) throw new Error(`${name}.pfm is no PFM of three colours in little-endian order`);
    const [w, h] = [Number(width), Number(height)];
    const rgb = new Float32Array(3 * w * h);
    for (let y = 0; y < h; y++)
      for (let i = 0; i < 3 * w; i++) rgb[3 * w * y + i] = bytes.readFloatLE(head.length + 4 * (3 * w * (h - 1 - y) + i));
    return { width: w, height: h, rgb };
  }
}
