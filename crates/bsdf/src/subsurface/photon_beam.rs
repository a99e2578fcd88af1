//! Photon beam diffusion (Habel, Christensen, Jarosz 2013): light enters as a beam, along which there are sources of
//! diffuse light, each with its image, and what scatters but once is counted by itself. As pbrt-v4 tabulates it.

use super::profile::{ProfileTable, internal_moment};
use crate::fresnel;
use std::f64::consts::{PI, TAU};

/// Points along the beam.
const POINTS: u32 = 64;

/// Boundary and medium, which are the same for all radii.
struct Boundary {
    eta: f64,
    /// `∫ F μ dμ` and `∫ F μ² dμ` from within.
    moments: [f64; 2],
    /// Optical depths whose density is that of extinction.
    depths: Vec<f64>,
}

/// Light that scattered more than once, per area (eqs. 8 and 11, diffusion by Grosjean with the Fresnel boundary of
/// d'Eon and Irving 2011).
fn multiple(boundary: &Boundary, sigma_a: f64, sigma_s: f64, g: f64, r: f64) -> f64 {
    // Similarity: reduced coefficients turn anisotropic scattering into isotropic.
    let reduced_s = sigma_s * (1.0 - g);
    let reduced_t = sigma_a + reduced_s;
    let albedo = reduced_s / reduced_t;
    // Grosjean's diffusion coefficient keeps the single scattering apart.
    let diffusion = (2.0 * sigma_a + reduced_s) / (3.0 * reduced_t * reduced_t);
    let transport = (sigma_a / diffusion).sqrt();
    let [first, second] = boundary.moments;
    // Where the linearly extrapolated fluence vanishes.
    let extrapolated = 2.0 * diffusion * (1.0 + 3.0 * second) / (1.0 - 2.0 * first);
    let (of_fluence, of_flux) = (0.25 * (1.0 - 2.0 * first), 0.5 * (1.0 - 3.0 * second));
    let at = |depth: f64| {
        let image = depth + 2.0 * extrapolated;
        let (d, e) = ((r * r + depth * depth).sqrt(), (r * r + image * image).sqrt());
        let (decay_d, decay_e) = ((-transport * d).exp(), (-transport * e).exp());
        // Fluence and flux of the source and its negative image, combined to the radiant exitance.
        let fluence = (decay_d / d - decay_e / e) / (4.0 * PI * diffusion);
        let flux = (depth * (1.0 + transport * d) * decay_d / (d * d * d)
            + image * (1.0 + transport * e) * decay_e / (e * e * e))
            / (4.0 * PI);
        // Near the beam diffusion finds too much.
        let near = 1.0 - (-2.0 * reduced_t * (d + depth)).exp();
        near * albedo * albedo * (fluence * of_fluence + flux * of_flux)
    };
    // Average over the depths, which are distributed as the extinction along the beam.
    boundary.depths.iter().map(|depth| at(depth / reduced_t)).sum::<f64>() / f64::from(POINTS)
}

/// Light that scattered once, per area (section 4.2).
fn single(boundary: &Boundary, sigma_a: f64, sigma_s: f64, g: f64, r: f64) -> f64 {
    let sigma_t = sigma_a + sigma_s;
    // From nearer points it would be reflected within.
    let critical = r * (boundary.eta * boundary.eta - 1.0).max(0.0).sqrt();
    let at = |depth: f64| {
        let t = critical + depth;
        let d = (r * r + t * t).sqrt();
        let cos = t / d;
        // It turns back: the cosine between the two ways is negative.
        let x = 1.0 + g * g + 2.0 * g * cos;
        let phase = (1.0 - g * g) / (4.0 * PI * x * x.sqrt());
        let passed = 1.0 - f64::from(fresnel::dielectric(-cos as f32, boundary.eta as f32));
        // Attenuation down and back up, over the squared distance, times phase function and transmittance.
        sigma_s / sigma_t * (-sigma_t * (d + critical)).exp() / (d * d) * phase * passed * cos
    };
    boundary.depths.iter().map(|depth| at(depth / sigma_t)).sum::<f64>() / f64::from(POINTS)
}

/// Its table for a medium of this index and mean cosine of the phase function, by the albedo of single scattering.
pub fn photon_beam_diffusion(g: f32, eta: f32) -> ProfileTable {
    let (g, eta) = (f64::from(g), f64::from(eta));
    // Quantiles of the exponential distribution, in the middle of equal shares.
    let depth = |i| -(1.0 - (f64::from(i) + 0.5) / f64::from(POINTS)).ln();
    let moments = [1, 2].map(|n| internal_moment(eta, n));
    let boundary = Boundary { eta, moments, depths: (0..POINTS).map(depth).collect() };
    ProfileTable::new(|albedo, r| {
        // At the very point both diverge as 1/r; the ring has a limit.
        let r = r.max(1e-4);
        let (sigma_s, sigma_a) = (albedo, 1.0 - albedo);
        TAU * r * (multiple(&boundary, sigma_a, sigma_s, g, r) + single(&boundary, sigma_a, sigma_s, g, r))
    })
}
