/** Panel "Scene": what is selected, the nodes by family, and their parameters to be edited. */

import { h, section, setText } from './dom';
import { split } from './first';
import { shifted } from './place';
import { kindOf, parameterField, type Field } from './parameter';
import type { NodeState, PageMessage, ParameterState, State } from './protocol';
import type { Selected } from './selection';

/** Milliseconds after which a picture that did not come is no longer waited for. */
const PATIENCE = 2000;

class ParameterRow {
  readonly element = h('div', { class: 'row parameter' });
  private field: Field | null = null;
  private readonly name: HTMLElement;
  private readonly slot = h('span', { class: 'slot' });
  private readonly reset: HTMLButtonElement;

  constructor(
    node: NodeState,
    parameter: ParameterState,
    private readonly edit: (p: string, value: string | null, done: boolean) => void,
  ) {
    const { name } = parameter;
    this.name = h(
      'span',
      { class: 'name', title: [name, parameter.doc, parameter.type].filter(Boolean).join('\n') },
      name.replaceAll('_', ' '),
    );
    const what = `What holds when ${name} is not given`;
    this.reset = h('button', { class: 'small', title: what, 'aria-label': what, onclick: () => edit(name, null, true) }, '×');
    this.label = `${node.id}: ${name}`;
    this.element.append(this.name, this.slot, this.reset);
    this.update(parameter);
  }

  private readonly label: string;

  update(parameter: ParameterState): void {
    const { name, type, doc, unit } = parameter;
    this.element.title = [doc, type].filter(Boolean).join('\n');
    this.name.classList.toggle('unset', parameter.value === null);
    this.reset.hidden = parameter.value === null;
    if (this.field?.kind === kindOf(parameter)) return this.field.set(parameter);
    this.field = parameterField(parameter, this.label, (value, done) => this.edit(name, value, done));
    this.slot.replaceChildren(this.field.element);
    this.name.querySelector('.unit')?.remove();
    // Fields of numbers have it beside them.
    if (unit && this.field.kind !== 'number') this.name.append(' ', h('span', { class: 'unit' }, unit));
  }
}

class NodeItem {
  readonly element: HTMLDetailsElement;
  private readonly title = h('span', { class: 'kind' });
  private readonly body = h('div', { class: 'body' });
  private readonly moreTitle = h('span');
  private rows: Map<string, ParameterRow> | null = null;

  constructor(
    public node: NodeState,
    private readonly edit: (node: string, p: string, value: string | null, done: boolean) => void,
  ) {
    this.element = h(
      'details',
      { class: 'node', ontoggle: () => this.element.open && this.fill() },
      h('summary', {}, h('span', { class: 'id' }, node.id), this.title),
      this.body,
    );
    this.update(node);
  }

  update(node: NodeState): void {
    this.node = node;
    setText(this.title, node.kind);
    if (this.rows) this.fill();
  }

  /** Rows are made when the node is opened first. */
  private fill(): void {
    const rows = new Map<string, ParameterRow>();
    for (const parameter of this.node.parameters) {
      const old = this.rows?.get(parameter.name);
      old?.update(parameter);
      rows.set(parameter.name, old ?? new ParameterRow(this.node, parameter, (p, value, done) => this.edit(this.node.id, p, value, done)));
    }
    const isSame = this.rows && [...rows.keys()].join() === [...this.rows.keys()].join();
    this.rows = rows;
    const [first, more] = split(this.node);
    const set = more.filter((p) => p.value !== null).length;
    setText(this.moreTitle, `more: ${more.length} parameters${set ? `, ${set} set` : ''}`);
    if (isSame) return;
    const elements = (of: ParameterState[]) => of.map((p) => rows.get(p.name)!.element);
    const folded = more.length ? [h('details', { class: 'more' }, h('summary', {}, this.moreTitle), ...elements(more))] : [];
    this.body.replaceChildren(...(rows.size ? [...elements(first), ...folded] : [h('p', { class: 'facts' }, 'nothing to set')]));
  }

  unfold(): void {
    this.element.open = true;
    this.fill();
  }
}

export class Nodes {
  readonly element: HTMLElement;
  private readonly undo = h('button', { title: 'Undo (Ctrl+Z)', onclick: () => this.send({ type: 'undo' }) }, 'Undo');
  private readonly redo = h('button', { title: 'Redo (Ctrl+Shift+Z)', onclick: () => this.send({ type: 'redo' }) }, 'Redo');
  private readonly filter = h('input', {
    type: 'search',
    placeholder: 'Filter',
    'aria-label': 'Filter the nodes',
    oninput: () => this.sift(),
  });
  private readonly chosen = h('div', { class: 'chosen', role: 'group', 'aria-label': 'Selected', hidden: true });
  private readonly list = h('div', { class: 'nodes' });
  private readonly items = new Map<string, NodeItem>();
  private nodes: NodeState[] = [];
  private selected: Selected | null = null;
  /** Whether what is selected is still to be scrolled to. */
  private reveals = false;
  /** Where the shape was that is dragged. */
  private base: string | null = null;
  private key = '';
  private wants = false;
  /** The edit of a slider that is held, until it is sent. */
  private held: PageMessage | null = null;
  private sentAt = -PATIENCE;
  /** Edits that were sent. */
  private edits = 0;

  constructor(
    private readonly send: (message: PageMessage) => boolean,
    private readonly deselect: () => void,
  ) {
    this.element = section('Scene', false, h('div', { class: 'buttons' }, this.undo, this.redo, this.filter), this.chosen, this.list);
    this.element.addEventListener('toggle', () => void this.load());
  }

