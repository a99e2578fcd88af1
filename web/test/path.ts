/** The mock server's paths: from the pixel to the middle of the left edge, through fog, and out at the right. */

import type { PathVertex, State, TracedPath } from '../src/protocol';

const vertex = (more: Partial<PathVertex>): PathVertex => ({
  kind: 'surface',
  position: [0, 0, 0],
  normal: null,
  object: null,
  material: null,
  place: null,
  onwards: null,
  weight: [1, 1, 1],
  emitted: [0, 0, 0],
  direct: null,
  event: null,
  ...more,
});

/** What is answered about a sample of a pixel. */
export function pathOf(state: State, query: URLSearchParams): TracedPath | { error: string } {
  const [x, y, sample] = ['x', 'y', 'sample'].map((name) => Number(query.get(name))) as [number, number, number];
  const { film, generation, settings } = state;
  if (sample >= 1 << 24) return { error: `samples are whole numbers from 0 to 16777215, not ${sample}` };
  const lamp = { position: [0, 1, 0] as [number, number, number], onwards: null };
  const vertices = [
    vertex({ kind: 'camera' }),
    vertex({
      place: [x + 0.25, y + 0.75],
      onwards: [-1, 0],
      object: 'sphere 2',
      material: 'red glass',
      event: 'specular transmission',
      normal: [0, 0, 1],
    }),
    vertex({
      kind: 'medium',
      place: [0, film.height / 2],
      onwards: [1, 0],
      event: 'phase function',
      weight: [0.5, 0.25, 0.125],
      direct: { ...lamp, place: [film.width / 2, 0], light: [0.5, 0.25, 0.125] },
    }),
    vertex({
      place: [film.width - 1, film.height / 2 + sample],
      onwards: [0, -1],
      object: 'wall',
      event: 'diffuse reflection',
      weight: [0.25, 0.25, 0.25],
      direct: { ...lamp, place: [film.width / 2, 0], light: [0, 0, 0] },
    }),
    vertex({ kind: 'escaped', weight: [0.25, 0.25, 0.25], emitted: [0.25, 0.5, 0.75] }),
  ];
  const of_picture = /^(vol)?path/.test(settings.integrator);
  return { x, y, sample, generation, tracer: 'path', of_picture, value: [0.75, 0.75, 0.875], end: 'escaped', vertices };
}
