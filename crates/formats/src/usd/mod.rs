//! Universal Scene Description (OpenUSD, "USD Core Specification" 1.0): .usda, .usdc, .usdz and .usd.
//!
//! Layers of both encodings become one form (`layer`), which `stage` composes; the rest reads the composed prims by
//! schema: UsdGeom, UsdLux, UsdShade. Conventions: matrices act on row vectors, so that their rows are our columns;
//! cameras and lights look along their −z; v of pictures grows upwards. The stage's up axis becomes +y; its units stay.
//! Radiances are taken as they stand (nits).
//!
//! The scene is read as of one moment, `-D at=SECONDS` after the stage's start time code. What is not drawn is told by
//! schema and number.

mod archive;
mod binary;
mod camera;
mod curves;
mod layer;
mod lights;
mod look;
mod lz4;
mod materialx;
mod mesh;
mod mtlx;
mod nodes;
mod solids;
mod stage;
#[cfg(test)]
mod tests;
mod text;
mod texture;
mod value;
mod volume;
mod xform;

use crate::{Import, Options, files, mesh::model};
use stage::{Prim, Stage};
use std::{
    collections::{BTreeMap, HashMap},
    path::Path,
};
use steradian_math::{DMat4, DVec3};
use steradian_scene::{Animation, Format, Span};
use value::Value;

/// Opens a stage by its root layer or archive. What the file is decides, not what it is called.
pub fn import(path: &Path, options: &Options) -> Import {
    match files::read(path, &options.limits) {
        Ok(bytes) => import_bytes(path, bytes, options),
        Err(e) => {
            let mut import = Import::default();
            import.diagnostics.error(&import.desc.sources, None, e.to_string());
            import
        }
    }
}

/// Opens a stage in memory; the files that it names are beside `path`.
pub fn import_bytes(path: &Path, bytes: Vec<u8>, options: &Options) -> Import {
    let (stage, is_read) = Stage::open(path, bytes, options);
    let mut reader = Reader {
        stage,
        looks: HashMap::new(),
        meshes: HashMap::new(),
        drawn: Vec::new(),
        counts: BTreeMap::new(),
        bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
        uses_lights: false,
        prims: 0,
        instancers: 0,
        graph_nodes: 0,
    };
    reader.stage.import.desc.format = Format::Model;
    reader.stage.import.desc.path = Some(path.into());
    if is_read {
        reader.read();
    }
    reader.stage.import
}

/// True for the beginnings of such files; archives are told by their names.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(binary::MAGIC) || bytes.starts_with(b"#usda") || mtlx::looks_like(bytes)
}

/// Most materials of a document that are shown.
const MOST_BALLS: usize = 1000;

/// A stage on its way into a description.
struct Reader<'a> {
    stage: Stage<'a>,
    /// Materials by what they are made of.
    looks: HashMap<String, look::Look>,
    /// Meshes by what they are made of.
    meshes: HashMap<String, Vec<mesh::Part>>,
    /// Geometry to draw, until it is known how often.
    drawn: Vec<nodes::Drawn>,
    /// Repeated messages: how many, and the first place.
    counts: BTreeMap<Loss, (usize, Option<Span>, String)>,
    bounds: [DVec3; 2],
    uses_lights: bool,
    /// Prims that were walked.
    prims: usize,
    /// Instancers that are open.
    instancers: usize,
    /// Nodes of the graph that is being read.
    graph_nodes: usize,
}

/// A loss that many prims may share, told once.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Loss {
    /// Left out, with the reason.
    Dropped(String),
    Approximated(String),
}

