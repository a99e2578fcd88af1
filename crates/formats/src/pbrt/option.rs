//! `Option`.

use super::reader::{Done, Reader};
use steradian_scene::names;

/// All options, without dashes and underscores.
pub(super) const KNOWN: [&str; 11] = [
    "disablepixeljitter",
    "disabletexturefiltering",
    "disablewavelengthjitter",
    "displacementedgescale",
    "forcediffuse",
    "msereferenceimage",
    "msereferenceout",
    "pixelstats",
    "rendercoordsys",
    "seed",
    "wavefront",
];

impl Reader<'_> {
    pub(super) fn option(&mut self) -> Done {
        let (name, span) = self.quoted()?;
        let token = self.token()?;
        let lexer = self.lexer();
        let value_span = lexer.token_span(token);
        let value = String::from_utf8_lossy(lexer.bytes(token)).trim_matches('"').to_string();
        // pbrt reads the names of options without regard to case, dashes and underscores.
        let plain: String = name.chars().filter(|c| !"-_".contains(*c)).flat_map(char::to_lowercase).collect();
        let report = &mut self.scene.report;
        let is_bool = matches!(
            plain.as_str(),
            "disablepixeljitter"
                | "disabletexturefiltering"
                | "disablewavelengthjitter"
                | "forcediffuse"
                | "pixelstats"
                | "wavefront"
        );
        match plain.as_str() {
            "seed" => match value.parse() {
                Ok(seed) => self.globals.seed = Some(seed),
                Err(_) => report.error(value_span, format!("expected an integer, found '{value}'")),
            },
            _ if is_bool && value != "true" && value != "false" => {
                report.error(value_span, format!("expected true or false, found '{value}'"));
            }
            "disablepixeljitter" | "disabletexturefiltering" | "disablewavelengthjitter" | "forcediffuse" => {
                if value == "true" {
                    report.approximated(span, format!("option '{name}' has no effect"));
                }
            }
            "displacementedgescale" => match value.parse::<f64>() {
                Ok(scale) if scale > 0.0 && scale.is_finite() => self.scene.edge_scale = scale,
                _ => report.error(value_span, format!("expected a number above 0, found '{value}'")),
            },
            "pixelstats" | "wavefront" | "rendercoordsys" | "msereferenceimage" | "msereferenceout" => {
                report.no_effect(span, &format!("option '{name}'"), "it does not change the picture");
            }
            _ => {
                let help = names::did_you_mean(&plain, KNOWN);
                report.error_help(span, format!("unknown option '{name}'"), help);
            }
        }
        Ok(())
    }
}
