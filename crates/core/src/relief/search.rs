//! Searches for the first meeting of a ray with a relief, from plain marches to maps that are made beforehand. Each
//! gives the parameter of the line, `None` for a miss. [`HeightField::first_hit`] is what they approximate.
//!
//! After Szirmay-Kalos, Umenhoffer, "Displacement Mapping on the GPU — State of the Art", Computer Graphics Forum 27
//! (2008).

use super::field::{HeightField, Line};
use steradian_math::{Vec2, Vec3};

/// Height of a point above the relief.
fn above(field: &HeightField, p: Vec3) -> f32 {
    p.z - field.at(p.truncate())
}

/// Constant steps until one is below the relief: the interval of the last one. Features thinner than a step are stepped
/// over.
pub fn linear(field: &HeightField, line: &Line, steps: u32) -> Option<(f32, f32)> {
    let (near, far) = field.span(line)?;
    let mut before = near;
    for i in 1..=steps {
        let t = near + (far - near) * i as f32 / steps as f32;
        if above(field, line.at(t)) < 0.0 {
            return Some((before, t));
        }
        before = t;
    }
    None
}

/// Halves an interval whose ends are above and below: converges to a meeting, the first only if there is no other in
/// it.
pub fn binary(field: &HeightField, line: &Line, (mut a, mut b): (f32, f32), steps: u32) -> f32 {
    for _ in 0..steps {
        let m = 0.5 * (a + b);
        if above(field, line.at(m)) < 0.0 {
            b = m;
        } else {
            a = m;
        }
    }
    0.5 * (a + b)
}

/// The secant method, holding an end above and one below: `t = (t_b Δ_a − t_a Δ_b)/(Δ_a − Δ_b)` with the heights Δ over
/// the relief at the ends. (The lecture's formula has the weights the other way round: E20.)
pub fn secant(field: &HeightField, line: &Line, (mut a, mut b): (f32, f32), steps: u32) -> f32 {
    let (mut da, mut db) = (above(field, line.at(a)), above(field, line.at(b)));
    let mut t = b;
    for _ in 0..steps {
        if da == db {
            break;
        }
        t = (b * da - a * db) / (da - db);
        let d = above(field, line.at(t));
        if d < 0.0 {
            (b, db) = (t, d);
        } else {
            (a, da) = (t, d);
        }
    }
    t
}

/// For each cell the widest cone that stands on its highest point and is free of relief: radius over height (Dummer,
/// "Cone Step Mapping", 2006).
#[derive(Clone, Debug)]
pub struct ConeMap {
    ratios: Box<[f32]>,
    /// True if cones may reach into the relief, but not through it.
    relaxed: bool,
}

/// Cones wider than this bring nothing.
const WIDEST: f32 = 8.0;

impl ConeMap {
    /// Free cones. Between cells the distance of their borders counts, so that no ray in a cone can meet anything: the
    /// guarantee that a cone at the middle of a texel does not give.
    pub fn new(field: &HeightField) -> Self {
        let (w, h) = field.cells();
        let gap = |a: usize, b: usize, n: usize| (a.abs_diff(b).saturating_sub(1)) as f32 / n as f32;
        let mut ratios = Vec::with_capacity(w * h);
        for (i, j) in (0..h).flat_map(|j| (0..w).map(move |i| (i, j))) {
            let own = field.cell_max(i, j);
            let mut best = WIDEST;
            for (k, l) in (0..h).flat_map(|l| (0..w).map(move |k| (k, l))) {
                let rise = field.cell_max(k, l) - own;
                if rise > 0.0 {
                    let distance = Vec2::new(gap(i, k, w), gap(j, l, h)).length();
                    best = best.min(distance / rise);
                }
            }
            ratios.push(best);
        }
        Self { ratios: ratios.into(), relaxed: false }
    }

