//! Disney's "principled" surface (Burley 2012, "Physically-Based Shading at Disney"; Burley 2015, "Extending the Disney
//! BRDF to a BSDF with Integrated Subsurface Scattering"), with the lobes and weights of Mitsuba 3's `principled`. With
//! `m` = metallic, `t` = spec_trans, `h` the half-vector, `θ_d` the angle between it and the light, and Schlick's
//! weight `S(c) = (1 − c)⁵`:
//!
//! ```text
//! f = (1−m)(1−t) base/π · lerp(f_d + f_r, f_ss, flatness)       diffuse, Burley 2012, 5.3 and 2015, eq. 4
//!   + (1−m) sheen · S(cosθ_d)                                     2012, 5.2
//!   + F D_GGX G / (4 cosθ_o cosθ_i)                               specular: F of metal, tinted and plain dielectric
//!   + clearcoat/4 · F_0.04 D_GTR1 G_0.25                          2012, 5.4
//!   + (1−m) t √base (1−F) · refraction by the same microfacets    2015, 5.1
//! f_d = (1 − S_o/2)(1 − S_i/2),  R = 2 roughness cos²θ_d,  f_r = R (S_o + S_i + S_o S_i (R − 1))
//! ```
//!
//! From below, where there is only the transmitting part, it is plain glass. The model is an artist's: lobes are added,
//! not layered, so that a white base reflects more than arrives at it ([`Principled::ALBEDO_BOUND`]).
//!
//! Of the diffuse part a share w may be a medium that light goes below, to leave elsewhere ([`Lobe::SUBSURFACE`])
//! (2015, 6). That keeps to energy: of light along `wo` the part
//! `(1−m)(1−t) w (1 − F − clearcoat C(wo) − (1−m) sheen A(wo))` enters through each facet in view, which is what the
//! other lobes leave. The coat's albedo C(μ) is 0.01 + 0.025 μ² within 0.003 at full gloss, and
//! `A(μ) = ∫ S(cosθ_d) cosθ_i dω_i` is 0.0885 (1 − μ)^2.5 within 0.003 (by quadrature).

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, Microfacet, NormalDistribution, Shadowing, TransportMode, fresnel, gtr1,
    microfacet::{Facet, Mirror},
    packed::Unit4,
    registry::{Case, GREY, Model, Visitor},
    sample_cosine_hemisphere,
    scatter::Scatter,
    subsurface::SubsurfacePart,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3};

/// Parameters of the diffuse part, which the thin variant has too.
#[derive(Clone, Copy, Debug)]
pub struct DisneyDiffuse {
    /// Colour, in [0, 1].
    pub base: Spectrum,
    /// Sheen times its colour.
    pub sheen: Spectrum,
    /// In [0, 1].
    pub roughness: f32,
    /// Weight of the diffuse approximation of subsurface scattering, in [0, 1].
    pub flatness: f32,
}

impl DisneyDiffuse {
    /// `f cosθ_i` of directions on one side, without the weight of the lobe: diffuse, and sheen; by the square of the
    /// cosine between either and the half vector.
    #[inline(always)]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, cos2_d: f32) -> (Spectrum, Spectrum) {
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let (s_o, s_i) = (schlick_weight(cos_o), schlick_weight(cos_i));
        let r = 2.0 * self.roughness * cos2_d;
        let smooth = (1.0 - 0.5 * s_o) * (1.0 - 0.5 * s_i) + r * (s_o + s_i + s_o * s_i * (r - 1.0));
        // Hanrahan and Krueger's shape, flattened.
        let flat = || {
            let f90 = 0.5 * r;
            let flat = (1.0 + (f90 - 1.0) * s_o) * (1.0 + (f90 - 1.0) * s_i);
            1.25 * (flat * (1.0 / (cos_o + cos_i) - 0.5) + 0.5)
        };
        let shape = if self.flatness > 0.0 { smooth + (flat() - smooth) * self.flatness } else { smooth };
        (self.base * (shape * FRAC_1_PI * cos_i), self.sheen * (schlick_weight(cos2_d.sqrt()) * cos_i))
    }
}

/// The surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct Principled {
    diffuse: DisneyDiffuse,
    /// Base colour over its luminance.
    tint: Spectrum,
    microfacet: Microfacet,
    eta: f32,
    metallic: f32,
    spec_trans: f32,
    spec_tint: f32,
    clearcoat: f32,
    clearcoat_alpha: f32,
    /// Part of the diffuse lobe whose light goes below the surface.
    below: f32,
    /// Colour of the light that comes back from there.
    below_color: Unit4,
}

