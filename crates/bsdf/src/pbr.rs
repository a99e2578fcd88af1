//! The surface of glTF 2.0 with its material extensions, and (with the approximations that the compiler names) of
//! OpenPBR 1.1: a metal or a dielectric over diffuse reflection, diffuse transmission or refraction, under sheen, under
//! a clear coat.
//!
//! ```text
//! f = coat F_c D_c G_c/(4..) + L_c [ sheen + L_s ( F D G/(4..) + (1 − F) refraction + B(wo, wi) (ρ + τ)/π ) ]
//! F = metallic F_metal + (1 − metallic) F_dielectric                                  glTF 2.0, appendix B.2
//! F_dielectric = f0 + (f90 − f0)(1 − c)⁵, of the facet; total reflection from inside   KHR_materials_specular, _ior
//! F_metal = base + (1 − base)(1 − c)⁵ − k c (1 − c)⁶, with the edge's tint at 82°    Hoffman 2019; OpenPBR 1.1, eq. 24
//! with a film: both interpolated to Airy's reflectance over an index of √F₀ = (n−1)/(n+1)   KHR_materials_iridescence
//! B = (1 − E(wo))(1 − E(wi))/(1 − Ē) of the dielectric reflection                      albedo_table
//! with rough metal of OpenPBR: Kulla and Conty's lobe beside its F D G                 multiple_scattering
//! L = min over both directions of 1 − weight · E                                   KHR_materials_sheen, albedo scaling
//! ```
//!
//! The minimum keeps layering reciprocal and never makes energy; appendix B's own mix by the Fresnel factor of the
//! half-vector does at grazing angles. Rough metal of OpenPBR loses no light between its facets (stretched metal a part
//! of it); that of glTF is single scattering, as appendix B says. A coat may have a normal of its own: its lobe, albedo
//! and colour go by the cosines to that normal, so that no energy is made, and the surface is not reciprocal (its
//! adjoint is exact). Facets below [`Microfacet::SMOOTH_BELOW`] reflect and refract in one direction each, as delta
//! lobes. A surface that refracts is seen from inside as the bare interface. `thin` surfaces (glTF without a volume)
//! let light pass without bending it and are the same from both sides. Colours and weights are kept to 16 bits, the
//! weight of metal to 15, that of subsurface scattering to 8.
//!
//! Of the opaque dielectric a part w may be a medium that light goes below, to leave elsewhere
//! ([`Lobe::SUBSURFACE`]): `w L(wo) (1 − E(wo))` of it enters, which is what a white diffuse base under the same
//! layers sends back. The colour of a coat counts for the way out, too, at the mean cosine 2/3 of diffuse light.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, Microfacet, ThinFilm, TransportMode, albedo_table, fresnel,
    multiple_scattering::BetweenFacets,
    oren_nayar::over_lambert,
    packed::Unit4,
    packed_normal::Unit3,
    principled::schlick_weight,
    registry::{Case, GREY, Model, Visitor},
    sample_cosine_hemisphere,
    scatter::Scatter,
    sheen,
    split_sum::SplitSum,
    subsurface::SubsurfacePart,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Frame, Spectrum, Vec2, Vec3, elementary::pow, hash::ONE_MINUS_EPSILON};

/// A number in [0, 1] to 16 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Unit(u16);

impl Unit {
    fn new(v: f32) -> Self {
        Self((unit(v) * 65535.0 + 0.5) as u16)
    }

    #[inline]
    fn get(self) -> f32 {
        f32::from(self.0) * (1.0 / 65535.0)
    }
}

/// Roughness of the diffuse base in 127 steps, and whether the surface is a thin wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Grain(u8);

impl Grain {
    fn new(roughness: f32, is_thin: bool) -> Self {
        Self((unit(roughness) * 127.0 + 0.5) as u8 | u8::from(is_thin) << 7)
    }

    #[inline]
    fn roughness(self) -> f32 {
        f32::from(self.0 & 127) * (1.0 / 127.0)
    }

    #[inline]
    fn is_thin(self) -> bool {
        self.0 > 127
    }
}

/// Weight of the metal in 32767 steps, and whether light that its facets reflect to each other is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Metal(u16);

impl Metal {
    fn new(weight: f32, is_followed: bool) -> Self {
        Self((unit(weight) * 32767.0 + 0.5) as u16 | u16::from(is_followed) << 15)
    }

    #[inline]
    fn weight(self) -> f32 {
        f32::from(self.0 & 32767) * (1.0 / 32767.0)
    }

    #[inline]
    fn is_followed(self) -> bool {
        self.0 > 32768
    }
}

/// Specification of the parameters, where the two differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// glTF 2.0: `specular_color` tints the dielectric alone, and facets of metal reflect once (appendix B).
    Gltf,
    /// OpenPBR 1.1: `specular_color` tints the edge of metal, too, and light between facets of metal is not lost.
    OpenPbr,
}

/// Parameters of the surface. Colours and weights in [0, 1] (clamped).
#[derive(Clone, Copy, Debug)]
pub struct PbrParams {
    /// Colour of metal, of diffuse reflection, and of what is refracted.
    pub base_color: Spectrum,
    /// Roughness of the diffuse reflection, in [0, 1]; zero is Lambertian.
    pub diffuse_roughness: f32,
    /// Weight of the metal.
    pub metallic: f32,
    /// Facets of the base.
    pub facets: Microfacet,
    /// Index of refraction (≥ 1).
    pub eta: f32,
    /// Strength of the dielectric reflection.
    pub specular: f32,
    /// Tint of the dielectric reflection at normal incidence, and of OpenPBR's metal at 82°.
    pub specular_color: Spectrum,
    /// Part of the dielectric that refracts.
    pub transmission: f32,
    /// Factor on what is refracted.
    pub transmission_color: Spectrum,
    /// True for a thin wall, which light passes unbent.
    pub thin: bool,
    /// Part of the diffuse light that is transmitted.
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
    /// Transmittance of the coat for light that passes it in and out at normal incidence.
    pub coat_color: Spectrum,
    /// Strength of the darkening of the base by light that the coat sends back to it (OpenPBR 1.1, 3.5.3).
    pub coat_darkening: f32,
    /// Specification that the parameters are of.
    pub convention: Convention,
    /// A film between base and coat.
    pub film: ThinFilm,
    /// Part of the base that the film covers.
    pub film_weight: f32,
    /// Part of the opaque dielectric that is a medium which light enters.
    pub subsurface: SubsurfacePart,
}

