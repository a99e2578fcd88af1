/** A picture to look at: balls on a checkered floor under a sun. */

type Vec = [number, number, number];
const dot = (a: Vec, b: Vec) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a: Vec): Vec => a.map((v) => v / Math.sqrt(dot(a, a))) as Vec;
const BALLS: [Vec, number, Vec][] = [
  [[-1.1, 1, 0], 1, [0.7, 0.12, 0.08]],
  [[1.1, 0.8, 0.5], 0.8, [0.1, 0.3, 0.7]],
  [[0.2, 0.4, 1.5], 0.4, [0.7, 0.6, 0.2]],
];
const SUN = unit([0.5, 0.8, 0.45]);

function hit(origin: Vec, way: Vec): { at: Vec; normal: Vec; color: Vec } | null {
  let [nearest, found] = [Infinity, null as { at: Vec; normal: Vec; color: Vec } | null];
  const point = (t: number) => origin.map((o, i) => o + t * way[i]!) as Vec;
  if (way[1] < 0) {
    nearest = -origin[1] / way[1];
    const at = point(nearest);
    const dark = (Math.floor(at[0]) + Math.floor(at[2])) % 2 === 0;
    found = { at, normal: [0, 1, 0], color: dark ? [0.25, 0.25, 0.25] : [0.6, 0.6, 0.6] };
  }
  for (const [center, radius, color] of BALLS) {
    const off = origin.map((o, i) => o - center[i]!) as Vec;
    const b = dot(off, way);
    const d = b * b - dot(off, off) + radius * radius;
    const t = -b - Math.sqrt(Math.max(d, 0));
    if (d > 0 && t > 1e-3 && t < nearest) {
      const at = point((nearest = t));
      found = { at, normal: unit(at.map((v, i) => v - center[i]!) as Vec), color };
    }
  }
  return found;
}

/** Radiance at a pixel. */
export function balls(x: number, y: number, width: number, height: number): Vec {
  const way = unit([(2 * x - width) / height, (height - 2 * y) / height - 0.25, -2.2]);
  const eye: Vec = [0, 2.2, 6.5];
  const found = hit(eye, way);
  if (!found) return [0.35 + 0.3 * way[1], 0.55 + 0.3 * way[1], 0.9];
  const { at, normal, color } = found;
  const sun = hit(at.map((v, i) => v + 1e-3 * normal[i]!) as Vec, SUN) ? 0 : Math.max(dot(normal, SUN), 0) * 2.4;
  const mirror = way.map((v, i) => v - 2 * dot(way, normal) * normal[i]!) as Vec;
  const shine = sun > 0 && normal[1] < 1 ? 30 * Math.max(dot(mirror, SUN), 0) ** 400 : 0;
  return color.map((c, i) => c * (sun + [0.2, 0.25, 0.35][i]!) + shine) as Vec;
}
