//! Optical constants that files name.

use super::{
    graph::{ObjectId, Raw},
    plugins,
    reader::Reader,
};
use steradian_math::spectra::ior::DIELECTRICS;
use steradian_scene::names;

/// Conductors that Mitsuba has data for, each with the one of Steradian's table that is the same or looks most alike.
const CONDUCTORS: [(&str, &str); 47] = [
    ("a-C", "TiO2"),
    ("Ag", "Ag"),
    ("Al", "Al"),
    ("AlAs", "TiO2"),
    ("AlAs_palik", "TiO2"),
    ("AlSb", "TiO2"),
    ("AlSb_palik", "TiO2"),
    ("Au", "Au"),
    ("Be", "Al"),
    ("Be_palik", "Al"),
    ("Cr", "Al"),
    ("CsI", "MgO"),
    ("CsI_palik", "MgO"),
    ("Cu", "Cu"),
    ("Cu_palik", "Cu"),
    ("Cu2O", "Cu"),
    ("Cu2O_palik", "Cu"),
    ("CuO", "Cu"),
    ("CuO_palik", "Cu"),
    ("d-C", "TiO2"),
    ("d-C_palik", "TiO2"),
    ("Hg", "Al"),
    ("Hg_palik", "Al"),
    ("HgTe", "TiO2"),
    ("HgTe_palik", "TiO2"),
    ("Ir", "Al"),
    ("Ir_palik", "Al"),
    ("K", "Ag"),
    ("K_palik", "Ag"),
    ("Li", "Ag"),
    ("Li_palik", "Ag"),
    ("MgO", "MgO"),
    ("MgO_palik", "MgO"),
    ("Mo", "Al"),
    ("Mo_palik", "Al"),
    ("Na_palik", "Ag"),
    ("Nb", "Al"),
    ("Nb_palik", "Al"),
    ("Ni_palik", "Al"),
    ("Rh", "Al"),
    ("Rh_palik", "Al"),
    ("Ta", "Al"),
    ("TiN", "CuZn"),
    ("VN", "CuZn"),
    ("V", "Al"),
    ("W", "Al"),
    ("TiO2", "TiO2"),
];

/// Further names without near relatives in the table.
const OTHER_CONDUCTORS: [&str; 17] = [
    "Se",
    "Se_palik",
    "SiC",
    "SiC_palik",
    "SnTe",
    "SnTe_palik",
    "Te",
    "Te_palik",
    "ThF4",
    "ThF4_palik",
    "TiC",
    "TiC_palik",
    "TiO2_palik",
    "VC",
    "VC_palik",
    "V_palik",
    "W_palik",
];

impl Reader<'_> {
    /// An index of refraction, by number or name.
    pub fn ior(&mut self, object: ObjectId, name: &'static str, default: &str) -> f64 {
        let look_up = |text: &str| DIELECTRICS.iter().find(|(n, _)| n.eq_ignore_ascii_case(text)).map(|(_, v)| *v);
        let fallback = look_up(default).unwrap_or(1.0);
        let Some(prop) = self.graph.take(object, name) else { return fallback };
        let Raw::String(text) = &prop.value else {
            let value = self.float(object, name).unwrap_or(fallback);
            if value <= 0.0 {
                self.error(prop.value_span, format!("'{name}' must be above zero"));
                return fallback;
            }
            return value;
        };
        look_up(text).unwrap_or_else(|| {
            let known: Vec<&str> = DIELECTRICS.iter().map(|(n, _)| *n).collect();
            let help = names::did_you_mean(text, known.iter().copied());
            let help = help.or_else(|| Some(format!("known are {}, or a number", plugins::list(&known))));
            let message = format!("no index of refraction is known for '{text}'");
            self.diagnostics.error_help(&self.desc.sources, Some(prop.value_span), message, help);
            fallback
        })
    }

    /// Interior over exterior index of refraction, with Mitsuba's default materials for each.
    pub fn relative_ior(&mut self, object: ObjectId, interior: &str) -> f64 {
        self.ior(object, "int_ior", interior) / self.ior(object, "ext_ior", "air")
    }

    /// The name in Steradian's table for a conductor of Mitsuba's.
    pub fn conductor_name(&mut self, object: ObjectId, material: &str) -> Option<&'static str> {
        let span = self.value_span(object, "material");
        if let Some((_, ours)) = CONDUCTORS.iter().find(|(n, _)| *n == material) {
            if *ours != material.trim_end_matches("_palik") {
                self.approximated(
                    span,
                    format!("there is no measurement of the conductor '{material}'; that of {ours} is used"),
                );
            }
            return Some(ours);
        }
        if OTHER_CONDUCTORS.contains(&material) {
            self.approximated(
                span,
                format!("there is no measurement of the conductor '{material}'; that of Al is used"),
            );
            return Some("Al");
        }
        let known = CONDUCTORS.iter().map(|(n, _)| *n).chain(OTHER_CONDUCTORS).chain(["none"]);
        let help = names::did_you_mean(material, known);
        let message = format!("unknown conductor '{material}'");
        self.diagnostics.error_help(&self.desc.sources, Some(span), message, help);
        None
    }
}
