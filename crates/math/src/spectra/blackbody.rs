//! Thermal emission: Planck's law.
//!
//! `B_λ(T) = 2hc² / λ⁵ / (exp(hc / λ k T) − 1)`, `B_ν(T) = 2hν³ / c² / (exp(hν / k T) − 1)`, with the exact SI
//! constants of 2019.

use super::Wavelengths;
use crate::Spectrum;

/// Speed of light, m/s.
pub const SPEED_OF_LIGHT: f64 = 299_792_458.0;
/// Planck's constant, J s.
pub const PLANCK: f64 = 6.626_070_15e-34;
/// Boltzmann's constant, J/K.
pub const BOLTZMANN: f64 = 1.380_649e-23;
/// Wien's displacement constant, m K: `B_λ` is largest at this over the temperature.
pub const WIEN: f64 = 2.897_771_955e-3;
/// Stefan's constant, W/(m² K⁴): `π ∫ B dλ = σT⁴`.
pub const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// Spectral radiance of a black body of `kelvin` at wavelength `metres`, per metre of wavelength: W/(m² sr m). Zero
/// where either is not positive.
pub fn planck_wavelength(metres: f64, kelvin: f64) -> f64 {
    if !(metres > 0.0 && kelvin > 0.0) {
        return 0.0;
    }
    let x = PLANCK * SPEED_OF_LIGHT / (metres * BOLTZMANN * kelvin);
    bounded(2.0 * PLANCK * SPEED_OF_LIGHT * SPEED_OF_LIGHT / metres.powi(5) / x.exp_m1())
}

/// Spectral radiance of a black body of `kelvin` at frequency `hertz`, per hertz: W/(m² sr Hz). Zero where either is
/// not positive.
pub fn planck_frequency(hertz: f64, kelvin: f64) -> f64 {
    if !(hertz > 0.0 && kelvin > 0.0) {
        return 0.0;
    }
    let x = PLANCK * hertz / (BOLTZMANN * kelvin);
    bounded(2.0 * PLANCK * hertz.powi(3) / (SPEED_OF_LIGHT * SPEED_OF_LIGHT) / x.exp_m1())
}

/// 0/0 and ∞/∞ at arguments beyond the range of `f64`: no emission.
fn bounded(v: f64) -> f64 {
    if v.is_finite() { v } else { 0.0 }
}

/// The emission spectrum of a black body: radiance, or scaled so that its maximum over all wavelengths is 1 (pbrt-v4's
/// `blackbody` parameters).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blackbody {
    kelvin: f64,
    scale: f64,
}

impl Blackbody {
    /// Spectral radiance in W/(m² sr nm).
    pub fn radiance(kelvin: f64) -> Self {
        Self { kelvin, scale: 1e-9 }
    }

    /// Scaled to the maximum 1, which it has at 2.898e6 nm K / T; zero everywhere where `kelvin` is not positive.
    pub fn normalized(kelvin: f64) -> Self {
        let max = planck_wavelength(WIEN / kelvin, kelvin);
        Self { kelvin, scale: if max > 0.0 { 1.0 / max } else { 0.0 } }
    }

    /// The temperature, K.
    pub fn kelvin(&self) -> f64 {
        self.kelvin
    }

    /// The value at `lambda` nm.
    pub fn eval(&self, lambda: f32) -> f32 {
        (planck_wavelength(f64::from(lambda) * 1e-9, self.kelvin) * self.scale) as f32
    }

    /// The values at four sampled wavelengths.
    pub fn sample(&self, wavelengths: &Wavelengths) -> Spectrum {
        Spectrum::new(wavelengths.lambda.map(|l| self.eval(l)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Simpson's rule in ln λ, over which Planck's curve is smooth and falls to nothing at both ends.
    fn integral_over_wavelength(kelvin: f64) -> f64 {
        let (a, b, n) = ((1e-8f64 / 1.0).ln(), 1f64.ln(), 20_000);
        let h = (b - a) / n as f64;
        let weight = |i| {
            if i == 0 || i == n {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        (0..=n)
            .map(|i| (a + h * i as f64).exp())
            .enumerate()
            .map(|(i, l)| weight(i) * l * planck_wavelength(l, kelvin))
            .sum::<f64>()
            * h
            / 3.0
    }

    #[test]
    fn the_whole_emission_is_stefans_law() {
        for t in [1000.0, 2856.0, 6500.0, 20_000.0f64] {
            let ratio = integral_over_wavelength(t) / (STEFAN_BOLTZMANN * t.powi(4) / PI);
            assert!((ratio - 1.0).abs() < 1e-6, "{t} K: {ratio}");
        }
    }

    #[test]
    fn known_radiance_and_wiens_peak() {
        assert!((planck_wavelength(550e-9, 5778.0) / 2.585764e13 - 1.0).abs() < 1e-6);
        let peak = (0..200_000)
            .map(|i| 400.0 + i as f64 * 0.0005)
            .max_by(|a, b| planck_wavelength(a * 1e-9, 6500.0).total_cmp(&planck_wavelength(b * 1e-9, 6500.0)));
        assert!((peak.unwrap() - 445.81).abs() < 0.01, "{peak:?}");
        assert!((WIEN / 6500.0 * 1e9 - 445.81).abs() < 0.005);
    }

    #[test]
    fn frequency_and_wavelength_forms_describe_the_same_light() {
        let (l, t) = (550e-9, 5778.0);
        let nu = SPEED_OF_LIGHT / l;
        let ratio = planck_frequency(nu, t) * SPEED_OF_LIGHT / (l * l) / planck_wavelength(l, t);
        assert!((ratio - 1.0).abs() < 1e-12);
    }

    #[test]
    fn normalized_peaks_at_one_and_nonsense_emits_nothing() {
        let b = Blackbody::normalized(6500.0);
        assert!((b.eval(445.811) - 1.0).abs() < 1e-6);
        assert!(b.eval(360.0) < 1.0 && b.eval(830.0) < 1.0);
        for k in [0.0, -5.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
            for b in [Blackbody::normalized(k), Blackbody::radiance(k)] {
                assert!([360.0, 500.0, 830.0, 0.0, -1.0, f32::NAN].iter().all(|&l| !b.eval(l).is_nan()), "{k} K");
            }
            assert_eq!(if k > 1.0 && k.is_finite() { 0.0 } else { Blackbody::radiance(k).eval(500.0) }, 0.0);
        }
    }
}
