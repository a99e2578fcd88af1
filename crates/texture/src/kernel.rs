//! Kernels: how texels are joined to a continuous picture, and how pictures are made smaller.

use std::f32::consts::PI;

/// Reconstruction kernels that are products of one in x and one in y.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cubic {
    /// The uniform cubic B-spline: smooth, and blurs (B = 1, C = 0).
    BSpline,
    /// Mitchell, Netravali, "Reconstruction Filters in Computer Graphics", SIGGRAPH 1988, eq. 8, with B = C = 1/3.
    Mitchell,
    /// Catmull and Rom's spline through the texels (B = 0, C = 1/2).
    CatmullRom,
}

impl Cubic {
    /// The weights of the four texels around a point that lies `t` in `[0, 1)` beyond the second. They add up to one.
    #[inline]
    pub fn weights(self, t: f32) -> [f32; 4] {
        let (b, c) = match self {
            Self::BSpline => (1.0, 0.0),
            Self::Mitchell => (1.0 / 3.0, 1.0 / 3.0),
            Self::CatmullRom => (0.0, 0.5),
        };
        let near = |x: f32| ((12.0 - 9.0 * b - 6.0 * c) * x - 18.0 + 12.0 * b + 6.0 * c) * x * x / 6.0 + 1.0 - b / 3.0;
        let far = |x: f32| {
            (((-b - 6.0 * c) * x + 6.0 * b + 30.0 * c) * x - 12.0 * b - 48.0 * c) * x / 6.0 + (8.0 * b + 24.0 * c) / 6.0
        };
        [far(1.0 + t), near(t), near(1.0 - t), far(2.0 - t)]
    }
}

/// sin(πx)/(πx).
#[inline]
pub fn sinc(x: f32) -> f32 {
    let x = PI * x;
    if x.abs() < 1e-4 { 1.0 } else { x.sin() / x }
}

/// Lanczos' windowed sinc with three lobes.
#[inline]
pub fn lanczos3(x: f32) -> f32 {
    if x.abs() < 3.0 { sinc(x) * sinc(x / 3.0) } else { 0.0 }
}

/// The weights of the six texels around a point that lies `t` in `[0, 1)` beyond the third, by Lanczos' kernel. They
/// are made to add up to one.
#[inline]
pub fn lanczos_weights(t: f32) -> [f32; 6] {
    let w: [f32; 6] = std::array::from_fn(|k| lanczos3(t + 2.0 - k as f32));
    let sum: f32 = w.iter().sum();
    w.map(|w| w / sum)
}

/// Texels along an axis that [`spline_weights`] weighs: beyond, weights are below 10⁻⁷.
pub const SPLINE_TAPS: usize = 24;

/// The weights of the texels around a point that lies `t` in `[0, 1)` beyond the middle one, by the cardinal cubic
/// spline.
///
/// The spline through the texels is the B-spline of their coefficients c, with `(c₋₁ + 4 c₀ + c₁)/6` the texel. That
/// filter has the inverse `−6z/(1 − z²) z^|k|` with `z = √3 − 2` (Unser, "Splines: a perfect fit for signal and image
/// processing", 1999, box 2), so that each texel weighs the sum over k of that times the kernel moved by k.
pub fn spline_weights(t: f32) -> [f32; SPLINE_TAPS] {
    let z = 3f32.sqrt() - 2.0;
    let kernel = Cubic::BSpline.weights(t);
    let before = SPLINE_TAPS as i32 / 2 - 1;
    let inverse = |k: i32| -6.0 * z / (1.0 - z * z) * z.powi(k.abs());
    let weight = |tap: i32| (0..4).map(|j| kernel[j as usize] * inverse(tap - before + 1 - j)).sum::<f32>();
    let weights: [f32; SPLINE_TAPS] = std::array::from_fn(|tap| weight(tap as i32));
    let sum: f32 = weights.iter().sum();
    weights.map(|w| w / sum)
}

/// The weights of all `n` texels of a period at a place, counted in texels from the centre of the first: Dirichlet's
/// kernel, `sin(πx)/(n sin(πx/n))` for odd n and `sin(πx)/(n tan(πx/n))` for even n, the sum of all waves of a period
/// up to half the rate.
pub fn periodic_sinc_weights(place: f32, n: usize) -> Vec<f32> {
    let place = if place.is_finite() { place.rem_euclid(n as f32) } else { 0.0 };
    let weight = |k: usize| {
        let x = std::f64::consts::PI * (f64::from(place) - k as f64);
        let (sin, cos) = (x / n as f64).sin_cos();
        // At the texel itself, and at its images a period away, the limit.
        if sin.abs() < 1e-12 {
            return 1.0;
        }
        let kernel = x.sin() / (n as f64 * sin);
        (if n.is_multiple_of(2) { kernel * cos } else { kernel }) as f32
    };
    (0..n).map(weight).collect()
}

