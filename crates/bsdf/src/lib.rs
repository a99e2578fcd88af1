#![doc = include_str!("../README.md")]
//!
//! # Conventions
//!
//! A material evaluates its textures at a hit into one [`Bsdf`]: a small `Copy` value that knows no texture, no scene
//! and no allocation. Directions are unit vectors in the local shading frame (`z` is the shading normal) and both `wo`
//! and `wi` point away from the surface. Models that only reflect are defined on the upper side and black below; a
//! caller that wants them on both sides flips the frame. Transmitting models work from both sides.
//!
//! Every formula is stated once: `sample` draws a direction and asks the same pieces that `eval` uses. The registry
//! [`MODELS`] lists every model with cases at the corners of its parameters, and the tests run the laws of scattering
//! (density, reciprocity, energy) over all of them.

mod albedo_table;
pub mod blinn_phong;
mod classical;
mod coat_colors;
pub mod coat_table;
pub mod coated;
pub mod conductor;
pub mod cook_torrance;
pub mod dielectric;
pub mod diffuse;
pub mod diffuse_transmission;
pub mod fresnel;
mod gaussian;
mod gtr1;
pub mod hair;
#[cfg(test)]
mod laws;
pub mod layered;
#[cfg(test)]
mod layered_walk;
mod lobe_over_diffuse;
mod masking;
pub mod measured;
pub mod microfacet;
pub mod minnaert;
pub mod multiple_scattering;
mod normal_distribution;
pub mod oren_nayar;
pub mod pbr;
pub mod phong;
pub mod polarized;
pub mod principled;
pub mod principled_thin;
#[cfg(test)]
mod printed_formulae;
#[cfg(test)]
mod reference_values;
pub mod reflectance;
pub mod registry;
mod sheen;
pub mod thin_dielectric;
pub mod thin_film;
mod visible_normals;
pub mod ward;

pub use blinn_phong::BlinnPhong;
pub use coat_table::{CoatSeries, CoatTable};
pub use coated::Coated;
pub use conductor::Conductor;
pub use cook_torrance::{CookTorrance, DiffuseCoupling};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use diffuse_transmission::DiffuseTransmission;
pub use hair::Hair;
pub use layered::Layered;
pub use measured::{Measured, MeasuredData};
pub use microfacet::{Microfacet, NormalDistribution, Shadowing};
pub use minnaert::Minnaert;
pub use multiple_scattering::{CompensatedConductor, Compensation, EnergyTable};
pub use normal_distribution::Tail;
pub use oren_nayar::{OrenNayar, OrenNayarForm};
pub use pbr::Pbr;
pub use phong::Phong;
pub use principled::Principled;
pub use principled_thin::PrincipledThin;
pub use reflectance::Reflectance;
pub use registry::{MODELS, Model};
pub use thin_dielectric::ThinDielectric;
pub use thin_film::ThinFilm;
pub use ward::{Ward, WardForm};

use steradian_math::{Spectrum, Vec2, Vec3, warp};

/// Which lobe produced a sample: a set of properties.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Lobe(u8);

impl Lobe {
    /// The sample stays on the side of `wo`.
    pub const REFLECTION: Self = Self(1);
    /// The sample goes to the other side.
    pub const TRANSMISSION: Self = Self(2);
    /// Scattered over the whole hemisphere.
    pub const DIFFUSE: Self = Self(4);
    /// Scattered around a direction.
    pub const GLOSSY: Self = Self(8);
    /// Exactly one direction: a delta distribution, never met by chance.
    pub const SPECULAR: Self = Self(16);

    /// Both sets together.
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether every property of `other` is in this set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether the lobe is a delta distribution.
    pub const fn is_specular(self) -> bool {
        self.contains(Self::SPECULAR)
    }

    /// Whether the sample crossed the surface.
    pub const fn is_transmission(self) -> bool {
        self.contains(Self::TRANSMISSION)
    }

    /// Whether the lobe is diffuse.
    pub const fn is_diffuse(self) -> bool {
        self.contains(Self::DIFFUSE)
    }

    /// Whether the lobe is glossy.
    pub const fn is_glossy(self) -> bool {
        self.contains(Self::GLOSSY)
    }
}

/// A direction drawn from a [`Bsdf`].
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The drawn direction, away from the surface.
    pub wi: Vec3,
    /// `f·|cosθ_i| / pdf`: what a path's throughput is multiplied by.
    pub weight: Spectrum,
    /// Solid-angle density of `wi` (sr⁻¹); for a specular lobe the probability with which it was chosen.
    pub pdf: f32,
    /// Where the sample came from.
    pub lobe: Lobe,
    /// Relative index of refraction met by a transmitted ray (`η_t/η_i`), else 1. Russian roulette multiplies the
    /// throughput by its square to leave the compression of radiance out of account.
    pub eta: f32,
}