/// Parameters of the surface; all but `eta` in [0, 1] (clamped).
#[derive(Clone, Copy, Debug)]
pub struct PrincipledParams {
    /// Colour of the diffuse part, of metal, and (its root) of what is transmitted.
    pub base_color: Spectrum,
    /// The base colour over its luminance: the hue of tints.
    pub tint: Spectrum,
    /// Roughness; α is its square.
    pub roughness: f32,
    /// Stretch of the highlight along the tangent.
    pub anisotropic: f32,
    /// Weight of the metal.
    pub metallic: f32,
    /// Part of the rest that transmits.
    pub spec_trans: f32,
    /// Index of refraction (> 0).
    pub eta: f32,
    /// Tint of the dielectric highlight by the hue of the base.
    pub spec_tint: f32,
    /// Strength of the sheen of cloth.
    pub sheen: f32,
    /// Tint of the sheen by the hue of the base.
    pub sheen_tint: f32,
    /// Flatness of the diffuse part.
    pub flatness: f32,
    /// Strength of the clear coat.
    pub clearcoat: f32,
    /// Gloss of the clear coat: 0 is satin, 1 gloss.
    pub clearcoat_gloss: f32,
    /// Part of the diffuse lobe that is a medium which light enters.
    pub subsurface: SubsurfacePart,
}

/// Both α of a roughness and an anisotropy (Burley 2012, 5.4), with GGX and separable masking.
pub(super) fn stretched(roughness: f32, anisotropic: f32) -> Microfacet {
    let (alpha, aspect) = (roughness * roughness, (1.0 - 0.9 * anisotropic).sqrt());
    let (x, y) = ((alpha / aspect).max(0.001), (alpha * aspect).max(0.001));
    Microfacet::new(NormalDistribution::Ggx, Shadowing::Separable, x, y)
}

/// `(1 − cosθ)⁵`.
#[inline]
pub(super) fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    m * m * m * m * m
}

/// Schlick's reflectance from `r0`, with the cosine on the side of the rarer medium.
#[inline]
pub(super) fn schlick_from(r0: Spectrum, cos: f32, eta: f32) -> Spectrum {
    let eta_it = if cos >= 0.0 { eta } else { 1.0 / eta };
    let cos = if eta_it > 1.0 { cos.abs() } else { (1.0 - (1.0 - cos * cos) / (eta_it * eta_it)).max(0.0).sqrt() };
    r0 + (Spectrum::ONE - r0) * schlick_weight(cos)
}

fn unit(v: f32) -> f32 {
    if v > 0.0 { v.min(1.0) } else { 0.0 }
}

impl PrincipledParams {
    pub(super) fn diffuse(&self) -> DisneyDiffuse {
        let hue = Spectrum::ONE + (self.tint - Spectrum::ONE) * unit(self.sheen_tint);
        DisneyDiffuse {
            base: self.base_color,
            sheen: hue * unit(self.sheen),
            roughness: unit(self.roughness),
            flatness: unit(self.flatness),
        }
    }
}

/// Weights and probabilities of the lobes for light that leaves along `wo`.
struct Weights {
    /// Weight of the diffuse lobe.
    brdf: f32,
    /// Weight of the transmitting lobe.
    bsdf: f32,
    /// Weight of the light that goes below.
    below: f32,
    /// Probabilities: diffuse, clearcoat, going below; what is left is the microfacets'.
    diffuse: f32,
    clearcoat: f32,
    entering: f32,
    specular: f32,
}

impl Principled {
    /// No case of the model that stays in its ranges and has a base of moderate hue sends back more than this part of
    /// the light.
    pub const ALBEDO_BOUND: f32 = 1.75;

    /// The surface of `p`.
    pub fn new(p: &PrincipledParams) -> Self {
        let eta = if p.eta > 1e-3 { p.eta.min(1e3) } else { 1.5 };
        let (mut diffuse, medium, share) = (p.diffuse(), &p.subsurface, unit(p.subsurface.weight));
        if share > 0.0 && !medium.is_followed {
            diffuse.base += (medium.color - diffuse.base) * share;
        }
        Self {
            diffuse,
            below: if medium.is_followed { share } else { 0.0 },
            below_color: Unit4::new(medium.color),
            tint: p.tint,
            microfacet: stretched(unit(p.roughness), unit(p.anisotropic)),
            // A transmitting interface between equal media has no half-vector.
            eta: if (eta - 1.0).abs() < 1e-3 { 1.001 } else { eta },
            metallic: unit(p.metallic),
            spec_trans: unit(p.spec_trans),
            spec_tint: unit(p.spec_tint),
            clearcoat: unit(p.clearcoat),
            clearcoat_alpha: 0.1 + (0.001 - 0.1) * unit(p.clearcoat_gloss),
        }
    }

