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
//! [`models`] lists every model with cases at the corners of its parameters, and the tests run the laws of scattering
//! (density, reciprocity, energy) over all of them.

mod albedo_table;
pub mod blinn_phong;
mod coat_colors;
pub mod coat_table;
pub mod coated;
pub mod conductor;
pub mod cook_torrance;
pub mod dielectric;
pub mod diffuse;
pub mod diffuse_transmission;
pub mod filter;
pub mod fresnel;
mod gaussian;
pub mod grating;
mod grating_profile;
mod gtr1;
pub mod hair;
#[cfg(test)]
mod laws;
pub mod layered;
#[cfg(test)]
mod layered_walk;
#[cfg(test)]
mod layers_over_media;
mod lobe_over_diffuse;
mod masking;
pub mod measured;
pub mod microfacet;
pub mod minnaert;
pub mod multiple_scattering;
mod normal_distribution;
pub mod oren_nayar;
pub mod own;
mod packed;
mod packed_normal;
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
mod scatter;
mod sheen;
mod split_sum;
pub mod subsurface;
pub mod thin_dielectric;
pub mod thin_film;
mod visible_normals;
pub mod ward;
#[cfg(test)]
mod white_metal;

pub use blinn_phong::BlinnPhong;
pub use coat_table::{CoatSeries, CoatTable};
pub use coated::Coated;
pub use conductor::Conductor;
pub use cook_torrance::{CookTorrance, DiffuseCoupling};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use diffuse_transmission::DiffuseTransmission;
pub use filter::Filter;
pub use grating::{Grating, Grooves};
pub use grating_profile::Profile;
pub use hair::Hair;
pub use layered::Layered;
pub use measured::{Measured, MeasuredData};
pub use microfacet::{Microfacet, NormalDistribution, Shadowing};
pub use minnaert::Minnaert;
pub use multiple_scattering::{CompensatedConductor, Compensation, EnergyTable};
pub use normal_distribution::Tail;
pub use oren_nayar::{OrenNayar, OrenNayarForm};
pub use own::{Draw, Own, OwnScatter};
pub use pbr::Pbr;
pub use phong::Phong;
pub use principled::Principled;
pub use principled_thin::PrincipledThin;
pub use reflectance::Reflectance;
pub use registry::{Inputs, MOST_INPUTS, Model, Recipe};
use scatter::Scatter;
pub use split_sum::SplitSum;
use subsurface::{Emergence, Entry};
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
    /// Light goes below the surface, to leave it elsewhere; the direction says nothing.
    pub const SUBSURFACE: Self = Self(32);
    /// The direction is not the model's own: it was mirrored to the right side of a surface with bumps.
    pub const FOLDED: Self = Self(64);

    /// Both sets together.
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True if every property of `other` is in this set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// True if the lobe is a delta distribution.
    pub const fn is_specular(self) -> bool {
        self.contains(Self::SPECULAR)
    }

    /// True if the sample crossed the surface.
    pub const fn is_transmission(self) -> bool {
        self.contains(Self::TRANSMISSION)
    }

    /// True if the lobe is diffuse.
    pub const fn is_diffuse(self) -> bool {
        self.contains(Self::DIFFUSE)
    }

    /// True if light goes below the surface, to leave it elsewhere.
    #[inline]
    pub const fn is_subsurface(self) -> bool {
        self.contains(Self::SUBSURFACE)
    }

    /// True if the lobe is glossy.
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
    /// Lobe of the sample.
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

    /// The sample of a reflected direction; `None` also below the surface.
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
    /// One that carries nothing.
    pub const NONE: Self = Self { wi: Vec3::Z, weight: Spectrum::ZERO, pdf: 0.0, lobe: Lobe::DIFFUSE, eta: 1.0 };

    /// Mirror reflection at the surface, chosen with a probability.
    #[inline]
    pub(crate) fn mirrored(wo: Vec3, weight: Spectrum, probability: f32) -> Self {
        let lobe = Lobe::REFLECTION.with(Lobe::SPECULAR);
        Self { wi: Vec3::new(-wo.x, -wo.y, wo.z), weight, pdf: probability, lobe, eta: 1.0 }
    }

    /// Light goes below the surface, chosen with a probability.
    #[inline]
    pub(crate) fn entering(weight: Spectrum, probability: f32) -> Self {
        let lobe = Lobe::TRANSMISSION.with(Lobe::SPECULAR).with(Lobe::SUBSURFACE);
        Self { wi: Vec3::NEG_Z, weight, pdf: probability, lobe, eta: 1.0 }
    }
}

/// Quantity carried along a path: the two differ where light is refracted (Veach 1997, 5.2).
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

