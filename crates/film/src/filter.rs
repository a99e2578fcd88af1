//! Pixel filters, by importance sampling: each sample belongs to one pixel and is placed around its centre with a
//! density proportional to the filter (Ernst, Stamminger, Greiner 2006). No sample is shared, so pixels stay
//! independent of each other.
//!
//! Filters with negative lobes are sampled by their magnitude and weighted by their sign, rather than splatted.

use std::sync::Arc;
use steradian_math::{Vec2, distribution::Piecewise1D};

/// A filter's shape along one axis; filters are products over the two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterKind {
    /// 1.
    Box,
    /// `1 − |x|/r`.
    Tent,
    /// `exp(−x²/2σ²) − exp(−r²/2σ²)`.
    Gaussian {
        /// σ in pixels.
        sigma: f32,
    },
    /// Mitchell & Netravali 1988 with parameters B and C, stretched to the radius (`x·2/r`).
    Mitchell {
        /// B.
        b: f32,
        /// C.
        c: f32,
    },
    /// `sinc(x)·sinc(x/τ')`, zero outside the radius: Lanczos with τ lobes over the radius.
    Lanczos {
        /// Lobes.
        tau: f32,
    },
    /// The four-term Blackman–Harris window over the radius.
    BlackmanHarris,
}

const BINS: usize = 256;

/// A filter ready to be sampled.
#[derive(Clone, Debug)]
pub struct Filter {
    kind: FilterKind,
    radius: Vec2,
    axes: Arc<[Axis; 2]>,
}

/// Sampling of one axis: the density `|f|` over `BINS` cells of `[-1, 1]`.
#[derive(Debug)]
struct Axis {
    density: Piecewise1D,
    /// `1 / ∫ f` over `[-1, 1]`.
    norm: f32,
}

fn evaluate(kind: FilterKind, x: f32, radius: f32) -> f32 {
    let x = x.abs();
    if x > radius {
        return 0.0;
    }
    match kind {
        FilterKind::Box => 1.0,
        FilterKind::Tent => 1.0 - x / radius,
        FilterKind::Gaussian { sigma } => {
            let g = |x: f32| (-x * x / (2.0 * sigma * sigma)).exp();
            (g(x) - g(radius)).max(0.0)
        }
        FilterKind::Mitchell { b, c } => {
            let x = 2.0 * x / radius;
            let cubic = |p: f32, q: f32, r: f32, s: f32| (((p * x + q) * x + r) * x + s) / 6.0;
            if x < 1.0 {
                cubic(12.0 - 9.0 * b - 6.0 * c, -18.0 + 12.0 * b + 6.0 * c, 0.0, 6.0 - 2.0 * b)
            } else {
                cubic(-b - 6.0 * c, 6.0 * b + 30.0 * c, -12.0 * b - 48.0 * c, 8.0 * b + 24.0 * c)
            }
        }
        FilterKind::Lanczos { tau } => {
            let sinc = |x: f32| {
                let x = std::f32::consts::PI * x;
                if x < 1e-4 { 1.0 - x * x / 6.0 } else { x.sin() / x }
            };
            sinc(x) * sinc(x / tau)
        }
        FilterKind::BlackmanHarris => {
            let t = std::f32::consts::PI * (x / radius + 1.0);
            0.358_75 - 0.488_29 * t.cos() + 0.141_28 * (2.0 * t).cos() - 0.011_68 * (3.0 * t).cos()
        }
    }
}

impl Axis {
    fn new(kind: FilterKind, radius: f32) -> Self {
        let centre = |i: usize| ((i as f32 + 0.5) / BINS as f32 * 2.0 - 1.0) * radius;
        let values: Vec<f32> = (0..BINS).map(|i| evaluate(kind, centre(i), radius)).collect();
        let integral: f64 = values.iter().map(|&v| f64::from(v)).sum::<f64>() * 2.0 / BINS as f64;
        Self { density: Piecewise1D::new(&values), norm: 1.0 / integral as f32 }
    }
}

impl Filter {
    /// A filter of a shape and radii (pixels); `None` if a radius or parameter is not positive and finite, or the
    /// filter has no volume.
    pub fn new(kind: FilterKind, radius: Vec2) -> Option<Self> {
        let positive = |v: f32| v.is_finite() && v > 0.0;
        let sound = match kind {
            FilterKind::Gaussian { sigma } => positive(sigma),
            FilterKind::Lanczos { tau } => positive(tau),
            FilterKind::Mitchell { b, c } => b.is_finite() && c.is_finite(),
            _ => true,
        };
        if !(sound && positive(radius.x) && positive(radius.y) && radius.max_element() < 1e4) {
            return None;
        }
        let axis = |r: f32| {
            let a = Axis::new(kind, r);
            (a.norm.is_finite() && a.norm > 0.0).then_some(a)
        };
        Some(Self { kind, radius, axes: Arc::new([axis(radius.x)?, axis(radius.y)?]) })
    }