/// The value of a [`Bsdf`] for a pair of directions; specular lobes have no part in it.
#[derive(Clone, Copy, Debug, Default)]
pub struct BsdfEval {
    /// `f·|cosθ_i|` (sr⁻¹).
    pub value: Spectrum,
    /// Density with which [`Bsdf::sample`] draws `wi` (sr⁻¹).
    pub pdf: f32,
}

impl BsdfEval {
    /// No light, never sampled.
    pub const ZERO: Self = Self { value: Spectrum::ZERO, pdf: 0.0 };

    /// The sample of a direction of this value that was drawn with this density; `None` where that is no number to
    /// divide by.
    #[inline]
    pub(crate) fn drawn(self, wi: Vec3, lobe: Lobe, eta: f32) -> Option<BsdfSample> {
        self.drawn_if(true, wi, lobe, eta)
    }

    /// The same for reflection; `None` below the surface too.
    #[inline]
    pub(crate) fn drawn_above(self, wi: Vec3, lobe: Lobe) -> Option<BsdfSample> {
        self.drawn_if(wi.z > 0.0, wi, lobe, 1.0)
    }

    /// One decision over all that may be unsound.
    #[inline(always)]
    fn drawn_if(self, is_possible: bool, wi: Vec3, lobe: Lobe, eta: f32) -> Option<BsdfSample> {
        let weight = self.value / self.pdf;
        let is_sound = is_possible & (self.pdf > 0.0) & (self.pdf < f32::INFINITY) & weight.is_finite();
        is_sound.then_some(BsdfSample { wi, weight, pdf: self.pdf, lobe, eta })
    }
}

impl BsdfSample {
    /// Mirror reflection at the surface, chosen with a probability.
    #[inline]
    pub(crate) fn mirrored(wo: Vec3, weight: Spectrum, probability: f32) -> Self {
        let lobe = Lobe::REFLECTION.with(Lobe::SPECULAR);
        Self { wi: Vec3::new(-wo.x, -wo.y, wo.z), weight, pdf: probability, lobe, eta: 1.0 }
    }
}

/// What is being carried along a path: the two differ where light is refracted (Veach 1997, 5.2).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TransportMode {
    /// Radiance, for paths that start at the eye: scaled by `(η_i/η_t)²` on refraction.
    Radiance,
    /// Importance, for paths that start at a light: not scaled.
    Importance,
}

impl TransportMode {
    /// The mode of the path walked backwards.
    pub const fn adjoint(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }

    /// The factor on transmitted light whose relative index is `eta = η_t/η_i`.
    #[inline]
    pub(crate) fn compression(self, eta: f32) -> f32 {
        match self {
            Self::Radiance => 1.0 / (eta * eta),
            Self::Importance => 1.0,
        }
    }
}

