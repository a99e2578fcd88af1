//! A relief of heights over the unit square, and the exact place where a ray first meets it.

use steradian_math::{Vec2, Vec3};

/// Heights on a grid, bilinear between the samples, which reach from edge to edge of the unit square.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    /// Samples along u; at least two.
    width: usize,
    /// Samples along v; at least two.
    height: usize,
    /// Row by row; finite.
    data: Box<[f32]>,
    max: f32,
}

/// A ray in the space of the relief: x along u, y along v, z up. Its parameter is in units of the direction.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Origin of the line.
    pub origin: Vec3,
    /// Direction of the line.
    pub direction: Vec3,
}

impl Line {
    /// A point of it.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

impl HeightField {
    /// A relief; `None` for fewer than 2 × 2 samples, a wrong count, or a height that is not finite.
    pub fn new(width: usize, height: usize, data: Vec<f32>) -> Option<Self> {
        let fits = width >= 2 && height >= 2 && width.checked_mul(height) == Some(data.len());
        if !fits || !data.iter().all(|h| h.is_finite()) {
            return None;
        }
        let max = data.iter().copied().fold(f32::MIN, f32::max);
        Some(Self { width, height, data: data.into(), max })
    }

    /// Samples of a function.
    pub fn sampled(width: usize, height: usize, f: impl Fn(Vec2) -> f32) -> Option<Self> {
        let step = |i: usize, n: usize| i as f32 / n.saturating_sub(1).max(1) as f32;
        let samples = (0..height).flat_map(|j| (0..width).map(move |i| (i, j)));
        Self::new(width, height, samples.map(|(i, j)| f(Vec2::new(step(i, width), step(j, height)))).collect())
    }

    /// Cells along u and v.
    pub fn cells(&self) -> (usize, usize) {
        (self.width - 1, self.height - 1)
    }

    /// The largest height.
    pub fn max(&self) -> f32 {
        self.max
    }

    /// The smallest height.
    pub(super) fn data_min(&self) -> f32 {
        self.data.iter().copied().fold(f32::MAX, f32::min)
    }

    /// A sample; `i` along u, `j` along v.
    pub(crate) fn sample(&self, i: usize, j: usize) -> f32 {
        self.data[j * self.width + i]
    }

    /// Heights at the corners of a cell: (0, 0), (1, 0), (0, 1), (1, 1).
    pub(crate) fn corners(&self, i: usize, j: usize) -> [f32; 4] {
        [self.sample(i, j), self.sample(i + 1, j), self.sample(i, j + 1), self.sample(i + 1, j + 1)]
    }

    /// Heights at the corners of the cell that a place lies in.
    pub(crate) fn corners_at(&self, uv: Vec2) -> [f32; 4] {
        let (i, j) = self.cell(uv);
        self.corners(i, j)
    }

    /// The largest height of a cell.
    pub(super) fn cell_max(&self, i: usize, j: usize) -> f32 {
        self.corners(i, j).into_iter().fold(f32::MIN, f32::max)
    }

    /// The cell that a place lies in.
    pub(crate) fn cell(&self, uv: Vec2) -> (usize, usize) {
        let (w, h) = self.cells();
        let index = |x: f32, n: usize| ((x * n as f32).floor().max(0.0) as usize).min(n - 1);
        (index(uv.x, w), index(uv.y, h))
    }

    /// The height at a place; that of the edge beyond it.
    pub fn at(&self, uv: Vec2) -> f32 {
        let uv = uv.clamp(Vec2::ZERO, Vec2::ONE);
        let (w, h) = self.cells();
        let (i, j) = self.cell(uv);
        let (s, t) = (uv.x * w as f32 - i as f32, uv.y * h as f32 - j as f32);
        let [a, b, c, d] = self.corners(i, j);
        (a * (1.0 - s) + b * s) * (1.0 - t) + (c * (1.0 - s) + d * s) * t
    }

    /// The derivatives of the height along u and v at a place.
    pub fn slope(&self, uv: Vec2) -> Vec2 {
        let uv = uv.clamp(Vec2::ZERO, Vec2::ONE);
        let (w, h) = self.cells();
        let (i, j) = self.cell(uv);
        let (s, t) = (uv.x * w as f32 - i as f32, uv.y * h as f32 - j as f32);
        let [a, b, c, d] = self.corners(i, j);
        let du = ((b - a) * (1.0 - t) + (d - c) * t) * w as f32;
        let dv = ((c - a) * (1.0 - s) + (d - b) * s) * h as f32;
        Vec2::new(du, dv)
    }

