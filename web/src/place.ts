/** Transforms as location, rotation and scale. */

import { cross, dot, length, scale, type Vec3 } from './vector';

/** What a transform does: first scales along the axes, then turns about x, y and z (degrees, in this order), then shifts. */
export interface Place {
  location: Vec3;
  rotation: Vec3;
  scale: Vec3;
}

/** More than this part of shear is told from rounding. */
const SHEAR = 1e-6;

/** The place of a transform in Steradian's language; `null` for what is none, or shears. */
export function placeOf(text: string): Place | null {
  if (text === 'identity') return { location: [0, 0, 0], rotation: [0, 0, 0], scale: [1, 1, 1] };
  const m = /^\{matrix: \[([^[\]]*)\]\}$/.exec(text.trim())?.[1]?.split(',').map(Number);
  if (m?.length !== 16 || !m.every(Number.isFinite) || m[12] !== 0 || m[13] !== 0 || m[14] !== 0 || m[15] !== 1) return null;
  const column = (i: number): Vec3 => [m[i]!, m[4 + i]!, m[8 + i]!];
  const axes = [column(0), column(1), column(2)] as const;
  const sizes = axes.map(length) as Vec3;
  if (sizes.some((s) => s === 0)) return null;
  // A mirror is one along x.
  if (dot(cross(axes[0], axes[1]), axes[2]) < 0) sizes[0] = -sizes[0];
  const [x, y, z] = axes.map((a, i) => scale(a, 1 / sizes[i]!)) as [Vec3, Vec3, Vec3];
  if ([dot(x, y), dot(y, z), dot(z, x)].some((d) => Math.abs(d) > SHEAR)) return null;
  // R = Rz Ry Rx; x's third component is -sin y.
  const sine = Math.max(-1, Math.min(1, -x[2]));
  const level = Math.hypot(x[0], x[1]) > 1e-9;
  const turns = level ? [Math.atan2(y[2], z[2]), Math.asin(sine), Math.atan2(x[1], x[0])] : [Math.atan2(-z[1], y[1]), Math.asin(sine), 0];
  return { location: column(3), rotation: turns.map((v) => (v * 180) / Math.PI) as Vec3, scale: sizes };
}

/** A transform in Steradian's language, and then a shift along an axis; `null` where it is not told by a matrix. */
export function shifted(text: string, axis: number, distance: number): string | null {
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const m = text === 'identity' ? identity : /^\{matrix: \[([^[\]]*)\]\}$/.exec(text.trim())?.[1]?.split(',').map(Number);
  if (m?.length !== 16 || !m.every(Number.isFinite)) return null;
  m[4 * axis + 3]! += distance;
  return `{matrix: [${m.join(', ')}]}`;
}

/** A place in Steradian's language. */
export function textOf({ location, rotation, scale: size }: Place): string {
  const [[sx, cx], [sy, cy], [sz, cz]] = rotation.map((v) => {
    const exact = [0, 1, 0, -1];
    const quarter = v / 90;
    if (Number.isInteger(quarter)) return [exact[((quarter % 4) + 4) % 4]!, exact[(((quarter + 1) % 4) + 4) % 4]!];
    return [Math.sin((v * Math.PI) / 180), Math.cos((v * Math.PI) / 180)];
  }) as [[number, number], [number, number], [number, number]];
  const rows = [
    [cy * cz, sx * sy * cz - cx * sz, cx * sy * cz + sx * sz],
    [cy * sz, sx * sy * sz + cx * cz, cx * sy * sz - sx * cz],
    [-sy, sx * cy, cx * cy],
  ];
  const matrix = rows.flatMap((row, i) => [...row.map((v, k) => v * size[k]!), location[i]!]);
  return `{matrix: [${[...matrix, 0, 0, 0, 1].join(', ')}]}`;
}