/// The surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct Pbr {
    metal: Unit4,
    edge: Unit4,
    f0: Unit4,
    diffuse: Unit4,
    /// Colour of the light that goes through the surface, or below it.
    through: Unit4,
    refracted: Unit4,
    sheen: Unit4,
    coat_color: Unit4,
    film: ThinFilm,
    facets: Microfacet,
    /// α of the coat along and across.
    coat_alpha: [Unit; 2],
    eta: f32,
    film_weight: Unit,
    /// The f0 with which Schlick's reflectance is nowhere below the dielectric's, film and all lanes included.
    bound: Unit,
    metallic: Metal,
    f90: Unit,
    sheen_alpha: Unit,
    coat: Unit,
    coat_f0: Unit,
    /// Normal of the coat in the frame of the base.
    coat_normal: Unit3,
    grain: Grain,
    /// Part of that light that goes below the surface instead of through, of 255.
    below: u8,
}

/// Quantities that depend on the viewing direction alone.
#[derive(Default)]
struct Seen {
    /// Probabilities of the ways to draw a direction.
    coat: f32,
    facets: f32,
    between: f32,
    diffuse: f32,
    /// `1 − E` of the dielectric reflection.
    below: f32,
    /// The base's roughness in the tables.
    row: albedo_table::Row,
    /// Light that facets of the metal reflect to each other.
    lobe: Option<BetweenFacets>,
}

fn unit(v: f32) -> f32 {
    if v > 0.0 { v.min(1.0) } else { 0.0 }
}

impl Pbr {
    /// The surface of `p`.
    pub fn new(p: &PbrParams) -> Self {
        let eta = if p.eta > 1.0 { p.eta.min(1e3) } else { 1.0 };
        let (metallic, transmission) = (unit(p.metallic), unit(p.transmission));
        let through = unit(p.diffuse_transmission);
        let opaque = (1.0 - metallic) * (1.0 - transmission);
        let is_openpbr = p.convention == Convention::OpenPbr;
        let specular = unit(p.specular);
        let coat_eta = if p.coat_eta > 1.0 { p.coat_eta.min(1e3) } else { 1.0 };
        let f0 = Unit4::new((p.specular_color * fresnel::f0_from_eta(eta)).clamp(0.0, 1.0) * specular);
        let medium = &p.subsurface;
        // What of the base is a medium, in steps that 8 bits have.
        let share = (opaque * unit(medium.weight) * 255.0 + 0.5) as u8;
        let part = f32::from(share) * (1.0 / 255.0);
        let base = (opaque - part).max(0.0);
        let mut diffuse = p.base_color * (base * (1.0 - through));
        let mut passing = p.diffuse_transmission_color * (base * through);
        let is_below = share > 0 && medium.is_followed && !p.thin;
        if is_below {
            passing = medium.color * part;
        } else if share > 0 {
            let forward = if p.thin { part * unit(0.5 + 0.5 * medium.g) } else { 0.0 };
            diffuse += medium.color * (part - forward);
            passing += medium.color * forward;
        }
        let mut surface = Self {
            metal: Unit4::new(p.base_color),
            edge: Unit4::new(if is_openpbr { p.specular_color } else { Spectrum::ONE }),
            f0,
            diffuse: Unit4::new(diffuse),
            through: Unit4::new(passing),
            refracted: Unit4::new(p.transmission_color * ((1.0 - metallic) * transmission)),
            sheen: Unit4::new(p.sheen_color),
            coat_color: Unit4::new(p.coat_color),
            film: p.film,
            facets: p.facets,
            coat_alpha: p.coat_facets.alpha().to_array().map(Unit::new),
            // Refraction between equal media has no half-vector.
            eta: if eta < 1.001 { 1.001 } else { eta },
            film_weight: Unit::new(p.film_weight),
            bound: Unit::new(f0.most()),
            metallic: Metal::new(metallic, is_openpbr),
            f90: Unit::new(specular),
            sheen_alpha: Unit::new((unit(p.sheen_roughness) * unit(p.sheen_roughness)).max(sheen::MIN_ALPHA)),
            coat: Unit::new(p.coat),
            coat_f0: Unit::new(fresnel::f0_from_eta(coat_eta)),
            coat_normal: Unit3::Z,
            grain: Grain::new(p.diffuse_roughness, p.thin),
            below: if is_below { share } else { 0 },
        };
        if surface.film_weight.0 > 0 {
            surface.bound = Unit::new(surface.least_f0_above());
        }
        if p.coat_darkening > 0.0 && surface.coat.0 > 0 {
            surface.coat_color = Unit4::new(p.coat_color * surface.darkening(coat_eta, unit(p.coat_darkening)));
        }
        surface
    }