/// The enum of models, and what is done with each: a new one is a line below.
macro_rules! models {
    ($($(#[$doc:meta])* $name:ident($model:ty),)*) => {
        /// Bidirectional scattering distribution function (BSDF) of a surface at a point.
        #[derive(Clone, Copy, Debug)]
        pub enum Bsdf<'a> {
            $($(#[$doc])* $name($model),)*
        }

        impl<'a> Bsdf<'a> {
            const MODELS: &'static [&'static [Model]] = &[$(<$model as Scatter>::MODELS),*];
            const RECIPES: &'static [&'static [Recipe]] = &[$(<$model as Scatter>::RECIPES),*];
        }

        /// Does something with whatever model it is.
        macro_rules! each {
            ($bsdf:expr, $b:ident => $what:expr) => {
                match $bsdf {
                    $(Bsdf::$name($b) => $what,)*
                }
            };
        }

        /// The names of all variants.
        #[cfg(test)]
        const VARIANTS: &[&str] = &[$(stringify!($name)),*];
    };
}

models! {
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
    /// A polariser or a retarder.
    Filter(Filter),
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
    /// Grooves that diffract.
    Grating(Grating<'a>),
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
    /// Surface that light may enter, to leave it elsewhere.
    Subsurface(Entry),
    /// Surface through which light leaves that entered elsewhere.
    Emergence(Emergence),
    /// A model of a program's own.
    Own(Own<'a>),
}

/// All models.
pub fn models() -> impl Iterator<Item = &'static Model> + Clone {
    Bsdf::MODELS.iter().copied().flatten()
}

/// All ways to make a model from parameters alone.
pub fn recipes() -> impl Iterator<Item = &'static Recipe> + Clone {
    Bsdf::RECIPES.iter().copied().flatten()
}

const _: () = assert!(size_of::<Bsdf<'static>>() <= 128, "a Bsdf is copied at every hit");

impl Bsdf<'_> {
    /// `f·|cosθ_i|` and the density with which [`Bsdf::sample`] draws `wi`; both zero for specular lobes. The value for
    /// importance is that for radiance with the directions exchanged (Veach 1997, 5.2), which for most models is the
    /// same.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        if mode == TransportMode::Radiance || self.is_reciprocal() {
            return self.eval_of_model(wo, wi, mode);
        }
        let e = self.eval_of_model(wo, wi, mode);
        let back = self.eval_of_model(wi, wo, TransportMode::Radiance).value;
        let cosines = if wo.z.abs() > 1e-6 { (wi.z / wo.z).abs() } else { 0.0 };
        BsdfEval { value: back * cosines, pdf: e.pdf }
    }

    #[inline]
    fn eval_of_model(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        each!(self, b => b.eval(wo, wi, mode))
    }

    /// True if the BSDF is reciprocal: the same with the two directions exchanged.
    #[inline]
    fn is_reciprocal(&self) -> bool {
        each!(self, b => b.is_reciprocal())
    }

    /// Draws a direction: `u` (in `[0, 1)`) chooses the lobe, `u2` (in `[0, 1)²`) the direction in it. `None` where the
    /// surface scatters nothing or the draw fell outside of the model (it counts as black).
    #[inline]
    pub fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if mode == TransportMode::Radiance || self.is_reciprocal() {
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
        each!(self, b => b.sample(wo, u, u2, mode))
    }

    /// True if every lobe is a delta distribution, so that next-event estimation cannot contribute.
    #[inline]
    pub fn is_specular(&self) -> bool {
        each!(self, b => b.is_specular())
    }

    /// True if light can pass to the other side.
    #[inline]
    pub fn has_transmission(&self) -> bool {
        each!(self, b => b.transmits())
    }

    /// Density with which [`Bsdf::sample`] draws `wi`, the same as [`Bsdf::eval`] gives, for less where the value is
    /// dear.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        each!(self, b => b.pdf(wo, wi, mode))
    }

    /// True if values are estimates, right in the mean over directions.
    pub fn is_stochastic(&self) -> bool {
        each!(self, b => b.is_stochastic())
    }

    /// The largest part of the light that leaves again: 1 but for the empirical models that do not keep to it.
    pub fn albedo_bound(&self) -> f32 {
        fn bound<S: Scatter>(_: &S) -> f32 {
            S::ALBEDO_BOUND
        }
        each!(self, b => bound(b))
    }

    /// Gives the clear coat of glTF's surface a normal of its own, in the frame of the base; others have no such coat.
    #[inline]
    pub fn set_coat_normal(&mut self, n: Vec3) {
        if let Bsdf::Pbr(b) = self {
            b.set_coat_normal(n);
        }
    }

    /// Index of refraction below the surface relative to above, for what refracts into it; else 1.
    pub fn relative_eta(&self) -> f32 {
        each!(self, b => b.relative_eta())
    }

    /// The part of light that passes straight through, for models that let it: what a shadow ray loses on its way.
    #[inline]
    pub fn straight_transmission(&self, wo: Vec3) -> Option<Spectrum> {
        each!(self, b => b.straight_transmission(wo))
    }

    /// A cheap estimate of the directional albedo for feature images: the reflectance of diffuse surfaces, the
    /// reflectance at this angle for metals, and 1 (tinted) for glass, as denoisers expect it.
    pub fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        each!(self, b => b.albedo_estimate(wo))
    }
}

/// A direction above the surface with density `cosθ/π`; `None` for the rare draw that rounds to the horizon.
#[inline]
fn sample_cosine_hemisphere(u: Vec2) -> Option<Vec3> {
    let w = warp::cosine_hemisphere(u);
    (w.z > 0.0).then_some(w)
}
