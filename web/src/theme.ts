/** Dark or light: as the system has it, or as chosen. */

import { h } from './dom';

const THEMES = ['auto', 'dark', 'light'] as const;
const KEY = 'steradian-theme';

export function themeButton(changed: () => void): HTMLButtonElement {
  let theme: (typeof THEMES)[number] = THEMES.find((t) => t === localStorage.getItem(KEY)) ?? 'auto';
  const button = h('button', { onclick: () => set(THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length]!) });
  function set(to: (typeof THEMES)[number]): void {
    theme = to;
    localStorage.setItem(KEY, to);
    document.documentElement.dataset.theme = to;
    button.textContent = { auto: '◐', dark: '●', light: '○' }[to];
    button.title = `Theme: ${to}`;
    button.setAttribute('aria-label', button.title);
    changed();
  }
  set(theme);
  matchMedia('(prefers-color-scheme: light)').addEventListener('change', changed);
  return button;
}
