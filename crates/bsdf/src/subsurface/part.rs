//! Subsurface part of a surface.

use steradian_math::Spectrum;

/// The part of a surface's diffuse base that is a medium, which light enters.
#[derive(Clone, Copy, Debug)]
pub struct SubsurfacePart {
    /// Weight of the medium.
    pub weight: f32,
    /// The part of the light that comes back.
    pub color: Spectrum,
    /// True if light goes below, to leave elsewhere. Otherwise the light that comes back is diffuse; on a thin surface
    /// it goes through, too.
    pub is_followed: bool,
    /// Mean cosine of the phase function; of what a thin surface scatters `(1 + g)/2` goes through.
    pub g: f32,
}

impl SubsurfacePart {
    /// None of it.
    pub const NONE: Self = Self { weight: 0.0, color: Spectrum::ZERO, is_followed: false, g: 0.0 };
}