    /// Factor on light that leaves the base through a coat of an index, which sends part of it back to the base:
    /// `(1 − K)/(1 − E K)` with the base's albedo E (OpenPBR 1.1, 3.5.3). K is between that of mirror-like bases, of
    /// which light leaves as it came, and `1 − (1 − Ē)/η²` of diffuse ones. The factor is part of the coat's colour.
    fn darkening(&self, eta: f32, strength: f32) -> Spectrum {
        let diffuse = 1.0 - (1.0 - fresnel::dielectric_diffuse_fit(eta)) / (eta * eta);
        let metallic = self.metallic.weight();
        let rough = 1.0 - metallic * (1.0 - self.facets.mean_alpha().sqrt());
        let back = fresnel::f0_from_eta(eta) * (1.0 - rough) + diffuse * rough;
        let bare = Self { coat: Unit(0), coat_color: Unit4::ONE, ..*self };
        let albedo = bare.albedo_estimate(Vec3::Z);
        albedo.map(|e| 1.0 + ((1.0 - back) / (1.0 - e * back) - 1.0) * strength)
    }

    /// The least f0 of a Schlick reflectance that is nowhere below the dielectric's.
    fn least_f0_above(&self) -> f32 {
        let f90 = self.f90.get();
        let at = |i: u8| {
            let cos = f32::from(i) / 16.0;
            let s = schlick_weight(cos);
            (self.dielectric(cos).max_element() - f90 * s) / (1.0 - s)
        };
        (1..=16).map(at).fold(self.f0.most(), f32::max) + 0.01
    }

    #[inline]
    fn coat_facets(&self) -> Microfacet {
        match self.coat_alpha.map(Unit::get) {
            [x, y] if x == y => Microfacet::isotropic(x),
            // A coat with a normal of its own has no direction along.
            [x, y] if self.is_coat_tilted() => Microfacet::isotropic((x * y).sqrt()),
            [x, y] => Microfacet::ggx(x, y),
        }
    }

    /// Gives the coat a normal of its own, in the frame of the base.
    pub fn set_coat_normal(&mut self, n: Vec3) {
        self.coat_normal = if self.coat.0 > 0 { Unit3::new(n) } else { Unit3::Z };
    }

    /// True if the coat has a normal of its own.
    #[inline]
    fn is_coat_tilted(&self) -> bool {
        self.coat_normal != Unit3::Z
    }

    /// Cosine at which a direction crosses the coat.
    #[inline]
    fn coat_cos(&self, w: Vec3) -> f32 {
        if self.is_coat_tilted() { self.coat_normal.get().dot(w).abs().min(1.0) } else { w.z.abs() }
    }

    /// Directions in the frame of the coat; `None` if the coat reflects no light between them.
    #[inline]
    fn over_coat<const N: usize>(&self, directions: [Vec3; N]) -> Option<[Vec3; N]> {
        if !self.is_coat_tilted() {
            return Some(directions);
        }
        let frame = Frame::from_z(self.coat_normal.get());
        let local = directions.map(|w| frame.to_local(w));
        local.iter().all(|w| w.z > 0.0).then_some(local)
    }

    fn refracts(&self) -> bool {
        !self.grain.is_thin() && !self.refracted.is_black()
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
        let (f0, f90) = (self.f0.get(), self.f90.get());
        let bare = f0 + (Spectrum::splat(f90) - f0) * schlick_weight(outside);
        if f90 > 0.0 { self.filmed(outside, bare, f0 / f90, f90) } else { bare }
    }

    /// A reflectance as the film changes it, over a base of reflectance `f0` at normal incidence; `factor` is on all of
    /// it.
    #[inline]
    fn filmed(&self, cos: f32, bare: Spectrum, f0: Spectrum, factor: f32) -> Spectrum {
        if self.film_weight.0 == 0 {
            return bare;
        }
        let root = f0.clamp(0.0, 0.9999).sqrt();
        let index = root.map(|r| (1.0 + r) / (1.0 - r));
        let film = self.film.reflectance(cos, index, Spectrum::ZERO) * factor;
        bare + (film - bare) * self.film_weight.get()
    }

    /// Reflectance of base facets from outside.
    fn reflectance(&self, cos: f32) -> Spectrum {
        let dielectric = self.dielectric(cos);
        let metallic = self.metallic.weight();
        if metallic == 0.0 {
            return dielectric;
        }
        let w = schlick_weight(cos);
        let metal = self.filmed(cos, self.hoffman(w, cos * (1.0 - cos) * w), self.metal.get(), 1.0);
        dielectric * (1.0 - metallic) + metal * metallic
    }

    /// Reflectance of the bare metal by `(1 − c)⁵` and `c (1 − c)⁶`, in which it is linear.
    #[inline]
    fn hoffman(&self, w: f32, edge: f32) -> Spectrum {
        let base = self.metal.get();
        let schlick = |w: f32| base + (Spectrum::ONE - base) * w;
        // Hoffman's term is the lack at cos = 1/7, brought to zero at normal and grazing incidence.
        let lack = schlick((6.0f32 / 7.0).powi(5)) * (Spectrum::ONE - self.edge.get());
        (schlick(w) - lack * (edge * (7.0 * (7.0f32 / 6.0).powi(6)))).clamp(0.0, 1.0)
    }

    /// Light between the facets of the metal, as it is seen; under a film the reflectance of the bare metal
    /// counts.
    fn between_facets(&self, wo: Vec3) -> Option<BetweenFacets> {
        let metallic = self.metallic.weight();
        if !self.metallic.is_followed() || self.facets.is_smooth() {
            return None;
        }
        // The means of both terms over the cosine.
        let mean = self.hoffman(1.0 / 21.0, 1.0 / 126.0);
        Some(BetweenFacets::new(&self.facets, mean, metallic, wo))
    }

    /// Reflectance of base facets from the side that the cosine is on.
    #[inline]
    fn reflectance_from(&self, cos: f32) -> Spectrum {
        if cos >= 0.0 { self.reflectance(cos) } else { self.dielectric(cos) }
    }

    /// `1 − E` of the dielectric reflection, its strongest lane.
    fn below(&self, row: albedo_table::Row, cos: f32) -> f32 {
        let [a, b] = albedo_table::ggx(row, cos.abs());
        (1.0 - self.bound.get() * a - self.f90.get() * b).clamp(0.0, 1.0)
    }