  /** Something else may be in the scene now. */
  update({ undo, redo, scene }: State, connected: boolean): void {
    this.undo.disabled = undo === 0;
    this.redo.disabled = redo === 0;
    const key = `${undo} ${redo} ${scene.path} ${scene.name} ${scene.faces} ${scene.materials} ${scene.lights}`;
    if (key === this.key && !this.wants && !connected) return;
    this.key = key;
    this.wants = true;
    void this.load();
  }

  private async load(): Promise<void> {
    if (!this.wants || !(this.element as HTMLDetailsElement).open) return;
    this.wants = false;
    const { edits } = this;
    try {
      const response = await fetch('./api/nodes');
      const nodes = (await response.json()) as NodeState[];
      // Nodes without the last edit would undo it.
      if (edits !== this.edits) this.wants = true;
      else if (response.ok) this.show(nodes);
    } catch {
      this.wants = true;
    }
  }

  private show(nodes: NodeState[]): void {
    this.nodes = nodes;
    for (const node of nodes) this.items.get(node.id)?.update(node);
    this.arrange();
    this.reveal();
  }

  /** What is selected stands above the others. */
  select(selected: Selected | null): void {
    this.selected = selected;
    this.arrange();
    this.reveals = selected !== null;
    if (!selected) return;
    (this.element as HTMLDetailsElement).open = true;
    if (this.wants) void this.load();
    else this.reveal();
  }

  /** The nodes that are selected: the shape, its light and its material. */
  private chosenIds(): string[] {
    const { shape, light, material } = this.selected ?? {};
    return [shape, light, material].filter((id): id is string => typeof id === 'string' && this.items.has(id));
  }

  private reveal(): void {
    if (!this.reveals || this.wants || this.chosen.hidden) return;
    this.reveals = false;
    this.items.get(this.chosenIds().at(-1)!)?.unfold();
    this.chosen.scrollIntoView({ block: 'start' });
  }

  private arrange(): void {
    const old = new Map(this.items);
    this.items.clear();
    for (const node of this.nodes) this.items.set(node.id, old.get(node.id) ?? new NodeItem(node, (...edit) => this.edit(...edit)));
    const chosen = this.chosenIds();
    const shape = JSON.stringify([chosen, this.nodes.map((n) => [n.family, n.id])]);
    if (this.list.dataset.shape === shape) return;
    this.list.dataset.shape = shape;
    const families = new Map<string, NodeState[]>();
    for (const node of this.nodes.filter((n) => !chosen.includes(n.id)))
      families.set(node.family, [...(families.get(node.family) ?? []), node]);
    const folds = new Map([...this.list.querySelectorAll<HTMLDetailsElement>('.family')].map((f) => [f.dataset.family, f.open]));
    this.list.replaceChildren(
      ...[...families].map(([family, members]) =>
        h(
          'details',
          { class: 'family', 'data-family': family, open: folds.get(family) ?? members.length <= 12 },
          h('summary', {}, h('h3', {}, family), h('span', { class: 'kind' }, String(members.length))),
          ...members.map((n) => this.items.get(n.id)!.element),
        ),
      ),
    );
    this.choose(chosen);
    this.sift();
  }

  private choose(chosen: string[]): void {
    this.chosen.hidden = chosen.length === 0;
    const what = 'Select nothing (Escape)';
    const close = h('button', { class: 'small', title: what, 'aria-label': what, onclick: () => this.deselect() }, '×');
    const head = h('div', { class: 'pin-head' }, h('strong', {}, `Selected: ${chosen[0] ?? ''}`), close);
    this.chosen.replaceChildren(...(chosen.length ? [head, ...chosen.map((id) => this.items.get(id)!.element)] : []));
  }

  /** Moves the selected shape along an axis, by a distance from where it was before this began. */
  shift(axis: number, distance: number, done: boolean): void {
    const shape = this.selected?.shape;
    if (shape === undefined) return;
    // The place may have changed while the section was folded.
    if (this.wants && this.base === null) (this.element as HTMLDetailsElement).open = true;
    else this.base ??= this.nodes.find((n) => n.id === shape)?.parameters.find((p) => p.name === 'to_world')?.value ?? 'identity';
    const value = this.base === null ? null : shifted(this.base, axis, distance);
    if (done) this.base = null;
    if (value !== null) this.edit(shape, 'to_world', value, done);
  }

  /** Sends an edit; while a slider is held only when the picture of the last one came. */
  private edit(node: string, parameter: string, value: string | null, done: boolean): void {
    if (!done) {
      this.held = { type: 'edit', node, parameter, value, moving: true };
      this.sendHeld();
      return;
    }
    this.held = null;
    this.wants = true;
    this.edits++;
    this.send({ type: 'edit', node, parameter, value, moving: false });
  }

  private sendHeld(): void {
    if (this.held === null || performance.now() - this.sentAt < PATIENCE) return;
    this.edits++;
    this.send(this.held);
    this.held = null;
    this.sentAt = performance.now();
  }

  /** A picture came. */
  frame(): void {
    this.sentAt = -PATIENCE;
    this.sendHeld();
  }

  /** Shows the nodes whose id or kind has the filter's text. */
  private sift(): void {
    const text = this.filter.value.trim().toLowerCase();
    const chosen = this.chosenIds();
    for (const { element, node } of this.items.values())
      element.hidden = text !== '' && !chosen.includes(node.id) && !`${node.id} ${node.kind}`.toLowerCase().includes(text);
    for (const family of this.list.children) {
      family.toggleAttribute('hidden', ![...family.querySelectorAll<HTMLElement>('.node')].some((n) => !n.hidden));
    }
  }
}
