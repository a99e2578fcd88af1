//! Indices of refraction by material name, as Mitsuba's scene files use them.

use super::data::conductors::CONDUCTORS;
use super::{Curve, named};
use std::sync::LazyLock;

/// Dielectrics and their index of refraction at 589 nm, 0 °C to 20 °C (after Hecht, *Optics*), under Mitsuba's names.
pub const DIELECTRICS: &[(&str, f64)] = &[
    ("vacuum", 1.0),
    ("helium", 1.000036),
    ("hydrogen", 1.000132),
    ("air", 1.000277),
    ("carbon dioxide", 1.00045),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.470),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// The index of refraction of a dielectric of Mitsuba's list; case does not matter.
pub fn dielectric(name: &str) -> Option<f64> {
    DIELECTRICS.iter().find(|(n, _)| n.eq_ignore_ascii_case(name)).map(|(_, ior)| *ior)
}

/// The conductors under pbrt-v4's names. Further ones, under Mitsuba's, are among [`conductors`].
const METALS: &[&str] = &["Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"];

/// The names of all conductors of which there are measurements here.
pub fn conductors() -> impl Iterator<Item = &'static str> {
    METALS.iter().copied().chain(CONDUCTORS.iter().map(|c| c.0))
}

/// The complex index of refraction `(η, κ)` of a conductor of [`conductors`], over the visible range. Mitsuba's suffix
/// `_palik` is taken, too. `None` for other names (Mitsuba's `none`, the perfect mirror, has no index of refraction at
/// all).
pub fn conductor(name: &str) -> Option<(Curve, Curve)> {
    Some((named(&format!("metal-{name}-eta"))?, named(&format!("metal-{name}-k"))?))
}

/// The curve called `metal-NAME-eta` or `metal-NAME-k` of the further conductors, and of all those with the suffix
/// `_palik`.
pub(super) fn further_conductor(spectrum: &str) -> Option<Curve> {
    let (name, column) = split(spectrum)?;
    if let Some((_, samples)) = CONDUCTORS.iter().find(|c| c.0 == name) {
        let (lambda, value): (Vec<f32>, Vec<f32>) = samples.iter().map(|s| (s[0], s[column])).unzip();
        return Some(Curve::new(lambda, value).ok()?.extended());
    }
    let plain = name.strip_suffix("_palik").filter(|n| !n.ends_with("_palik"))?;
    named(&spectrum.replacen(name, plain, 1))
}

/// Name of the conductor and column of its table.
fn split(spectrum: &str) -> Option<(&str, usize)> {
    let name = spectrum.strip_prefix("metal-")?;
    name.strip_suffix("-eta").map(|n| (n, 1)).or_else(|| name.strip_suffix("-k").map(|n| (n, 2)))
}

/// The names of the further conductors' curves.
pub(super) fn further_names() -> impl Iterator<Item = &'static str> {
    static NAMES: LazyLock<Vec<String>> = LazyLock::new(|| {
        CONDUCTORS.iter().flat_map(|c| ["eta", "k"].map(|part| format!("metal-{}-{part}", c.0))).collect()
    });
    NAMES.iter().map(String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_resolve() {
        assert_eq!(dielectric("BK7"), Some(1.5046));
        assert_eq!(dielectric("diamond"), Some(2.419));
        assert_eq!(dielectric("cheese"), None);
        for c in conductors() {
            let (eta, k) = conductor(c).unwrap();
            assert!(eta.eval(550.0) > 0.0 && k.eval(550.0) >= 0.0, "{c}");
        }
        assert!(conductor("Unobtainium").is_none() && conductor("none").is_none());
        assert_eq!(conductor("W_palik"), conductor("W"));
        assert_eq!(conductor("Au_palik"), conductor("Au"));
        assert_ne!(conductor("Cu_palik"), conductor("Cu"));
        assert!(conductor("W_palik_palik").is_none() && named("metal-").is_none() && named("metal--k").is_none());
    }

    /// Chromium and tungsten reflect about half of yellow light, mercury three quarters, sodium nearly all; diamond
    /// bends it by 2.417.
    #[test]
    fn further_conductors_are_like_themselves() {
        let reflectance = |name: &str, l: f32| {
            let (n, k) = conductor(name).unwrap();
            let (n, k) = (n.eval(l), k.eval(l));
            ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k)
        };
        // Chromium by Palik: n = 3.2, k = 4.4.
        for (name, lambda, expected) in
            [("Cr", 580.0, 0.655), ("W", 580.0, 0.50), ("Hg", 580.0, 0.77), ("Na", 580.0, 0.97)]
        {
            let r = reflectance(name, lambda);
            assert!((r - expected).abs() < 0.035, "{name}: {r}");
        }
        assert!((conductor("d-C").unwrap().0.eval(589.3) - 2.417).abs() < 2e-3);
    }
}
