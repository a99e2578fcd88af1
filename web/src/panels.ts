/** The panels beside the picture. */

import { Compare } from './compare';
import { h } from './dom';
import { Errors } from './errors';
import { Histogram } from './histogram';
import { Look } from './look';
import { Messages } from './messages';
import { Mixer } from './mixer';
import { Nodes } from './nodes';
import { Output } from './output';
import { CameraPanel, RenderPanel } from './panel';
import type { FrameEnd, Message, State } from './protocol';
import { keptReference } from './reference';
import type { Stage } from './stage';
import { SurroundingsPanel } from './surroundings';

export class Panels {
  readonly element: HTMLElement;
  readonly look: Look;
  readonly compare: Compare;
  readonly messages = new Messages();
  private readonly errors: Errors;
  private readonly histogram = new Histogram();
  private readonly render: RenderPanel;
  private readonly surroundings: SurroundingsPanel;
  private readonly mixer: Mixer;
  private readonly camera: CameraPanel;
  private readonly nodes: Nodes;
  private readonly output: Output;

  constructor(private readonly stage: Stage) {
    const { view, send } = stage;
    this.output = new Output(view, this.tell);
    this.compare = new Compare(view, this.tell, keptReference());
    this.errors = new Errors(view);
    this.compare.changed = () => this.errors.changeReference();
    this.look = new Look(
      view,
      (names) => send({ type: 'layers', names }),
      () => {
        this.output.update();
        this.showHistogram();
        this.compare.refresh();
      },
    );
    this.histogram.element.addEventListener('toggle', this.showHistogram);
    this.render = new RenderPanel(send);
    this.surroundings = new SurroundingsPanel(send, (text) => this.output.copy(text));
    this.mixer = new Mixer(view, send, this.showHistogram);
    this.camera = new CameraPanel(send, { from: stage.from, fly: stage.fly, fov: (degrees) => stage.moving.fov(degrees) });
    this.nodes = new Nodes(send, () => stage.selection.set(null));
    stage.overlay.gizmo.moved = (axis, distance, done) => this.nodes.shift(axis, distance, done);
    stage.selection.changed = (selected) => this.nodes.select(selected);
    this.element = h(
      'aside',
      { class: 'panel', 'aria-label': 'Panels' },
      this.look.element,
      this.compare.element,
      this.errors.element,
      this.histogram.element,
      stage.inspector.element,
      this.render.element,
      this.surroundings.element,
      this.mixer.element,
      this.camera.element,
      this.nodes.element,
      this.output.element,
      this.messages.element,
    );
    stage.themed = this.showHistogram;
    this.showHistogram();
  }

  readonly tell = (message: Message): void => this.messages.add(message);

  readonly showHistogram = (): void => this.histogram.update(() => this.stage.view.statistics(), this.stage.view.tone.exposure);

  takeState(state: State): void {
    this.look.update(state);
    this.compare.takeTones(state.choices.tones);
    this.errors.takeState(state);
    this.output.update(state);
    this.messages.scene(state.scene.messages);
  }

  takeFields(state: State, isNew: boolean): void {
    this.render.update(state);
    this.surroundings.update(state);
    this.mixer.update(state);
    this.camera.update(state);
    this.nodes.update(state, isNew);
  }

  takeFrame(frame: FrameEnd): void {
    this.look.takeFrame();
    this.mixer.takeFrame(frame);
    this.nodes.frame();
    this.surroundings.frame();
    this.compare.takeFrame(frame);
    this.errors.takeFrame(frame);
    this.showHistogram();
  }
}
