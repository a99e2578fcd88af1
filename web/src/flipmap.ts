/** The map of FLIP errors: asked of the server as frames come, one at a time. */

import type { Figures } from './protocol';
import type { Pieces } from './reference';
import type { View } from './view';

export class FlipMap {
  private isBusy = false;
  private isStale = false;
  private turn = 0;

  /** `told` is given the figures, or why there are none. */
  constructor(
    private readonly view: View,
    private readonly tone: () => string,
    private readonly fetch: (tone: string, exposure: number) => Promise<Pieces<Figures>>,
    private readonly told: (figures: Figures | string) => void,
  ) {}

  /** The picture, B or how they are displayed has changed. */
  update(): void {
    if (this.isBusy) this.isStale = true;
    else void this.ask();
  }

  /** Forgets the map, also the one that is on its way. */
  clear(): void {
    this.turn++;
    this.isStale = false;
    this.view.others.keep(['reference']);
  }

  private async ask(): Promise<void> {
    this.isBusy = true;
    const { turn } = this;
    try {
      const { head, tiles } = await this.fetch(this.tone(), this.view.tone.exposure);
      if (turn === this.turn) {
        for (const tile of tiles) this.view.others.tile('map', tile);
        this.view.others.swap(head.crop, 'map');
        this.view.redraw();
        this.told(head);
      }
    } catch (error) {
      if (turn === this.turn) this.told(error instanceof Error ? error.message : String(error));
    }
    this.isBusy = false;
    if (this.isStale) {
      this.isStale = false;
      this.update();
    }
  }
}