    /// Cones that no ray from the top of the relief can leave again after having met it within the cone (Policarpo,
    /// Oliveira, "Relaxed Cone Stepping for Relief Mapping", GPU Gems 3, 2007): wider, but a search must follow.
    pub fn relaxed(field: &HeightField) -> Self {
        let (w, h) = field.cells();
        let middle = |i: usize, j: usize| Vec2::new((i as f32 + 0.5) / w as f32, (j as f32 + 0.5) / h as f32);
        let step = 0.5 / w.max(h) as f32;
        let mut ratios = Vec::with_capacity(w * h);
        for (i, j) in (0..h).flat_map(|j| (0..w).map(move |i| (i, j))) {
            let foot = middle(i, j);
            let own = field.at(foot);
            let mut best = WIDEST;
            for (k, l) in (0..h).flat_map(|l| (0..w).map(move |k| (k, l))) {
                let goal = middle(k, l);
                let reach = goal - foot;
                let length = reach.length();
                let goal = goal.extend(field.at(goal));
                if goal.z <= own || length == 0.0 {
                    continue;
                }
                // On along the ray from the top over the foot, until it comes out of the relief.
                let d = (goal - foot.extend(field.max())) * (step / length);
                let mut p = goal;
                let mut is_out = false;
                while p.z > own && p.truncate().cmpge(Vec2::ZERO).all() && p.truncate().cmple(Vec2::ONE).all() {
                    p += d;
                    if above(field, p) > 0.0 {
                        is_out = true;
                        break;
                    }
                }
                if is_out && p.z > own {
                    best = best.min((p.truncate() - foot).length() / (p.z - own));
                }
            }
            ratios.push(best);
        }
        Self { ratios: ratios.into(), relaxed: true }
    }

    fn ratio(&self, field: &HeightField, (i, j): (usize, usize)) -> f32 {
        self.ratios[j * field.cells().0 + i]
    }

    /// Mean ratio of the cones: radius over height.
    pub fn mean_ratio(&self) -> f32 {
        self.ratios.iter().sum::<f32>() / self.ratios.len() as f32
    }

    /// Steps from cone to cone, at most `steps`; gives the parameter and how many steps it took.
    ///
    /// Free cones are followed to the surface, cell by cell where they are too narrow to step over one: the first
    /// meeting is found. Relaxed cones lead to just behind it, and a binary search back.
    pub fn trace(&self, field: &HeightField, line: &Line, steps: u32) -> Option<(f32, u32)> {
        let (near, far) = field.span(line)?;
        let flat = line.direction.truncate().length();
        let mut t = near;
        let mut before = near;
        for n in 1..=steps {
            let p = line.at(t);
            let (cell, exit) = field.cell_exit(line, t);
            let ratio = self.ratio(field, cell);
            let over = p.z - if self.relaxed { field.at(p.truncate()) } else { field.cell_max(cell.0, cell.1) };
            // Where the line leaves the cone: flat·s = ratio (over + d_z s).
            let closing = flat - ratio * line.direction.z;
            let cone = if over > 0.0 && closing > 0.0 { ratio * over / closing } else { 0.0 };
            if self.relaxed {
                if over < 0.0 {
                    return Some((binary(field, line, (before, t), 16), n));
                }
                before = t;
                // Steps of at least a quarter of a cell, where a cone is a needle.
                t += cone.max(0.25 * (exit - t)).max(1e-6 * (far - near));
            } else if t + cone > exit {
                t += cone;
            } else {
                if let Some(hit) = field.hit_in_cell(line, cell, t, exit.min(far)) {
                    return Some((hit, n));
                }
                t = exit.max(t + 1e-7 * (far - near));
            }
            if t >= far {
                let end = self.relaxed && above(field, line.at(far)) < 0.0;
                return end.then(|| (binary(field, line, (before, far), 16), n));
            }
        }
        None
    }
}

/// Distances to the relief on a grid of layers above it.
#[derive(Clone, Debug)]
pub struct DistanceField {
    size: usize,
    layers: usize,
    low: f32,
    high: f32,
    data: Box<[f32]>,
}

