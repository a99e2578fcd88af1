//! The surface of glTF 2.0 with its material extensions, and (with the approximations that the compiler names) of OpenPBR 1.1: a metal or a
//! dielectric over diffuse reflection, diffuse transmission or refraction, under sheen, under a clear coat.
//!
//! ```text
//! f = coat F_c D_c G_c/(4..) + L_c [ sheen + L_s ( F D G/(4..) + (1 − F) refraction + B(wo, wi) (ρ + τ)/π ) ]
//! F = metallic F_metal + (1 − metallic) F_dielectric                                  glTF 2.0, appendix B.2
//! F_dielectric = f0 + (f90 − f0)(1 − c)⁵, of the facet; total reflection from inside   KHR_materials_specular, _ior
//! F_metal = base + (1 − base)(1 − c)⁵ − k c (1 − c)⁶, with the edge's tint at 82°      Hoffman 2019; OpenPBR 1.1, eq. 24
//! B = (1 − E(wo))(1 − E(wi))/(1 − Ē) of the dielectric reflection                      albedo_table
//! L = min over both directions of 1 − weight · E                                       KHR_materials_sheen, albedo scaling
//! ```
//!
//! The minimum keeps layering reciprocal and never makes energy; appendix B's own mix by the Fresnel factor of the half-vector does at grazing
//! angles. A surface that refracts is seen from inside as the bare interface. `thin` surfaces (glTF without a volume) let light pass without
//! bending it and are the same from both sides. Colours are kept to 16 bits.

use super::principled::schlick_weight;
use super::{
    BsdfEval, BsdfSample, Lobe, Microfacet, TransportMode, albedo_table, fresnel, sample_cosine_hemisphere, sheen,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3};

/// A spectrum of values in [0, 1] to 16 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Unit4([u16; 4]);

impl Unit4 {
    fn new(s: Spectrum) -> Self {
        Self(s.to_array().map(|v| if v > 0.0 { (v.min(1.0) * 65535.0 + 0.5) as u16 } else { 0 }))
    }

    #[inline]
    fn get(self) -> Spectrum {
        Spectrum::new(self.0.map(|v| f32::from(v) * (1.0 / 65535.0)))
    }

    #[inline]
    fn most(self) -> f32 {
        f32::from(self.0.into_iter().max().unwrap_or(0)) * (1.0 / 65535.0)
    }
}

/// What a scene says of the surface. Colours and weights in [0, 1] (clamped).
#[derive(Clone, Copy, Debug)]
pub struct PbrParams {
    /// Colour of metal, of diffuse reflection, and of what is refracted.
    pub base_color: Spectrum,
    /// How much of it is metal.
    pub metallic: f32,
    /// Facets of the base.
    pub facets: Microfacet,
    /// Index of refraction (≥ 1).
    pub eta: f32,
    /// Strength of the dielectric reflection.
    pub specular: f32,
    /// Tint of the dielectric reflection at normal incidence, and of metal at 82°.
    pub specular_color: Spectrum,
    /// How much of the dielectric refracts.
    pub transmission: f32,
    /// Factor on what is refracted.
    pub transmission_color: Spectrum,
    /// Whether light passes unbent.
    pub thin: bool,
    /// How much of the diffuse light goes through.
    pub diffuse_transmission: f32,
    /// Its colour.
    pub diffuse_transmission_color: Spectrum,
    /// Colour of the sheen; black for none.
    pub sheen_color: Spectrum,
    /// Roughness of the sheen; its α is the square.
    pub sheen_roughness: f32,
    /// Strength of the clear coat.
    pub coat: f32,
    /// Facets of the coat.
    pub coat_facets: Microfacet,
    /// Index of refraction of the coat (≥ 1).
    pub coat_eta: f32,
    /// What light keeps on its way in and out of the coat at normal incidence.
    pub coat_color: Spectrum,
    /// Whether specular_color tints metal at the edge (OpenPBR) rather than the dielectric alone (glTF).
    pub tints_metal_edge: bool,
}

/// The surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct Pbr {
    metal: Unit4,
    edge: Unit4,
    f0: Unit4,
    diffuse: Unit4,
    through: Unit4,
    refracted: Unit4,
    sheen: Unit4,
    coat_color: Unit4,
    facets: Microfacet,
    coat_facets: Microfacet,
    metallic: f32,
    eta: f32,
    f90: f32,
    sheen_alpha: f32,
    coat: f32,
    coat_f0: f32,
    thin: bool,
}

/// Probabilities of the ways to draw a direction.
struct Chances {
    coat: f32,
    facets: f32,
    diffuse: f32,
}

fn unit(v: f32) -> f32 {
    if v > 0.0 { v.min(1.0) } else { 0.0 }
}

