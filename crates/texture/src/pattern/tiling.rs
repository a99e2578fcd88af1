//! Patterns of the plane and of space that repeat: their averages have closed forms.

// Comparisons are negated on purpose: NaN takes the way of the exception.
#![expect(clippy::neg_cmp_op_on_partial_ord, reason = "a NaN takes the branch, too")]

use super::super::{
    mapping::{Coordinates2, Coordinates3},
    noise::{gradient_noise, lattice},
};
use steradian_math::{Vec2, Vec3, hash::unit_f32};

/// Indices of cells alternate up to here; beyond it `f32` has no odd numbers.
fn is_odd(x: f32) -> bool {
    x.rem_euclid(2.0) >= 1.0
}

/// The square wave of period two, +1 on [0, 1) and −1 on [1, 2), averaged with a tent of half width `r`.
///
/// The second integral of the wave is `x/2 + y (1 − 2|y|)` with `y = frac(x/2) − ½`, up to a linear part, and the
/// average is its second difference over `r²` (Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., §
/// 10.4.1).
fn alternation(x: f32, r: f32) -> f32 {
    let (a, b) = ((x - r).floor(), (x + r).floor());
    // Also where r is zero or vanishes beside x.
    if a == b || !(r > 0.0) {
        return if is_odd(x.floor()) { -1.0 } else { 1.0 };
    }
    let (x, r) = (f64::from(x), f64::from(r));
    let d = |x: f64| {
        let h = x * 0.5;
        let y = h - h.floor() - 0.5;
        h + y * (1.0 - 2.0 * y.abs())
    };
    ((d(x + r) - 2.0 * d(x) + d(x - r)) / (r * r)) as f32
}

/// The tent that pbrt uses reaches one and a half pixels.
const TENT: f32 = 1.5;

/// The share of odd squares.
pub fn checker2(c: &Coordinates2) -> f32 {
    let r = c.width() * TENT;
    0.5 - 0.5 * alternation(c.uv.x, r.x) * alternation(c.uv.y, r.y)
}

/// The share of odd cubes.
pub fn checker3(c: &Coordinates3) -> f32 {
    let r = c.width() * TENT;
    0.5 - 0.5 * alternation(c.p.x, r.x) * alternation(c.p.y, r.y) * alternation(c.p.z, r.z)
}

/// The pulse train that is 1 on [k, k + duty) for whole k, averaged over `[x − w/2, x + w/2]`.
pub fn pulse(x: f32, w: f32, duty: f32) -> f32 {
    let duty = duty.clamp(0.0, 1.0);
    let x = f64::from(x);
    let wide = f64::from(w);
    if !(wide > 1e-6) {
        return if x - x.floor() < f64::from(duty) { 1.0 } else { 0.0 };
    }
    let d = f64::from(duty);
    let integral = |x: f64| x.floor() * d + (x - x.floor()).min(d);
    // Wide averages of numbers far from zero lose digits; the whole periods are taken out.
    let x = x - x.floor();
    ((integral(x + wide * 0.5) - integral(x - wide * 0.5)) / wide) as f32
}

/// pbrt-v4's polka dots: a cell has one where the noise at its middle is positive, displaced within the cell by noise.
pub fn polka_dot(uv: Vec2) -> f32 {
    const RADIUS: f32 = 0.35;
    const SHIFT: f32 = 0.5 - RADIUS;
    let cell = (uv + 0.5).floor();
    let noise = |dx: f32, dy: f32| gradient_noise(Vec3::new(cell.x + dx, cell.y + dy, 0.5), 0);
    if noise(0.5, 0.5) <= 0.0 {
        return 0.0;
    }
    let centre = cell + Vec2::new(noise(1.5, 2.8), noise(4.5, 9.8)) * SHIFT;
    if (uv - centre).length_squared() < RADIUS * RADIUS { 1.0 } else { 0.0 }
}

/// Rectangles in rows with mortar between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bricks {
    /// Width and height of a brick with its mortar.
    pub size: Vec2,
    /// Width of the mortar, along u and v.
    pub mortar: Vec2,
    /// Shift of each row against the one before, in bricks: 0 for tiles, ½ for a running bond.
    pub shift: f32,
}

/// Rows that are averaged one by one.
const ROWS: f32 = 16.0;

impl Bricks {
    /// Shares of a period that are brick.
    fn duty(&self) -> Vec2 {
        (Vec2::ONE - self.mortar / self.size).clamp(Vec2::ZERO, Vec2::ONE)
    }

    /// Place in units of bricks, with the mortar half on each side.
    fn place(&self, uv: Vec2) -> Vec2 {
        uv / self.size - (Vec2::ONE - self.duty()) * 0.5
    }

    fn moved(&self, row: f32) -> f32 {
        let s = f64::from(row) * f64::from(self.shift);
        (s - s.floor()) as f32
    }

    /// The share of brick in the footprint: the average over each of its rows of the average along it.
    pub fn value(&self, c: &Coordinates2) -> f32 {
        let (p, w, duty) = (self.place(c.uv), c.width() / self.size, self.duty());
        let (low, high) = (p.y - w.y * 0.5, p.y + w.y * 0.5);
        let along = |row: f32| pulse(p.x + self.moved(row), w.x, duty.x);
        if !(w.y > 1e-6) {
            return along(p.y.floor()) * pulse(p.y, 0.0, duty.y);
        }
        if !(w.y <= ROWS) {
            return duty.x * pulse(p.y, w.y, duty.y);
        }
        let mut sum = 0.0;
        let mut row = low.floor();
        while row < high {
            let covered = (high.min(row + duty.y) - low.max(row)).max(0.0);
            sum += covered * along(row);
            if row + 1.0 == row {
                break;
            }
            row += 1.0;
        }
        (sum / w.y).clamp(0.0, 1.0)
    }

    /// A random number for the brick that a point lies on.
    pub fn shade(&self, uv: Vec2, seed: u32) -> f32 {
        let p = self.place(uv);
        let row = p.y.floor();
        let column = (p.x + self.moved(row)).floor();
        unit_f32(lattice::hash(seed, [column as i32, row as i32, 0]))
    }
}