impl Reader<'_> {
    fn read(&mut self) {
        let number = |value: Option<Value>| value.and_then(|v| v.number()).filter(|v| v.is_finite());
        let start = number(self.stage.head("startTimeCode"));
        let rate = number(self.stage.head("timeCodesPerSecond")).or_else(|| number(self.stage.head("framesPerSecond")));
        let rate = rate.filter(|r| *r > 0.0).unwrap_or(24.0);
        let Some(at) = self.moment() else { return };
        self.stage.time = start.unwrap_or(0.0) + at * rate;
        let up = self.stage.head("upAxis").and_then(|v| v.text().map(str::to_owned));
        let root = match up.as_deref() {
            // z to y, y to −z.
            Some("Z") => DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2),
            _ => DMat4::IDENTITY,
        };
        self.walk(root);
        self.show_materials();
        if self.stage.import.diagnostics.has_errors() {
            return;
        }
        self.place_drawn();
        self.tell_counts();
        self.tell_motion(start.unwrap_or(0.0), rate);
        let desc = &self.stage.import.desc;
        if desc.shapes.is_empty() && desc.instances.is_empty() {
            let what = match &desc.path {
                Some(path) => format!("the scene of '{}' has no surfaces", path.display()),
                None => "the scene has no surfaces".into(),
            };
            let import = &mut self.stage.import;
            import.diagnostics.warn(&import.desc.sources, None, what);
            self.bounds = [DVec3::NEG_ONE, DVec3::ONE];
        }
        model::stage::complete(&mut self.stage.import, self.stage.options, self.bounds, self.uses_lights, false);
    }

    /// Balls in a row for the materials of a MaterialX document, which has nothing else.
    fn show_materials(&mut self) {
        if !self.drawn.is_empty() {
            return;
        }
        let Some(materials) = self.stage.prim(mtlx::ROOT).filter(|_| self.stage.is_materialx()) else { return };
        for (k, name) in self.stage.children(&materials).into_iter().enumerate().take(MOST_BALLS) {
            let material = self.stage.child(&materials, &name);
            let look = self.look(&material, Some(&material.path), look::Channels::default());
            self.draw(nodes::Drawn {
                name,
                form: nodes::Form::Solid(solids::solid("sphere").with("radius", 1.0)),
                place: DMat4::from_translation(DVec3::new(2.5 * k as f64, 1.0, 0.0)),
                material: look.material,
                emission: look.emission,
            });
        }
    }

    /// Seconds after the start that the user asks for.
    fn moment(&mut self) -> Option<f64> {
        let Some(text) = self.stage.options.defines.get("at") else { return Some(0.0) };
        match text.parse::<f64>().ok().filter(|v| v.is_finite()) {
            Some(at) => Some(at),
            None => {
                self.stage.error(None, format!("'at' is a time in seconds, not '{text}'"));
                None
            }
        }
    }

    fn count(&mut self, loss: Loss, prim: &Prim, name: Option<&str>) {
        let entry = self.counts.entry(loss).or_insert_with(|| (0, self.stage.span(prim, name), prim.path.clone()));
        entry.0 += 1;
    }

    fn tell_counts(&mut self) {
        for (loss, (count, span, path)) in std::mem::take(&mut self.counts) {
            let all = if count > 1 { format!(" (and {} more)", count - 1) } else { String::new() };
            match loss {
                Loss::Dropped(what) => self.stage.dropped(span, format!("{path}{all}: {what}")),
                Loss::Approximated(what) => self.stage.approximated(span, format!("{path}{all}: {what}")),
            }
        }
    }

    fn tell_motion(&mut self, start: f64, rate: f64) {
        let (number, [low, high]) = self.stage.moving;
        if number == 0 || high <= low {
            return;
        }
        let times = [(low - start) / rate, (high - start) / rate];
        self.stage.import.desc.animations = vec![Animation { name: None, times, channels: number }];
        if !self.stage.options.defines.contains_key("at") {
            let what = format!(
                "the scene moves, and is read as of its start: -D at=SECONDS names another moment ({:.3} to {:.3})",
                times[0], times[1]
            );
            self.stage.note(None, what);
        }
    }

    // Attributes.

    fn number(&mut self, prim: &Prim, name: &str, default: f64, range: (f64, f64)) -> f64 {
        let Some(value) = self.stage.value(prim, name) else { return default };
        match value.number() {
            Some(v) if v >= range.0 && v <= range.1 => v,
            Some(v) => {
                self.fault(prim, name, format!("a number from {} to {} is expected, not {v}", range.0, range.1));
                default
            }
            None => {
                self.fault(prim, name, "a number is expected".into());
                default
            }
        }
    }

    fn tuple<const N: usize>(&mut self, prim: &Prim, name: &str, default: [f64; N]) -> [f64; N] {
        let Some(value) = self.stage.value(prim, name) else { return default };
        match value.tuple::<N>().filter(|t| t.iter().all(|v| v.is_finite())) {
            Some(tuple) => tuple,
            None => {
                self.fault(prim, name, format!("{N} finite numbers are expected"));
                default
            }
        }
    }

    fn flag(&mut self, prim: &Prim, name: &str, default: bool) -> bool {
        self.stage.value(prim, name).and_then(|v| v.bool()).unwrap_or(default)
    }

    fn word(&mut self, prim: &Prim, name: &str) -> Option<String> {
        self.stage.value(prim, name)?.text().map(str::to_owned)
    }

    /// An error about an attribute.
    fn fault(&mut self, prim: &Prim, name: &str, message: String) {
        let span = self.stage.span(prim, Some(name));
        self.stage.error(span, format!("{}.{name}: {message}", prim.path));
    }
}