    /// Index below relative to above.
    pub(super) fn eta(&self) -> f32 {
        self.eta
    }

    fn weights(&self, wo: Vec3) -> Option<Weights> {
        let (brdf, bsdf) = ((1.0 - self.metallic) * (1.0 - self.spec_trans), (1.0 - self.metallic) * self.spec_trans);
        if wo.z > 0.0 && self.below > 0.0 {
            let (below, brdf) = (brdf * self.below, brdf * (1.0 - self.below));
            // Sheen is drawn as the diffuse part is, where there is none, too.
            let diffuse = brdf + 0.1 * self.diffuse.sheen.max_element();
            let specular = 1.0 / (1.0 + 0.25 * self.clearcoat + diffuse + below);
            let [diffuse, clearcoat, entering] = [diffuse, 0.25 * self.clearcoat, below].map(|w| w * specular);
            Some(Weights { brdf, bsdf, below, diffuse, clearcoat, entering, specular })
        } else if wo.z > 0.0 {
            let total = 1.0 + 0.25 * self.clearcoat + brdf;
            let specular = 1.0 / total;
            let [diffuse, clearcoat] = [brdf * specular, 0.25 * self.clearcoat * specular];
            Some(Weights { brdf, bsdf, below: 0.0, diffuse, clearcoat, entering: 0.0, specular })
        } else if wo.z < 0.0 && bsdf > 0.0 {
            Some(Weights { brdf, bsdf, below: 0.0, diffuse: 0.0, clearcoat: 0.0, entering: 0.0, specular: 1.0 })
        } else {
            None
        }
    }

    /// The part of the microfacets' draws that is reflected where a facet reflects the fraction `f`.
    #[inline]
    fn reflecting_part(wo: Vec3, w: &Weights, f: f32) -> f32 {
        if wo.z > 0.0 { 1.0 - w.bsdf * (1.0 - f) } else { f }
    }

    /// Fresnel factor of the specular reflection.
    fn fresnel(&self, wo: Vec3, w: &Weights, cos: f32, f: f32) -> Spectrum {
        if wo.z < 0.0 {
            return Spectrum::splat(w.bsdf * f);
        }
        let mut sum = Spectrum::splat((1.0 - self.metallic) * (1.0 - self.spec_tint) * f);
        if self.metallic > 0.0 {
            sum += schlick_from(self.diffuse.base, cos, self.eta) * self.metallic;
        }
        if self.spec_tint > 0.0 {
            let r0 = (self.tint * fresnel::f0_from_eta(self.eta)).clamp(0.0, 1.0);
            sum += schlick_from(r0, cos, self.eta) * ((1.0 - self.metallic) * self.spec_tint);
        }
        sum
    }

