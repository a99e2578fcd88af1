//! The thin variant of Disney's surface (Burley 2015, "Extending the Disney BRDF to a BSDF with Integrated Subsurface
//! Scattering", 5.2 and 5.3), as Mitsuba 3's `principledthin`: a sheet that light passes without being bent, the same
//! from both sides. With `t` = spec_trans and `d` = diff_trans/2:
//!
//! ```text
//! reflection    t F D G / (4 cosθ_o cosθ_i)  +  (1−t)(1−d) (diffuse + sheen)
//! transmission  t base (1−F) D' G' / (4 cosθ_o cosθ_i)  +  (1−t) d base/π
//! ```
//!
//! where transmission is mirrored to the other side and its roughness scaled by `0.65 η − 0.35`.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, Microfacet, TransportMode, fresnel,
    principled::{DisneyDiffuse, PrincipledParams, plain, schlick_from, stretched},
    registry::{Case, Model, Visitor},
    sample_cosine_hemisphere,
    scatter::Scatter,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3};

/// The sheet at a point.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThin {
    diffuse: DisneyDiffuse,
    /// Tinted reflectance at the normal.
    f0_tint: Spectrum,
    spec_tint: f32,
    reflecting: Microfacet,
    transmitting: Microfacet,
    eta: f32,
    spec_trans: f32,
    /// The part of the diffuse light that goes through.
    diff_trans: f32,
}

impl PrincipledThin {
    /// The sheet of `p`, whose metal and clear coat have no meaning here; `diff_trans` in [0, 2] (clamped).
    pub fn new(p: &PrincipledParams, diff_trans: f32) -> Self {
        let unit = |v: f32| if v > 0.0 { v.min(1.0) } else { 0.0 };
        let eta = if p.eta > 1e-3 { p.eta.min(1e3) } else { 1.5 };
        let (roughness, anisotropic) = (unit(p.roughness), unit(p.anisotropic));
        Self {
            diffuse: p.diffuse(),
            f0_tint: (p.tint * fresnel::f0_from_eta(eta)).clamp(0.0, 1.0),
            spec_tint: unit(p.spec_tint),
            reflecting: stretched(roughness, anisotropic),
            transmitting: stretched((0.65 * eta - 0.35) * roughness, anisotropic),
            eta,
            spec_trans: unit(p.spec_trans),
            diff_trans: unit(0.5 * diff_trans),
        }
    }

    /// A sheet that nothing passes is left to the caller on its lower side, as every model that only reflects.
    fn is_seen_from(&self, wo: Vec3) -> bool {
        wo.z > 0.0 || (wo.z < 0.0 && self.transmits())
    }

    /// The probabilities of specular reflection, specular transmission and diffuse reflection; what is left is diffuse
    /// transmission.
    fn chances(&self) -> [f32; 3] {
        let (t, d) = (self.spec_trans, self.diff_trans);
        [0.5 * t, 0.5 * t, (1.0 - t) * (1.0 - d)]
    }

    /// The directions seen with `wo` on the upper side.
    fn turned(wo: Vec3, w: Vec3) -> Vec3 {
        if wo.z < 0.0 { -w } else { w }
    }
}

impl Scatter for PrincipledThin {
    const ALBEDO_BOUND: f32 = super::Principled::ALBEDO_BOUND;
    const MODELS: &'static [Model] = &[Model::new("principled-thin", "Disney's thin sheet", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if !self.is_seen_from(wo) {
            return BsdfEval::ZERO;
        }
        let (wo, wi) = (Self::turned(wo, wo), Self::turned(wo, wi));
        let [reflected, transmitted, diffuse] = self.chances();
        let (t, d) = (self.spec_trans, self.diff_trans);
        let mut e = BsdfEval::ZERO;
        if wi.z > 0.0 {
            let mirror = self.reflecting.mirror(wo, wi);
            if t > 0.0
                && let Some(facet) = self.reflecting.reflecting_by(&mirror, wo, wi)
            {
                let plain = Spectrum::splat(fresnel::Crossing::by_square(mirror.cos2, self.eta).reflectance);
                let tinted = schlick_from(self.f0_tint, facet.cos_o, self.eta);
                e.value = (plain + (tinted - plain) * self.spec_tint) * (t * facet.value);
                e.pdf = reflected * facet.pdf;
            }
            let (base, sheen) = self.diffuse.eval(wo, wi, mirror.cos2);
            e.value += (base + sheen) * ((1.0 - t) * (1.0 - d));
            e.pdf += diffuse * FRAC_1_PI * wi.z;
        } else if wi.z < 0.0 {
            let mirrored = Vec3::new(wi.x, wi.y, -wi.z);
            if t > 0.0
                && let Some(facet) = self.transmitting.reflecting(wo, mirrored)
            {
                let f = fresnel::dielectric(facet.cos_o, self.eta);
                e.value = self.diffuse.base * (t * (1.0 - f) * facet.value);
                e.pdf = transmitted * facet.pdf;
            }
            let lambert = FRAC_1_PI * mirrored.z;
            e.value += self.diffuse.base * ((1.0 - t) * d * lambert);
            e.pdf += (1.0 - reflected - transmitted - diffuse).max(0.0) * lambert;
        }
        e
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if !self.is_seen_from(wo) {
            return None;
        }
        let above = Self::turned(wo, wo);
        let [reflected, transmitted, diffuse] = self.chances();
        let (wi, lobe) = if u < reflected {
            let wi = self.reflecting.draw(above, u2).mirrored(above);
            (wi, Lobe::REFLECTION.with(Lobe::GLOSSY))
        } else if u < reflected + transmitted {
            let wi = self.transmitting.draw(above, u2).mirrored(above);
            (Vec3::new(wi.x, wi.y, -wi.z), Lobe::TRANSMISSION.with(Lobe::GLOSSY))
        } else if u < reflected + transmitted + diffuse {
            (sample_cosine_hemisphere(u2)?, Lobe::REFLECTION.with(Lobe::DIFFUSE))
        } else {
            (-sample_cosine_hemisphere(u2)?, Lobe::TRANSMISSION.with(Lobe::DIFFUSE))
        };
        let wi = Self::turned(wo, wi);
        if (wo.z * wi.z < 0.0) != lobe.is_transmission() {
            return None;
        }
        let e = self.eval(wo, wi, TransportMode::Radiance);
        e.drawn(wi, lobe, 1.0)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let f = Spectrum::splat(fresnel::dielectric(wo.z.abs(), self.eta));
        let sheet = f + (Spectrum::ONE - f) * self.diffuse.base;
        (sheet * self.spec_trans + self.diffuse.base * (1.0 - self.spec_trans)).clamp(0.0, 1.0)
    }

    fn transmits(&self) -> bool {
        self.spec_trans > 0.0 || self.diff_trans > 0.0
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, params: PrincipledParams, diff_trans| {
        let bsdf = Bsdf::PrincipledThin(PrincipledThin::new(&params, diff_trans));
        visit(Case { label, bsdf, lossless: false });
    };
    let p = plain();
    case("paper", p, 0.8);
    case("opaque", PrincipledParams { sheen: 0.5, ..p }, 0.0);
    case("pane", PrincipledParams { spec_trans: 1.0, roughness: 0.5, ..p }, 0.0);
    case("leaf", PrincipledParams { spec_trans: 0.3, spec_tint: 0.5, anisotropic: 0.5, flatness: 0.5, ..p }, 1.2);
}
