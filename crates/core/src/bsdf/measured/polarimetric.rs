//! Isotropic polarimetric BRDFs (`.pbsdf`): Mueller matrices over half–difference angles and wavelength, of which
//! unpolarised transport uses the first element.
//!
//! Fields of the tensor file: `phi_d`, `theta_d`, `theta_h` (radians, increasing), `wvls` (nm) and `M` in
//! `[phi_d][theta_d][theta_h][wvls][4][4]`. Baek et al., "Image-Based Acquisition and Modeling of Polarimetric
//! Reflectance" (2020); read by Mitsuba as `measured_polarized`.

use super::{
    MeasuredError,
    rgl::{Wanted, rgb_weights},
    rusinkiewicz::HalfDifference,
    tensor::TensorFile,
};
use std::f32::consts::{PI, TAU};
use steradian_math::{Spectrum, Vec3};

/// A measurement's intensities.
#[derive(Clone, Debug)]
pub struct Polarimetric {
    phi_d: Vec<f32>,
    theta_d: Vec<f32>,
    theta_h: Vec<f32>,
    /// Wavelengths, nm; empty for three channels.
    lambda: Vec<f32>,
    /// `f` (sr⁻¹) in `[phi_d][theta_d][theta_h][wavelength or channel]`.
    values: Vec<f32>,
}

/// The neighbours of a value on an axis, and how far it is from the first to the second.
#[inline]
pub(super) fn neighbours(axis: &[f32], x: f32) -> (usize, usize, f32) {
    if axis.len() < 2 {
        return (0, 0, 0.0);
    }
    let j = axis.partition_point(|a| *a <= x).clamp(1, axis.len() - 1);
    (j - 1, j, ((x - axis[j - 1]) / (axis[j] - axis[j - 1])).clamp(0.0, 1.0))
}

impl Polarimetric {
    /// From a tensor file.
    ///
    /// # Errors
    /// What is missing or does not fit.
    pub fn read(file: &TensorFile<'_>, wanted: Wanted) -> Result<Self, MeasuredError> {
        let axis = |name: &str| file.need(name, 1)?.floats(name).map(|v| v.to_vec());
        let [phi_d, theta_d, theta_h] = [axis("phi_d")?, axis("theta_d")?, axis("theta_h")?];
        let lambda = file.need("wvls", 1)?.axis("wvls")?;
        let increases = |v: &[f32]| v.windows(2).all(|w| w[0] < w[1]);
        if [&phi_d, &theta_d, &theta_h].iter().any(|v| !increases(v)) {
            return Err(MeasuredError::Fault("its angles do not increase".into()));
        }
        let m = file.need("M", 6)?;
        if m.shape != [phi_d.len(), theta_d.len(), theta_h.len(), lambda.len(), 4, 4] {
            return Err(MeasuredError::Fault(format!("'M' has the shape {:?}", m.shape)));
        }
        let intensities: Vec<f32> = m.floats("M")?.chunks_exact(16).map(|m| m[0].max(0.0)).collect();
        if wanted == Wanted::Spectral {
            return Ok(Self { phi_d, theta_d, theta_h, lambda, values: intensities });
        }
        let weights = rgb_weights(&lambda);
        let rgb = |f: &[f32]| f.iter().zip(&weights).map(|(f, w)| *w * *f).sum::<Vec3>().max(Vec3::ZERO);
        let values = intensities.chunks_exact(lambda.len()).flat_map(|f| rgb(f).to_array()).collect();
        Ok(Self { phi_d, theta_d, theta_h, lambda: Vec::new(), values })
    }

    /// Whether values are by wavelength.
    pub fn spectral(&self) -> bool {
        !self.lambda.is_empty()
    }

