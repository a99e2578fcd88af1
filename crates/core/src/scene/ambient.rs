//! The ambient term of surfaces.

use super::{Interaction, Scene};
use crate::{light::Ambient, material::Scattering};
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};

impl Scene {
    /// The ambient term of a surface point, `k_a L_a`, for each ambient light with its group; `wo` is the direction to
    /// the viewer in the shading frame. Mirrors and glass have none.
    pub fn ambient<'a>(
        &'a self,
        i: &Interaction,
        scattering: &Scattering<'a>,
        wo: Vec3,
        lambda: &'a Wavelengths,
    ) -> impl Iterator<Item = (u32, Spectrum)> + 'a {
        let lights = &self.parts.lights.ambient;
        let has_term = !lights.is_empty() && !scattering.bsdf.is_specular();
        let material = &self.parts.materials[self.parts.geometries[i.geometry as usize].material as usize];
        let reflectance = match (has_term, &material.ambient) {
            (false, _) => Spectrum::ZERO,
            (true, Some(k)) => k.eval(&self.parts.textures, &self.texture_context(i), lambda),
            (true, None) => scattering.bsdf.albedo_estimate(wo),
        };
        let term = move |light: &Ambient| (light.group, reflectance * light.radiance.eval(lambda) * light.scale);
        lights.iter().filter(move |_| has_term).map(term)
    }
}
