//! Microfacet surfaces: the distribution of normals, masking and shadowing, and what a mirror or a refracting interface made
//! of such facets does to light (Walter et al. 2007; Heitz 2014).
//!
//! `D` is normalised by `∫ D(m) cosθ_m dm = 1`. With the stretched slopes `s = tan²θ_m (cos²φ/α_x² + sin²φ/α_y²)`:
//!
//! ```text
//! GGX       D = 1 / (π α_x α_y cos⁴θ_m (1 + s)²)      Λ = (√(1 + a⁻²) − 1)/2
//! Beckmann  D = exp(−s) / (π α_x α_y cos⁴θ_m)         Λ = (erf(a) − 1)/2 + exp(−a²)/(2a√π)
//! ```
//!
//! where `1/a = α(φ)·tanθ` for the direction that is masked, and `G₁ = 1/(1 + Λ)`.

use super::gaussian::erf;
use super::visible_normals;
use std::f32::consts::PI;
use steradian_math::{Vec2, Vec3};

/// The shape of the distribution of facet normals.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum NormalDistribution {
    /// Trowbridge–Reitz (1975), known as GGX: long tails.
    Ggx,
    /// Beckmann (1963): Gaussian slopes.
    Beckmann,
}

/// How masking and shadowing combine into `G₂`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Shadowing {
    /// `1/(1 + Λ(wo) + Λ(wi))`: high facets are both visible and lit (Heitz 2014, eq. 99); pbrt-v4's choice.
    HeightCorrelated,
    /// `G₁(wo)·G₁(wi)` (Walter et al. 2007, eq. 23); Mitsuba's choice.
    Separable,
}

/// A rough surface. Roughness values are those of the distributions above (the root-mean-square slope of Beckmann is `α/√2`).
#[derive(Clone, Copy, Debug)]
pub struct Microfacet {
    alpha_x: f32,
    alpha_y: f32,
    distribution: NormalDistribution,
    shadowing: Shadowing,
}

/// A facet that carries light from `wi` to `wo`, for unit Fresnel factor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// `wo·m`, negative when `wo` lies below the facet.
    pub cos_o: f32,
    /// `f·|cosθ_i| / F` with `F` the reflected or transmitted fraction.
    pub value: f32,
    /// Density of `wi` when `m` is drawn by [`Microfacet::sample_visible`].
    pub pdf: f32,
}

impl Microfacet {
    /// A mirror-like surface without roughness.
    pub const SMOOTH: Self = Self {
        alpha_x: 0.0,
        alpha_y: 0.0,
        distribution: NormalDistribution::Ggx,
        shadowing: Shadowing::HeightCorrelated,
    };

    /// Below this roughness in both directions the surface counts as smooth (pbrt-v4's threshold).
    pub const SMOOTH_BELOW: f32 = 1e-3;

    /// A surface of roughness `alpha_x` along the tangent and `alpha_y` along the bitangent, each in `[0, 16]` (clamped;
    /// NaN counts as 0). Where only one of them is smaller than 10⁻⁴ it is raised to that.
    pub fn new(distribution: NormalDistribution, shadowing: Shadowing, alpha_x: f32, alpha_y: f32) -> Self {
        let in_range = |alpha: f32| if alpha > 0.0 { alpha.min(16.0) } else { 0.0 };
        let mut m = Self { alpha_x: in_range(alpha_x), alpha_y: in_range(alpha_y), distribution, shadowing };
        if !m.is_smooth() {
            m.alpha_x = m.alpha_x.max(1e-4);
            m.alpha_y = m.alpha_y.max(1e-4);
        }
        m
    }

    /// GGX with height-correlated shadowing.
    pub fn ggx(alpha_x: f32, alpha_y: f32) -> Self {
        Self::new(NormalDistribution::Ggx, Shadowing::HeightCorrelated, alpha_x, alpha_y)
    }