/// Facets too smooth for a density are roughened to the least that has one: the model has no delta lobes.
fn rough(m: Microfacet) -> Microfacet {
    if m.is_smooth() { Microfacet::ggx(1.001e-3, 1.001e-3) } else { m }
}

impl Pbr {
    /// The surface of `p`.
    pub fn new(p: &PbrParams) -> Self {
        let eta = if p.eta > 1.0 { p.eta.min(1e3) } else { 1.0 };
        let (metallic, transmission) = (unit(p.metallic), unit(p.transmission));
        let through = unit(p.diffuse_transmission);
        let opaque = (1.0 - metallic) * (1.0 - transmission);
        let specular = unit(p.specular);
        let coat_eta = if p.coat_eta > 1.0 { p.coat_eta.min(1e3) } else { 1.0 };
        Self {
            metal: Unit4::new(p.base_color),
            edge: Unit4::new(if p.tints_metal_edge { p.specular_color } else { Spectrum::ONE }),
            f0: Unit4::new((p.specular_color * fresnel::f0_from_eta(eta)).clamp(0.0, 1.0) * specular),
            diffuse: Unit4::new(p.base_color * (opaque * (1.0 - through))),
            through: Unit4::new(p.diffuse_transmission_color * (opaque * through)),
            refracted: Unit4::new(p.transmission_color * ((1.0 - metallic) * transmission)),
            sheen: Unit4::new(p.sheen_color),
            coat_color: Unit4::new(p.coat_color),
            facets: rough(p.facets),
            coat_facets: rough(p.coat_facets),
            metallic,
            // Refraction between equal media has no half-vector.
            eta: if eta < 1.001 { 1.001 } else { eta },
            f90: specular,
            sheen_alpha: (unit(p.sheen_roughness) * unit(p.sheen_roughness)).max(sheen::MIN_ALPHA),
            coat: unit(p.coat),
            coat_f0: fresnel::f0_from_eta(coat_eta),
            thin: p.thin,
        }
    }

    fn refracts(&self) -> bool {
        !self.thin && self.refracted.most() > 0.0
    }

    pub(super) fn transmits(&self) -> bool {
        self.refracted.most() > 0.0 || self.through.most() > 0.0
    }

    /// Index below relative to above, as light meets it.
    pub(super) fn eta(&self) -> f32 {
        if self.refracts() { self.eta } else { 1.0 }
    }

    /// Reflectance of the dielectric where the cosine of the facet is `cos` (negative from inside).
    fn dielectric(&self, cos: f32) -> Spectrum {
        let outside = if cos >= 0.0 {
            cos
        } else {
            let c2 = 1.0 - self.eta * self.eta * (1.0 - cos * cos);
            if c2 <= 0.0 {
                return Spectrum::ONE;
            }
            c2.sqrt()
        };
        let f0 = self.f0.get();
        f0 + (Spectrum::splat(self.f90) - f0) * schlick_weight(outside)
    }

    /// Reflectance of base facets from outside.
    fn reflectance(&self, cos: f32) -> Spectrum {
        let dielectric = self.dielectric(cos);
        if self.metallic == 0.0 {
            return dielectric;
        }
        let (base, w) = (self.metal.get(), schlick_weight(cos));
        let schlick = |w: f32| base + (Spectrum::ONE - base) * w;
        // Hoffman's term is the lack at cos = 1/7, brought to zero at normal and grazing incidence.
        let lack = schlick((6.0f32 / 7.0).powi(5)) * (Spectrum::ONE - self.edge.get());
        let shape = cos * (1.0 - cos).powi(6) / ((1.0 / 7.0) * (6.0f32 / 7.0).powi(6));
        let metal = (schlick(w) - lack * shape).clamp(0.0, 1.0);
        dielectric * (1.0 - self.metallic) + metal * self.metallic
    }

    /// `1 − E` of the dielectric reflection, its strongest lane.
    fn below(&self, cos: f32) -> f32 {
        let [a, b] = albedo_table::ggx(self.facets.mean_alpha(), cos.abs());
        (1.0 - self.f0.most() * a - self.f90 * b).clamp(0.0, 1.0)
    }

    /// `B/π cosθ_i`.
    fn lambert(&self, wo: Vec3, wi: Vec3) -> f32 {
        let [a, b] = albedo_table::ggx_mean(self.facets.mean_alpha());
        let mean = (1.0 - self.f0.most() * a - self.f90 * b).max(1e-3);
        self.below(wo.z) * self.below(wi.z) / mean * FRAC_1_PI * wi.z.abs()
    }

    fn coat_albedo(&self, cos: f32) -> f32 {
        if self.coat == 0.0 {
            return 0.0;
        }
        let [a, b] = albedo_table::ggx(self.coat_facets.mean_alpha(), cos);
        self.coat * (self.coat_f0 * a + b)
    }

