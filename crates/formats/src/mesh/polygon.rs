//! Polygons into triangles: quads by their diagonal, convex polygons by a fan, others by clipping ears (Meisters 1975).

/// The polygon is too complex to be cut in reasonable time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooComplex;

type Point = [f64; 2];

/// Added to the budget for each corner of a concave polygon: those of about two hundred corners can never use it up.
const STEPS_PER_CORNER: u64 = 600;

/// Cuts polygons; keeps its work space between them.
pub(crate) struct Triangulator {
    flat: Vec<Point>,
    next: Vec<u32>,
    previous: Vec<u32>,
    reflex: Vec<bool>,
    ear: Vec<bool>,
    /// Steps left. Ear clipping is quadratic; this makes what a hostile file can ask for linear in its length.
    budget: u64,
}

impl Default for Triangulator {
    fn default() -> Self {
        Self {
            flat: Vec::new(),
            next: Vec::new(),
            previous: Vec::new(),
            reflex: Vec::new(),
            ear: Vec::new(),
            budget: 1 << 28,
        }
    }
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f64; 3] {
    std::array::from_fn(|i| f64::from(a[i]) - f64::from(b[i]))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Twice the signed area of a triangle.
fn area(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl Triangulator {
    /// Calls `emit` with the corners (positions in the polygon) of its `n − 2` triangles, wound as the polygon is;
    /// nothing for less than three corners. `position` gives a corner's place.
    ///
    /// # Errors
    /// [`TooComplex`] for concave polygons when the budget is used up.
    pub(crate) fn cut(
        &mut self,
        corners: usize,
        position: impl Fn(usize) -> [f32; 3],
        mut emit: impl FnMut([usize; 3]),
    ) -> Result<(), TooComplex> {
        match corners {
            0..=2 => {}
            3 => emit([0, 1, 2]),
            4 => {
                // The diagonal 0–2 cuts the quad well unless the halves face apart, as they do where corner 1 or 3 is
                // reflex.
                let p = [position(0), position(1), position(2), position(3)];
                let diagonal = sub(p[2], p[0]);
                let (n1, n2) = (cross(sub(p[1], p[0]), diagonal), cross(diagonal, sub(p[3], p[0])));
                if dot(n1, n2) >= 0.0 {
                    emit([0, 1, 2]);
                    emit([0, 2, 3]);
                } else {
                    emit([1, 2, 3]);
                    emit([1, 3, 0]);
                }
            }
            _ => return self.cut_many(corners, position, emit),
        }
        Ok(())
    }

    fn cut_many(
        &mut self,
        corners: usize,
        position: impl Fn(usize) -> [f32; 3],
        mut emit: impl FnMut([usize; 3]),
    ) -> Result<(), TooComplex> {
        self.flatten(corners, position);
        let n = corners;
        let turn = |flat: &[Point], i: usize| area(flat[(i + n - 1) % n], flat[i], flat[(i + 1) % n]);
        let convex = (0..n).all(|i| turn(&self.flat, i) >= 0.0);
        if convex {
            (1..n - 1).for_each(|i| emit([0, i, i + 1]));
            return Ok(());
        }

        self.budget += n as u64 * STEPS_PER_CORNER;
        // Corners in a ring; those that are reflex can block an ear, the others cannot.
        self.next = (1..=n).map(|i| (i % n) as u32).collect();
        self.previous = (0..n).map(|i| ((i + n - 1) % n) as u32).collect();
        self.reflex = (0..n).map(|i| turn(&self.flat, i) < 0.0).collect();
        self.ear = vec![false; n];
        for i in 0..n {
            self.ear[i] = self.is_ear(i)?;
        }
        let (mut at, mut left, mut passed) = (0usize, n, 0usize);
        while left > 3 {
            // A polygon that crosses itself may have no ear left: any corner is cut then, so that it always ends.
            if !self.ear[at] && passed <= left {
                at = self.next[at] as usize;
                passed += 1;
                self.budget = self.budget.checked_sub(1).ok_or(TooComplex)?;
                continue;
            }
            let (before, after) = (self.previous[at] as usize, self.next[at] as usize);
            emit([before, at, after]);
            self.next[before] = after as u32;
            self.previous[after] = before as u32;
            self.reflex[at] = false;
            left -= 1;
            passed = 0;
            for i in [before, after] {
                let (p, q) = (self.previous[i] as usize, self.next[i] as usize);
                self.reflex[i] = area(self.flat[p], self.flat[i], self.flat[q]) < 0.0;
            }
            self.ear[before] = self.is_ear(before)?;
            self.ear[after] = self.is_ear(after)?;
            // Going on two corners later makes fewer slivers than cutting neighbours in turn.
            at = self.next[after] as usize;
        }
        emit([self.previous[at] as usize, at, self.next[at] as usize]);
        Ok(())
    }

    /// Projects the polygon along the largest axis of its normal (Newell's), mirrored where needed so that it runs
    /// counter-clockwise.
    fn flatten(&mut self, corners: usize, position: impl Fn(usize) -> [f32; 3]) {
        let origin = position(0);
        let mut normal = [0.0; 3];
        let mut a = sub(position(corners - 1), origin);
        for i in 0..corners {
            let b = sub(position(i), origin);
            let c = cross(a, b);
            for k in 0..3 {
                normal[k] += c[k];
            }
            a = b;
        }
        let axis = (0..3).fold(0, |m, k| if normal[k].abs() > normal[m].abs() { k } else { m });
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = if normal[axis] < 0.0 { (v, u) } else { (u, v) };
        self.flat.clear();
        self.flat.extend((0..corners).map(|i| {
            let p = sub(position(i), origin);
            [p[u], p[v]]
        }));
    }

    /// Tests for an ear, a corner that can be cut off: it is convex, and no reflex corner lies in its triangle.
    fn is_ear(&mut self, i: usize) -> Result<bool, TooComplex> {
        let (before, after) = (self.previous[i] as usize, self.next[i] as usize);
        let (a, b, c) = (self.flat[before], self.flat[i], self.flat[after]);
        if area(a, b, c) <= 0.0 {
            return Ok(false);
        }
        let mut j = self.next[after] as usize;
        while j != before {
            self.budget = self.budget.checked_sub(1).ok_or(TooComplex)?;
            let p = self.flat[j];
            if self.reflex[j]
                && p != a
                && p != b
                && p != c
                && area(a, b, p) >= 0.0
                && area(b, c, p) >= 0.0
                && area(c, a, p) >= 0.0
            {
                return Ok(false);
            }
            j = self.next[j] as usize;
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn cut(points: &[[f32; 3]]) -> Vec<[usize; 3]> {
        let mut out = Vec::new();
        Triangulator::default().cut(points.len(), |i| points[i], |t| out.push(t)).unwrap();
        assert_eq!(out.len(), points.len().saturating_sub(2));
        out
    }

    /// Sum of signed areas along z, and of their magnitudes: equal where no triangle is turned over or overlaps.
    fn areas(points: &[[f32; 3]], triangles: &[[usize; 3]]) -> (f64, f64) {
        let xy = |i: usize| [f64::from(points[i][0]), f64::from(points[i][1])];
        triangles.iter().fold((0.0, 0.0), |(s, m), &[a, b, c]| {
            let x = area(xy(a), xy(b), xy(c)) * 0.5;
            (s + x, m + x.abs())
        })
    }

    #[test]
    fn concave_quad_is_cut_along_the_inner_diagonal() {
        for shift in 0..4 {
            let mut dart = [[0.0, 0.0, 0.0], [2.0, -2.0, 0.0], [0.5, 0.0, 0.0], [2.0, 2.0, 0.0]];
            dart.rotate_left(shift);
            let (signed, total) = areas(&dart, &cut(&dart));
            assert!((signed - total).abs() < 1e-12 && signed > 0.0, "{shift}: {signed} {total}");
        }
    }

    #[test]
    fn star_shaped_polygons_keep_their_area_in_any_orientation() {
        let mut rng = HashRng::new(5);
        for trial in 0..200 {
            let n = 5 + trial % 60;
            let mut star: Vec<[f32; 3]> = (0..n)
                .map(|i| {
                    let (angle, r) = (i as f32 / n as f32 * std::f32::consts::TAU, 0.2 + rng.next_f32());
                    [r * angle.cos(), r * angle.sin(), 0.0]
                })
                .collect();
            if trial % 2 == 1 {
                star.reverse();
            }
            let exact: f64 = (0..n)
                .map(|i| {
                    let (a, b) = (star[i], star[(i + 1) % n]);
                    0.5 * (f64::from(a[0]) * f64::from(b[1]) - f64::from(a[1]) * f64::from(b[0]))
                })
                .sum();
            let (signed, total) = areas(&star, &cut(&star));
            assert!((signed - exact).abs() < 1e-6, "{trial}: {signed} against {exact}");
            assert!((total - exact.abs()).abs() < 1e-6, "{trial}: triangles overlap: {total} against {exact}");
        }
    }

    #[test]
    fn degenerate_polygons_end() {
        cut(&[[1.0; 3]; 9]);
        let line: Vec<[f32; 3]> = (0..9).map(|i| [i as f32, 0.0, 0.0]).collect();
        cut(&line);
        let bow =
            [[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.], [2., 3., 1.], [0., -1., 5.], [0.3, 0.2, 0.1]];
        cut(&bow);
        assert!(cut(&[[0.0; 3]; 2]).is_empty());
    }

    #[test]
    fn the_budget_stops_hostile_polygons() {
        let comb: Vec<[f32; 3]> =
            (0..20_000).map(|i| [i as f32, if i % 2 == 0 { 0.0 } else { 1e-3 * i as f32 }, 0.0]).collect();
        let mut t = Triangulator { budget: 0, ..Triangulator::default() };
        assert_eq!(t.cut(comb.len(), |i| comb[i], |_| ()), Err(TooComplex));
    }
}
