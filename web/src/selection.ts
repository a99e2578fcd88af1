/** The shape that is selected by a click on the picture. */

import type { Gizmo } from './gizmo';
import type { OutlineDrawing } from './outline';
import type { FrameEnd, Outline, Pixel, State } from './protocol';

/** Nodes by their names. */
export interface Selected {
  shape: string;
  material: string | null;
  light: string | null;
}

export class Selection {
  selected: Selected | null = null;
  /** Called when something else is selected. */
  changed: (selected: Selected | null) => void = () => {};
  /** Whether the pixel that is asked about selects. */
  private waits = false;
  private scene = '';
  private generation = 0;
  private frameKey = '';
  private outlined = '';

  constructor(
    private readonly drawing: OutlineDrawing,
    private readonly gizmo: Gizmo,
  ) {}

  /** A pixel was clicked: what is known of it selects. */
  click(): void {
    this.waits = true;
  }

  /** What is known of the clicked pixel; coarse pictures may know no surfaces. */
  take({ hasSurface, object, material, light }: Pixel): void {
    if (!this.waits || !hasSurface) return;
    this.set(object === null ? null : { shape: object, material, light });
  }

  set(selected: Selected | null): void {
    this.waits = false;
    if (selected === null && this.selected === null) return;
    const isOther = selected?.shape !== this.selected?.shape;
    this.selected = selected;
    if (isOther) {
      this.outlined = '';
      this.show(null);
      void this.outline();
    }
    this.changed(selected);
  }

  /** Of another picture the outline is another. */
  state({ generation, scene }: State): void {
    const name = `${scene.path} ${scene.name}`;
    if (name !== this.scene) this.set(null);
    this.scene = name;
    if (generation === this.generation) return;
    this.generation = generation;
    this.outlined = '';
    this.show(null);
  }

  private show(outline: Outline | null): void {
    this.drawing.show(outline);
    this.gizmo.show(outline?.handle ?? null);
  }

  frame({ generation, width, height, kind }: FrameEnd): void {
    this.frameKey = `${generation} ${width} ${height} ${kind}`;
    void this.outline();
  }

  private async outline(): Promise<void> {
    const { selected, frameKey } = this;
    if (!selected || this.outlined === frameKey) return;
    this.outlined = frameKey;
    try {
      const response = await fetch(`./api/outline?shape=${encodeURIComponent(selected.shape)}`);
      const outline = response.ok ? ((await response.json()) as Outline | null) : null;
      if (selected.shape !== this.selected?.shape || this.outlined !== frameKey) return;
      // First paths know no surfaces: the outline of the preview stays.
      if (outline?.generation === this.generation) this.show(outline);
      else this.outlined = '';
    } catch {
      this.outlined = '';
    }
  }
}