    /// What sheen leaves to the layers below it at one cosine.
    fn sheen_leaves(&self, cos: f32) -> f32 {
        1.0 - self.sheen.most() * albedo_table::sheen(self.sheen_alpha, cos)
    }

    /// What the coat leaves of light that sees it at these cosines on its way, and the colour it gives.
    fn coat_leaves(&self, cosines: &[f32]) -> Spectrum {
        if self.coat == 0.0 {
            return Spectrum::ONE;
        }
        let most = cosines.iter().map(|c| self.coat_albedo(*c)).fold(0.0, f32::max);
        let white = self.coat_color == Unit4([u16::MAX; 4]);
        let kept = if white {
            Spectrum::ONE
        } else {
            // Half of the colour's two ways each, along the direction refracted at an index of 1.5.
            let way: f32 = cosines.iter().map(|c| 0.5 / (1.0 - (1.0 - c * c) / 2.25).sqrt()).sum();
            self.coat_color.get().map(|c| c.powf(way))
        };
        (Spectrum::ONE + (kept - Spectrum::ONE) * self.coat) * (1.0 - most)
    }

    fn chances(&self, wo: Vec3) -> Chances {
        let cos = wo.z.abs();
        let [a, b] = albedo_table::ggx(self.facets.mean_alpha(), cos);
        let coat = self.coat_albedo(cos);
        let reflected =
            self.metallic * self.metal.most().max(b) + (1.0 - self.metallic) * (self.f0.most() * a + self.f90 * b);
        let facets = (1.0 - coat) * (reflected + self.refracted.most()).max(0.02);
        let below = self.below(cos) * (self.diffuse.most() + self.through.most());
        let diffuse = (1.0 - coat) * below + self.sheen.most() * albedo_table::sheen(self.sheen_alpha, cos);
        let total = coat + facets + diffuse;
        Chances { coat: coat / total, facets: facets / total, diffuse: diffuse / total }
    }

    /// The part of the diffuse draws that goes through.
    fn through_part(&self) -> f32 {
        let through = self.through.most();
        let reflected = self.diffuse.most() + self.sheen.most();
        if through > 0.0 { through / (through + reflected) } else { 0.0 }
    }

