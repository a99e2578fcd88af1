/** The connection with the line of its status, and the state that the server told last. */

import type { FrameEnd, PageMessage, ServerMessage, State } from './protocol';
import { Socket } from './socket';
import { Status } from './status';
import type { Tile } from './tile';

/** Parts of the page that are told. */
export interface Told {
  /** A state; `isNew` where it is the first one of a connection. */
  state(state: State, isNew: boolean): void;
  /** What holds where it can be changed: a state that knows of all that was changed here, or the first one. */
  fields(state: State, isNew: boolean): void;
  frame(frame: FrameEnd): void;
  tile(tile: Tile): void;
  /** A message other than states and frames. */
  other(message: ServerMessage): void;
}

export class Connection {
  readonly status = new Status(() => this.socket?.retry());
  state: State | null = null;
  private socket: Socket | null = null;
  private isNew = true;

  /** Sends, unless there is no connection; tells whether it did. */
  send(message: PageMessage): boolean {
    return this.socket?.send(message) ?? false;
  }

  /** Connects, and tells what comes. */
  open(told: Told): void {
    this.socket = new Socket({
      message: (message) => {
        if (message.type === 'state') this.takeState(message, told);
        else if (message.type === 'frame') {
          told.frame(message);
          this.status.update(null, message);
        } else told.other(message);
      },
      tile: (tile) => told.tile(tile),
      status: (connected, seconds) => {
        this.isNew ||= connected;
        this.status.connected(connected, seconds);
      },
      settled: () => this.state && told.fields(this.state, this.isNew),
    });
  }

  private takeState(state: State, told: Told): void {
    const { isNew } = this;
    this.state = state;
    told.state(state, isNew);
    // A state that doesn't know yet of what was changed here would undo it.
    if (isNew || this.socket?.isSettled) told.fields(state, isNew);
    this.status.update(state, null);
    this.isNew = false;
  }
}
