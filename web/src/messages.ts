/** Panel "Messages", and the newest one over the picture for some seconds. */

import { h, section, setText } from './dom';
import type { Message } from './protocol';

const SHOWN = 8000;
const KEPT = 100;

export class Messages {
  readonly element: HTMLElement;
  readonly toast = h('div', { class: 'toast', role: 'status', hidden: true });
  private readonly list = h('ul', { class: 'messages' });
  private readonly none = h('p', { class: 'facts' }, 'No messages.');
  private readonly clear = h('button', { hidden: true, onclick: () => this.empty() }, 'Clear');
  private own: Message[] = [];
  private ofScene: Message[] = [];
  private timer = 0;

  constructor() {
    this.element = section('Messages', false, this.none, this.list, this.clear);
  }

  /** The scene's own messages. */
  scene(messages: Message[]): void {
    if (JSON.stringify(messages) === JSON.stringify(this.ofScene)) return;
    this.ofScene = messages;
    this.fill();
  }

  add(message: Message): void {
    this.own = [message, ...this.own].slice(0, KEPT);
    this.fill();
    this.toast.className = `toast ${message.severity}`;
    this.toast.setAttribute('role', message.severity === 'error' ? 'alert' : 'status');
    this.toast.hidden = false;
    setText(this.toast, message.text);
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => (this.toast.hidden = true), SHOWN);
  }

  private empty(): void {
    this.own = [];
    this.fill();
  }

  private fill(): void {
    const all = [...this.own, ...this.ofScene];
    this.none.hidden = all.length > 0;
    this.clear.hidden = this.own.length === 0;
    const items = all.map(({ severity, text }) => h('li', { class: severity }, h('span', { class: 'severity' }, severity), text));
    this.list.replaceChildren(...items);
    const count = this.element.querySelector('h2')!;
    setText(count, all.length > 0 ? `Messages (${all.length})` : 'Messages');
  }
}