    /// `B/π cosθ_i` of light that is seen so.
    fn lambert(&self, seen: &Seen, wi: Vec3) -> f32 {
        let [a, b] = albedo_table::ggx_mean(seen.row);
        let mean = (1.0 - self.bound.get() * a - self.f90.get() * b).max(1e-3);
        seen.below * self.below(seen.row, wi.z) / mean * FRAC_1_PI * wi.z.abs()
    }

    fn coat_albedo(&self, cos: f32) -> f32 {
        if self.coat.0 == 0 {
            return 0.0;
        }
        let [a, b] = albedo_table::ggx(albedo_table::row(self.coat_facets().mean_alpha()), cos);
        self.coat.get() * (self.coat_f0.get() * a + b)
    }

    /// Transmittance of the sheen to the layers below it at one cosine.
    fn sheen_leaves(&self, cos: f32) -> f32 {
        if self.sheen.is_black() {
            return 1.0;
        }
        1.0 - self.sheen.most() * albedo_table::sheen(self.sheen_alpha.get(), cos)
    }

    /// Transmittance of the coat, with its colour, for light that crosses it at these cosines.
    fn coat_leaves(&self, cosines: &[f32]) -> Spectrum {
        if self.coat.0 == 0 {
            return Spectrum::ONE;
        }
        let most = cosines.iter().map(|c| self.coat_albedo(*c)).fold(0.0, f32::max);
        self.coat_color_kept(cosines) * (1.0 - most)
    }

    /// Transmittance of the coat's colour alone for light that crosses it at these cosines.
    #[inline(always)]
    fn coat_color_kept(&self, cosines: &[f32]) -> Spectrum {
        let white = self.coat_color == Unit4::ONE;
        let kept = if white {
            Spectrum::ONE
        } else {
            // Half of the colour's two ways each, along the direction refracted at an index of 1.5.
            let way: f32 = cosines.iter().map(|c| 0.5 / (1.0 - (1.0 - c * c) / 2.25).sqrt()).sum();
            self.coat_color.get().map(|c| pow(c, way))
        };
        Spectrum::ONE + (kept - Spectrum::ONE) * self.coat.get()
    }

    /// Reflectance of the coat's facets.
    #[inline]
    fn coat_reflectance(&self, cos: f32) -> f32 {
        let f0 = self.coat_f0.get();
        self.coat.get() * (f0 + (1.0 - f0) * schlick_weight(cos))
    }

    fn seen_from(&self, wo: Vec3) -> Seen {
        let cos = wo.z.abs();
        let row = albedo_table::row(self.facets.mean_alpha());
        let [a, b] = albedo_table::ggx(row, cos);
        // Of a coat that is turned away nothing is drawn.
        let coat = if self.over_coat([wo]).is_some() { self.coat_albedo(self.coat_cos(wo)) } else { 0.0 };
        let (metallic, film) = (self.metallic.weight(), 0.5 * self.film_weight.get());
        let dielectric = self.bound.get() * a + self.f90.get() * b;
        let lobe = self.between_facets(wo);
        let [lost, regained] = lobe.map_or([0.0; 2], |m| [m.lost, m.albedo().max_element()]);
        let metal = (1.0 - lost) * self.metal.most().max(b).max(film);
        let reflected = metallic * metal + (1.0 - metallic) * dielectric;
        let facets = (1.0 - coat) * (reflected + self.refracted.most()).max(0.02);
        let below = (1.0 - dielectric).clamp(0.0, 1.0);
        let sheen = 1.0 - self.sheen_leaves(cos);
        let diffuse = (1.0 - coat) * below * (self.diffuse.most() + self.through.most()) + sheen;
        let between = (1.0 - coat) * regained;
        let inverse = 1.0 / (coat + facets + between + diffuse);
        let [coat, facets, between, diffuse] = [coat, facets, between, diffuse].map(|part| part * inverse);
        Seen { coat, facets, between, diffuse, below, row, lobe }
    }

    /// Factors of light in two sums; `None` with layers on top, and where light passes.
    pub(super) fn split_sum(&self, wo: Vec3) -> Option<SplitSum> {
        let cos = wo.z;
        let is_layered = self.coat.0 > 0 || !self.sheen.is_black() || self.film_weight.0 > 0;
        if is_layered || !self.refracted.is_black() || !self.through.is_black() {
            return None;
        }
        let (alpha, metallic) = (self.facets.mean_alpha(), self.metallic.weight());
        let row = albedo_table::row(alpha);
        let [a, b] = albedo_table::ggx(row, cos);
        let dielectric = self.f0.get() * a + Spectrum::splat(self.f90.get() * b);
        let metal = self.metal.get() * a + Spectrum::splat(b);
        let facets = dielectric * (1.0 - metallic) + metal * metallic;
        let facets = if self.facets.is_smooth() { Spectrum::ZERO } else { facets };
        let between = self.between_facets(wo).map_or(Spectrum::ZERO, |m| m.albedo());
        Some(SplitSum { alpha, facets, diffuse: self.diffuse.get() * self.below(row, cos) + between })
    }

    /// True if diffuse light goes through.
    #[inline]
    fn passes_diffusely(&self) -> bool {
        self.below == 0 && !self.through.is_black()
    }

    /// Sample of the light that goes below the surface, to leave elsewhere.
    fn entering(&self, wo: Vec3, c: &Seen) -> BsdfSample {
        let cos = self.coat_cos(wo);
        let kept = self.coat_color_kept(&[cos, 2.0 / 3.0]) * ((1.0 - self.coat_albedo(cos)) * self.sheen_leaves(wo.z));
        let share = f32::from(self.below) * (1.0 / 255.0) * c.below;
        let chance = c.diffuse * self.through_part();
        BsdfSample::entering(kept * (share / chance), chance)
    }

