/** Files dropped on the page are opened: models or scenes with what belongs to them, folders too; a picture becomes the environment map. */

import { h } from './dom';
import type { Message } from './protocol';

interface Dropped {
  file: File;
  path: string;
}

/** Answer of the server to the files. */
interface Answer {
  messages?: (Message | string)[];
  error?: string;
  /** A picture that is the environment map now. */
  environment?: string;
  /** Numbers of the pictures on the list. */
  added?: number[];
}

export class Drop {
  readonly hint: HTMLElement;

  /** `hint` says what may be dropped; `opened` is given the server's answer. */
  constructor(
    private readonly tell: (message: Message) => void,
    hint = 'Drop a model or a scene with what belongs to it, or an environment map',
    private readonly opened: (answer: Answer) => void = () => {},
  ) {
    this.hint = h('div', { class: 'drop', hidden: true }, hint);
    let depth = 0;
    const isFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
    const show = (on: boolean) => (this.hint.hidden = !on);
    addEventListener('dragenter', (event) => isFiles(event) && show(++depth > 0));
    addEventListener('dragleave', (event) => isFiles(event) && show(--depth > 0));
    addEventListener('dragover', (event) => isFiles(event) && event.preventDefault());
    addEventListener('drop', (event) => {
      if (!isFiles(event)) return;
      event.preventDefault();
      show((depth = 0) > 0);
      void this.open([...event.dataTransfer!.items]);
    });
  }

  private async open(items: DataTransferItem[]): Promise<void> {
    try {
      // Entries and files are gone once this function has waited.
      const entries = items.map((item) => ({ entry: item.webkitGetAsEntry(), file: item.getAsFile() }));
      const found = (
        await Promise.all(entries.map(({ entry, file }) => (entry ? filesOf(entry) : file ? [{ file, path: file.name }] : [])))
      ).flat();
      if (found.length === 0) return;
      const form = new FormData();
      for (const { file, path } of found) form.append('file', file, path);
      this.tell({ severity: 'note', text: `opening ${found.length === 1 ? found[0]!.path : `${found.length} files`}` });
      const response = await fetch('./api/open', { method: 'POST', body: form });
      const answer = (await response.json().catch(() => ({}))) as Answer;
      for (const message of answer.messages ?? []) {
        this.tell(typeof message === 'string' ? { severity: response.ok ? 'warning' : 'error', text: message } : message);
      }
      if (answer.environment) this.tell({ severity: 'note', text: `${answer.environment} is the environment map now` });
      if (response.ok) this.opened(answer);
      if (!response.ok && !answer.messages?.length) this.tell({ severity: 'error', text: answer.error ?? response.statusText });
    } catch (error) {
      this.tell({ severity: 'error', text: `not opened: ${String(error)}` });
    }
  }
}

/** All files below an entry, with their paths from what was dropped. */
async function filesOf(entry: FileSystemEntry, folder = ''): Promise<Dropped[]> {
  const path = folder + entry.name;
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [{ file, path }];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const all: Dropped[] = [];
  for (;;) {
    // A reader gives some entries at a time, and at last none.
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return all;
    for (const child of some) all.push(...(await filesOf(child, `${path}/`)));
  }
}
