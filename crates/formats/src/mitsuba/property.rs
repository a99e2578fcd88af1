//! Elements that set a property of the object they stand in.

use super::{
    graph::{ObjectId, Prop, Raw},
    parse::{Attributes, File, Parser, tag_span},
    transform, values,
};
use crate::{Limits, files};
use roxmltree::Node;
use steradian_math::Transform;
use steradian_scene::{SpectrumValue, names};

/// All elements that can stand inside an object, for "did you mean".
const TAGS: [&str; 27] = [
    "alias",
    "boolean",
    "bsdf",
    "default",
    "emitter",
    "film",
    "float",
    "include",
    "integer",
    "integrator",
    "medium",
    "path",
    "phase",
    "point",
    "ref",
    "rfilter",
    "rgb",
    "sampler",
    "sensor",
    "shape",
    "spectrum",
    "string",
    "texture",
    "transform",
    "vector",
    "volume",
    "scene",
];

/// Largest spectrum file, in bytes.
const SPECTRUM_BYTES: u64 = 64 << 20;

impl Parser<'_> {
    /// Sets the property that an element states.
    pub fn property(&mut self, node: Node<'_, '_>, parent: ObjectId, file: &File, attributes: &Attributes<'_>) {
        let tag = node.tag_name().name();
        let Some(value) = self.value(tag, node, file, attributes) else { return };
        let span =
            attributes.get("name").or(attributes.get("id")).map_or_else(|| tag_span(node, file), |a| a.value_span);
        let stated = ["value", "filename", "id"].iter().find_map(|n| attributes.get(n));
        let value_span = stated.map_or(span, |a| a.value_span);
        let name = attributes.text("name").unwrap_or_default().to_owned();
        if name.is_empty() && !matches!(value, Raw::Ref(_)) {
            return self.error(span, format!("<{tag}> needs a name"));
        }
        self.set(parent, Prop { name, value, span, value_span, used: false });
    }

    /// The value that an element states, or `None` after an error.
    fn value(&mut self, tag: &str, node: Node<'_, '_>, file: &File, attributes: &Attributes<'_>) -> Option<Raw> {
        let (known, needed): (&[&str], &[&str]) = match tag {
            "float" | "integer" | "boolean" | "string" => (&["name", "value"], &["name", "value"]),
            "rgb" | "srgb" => (&["name", "value", "intent"], &["name", "value"]),
            "point" | "vector" if attributes.get("value").is_some() => (&["name", "value", "x", "y", "z"], &["name"]),
            "point" | "vector" if file.legacy => (&["name", "x", "y", "z"], &["name"]),
            "point" | "vector" => (&["name", "x", "y", "z"], &["name", "x", "y", "z"]),
            "spectrum" => (&["name", "value", "filename", "intent"], &["name"]),
            "blackbody" if file.legacy => (&["name", "temperature", "scale"], &["name", "temperature"]),
            "transform" => (&["name"], &["name"]),
            "ref" => (&["name", "id"], &["id"]),
            _ => {
                self.unknown_element(tag, node, file);
                return None;
            }
        };
        if !self.check(node, file, attributes, known, needed) {
            return None;
        }
        if tag == "transform" {
            return Some(Raw::Transform(self.transform(node, file)));
        }
        self.simple_value(tag, file, attributes)
            .map_err(|message| {
                let at = ["value", "filename", "x", "y", "z", "temperature"].iter().find_map(|n| attributes.get(n));
                let span = at.map_or_else(|| tag_span(node, file), |a| a.value_span);
                let name = attributes.text("name").unwrap_or_default();
                self.error(span, format!("'{name}': {message}"));
            })
            .ok()
    }

    /// The value that attributes alone state, or what is wrong with them.
    fn simple_value(&mut self, tag: &str, file: &File, attributes: &Attributes<'_>) -> Result<Raw, String> {
        let text = attributes.text("value").unwrap_or_default();
        Ok(match tag {
            "float" => Raw::Float(values::number(text)?),
            "integer" => Raw::Int(values::integer(text)?),
            "boolean" => Raw::Bool(values::boolean(text)?),
            "rgb" => Raw::Rgb(values::rgb(text)?),
            "srgb" => Raw::Rgb(values::rgb(text)?.map(values::srgb_to_linear)),
            "point" | "vector" => Raw::Vec3(transform::vector(attributes, 0.0)?),
            "ref" => Raw::Ref(attributes.text("id").unwrap_or_default().to_owned()),
            "spectrum" => Raw::Spectrum(match (attributes.get("value"), attributes.text("filename")) {
                (Some(value), None) => values::spectrum(&value.value, file.legacy)?,
                (None, Some(name)) => self.spectrum_file(name)?,
                _ => return Err("<spectrum> needs either 'value' or 'filename'".into()),
            }),
            "blackbody" => {
                let temperature = attributes.text("temperature").unwrap_or_default();
                let temperature = values::number(temperature.trim().trim_end_matches(['K', 'k']))?;
                let scale = attributes.text("scale").map_or(Ok(1.0), values::number)?;
                Raw::Spectrum(values::blackbody(temperature, [360.0, 830.0], scale)?)
            }
            _ => Raw::String(text.to_owned()),
        })
    }

    fn unknown_element(&mut self, tag: &str, node: Node<'_, '_>, file: &File) {
        let (message, help) = if transform::OPERATIONS.contains(&tag) {
            (format!("<{tag}> belongs inside a <transform>"), None)
        } else {
            (format!("unknown element <{tag}>"), names::did_you_mean(tag, TAGS))
        };
        self.diagnostics.error_help(&self.sources, Some(tag_span(node, file)), message, help);
    }

    /// Composes the operations inside a `<transform>`: each is applied after those before it.
    fn transform(&mut self, node: Node<'_, '_>, file: &File) -> Transform {
        let mut composed = Transform::IDENTITY;
        for child in node.children().filter(|c| c.is_element()) {
            let attributes = self.attributes(child, file);
            if attributes.broken {
                continue;
            }
            let tag = child.tag_name().name();
            match transform::operation(tag, &attributes, file.legacy) {
                Ok(t) => {
                    if transform::stretches(tag, &attributes, file.legacy) {
                        let what = "the axis of this <rotate> is not of unit length: as in Mitsuba 3, it stretches too";
                        self.diagnostics.warn(&self.sources, Some(tag_span(child, file)), what);
                    }
                    composed = t * composed;
                }
                Err((span, message)) => self.error(span.unwrap_or_else(|| tag_span(child, file)), message),
            }
        }
        composed
    }

    fn spectrum_file(&mut self, name: &str) -> Result<SpectrumValue, String> {
        let path = self.search.find(name).map_err(|e| e.to_string())?;
        let limits = &self.options.limits;
        let limits = Limits { file_bytes: limits.file_bytes.min(SPECTRUM_BYTES), ..limits.clone() };
        let bytes = files::read(&path, &limits).map_err(|e| e.to_string())?;
        self.sources.note(&path);
        values::spectrum_file(&String::from_utf8_lossy(&bytes)).map_err(|e| format!("'{}', {e}", path.display()))
    }
}