    /// The index that light along `wo` meets.
    #[inline(always)]
    fn eta_from(&self, wo: Vec3) -> f32 {
        if wo.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// Transmission through a facet that reflects the fraction `f`.
    #[inline(always)]
    fn transmitted(&self, w: &Weights, facet: Facet, f: f32, wo: Vec3, eta: f32, mode: TransportMode) -> BsdfEval {
        let value = w.bsdf * (1.0 - f) * facet.value * mode.compression(eta);
        let p = w.specular * (1.0 - Self::reflecting_part(wo, w, f));
        BsdfEval { value: self.diffuse.base.sqrt() * value, pdf: p * facet.pdf }
    }

    /// Reflection to the side of `wo`.
    #[inline(always)]
    fn reflected(&self, w: &Weights, mirror: &Mirror, wo: Vec3, wi: Vec3) -> BsdfEval {
        let Some(facet) = self.microfacet.reflecting_by(mirror, wo, wi) else { return BsdfEval::ZERO };
        let crossing = fresnel::Crossing::by_square(mirror.cos2, self.eta_from(wo));
        let f = crossing.reflectance;
        let mut e = BsdfEval {
            value: self.fresnel(wo, w, crossing.cos_i, f) * facet.value,
            pdf: w.specular * Self::reflecting_part(wo, w, f) * facet.pdf,
        };
        if wo.z < 0.0 {
            return e;
        }
        if self.clearcoat > 0.0 {
            let (value, pdf) = self.clearcoat(crossing.cos_i, wo, wi);
            e.value += Spectrum::splat(value);
            e.pdf += w.clearcoat * pdf;
        }
        if w.diffuse > 0.0 {
            let (diffuse, sheen) = self.diffuse.eval(wo, wi, mirror.cos2);
            e.value += diffuse * w.brdf + sheen * (1.0 - self.metallic);
            e.pdf += w.diffuse * FRAC_1_PI * wi.z;
        }
        e
    }

    /// Sample of the light that goes below the surface through a facet in view, to leave elsewhere.
    fn entering(&self, w: &Weights, wo: Vec3, u2: Vec2) -> BsdfSample {
        let crossing = self.microfacet.draw(wo, u2).crossing(self.eta);
        let dielectric = Self { metallic: 0.0, ..*self };
        let f = dielectric.fresnel(wo, w, crossing.cos_i, crossing.reflectance).clamp(0.0, 1.0);
        let coat = self.clearcoat * (0.01 + 0.025 * wo.z * wo.z);
        let grazing = 1.0 - wo.z;
        let sheen = self.diffuse.sheen * ((1.0 - self.metallic) * 0.0885 * grazing * grazing * grazing.sqrt());
        let passed = (Spectrum::splat(1.0 - coat) - f - sheen).clamp(0.0, 1.0);
        BsdfSample::entering(passed * (w.below / w.entering), w.entering)
    }

    /// `f cosθ_i` and density of the clear coat, for directions above it with this cosine at the facet: GTR1 with
    /// Smith's masking of GGX at 0.25.
    fn clearcoat(&self, cos: f32, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let h = (wo + wi) * (0.5 / cos);
        let d = gtr1::d(self.clearcoat_alpha, h.z);
        let masking = Microfacet::new(NormalDistribution::Ggx, Shadowing::Separable, 0.25, 0.25);
        let f = schlick_from(Spectrum::splat(0.04), cos, self.eta)[0];
        (0.25 * self.clearcoat * f * d * masking.g2(wo, wi, h) * wi.z, d * h.z / (4.0 * cos))
    }
}

impl Scatter for Principled {
    const ALBEDO_BOUND: f32 = Principled::ALBEDO_BOUND;
    const MODELS: &'static [Model] = &[Model::new("principled", "Disney's surface", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        let Some(w) = self.weights(wo) else { return BsdfEval::ZERO };
        if wo.z * wi.z >= 0.0 {
            return self.reflected(&w, &self.microfacet.mirror(wo, wi), wo, wi);
        }
        let eta = self.eta_from(wo);
        if w.bsdf > 0.0
            && let Some(facet) = self.microfacet.refracting(wo, wi, eta)
        {
            return self.transmitted(&w, facet, fresnel::dielectric(facet.cos_o, self.eta), wo, eta, mode);
        }
        BsdfEval::ZERO
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let w = self.weights(wo)?;
        let (wi, mirror, shape) = if u < w.diffuse {
            let wi = sample_cosine_hemisphere(u2)?;
            (wi, self.microfacet.mirror(wo, wi), Lobe::DIFFUSE)
        } else if u < w.diffuse + w.clearcoat {
            let wi = fresnel::reflect(wo, gtr1::sample(self.clearcoat_alpha, u2));
            (wi, self.microfacet.mirror(wo, wi), Lobe::GLOSSY)
        } else if u >= 1.0 - w.entering {
            return Some(self.entering(&w, wo, u2));
        } else {
            let n = self.microfacet.draw(wo, u2);
            let crossing = n.crossing(self.eta);
            let f = crossing.reflectance;
            if u - w.diffuse - w.clearcoat >= w.specular * Self::reflecting_part(wo, &w, f) {
                let (wi, eta) = n.refracted(wo, &crossing)?;
                let facet = self.microfacet.refracting_drawn(&n, &crossing, wo, wi)?;
                let e = self.transmitted(&w, facet, f, wo, eta, mode);
                return e.drawn(wi, Lobe::TRANSMISSION.with(Lobe::GLOSSY), eta);
            }
            (n.mirrored(wo), n.mirror(), Lobe::GLOSSY)
        };
        if wo.z * wi.z <= 0.0 {
            return None;
        }
        self.reflected(&w, &mirror, wo, wi).drawn(wi, Lobe::REFLECTION.with(shape), 1.0)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        if self.transmits() && wo.z < 0.0 {
            return Spectrum::ONE;
        }
        let f = Spectrum::splat(fresnel::dielectric(wo.z.abs(), self.eta));
        let glass = f + (Spectrum::ONE - f) * self.diffuse.base.sqrt();
        let base = match self.below {
            0.0 => self.diffuse.base,
            below => self.diffuse.base + (self.below_color.get() - self.diffuse.base) * below,
        };
        let opaque = base * (1.0 - self.metallic) * (1.0 - self.spec_trans)
            + schlick_from(self.diffuse.base, wo.z.abs(), 1.5) * self.metallic;
        (opaque + glass * ((1.0 - self.metallic) * self.spec_trans)).clamp(0.0, 1.0)
    }

