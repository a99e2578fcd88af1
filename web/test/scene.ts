/** The mock's scene. */

import type { NodeState, ParameterState, State } from '../src/protocol';

const named = (...names: string[]) => names.map((name) => ({ name, doc: `what ${name} is` }));
const gamma = { name: 'gamma', doc: 'exponent γ of the display', default: 2.2, range: [0.1, 10] as [number, number] };
const max = { name: 'max', doc: 'radiance that becomes 1', default: 1, range: [1e-9, 1e9] as [number, number] };
const white = { name: 'white', doc: 'luminance that becomes 1', default: 4, range: [1e-3, 1e9] as [number, number] };

export function firstState(): State {
  const tone = (name: string, ...parameters: State['choices']['tones'][number]['parameters']) => ({
    name,
    doc: `the curve ${name}`,
    encoding: 'sRGB',
    parameters,
  });
  return {
    generation: 1,
    scene: {
      name: 'spheres',
      path: '/scenes/spheres.steradian',
      faces: 12480,
      lights: 3,
      materials: 4,
      messages: [{ severity: 'warning', text: "material 'red glass': 'eta' is 9, held at 4" }],
    },
    film: { width: 96, height: 64 },
    region: null,
    camera: {
      name: 'main',
      names: ['main', 'side'],
      kind: 'perspective',
      eye: [0, 1, 5],
      target: [0, 1, 0],
      up: [0, 1, 0],
      fov: 40,
      handedness: 1,
      moved: false,
      movable: true,
      id: 'main',
      unit: 1,
      lens: 0.1,
    },
    settings: {
      integrator: 'path',
      spp: 256,
      sampler: 'zsobol',
      color: 'auto',
      seed: 0,
      maxDepth: null,
      denoise: null,
      lightGroups: false,
    },
    choices: {
      integrators: named('path', 'direct', 'raster', 'bdpt', 'ao'),
      samplers: named('zsobol', 'independent', 'halton'),
      denoisers: named('nlm', 'atrous', 'oidn'),
      colors: ['auto', 'rgb', 'spectral'],
      tones: [
        tone('none'),
        tone('clamp', max),
        tone('equalize'),
        tone('gamma', gamma),
        tone('clamp-gamma', gamma, max),
        tone('equalize-gamma', gamma),
        tone('reinhard', white),
        tone('aces-fit'),
        tone('agx'),
        tone('pbr-neutral'),
        tone('hable', { ...white, default: 11.2, range: [0.1, 1e4] }),
      ],
      layers: named('albedo', 'depth'),
    },
    layers: [],
    tone: 'none',
    exposure: 'given',
    surroundings: null,
    paused: false,
    undo: 0,
    redo: 0,
    saveName: 'spheres-edited.steradian',
    command: 'steradian render /scenes/spheres.steradian --spp 256 --size 96x64 -o picture.exr',
  };
}

function parameter(name: string, type: string, value: string | null, more: Partial<ParameterState> = {}): ParameterState {
  return { name, value, default: '', type, unit: '', range: null, doc: `what ${name} is`, words: [], ...more };
}

export function firstNodes(): NodeState[] {
  return [
    {
      id: 'red glass',
      family: 'material',
      kind: 'dielectric',
      parameters: [
        parameter('eta', 'number or spectrum', '1.5', { range: [1, 4], default: '1.5' }),
        parameter('alpha', 'number or texture', null, { range: [0, 1], default: '0' }),
        parameter('grey', 'number or spectrum, 0 to 1', '0.5', { range: [0, 1], default: '0.5' }),
        parameter('tint', 'number, spectrum or texture', '[0.8, 0.2, 0.1]', { range: [0, 1], default: '1' }),
        parameter('thin', 'true or false', null, { default: 'false' }),
        parameter('distribution', 'ggx, beckmann', 'ggx', { words: ['ggx', 'beckmann'], default: 'ggx' }),
      ],
    },
    {
      id: 'floor',
      family: 'material',
      kind: 'diffuse',
      parameters: [parameter('reflectance', 'number, spectrum or texture', '{texture: checker}', { default: '0.5' })],
    },
    {
      id: 'lamp',
      family: 'light',
      kind: 'area',
      parameters: [parameter('radiance', 'number or spectrum', '120', { range: [0, null], unit: 'W/(m² sr nm)', default: '1' })],
    },
    {
      id: 'sphere 2',
      family: 'shape',
      kind: 'sphere',
      parameters: [
        parameter('center', 'three numbers', '[0, 1, 0]'),
        parameter('radius', 'number', '1', { range: [0, 1e9], unit: 'm' }),
        parameter('to_world', 'transform', '{matrix: [0.0, -2.0, 0.0, 1.5, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, -3.0, 0.0, 0.0, 0.0, 1.0]}'),
      ],
    },
  ];
}
