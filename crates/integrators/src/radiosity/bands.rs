//! The colours that radiosity is solved for: RGB in one band, spectra in bands of four wavelengths each.

use steradian_core::ColorMode;
use steradian_math::{
    Spectrum,
    spectra::{LAMBDA_MAX, LAMBDA_MIN, Wavelengths},
};

/// Bands of four lanes each.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    mode: ColorMode,
    wavelengths: Vec<Wavelengths>,
}

impl Bands {
    /// The band of RGB, or evenly spaced wavelengths, in fours, over the visible range.
    pub fn new(mode: ColorMode, bands: usize) -> Self {
        let wavelengths = match mode {
            ColorMode::Rgb => vec![Wavelengths::RGB],
            ColorMode::Spectral => {
                // λ_k evenly from the least to the greatest visible wavelength, four to a band.
                let count = 4 * bands.max(1);
                let at = |k: usize| LAMBDA_MIN + (LAMBDA_MAX - LAMBDA_MIN) * k as f32 / (count - 1) as f32;
                (0..bands.max(1)).map(|b| Wavelengths::at(std::array::from_fn(|l| at(4 * b + l)))).collect()
            }
        };
        Self { mode, wavelengths }
    }

    /// Number of bands.
    pub fn count(&self) -> usize {
        self.wavelengths.len()
    }

    /// The wavelengths of each.
    pub fn wavelengths(&self) -> &[Wavelengths] {
        &self.wavelengths
    }

    /// Values at the wavelengths of a path, between those of the bands.
    #[inline]
    pub fn at(&self, values: &[Spectrum], lambda: &Wavelengths) -> Spectrum {
        self.of(|band| values[band], lambda)
    }

    /// Values at the wavelengths of a path, between those that `values` gives of bands.
    #[inline]
    pub fn of(&self, values: impl Fn(usize) -> Spectrum, lambda: &Wavelengths) -> Spectrum {
        if self.mode == ColorMode::Rgb {
            return values(0);
        }
        let last = 4 * self.count() - 1;
        let value = |k: usize| values(k / 4)[k % 4];
        Spectrum::new(lambda.lambda.map(|l| {
            // Linear interpolation between the two wavelengths next to λ.
            let x = ((l - LAMBDA_MIN) / (LAMBDA_MAX - LAMBDA_MIN)).clamp(0.0, 1.0) * last as f32;
            let k = (x as usize).min(last - 1);
            let (a, b) = (value(k), value(k + 1));
            a + (b - a) * (x - k as f32)
        }))
    }
}