impl DistanceField {
    /// The distance of each of `size` × `size` × `layers` points to the nearest sample of the relief, zero below it.
    pub fn new(field: &HeightField, size: usize, layers: usize) -> Self {
        let (size, layers) = (size.clamp(2, 256), layers.clamp(2, 256));
        let high = field.max();
        let low = field.data_min();
        let samples: Vec<Vec3> = {
            let (w, h) = field.cells();
            let n = (2 * w + 1, 2 * h + 1);
            let at = |i: usize, n: usize| i as f32 / (n - 1) as f32;
            (0..n.1)
                .flat_map(|j| (0..n.0).map(move |i| Vec2::new(at(i, n.0), at(j, n.1))))
                .map(|uv| uv.extend(field.at(uv)))
                .collect()
        };
        let mut data = Vec::with_capacity(size * size * layers);
        for k in 0..layers {
            for j in 0..size {
                for i in 0..size {
                    let z = low + (high - low) * k as f32 / (layers - 1) as f32;
                    let p = Vec3::new(i as f32 / (size - 1) as f32, j as f32 / (size - 1) as f32, z);
                    let nearest = samples.iter().map(|s| (*s - p).length_squared()).fold(f32::MAX, f32::min);
                    data.push(if above(field, p) > 0.0 { nearest.sqrt() } else { 0.0 });
                }
            }
        }
        Self { size, layers, low, high, data: data.into() }
    }

    fn at(&self, p: Vec3) -> f32 {
        let n = self.size - 1;
        let z = if self.high > self.low { (p.z - self.low) / (self.high - self.low) } else { 0.0 };
        let q = Vec3::new(p.x * n as f32, p.y * n as f32, z * (self.layers - 1) as f32);
        let last = Vec3::new(n as f32, n as f32, (self.layers - 1) as f32);
        let q = q.clamp(Vec3::ZERO, last);
        let c = q.floor().min(last - 1.0);
        let d = q - c;
        let get = |x: usize, y: usize, z: usize| {
            let (i, j, k) = (c.x as usize + x, c.y as usize + y, c.z as usize + z);
            self.data[(k * self.size + j) * self.size + i]
        };
        let row = |y, z| get(0, y, z) * (1.0 - d.x) + get(1, y, z) * d.x;
        let plane = |z| row(0, z) * (1.0 - d.y) + row(1, z) * d.y;
        plane(0) * (1.0 - d.z) + plane(1) * d.z
    }

