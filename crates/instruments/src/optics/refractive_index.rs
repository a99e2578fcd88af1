//! Refractive indices of the transparent media that experiments are made with.

use steradian_math::spectra::dispersion::{Dispersion, FRAUNHOFER};

/// The names of media.
pub const MEDIA: &[&str] = &["bk7", "sf11", "fused-silica", "diamond", "water", "custom"];

/// The index by wavelength of a medium in [`MEDIA`]; `custom` has the index `n_d` at the d line and the Abbe number
/// `abbe`.
///
/// Sellmeier's constants: SCHOTT's data sheets (N-BK7, N-SF11); Malitson 1965 (fused silica); Peter 1923 (diamond, two
/// terms); Daimon, Masumura 2007 (water of 20 °C).
pub fn index(medium: &str, n_d: f64, abbe: f64) -> Dispersion {
    match medium {
        "bk7" => Dispersion::three_terms([
            [1.039_612_12, 0.006_000_698_67],
            [0.231_792_344, 0.020_017_914_4],
            [1.010_469_45, 103.560_653],
        ]),
        "sf11" => Dispersion::three_terms([
            [1.737_596_95, 0.013_188_707],
            [0.313_747_346, 0.062_306_814_2],
            [1.898_781_01, 155.236_29],
        ]),
        "fused-silica" => Dispersion::three_terms([
            [0.696_166_3, 0.068_404_3 * 0.068_404_3],
            [0.407_942_6, 0.116_241_4 * 0.116_241_4],
            [0.897_479_4, 9.896_161 * 9.896_161],
        ]),
        "diamond" => Dispersion::three_terms([[0.3306, 0.175 * 0.175], [4.3356, 0.106 * 0.106], [0.0, 1.0]]),
        "water" => Dispersion::Sellmeier([
            [5.684_027_565e-1, 5.101_829_712e-3],
            [1.726_177_391e-1, 1.821_153_936e-2],
            [2.086_189_578e-2, 2.620_722_293e-2],
            [1.130_748_688e-1, 1.069_792_721e1],
        ]),
        _ => Dispersion::from_abbe(n_d, abbe),
    }
}

/// Indices at the lines F, d and C.
pub fn at_lines(d: &Dispersion) -> [f64; 3] {
    FRAUNHOFER.map(|nm| d.eval(nm))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M129: catalogue values of n_d and V_d. Water: 1.3330 against air at the D lines is 1.3334 against vacuum (IAPWS
    /// 1997).
    #[test]
    fn media_have_their_published_index_and_abbe_number() {
        for (medium, n, v, (dn, dv)) in [
            ("bk7", 1.5168, 64.17, (1e-5, 0.01)),
            ("sf11", 1.784_72, 25.68, (1e-5, 0.01)),
            ("fused-silica", 1.458_46, 67.82, (1e-5, 0.05)),
            ("diamond", 2.4175, 55.3, (2e-3, 1.5)),
            ("water", 1.333_36, 55.8, (1e-4, 0.3)),
        ] {
            let d = index(medium, 0.0, 0.0);
            let nd = d.eval(FRAUNHOFER[1]);
            assert!((nd - n).abs() < dn && (d.abbe() - v).abs() < dv, "{medium}: {nd} {}", d.abbe());
        }
        assert!((index("custom", 1.6, 40.0).abbe() - 40.0).abs() < 1e-9);
    }
}