    /// The part of the diffuse draws that goes through, or below.
    fn through_part(&self) -> f32 {
        if self.through.is_black() {
            return 0.0;
        }
        let through = self.through.most();
        through / (through + self.diffuse.most() + self.sheen.most())
    }

    /// The part of the facets' draws that is reflected.
    fn reflecting_part(&self, f: Spectrum) -> f32 {
        if self.refracted.is_black() {
            return 1.0;
        }
        let (r, t) = (f.max_element(), self.refracted.most() * (1.0 - f.0.min_element()));
        if t > 0.0 { r / (r + t) } else { 1.0 }
    }

    /// The value for light that leaves outside and is seen so.
    fn eval_outside(&self, c: &Seen, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        let mut e = BsdfEval::ZERO;
        let is_rough = !self.facets.is_smooth();
        if wi.z > 0.0 {
            if is_rough && let Some(facet) = self.facets.reflecting(wo, wi) {
                let f = self.reflectance(facet.cos_o);
                e.value = f * facet.value;
                e.pdf = c.facets * self.reflecting_part(f) * facet.pdf;
            }
            if !self.diffuse.is_black() {
                let mut diffuse = self.diffuse.get();
                if self.grain.roughness() > 0.0 {
                    diffuse *= over_lambert(self.metal.get(), self.grain.roughness(), wo, wi);
                }
                e.value += diffuse * self.lambert(c, wi);
            }
            if let Some(lobe) = &c.lobe {
                e.value += lobe.value(wi);
                e.pdf += c.between * lobe.pdf(wi);
            }
            e.pdf += c.diffuse * (1.0 - self.through_part()) * FRAC_1_PI * wi.z;
            if !self.sheen.is_black() {
                e.value *= self.sheen_leaves(wo.z).min(self.sheen_leaves(wi.z));
                e.value += self.sheen.get() * sheen::value(self.sheen_alpha.get(), wo, wi);
            }
            if self.coat.0 > 0 {
                e.value *= self.coat_leaves(&[self.coat_cos(wo), self.coat_cos(wi)]);
                let facets = self.coat_facets();
                if !facets.is_smooth()
                    && let Some([wo, wi]) = self.over_coat([wo, wi])
                    && let Some(facet) = facets.reflecting(wo, wi)
                {
                    e.value += Spectrum::splat(self.coat_reflectance(facet.cos_o) * facet.value);
                    e.pdf += c.coat * facet.pdf;
                }
            }
            return e;
        }
        if !is_rough {
            // Light that goes through does so in one direction.
        } else if self.refracts() {
            if let Some(facet) = self.facets.refracting(wo, wi, self.eta) {
                let (value, p) = self.transmitted(facet.cos_o);
                let layers = self.coat_leaves(&[self.coat_cos(wo)]) * self.sheen_leaves(wo.z);
                e.value = value * layers * (facet.value * mode.compression(self.eta));
                e.pdf = c.facets * p * facet.pdf;
            }
        } else if !self.refracted.is_black()
            && let Some(facet) = self.facets.reflecting(wo, Vec3::new(wi.x, wi.y, -wi.z))
        {
            let (value, p) = self.transmitted(facet.cos_o);
            e.value = value * facet.value * self.layers(wo, wi);
            e.pdf = c.facets * p * facet.pdf;
        }
        if self.passes_diffusely() {
            e.value += self.through.get() * self.layers(wo, wi) * self.lambert(c, wi);
            e.pdf += c.diffuse * self.through_part() * FRAC_1_PI * -wi.z;
        }
        e
    }

    /// Transmittance of the layers for light between two directions.
    fn layers(&self, a: Vec3, b: Vec3) -> Spectrum {
        let sheen = self.sheen_leaves(a.z.abs()).min(self.sheen_leaves(b.z.abs()));
        self.coat_leaves(&[self.coat_cos(a), self.coat_cos(b)]) * sheen
    }

    /// Transmission of a facet, and the part of its samples that are transmitted.
    fn transmitted(&self, cos: f32) -> (Spectrum, f32) {
        let passing = 1.0 - self.reflecting_part(self.reflectance_from(cos));
        (self.refracted.get() * (Spectrum::ONE - self.dielectric(cos)), passing)
    }

    fn eval_inside(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        if self.facets.is_smooth() {
            return BsdfEval::ZERO;
        }
        let eta = 1.0 / self.eta;
        if wi.z < 0.0 {
            return self.facets.reflecting(wo, wi).map_or(BsdfEval::ZERO, |facet| {
                let f = self.dielectric(facet.cos_o);
                BsdfEval { value: f * facet.value, pdf: self.reflecting_part(f) * facet.pdf }
            });
        }
        self.facets.refracting(wo, wi, eta).map_or(BsdfEval::ZERO, |facet| {
            let (value, p) = self.transmitted(facet.cos_o);
            let layers = self.coat_leaves(&[self.coat_cos(wi)]) * self.sheen_leaves(wi.z);
            BsdfEval { value: value * layers * (facet.value * mode.compression(eta)), pdf: p * facet.pdf }
        })
    }

    /// Mirror reflection by all that is smooth: coat and base send light the same way. From inside there is the base
    /// alone.
    fn mirrored(&self, wo: Vec3, c: &Seen) -> BsdfSample {
        let (mut value, mut chance) = (Spectrum::ZERO, 0.0);
        if self.facets.is_smooth() {
            let f = self.reflectance_from(wo.z);
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            value = if wo.z > 0.0 { f * self.layers(wo, wi) } else { f };
            chance = c.facets * self.reflecting_part(f);
        }
        if c.coat > 0.0 && self.coat_facets().is_smooth() && !self.is_coat_tilted() {
            value += Spectrum::splat(self.coat_reflectance(wo.z));
            chance += c.coat;
        }
        BsdfSample::mirrored(wo, value / chance, chance)
    }

