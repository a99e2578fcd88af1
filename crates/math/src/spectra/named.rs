//! Spectra that have a name in scene files: standard illuminants, metals and glasses, under the names of pbrt-v4.
//! Illuminants that pbrt-v4 lacks continue its pattern: `stdillum-C`, `stdillum-LED-B1`, `stdillum-HP1`.
//!
//! As in pbrt-v4, every curve holds its end values over the visible range, and illuminants are scaled to luminance Y =
//! 1.

use super::data::cie1931::CMF;
use super::data::{glasses, illuminants, lamps, metals};
use super::{Curve, Dense, ior};
use std::sync::LazyLock;

/// A name, its samples (λ in nm and value, interleaved), and whether it is an illuminant.
struct Entry {
    name: &'static str,
    samples: &'static [f32],
    illuminant: bool,
}

const fn plain(name: &'static str, samples: &'static [f32]) -> Entry {
    Entry { name, samples, illuminant: false }
}

const fn light(name: &'static str, samples: &'static [f32]) -> Entry {
    Entry { name, samples, illuminant: true }
}

/// The glasses SF5, SF10 and SF11 are known under the catalogue's names and under those of pbrt-v4, which drop the S.
static ENTRIES: &[Entry] = &[
    plain("glass-BK7", glasses::BK7),
    plain("glass-BAF10", glasses::BAF10),
    plain("glass-FK51A", glasses::FK51A),
    plain("glass-LASF9", glasses::LASF9),
    plain("glass-F5", glasses::SF5),
    plain("glass-F10", glasses::SF10),
    plain("glass-F11", glasses::SF11),
    plain("glass-SF5", glasses::SF5),
    plain("glass-SF10", glasses::SF10),
    plain("glass-SF11", glasses::SF11),
    plain("metal-Ag-eta", metals::AG_ETA),
    plain("metal-Ag-k", metals::AG_K),
    plain("metal-Al-eta", metals::AL_ETA),
    plain("metal-Al-k", metals::AL_K),
    plain("metal-Au-eta", metals::AU_ETA),
    plain("metal-Au-k", metals::AU_K),
    plain("metal-Cu-eta", metals::CU_ETA),
    plain("metal-Cu-k", metals::CU_K),
    plain("metal-CuZn-eta", metals::CUZN_ETA),
    plain("metal-CuZn-k", metals::CUZN_K),
    plain("metal-MgO-eta", metals::MGO_ETA),
    plain("metal-MgO-k", metals::MGO_K),
    plain("metal-TiO2-eta", metals::TIO2_ETA),
    plain("metal-TiO2-k", metals::TIO2_K),
    light("stdillum-A", illuminants::A),
    light("stdillum-D50", illuminants::D50),
    light("stdillum-D65", illuminants::D65),
    light("stdillum-F1", illuminants::F1),
    light("stdillum-F2", illuminants::F2),
    light("stdillum-F3", illuminants::F3),
    light("stdillum-F4", illuminants::F4),
    light("stdillum-F5", illuminants::F5),
    light("stdillum-F6", illuminants::F6),
    light("stdillum-F7", illuminants::F7),
    light("stdillum-F8", illuminants::F8),
    light("stdillum-F9", illuminants::F9),
    light("stdillum-F10", illuminants::F10),
    light("stdillum-F11", illuminants::F11),
    light("stdillum-F12", illuminants::F12),
    light("stdillum-C", lamps::C),
    light("stdillum-D55", lamps::D55),
    light("stdillum-D75", lamps::D75),
    light("stdillum-LED-B1", lamps::LED_B1),
    light("stdillum-LED-B2", lamps::LED_B2),
    light("stdillum-LED-B3", lamps::LED_B3),
    light("stdillum-LED-B4", lamps::LED_B4),
    light("stdillum-LED-B5", lamps::LED_B5),
    light("stdillum-LED-BH1", lamps::LED_BH1),
    light("stdillum-LED-RGB1", lamps::LED_RGB1),
    light("stdillum-LED-V1", lamps::LED_V1),
    light("stdillum-LED-V2", lamps::LED_V2),
    light("stdillum-HP1", lamps::HP1),
    light("stdillum-HP2", lamps::HP2),
    light("stdillum-HP3", lamps::HP3),
    light("stdillum-HP4", lamps::HP4),
    light("stdillum-HP5", lamps::HP5),
    light("illum-acesD60", illuminants::ACES_D60),
];

