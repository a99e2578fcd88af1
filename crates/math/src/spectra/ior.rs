//! Indices of refraction by material name, as Mitsuba's scene files use them.

use super::{Curve, named};

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

/// The conductors of which there are measurements here.
pub const CONDUCTORS: &[&str] = &["Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"];

/// The complex index of refraction `(η, κ)` of a conductor of [`CONDUCTORS`], over the visible range. `None` for the other names
/// of Mitsuba's list, of which there are no measurements here (its `none`, the perfect mirror, has no index of refraction at all).
pub fn conductor(name: &str) -> Option<(Curve, Curve)> {
    let name = CONDUCTORS.iter().find(|c| **c == name)?;
    Some((named(&format!("metal-{name}-eta"))?, named(&format!("metal-{name}-k"))?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_resolve() {
        assert_eq!(dielectric("BK7"), Some(1.5046));
        assert_eq!(dielectric("diamond"), Some(2.419));
        assert_eq!(dielectric("cheese"), None);
        for c in CONDUCTORS {
            let (eta, k) = conductor(c).unwrap();
            assert!(eta.eval(550.0) > 0.0 && k.eval(550.0) >= 0.0, "{c}");
        }
        assert!(conductor("Cr").is_none() && conductor("none").is_none());
    }
}