/// Kernels by which smaller levels are made; their unit of length is the spacing of the smaller level's texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MipKernel {
    /// The mean over what a texel covers.
    Box,
    /// A Gaussian of standard deviation 1/2.
    Gaussian,
    /// Lanczos' windowed sinc with three lobes.
    Lanczos,
    /// Sinc with three lobes in a Kaiser window (α = 4).
    Kaiser,
}

/// The kernels of levels by name.
pub const MIP_KERNELS: [(&str, MipKernel); 4] = [
    ("box", MipKernel::Box),
    ("gaussian", MipKernel::Gaussian),
    ("lanczos", MipKernel::Lanczos),
    ("kaiser", MipKernel::Kaiser),
];

impl MipKernel {
    fn radius(self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Gaussian => 1.5,
            Self::Lanczos | Self::Kaiser => 3.0,
        }
    }

    fn value(self, x: f32) -> f32 {
        match self {
            Self::Box => 1.0,
            Self::Gaussian => (-2.0 * x * x).exp(),
            Self::Lanczos => lanczos3(x),
            Self::Kaiser => {
                let r = x / 3.0;
                if r.abs() < 1.0 { sinc(x) * bessel_i0(4.0 * (1.0 - r * r).sqrt()) / bessel_i0(4.0) } else { 0.0 }
            }
        }
    }

    /// For each of `to` texels that stand for `from` ones: the first of those it is made of, and their weights, which
    /// add up to one.
    pub fn taps(self, from: usize, to: usize) -> Vec<(i32, Vec<f32>)> {
        let ratio = from as f32 / to as f32;
        let taps = |i: usize| {
            let centre = (i as f32 + 0.5) * ratio;
            let (low, high) = (centre - self.radius() * ratio, centre + self.radius() * ratio);
            // Edges that fall on texel borders up to rounding take no further texel in.
            let (first, end) = ((low + 1e-4).floor() as i32, (high - 1e-4).ceil() as i32);
            let weight = |j: i32| match self {
                Self::Box => high.min(j as f32 + 1.0) - low.max(j as f32),
                _ => self.value((j as f32 + 0.5 - centre) / ratio),
            };
            let weights: Vec<f32> = (first..end).map(weight).collect();
            let sum: f32 = weights.iter().sum();
            (first, weights.into_iter().map(|w| w / sum).collect())
        };
        (0..to).map(taps).collect()
    }
}

/// The modified Bessel function of the first kind and order zero, by its power series.
fn bessel_i0(x: f32) -> f32 {
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..20 {
        term *= (x / (2.0 * k as f32)).powi(2);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_add_up_to_one_and_are_symmetric() {
        for t in [0.0, 0.125, 0.5, 0.9] {
            for cubic in [Cubic::BSpline, Cubic::Mitchell, Cubic::CatmullRom] {
                let (w, r) = (cubic.weights(t), cubic.weights(1.0 - t));
                assert!((w.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{cubic:?} {t}");
                (0..4).for_each(|k| assert!((w[k] - r[3 - k]).abs() < 1e-6));
            }
            assert!((lanczos_weights(t).iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
        assert_eq!(Cubic::CatmullRom.weights(0.0), [0.0, 1.0, 0.0, 0.0]);
        let spline = Cubic::BSpline.weights(0.0);
        [1.0, 4.0, 1.0, 0.0].iter().zip(spline).for_each(|(a, b)| assert!((a / 6.0 - b).abs() < 1e-6));
    }

    #[test]
    fn box_taps_are_overlaps() {
        assert_eq!(MipKernel::Box.taps(4, 2), [(0, vec![0.5, 0.5]), (2, vec![0.5, 0.5])]);
        // Three texels into one, and five into two: the middle one is shared.
        let five = MipKernel::Box.taps(5, 2);
        assert_eq!((five[0].0, five[1].0), (0, 2));
        five[0].1.iter().zip([0.4, 0.4, 0.2]).for_each(|(a, b)| assert!((a - b).abs() < 1e-6));
        five[1].1.iter().zip([0.2, 0.4, 0.4]).for_each(|(a, b)| assert!((a - b).abs() < 1e-6));
    }
}