/// The spectrum called `name`, end values held over the visible range, illuminants scaled to luminance Y = 1. Case
/// matters.
pub fn named(name: &str) -> Option<Curve> {
    let Some(entry) = ENTRIES.iter().find(|e| e.name == name) else { return ior::further_conductor(name) };
    let curve = Curve::from_interleaved(entry.samples).ok()?.extended();
    Some(if entry.illuminant { curve.normalized() } else { curve })
}

/// All names that [`named`] knows, but for the suffix `_palik` of conductors, which is taken too.
pub fn names() -> impl Iterator<Item = &'static str> {
    ENTRIES.iter().map(|e| e.name).chain(ior::further_names())
}

/// CIE standard illuminant D65 at luminance Y = 1: the white of sRGB.
pub fn d65() -> &'static Dense {
    static D65: LazyLock<Dense> = LazyLock::new(|| white("stdillum-D65"));
    &D65
}

/// The white of the ACES colour spaces at luminance Y = 1.
pub fn aces_d60() -> &'static Dense {
    static D60: LazyLock<Dense> = LazyLock::new(|| white("illum-acesD60"));
    &D60
}

fn white(name: &str) -> Dense {
    // Both callers name an entry of the table, so the equal-energy white never stands in.
    // Standards tabulate whites by their values at whole nanometres.
    named(name).map_or_else(|| Dense::new(|_| 1.0), |c| Dense::new(|l| c.eval(l)))
}

/// XYZ, at Y = 1, of an illuminant: at compile time, for the matrices of the colour spaces. The
/// tables begin at 300 nm.
pub(crate) const fn white_xyz(illuminant: Illuminant) -> [f64; 3] {
    let samples = match illuminant {
        Illuminant::D65 => illuminants::D65,
        Illuminant::AcesD60 => illuminants::ACES_D60,
    };
    let mut xyz = [0.0; 3];
    let mut nm = 0;
    while nm < CMF.len() {
        // Linear between the samples at 5-nm steps; the value follows its wavelength.
        let (i, t) = ((60 + nm) / 5, (nm % 5) as f64 / 5.0);
        let after = if t > 0.0 { i + 1 } else { i };
        let s = samples[2 * i + 1] as f64 * (1.0 - t) + samples[2 * after + 1] as f64 * t;
        let mut c = 0;
        while c < 3 {
            xyz[c] += s * CMF[nm][c];
            c += 1;
        }
        nm += 1;
    }
    [xyz[0] / xyz[1], 1.0, xyz[2] / xyz[1]]
}

/// The illuminants that are the white of a colour space.
#[derive(Clone, Copy)]
pub(crate) enum Illuminant {
    D65,
    AcesD60,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectra::cie::to_xyz;

    #[test]
    fn every_name_is_a_curve_over_the_visible_range() {
        for name in names() {
            let c = named(name).unwrap();
            assert!(c.eval(360.0) >= 0.0 && c.eval(830.0) >= 0.0);
            assert!(c.lambda()[0] <= 360.0 && *c.lambda().last().unwrap() >= 830.0, "{name}");
            assert!(c.values().iter().all(|v| (0.0..40.0).contains(v)), "{name}");
        }
        assert!(named("metal-Unobtainium-eta").is_none());
    }

