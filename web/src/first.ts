/** The parameters of materials that matter first. */

import type { NodeState, ParameterState } from './protocol';

const FIRST = new Set([
  ...['base_color', 'color', 'reflectance', 'diffuse_reflectance', 'specular_reflectance', 'albedo', 'transmittance'],
  ...['roughness', 'specular_roughness', 'alpha', 'alpha_u', 'alpha_v', 'exponent', 'beta_m', 'beta_n'],
  ...['metallic', 'base_metalness', 'eta', 'k', 'specular_ior', 'index', 'emission', 'opacity', 'geometry_opacity'],
  ...['file', 'material', 'front', 'back', 'amount'],
]);

/** Those that are shown at once, and those that are folded; of nodes of other families, and where none matters first, all are shown. */
export function split({ family, parameters }: NodeState): [ParameterState[], ParameterState[]] {
  const first = parameters.filter((p) => FIRST.has(p.name));
  if (family !== 'material' || first.length === 0) return [parameters, []];
  return [first, parameters.filter((p) => !FIRST.has(p.name))];
}
