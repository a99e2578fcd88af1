//! Sign changes of an expression along a ray.
//!
//! The way through the box is halved, nearer parts first. A part is done with where the interval of its values has no
//! zero, or where that of its derivative has none: the expression is monotone there, and the signs at the ends tell. A
//! part too short to halve is a hit where the signs differ and the values are bounded: poles are none. So no change of
//! sign is missed that shows at the ends of a part of that length; places where the surface is touched without a change
//! are none. What it may cost is bounded: beyond [`MOST_PARTS`] parts are no longer halved, and the signs at their ends
//! tell.

use glam::DVec3;
use steradian_math::expression::{Dual, Expression, Interval, Number};

/// Most parts of a ray that are looked at closely, and most operations in all of them.
const MOST_PARTS: usize = 8192;
const MOST_OPERATIONS: usize = 1 << 21;
/// Longest part that is not halved again, relative to the length in the box and to the distance from the ray's origin:
/// below half a step of `f32`.
const SHORT: f64 = 1.0 / (1_u64 << 26) as f64;
/// Most steps to a root that is known to be between two places.
const MOST_STEPS: u32 = 100;

/// A ray along which the zeros of an expression are sought.
pub(super) struct Search<'e> {
    e: &'e Expression<3>,
    ray: [DVec3; 2],
    before: f64,
    /// Parts that were looked at.
    seen: usize,
}

impl<'e> Search<'e> {
    /// Along `o + s d`. Steps of `f32` are those at `before + s`.
    pub fn new(e: &'e Expression<3>, ray: [DVec3; 2], before: f64) -> Self {
        Self { e, ray, before, seen: 0 }
    }

    fn value(&self, s: f64) -> f64 {
        let [o, d] = self.ray;
        self.e.value((o + d * s).to_array())
    }

    /// The values between two places.
    fn between(&self, a: f64, b: f64) -> Interval {
        let ([o, d], s) = (self.ray, Interval::new(a, b));
        self.e.value(std::array::from_fn(|k| Interval::new(o[k], o[k]).add(Interval::new(d[k], d[k]).mul(s))))
    }

    /// The derivative between two places.
    fn slope(&self, a: f64, b: f64) -> Interval {
        let ([o, d], s) = (self.ray, Interval::new(a, b));
        let along = |k: usize| {
            let way = Interval::new(d[k], d[k]);
            Dual::new(Interval::new(o[k], o[k]).add(way.mul(s)), way)
        };
        self.e.value(std::array::from_fn(along)).slope
    }

    /// Calls back with the places where the expression changes its sign between two places, in order, until one is
    /// taken.
    pub fn first<R>(&mut self, [begin, end]: [f64; 2], mut take: impl FnMut(f64) -> Option<R>) -> Option<R> {
        let at_begin = self.value(begin);
        if begin == 0.0
            && at_begin == 0.0
            && let Some(taken) = take(0.0)
        {
            return Some(taken);
        }
        // Each part waits with its values at the ends; halves leave one more, so there are never many.
        let mut parts = [(0.0, 0.0, 0.0, 0.0); 64];
        parts[0] = (begin, at_begin, end, self.value(end));
        let mut count = 1;
        let most = MOST_PARTS.min(MOST_OPERATIONS / self.e.operations().max(1));
        while count > 0 {
            count -= 1;
            let (a, fa, b, fb) = parts[count];
            let changes = fb == 0.0 || (fa < 0.0 && fb > 0.0) || (fa > 0.0 && fb < 0.0);
            let is_short = b - a <= SHORT * end.max(self.before.abs() + b) || count + 2 > parts.len();
            self.seen += 1;
            let root = if self.seen > most {
                changes
            } else {
                let value = self.between(a, b);
                if value.is_none() || !value.has_zero() {
                    continue;
                }
                let is_monotone = || {
                    let slope = self.slope(a, b);
                    !slope.is_none() && !slope.has_zero()
                };
                if is_short {
                    changes && value.is_finite()
                } else if value.is_finite() && is_monotone() {
                    changes
                } else {
                    let m = 0.5 * (a + b);
                    let fm = self.value(m);
                    (parts[count], parts[count + 1]) = ((m, fm, b, fb), (a, fa, m, fm));
                    count += 2;
                    continue;
                }
            };
            if root {
                let taken = take(refine(|s| self.value(s), [a, b], [fa, fb]));
                if taken.is_some() {
                    return taken;
                }
            }
        }
        None
    }
}

/// The root between two places with values of different signs, by the method of Illinois: secants, where an end that
/// stays again counts half.
fn refine(f: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], [mut fa, mut fb]: [f64; 2]) -> f64 {
    if fb == 0.0 {
        return b;
    }
    let close = 1e-15 * (a.abs() + b.abs());
    let mut stays = 0.0;
    for step in 0..MOST_STEPS {
        if b - a <= close {
            break;
        }
        let secant = (a * fb - b * fa) / (fb - fa);
        // Every third step halves, so that it ends soon whatever the function is.
        let s = if step % 3 < 2 && secant > a && secant < b { secant } else { 0.5 * (a + b) };
        let v = f(s);
        if v == 0.0 {
            return s;
        }
        let moved = if (v < 0.0) == (fa < 0.0) { 1.0 } else { -1.0 };
        let weight = if moved == stays { 0.5 } else { 1.0 };
        stays = moved;
        if moved > 0.0 {
            (a, fa, fb) = (s, v, weight * fb);
        } else {
            (b, fb, fa) = (s, v, weight * fa);
        }
    }
    0.5 * (a + b)
}
