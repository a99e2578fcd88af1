//! Isotropic BRDFs in the binary files of the MERL database.
//!
//! Three `i32` sizes (90, 90, 180: half angle, difference angle, azimuth), then one block of `f64` for each of red,
//! green and blue, azimuth fastest. Half angles are spaced by the square of the index, the others evenly; azimuths
//! cover [0, π), the rest follows by reciprocity. Values are `f` (sr⁻¹) after multiplication by 1/1500, 1.15/1500 and
//! 1.66/1500. Matusik, Pfister, Brand, McMillan, "A Data-Driven Reflectance Model" (2003). Values are looked up
//! linearly between the centres of bins; negative ones mark what was not measured and count as zero.

use super::{MeasuredError, rusinkiewicz::HalfDifference};
use std::f32::consts::{FRAC_PI_2, PI};
use steradian_math::Vec3;

/// Factors on red, green and blue.
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// Largest size along one axis that is believed.
const MAX_SIZE: i32 = 1024;

/// A measurement.
#[derive(Clone, Debug)]
pub struct Merl {
    size: [usize; 3],
    /// `f` in linear RGB.
    values: Vec<[f32; 3]>,
}

impl Merl {
    /// True if bytes have the size that their header declares.
    pub fn is(bytes: &[u8]) -> bool {
        sizes(bytes).is_some_and(|s| length(s) == bytes.len())
    }

    /// From the bytes of a file.
    ///
    /// # Errors
    /// Sizes that do not fit the file, or values that are not finite.
    pub fn read(bytes: &[u8]) -> Result<Self, MeasuredError> {
        let size = sizes(bytes).ok_or(MeasuredError::NotThis("a MERL file"))?;
        let wanted = length(size);
        if bytes.len() != wanted {
            return Err(MeasuredError::Fault(format!(
                "its header asks for {wanted} bytes, but it has {}",
                bytes.len()
            )));
        }
        let count = size.iter().product::<usize>();
        // Blocks of doubles by channel; scale each and hold what was not measured at zero.
        let (numbers, _) = bytes[12..].as_chunks::<8>();
        let mut values = vec![[0.0; 3]; count];
        for (i, raw) in numbers.iter().enumerate() {
            let v = f64::from_le_bytes(*raw);
            if !v.is_finite() {
                return Err(MeasuredError::Fault(format!("value {i} is not finite")));
            }
            values[i % count][i / count] = (v * SCALES[i / count]).clamp(0.0, 1e30) as f32;
        }
        Ok(Self { size, values })
    }

    /// `f` (sr⁻¹) in linear RGB for two directions above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        let Some(a) = HalfDifference::new(wi, wo) else { return Vec3::ZERO };
        let [nh, nd, np] = self.size;
        // Neighbouring centres of bins, clamped at the ends.
        let place = |x: f32, n: usize| {
            let x = (x * n as f32 - 0.5).clamp(0.0, (n - 1) as f32);
            let i = (x as usize).min(n.saturating_sub(2));
            (i, (i + 1).min(n - 1), x - i as f32)
        };
        // Half angles are spaced by squares: the index goes with the root.
        let (h0, h1, fh) = place((a.theta_h / FRAC_PI_2).max(0.0).sqrt(), nh);
        let (d0, d1, fd) = place(a.theta_d / FRAC_PI_2, nd);
        // By reciprocity the azimuth has the period π.
        let turns = a.phi_d / PI;
        let x = (turns - turns.floor()) * np as f32 - 0.5 + np as f32;
        let p0 = x as usize % np;
        let (p1, fp) = ((p0 + 1) % np, x.fract());
        // Trilinear interpolation over azimuth, difference angle and half angle.
        let at = |h: usize, d: usize, p: usize| Vec3::from(self.values[(h * nd + d) * np + p]);
        let along = |h, d| at(h, d, p0).lerp(at(h, d, p1), fp);
        let across = |h| along(h, d0).lerp(along(h, d1), fd);
        across(h0).lerp(across(h1), fh)
    }
}

