//! Materials of patches: their Lambertian reflectance and transmittance, and their emission.

use super::{bands::Bands, cells::Cell, surfaces::Piece};
use steradian_bsdf::{Bsdf, Lobe, TransportMode};
use steradian_core::{Scene, scene::Interaction};
use steradian_math::{Spectrum, Vec2, Vec3, spectra::Wavelengths, warp};

/// Places of a patch that are looked at.
const PLACES: u32 = 4;
/// Samples that tell the Lambertian part of other models.
const SAMPLES: u32 = 64;

/// One side of a patch, for one band.
#[derive(Clone, Copy, Debug, Default)]
pub struct Matter {
    /// Part of light that comes back, in every direction evenly.
    pub reflectance: Spectrum,
    /// Part of the light on the other side that comes through, in every direction evenly.
    pub transmittance: Spectrum,
    /// Emitted radiosity, π times the radiance.
    pub emission: Spectrum,
}

/// The Lambertian part of a scattering model: reflectance, transmittance, and whether that is all of it.
pub fn lambertian(bsdf: &Bsdf<'_>) -> (Spectrum, Spectrum, bool) {
    match bsdf {
        Bsdf::Diffuse(b) => (b.reflectance, Spectrum::ZERO, true),
        Bsdf::DiffuseTransmission(b) => (b.reflectance, b.transmittance, true),
        _ => {
            let (mut r, mut t) = (Spectrum::ZERO, Spectrum::ZERO);
            // Diffuse part of other models: weights of samples whose lobe is diffuse, in the mean over
            // cosine-distributed directions.
            for k in 0..SAMPLES {
                let [a, b, c, d] = steradian_math::sobol::shuffled_scrambled_sobol_4d(k, 0x51d3);
                let wo = warp::cosine_hemisphere(Vec2::new(a, b));
                let [e, ..] = steradian_math::sobol::shuffled_scrambled_sobol_2d(k, 0x9a17);
                let Some(s) = bsdf.sample(wo, e, Vec2::new(c, d), TransportMode::Radiance) else { continue };
                if s.lobe.contains(Lobe::DIFFUSE) {
                    *if s.lobe.is_transmission() { &mut t } else { &mut r } += s.weight / SAMPLES as f32;
                }
            }
            (r.clamp(0.0, 1.0), t.clamp(0.0, 1.0), false)
        }
    }
}

/// The Lambertian part of a surface as it is seen, and whether that is all that it scatters; nothing where nothing
/// scatters.
pub fn of_surface(scene: &Scene, i: &Interaction, choice: f32, lambda: &Wavelengths) -> (Spectrum, Spectrum, bool) {
    match scene.scattering(i, choice, &mut lambda.clone()) {
        Some((s, frame)) if s.bsdf.has_transmission() || frame.to_local(i.wo).z > 0.0 => lambertian(&s.bsdf),
        Some((s, _)) => (Spectrum::ZERO, Spectrum::ZERO, matches!(s.bsdf, Bsdf::Diffuse(_))),
        None => (Spectrum::ZERO, Spectrum::ZERO, true),
    }
}

/// The mean over one side of a patch for each band, and whether it is Lambertian everywhere.
pub fn of_cell(scene: &Scene, piece: &Piece, cell: &Cell, front: bool, bands: &Bands) -> (Vec<Matter>, bool) {
    let mut sum = vec![Matter::default(); bands.count()];
    let mut is_pure = true;
    let geometry = &scene.geometries()[piece.geometry as usize];
    // Without textures and mixtures one point stands for all.
    let is_plain = !geometry.needs.parameters && !scene.has_mixtures();
    let places = if is_plain { 1 } else { PLACES };
    for k in 0..places {
        let u = if is_plain {
            Vec2::splat(0.5)
        } else {
            Vec2::from(steradian_math::sobol::shuffled_scrambled_sobol_2d(k, 0x3c6e))
        };
        let seen = piece.seen(scene, cell.at(u), front);
        let choice = (k as f32 + 0.5) / places as f32;
        // Means over the points; emitted radiosity is π L.
        for (matter, lambda) in sum.iter_mut().zip(bands.wavelengths()) {
            let (r, t, pure) = of_surface(scene, &seen, choice, lambda);
            matter.reflectance += r / places as f32;
            matter.transmittance += t / places as f32;
            matter.emission += emitted(scene, &seen, lambda) * (std::f32::consts::PI / places as f32);
            is_pure &= pure;
        }
    }
    (sum, is_pure)
}

/// Radiance that a surface emits towards where it is seen from.
pub fn emitted(scene: &Scene, i: &Interaction, lambda: &Wavelengths) -> Spectrum {
    let Some(emitter) = scene.geometries()[i.geometry as usize].emitter else { return Spectrum::ZERO };
    let n: Vec3 = i.surface.n;
    let at = || scene.texture_context(i);
    scene.lights().emitters[emitter as usize].radiance(n, i.wo, at, lambda, scene.textures())
}