    /// The unit normal at a place.
    pub fn normal(&self, uv: Vec2) -> Vec3 {
        (-self.slope(uv)).extend(1.0).normalize_or(Vec3::Z)
    }

    /// The derivatives at a sample: differences over both its neighbours, at the rim over one.
    pub(crate) fn vertex_slope(&self, i: usize, j: usize) -> Vec2 {
        let (w, h) = self.cells();
        let (i0, i1, j0, j1) = (i.saturating_sub(1), (i + 1).min(w), j.saturating_sub(1), (j + 1).min(h));
        let du = (self.sample(i1, j) - self.sample(i0, j)) * w as f32 / (i1 - i0) as f32;
        let dv = (self.sample(i, j1) - self.sample(i, j0)) * h as f32 / (j1 - j0) as f32;
        Vec2::new(du, dv)
    }

    /// The part of a line over the unit square and not above the relief's top; `None` where there is none.
    pub fn span(&self, line: &Line) -> Option<(f32, f32)> {
        let (mut near, mut far) = (0.0_f32, f32::INFINITY);
        let (o, d) = (line.origin, line.direction);
        let slabs = [(o.x, d.x, 0.0, 1.0), (o.y, d.y, 0.0, 1.0), (o.z, d.z, f32::NEG_INFINITY, self.max)];
        for (o, d, low, high) in slabs {
            if d == 0.0 {
                if o < low || o > high {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - o) / d, (high - o) / d);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        // A ray straight down leaves through the lowest height at the latest.
        if far == f32::INFINITY {
            far = ((self.data_min() - o.z) / d.z + near) * 1.001 + 1e-6;
        }
        (near <= far && near.is_finite() && far.is_finite()).then_some((near, far))
    }

    /// First intersection of a line with the relief from above: cell by cell, in each the smaller root of a quadratic.
    pub fn first_hit(&self, line: &Line) -> Option<f32> {
        let (near, far) = self.span(line)?;
        let mut t = near;
        let (w, h) = self.cells();
        // No line crosses more cells.
        for _ in 0..=2 * (w + h) {
            let (cell, exit) = self.cell_exit(line, t);
            let exit = exit.min(far);
            if let Some(hit) = self.hit_in_cell(line, cell, t, exit) {
                return Some(hit);
            }
            if exit >= far {
                return None;
            }
            t = exit;
        }
        None
    }

    /// The cell at `t` that the line goes on into, and where it leaves it.
    pub(super) fn cell_exit(&self, line: &Line, t: f32) -> ((usize, usize), f32) {
        let (w, h) = self.cells();
        let p = line.at(t);
        let axis = |p: f32, d: f32, n: usize| -> (usize, f32) {
            let x = p * n as f32;
            // On a border, the cell ahead.
            let near_border = (x - x.round()).abs() < 1e-4;
            let i = if near_border && d < 0.0 {
                x.round() - 1.0
            } else if near_border {
                x.round()
            } else {
                x.floor()
            };
            let i = i.clamp(0.0, n as f32 - 1.0);
            let border = if d > 0.0 { i + 1.0 } else { i };
            let exit = if d == 0.0 { f32::INFINITY } else { (border - x) / (d * n as f32) };
            (i as usize, exit)
        };
        let (i, a) = axis(p.x, line.direction.x, w);
        let (j, b) = axis(p.y, line.direction.y, h);
        ((i, j), t + a.min(b).max(0.0))
    }

    /// The first meeting within a cell, from above, between two parameters.
    pub(super) fn hit_in_cell(&self, line: &Line, (i, j): (usize, usize), t0: f32, t1: f32) -> Option<f32> {
        let (w, h) = self.cells();
        let [a, b, c, d] = self.corners(i, j).map(f64::from);
        let (o, v) = (line.origin.as_dvec3(), line.direction.as_dvec3());
        // In the cell's coordinates: s = s0 + s1 t, q = q0 + q1 t, height a + (b − a)s + (c − a)q + (a − b − c + d)sq.
        let (s0, s1) = (o.x * w as f64 - i as f64, v.x * w as f64);
        let (q0, q1) = (o.y * h as f64 - j as f64, v.y * h as f64);
        let (kb, kc, kd) = (b - a, c - a, a - b - c + d);
        let c2 = kd * s1 * q1;
        let c1 = kb * s1 + kc * q1 + kd * (s0 * q1 + s1 * q0) - v.z;
        let c0 = a + kb * s0 + kc * q0 + kd * s0 * q0 - o.z;
        // Depth below the relief: c0 + c1 t + c2 t².
        let depth = |t: f64| c0 + t * (c1 + t * c2);
        let (t0, t1) = (f64::from(t0), f64::from(t1));
        let scale = (1e-6 * (a.abs() + b.abs() + c.abs() + d.abs())).max(1e-9);
        if depth(t0) > scale {
            return None;
        }
        let mut roots = [f64::INFINITY; 2];
        if c2.abs() < 1e-12 * (c1.abs() + c2.abs()) || c2 == 0.0 {
            if c1 != 0.0 {
                roots[0] = -c0 / c1;
            }
        } else {
            let disc = c1 * c1 - 4.0 * c2 * c0;
            if disc < 0.0 {
                return None;
            }
            let q = -0.5 * (c1 + disc.sqrt().copysign(c1));
            roots = [q / c2, if q != 0.0 { c0 / q } else { f64::INFINITY }];
            roots.sort_by(f64::total_cmp);
        }
        let slack = 1e-6 * (1.0 + t1.abs());
        // Downwards through the surface: the depth grows.
        let entering = |t: f64| c1 + 2.0 * c2 * t >= 0.0;
        roots.into_iter().find(|&t| t >= t0 - slack && t <= t1 + slack && entering(t)).map(|t| t as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn bumps(n: usize) -> HeightField {
        HeightField::sampled(n, n, |p| 0.1 * (9.0 * p.x).sin() * (7.0 * p.y).cos()).unwrap()
    }

    pub fn random_line(rng: &mut HashRng) -> Line {
        let mut u = || rng.next_f32();
        let (from, to) = (Vec3::new(u(), u(), 0.12 + 0.2 * u()), Vec3::new(u(), u(), -0.1));
        Line { origin: from, direction: to - from }
    }

    #[test]
    fn heights_and_normals_of_planes_are_exact() {
        let f = HeightField::sampled(5, 3, |p| 0.5 * p.x - 0.25 * p.y).unwrap();
        let uv = Vec2::new(0.37, 0.81);
        assert!((f.at(uv) - (0.185 - 0.2025)).abs() < 1e-6);
        assert!((f.normal(uv) - Vec3::new(-0.5, 0.25, 1.0).normalize()).length() < 1e-6);
        // z = 0.5 x − 0.25 y along (0.2, 0.4, 1) − t (0, 0, 1).
        let line = Line { origin: Vec3::new(0.2, 0.4, 1.0), direction: -Vec3::Z };
        assert!((f.first_hit(&line).unwrap() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_first_hit_is_that_of_a_fine_march() {
        let field = bumps(17);
        let mut rng = HashRng::new(3);
        let mut hits = 0;
        for _ in 0..500 {
            let line = random_line(&mut rng);
            let fine = 20_000;
            let below = |i: i32| {
                let p = line.at(i as f32 / fine as f32);
                p.z < field.at(p.truncate())
            };
            let marched = (0..=fine).find(|&i| below(i)).map(|i| i as f32 / fine as f32);
            match (field.first_hit(&line), marched) {
                (Some(a), Some(b)) => {
                    assert!((a - b).abs() < 2e-4, "{a} {b}");
                    hits += 1;
                }
                (None, None) => {}
                (a, b) => panic!("{a:?} {b:?} {line:?}"),
            }
        }
        assert!(hits > 400);
    }

    #[test]
    fn misses_and_faults() {
        let field = bumps(8);
        assert_eq!(field.first_hit(&Line { origin: Vec3::new(0.5, 0.5, 1.0), direction: Vec3::Z }), None);
        assert_eq!(field.first_hit(&Line { origin: Vec3::new(2.0, 0.5, 1.0), direction: -Vec3::Z }), None);
        assert_eq!(field.first_hit(&Line { origin: Vec3::ONE, direction: Vec3::ZERO }), None);
        assert_eq!(field.first_hit(&Line { origin: Vec3::NAN, direction: Vec3::X }), None);
        assert!(HeightField::new(1, 5, vec![0.0; 5]).is_none() && HeightField::new(2, 2, vec![f32::NAN; 4]).is_none());
        assert!(HeightField::new(2, 2, vec![0.0; 3]).is_none());
    }
}
