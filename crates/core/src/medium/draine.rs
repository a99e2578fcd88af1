//! Draine's phase function, and fog and clouds made of it.
//!
//! `p(c) = (1 − g²)/(4π (1 + g² − 2gc)^{3/2}) · (1 + α c²)/(1 + α (1 + 2g²)/3)` over the cosine c of the deflection
//! (Draine 2003, "Scattering by Interstellar Dust Grains. I"): Henyey and Greenstein's for α = 0, Rayleigh's for
//! g = 0 and α = 1, Cornette and Shanks's for α = 1.

use super::{Lobe, Phase};
use std::f64::consts::PI;

/// Draine's phase function.
#[derive(Clone, Copy, Debug)]
pub struct Draine {
    g: f64,
    alpha: f64,
}

/// Asymmetries nearer to zero count as zero: integrals are divided by their cubes.
const LEAST: f64 = 1e-3;

impl Draine {
    /// With an asymmetry in (−1, 1) and α ≥ 0.
    pub fn new(g: f64, alpha: f64) -> Self {
        Self { g: if g.abs() < LEAST { 0.0 } else { g }, alpha }
    }

    /// The value in front of `(1 + α c²)/(1 + g² − 2gc)^{3/2}`, per unit cosine.
    fn scale(&self) -> f64 {
        let g2 = self.g * self.g;
        0.5 * (1.0 - g2) / (1.0 + self.alpha * (1.0 + 2.0 * g2) / 3.0)
    }

    /// The density per unit cosine.
    fn density(&self, cos: f64) -> f64 {
        let d = 1.0 + self.g * self.g - 2.0 * self.g * cos;
        self.scale() * (1.0 + self.alpha * cos * cos) / (d * d.sqrt())
    }

    /// The value, 1/sr.
    pub(super) fn value(&self, cos: f32) -> f32 {
        (self.density(cos.into()) / (2.0 * PI)) as f32
    }

    /// An integral of the density over the cosine, up to a constant.
    fn integral(&self, cos: f64) -> f64 {
        let (g, alpha) = (self.g, self.alpha);
        if g == 0.0 {
            return self.scale() * (cos + alpha * cos.powi(3) / 3.0);
        }
        // With D = 1 + g² − 2gc: ∫ D^{-3/2} dc = D^{-1/2}/g, and c² = (1 + g² − D)²/(4g²).
        let a = 1.0 + g * g;
        let root = (a - 2.0 * g * cos).sqrt();
        let square = (2.0 * a * a / root + 4.0 * a * root - 2.0 / 3.0 * root.powi(3)) / (8.0 * g.powi(3));
        self.scale() * (1.0 / (root * g) + alpha * square)
    }

    /// The cosine up to which the integral is `u`: Newton's steps within an interval that shrinks.
    pub(super) fn invert(&self, u: f32) -> f32 {
        let begin = self.integral(-1.0);
        let (mut low, mut high, mut cos) = (-1.0, 1.0, 0.0);
        for _ in 0..64 {
            let off = self.integral(cos) - begin - f64::from(u);
            if off > 0.0 {
                high = cos
            } else {
                low = cos
            }
            let next = cos - off / self.density(cos);
            let next = if low < next && next < high { next } else { 0.5 * (low + high) };
            if (next - cos).abs() < 1e-9 {
                break;
            }
            cos = next;
        }
        cos as f32
    }

    /// The asymmetry of the Henyey and Greenstein factor.
    pub(super) fn asymmetry(&self) -> f32 {
        self.g as f32
    }
}

impl Phase {
    /// Droplets of water of a diameter of 5 to 50 µm, under white light: a sum of Henyey and Greenstein's function and
    /// Draine's that was fitted to Mie's theory (Jendersie, d'Eon 2023, "An Approximate Mie Scattering Function for
    /// Fog and Cloud Rendering", eqs. 4 to 7).
    pub fn droplets(diameter: f64) -> Self {
        let d = diameter;
        let forwards = (-0.099_056_7 / (d - 1.671_54)).exp();
        let g = (-2.206_79 / (d + 3.910_29) - 0.428_934).exp();
        let alpha = (3.624_89 - 8.292_88 / (d + 5.528_25)).exp();
        let weight = (-0.599_085 / (d - 0.641_583) - 0.665_888).exp() as f32;
        let of_draine = Self::of(Lobe::Draine(Draine::new(g, alpha)));
        Self::sum(&[(1.0 - weight, Self::HenyeyGreenstein(forwards as f32)), (weight, of_draine)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::warp::hg_phase;

    /// Henyey and Greenstein's and Rayleigh's are cases of it; `value` takes the cosine of the deflection.
    #[test]
    fn special_cases() {
        for k in -10..=10 {
            let cos = k as f32 / 10.0;
            for g in [-0.6, 0.0, 0.3, 0.9] {
                let (found, expected) = (Draine::new(g, 0.0).value(cos), hg_phase(-cos, g as f32));
                assert!((found / expected - 1.0).abs() < 1e-5, "{g} at {cos}: {found}, {expected}");
            }
            let rayleigh = 3.0 / (16.0 * PI) * (1.0 + f64::from(cos * cos));
            assert!((f64::from(Draine::new(0.0, 1.0).value(cos)) / rayleigh - 1.0).abs() < 1e-6);
        }
    }

    /// The integral ends at one, and inverting it gives the cosine back, for sharp lobes, too.
    #[test]
    fn inversion() {
        for (g, alpha) in [(0.0, 1.0), (0.002, 30.0), (0.5, 0.0), (0.6, 25.0), (-0.9, 1.0), (0.999, 4.0)] {
            let draine = Draine::new(g, alpha);
            let whole = draine.integral(1.0) - draine.integral(-1.0);
            assert!((whole - 1.0).abs() < 1e-5, "{g}, {alpha}: {whole}");
            for u in [0.0, 1e-3, 0.25, 0.5, 0.9, 0.999] {
                let cos = f64::from(draine.invert(u));
                let back = draine.integral(cos) - draine.integral(-1.0);
                let step = draine.density(cos) * f64::from(f32::EPSILON);
                assert!((back - f64::from(u)).abs() < 1e-5 + step, "{g}, {alpha}: {u} gives {cos}, which is {back}");
            }
        }
    }
}
