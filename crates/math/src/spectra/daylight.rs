//! Daylight of a given colour temperature: the CIE D series (CIE 15, section 3).

use super::data::daylight::S;
use super::{Blackbody, Curve, Dense};
use crate::Error;

/// The ratio by which the second radiation constant has changed since the D series was defined: D65 is daylight of 6504
/// K.
const RADIATION_CONSTANT_CHANGE: f64 = 1.4388 / 1.4380;

/// The range of correlated colour temperatures, K, over which the CIE defines daylight.
pub const RANGE: std::ops::RangeInclusive<f64> = 4000.0..=25_000.0;

/// Chromaticity `(x, y)` of daylight of correlated colour temperature `cct`, K, on today's temperature scale; `None`
/// outside [`RANGE`].
pub fn chromaticity(cct: f64) -> Option<[f64; 2]> {
    if !RANGE.contains(&cct) {
        return None;
    }
    let t = 1e3 / cct;
    let x = if cct <= 7000.0 {
        ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244063
    } else {
        ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237040
    };
    Some([x, (-3.0 * x + 2.870) * x - 0.275])
}

/// The daylight spectrum of a nominal colour temperature (6500 K is D65), about 1 at 560 nm. Where the CIE defines no
/// daylight below 4000 K it is a black body of maximum 1, as in pbrt-v4; above 25000 K, and where `nominal` is not
/// positive, it is refused.
pub fn daylight(nominal: f64) -> Result<Dense, Error> {
    let cct = nominal * RADIATION_CONSTANT_CHANGE;
    if cct > 0.0 && cct < *RANGE.start() {
        let b = Blackbody::normalized(cct);
        return Ok(Dense::new(|l| b.eval(l)));
    }
    let Some([x, y]) = chromaticity(cct) else {
        return Err(Error::Curve(format!("there is no daylight of {nominal} K: the CIE defines it up to 25000 K")));
    };
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    let m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m;
    let value = |s: &[f32; 3]| ((f64::from(s[0]) + m1 * f64::from(s[1]) + m2 * f64::from(s[2])) * 0.01) as f32;
    let curve = Curve::regular(300.0, 830.0, S.iter().map(value).collect::<Box<[f32]>>())?;
    // The CIE tabulates daylight by its values at whole nanometres.
    Ok(Dense::new(|l| curve.eval(l)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectra::{cie::to_xyz, d65};

    #[test]
    fn six_thousand_five_hundred_kelvin_is_d65() {
        let d = daylight(6500.0).unwrap();
        let scale = d65().eval(560.0) / d.eval(560.0);
        for l in [400.0, 450.0, 500.0, 600.0, 700.0, 800.0] {
            assert!(
                (d.eval(l) * scale / d65().eval(l) - 1.0).abs() < 2e-3,
                "{l} nm: {} {}",
                d.eval(l) * scale,
                d65().eval(l)
            );
        }
        assert!((d.eval(560.0) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn spectra_have_the_chromaticity_of_the_series() {
        for t in [4200.0, 5000.0, 6500.0, 7600.0, 12_000.0] {
            let d = daylight(t).unwrap();
            let xyz = to_xyz(|l| d.eval(l));
            let [x, y] = chromaticity(t * RADIATION_CONSTANT_CHANGE).unwrap();
            let sum = xyz.element_sum();
            assert!((xyz.x / sum - x).abs() < 5e-4 && (xyz.y / sum - y).abs() < 5e-4, "{t} K");
        }
    }

    #[test]
    fn outside_the_series() {
        assert!((daylight(3000.0).unwrap().max() - 1.0).abs() < 0.2);
        for t in [30_000.0, 0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(daylight(t).is_err(), "{t}");
        }
        assert_eq!(chromaticity(3999.0), None);
    }
}