    /// Mirror reflection by a smooth coat with a normal of its own.
    fn mirrored_by_coat(&self, wo: Vec3, c: &Seen, mode: TransportMode) -> Option<BsdfSample> {
        let n = self.coat_normal.get();
        let cos = n.dot(wo);
        let wi = (n * (2.0 * cos) - wo).normalize();
        // The adjoint exchanges the cosines to the base.
        let turn = if mode == TransportMode::Importance { wi.z / wo.z } else { 1.0 };
        let weight = Spectrum::splat(self.coat_reflectance(cos.min(1.0)) * turn / c.coat);
        let lobe = Lobe::REFLECTION.with(Lobe::SPECULAR);
        (wi.z > 0.0).then_some(BsdfSample { wi, weight, pdf: c.coat, lobe, eta: 1.0 })
    }

    /// Light that smooth facets of the base let pass.
    fn passed(&self, wo: Vec3, c: &Seen, mode: TransportMode) -> Option<BsdfSample> {
        let (value, passing) = self.transmitted(wo.z);
        let (pdf, lobe) = (c.facets * passing, Lobe::TRANSMISSION.with(Lobe::SPECULAR));
        if self.grain.is_thin() {
            let weight = value * self.layers(wo, -wo) / pdf;
            return Some(BsdfSample { wi: -wo, weight, pdf, lobe, eta: 1.0 });
        }
        let (wi, eta) = fresnel::refract(wo, Vec3::Z, self.eta)?;
        let above = if wo.z > wi.z { wo } else { wi };
        let layers = self.coat_leaves(&[self.coat_cos(above)]) * self.sheen_leaves(above.z);
        Some(BsdfSample { wi, weight: value * layers * (mode.compression(eta) / pdf), pdf, lobe, eta })
    }
}

impl Scatter for Pbr {
    const MODELS: &'static [Model] = &[
        Model::new("pbr", "the surface of glTF and OpenPBR", cases),
        Model::new("pbr_tilted_coat", "the same under a coat with a normal of its own", tilted_cases).not_reciprocal(),
    ];

    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        if wo.z == 0.0 || wi.z == 0.0 {
            return BsdfEval::ZERO;
        }
        if wo.z > 0.0 {
            return self.eval_outside(&self.seen_from(wo), wo, wi, mode);
        }
        if self.refracts() {
            self.eval_inside(wo, wi, mode)
        } else if self.transmits() {
            self.eval_outside(&self.seen_from(-wo), -wo, -wi, mode)
        } else {
            BsdfEval::ZERO
        }
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.z == 0.0 || (wo.z < 0.0 && !self.transmits()) {
            return None;
        }
        let is_inside = wo.z < 0.0 && self.refracts();
        let turn = if wo.z < 0.0 && !is_inside { -1.0 } else { 1.0 };
        let seen = wo * turn;
        let c = if is_inside { Seen { facets: 1.0, ..Seen::default() } } else { self.seen_from(seen) };
        let mut eta = 1.0;
        let (wi, lobe) = if u < c.coat {
            let facets = self.coat_facets();
            if facets.is_smooth() {
                let s = if self.is_coat_tilted() {
                    self.mirrored_by_coat(seen, &c, mode)?
                } else {
                    self.mirrored(seen, &c)
                };
                return Some(BsdfSample { wi: s.wi * turn, ..s });
            }
            let [own] = self.over_coat([seen])?;
            let mirrored = facets.draw(own, u2).mirrored(own);
            if self.is_coat_tilted() && mirrored.z <= 0.0 {
                return None;
            }
            let wi =
                if self.is_coat_tilted() { Frame::from_z(self.coat_normal.get()).to_world(mirrored) } else { mirrored };
            (wi, Lobe::GLOSSY)
        } else if u < c.coat + c.facets {
            let u = ((u - c.coat) / c.facets).min(ONE_MINUS_EPSILON);
            if self.facets.is_smooth() {
                let s = if u < self.reflecting_part(self.reflectance_from(seen.z)) {
                    self.mirrored(seen, &c)
                } else {
                    self.passed(seen, &c, mode)?
                };
                return Some(BsdfSample { wi: s.wi * turn, ..s });
            }
            let n = self.facets.draw(seen, u2);
            if u < self.reflecting_part(self.reflectance_from(n.cos_o())) {
                (n.mirrored(seen), Lobe::GLOSSY)
            } else if self.grain.is_thin() {
                let w = n.mirrored(seen);
                (Vec3::new(w.x, w.y, -w.z), Lobe::GLOSSY.with(Lobe::TRANSMISSION))
            } else {
                let (w, relative) = n.refracted(seen, &n.crossing(self.eta))?;
                eta = relative;
                (w, Lobe::GLOSSY.with(Lobe::TRANSMISSION))
            }
        } else if let Some(lobe) = &c.lobe
            && u < c.coat + c.facets + c.between
        {
            (lobe.draw(u2), Lobe::DIFFUSE)
        } else {
            let w = sample_cosine_hemisphere(u2)?;
            let u = (u - c.coat - c.facets - c.between) / c.diffuse;
            if self.below > 0 && u < self.through_part() {
                return Some(self.entering(seen, &c));
            }
            if u < self.through_part() { (-w, Lobe::DIFFUSE.with(Lobe::TRANSMISSION)) } else { (w, Lobe::DIFFUSE) }
        };
        if (seen.z * wi.z < 0.0) != lobe.is_transmission() {
            return None;
        }
        let lobe = if lobe.is_transmission() { lobe } else { lobe.with(Lobe::REFLECTION) };
        let e = if is_inside { self.eval_inside(seen, wi, mode) } else { self.eval_outside(&c, seen, wi, mode) };
        e.drawn(wi * turn, lobe, eta)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let cos = wo.z.abs();
        let below = (self.diffuse.get() + self.through.get() + self.refracted.get())
            * self.below(albedo_table::row(self.facets.mean_alpha()), cos);
        let under = self.reflectance(cos) + below;
        let sheen = self.sheen.get() * albedo_table::sheen(self.sheen_alpha.get(), cos);
        let coat_cos = self.coat_cos(wo);
        let layered = (under * self.sheen_leaves(cos) + sheen) * self.coat_leaves(&[coat_cos, coat_cos]);
        (layered + Spectrum::splat(self.coat_albedo(coat_cos))).clamp(0.0, 1.0)
    }

    fn is_specular(&self) -> bool {
        let smooth_coat = self.coat.0 == 0 || self.coat_facets().is_smooth();
        let nothing_else = self.diffuse.is_black() && self.sheen.is_black() && !self.passes_diffusely();
        self.facets.is_smooth() && smooth_coat && nothing_else
    }

    fn transmits(&self) -> bool {
        !self.refracted.is_black() || self.passes_diffusely()
    }

    #[inline]
    fn is_reciprocal(&self) -> bool {
        // What a smooth coat mirrors knows its adjoint.
        !self.is_coat_tilted() || self.coat_facets().is_smooth()
    }

    #[inline]
    fn relative_eta(&self) -> f32 {
        self.eta()
    }
}