    /// The part of the facets' draws that is reflected.
    fn reflecting_part(&self, f: Spectrum) -> f32 {
        let (r, t) = (f.max_element(), self.refracted.most() * (1.0 - f.0.min_element()));
        if t > 0.0 { r / (r + t) } else { 1.0 }
    }

    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        if wo.z == 0.0 || wi.z == 0.0 {
            return BsdfEval::ZERO;
        }
        if wo.z > 0.0 {
            return self.eval_outside(wo, wi, mode);
        }
        if self.refracts() {
            self.eval_inside(wo, wi, mode)
        } else if self.transmits() {
            self.eval_outside(-wo, -wi, mode)
        } else {
            BsdfEval::ZERO
        }
    }

    fn eval_outside(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        let c = self.chances(wo);
        let mut e = BsdfEval::ZERO;
        if wi.z > 0.0 {
            if let Some(facet) = self.facets.reflecting(wo, wi) {
                let f = self.reflectance(facet.cos_o);
                e.value = f * facet.value;
                e.pdf = c.facets * self.reflecting_part(f) * facet.pdf;
            }
            e.value += self.diffuse.get() * self.lambert(wo, wi);
            e.pdf += c.diffuse * (1.0 - self.through_part()) * FRAC_1_PI * wi.z;
            if self.sheen.most() > 0.0 {
                e.value *= self.sheen_leaves(wo.z).min(self.sheen_leaves(wi.z));
                e.value += self.sheen.get() * sheen::value(self.sheen_alpha, wo, wi);
            }
            if self.coat > 0.0 {
                e.value *= self.coat_leaves(&[wo.z, wi.z]);
                if let Some(facet) = self.coat_facets.reflecting(wo, wi) {
                    let f = self.coat_f0 + (1.0 - self.coat_f0) * schlick_weight(facet.cos_o);
                    e.value += Spectrum::splat(self.coat * f * facet.value);
                    e.pdf += c.coat * facet.pdf;
                }
            }
            return e;
        }
        if self.refracts() {
            if let Some(facet) = self.facets.refracting(wo, wi, self.eta) {
                let (value, p) = self.transmitted(facet.cos_o);
                let layers = self.coat_leaves(&[wo.z]) * self.sheen_leaves(wo.z);
                e.value = value * layers * (facet.value * mode.compression(self.eta));
                e.pdf = c.facets * p * facet.pdf;
            }
        } else if self.refracted.most() > 0.0
            && let Some(facet) = self.facets.reflecting(wo, Vec3::new(wi.x, wi.y, -wi.z))
        {
            let (value, p) = self.transmitted(facet.cos_o);
            e.value = value * facet.value * self.layers(wo.z, -wi.z);
            e.pdf = c.facets * p * facet.pdf;
        }
        if self.through.most() > 0.0 {
            e.value += self.through.get() * self.layers(wo.z, -wi.z) * self.lambert(wo, wi);
            e.pdf += c.diffuse * self.through_part() * FRAC_1_PI * -wi.z;
        }
        e
    }

    /// What the layers leave to light between two sides.
    fn layers(&self, a: f32, b: f32) -> Spectrum {
        let sheen = self.sheen_leaves(a).min(self.sheen_leaves(b));
        self.coat_leaves(&[a, b]) * sheen
    }

    /// What a facet lets pass, and the part of its draws that does.
    fn transmitted(&self, cos: f32) -> (Spectrum, f32) {
        let f = self.dielectric(cos);
        let reflected = if cos >= 0.0 { self.reflectance(cos) } else { f };
        (self.refracted.get() * (Spectrum::ONE - f), 1.0 - self.reflecting_part(reflected))
    }

    fn eval_inside(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        let eta = 1.0 / self.eta;
        if wi.z < 0.0 {
            return self.facets.reflecting(wo, wi).map_or(BsdfEval::ZERO, |facet| {
                let f = self.dielectric(facet.cos_o);
                BsdfEval { value: f * facet.value, pdf: self.reflecting_part(f) * facet.pdf }
            });
        }
        self.facets.refracting(wo, wi, eta).map_or(BsdfEval::ZERO, |facet| {
            let (value, p) = self.transmitted(facet.cos_o);
            let layers = self.coat_leaves(&[wi.z]) * self.sheen_leaves(wi.z);
            BsdfEval { value: value * layers * (facet.value * mode.compression(eta)), pdf: p * facet.pdf }
        })
    }

    pub(super) fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.z == 0.0 || (wo.z < 0.0 && !self.transmits()) {
            return None;
        }
        let is_inside = wo.z < 0.0 && self.refracts();
        let turn = if wo.z < 0.0 && !is_inside { -1.0 } else { 1.0 };
        let seen = wo * turn;
        let c = if is_inside { Chances { coat: 0.0, facets: 1.0, diffuse: 0.0 } } else { self.chances(seen) };
        let mut eta = 1.0;
        let (wi, lobe) = if u < c.coat {
            (fresnel::reflect(seen, self.coat_facets.sample_visible(seen, u2)), Lobe::GLOSSY)
        } else if u < c.coat + c.facets {
            let u = (u - c.coat) / c.facets;
            let m = self.facets.sample_visible(seen, u2);
            let cos = seen.dot(m);
            let f = if is_inside { self.dielectric(cos) } else { self.reflectance(cos) };
            if u < self.reflecting_part(f) {
                (fresnel::reflect(seen, m), Lobe::GLOSSY)
            } else if self.thin {
                let w = fresnel::reflect(seen, m);
                (Vec3::new(w.x, w.y, -w.z), Lobe::GLOSSY.with(Lobe::TRANSMISSION))
            } else {
                let (w, relative) = fresnel::refract(seen, m, self.eta)?;
                eta = relative;
                (w, Lobe::GLOSSY.with(Lobe::TRANSMISSION))
            }
        } else {
            let w = sample_cosine_hemisphere(u2)?;
            let u = (u - c.coat - c.facets) / c.diffuse;
            if u < self.through_part() { (-w, Lobe::DIFFUSE.with(Lobe::TRANSMISSION)) } else { (w, Lobe::DIFFUSE) }
        };
        if (seen.z * wi.z < 0.0) != lobe.is_transmission() {
            return None;
        }
        let lobe = if lobe.is_transmission() { lobe } else { lobe.with(Lobe::REFLECTION) };
        let wi = wi * turn;
        let e = self.eval(wo, wi, mode);
        (e.pdf > 0.0 && e.pdf.is_finite()).then(|| BsdfSample { wi, weight: e.value / e.pdf, pdf: e.pdf, lobe, eta })
    }

    pub(super) fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let cos = wo.z.abs();
        let below = (self.diffuse.get() + self.through.get() + self.refracted.get()) * self.below(cos);
        let under = self.reflectance(cos) + below;
        let sheen = self.sheen.get() * albedo_table::sheen(self.sheen_alpha, cos);
        let layered = (under * self.sheen_leaves(cos) + sheen) * self.coat_leaves(&[cos, cos]);
        (layered + Spectrum::splat(self.coat_albedo(cos))).clamp(0.0, 1.0)
    }
}