/// How a surface scatters light at one point.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<'a> {
    /// Lambertian reflection.
    Diffuse(Diffuse),
    /// Lambertian reflection and transmission.
    DiffuseTransmission(DiffuseTransmission),
    /// A metal, smooth or rough; also the perfect mirror.
    Conductor(Conductor),
    /// Glass and liquids, smooth or rough.
    Dielectric(Dielectric),
    /// A pane that refracts in and out again.
    ThinDielectric(ThinDielectric),
    /// A dielectric coat over a diffuse base: plastic, varnish.
    Coated(Coated<'a>),
    /// Rough diffuse reflection.
    OrenNayar(OrenNayar),
    /// Minnaert's law.
    Minnaert(Minnaert),
    /// A cosine lobe over a diffuse part: Phong, Lafortune.
    Phong(Phong),
    /// A lobe in the half vector over a diffuse part.
    BlinnPhong(BlinnPhong),
    /// A Gaussian lobe over a diffuse part.
    Ward(Ward),
    /// Facets of any reflectance over a diffuse part.
    CookTorrance(CookTorrance),
    /// A rough metal with light between its facets.
    CompensatedConductor(CompensatedConductor<'a>),
    /// Tabulated reflection.
    Measured(Measured<'a>),
    /// A fibre.
    Hair(Hair),
    /// A coat over a metal or a diffuse base, by random walks.
    Layered(Layered),
    /// The surface of glTF and OpenPBR.
    Pbr(Pbr),
    /// Disney's surface.
    Principled(Principled),
    /// Disney's thin sheet.
    PrincipledThin(PrincipledThin),
}

const _: () = assert!(size_of::<Bsdf<'static>>() <= 128, "a Bsdf is copied at every hit");

impl Bsdf<'_> {
    /// `f·|cosθ_i|` and the density with which [`Bsdf::sample`] draws `wi`; both zero for specular lobes. The value for
    /// importance is that for radiance with the directions exchanged (Veach 1997, 5.2), which for most models is the
    /// same.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        if mode == TransportMode::Radiance || !self.is_one_way() {
            return self.eval_of_model(wo, wi, mode);
        }
        let e = self.eval_of_model(wo, wi, mode);
        let back = self.eval_of_model(wi, wo, TransportMode::Radiance).value;
        let cosines = if wo.z.abs() > 1e-6 { (wi.z / wo.z).abs() } else { 0.0 };
        BsdfEval { value: back * cosines, pdf: e.pdf }
    }

    /// Whether it is another surface with the two directions exchanged.
    #[inline]
    fn is_one_way(&self) -> bool {
        match self {
            Self::Phong(b) => !b.is_reciprocal(),
            Self::BlinnPhong(b) => !b.is_reciprocal(),
            Self::CompensatedConductor(b) => !b.is_reciprocal(),
            Self::Measured(_) | Self::Hair(_) => true,
            _ => false,
        }
    }

    #[inline]
    fn eval_of_model(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        match self {
            Self::Diffuse(b) => b.eval(wo, wi),
            Self::DiffuseTransmission(b) => b.eval(wo, wi),
            Self::Conductor(b) => b.eval(wo, wi),
            Self::Dielectric(b) => b.eval(wo, wi, mode),
            Self::ThinDielectric(_) => BsdfEval::ZERO,
            Self::Coated(b) => b.eval(wo, wi),
            Self::OrenNayar(b) => b.eval(wo, wi),
            Self::Minnaert(b) => b.eval(wo, wi),
            Self::Phong(b) => b.eval(wo, wi),
            Self::BlinnPhong(b) => b.eval(wo, wi),
            Self::Ward(b) => b.eval(wo, wi),
            Self::CookTorrance(b) => b.eval(wo, wi),
            Self::CompensatedConductor(b) => b.eval(wo, wi),
            Self::Measured(b) => b.eval(wo, wi),
            Self::Hair(b) => b.eval(wo, wi),
            Self::Layered(b) => b.eval(wo, wi),
            Self::Pbr(b) => b.eval(wo, wi, mode),
            Self::Principled(b) => b.eval(wo, wi, mode),
            Self::PrincipledThin(b) => b.eval(wo, wi),
        }
    }

    /// Draws a direction: `u` (in `[0, 1)`) chooses the lobe, `u2` (in `[0, 1)²`) the direction in it. `None` where the
    /// surface scatters nothing or the draw fell outside of the model (it counts as black).
    #[inline]
    pub fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if mode == TransportMode::Radiance || !self.is_one_way() {
            return self.sample_of_model(wo, u, u2, mode);
        }
        let mut drawn = self.sample_of_model(wo, u, u2, mode)?;
        if !drawn.lobe.is_specular() {
            drawn.weight = self.eval(wo, drawn.wi, mode).value / drawn.pdf;
        }
        Some(drawn)
    }

    #[inline]
    fn sample_of_model(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        match self {
            Self::Diffuse(b) => b.sample(wo, u2),
            Self::DiffuseTransmission(b) => b.sample(wo, u, u2),
            Self::Conductor(b) => b.sample(wo, u2),
            Self::Dielectric(b) => b.sample(wo, u, u2, mode),
            Self::ThinDielectric(b) => b.sample(wo, u),
            Self::Coated(b) => b.sample(wo, u, u2),
            Self::OrenNayar(b) => b.sample(wo, u2),
            Self::Minnaert(b) => b.sample(wo, u2),
            Self::Phong(b) => b.sample(wo, u.into(), u2),
            Self::BlinnPhong(b) => b.sample(wo, u.into(), u2),
            Self::Ward(b) => b.sample(wo, u.into(), u2),
            Self::CookTorrance(b) => b.sample(wo, u, u2),
            Self::CompensatedConductor(b) => b.sample(wo, u, u2),
            Self::Measured(b) => b.sample(wo, u, u2),
            Self::Hair(b) => b.sample(wo, u, u2),
            Self::Layered(b) => b.sample(wo, u, u2),
            Self::Pbr(b) => b.sample(wo, u, u2, mode),
            Self::Principled(b) => b.sample(wo, u, u2, mode),
            Self::PrincipledThin(b) => b.sample(wo, u, u2),
        }
    }

    /// Whether every lobe is a delta distribution, so that next-event estimation cannot contribute.
    #[inline]
    pub fn is_specular(&self) -> bool {
        match self {
            Self::OrenNayar(_) | Self::Minnaert(_) | Self::Phong(_) | Self::BlinnPhong(_) | Self::Ward(_) => false,
            Self::CookTorrance(b) => b.is_specular(),
            Self::CompensatedConductor(b) => b.is_specular(),
            Self::Diffuse(_) | Self::DiffuseTransmission(_) | Self::Coated(_) | Self::Measured(_) | Self::Hair(_) => {
                false
            }
            Self::Principled(_) | Self::PrincipledThin(_) => false,
            Self::Pbr(b) => b.is_specular(),
            Self::Layered(b) => b.is_specular(),
            Self::Conductor(b) => b.microfacet.is_smooth(),
            Self::Dielectric(b) => b.is_specular(),
            Self::ThinDielectric(_) => true,
        }
    }

    /// Whether light can pass to the other side.
    #[inline]
    pub fn has_transmission(&self) -> bool {
        match self {
            Self::DiffuseTransmission(_) | Self::Dielectric(_) | Self::ThinDielectric(_) | Self::Hair(_) => true,
            Self::Pbr(b) => b.transmits(),
            Self::Principled(b) => b.transmits(),
            Self::PrincipledThin(b) => b.transmits(),
            _ => false,
        }
    }

    /// Density with which [`Bsdf::sample`] draws `wi`, the same as [`Bsdf::eval`] gives, for less where the value is
    /// dear.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        match self {
            Self::Layered(b) => b.pdf(wo, wi),
            _ => self.eval(wo, wi, mode).pdf,
        }
    }

    /// Whether values are estimates, right in the mean over directions.
    pub fn is_stochastic(&self) -> bool {
        matches!(self, Self::Layered(b) if !b.is_specular())
    }

    /// The largest part of the light that leaves again: 1 but for the empirical models that do not keep to it.
    pub fn albedo_bound(&self) -> f32 {
        match self {
            Self::Principled(_) | Self::PrincipledThin(_) => Principled::ALBEDO_BOUND,
            _ => 1.0,
        }
    }

    /// Index of refraction below the surface relative to above, for what refracts into it; else 1.
    pub fn relative_eta(&self) -> f32 {
        match self {
            Self::Dielectric(b) => b.eta,
            Self::Pbr(b) => b.eta(),
            Self::Principled(b) => b.eta(),
            _ => 1.0,
        }
    }

    /// The part of light that passes straight through, for models that let it: what a shadow ray loses on its way.
    #[inline]
    pub fn straight_transmission(&self, wo: Vec3) -> Option<Spectrum> {
        match self {
            Self::ThinDielectric(b) => Some(b.straight_transmission(wo)),
            _ => None,
        }
    }

    /// A cheap estimate of the directional albedo for feature images: the reflectance of diffuse surfaces, the
    /// reflectance at this angle for metals, and 1 (tinted) for glass, as denoisers expect it.
    pub fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        match self {
            Self::Diffuse(b) => b.reflectance,
            Self::DiffuseTransmission(b) => b.reflectance + b.transmittance,
            Self::Conductor(b) => b.albedo_estimate(wo),
            Self::Dielectric(b) => b.albedo_estimate(wo),
            Self::ThinDielectric(b) => b.albedo_estimate(wo),
            Self::Coated(b) => b.albedo_estimate(wo),
            Self::OrenNayar(b) => b.albedo_estimate(),
            Self::Minnaert(b) => b.albedo_estimate(),
            Self::Phong(b) => b.albedo_estimate(),
            Self::BlinnPhong(b) => b.albedo_estimate(),
            Self::Ward(b) => b.albedo_estimate(),
            Self::CookTorrance(b) => b.albedo_estimate(wo),
            Self::CompensatedConductor(b) => b.albedo_estimate(wo),
            Self::Measured(b) => b.albedo_estimate(wo),
            Self::Hair(b) => b.albedo_estimate(wo),
            Self::Layered(b) => b.albedo_estimate(wo),
            Self::Pbr(b) => b.albedo_estimate(wo),
            Self::Principled(b) => b.albedo_estimate(wo),
            Self::PrincipledThin(b) => b.albedo_estimate(wo),
        }
    }
}

/// A direction above the surface with density `cosθ/π`; `None` for the rare draw that rounds to the horizon.
#[inline]
fn sample_cosine_hemisphere(u: Vec2) -> Option<Vec3> {
    let w = warp::cosine_hemisphere(u);
    (w.z > 0.0).then_some(w)
}