    /// The value at an offset from the pixel centre, not normalised.
    pub fn evaluate(&self, offset: Vec2) -> f32 {
        evaluate(self.kind, offset.x, self.radius.x) * evaluate(self.kind, offset.y, self.radius.y)
    }

    /// The radii along both axes, pixels.
    pub fn radius(&self) -> Vec2 {
        self.radius
    }

    /// The value at an offset from the pixel centre, normalised: its integral over the film is one.
    pub fn density(&self, offset: Vec2) -> f32 {
        let [x, y] = &*self.axes;
        self.evaluate(offset) * (x.norm * y.norm / (self.radius.x * self.radius.y))
    }

    /// An offset from the pixel centre and the weight of a sample there: filter over density, one on average.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        match self.kind {
            FilterKind::Box => ((u * 2.0 - 1.0) * self.radius, 1.0),
            _ => self.sample_curved(u),
        }
    }

    /// Samples the filters that are not constant.
    #[inline(never)]
    fn sample_curved(&self, u: Vec2) -> (Vec2, f32) {
        match self.kind {
            FilterKind::Tent => {
                let tent =
                    |u: f32| if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).max(0.0).sqrt() };
                (Vec2::new(tent(u.x), tent(u.y)) * self.radius, 1.0)
            }
            _ => {
                let axis = |a: &Axis, u: f32, radius: f32| {
                    let (x, pdf, _) = a.density.sample(u);
                    let x = x * 2.0 - 1.0;
                    // Densities here are over [-1, 1]: half of those over [0, 1].
                    (x * radius, evaluate(self.kind, x * radius, radius) * a.norm / (pdf * 0.5))
                };
                let (x, wx) = axis(&self.axes[0], u.x, self.radius.x);
                let (y, wy) = axis(&self.axes[1], u.y, self.radius.y);
                (Vec2::new(x, y), wx * wy)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    const ALL: &[(FilterKind, f32)] = &[
        (FilterKind::Box, 0.5),
        (FilterKind::Tent, 1.0),
        (FilterKind::Gaussian { sigma: 0.5 }, 1.5),
        (FilterKind::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }, 2.0),
        (FilterKind::Mitchell { b: 0.0, c: 0.5 }, 2.0),
        (FilterKind::Lanczos { tau: 3.0 }, 3.0),
        (FilterKind::BlackmanHarris, 1.5),
    ];

    /// M165: a step edge seen through the filter. The estimate of `∫ f(x) [x < e] dx` agrees with quadrature.
    #[test]
    fn samples_reproduce_the_filter() {
        for &(kind, r) in ALL {
            let filter = Filter::new(kind, Vec2::splat(r)).unwrap();
            let mut rng = HashRng::new(11);
            for edge in [-0.7 * r, 0.1, 0.4 * r] {
                let n = 200_000;
                let (mut sum, mut sq) = (0.0_f64, 0.0_f64);
                for _ in 0..n {
                    let (p, w) = filter.sample(Vec2::new(rng.next_f32(), rng.next_f32()));
                    assert!(p.x.abs() <= r && p.y.abs() <= r);
                    let v = if p.x < edge { f64::from(w) } else { 0.0 };
                    sum += v;
                    sq += v * v;
                }
                let mean = sum / f64::from(n);
                let sigma = ((sq / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
                let steps = 20_000;
                let quad = |to: f32| {
                    let h = (to + r) / steps as f32;
                    (0..steps).map(|i| f64::from(evaluate(kind, -r + (i as f32 + 0.5) * h, r) * h)).sum::<f64>()
                };
                let expected = quad(edge) / quad(r);
                assert!((mean - expected).abs() < 4.5 * sigma + 2e-4, "{kind:?} {edge}: {mean} against {expected}");
            }
        }
    }

    #[test]
    fn unsound_filters_are_refused() {
        assert!(Filter::new(FilterKind::Box, Vec2::ZERO).is_none());
        assert!(Filter::new(FilterKind::Box, Vec2::new(1.0, f32::NAN)).is_none());
        assert!(Filter::new(FilterKind::Gaussian { sigma: 0.0 }, Vec2::ONE).is_none());
    }
}
