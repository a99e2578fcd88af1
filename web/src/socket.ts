/** The connection: typed messages, and reconnecting with growing pauses. */

import type { PageMessage, ServerMessage } from './protocol';
import { parseTile, type Tile } from './tile';

export interface Listeners {
  message(message: ServerMessage): void;
  tile(tile: Tile): void;
  /** `seconds` until the next try, or `null` when connected. */
  status(connected: boolean, seconds: number | null): void;
  /** All that was asked for is answered. */
  settled(): void;
}

const FIRST_PAUSE = 0.5;
const LONGEST_PAUSE = 10;

export class Socket {
  private socket: WebSocket | null = null;
  private pause = FIRST_PAUSE;
  private timer = 0;
  /** Requests without an answer yet. */
  private asked = 0;

  constructor(private readonly listeners: Listeners) {
    this.connect();
    addEventListener('online', () => this.retry());
  }

  /** Whether the last state knows of all that was asked for. */
  get isSettled(): boolean {
    return this.asked === 0;
  }

  /** Sends, or forgets it when there is no connection: the state that comes after connecting tells what holds. */
  send(message: PageMessage): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.asked++;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  /** Tries now, when waiting. */
  retry(): void {
    if (this.timer === 0) return;
    clearTimeout(this.timer);
    this.connect();
  }

  private take(message: ServerMessage): void {
    if (message.type !== 'answered') this.listeners.message(message);
    else if (--this.asked === 0) this.listeners.settled();
  }

  private connect(): void {
    this.timer = 0;
    const url = new URL('./api/socket', location.href);
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(url);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.pause = FIRST_PAUSE;
      this.asked = 0;
      this.listeners.status(true, null);
    };
    socket.onmessage = ({ data }) => {
      if (data instanceof ArrayBuffer) {
        const tile = parseTile(data);
        if (tile) this.listeners.tile(tile);
      } else {
        this.take(JSON.parse(data as string) as ServerMessage);
      }
    };
    socket.onclose = () => {
      this.listeners.status(false, this.pause);
      this.timer = window.setTimeout(() => this.connect(), 1000 * this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE);
    };
    this.socket = socket;
  }
}
