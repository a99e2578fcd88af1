//! Optical constants that files name.

use super::{
    graph::{ObjectId, Raw},
    plugins,
    reader::Reader,
};
use steradian_math::spectra::ior::{self, DIELECTRICS};
use steradian_scene::names;

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
    pub fn conductor_name<'m>(&mut self, object: ObjectId, material: &'m str) -> Option<&'m str> {
        if ior::conductor(material).is_some() {
            return Some(material);
        }
        let help = names::did_you_mean(material, ior::conductors().chain(["none"]));
        let message = format!("unknown conductor '{material}'");
        let span = self.value_span(object, "material");
        self.diagnostics.error_help(&self.desc.sources, Some(span), message, help);
        None
    }
}
