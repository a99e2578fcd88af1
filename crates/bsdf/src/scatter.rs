//! Interface of a scattering model: the contract behind [`Bsdf`](super::Bsdf).

use super::{
    BsdfEval, BsdfSample, TransportMode,
    registry::{Model, Recipe},
};
use steradian_math::{Spectrum, Vec2, Vec3};

/// A scattering model at a point. Directions and random numbers are those of [`Bsdf`](super::Bsdf). What a model does
/// not say is what an opaque, reciprocal surface without mirrors does.
pub(crate) trait Scatter {
    /// The model, or its forms, with cases for the laws.
    const MODELS: &'static [Model];
    /// Recipes that make the model from parameters alone, for models that allow it.
    const RECIPES: &'static [Recipe] = &[];
    /// The largest part of the light that leaves again.
    const ALBEDO_BOUND: f32 = 1.0;

    /// `f·|cosθ_i|` and density.
    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval;

    /// Draws a direction.
    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample>;

    /// A cheap estimate of the directional albedo.
    fn albedo_estimate(&self, wo: Vec3) -> Spectrum;

    /// The density that `eval` gives.
    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        self.eval(wo, wi, mode).pdf
    }

    /// True if every lobe is a delta distribution.
    #[inline]
    fn is_specular(&self) -> bool {
        false
    }

    /// True if light can pass to the other side.
    #[inline]
    fn transmits(&self) -> bool {
        false
    }

    /// True if the model is the same surface with the two directions exchanged.
    #[inline]
    fn is_reciprocal(&self) -> bool {
        true
    }

    /// True if values are estimates, right in the mean.
    #[inline]
    fn is_stochastic(&self) -> bool {
        false
    }

    /// Index of refraction below the surface relative to above, for what refracts into it.
    #[inline]
    fn relative_eta(&self) -> f32 {
        1.0
    }

    /// The part of light that passes straight through.
    #[inline]
    fn straight_transmission(&self, _: Vec3) -> Option<Spectrum> {
        None
    }
}