    fn transmits(&self) -> bool {
        (1.0 - self.metallic) * self.spec_trans > 0.0
    }

    #[inline]
    fn relative_eta(&self) -> f32 {
        self.eta()
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut case = |label, params: PrincipledParams| {
        visit(Case { label, bsdf: Bsdf::Principled(Principled::new(&params)), lossless: false });
    };
    let p = plain();
    case("plain", p);
    case("metal", PrincipledParams { metallic: 1.0, roughness: 0.4, anisotropic: 0.7, ..p });
    case("glass", PrincipledParams { spec_trans: 1.0, roughness: 0.4, ..p });
    case("bubble", PrincipledParams { spec_trans: 0.8, eta: 0.7, roughness: 0.5, ..p });
    case("cloth", PrincipledParams { sheen: 1.0, sheen_tint: 0.5, roughness: 1.0, flatness: 0.6, ..p });
    case("lacquer", PrincipledParams { clearcoat: 1.0, clearcoat_gloss: 0.3, ..p });
    case("white", PrincipledParams { base_color: Spectrum::ONE, tint: Spectrum::ONE, roughness: 1.0, sheen: 1.0, ..p });
    let medium = SubsurfacePart { weight: 1.0, color: GREY, is_followed: true, g: 0.0 };
    case("marble", PrincipledParams { subsurface: medium, clearcoat: 1.0, sheen: 1.0, spec_tint: 0.5, ..p });
    let half = SubsurfacePart { weight: 0.5, ..medium };
    case("skin and glass", PrincipledParams { subsurface: half, spec_trans: 0.5, sheen: 0.5, ..p });
    case(
        "all at once",
        PrincipledParams {
            metallic: 0.4,
            spec_trans: 0.5,
            spec_tint: 0.6,
            sheen: 0.5,
            clearcoat: 0.7,
            flatness: 0.3,
            anisotropic: 0.4,
            ..p
        },
    );
}

/// The plain surface that cases depart from.
pub(super) fn plain() -> PrincipledParams {
    let luminance = 0.2126 * GREY[0] + 0.7152 * GREY[1] + 0.0722 * GREY[2];
    PrincipledParams {
        base_color: GREY,
        tint: GREY / luminance,
        roughness: 0.5,
        anisotropic: 0.0,
        metallic: 0.0,
        spec_trans: 0.0,
        eta: 1.5,
        spec_tint: 0.0,
        sheen: 0.0,
        sheen_tint: 0.0,
        flatness: 0.0,
        clearcoat: 0.0,
        clearcoat_gloss: 0.0,
        subsurface: SubsurfacePart::NONE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rough_grey_base_is_burleys_diffuse() {
        // Without the specular (η → 1.001): base/π (0.5 + 2 cos²θ_d r)-like growth at grazing, exactly 1/π at the
        // normal.
        let p = PrincipledParams {
            base_color: Spectrum::ONE,
            tint: Spectrum::ONE,
            roughness: 1.0,
            anisotropic: 0.0,
            metallic: 0.0,
            spec_trans: 0.0,
            eta: 1.001,
            spec_tint: 0.0,
            sheen: 0.0,
            sheen_tint: 0.0,
            flatness: 0.0,
            clearcoat: 0.0,
            clearcoat_gloss: 0.0,
            subsurface: SubsurfacePart::NONE,
        };
        let b = Principled::new(&p);
        let at = |wo, wi: Vec3| b.eval(wo, wi, TransportMode::Radiance).value[0] / wi.z;
        assert!((at(Vec3::Z, Vec3::Z) - FRAC_1_PI).abs() < 1e-5);
        // At 60° back to the viewer: S = 1/32, R = 2, f = (1 − 1/64)² + 2 (1/16 + 1/1024).
        let w = Vec3::new(0.75f32.sqrt(), 0.0, 0.5);
        let expected = (1.0 - 1.0 / 64.0f32).powi(2) + 2.0 * (1.0 / 16.0 + 1.0 / 1024.0);
        assert!((at(w, w) - expected * FRAC_1_PI).abs() < 1e-4, "{} {}", at(w, w), expected * FRAC_1_PI);
    }
}