    /// Whether the surface scatters as a delta distribution.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.alpha_x.max(self.alpha_y) < Self::SMOOTH_BELOW
    }

    /// The isotropic roughness with the same area of the slope ellipse, `√(α_x α_y)`.
    pub fn mean_alpha(&self) -> f32 {
        (self.alpha_x * self.alpha_y).sqrt()
    }

    /// `D(m)`, for `m` in the upper hemisphere (sr⁻¹).
    #[inline]
    pub fn d(&self, m: Vec3) -> f32 {
        let (x, y) = (m.x / self.alpha_x, m.y / self.alpha_y);
        let (slopes, cos2) = (x * x + y * y, m.z * m.z);
        let area = PI * self.alpha_x * self.alpha_y;
        match self.distribution {
            NormalDistribution::Ggx => {
                let q = slopes + cos2;
                1.0 / (area * q * q)
            }
            NormalDistribution::Beckmann => {
                if cos2 < 1e-10 {
                    return 0.0;
                }
                (-slopes / cos2).exp() / (area * cos2 * cos2)
            }
        }
    }

    /// Smith's `Λ(w)`: masked over visible facet area.
    #[inline]
    pub fn lambda(&self, w: Vec3) -> f32 {
        let (x, y, z2) = (self.alpha_x * w.x, self.alpha_y * w.y, w.z * w.z);
        if z2 == 0.0 {
            return f32::INFINITY;
        }
        let inv_a2 = (x * x + y * y) / z2;
        match self.distribution {
            NormalDistribution::Ggx => 0.5 * ((1.0 + inv_a2).sqrt() - 1.0),
            NormalDistribution::Beckmann => {
                // Beyond a = 4 less than 10⁻⁸ is masked, and the two terms cancel.
                if inv_a2 < 1.0 / 16.0 {
                    return 0.0;
                }
                let a = 1.0 / inv_a2.sqrt();
                (0.5 * (erf(a) - 1.0) + (-a * a).exp() / (2.0 * PI.sqrt() * a)).max(0.0)
            }
        }
    }

    /// The fraction `G₁(w)` of the facets that `w` sees.
    #[inline]
    pub fn g1(&self, w: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// The fraction of the facets that both directions see; they may lie on different sides.
    #[inline]
    pub fn g2(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.g2_from(self.lambda(wo), self.lambda(wi))
    }

    #[inline]
    fn g2_from(&self, lambda_o: f32, lambda_i: f32) -> f32 {
        match self.shadowing {
            Shadowing::HeightCorrelated => 1.0 / (1.0 + lambda_o + lambda_i),
            Shadowing::Separable => 1.0 / ((1.0 + lambda_o) * (1.0 + lambda_i)),
        }
    }

    /// Density of the normals that `w` sees, `D_w(m) = G₁(w) |w·m| D(m) / |cosθ_w|` (sr⁻¹).
    #[inline]
    pub fn d_visible(&self, w: Vec3, m: Vec3) -> f32 {
        if w.z == 0.0 {
            return 0.0;
        }
        self.g1(w) * w.dot(m).abs() * self.d(m) / w.z.abs()
    }

    /// Draws a normal that `w` sees with the density [`Microfacet::d_visible`]; `w` may lie on either side, the normal is in
    /// the upper hemisphere.
    #[inline]
    pub fn sample_visible(&self, w: Vec3, u: Vec2) -> Vec3 {
        // The distribution with unit roughness is sampled for the stretched direction; the normal is stretched back.
        let w = if w.z < 0.0 { -w } else { w };
        let stretched = Vec3::new(self.alpha_x * w.x, self.alpha_y * w.y, w.z).normalize_or(Vec3::Z);
        let m = match self.distribution {
            NormalDistribution::Ggx => visible_normals::sample_ggx(stretched, u),
            NormalDistribution::Beckmann => visible_normals::sample_beckmann(stretched, u),
        };
        Vec3::new(self.alpha_x * m.x, self.alpha_y * m.y, m.z.max(1e-6)).normalize_or(Vec3::Z)
    }

    /// The facet that mirrors `wi` into `wo`; both must be on one side.
    #[inline]
    pub(super) fn reflecting(&self, wo: Vec3, wi: Vec3) -> Option<Facet> {
        if wo.z * wi.z <= 0.0 {
            return None;
        }
        self.reflecting_at(upper(wo + wi)?, wo, wi)
    }

    /// Reflection by the facet `m`: `f cosθ_i = F D G₂ / (4 |cosθ_o|)`.
    #[inline]
    pub(super) fn reflecting_at(&self, m: Vec3, wo: Vec3, wi: Vec3) -> Option<Facet> {
        if wo.z * wi.z <= 0.0 {
            return None;
        }
        self.facet(wo, wi, wo.dot(m), self.d(m) / (4.0 * wo.z.abs()))
    }

    /// The facet that refracts `wi` into `wo`, which must be on different sides; `eta = η_t/η_i` from the side of `wo` to the
    /// side of `wi`.
    #[inline]
    pub(super) fn refracting(&self, wo: Vec3, wi: Vec3, eta: f32) -> Option<Facet> {
        if wo.z * wi.z >= 0.0 {
            return None;
        }
        self.refracting_at(upper(wo + eta * wi)?, wo, wi, eta)
    }

    /// Refraction by the facet `m` (Walter et al. 2007, eq. 21), for the transport of importance.
    #[inline]
    pub(super) fn refracting_at(&self, m: Vec3, wo: Vec3, wi: Vec3, eta: f32) -> Option<Facet> {
        let (cos_o, cos_i) = (wo.dot(m), wi.dot(m));
        // A facet cannot be seen from behind.
        if wo.z * wi.z >= 0.0 || cos_o * wo.z <= 0.0 || cos_i * wi.z <= 0.0 {
            return None;
        }
        let denominator = cos_i + cos_o / eta;
        let jacobian = cos_i.abs() / (denominator * denominator);
        self.facet(wo, wi, cos_o, self.d(m) * cos_o.abs() * jacobian / wo.z.abs())
    }

    /// The facet whose visible density, but for masking, is `unmasked`; a density that vanishes or overflows (a grazing
    /// direction) carries nothing.
    #[inline]
    fn facet(&self, wo: Vec3, wi: Vec3, cos_o: f32, unmasked: f32) -> Option<Facet> {
        let (lambda_o, lambda_i) = (self.lambda(wo), self.lambda(wi));
        let (value, pdf) = (unmasked * self.g2_from(lambda_o, lambda_i), unmasked / (1.0 + lambda_o));
        (pdf > 0.0 && pdf.is_finite() && value.is_finite()).then_some(Facet { cos_o, value, pdf })
    }
}

/// The direction of `v` or `−v` that points up.
#[inline]
fn upper(v: Vec3) -> Option<Vec3> {
    let m = v.try_normalize()?;
    Some(if m.z < 0.0 { -m } else { m })
}
