//! Interface shared by skies and suns.

use steradian_math::{Spectrum, Vec2, Vec3, spectra::Wavelengths};

/// A celestial source of light, described by direction.
pub(in crate::light::sky) trait CelestialBody {
    /// Radiance from the direction `w`, W/(m² sr nm).
    fn radiance(&self, w: Vec3, lambda: &Wavelengths) -> Spectrum;
    /// A direction and its density per solid angle. All light is found so.
    fn sample(&self, u: Vec2) -> (Vec3, f32);
    /// The density of [`CelestialBody::sample`].
    fn pdf(&self, w: Vec3) -> f32;
    /// The luminance of what comes from all directions together: `∫ Y dω`.
    fn fluence(&self) -> f32;
    /// Bytes of its tables.
    fn bytes(&self) -> usize;
}
