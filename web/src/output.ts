/** Panel "Save": files to download or to write beside the scene, and the command that renders the same. */

import { h, section } from './dom';
import type { Message, State } from './protocol';
import { toneText } from './tone';
import type { View } from './view';

/** What stands for the scene among files that can be saved. */
const SCENE = 'scene.steradian';

export class Output {
  readonly element: HTMLElement;
  private readonly exr = h(
    'a',
    { class: 'button', download: 'picture.exr', href: './api/picture.exr', title: 'All values, with the layer that is shown' },
    'EXR',
  );
  private readonly png = h('a', { class: 'button', download: 'picture.png', href: './api/picture.png' }, 'PNG');
  private readonly scene = h(
    'a',
    { class: 'button', download: 'scene.steradian', href: './api/scene.steradian', title: 'The scene as it is now' },
    'Scene',
  );
  private readonly command = h('code', {
    class: 'command',
    tabindex: 0,
    'aria-label': 'Command that renders this picture',
    role: 'textbox',
    'aria-readonly': 'true',
  });
  private state: State | null = null;

  constructor(
    private readonly view: View,
    private readonly tell: (message: Message) => void,
  ) {
    this.element = section(
      'Save',
      false,
      h('div', { class: 'row' }, h('span', {}, 'Download'), h('span', { class: 'buttons' }, this.exr, this.png, this.scene)),
      h(
        'div',
        { class: 'row' },
        h('span', {}, 'Beside scene'),
        h(
          'span',
          { class: 'buttons' },
          ...['picture.exr', 'picture.png', SCENE].map((name) =>
            h(
              'button',
              {
                title: name === SCENE ? 'Write the scene as it is now into its folder' : `Write ${name} into the scene’s folder`,
                onclick: () => void this.save(name === SCENE ? (this.state?.saveName ?? SCENE) : name),
              },
              name.endsWith('steradian') ? 'Scene' : name.slice(-3).toUpperCase(),
            ),
          ),
        ),
      ),
      this.command,
      h('div', { class: 'buttons' }, h('button', { onclick: () => void this.copy() }, 'Copy command')),
    );
  }

  update(state: State | null = this.state): void {
    this.state = state;
    if (!state) return;
    const layers = [...state.layers, ...(state.settings.lightGroups ? ['light_groups'] : [])];
    this.exr.href = `./api/picture.exr${layers.length ? `?layers=${layers.join(',')}` : ''}`;
    this.scene.download = state.saveName;
    this.png.href = `./api/picture.png?${new URLSearchParams(this.look())}`;
    if (this.command.textContent !== state.command) this.command.textContent = state.command;
  }

  /** Tone and exposure as the view has them. */
  private look(): { tone: string; exposure: string } {
    return { tone: toneText(this.view.tone, this.state?.choices.tones ?? []), exposure: String(this.view.tone.exposure) };
  }

  private async save(name: string): Promise<void> {
    const { tone, exposure } = this.look();
    const body = JSON.stringify(name.endsWith('.png') ? { name, tone, exposure: Number(exposure) } : { name });
    try {
      const response = await fetch('./api/save', { method: 'POST', headers: { 'content-type': 'application/json' }, body });
      const answer = (await response.json()) as { saved?: string; error?: string };
      this.tell(
        answer.saved
          ? { severity: 'note', text: `saved ${answer.saved}` }
          : { severity: 'error', text: answer.error ?? response.statusText },
      );
    } catch {
      this.tell({ severity: 'error', text: `${name} was not saved: the server does not answer` });
    }
  }

  /** Copies a command, by default that of the picture. */
  async copy(text = this.state?.command ?? ''): Promise<void> {
    try {
      await navigator.clipboard.writeText(text);
      this.tell({ severity: 'note', text: 'command copied' });
    } catch {
      getSelection()?.selectAllChildren(this.command);
      this.tell({ severity: 'warning', text: 'the browser does not let the page copy; the command is selected instead' });
    }
  }
}