fn sizes(bytes: &[u8]) -> Option<[usize; 3]> {
    let (head, _) = bytes.get(..12)?.as_chunks::<4>();
    let size = [0, 1, 2].map(|i| i32::from_le_bytes(head[i]));
    size.iter().all(|s| (1..=MAX_SIZE).contains(s)).then(|| size.map(|s| s as usize))
}

fn length(size: [usize; 3]) -> usize {
    12 + 3 * 8 * size.iter().product::<usize>()
}

/// A file with the given half, difference and azimuth sizes, of `f(theta_h, theta_d, phi_d)` in radians.
pub fn write(size: [usize; 3], f: impl Fn(f64, f64, f64) -> [f64; 3]) -> Vec<u8> {
    let mut out: Vec<u8> = size.iter().flat_map(|s| (*s as i32).to_le_bytes()).collect();
    let [nh, nd, np] = size;
    let half_pi = std::f64::consts::FRAC_PI_2;
    for (channel, scale) in SCALES.iter().enumerate() {
        for i in 0..nh * nd * np {
            let (h, d, p) = (i / (nd * np), i / np % nd, i % np);
            // Centres of bins, the half angle by the square of the index.
            let centre = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
            let theta_h = centre(h, nh).powi(2) * half_pi;
            let v = f(theta_h, centre(d, nd) * half_pi, centre(p, np) * 2.0 * half_pi)[channel];
            out.extend((v / scale).to_le_bytes());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M106: a tabulated analytic model is found again between its samples.
    #[test]
    fn a_tabulated_model_comes_back() {
        let model = |h: f64, d: f64, p: f64| {
            let lobe = (-4.0 * h * h).exp();
            [0.3 * lobe + 0.1, 0.2 * lobe * (1.0 + d), 0.1 + 0.05 * (2.0 * p).cos() * d]
        };
        let bytes = write([90, 90, 180], model);
        assert!(Merl::is(&bytes));
        let merl = Merl::read(&bytes).expect("sound");
        let mut rng = steradian_math::hash::HashRng::new(1);
        for _ in 0..2000 {
            let mut w = || steradian_math::warp::cosine_hemisphere((rng.next_f32(), rng.next_f32()).into());
            let (wo, wi) = (w(), w());
            let a = HalfDifference::new(wi, wo).expect("two directions above");
            let (d, h) = (f64::from(a.theta_d), f64::from(a.theta_h));
            if wo.z < 0.02 || wi.z < 0.02 || d < 0.02 || h < 1e-3 {
                continue;
            }
            let expected = model(h, d, f64::from(a.phi_d));
            let found = merl.eval(wo, wi).as_dvec3().to_array();
            for c in 0..3 {
                assert!((found[c] - expected[c]).abs() < 2e-3, "{wo} {wi}: {found:?} not {expected:?}");
            }
        }
    }

    #[test]
    fn hostile_files_are_refused() {
        let good = write([2, 3, 4], |_, _, _| [0.1; 3]);
        assert!(Merl::read(&good).is_ok());
        for n in [0, 5, 12, 20, good.len() - 1] {
            assert!(Merl::read(&good[..n]).is_err(), "cut to {n}");
        }
        let with = |at: usize, bytes: &[u8]| {
            let mut bad = good.clone();
            bad[at..at + bytes.len()].copy_from_slice(bytes);
            Merl::read(&bad)
        };
        for size in [0i32, -1, 3, 1000, 1_000_000_000, i32::MAX, i32::MIN] {
            assert!(with(0, &size.to_le_bytes()).is_err(), "size {size}");
        }
        for value in [f64::NAN, f64::INFINITY] {
            assert!(with(12, &value.to_le_bytes()).is_err(), "{value}");
        }
        // What was not measured is black.
        assert!(with(12, &(-1.0f64).to_le_bytes()).is_ok());
        let huge = with(12, &1e300f64.to_le_bytes()).expect("read");
        assert!(huge.eval(Vec3::Z, Vec3::Z).is_finite());
    }
}
