//! Isotropic polarimetric BRDFs (`.pbsdf`): Mueller matrices over half–difference angles and wavelength, of which
//! unpolarised transport uses the first element.
//!
//! Fields of the tensor file: `phi_d`, `theta_d`, `theta_h` (radians, increasing; lists, or rows of a matrix as the
//! authors' files have them), `wvls` (nm) and `M` in `[phi_d][theta_d][theta_h][wvls][4][4]`, where values not measured
//! are NaN. Files with angles of no rows have them spaced evenly over their ranges. Baek et al., "Image-Based
//! Acquisition and Modeling of Polarimetric Reflectance" (2020); read by Mitsuba as `measured_polarized`.

use super::{
    MeasuredError,
    rgl::{Wanted, rgb_weights},
    rusinkiewicz::HalfDifference,
    tensor::TensorFile,
};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
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
    // Binary search for the interval; values outside are held at the ends.
    let j = axis.partition_point(|a| *a <= x).clamp(1, axis.len() - 1);
    (j - 1, j, ((x - axis[j - 1]) / (axis[j] - axis[j - 1])).clamp(0.0, 1.0))
}

impl Polarimetric {
    /// From a tensor file.
    ///
    /// # Errors
    /// What is missing or does not fit.
    pub fn read(file: &TensorFile<'_>, wanted: Wanted) -> Result<Self, MeasuredError> {
        // An axis may be a list, a matrix of one row, or, without rows, even steps over its range.
        let axis = |name: &str, from: f32, to: f32| {
            let field = file.get(name).ok_or_else(|| MeasuredError::Fault(format!("it lacks the field '{name}'")))?;
            match field.shape[..] {
                [n] | [1, n] if n > 0 => field.floats(name),
                [0, n] if (2..1 << 16).contains(&n) => {
                    Ok((0..n).map(|i| from + (to - from) * i as f32 / (n - 1) as f32).collect())
                }
                _ => Err(MeasuredError::Fault(format!("field '{name}' has the shape {:?}", field.shape))),
            }
        };
        let (phi_d, theta_d, theta_h) =
            (axis("phi_d", -PI, PI)?, axis("theta_d", 0.0, FRAC_PI_2)?, axis("theta_h", 0.0, FRAC_PI_2)?);
        let lambda = file.need("wvls", 1)?.axis("wvls")?;
        let increases = |v: &[f32]| v.windows(2).all(|w| w[0] < w[1]);
        if [&phi_d, &theta_d, &theta_h].iter().any(|v| !increases(v)) {
            return Err(MeasuredError::Fault("its angles do not increase".into()));
        }
        let m = file.need("M", 6)?;
        if m.shape != [phi_d.len(), theta_d.len(), theta_h.len(), lambda.len(), 4, 4] {
            return Err(MeasuredError::Fault(format!("'M' has the shape {:?}", m.shape)));
        }
        // Values that were not measured are NaN and count as black.
        let measured = |v: f32| if v.is_finite() { v.max(0.0) } else { 0.0 };
        // Keep the first element of each Mueller matrix: the intensity of unpolarised light.
        let intensities: Vec<f32> = m.numbers("M")?.chunks_exact(16).map(|m| measured(m[0])).collect();
        if wanted == Wanted::Spectral {
            return Ok(Self { phi_d, theta_d, theta_h, lambda, values: intensities });
        }
        // For RGB integrate over wavelengths once, at reading.
        let weights = rgb_weights(&lambda);
        let rgb = |f: &[f32]| f.iter().zip(&weights).map(|(f, w)| *w * *f).sum::<Vec3>().max(Vec3::ZERO);
        let values = intensities.chunks_exact(lambda.len()).flat_map(|f| rgb(f).to_array()).collect();
        Ok(Self { phi_d, theta_d, theta_h, lambda: Vec::new(), values })
    }

    /// True if values are by wavelength.
    pub fn spectral(&self) -> bool {
        !self.lambda.is_empty()
    }