/// Parameters of the cases: a grey dielectric, moderately rough.
pub(super) fn plain() -> PbrParams {
    PbrParams {
        base_color: GREY,
        diffuse_roughness: 0.0,
        metallic: 0.0,
        facets: Microfacet::ggx(0.3, 0.3),
        eta: 1.5,
        specular: 1.0,
        specular_color: Spectrum::ONE,
        transmission: 0.0,
        transmission_color: GREY,
        thin: true,
        diffuse_transmission: 0.0,
        diffuse_transmission_color: GREY,
        sheen_color: Spectrum::ZERO,
        sheen_roughness: 0.5,
        coat: 0.0,
        coat_facets: Microfacet::ggx(0.1, 0.1),
        coat_eta: 1.5,
        coat_color: Spectrum::ONE,
        coat_darkening: 0.0,
        convention: Convention::Gltf,
        film: ThinFilm::new(1.3, 0.0, None),
        film_weight: 0.0,
        subsurface: SubsurfacePart::NONE,
    }
}

fn cases(visit: &mut Visitor<'_>) {
    let mut furnace = |label, params: PbrParams, lossless| {
        visit(Case { label, bsdf: Bsdf::Pbr(Pbr::new(&params)), lossless });
    };
    let p = plain();
    let white = PbrParams { base_color: Spectrum::ONE, ..p };
    let clear = PbrParams { transmission: 1.0, transmission_color: Spectrum::ONE, facets: Microfacet::SMOOTH, ..white };
    furnace("smooth pane", clear, true);
    furnace("smooth glass", PbrParams { thin: false, ..clear }, true);
    let oxide = ThinFilm::new(2.2, 900.0, Some([450.0, 500.0, 560.0, 640.0]));
    furnace("film on a smooth pane", PbrParams { film: oxide, film_weight: 1.0, ..clear }, true);
    let metal = PbrParams { metallic: 1.0, convention: Convention::OpenPbr, ..white };
    furnace("white metal, 0.1", PbrParams { facets: Microfacet::ggx(0.1, 0.1), ..metal }, true);
    furnace("white metal, 0.5", PbrParams { facets: Microfacet::ggx(0.5, 0.5), ..metal }, true);
    furnace("white metal, 1", PbrParams { facets: Microfacet::ggx(1.0, 1.0), ..metal }, true);
    let mut case = |label, params: PbrParams| furnace(label, params, false);
    case("plain", p);
    case("smooth metal", PbrParams { metallic: 1.0, facets: Microfacet::SMOOTH, ..p });
    case("smooth, white", PbrParams { facets: Microfacet::SMOOTH, ..white });
    let smooth_coat = PbrParams { coat: 0.8, coat_facets: Microfacet::SMOOTH, ..white };
    case("smooth lacquer", smooth_coat);
    case("smooth lacquer on smooth coloured glass", PbrParams { thin: false, coat_color: GREY, ..clear });
    case(
        "smooth lacquer on smooth glass",
        PbrParams { thin: false, coat: 1.0, coat_facets: Microfacet::SMOOTH, ..clear },
    );
    let soap = ThinFilm::new(1.33, 380.0, None);
    case("film on white", PbrParams { film: soap, film_weight: 1.0, ..white });
    case("film on metal", PbrParams { film: oxide, film_weight: 0.7, metallic: 0.6, ..white });
    case(
        "film on rough glass",
        PbrParams { film: soap, film_weight: 0.5, thin: false, facets: Microfacet::ggx(0.2, 0.2), ..clear },
    );
    case("white, rough", PbrParams { facets: Microfacet::ggx(1.0, 1.0), ..white });
    case("white, dense", PbrParams { eta: 2.4, facets: Microfacet::ggx(0.1, 0.1), ..white });
    case("metal, stretched", PbrParams { metallic: 1.0, facets: Microfacet::ggx(0.5, 0.1), ..p });
    case("metal with a dark edge", PbrParams { specular_color: GREY, ..metal });
    case(
        "metal with a dark edge, rough",
        PbrParams { specular_color: GREY, facets: Microfacet::ggx(0.8, 0.8), ..metal },
    );
    case("white metal, stretched", PbrParams { facets: Microfacet::ggx(0.5, 0.1), ..metal });
    case(
        "film on rough metal",
        PbrParams { film: oxide, film_weight: 1.0, facets: Microfacet::ggx(0.6, 0.6), ..metal },
    );
    let leafy = PbrParams { metallic: 0.5, diffuse_transmission: 0.6, facets: Microfacet::ggx(0.7, 0.7), ..metal };
    case("gilt leaf", PbrParams { diffuse_transmission_color: Spectrum::ONE, ..leafy });
    case("lacquered rough metal under fuzz", PbrParams { coat: 0.6, sheen_color: GREY, metallic: 0.8, ..leafy });
    case("cloth", PbrParams { sheen_color: Spectrum::ONE, sheen_roughness: 0.4, specular: 0.5, ..white });
    case("soft cloth", PbrParams { sheen_color: GREY, sheen_roughness: 1.0, specular: 0.0, ..white });
    let lacquer = PbrParams { coat: 1.0, coat_facets: Microfacet::ggx(0.2, 0.2), ..white };
    case("lacquer", lacquer);
    case("coloured lacquer on metal", PbrParams { coat_color: GREY, metallic: 1.0, coat: 0.7, ..lacquer });
    case("pane", PbrParams { transmission: 1.0, transmission_color: Spectrum::ONE, ..white });
    case("glass", PbrParams { transmission: 1.0, thin: false, ..p });
    case(
        "lacquered cloudy glass",
        PbrParams { transmission: 0.6, transmission_color: Spectrum::ONE, thin: false, eta: 1.3, ..lacquer },
    );
    case("clay", PbrParams { diffuse_roughness: 1.0, ..white });
    case("dark clay without gloss", PbrParams { diffuse_roughness: 0.6, specular: 0.0, ..p });
    case("brushed lacquer", PbrParams { coat_facets: Microfacet::ggx(0.4, 0.1), ..lacquer });
    case(
        "wet clay",
        PbrParams { coat_darkening: 1.0, diffuse_roughness: 1.0, coat_facets: Microfacet::SMOOTH, ..lacquer },
    );
    case("leaf", PbrParams { diffuse_transmission: 0.6, diffuse_transmission_color: Spectrum::ONE, ..white });
    let medium = SubsurfacePart { weight: 1.0, color: Spectrum::ONE, is_followed: true, g: 0.3 };
    case("smooth skin", PbrParams { facets: Microfacet::SMOOTH, thin: false, subsurface: medium, ..p });
    case("lacquered marble", PbrParams { coat_color: GREY, thin: false, subsurface: medium, ..lacquer });
    let half = SubsurfacePart { weight: 0.5, ..medium };
    case(
        "skin and glass under fuzz",
        PbrParams { transmission: 0.5, sheen_color: GREY, subsurface: half, thin: false, ..white },
    );
    case("a sheet of wax", PbrParams { subsurface: half, ..white });
    case(
        "all at once",
        PbrParams {
            metallic: 0.3,
            transmission: 0.4,
            diffuse_transmission: 0.5,
            sheen_color: GREY,
            coat: 0.5,
            specular: 0.7,
            specular_color: GREY,
            ..p
        },
    );
    // But for the mirrored light the surface below a smooth coat is reciprocal, however the coat is turned.
    let far = [-0.9, 0.6, 0.7];
    visit(tilted("tilted smooth lacquer", smooth_coat, [0.2, -0.1, 1.0]));
    let mirror = PbrParams { facets: Microfacet::SMOOTH, metallic: 1.0, ..smooth_coat };
    visit(tilted("tilted smooth lacquer on a mirror", mirror, far));
}