    #[test]
    fn illuminants_have_luminance_one_and_their_published_chromaticity() {
        // CIE 15:2018; for A to F11 also CIE 15:2004, tables T.3 and T.8.
        for (name, x, y) in [
            ("stdillum-A", 0.44758, 0.40745),
            ("stdillum-D65", 0.31272, 0.32903),
            ("stdillum-F2", 0.3721, 0.3751),
            ("stdillum-F7", 0.3129, 0.3292),
            ("stdillum-F11", 0.3805, 0.3769),
            ("stdillum-C", 0.3101, 0.3162),
            ("stdillum-D55", 0.3324, 0.3474),
            ("stdillum-D75", 0.2990, 0.3149),
            ("stdillum-LED-B1", 0.4560, 0.4078),
            ("stdillum-LED-B2", 0.4357, 0.4012),
            ("stdillum-LED-B3", 0.3756, 0.3723),
            ("stdillum-LED-B4", 0.3422, 0.3502),
            ("stdillum-LED-B5", 0.3118, 0.3236),
            ("stdillum-LED-BH1", 0.4474, 0.4066),
            ("stdillum-LED-RGB1", 0.4557, 0.4211),
            ("stdillum-LED-V1", 0.4548, 0.4044),
            ("stdillum-LED-V2", 0.3781, 0.3775),
            ("stdillum-HP1", 0.5330, 0.4150),
            ("stdillum-HP2", 0.4778, 0.4158),
            ("stdillum-HP3", 0.4302, 0.4075),
            ("stdillum-HP4", 0.3812, 0.3797),
            ("stdillum-HP5", 0.3776, 0.3713),
        ] {
            let c = named(name).unwrap();
            let xyz = to_xyz(|l| c.eval(l));
            let sum = xyz.element_sum();
            assert!((xyz.y - 1.0).abs() < 1e-6, "{name}: {}", xyz.y);
            assert!(
                (xyz.x / sum - x).abs() < 3e-4 && (xyz.y / sum - y).abs() < 3e-4,
                "{name}: {} {}",
                xyz.x / sum,
                xyz.y / sum
            );
        }
    }

    #[test]
    fn compile_time_whites_are_those_of_the_curves() {
        for (illuminant, dense) in [(Illuminant::D65, d65()), (Illuminant::AcesD60, aces_d60())] {
            let xyz = to_xyz(|l| dense.eval(l));
            assert!((xyz - glam::DVec3::from(white_xyz(illuminant))).length() < 1e-6);
        }
    }

    /// Reflectance at normal incidence, `((η−1)² + κ²) / ((η+1)² + κ²)`: gold is yellow, copper red, silver and
    /// aluminium bright.
    #[test]
    fn metals_reflect_like_themselves() {
        let reflectance = |metal: &str, l: f32| {
            let at = |q: &str| named(&format!("metal-{metal}-{q}")).unwrap().eval(l);
            let (n, k) = (at("eta"), at("k"));
            ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k)
        };
        assert!(reflectance("Au", 650.0) > 0.92 && reflectance("Au", 450.0) < 0.45);
        assert!(reflectance("Cu", 650.0) > 0.9 && reflectance("Cu", 500.0) < 0.65);
        assert!((450..=650).all(|l| reflectance("Ag", l as f32) > 0.9 && reflectance("Al", l as f32) > 0.88));
        assert!(reflectance("MgO", 550.0) < 0.1);
    }

    #[test]
    fn glasses_have_their_catalogue_index_and_disperse_normally() {
        // SCHOTT catalogue, index at the sodium d line, 587.6 nm.
        for (name, nd) in [
            ("BK7", 1.5168),
            ("BAF10", 1.6700),
            ("FK51A", 1.4866),
            ("LASF9", 1.8503),
            ("SF10", 1.7283),
            ("SF11", 1.7847),
        ] {
            let c = named(&format!("glass-{name}")).unwrap();
            assert!((c.eval(587.6) - nd).abs() < 5e-4, "{name}: {}", c.eval(587.6));
            assert!(c.values().windows(2).all(|w| w[0] >= w[1]), "{name}");
        }
        assert_eq!(named("glass-F10"), named("glass-SF10"));
    }
}
