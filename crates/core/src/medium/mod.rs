//! Participating media: Beer–Lambert attenuation, scattering and emission.

mod cells;
mod draine;
mod emissive_volume;
mod field;
mod phase;

use cells::Cells;
pub use draine::Draine;
pub use emissive_volume::EmissiveVolume;
pub use field::{Cloud, Field, Glow, GlowSource, Grid, Heat, OwnMedium, Variation, into_cube};
pub use phase::{Lobe, Phase, Table};
use std::sync::Arc;
use steradian_math::{
    Spectrum, Vec2, Vec3, elementary,
    spectra::{Wavelengths, role::Color},
};

/// A medium.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Spatial variation; the coefficients are those for a variation of one.
    pub field: Option<Arc<Field>>,
    /// The light that it gives off.
    pub glow: Option<Glow>,
    /// Absorption coefficient per unit length.
    pub sigma_a: Color,
    /// Scattering coefficient per unit length.
    pub sigma_s: Color,
    /// Factor on both coefficients.
    pub scale: f32,
    /// The phase function.
    pub phase: Phase,
}

impl Medium {
    /// The mean cosine of its phase function, if that is Henyey and Greenstein's, and the medium is the same everywhere
    /// and gives off no light.
    #[inline]
    pub fn plain_asymmetry(&self) -> Option<f32> {
        self.phase.henyey_greenstein().filter(|_| self.field.is_none() && self.glow.is_none())
    }

    /// Absorption and scattering coefficients at the wavelengths of a path.
    #[inline]
    pub fn coefficients(&self, lambda: &Wavelengths) -> (Spectrum, Spectrum) {
        (self.sigma_a.eval(lambda) * self.scale, self.sigma_s.eval(lambda) * self.scale)
    }

    /// Scattering coefficient at a point of the world.
    #[inline]
    pub fn scattering_at(&self, p: Vec3, lambda: &Wavelengths) -> Spectrum {
        let unit = self.coefficients(lambda);
        self.field.as_ref().map_or(unit, |field| field.coefficients(unit, field.place(p), lambda)).1
    }

    /// Extinction by which bounds on the variation are multiplied to give majorants.
    #[inline]
    pub fn majorant(&self, lambda: &Wavelengths) -> Spectrum {
        let (a, s) = self.coefficients(lambda);
        a + s
    }

    /// True if it scatters at all, in the first lanes.
    pub fn scatters(&self, lambda: &Wavelengths, lanes: usize) -> bool {
        let (_, s) = self.coefficients(lambda);
        (0..lanes).any(|l| s[l] > 0.0)
    }

    /// The light that it gives off per length, at a point of the cube of its field.
    fn glow_at(&self, p: Vec3, lambda: &Wavelengths) -> Spectrum {
        let Some(glow) = &self.glow else { return Spectrum::ZERO };
        // ε = σ_a·L_e at the point.
        let coefficients = self.coefficients(lambda);
        let (absorbed, _) = self.field.as_ref().map_or(coefficients, |f| f.coefficients(coefficients, p, lambda));
        absorbed * glow.eval(p, lambda)
    }

    /// The light that a way of a length brings to its beginning, where nothing varies: `σ_a L (1 − e^(−σ_t d))/σ_t`.
    pub fn glow_over(&self, distance: f32, lambda: &Wavelengths) -> Spectrum {
        let Some(Glow { source: GlowSource::Even(color), .. }) = &self.glow else { return Spectrum::ZERO };
        // ∫ σ_a L e^(−σ_t t) dt over the distance.
        let (a, s) = self.coefficients(lambda);
        let extinction = (a + s) * distance.min(f32::MAX);
        // Of thin media the length; of infinite ones one over the extinction.
        let part = (a + s).map(|t| if t * distance < 1e-4 { distance } else { -(-t * distance).exp_m1() / t });
        if extinction.is_black() { Spectrum::ZERO } else { a * color.eval(lambda) * part }
    }

    /// Beer–Lambert transmittance over a distance; 1 over no distance, 0 over an infinite one where there is any
    /// extinction.
    #[inline]
    pub fn transmittance(&self, distance: f32, lambda: &Wavelengths) -> Spectrum {
        let (a, s) = self.coefficients(lambda);
        transmittance(a + s, distance)
    }

    /// Phase function and density (they are equal) for directions pointing away from the point.
    #[inline]
    pub fn phase(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.phase.value(wo.dot(wi))
    }

    /// A direction by the phase function, and its density.
    #[inline]
    pub fn sample_phase(&self, wo: Vec3, u: Vec2) -> (Vec3, f32) {
        self.phase.sample(wo, u)
    }
}

/// `exp(−σ_t d)`, with lanes of no extinction kept at one over infinite distances.
#[inline]
pub fn transmittance(sigma_t: Spectrum, distance: f32) -> Spectrum {
    // Most media are grey.
    let first = beer_lambert(sigma_t[0], distance);
    sigma_t.map(|s| if s == sigma_t[0] { first } else { beer_lambert(s, distance) })
}

/// One lane of [`transmittance`].
#[inline(always)]
pub fn beer_lambert(sigma_t: f32, distance: f32) -> f32 {
    // T = e^(−σ_t·d); no extinction keeps one even over infinite distances.
    if sigma_t == 0.0 { 1.0 } else { elementary::exp(-sigma_t * distance) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The density that samples come with is the phase function's value for them: light goes on forwards where `g > 0`.
    #[test]
    fn phase_is_the_density_of_its_samples() {
        for g in [-0.7, 0.0, 0.4, 0.9] {
            let m = Medium {
                field: None,
                glow: None,
                sigma_a: Color::BLACK,
                sigma_s: Color::constant(1.0),
                scale: 1.0,
                phase: Phase::HenyeyGreenstein(g),
            };
            let wo = Vec3::new(0.36, -0.48, 0.8);
            for i in 0..64 {
                let (wi, pdf) = m.sample_phase(wo, Vec2::new((i as f32 + 0.5) / 64.0, 0.3));
                assert!((m.phase(wo, wi) / pdf - 1.0).abs() < 1e-3, "g = {g}: {} for {pdf}", m.phase(wo, wi));
            }
            let (forward, back) = (m.phase(wo, -wo), m.phase(wo, wo));
            assert!((forward - back) * g >= 0.0, "g = {g}: {forward} forwards, {back} back");
        }
    }

    #[test]
    fn transmittance_multiplies_over_segments() {
        let m = Medium {
            field: None,
            glow: None,
            sigma_a: Color::constant(0.3),
            sigma_s: Color::constant(0.2),
            scale: 2.0,
            phase: Phase::ISOTROPIC,
        };
        let w = Wavelengths::sample_visible(0.3);
        let (a, b) = (m.transmittance(0.7, &w)[0], m.transmittance(1.1, &w)[0]);
        assert!((a * b - m.transmittance(1.8, &w)[0]).abs() < 1e-6);
        assert!((a - (-0.7_f32).exp()).abs() < 1e-6);
        let empty = Medium {
            field: None,
            glow: None,
            sigma_a: Color::BLACK,
            sigma_s: Color::BLACK,
            scale: 1.0,
            phase: Phase::ISOTROPIC,
        };
        assert_eq!(empty.transmittance(f32::INFINITY, &w), Spectrum::ONE);
    }
}
