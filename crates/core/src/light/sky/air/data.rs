//! The sun's spectrum and ozone's absorption in bands, and what is interpolated between bands.

use crate::light::sky::data as tables;
use steradian_math::{
    Spectrum, Vec3,
    color::space::REC709,
    spectra::{Wavelengths, cie},
};

/// Bands of 10 nm: so many, and the middle of the first in nm. Beyond the outermost middles values stay.
pub(super) const BANDS: usize = 48;
const FIRST: f32 = 365.0;
const STEP: f32 = 10.0;

/// A quantity by band.
pub(super) type Bands = [f32; BANDS];

/// The middle of a band in nm.
pub(super) fn wavelength(band: usize) -> f32 {
    FIRST + STEP * band as f32
}

/// Irradiance of the sun above the air at the mean distance, W/(m² nm): means over the bands of the extraterrestrial
/// column of ASTM G173-03 (Gueymard 2004).
pub(super) const SUN: Bands = [
    1.1229, 1.1391, 1.0150, 1.1581, 1.7201, 1.7336, 1.6693, 1.6434, 1.9239, 2.0312, 2.0175, 2.0286, 1.9320, 1.9523,
    1.9166, 1.8273, 1.8701, 1.8885, 1.8546, 1.8465, 1.8362, 1.8348, 1.8091, 1.7840, 1.7510, 1.6959, 1.6796, 1.6439,
    1.6004, 1.5230, 1.5550, 1.5093, 1.4733, 1.4453, 1.4093, 1.3650, 1.3412, 1.3117, 1.2826, 1.2668, 1.2345, 1.2071,
    1.1862, 1.1445, 1.1229, 1.1040, 1.0704, 1.0496,
];

/// Absorption cross-section of an ozone molecule at 233 K, 10⁻²⁷ m²: means over the bands of the measurements of
/// Serdyuchenko, Gorshelev, Weber, Chehade, Burrows, "High spectral resolution ozone absorption cross-sections – Part
/// 2", Atmos. Meas. Tech. 7 (2014), as averaged by Bruneton (precomputed_atmospheric_scattering, 2017).
pub(super) const OZONE: Bands = [
    1.18, 0.2182, 0.2818, 0.6636, 1.527, 2.763, 5.52, 8.451, 15.82, 23.16, 36.69, 49.24, 77.52, 90.16, 148.0, 160.2,
    213.9, 275.5, 309.1, 350.0, 426.6, 467.2, 439.8, 470.1, 501.9, 430.5, 374.0, 321.5, 266.2, 223.8, 185.2, 147.3,
    120.9, 94.23, 74.55, 65.66, 51.05, 41.5, 42.28, 32.37, 24.51, 28.01, 25.34, 16.24, 14.65, 20.78, 13.83, 7.105,
];

/// The band below a wavelength in nm, and how far it is to the next.
fn place(lambda: f32) -> (usize, f32) {
    // Linear interpolation between the middles of bands.
    let x = ((lambda - FIRST) / STEP).clamp(0.0, (BANDS - 1) as f32);
    let band = (x as usize).min(BANDS - 2);
    (band, x - band as f32)
}

/// A value per lane, linear between bands.
pub(super) fn at_wavelengths(lambda: &Wavelengths, value: impl Fn(usize) -> f32) -> Spectrum {
    Spectrum::new(lambda.lambda.map(|l| {
        let (band, t) = place(l);
        (value(band) * (1.0 - t) + value(band + 1) * t).max(0.0)
    }))
}

/// Contribution of each band to linear sRGB, exact for spectra that are linear between bands.
pub(super) fn rgb_of_bands() -> [Vec3; BANDS] {
    std::array::from_fn(|b| {
        let xyz = cie::to_xyz(|l| {
            let (band, t) = place(l);
            match b {
                _ if b == band => 1.0 - t,
                _ if b == band + 1 => t,
                _ => 0.0,
            }
        });
        (REC709.rgb_from_xyz() * xyz).as_vec3()
    })
}

/// The sun's limb darkening by band as polynomials of the cosine, relative to the mean over the disc: those of Hosek
/// and Wilkie, whose last stays beyond 720 nm.
pub(super) fn limb() -> [[f32; tables::LIMB]; BANDS] {
    let published = tables::limb();
    std::array::from_fn(|b| {
        // Interpolate the published polynomials between their wavelengths.
        let x = ((wavelength(b) - 320.0) / 40.0).min((tables::BANDS - 1) as f32);
        let row = (x as usize).min(tables::BANDS - 2);
        let t = x - row as f32;
        let (low, high) = (published[row], published[row + 1]);
        let c: [f32; tables::LIMB] = std::array::from_fn(|k| low[k] * (1.0 - t) + high[k] * t);
        // ∫ Σ c μᵏ 2μ dμ
        let mean: f32 = c.iter().enumerate().map(|(k, c)| 2.0 * c / (k as f32 + 2.0)).sum();
        c.map(|c| c / mean)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::spectra::photometry;

    /// The sun's illuminance above the air is 133.3 klx (Darula, Kittler, Gueymard, "Reference luminous solar
    /// constant", Solar Energy 79, 2005: 133.1 to 134.1).
    #[test]
    fn the_luminous_solar_constant() {
        let spectrum = |l: f32| at_wavelengths(&Wavelengths::at([l; 4]), |b| SUN[b]).to_array()[0];
        let lux = photometry::photometric(spectrum);
        assert!((lux / 133_300.0 - 1.0).abs() < 0.01, "{lux}");
    }

    /// Darkening leaves the irradiance as it was, and the edge is darker, most of all in the blue.
    #[test]
    fn the_limb_is_dark() {
        let limb = limb();
        let at = |b: usize, mu: f32| crate::light::sky::disc::polynomial(&limb[b], mu);
        for b in [0, 10, 30, 47] {
            let n = 2000;
            let mean: f32 = (0..n).map(|i| at(b, ((i as f32 + 0.5) / n as f32).sqrt())).sum::<f32>() / n as f32;
            assert!((mean - 1.0).abs() < 1e-3, "{b}: {mean}");
            assert!(at(b, 0.1) < 0.8 && at(b, 1.0) > 1.05);
        }
        assert!(at(8, 0.2) < at(30, 0.2));
    }
}
