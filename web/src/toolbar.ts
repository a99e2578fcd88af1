/** Buttons over the picture. */

import { h, isPressed, setPressed } from './dom';
import type { State } from './protocol';
import { themeButton } from './theme';

export interface ToolbarActions {
  fit(): void;
  actual(): void;
  pause(on: boolean): void;
  clearRegion(): void;
  help(): void;
  panel(): void;
  themed(): void;
}

function toggleFullScreen(): void {
  // Where the browser refuses, the page stays as it is.
  void (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen()).catch(() => {});
}

export class Toolbar {
  readonly element: HTMLElement;
  /** Whether the region tool is in hand. */
  region = false;
  private readonly regionButton: HTMLButtonElement;
  private readonly clearButton: HTMLButtonElement;
  private readonly pauseButton: HTMLButtonElement;
  private readonly panelButton: HTMLButtonElement;

  constructor(actions: ToolbarActions) {
    const button = (text: string, title: string, act: () => void, attributes: Record<string, string> = {}) =>
      h('button', { title, onclick: act, ...attributes }, text);
    this.regionButton = button('Region', 'Render only what you frame (R)', () => this.setRegion(!this.region), { 'aria-pressed': 'false' });
    this.clearButton = button('Whole', 'Render the whole picture again', actions.clearRegion);
    this.clearButton.hidden = true;
    this.pauseButton = button('Pause', 'Pause or go on (P)', () => actions.pause(!isPressed(this.pauseButton)), {
      'aria-pressed': 'false',
    });
    this.panelButton = button('Panel', 'Show or hide the panel (N)', actions.panel, { 'aria-expanded': 'true' });
    this.element = h(
      'div',
      { class: 'toolbar', role: 'toolbar', 'aria-label': 'Picture' },
      button('Fit', 'Fit the picture into the window (F)', actions.fit),
      button('1:1', 'One pixel for each pixel (1)', actions.actual),
      this.regionButton,
      this.clearButton,
      this.pauseButton,
      h('span', { class: 'gap' }),
      button('Full', 'Full screen (F11)', toggleFullScreen, { 'aria-label': 'Full screen' }),
      themeButton(actions.themed),
      button('?', 'Keys and pointer (?)', actions.help, { 'aria-label': 'Keys and pointer' }),
      this.panelButton,
    );
  }

  update(state: State): void {
    this.clearButton.hidden = state.region === null;
    this.setPaused(state.paused);
  }

  setPaused(on: boolean): void {
    setPressed(this.pauseButton, on);
  }

  setRegion(on: boolean): void {
    this.region = on;
    setPressed(this.regionButton, on);
    document.body.classList.toggle('draws-region', on);
  }

  setPanel(hidden: boolean): void {
    this.panelButton.setAttribute('aria-expanded', String(!hidden));
  }

  /** As the button does. */
  press(which: 'pause' | 'panel'): void {
    (which === 'pause' ? this.pauseButton : this.panelButton).click();
  }
}