    /// `f` (sr⁻¹) at the wavelengths, or of the three channels.
    pub fn eval(&self, wo: Vec3, wi: Vec3, lambda: [f32; 4]) -> Spectrum {
        let Some(a) = HalfDifference::new(wi, wo) else { return Spectrum::ZERO };
        // Azimuths are stored over a whole turn from their first value on.
        let first = self.phi_d.first().copied().unwrap_or(-PI);
        let phi = first + (a.phi_d - first).rem_euclid(TAU);
        let axes =
            [neighbours(&self.phi_d, phi), neighbours(&self.theta_d, a.theta_d), neighbours(&self.theta_h, a.theta_h)];
        let lanes = if self.spectral() { self.lambda.len() } else { 3 };
        let mut value = [0.0f32; 4];
        let channels = lambda.map(|l| neighbours(&self.lambda, l));
        for corner in 0..8 {
            let mut weight = 1.0;
            let index = [0, 1, 2].map(|i| {
                let (low, high, f) = axes[i];
                if corner >> i & 1 == 0 {
                    weight *= 1.0 - f;
                    low
                } else {
                    weight *= f;
                    high
                }
            });
            let at = ((index[0] * self.theta_d.len() + index[1]) * self.theta_h.len() + index[2]) * lanes;
            for (lane, v) in value.iter_mut().enumerate() {
                let (low, high, f) = if self.spectral() { channels[lane] } else { (lane.min(2), lane.min(2), 0.0) };
                *v += weight * ((1.0 - f) * self.values[at + low] + f * self.values[at + high]);
            }
        }
        Spectrum::new(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::measured::{synthetic::METAL, tensor::write};
    use std::f32::consts::FRAC_PI_2;
    use steradian_math::{DVec3, hash::HashRng, warp};

    /// A file with the intensities of the synthetic metal and nonsense in all other elements.
    fn file() -> Vec<u8> {
        let spaced = |n: usize, from: f32, to: f32| -> Vec<f32> {
            (0..n).map(|i| from + (to - from) * i as f32 / (n - 1) as f32).collect()
        };
        let (phi, theta_d, theta_h) = (spaced(37, -PI, PI), spaced(46, 0.0, FRAC_PI_2), spaced(91, 0.0, FRAC_PI_2));
        let mut m = Vec::new();
        for p in &phi {
            for d in &theta_d {
                for h in &theta_h {
                    let ((sh, ch), (sd, cd)) = (f64::from(*h).sin_cos(), f64::from(*d).sin_cos());
                    let around =
                        DVec3::new(ch, 0.0, -sh) * (sd * f64::from(*p).cos()) + DVec3::Y * (sd * f64::from(*p).sin());
                    let axis = DVec3::new(sh, 0.0, ch);
                    let (wi, wo) = (axis * cd + around, axis * cd - around);
                    let f = if wi.z > 1e-3 && wo.z > 1e-3 { METAL.f(wo, wi) } else { [0.0; 3] };
                    // Three wavelengths, for the three channels.
                    for v in f {
                        m.extend([v as f32, 9.0, -9.0, 9.0].into_iter().chain([-9.0; 12]));
                    }
                }
            }
        }
        let sizes = vec![phi.len(), theta_d.len(), theta_h.len(), 3, 4, 4];
        write::file(&[
            ("phi_d", vec![phi.len()], phi, false),
            ("theta_d", vec![theta_d.len()], theta_d, false),
            ("theta_h", vec![theta_h.len()], theta_h, false),
            ("wvls", vec![3], vec![450.0, 550.0, 650.0], false),
            ("M", sizes, m, false),
        ])
    }

    #[test]
    fn intensities_come_back_at_their_wavelengths() {
        let bytes = file();
        let tensor = TensorFile::read(&bytes).expect("sound");
        let table = Polarimetric::read(&tensor, Wanted::Spectral).expect("sound");
        let mut rng = HashRng::new(2);
        let mut errors = Vec::new();
        for _ in 0..500 {
            let mut w = || warp::cosine_hemisphere((rng.next_f32(), rng.next_f32()).into());
            let (wo, wi) = (w(), w());
            let f = METAL.f(wo.as_dvec3(), wi.as_dvec3());
            let found = table.eval(wo, wi, [450.0, 500.0, 550.0, 700.0]).to_array();
            let expected = [f[0], 0.5 * (f[0] + f[1]), f[1], f[2]];
            errors.extend((0..4).map(|i| (f64::from(found[i]) / expected[i] - 1.0).abs()));
        }
        errors.sort_by(f64::total_cmp);
        assert!(errors[errors.len() / 2] < 0.01, "{}", errors[errors.len() / 2]);
        let grey = Polarimetric::read(&tensor, Wanted::Rgb).expect("sound").eval(Vec3::Z, Vec3::Z, [0.0; 4]);
        assert!(grey[0] > 0.0 && grey.is_finite());
    }
}
