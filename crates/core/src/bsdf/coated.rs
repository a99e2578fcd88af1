//! A dielectric coat over a Lambertian base: plastic, varnish, lacquer.
//!
//! Light that enters the coat reaches the base with probability `T(wo)`, is scattered diffusely, and each time leaves or is
//! thrown back with probability `K`. Summing all orders, with `T` by reciprocity for the way out,
//!
//! ```text
//! f = f_interface + T(wo)·T(wi)/(π η²) · ρ/(1 − ρK)
//! ```
//!
//! which is the expectation of pbrt-v4's random walk for `coateddiffuse` (Pharr et al. 2023, 14.3) and the model of Mitsuba's
//! `plastic` and `roughplastic`; [`CoatSeries`](super::CoatSeries) says where the two differ. `T`, `K` and the absorption in
//! the coat come from a [`CoatTable`].
//!
//! Where it departs: pbrt-v4's *evaluation* of a rough coat (not its sampling) weighs its two strategies by densities that
//! are measured on different sides of the interface, so their weights do not add up to one and the value comes out too
//! high: by 0.2 to 1 % at roughness 0.01, 2 to 9 % at 0.1, 6 to 13 % above 0.3. This model is the walk's true expectation. An
//! anisotropic coat uses the tables of its mean roughness; its interface reflection is exact.

use super::coat_table::RowPlace;
use super::microfacet::facet_cosine;
use super::{BsdfEval, BsdfSample, CoatTable, Lobe, Microfacet, fresnel};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3, warp::cosine_hemisphere};

/// A coated diffuse surface.
#[derive(Clone, Copy, Debug)]
pub struct Coated<'a> {
    table: &'a CoatTable,
    /// `ρ/(1 − ρK)/η²`.
    base: Spectrum,
    /// Factor on the light that the interface reflects.
    tint: Spectrum,
    microfacet: Microfacet,
    place: RowPlace,
    /// The part of diffuse light inside that leaves, times the largest lane of `base`; for choosing a lobe.
    base_weight: f32,
}

impl<'a> Coated<'a> {
    /// A base of albedo `reflectance` (clamped to `[0, 1]`) under the coat of `table` with roughness `alpha_x`, `alpha_y`,
    /// which should lie in the table's range; `tint` is a factor on what the coat itself reflects (1 is physical).
    pub fn new(table: &'a CoatTable, reflectance: Spectrum, tint: Spectrum, alpha_x: f32, alpha_y: f32) -> Self {
        let microfacet = table.microfacet(alpha_x, alpha_y);
        let place = table.place(&microfacet);
        let eta2 = table.eta() * table.eta();
        let base = table.multiply_scattered(place, reflectance.clamp(0.0, 1.0)) / eta2;
        let base_weight = base.max_element() * table.mean_transmitted(place);
        Self { table, base, tint, microfacet, place, base_weight }
    }

    /// `R` and `T` of the coat at `wo`, and the probability of sampling the interface.
    #[inline]
    fn at(&self, wo: Vec3) -> (f32, f32, f32) {
        let (r, t) = self.table.interface(self.place, wo.z);
        let (interface, base) = (r * self.tint.max_element(), t * self.base_weight);
        (r, t, if interface + base > 0.0 { interface / (interface + base) } else { 0.0 })
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let (_, t_o, p) = self.at(wo);
        self.eval_at(wo, wi, t_o, p, facet_cosine(wo, wi))
    }

    /// The value where the interface lets `t_o` pass along `wo` and is sampled with probability `p`, with the cosine at the facet.
    #[inline]
    fn eval_at(&self, wo: Vec3, wi: Vec3, t_o: f32, p: f32, cos: f32) -> BsdfEval {
        if wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let (_, t_i) = self.table.interface(self.place, wi.z);
        let cosine = wi.z * FRAC_1_PI;
        let mut e = BsdfEval { value: self.base * (t_o * t_i * cosine), pdf: (1.0 - p) * cosine };
        if !self.microfacet.is_smooth()
            && let Some(facet) = self.microfacet.reflecting_at(cos, wo, wi)
        {
            e.value += self.tint * (fresnel::dielectric(cos, self.table.eta()) * facet.value);
            e.pdf += p * facet.pdf;
        }
        e
    }

    pub(super) fn sample(&self, wo: Vec3, u: f32, u2: Vec2) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (r, t_o, p) = self.at(wo);
        let (wi, cos, lobe) = if u >= p {
            let wi = cosine_hemisphere(u2);
            (wi, facet_cosine(wo, wi), Lobe::DIFFUSE)
        } else if self.microfacet.is_smooth() {
            return Some(BsdfSample::mirrored(wo, self.tint * (r / p), p));
        } else {
            let n = self.microfacet.draw(wo, u2);
            (n.mirrored(wo), n.cos_o, Lobe::GLOSSY)
        };
        self.eval_at(wo, wi, t_o, p, cos).drawn_above(wi, Lobe::REFLECTION.with(lobe))
    }

    pub(super) fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let (r, t) = self.table.interface(self.place, wo.z.abs());
        self.tint * r + self.base * (t * self.table.mean_transmitted(self.place))
    }
}
