/** The line below the picture: how far the render is, and whether the server is there. */

import { h, setText, show } from './dom';
import type { FrameEnd, State } from './protocol';

export class Status {
  readonly element = h('footer', { class: 'status' });
  private readonly dot = h('span', { class: 'dot', 'aria-hidden': 'true' });
  private readonly connection = h('span', { role: 'status' }, 'connecting');
  private readonly facts = h('span', { class: 'status-facts' });
  private readonly progress = h('progress', { max: 1, value: 0, 'aria-label': 'Samples taken' });
  private readonly retry: HTMLButtonElement;
  private state: State | null = null;
  private frame: FrameEnd | null = null;

  constructor(retry: () => void) {
    this.retry = h('button', { class: 'small', hidden: true, onclick: retry }, 'Try now');
    this.element.append(this.dot, this.connection, this.retry, this.facts, this.progress);
  }

  connected(on: boolean, seconds: number | null): void {
    this.element.classList.toggle('lost', !on);
    this.retry.hidden = on;
    setText(this.connection, on ? '' : `connection lost; next try in ${seconds} s`);
  }

  update(state: State | null, frame: FrameEnd | null): void {
    this.state = state ?? this.state;
    this.frame = frame ?? this.frame;
    const { settings, paused } = this.state ?? {};
    const f = this.frame;
    const what = f === null ? 'no picture yet' : paused ? 'paused' : f.kind === 'preview' ? 'preview' : f.done ? 'done' : 'rendering';
    this.element.dataset.what = what;
    const parts = [what, settings?.integrator];
    if (f) {
      const isCounted = f.kind === 'render' || f.samples < f.target;
      parts.push(isCounted ? `${show(f.samples)} / ${f.target} spp` : null!);
      if (f.error !== null) parts.push(`error ${show(100 * f.error)} %`);
      parts.push(`${f.seconds < 10 ? f.seconds.toFixed(2) : f.seconds.toFixed(0)} s`);
      if (f.denoised) parts.push('denoised');
      if (f.nonfinite > 0) parts.push(`${f.nonfinite} not finite`);
      parts.push(`${f.width} × ${f.height}`);
      this.progress.value = Math.min(1, f.samples / Math.max(f.target, 1));
    }
    const text = parts.filter(Boolean).join(' · ');
    setText(this.facts, text);
    this.facts.title = text;
  }
}
