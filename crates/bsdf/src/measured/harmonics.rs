//! Isotropic reflection projected onto spherical harmonics: smooth, small, and fast where only soft lighting counts.
//!
//! For each angle of the viewer `f·cosθ_i` over the sphere of light directions is a sum of real spherical harmonics,
//! `Σ c_lm(θ_o) y_lm(ω_i)`, the viewer at azimuth zero. By the mirror symmetry of isotropic materials only `m ≥ 0`
//! remains. Kautz, Sloan, Snyder, "Fast, Arbitrary BRDF Shading for Low-Frequency Lighting Using Spherical Harmonics"
//! (2002). Sums that fall below zero are held there.

use steradian_math::{
    Vec3,
    harmonics::{self, MAX_DEGREE},
};

/// Angles of the viewer that are projected.
const VIEWS: usize = 32;
/// Quadrature in cosine and azimuth.
const COSINES: usize = 48;
const AZIMUTHS: usize = 96;

/// A projection.
#[derive(Clone, Debug)]
pub struct Harmonics {
    degree: usize,
    /// `[view][coefficient with m ≥ 0]`.
    coefficients: Vec<Vec3>,
}

impl Harmonics {
    /// Projects `f(wo, wi)` (sr⁻¹) up to a degree.
    pub fn project(degree: usize, f: impl Fn(Vec3, Vec3) -> Vec3) -> Self {
        let degree = degree.min(MAX_DEGREE);
        let count = (degree + 1) * (degree + 2) / 2;
        let mut coefficients = vec![Vec3::ZERO; VIEWS * count];
        let nodes = steradian_math::quadrature::gauss_legendre(COSINES);
        // Project the slice of each view: c_lm = ∫ f cos θ_i y_lm dω, by Gauss–Legendre nodes in the cosine.
        for (view, sums) in coefficients.chunks_exact_mut(count).enumerate() {
            let mu = (view as f32 + 0.5) / VIEWS as f32;
            let wo = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
            for (x, w) in &nodes {
                let z = (0.5 * (x + 1.0)) as f32;
                for a in 0..AZIMUTHS {
                    let phi = (a as f32 + 0.5) / AZIMUTHS as f32 * std::f32::consts::TAU;
                    let sin = (1.0 - z * z).sqrt();
                    let wi = Vec3::new(sin * phi.cos(), sin * phi.sin(), z);
                    // Solid angle of the node.
                    let area = (0.5 * w * std::f64::consts::TAU / AZIMUTHS as f64) as f32;
                    let value = f(wo, wi) * (z * area);
                    harmonics::visit(degree, wi, |l, m, y| {
                        // Orders below zero vanish by mirror symmetry.
                        if let Ok(m) = usize::try_from(m) {
                            sums[l * (l + 1) / 2 + m] += value * y;
                        }
                    });
                }
            }
        }
        Self { degree, coefficients }
    }

    /// `f·cosθ_i` in linear RGB; both directions above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        let count = (self.degree + 1) * (self.degree + 2) / 2;
        // Interpolate linearly between the views on either side.
        let x = (wo.z.clamp(0.0, 1.0) * VIEWS as f32 - 0.5).clamp(0.0, (VIEWS - 1) as f32);
        let low = (x as usize).min(VIEWS - 2);
        let (a, b) = (&self.coefficients[low * count..][..count], &self.coefficients[(low + 1) * count..][..count]);
        let t = x - low as f32;
        // The viewer's azimuth becomes zero.
        let r = wo.x.hypot(wo.y);
        let (c, s) = if r > 0.0 { (wo.x / r, wo.y / r) } else { (1.0, 0.0) };
        let w = Vec3::new(c * wi.x + s * wi.y, c * wi.y - s * wi.x, wi.z);
        // Sum of c_lm y_lm at the turned direction, held at zero where the truncated series rings.
        let mut sum = Vec3::ZERO;
        harmonics::visit(self.degree, w, |l, m, y| {
            if let Ok(m) = usize::try_from(m) {
                let i = l * (l + 1) / 2 + m;
                sum += a[i].lerp(b[i], t) * y;
            }
        });
        sum.max(Vec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lobe_that_is_a_low_harmonic_comes_back() {
        let f = |_: Vec3, wi: Vec3| Vec3::new(0.2, 0.1 + 0.05 * wi.z, 0.3);
        let sh = Harmonics::project(MAX_DEGREE, f);
        let (wo, mut worst) = (Vec3::new(0.6, 0.0, 0.8), 0.0f32);
        for i in 0..50 {
            let z = 0.15 + 0.8 * i as f32 / 50.0;
            let wi = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
            worst = worst.max((sh.eval(wo, wi) - f(wo, wi) * z).abs().max_element());
        }
        // The clamped cosine is not band-limited: its error at degree 10 is below a hundredth.
        assert!(worst < 0.01, "{worst}");
    }
}
