//! The sheen of cloth: fibres that stand up from the surface (Estevez, Kulla 2017, "Production Friendly Microfacet
//! Sheen BRDF"; the `Charlie` sheen of glTF's KHR_materials_sheen, whose α is the square of the roughness).
//!
//! ```text
//! f = D G / (4 cosθ_o cosθ_i),   D = (2 + 1/α) sin^{1/α}θ_h / 2π,   G = 1/(1 + Λ(θ_o) + Λ(θ_i))
//! Λ = exp L(cosθ) below 60° from grazing, exp(2 L(½) − L(1 − cosθ)) above;  L(x) = a/(1 + b x^c) + d x + e
//! ```
//!
//! with the five numbers interpolated by `(1 − α)²` between the two fits of the paper's table 1.

use std::f32::consts::TAU;
use steradian_math::{
    Vec3,
    elementary::{exp, pow},
};

/// Below it the distribution is too narrow about the horizon for `f32`; α is raised to it.
pub(super) const MIN_ALPHA: f32 = 0.02;

fn lambda(alpha: f32, cos: f32) -> f32 {
    const SHARP: [f32; 5] = [25.3245, 3.32435, 0.16801, -1.27393, -4.85967];
    const ROUGH: [f32; 5] = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054];
    let t = (1.0 - alpha) * (1.0 - alpha);
    let [a, b, c, d, e]: [f32; 5] = std::array::from_fn(|i| ROUGH[i] + (SHARP[i] - ROUGH[i]) * t);
    let l = |x: f32| a / (1.0 + b * pow(x, c)) + d * x + e;
    exp(if cos < 0.5 { l(cos) } else { 2.0 * l(0.5) - l(1.0 - cos) })
}

/// `f cosθ_i` of white sheen for directions on the upper side; `alpha` in `[MIN_ALPHA, 1]`.
#[inline]
pub(super) fn value(alpha: f32, wo: Vec3, wi: Vec3) -> f32 {
    let Some(h) = (wo + wi).try_normalize() else { return 0.0 };
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return 0.0;
    }
    let inv = 1.0 / alpha;
    let d = (2.0 + inv) * pow((1.0 - h.z * h.z).max(0.0), 0.5 * inv) / TAU;
    let g = 1.0 / (1.0 + lambda(alpha, wo.z) + lambda(alpha, wi.z));
    let value = d * g / (4.0 * wo.z.max(1e-6));
    if value.is_finite() { value } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_testkit::SphereGrid;

    #[test]
    fn the_distribution_covers_the_surface_once() {
        // ∫ D cosθ dω = 1, seen as D = 4 f cosθ_o / G at the mirrored pair.
        for alpha in [0.05, 0.3, 1.0f32] {
            let inv = 1.0 / alpha;
            let d = |m: Vec3| f64::from((2.0 + inv) * (1.0 - m.z * m.z).max(0.0).powf(0.5 * inv) / TAU * m.z.max(0.0));
            let sum: f64 = SphereGrid { bands: 64, sectors: 4 }.integrate(d, 1e-6).iter().sum();
            assert!((sum - 1.0).abs() < 2e-3, "{alpha}: {sum}");
        }
    }

    #[test]
    fn sheen_shines_at_grazing_angles() {
        let at = |z: f32| Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
        let back = |z: f32| value(0.25, at(z), at(z)) / z;
        assert!(back(0.1) > 4.0 * back(0.9) && back(0.9) >= 0.0);
    }
}