    /// Sphere tracing (Hart 1996; on reliefs Donnelly, GPU Gems 2, 2005): steps as long as the relief is far, then a
    /// binary search. The distances between grid points are interpolated, so thin features may be missed.
    pub fn trace(&self, field: &HeightField, line: &Line, steps: u32) -> Option<(f32, u32)> {
        let (near, far) = field.span(line)?;
        let speed = line.direction.length();
        let least = 0.25 / (self.size as f32 * speed);
        let (mut t, mut before) = (near, near);
        for n in 1..=steps {
            if above(field, line.at(t)) < 0.0 {
                return Some((binary(field, line, (before, t), 16), n));
            }
            if t >= far {
                return None;
            }
            before = t;
            t = (t + (self.at(line.at(t)) / speed).max(least)).min(far);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn bumps() -> HeightField {
        HeightField::sampled(25, 25, |p| 0.1 * (9.0 * p.x).sin() * (7.0 * p.y).cos()).unwrap()
    }

    fn lines() -> Vec<(Line, f32)> {
        let (field, mut rng) = (bumps(), HashRng::new(17));
        let mut found = Vec::new();
        while found.len() < 300 {
            let mut u = || rng.next_f32();
            let (from, to) = (Vec3::new(u(), u(), 0.12 + 0.2 * u()), Vec3::new(u(), u(), -0.1));
            let line = Line { origin: from, direction: to - from };
            if let Some(t) = field.first_hit(&line) {
                found.push((line, t));
            }
        }
        found
    }

    /// The share of lines whose first meeting is found to within `within`, and the mean number of steps.
    fn score(within: f32, f: impl Fn(&Line) -> Option<(f32, u32)>) -> (f32, f32) {
        let all = lines();
        let (mut right, mut steps) = (0, 0);
        for (line, t) in &all {
            if let Some((found, n)) = f(line) {
                right += u32::from((found - t).abs() < within);
                steps += n;
            }
        }
        (right as f32 / all.len() as f32, steps as f32 / all.len() as f32)
    }

    /// E20: the weight of an end is the difference at the other one. Where the ray is 0.37 of the way's fall above the
    /// relief at its start and 0.63 below at its end, it meets it at 0.37 of the way; the lecture's formula has 0.63.
    #[test]
    fn the_lectures_numbers_for_the_secant() {
        let flat = HeightField::sampled(2, 2, |_| 0.5).unwrap();
        let line = Line { origin: Vec3::new(0.0, 0.5, 0.5 + 0.185), direction: Vec3::new(1.0, 0.0, -0.5) };
        assert!((secant(&flat, &line, (0.0, 1.0), 1) - 0.37).abs() < 1e-6);
        // On a slope: one step on a line meets it exactly.
        let field = HeightField::sampled(2, 2, |p| 0.5 * p.x).unwrap();
        let line = Line { origin: Vec3::new(0.0, 0.5, 0.4), direction: Vec3::new(1.0, 0.0, -0.4) };
        // 0.4 − 0.4 t = 0.5 t.
        assert!((secant(&field, &line, (0.0, 1.0), 1) - 4.0 / 9.0).abs() < 1e-6);
        assert!((binary(&field, &line, (0.0, 1.0), 20) - 4.0 / 9.0).abs() < 1e-5);
    }

    #[test]
    fn marches_find_what_is_as_wide_as_their_steps() {
        let field = bumps();
        let march = |steps, refine: &dyn Fn(&Line, (f32, f32)) -> f32| {
            score(1e-3, |l| linear(&field, l, steps).map(|i| (refine(l, i), steps))).0
        };
        let coarse = march(8, &|l, i| binary(&field, l, i, 10));
        let fine = march(64, &|l, i| binary(&field, l, i, 10));
        let by_secant = march(64, &|l, i| secant(&field, l, i, 4));
        let stairs = march(64, &|_, i| i.1);
        assert!(
            fine > 0.97 && by_secant > 0.97 && coarse < fine && stairs < 0.3,
            "{coarse} {fine} {by_secant} {stairs}"
        );
    }

    #[test]
    fn free_cones_find_every_first_meeting() {
        let field = bumps();
        let map = ConeMap::new(&field);
        let (right, steps) = score(1e-4, |l| map.trace(&field, l, 400));
        assert_eq!(right, 1.0);
        // Fewer steps than cells on the way.
        let cells = score(1.0, |l| {
            let d = l.direction.truncate().abs() * 24.0;
            Some((field.first_hit(l)?, ((d.x + d.y) * field.first_hit(l)?) as u32 + 1))
        });
        assert!(steps < 0.9 * cells.1, "{steps} {}", cells.1);
    }

    #[test]
    fn relaxed_cones_are_wider_and_seldom_wrong() {
        let field = bumps();
        let (free, relaxed) = (ConeMap::new(&field), ConeMap::relaxed(&field));
        assert!(relaxed.mean_ratio() > 1.2 * free.mean_ratio(), "{} {}", relaxed.mean_ratio(), free.mean_ratio());
        let (right, steps) = score(2e-3, |l| relaxed.trace(&field, l, 64));
        assert!(right > 0.95, "{right} {steps}");
    }

    #[test]
    fn spheres_find_most() {
        let field = bumps();
        let distances = DistanceField::new(&field, 33, 16);
        let (right, steps) = score(2e-3, |l| distances.trace(&field, l, 128));
        assert!(right > 0.97 && steps < 40.0, "{right} {steps}");
    }

    #[test]
    fn misses_are_misses() {
        let field = bumps();
        // Over a hollow, and up.
        let up = Line { origin: Vec3::new(0.5, 0.05, 0.05), direction: Vec3::new(0.1, 0.0, 1.0) };
        let map = ConeMap::new(&field);
        assert!(linear(&field, &up, 16).is_none() && map.trace(&field, &up, 100).is_none());
        assert!(DistanceField::new(&field, 8, 8).trace(&field, &up, 100).is_none());
    }
}