/// A case with the coat turned.
fn tilted(label: &'static str, params: PbrParams, normal: [f32; 3]) -> Case<'static> {
    let mut surface = Pbr::new(&params);
    surface.set_coat_normal(Vec3::from(normal));
    Case { label, bsdf: Bsdf::Pbr(surface), lossless: false }
}

/// Coats turned by moderate and by large angles, over each kind of base.
fn tilted_cases(visit: &mut Visitor<'_>) {
    let mut case = |label, params, normal| visit(tilted(label, params, normal));
    let p = PbrParams { coat: 1.0, coat_facets: Microfacet::ggx(0.2, 0.2), ..plain() };
    let white = PbrParams { base_color: Spectrum::ONE, ..p };
    let (slight, far) = ([0.2, -0.1, 1.0], [-0.9, 0.6, 0.7]);
    case("tilted lacquer", white, slight);
    case("lacquer that leans far", white, far);
    case("rough lacquer that leans far", PbrParams { coat_facets: Microfacet::ggx(0.8, 0.8), ..white }, far);
    case("tilted coloured lacquer on metal", PbrParams { coat_color: GREY, metallic: 1.0, coat: 0.7, ..p }, slight);
    case("tilted lacquer on cloth", PbrParams { sheen_color: Spectrum::ONE, coat: 0.5, ..white }, slight);
    let glass = PbrParams { transmission: 1.0, transmission_color: Spectrum::ONE, thin: false, ..white };
    case("tilted lacquer on glass", glass, slight);
    case("tilted lacquer on smooth glass", PbrParams { facets: Microfacet::SMOOTH, ..glass }, slight);
    case("tilted lacquer on a pane", PbrParams { thin: true, ..glass }, far);
    case("tilted lacquer on a leaf", PbrParams { diffuse_transmission: 0.6, ..white }, slight);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_reflectance_of_metal_is_the_integral() {
        let p = PbrParams { metallic: 1.0, specular_color: GREY, convention: Convention::OpenPbr, ..plain() };
        let (surface, n) = (Pbr::new(&p), 1000);
        let at = |i: u16| surface.reflectance(((f32::from(i) + 0.5) / 1000.0).sqrt());
        let sum = (0..n).map(at).fold(Spectrum::ZERO, |a, b| a + b) / f32::from(n);
        let mean = surface.hoffman(1.0 / 21.0, 1.0 / 126.0);
        assert!((0..4).all(|i| (sum[i] - mean[i]).abs() < 1e-4 && mean[i] < GREY[i]), "{sum:?} is not {mean:?}");
    }
}
