//! Ramps, from a number to a colour, and curves, from a number to a number.

use steradian_math::Vec3;

/// Interpolation between the stops of a ramp or curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The last stop before.
    Step,
    /// Straight lines.
    Linear,
    /// Smoothsteps: no slope at the stops.
    Smooth,
    /// Catmull–Rom (slopes by the neighbours on each side): through the stops without corners; may overshoot.
    CatmullRom,
    /// Cubic Bézier segments over four stops at a time, the next one stop further on, as pbrt's marble has it; stops
    /// count as evenly spaced over [0, 1].
    SlidingBezier,
}

/// A function given by stops; beyond the ends it is constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// Places, increasing.
    places: Box<[f32]>,
    values: Box<[Vec3]>,
    interpolation: Interpolation,
}

/// Fault in the stops of a ramp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RampFault {
    /// None at all.
    #[error("a ramp needs stops")]
    Empty,
    /// As many places as values.
    #[error("a ramp needs as many places as values")]
    Mismatch,
    /// They go up.
    #[error("the places of a ramp must increase")]
    Order,
    /// A segment has four.
    #[error("a Bézier ramp needs at least four stops")]
    TooFew,
}

impl Ramp {
    /// A ramp through values at places.
    ///
    /// # Errors
    /// Where the stops do not make a function.
    pub fn new(places: Vec<f32>, values: Vec<Vec3>, interpolation: Interpolation) -> Result<Self, RampFault> {
        if values.is_empty() {
            return Err(RampFault::Empty);
        }
        if places.len() != values.len() {
            return Err(RampFault::Mismatch);
        }
        if interpolation == Interpolation::SlidingBezier && values.len() < 4 {
            return Err(RampFault::TooFew);
        }
        if !places.windows(2).all(|w| w[0] < w[1]) || !places.iter().all(|p| p.is_finite()) {
            return Err(RampFault::Order);
        }
        Ok(Self { places: places.into(), values: values.into(), interpolation })
    }

    /// pbrt-v4's colours of marble (linear sRGB), half as bright again as listed.
    pub fn marble() -> Self {
        let grey = Vec3::new(0.58, 0.58, 0.6);
        let other = [(3, Vec3::splat(0.5)), (4, Vec3::new(0.6, 0.59, 0.58)), (7, Vec3::new(0.2, 0.2, 0.33))];
        let mut values = vec![grey; 9];
        for (i, c) in other {
            values[i] = c;
        }
        Self {
            places: (0..9).map(|i| i as f32 / 8.0).collect(),
            values: values.into_iter().map(|c| c * 1.5).collect(),
            interpolation: Interpolation::SlidingBezier,
        }
    }

    /// The value at a place.
    pub fn at(&self, x: f32) -> Vec3 {
        let n = self.values.len();
        let x = if x.is_nan() { 0.0 } else { x };
        if self.interpolation == Interpolation::SlidingBezier {
            let segments = n - 3;
            let s = x.clamp(0.0, 1.0) * segments as f32;
            let first = (s.floor() as usize).min(segments - 1);
            return bezier(&self.values[first..first + 4], s - first as f32);
        }
        // The number of stops at or before x.
        let after = self.places.partition_point(|p| *p <= x);
        if after == 0 {
            return self.values[0];
        }
        if after == n {
            return self.values[n - 1];
        }
        let (i, j) = (after - 1, after);
        let (a, b) = (self.values[i], self.values[j]);
        let step = self.places[j] - self.places[i];
        let t = (x - self.places[i]) / step;
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Smooth => a + (b - a) * (t * t * (3.0 - 2.0 * t)),
            Interpolation::CatmullRom => {
                let slope = |k: usize| {
                    let (l, r) = (k.saturating_sub(1), (k + 1).min(n - 1));
                    (self.values[r] - self.values[l]) / (self.places[r] - self.places[l])
                };
                let (ma, mb) = (slope(i) * step, slope(j) * step);
                let (t2, t3) = (t * t, t * t * t);
                a * (2.0 * t3 - 3.0 * t2 + 1.0) + ma * (t3 - 2.0 * t2 + t) + b * (3.0 * t2 - 2.0 * t3) + mb * (t3 - t2)
            }
            Interpolation::Linear | Interpolation::SlidingBezier => a + (b - a) * t,
        }
    }
}

fn bezier(c: &[Vec3], t: f32) -> Vec3 {
    let s = 1.0 - t;
    c[0] * (s * s * s) + c[1] * (3.0 * s * s * t) + c[2] * (3.0 * s * t * t) + c[3] * (t * t * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(interpolation: Interpolation) -> Ramp {
        let values = vec![Vec3::ZERO, Vec3::new(1.0, 2.0, 4.0), Vec3::new(3.0, 2.0, 0.0)];
        Ramp::new(vec![0.0, 1.0, 2.0], values, interpolation).unwrap()
    }

    #[test]
    fn stops_and_what_lies_between() {
        use Interpolation::{CatmullRom, Linear, Smooth, Step};
        for i in [Step, Linear, Smooth, CatmullRom] {
            let r = ramp(i);
            assert_eq!((r.at(-1.0), r.at(0.0), r.at(5.0)), (Vec3::ZERO, Vec3::ZERO, Vec3::new(3.0, 2.0, 0.0)), "{i:?}");
            assert_eq!(r.at(1.0), Vec3::new(1.0, 2.0, 4.0));
            assert!(r.at(f32::NAN).is_finite());
        }
        assert_eq!(ramp(Step).at(0.9), Vec3::ZERO);
        assert_eq!(ramp(Linear).at(0.25), Vec3::new(0.25, 0.5, 1.0));
        assert_eq!(ramp(Smooth).at(0.25).x, 0.15625);
        // A straight line stays one.
        let line = Ramp::new(vec![0.0, 1.0, 3.0], [0.0, 1.0, 3.0].map(Vec3::splat).into(), CatmullRom).unwrap();
        assert!((line.at(1.7).x - 1.7).abs() < 1e-6);
    }

    #[test]
    fn marble_by_hand() {
        // The seventh colour's segment: t = 1 ends at the last colour, t = ½ is the middle of the fourth segment's
        // start.
        let m = Ramp::marble();
        assert!((m.at(1.0) - Vec3::new(0.87, 0.87, 0.9)).length() < 1e-6);
        assert!((m.at(0.0) - Vec3::new(0.87, 0.87, 0.9)).length() < 1e-6);
        assert!((m.at(0.5) - Vec3::splat(0.75)).length() < 1e-6);
        // Control points 5…8 at t = ½ of segment 5: (0.58 + 3·0.58 + 3·0.2 + 0.58)/8 × 1.5.
        let x = (0.58 * 5.0 + 0.2 * 3.0) / 8.0 * 1.5;
        assert!((m.at(11.0 / 12.0).x - x).abs() < 1e-6);
    }

    #[test]
    fn faults() {
        let v = |n: usize| vec![Vec3::ONE; n];
        let f = |p: Vec<f32>, n, i| Ramp::new(p, v(n), i).err();
        assert_eq!(f(vec![], 0, Interpolation::Linear), Some(RampFault::Empty));
        assert_eq!(f(vec![0.0], 2, Interpolation::Linear), Some(RampFault::Mismatch));
        assert_eq!(f(vec![0.0, 0.0], 2, Interpolation::Linear), Some(RampFault::Order));
        assert_eq!(f(vec![0.0, 1.0], 2, Interpolation::SlidingBezier), Some(RampFault::TooFew));
    }
}
