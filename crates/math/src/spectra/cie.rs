//! The CIE 1931 2° standard observer: colour matching functions, and integrals of spectra against them.
//!
//! `X = ∫ s(λ) x̄(λ) dλ / ∫ ȳ dλ`, and likewise Y and Z. The integrals are sums over whole nanometres, the resolution
//! at which the functions are tabulated; this is also pbrt-v4's convention, so equal spectra have equal colours.

use super::data::cie1931::CMF;
use super::{LAMBDA_COUNT, LAMBDA_MIN};
use crate::Vec4;
use glam::DVec3;

/// `∫ ȳ(λ) dλ` in nm, by which tristimulus values are divided so that the constant spectrum 1 has Y = 1.
pub const CIE_Y_INTEGRAL: f64 = 106.856895;

/// x̄, ȳ, z̄ and zero at every nanometre, in the layout the estimators load.
pub(super) static CMF_F32: [Vec4; LAMBDA_COUNT] = {
    let mut table = [Vec4::ZERO; LAMBDA_COUNT];
    let mut i = 0;
    while i < LAMBDA_COUNT {
        table[i] = Vec4::new(CMF[i][0] as f32, CMF[i][1] as f32, CMF[i][2] as f32, 0.0);
        i += 1;
    }
    table
};

/// The table index of the whole nanometre nearest to `lambda`, `None` outside the visible range (and for NaN).
#[inline]
pub(super) fn nearest(lambda: f32) -> Option<usize> {
    let i = lambda - LAMBDA_MIN + 0.5;
    (i >= 0.0 && i < LAMBDA_COUNT as f32).then_some(i as usize)
}

/// `[x̄, ȳ, z̄]` at `lambda` (nm), of the nearest whole nanometre; zero outside 360 nm to 830 nm.
#[inline]
pub fn matching(lambda: f32) -> [f32; 3] {
    nearest(lambda).map_or([0.0; 3], |i| CMF_F32[i].truncate().to_array())
}

/// `[x̄, ȳ, z̄]` at `lambda` (nm) between the tabulated nanometres, linear; zero outside 360 nm to 830 nm.
pub fn matching_linear(lambda: f64) -> [f64; 3] {
    let x = lambda - f64::from(LAMBDA_MIN);
    if !(0.0..=(LAMBDA_COUNT - 1) as f64).contains(&x) {
        return [0.0; 3];
    }
    let i = (x as usize).min(LAMBDA_COUNT - 2);
    let t = x - i as f64;
    std::array::from_fn(|c| CMF[i][c] * (1.0 - t) + CMF[i + 1][c] * t)
}

/// The visible wavelengths at which integrals are summed: 360, 361, …, 830 nm.
pub fn lambdas() -> impl Iterator<Item = f32> {
    (0..LAMBDA_COUNT).map(|i| LAMBDA_MIN + i as f32)
}

/// CIE XYZ of the spectrum `s(λ in nm)`: `∫ s x̄ dλ / CIE_Y_INTEGRAL`, … The constant spectrum 1 has Y = 1.
pub fn to_xyz(s: impl Fn(f32) -> f32) -> DVec3 {
    lambdas().zip(CMF).map(|(l, c)| DVec3::from_array(c) * f64::from(s(l))).sum::<DVec3>() / CIE_Y_INTEGRAL
}

/// `∫ s(λ) ȳ(λ) dλ` in the unit of `s` times nm: pbrt-v4's photometric integral, without the factor 683 lm/W.
pub fn to_photometric(s: impl Fn(f32) -> f32) -> f64 {
    to_xyz(s).y * CIE_Y_INTEGRAL
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stated_integral_is_that_of_the_table() {
        let sum: f64 = CMF.iter().map(|c| c[1]).sum();
        assert!((sum - CIE_Y_INTEGRAL).abs() < 5e-5, "{sum}");
    }

    #[test]
    fn equal_energy_is_the_centre_of_the_chromaticity_diagram() {
        let e = to_xyz(|_| 1.0);
        let sum = e.element_sum();
        // The tabulated functions have equal areas to 3e-4.
        assert!((e.x / sum - 1.0 / 3.0).abs() < 1e-4, "{e}");
        assert!((e.y / sum - 1.0 / 3.0).abs() < 1e-4, "{e}");
        assert!((e.y - 1.0).abs() < 1e-6);
    }

    #[test]
    fn lookups_round_to_the_nearest_nanometre_and_vanish_outside() {
        assert_eq!(matching(555.0)[1], 1.0);
        assert_eq!(matching(554.6), matching(555.4));
        assert_eq!(matching(359.4), [0.0; 3]);
        assert_eq!(matching(830.6), [0.0; 3]);
        assert_eq!(matching(f32::NAN), [0.0; 3]);
        assert_eq!(matching(f32::INFINITY), [0.0; 3]);
        assert!(matching(830.0)[0] > 0.0 && matching(360.0)[0] > 0.0);
    }

    #[test]
    fn linear_lookup_meets_the_table_and_averages_between() {
        let (a, b, m) = (matching_linear(600.0), matching_linear(601.0), matching_linear(600.5));
        assert_eq!(a, CMF[240]);
        for c in 0..3 {
            assert!((m[c] - 0.5 * (a[c] + b[c])).abs() < 1e-12);
        }
        assert_eq!(matching_linear(830.0), CMF[470]);
        assert_eq!(matching_linear(830.1), [0.0; 3]);
    }
}