    /// `f` (sr⁻¹) at the wavelengths, or of the three channels.
    pub fn eval(&self, wo: Vec3, wi: Vec3, lambda: [f32; 4]) -> Spectrum {
        let Some(a) = HalfDifference::new(wi, wo) else { return Spectrum::ZERO };
        // Azimuths are stored over a whole turn from their first value on.
        let first = self.phi_d.first().copied().unwrap_or(-PI);
        let phi = first + (a.phi_d - first).rem_euclid(TAU);
        // Neighbours along the half–difference angles.
        let axes =
            [neighbours(&self.phi_d, phi), neighbours(&self.theta_d, a.theta_d), neighbours(&self.theta_h, a.theta_h)];
        let lanes = if self.spectral() { self.lambda.len() } else { 3 };
        let mut value = [0.0f32; 4];
        // Neighbouring wavelengths of each lane.
        let channels = lambda.map(|l| neighbours(&self.lambda, l));
        // Trilinear interpolation over the angles, and linear over the wavelength.
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
    use crate::measured::{synthetic::METAL, tensor::write};
    use steradian_math::{DVec3, hash::HashRng, warp};

    /// A file with the intensities of the synthetic metal and nonsense in all other elements; its angles are lists, or
    /// matrices of so many rows.
    fn file(rows: Option<usize>) -> Vec<u8> {
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
        let angles = |v: Vec<f32>| match rows {
            None => (vec![v.len()], v),
            Some(rows) => (vec![rows, v.len()], v.repeat(rows)),
        };
        let [phi, theta_d, theta_h] = [phi, theta_d, theta_h].map(angles);
        write::file(&[
            ("phi_d", phi.0, phi.1, false),
            ("theta_d", theta_d.0, theta_d.1, false),
            ("theta_h", theta_h.0, theta_h.1, false),
            ("wvls", vec![3], vec![450.0, 550.0, 650.0], false),
            ("M", sizes, m, false),
        ])
    }

    #[test]
    fn intensities_come_back_at_their_wavelengths() {
        let bytes = file(None);
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

    /// Angles as a row, and angles of no rows, are those of a list; two rows are none.
    #[test]
    fn angles_may_be_rows() {
        let read = |rows| {
            let bytes = file(rows);
            Polarimetric::read(&TensorFile::read(&bytes).expect("sound"), Wanted::Rgb)
        };
        let list = read(None).expect("sound");
        for rows in [0, 1] {
            let table = read(Some(rows)).expect("sound");
            for (a, b) in
                [(&table.phi_d, &list.phi_d), (&table.theta_d, &list.theta_d), (&table.theta_h, &list.theta_h)]
            {
                assert!(a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{rows}: {a:?}");
            }
        }
        assert!(read(Some(2)).is_err());
    }

    /// One azimuth is for all; and what was not measured is NaN.
    #[test]
    fn one_azimuth_is_isotropic_and_gaps_are_black() {
        let values = |f: f32| [f, 0.0, 0.0, 0.0].into_iter().chain([0.0; 12]);
        let m: Vec<f32> = [0.1, f32::NAN, 0.3, 0.4].into_iter().flat_map(values).collect();
        let bytes = write::file(&[
            ("phi_d", vec![1, 1], vec![0.5], false),
            ("theta_d", vec![1, 2], vec![0.0, FRAC_PI_2], false),
            ("theta_h", vec![1, 2], vec![0.0, FRAC_PI_2], false),
            ("wvls", vec![1], vec![550.0], false),
            ("M", vec![1, 2, 2, 1, 4, 4], m, false),
        ]);
        let table = Polarimetric::read(&TensorFile::read(&bytes).expect("sound"), Wanted::Spectral).expect("sound");
        let f = |theta: f32, phi: f32| {
            let at = |phi: f32| Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            table.eval(at(phi), at(phi + PI), [550.0; 4])[0]
        };
        for phi in [0.0, 0.7, 2.0, -1.5] {
            // θ_h = 0; half of the way from 0.1 to 0.3.
            assert!((f(0.25 * PI, phi) - 0.2).abs() < 1e-5, "{}", f(0.25 * PI, phi));
        }
        let tilted = Vec3::new(0.6, 0.0, 0.8);
        // θ_d = 0, towards θ_h = 90°, where there is a gap.
        assert!((table.eval(tilted, tilted, [550.0; 4])[0] - 0.1 * (1.0 - 0.6_f32.asin() / FRAC_PI_2)).abs() < 1e-5);
    }

    /// The example of Mitsuba's tests, whose arrays of angles have no rows: white, and a mirror's peak towards grazing.
    #[test]
    fn the_example_of_mitsuba_is_white() {
        let Some(path) = steradian_testkit::asset("brdf/spectralon_lowres.pbsdf") else { return };
        let bytes = std::fs::read(path).expect("a file that can be read");
        let table = Polarimetric::read(&TensorFile::read(&bytes).expect("sound"), Wanted::Rgb).expect("sound");
        let f = table.eval(Vec3::Z, Vec3::Z, [0.0; 4]).to_array();
        // The first intensities of the table are 0.2224 to 0.2390 over the wavelengths.
        assert!(f[..3].iter().all(|v| (0.2..0.25).contains(v)), "{f:?}");
    }
}
