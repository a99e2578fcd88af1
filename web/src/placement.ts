/** Where the picture lies on the canvas: fitted, or zoomed and moved. Lengths are in device pixels. */

const LEAST = 1 / 16;
const MOST = 128;

export class Placement {
  /** Device pixels for each pixel of the film. */
  scale = 1;
  /** The picture's left upper corner on the canvas. */
  left = 0;
  top = 0;
  private fitted = true;
  private canvas = { width: 1, height: 1 };
  private film = { width: 1, height: 1 };

  /** Sizes may have changed. */
  update(canvas: { width: number; height: number }, film: { width: number; height: number }): void {
    const same = canvas.width === this.canvas.width && canvas.height === this.canvas.height;
    const sameFilm = film.width === this.film.width && film.height === this.film.height;
    if (same && sameFilm) return;
    const [dx, dy] = [canvas.width - this.canvas.width, canvas.height - this.canvas.height];
    this.canvas = { width: canvas.width, height: canvas.height };
    this.film = { width: film.width, height: film.height };
    if (this.fitted) this.fit();
    else if (!sameFilm) this.center();
    else this.pan(dx / 2, dy / 2);
  }

  /** As large as the canvas allows, in its middle. */
  fit(): void {
    this.fitted = true;
    this.scale = Math.min(this.canvas.width / this.film.width, this.canvas.height / this.film.height);
    this.center();
  }

  /** One device pixel for each pixel of the film, in the middle. */
  actual(): void {
    this.fitted = false;
    this.scale = 1;
    this.center();
  }

  pan(dx: number, dy: number): void {
    this.left += dx;
    this.top += dy;
    if (dx !== 0 || dy !== 0) this.fitted = false;
  }

  /** Magnifies; what is at (x, y) of the canvas stays there. */
  zoom(factor: number, x = this.canvas.width / 2, y = this.canvas.height / 2): void {
    this.fitted = false;
    const before = this.scale;
    let scale = Math.min(Math.max(before * factor, LEAST), MOST);
    // Sizes where each pixel is as large as the others attract.
    const near = scale >= 1 ? Math.round(scale) : 1 / Math.round(1 / scale);
    if (Math.abs(scale / near - 1) < 0.04 && Math.abs(near / before - 1) > 0.01) scale = near;
    this.scale = scale;
    this.left = Math.round(x - ((x - this.left) * scale) / before);
    this.top = Math.round(y - ((y - this.top) * scale) / before);
  }

  /** The film's pixel (with fraction) at a place of the canvas. */
  pixelAt(x: number, y: number): [number, number] {
    return [(x - this.left) / this.scale, (y - this.top) / this.scale];
  }

  private center(): void {
    this.left = Math.round((this.canvas.width - this.film.width * this.scale) / 2);
    this.top = Math.round((this.canvas.height - this.film.height * this.scale) / 2);
  }
}
