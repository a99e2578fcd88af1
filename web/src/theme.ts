/** Dark or light: as the system has it, or as chosen. */

import { h } from './dom';

const THEMES = ['auto', 'dark', 'light'] as const;
const KEY = 'steradian-theme';

export function themeButton(changed: () => void): HTMLButtonElement {
  let theme: (typeof THEMES)[number] = THEMES.find((t) => t === stored()) ?? 'auto';
  const light = matchMedia('(prefers-color-scheme: light)');
  const button = h('button', { onclick: () => set(THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length]!) });
  function set(to: (typeof THEMES)[number]): void {
    theme = to;
    store(to);
    apply();
    button.textContent = { auto: '◐', dark: '●', light: '○' }[to];
    button.title = `Theme: ${to}`;
    button.setAttribute('aria-label', button.title);
  }
  function apply(): void {
    document.documentElement.dataset.theme = theme === 'auto' ? (light.matches ? 'light' : 'dark') : theme;
    changed();
  }
  set(theme);
  light.addEventListener('change', apply);
  return button;
}

/** Storage that the browser may refuse. */
function stored(): string | null {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}

function store(theme: string): void {
  try {
    localStorage.setItem(KEY, theme);
  } catch {
    // The choice holds until the page is left.
  }
}
