//! Mitsuba XML scene files: version 3 and 2, and 0.6 with its older names.
//!
//! Three steps. `parse` reads the file and what it includes into a graph of objects with typed properties, puts in
//! `$parameters`, and resolves references. The translators (one per family) turn objects into the nodes of a
//! [`SceneDesc`](steradian_scene::SceneDesc), Mitsuba's defaults written out. Last, mesh files are read in parallel.
//! Every step goes on after faults, and every message points at the text it is about.
//!
//! What Mitsuba means by a file is as Mitsuba 3 documents and does it (<https://mitsuba.readthedocs.io>).

mod curve;
mod directives;
mod graph;
mod hair;
mod integrator;
mod ior;
mod light;
mod material;
mod medium;
mod meshes;
mod meters;
mod normals;
mod parameters;
mod parse;
mod plugins;
mod polarizing;
mod property;
mod reader;
mod sensor;
mod shape;
mod sky;
pub(crate) mod solids;
mod spectrum;
mod texture;
mod told;
mod transform;
mod upgrade;
mod values;

#[cfg(test)]
mod tests;

use crate::{Import, Options};
use graph::{Category, Raw};
use parse::Parser;
use reader::Reader;
use std::path::Path;

/// Reads a Mitsuba scene with all it refers to. Faults are among the diagnostics; the description is complete where
/// there are no errors among them. Images are not read, but it is checked that they are there.
pub fn import(path: &Path, options: &Options) -> Import {
    let mut parser = Parser::new(path.parent().unwrap_or(Path::new("")).to_path_buf(), options);
    parser.main_file(path);
    translate(path, parser, options)
}

/// Reads a Mitsuba scene from its text. `path` is where the text comes from, for messages and for the files it refers
/// to.
pub fn import_text(text: &str, path: &Path, options: &Options) -> Import {
    import_bytes(text.as_bytes().to_vec(), path, options)
}

/// Reads a Mitsuba scene from bytes, which may not be text at all.
pub fn import_bytes(bytes: Vec<u8>, path: &Path, options: &Options) -> Import {
    let mut parser = Parser::new(path.parent().unwrap_or(Path::new("")).to_path_buf(), options);
    parser.main_text(path, bytes);
    translate(path, parser, options)
}

fn translate(path: &Path, parser: Parser<'_>, options: &Options) -> Import {
    let Parser { graph, sources, diagnostics, search, .. } = parser;
    let mut reader = Reader::new(graph, sources, diagnostics, search, options);
    reader.desc.path = Some(path.to_path_buf());
    if !reader.graph.objects.is_empty() {
        reader.scene();
        reader.read_meshes();
        reader.report_unknown();
        reader.report_unused();
    }
    Import { desc: reader.desc, diagnostics: reader.diagnostics }
}

impl Reader<'_> {
    /// Translates what stands directly in the scene. Other objects are translated where they are used.
    fn scene(&mut self) {
        let mut children = Vec::new();
        for prop in &mut self.graph.objects[0].props {
            if let Raw::Object(child) = prop.value {
                prop.used = true;
                children.push(child);
            }
        }
        self.graph.objects[0].visited = true;
        for child in children {
            if self.diagnostics.is_full() {
                return;
            }
            match self.graph.objects[child].category {
                Category::Shape => self.scene_shape(child),
                // An emitter for shapes that refer to it by its id.
                Category::Emitter if ["area", "directionalarea"].contains(&self.plugin(child)) => {}
                Category::Emitter => {
                    let light = self.emitter(child);
                    self.desc.lights.extend(light);
                }
                Category::Sensor => self.sensor(child),
                Category::Integrator if self.desc.integrator.is_some() => {
                    self.error(self.span(child), "a scene has one integrator");
                }
                Category::Integrator => self.desc.integrator = self.integrator(child),
                Category::Bsdf | Category::Texture | Category::Volume | Category::Medium | Category::Phase => {}
                category @ (Category::Film | Category::Sampler | Category::Filter | Category::Scene) => {
                    let message = format!("a {} does not stand directly in the scene; it is left out", category.noun());
                    self.dropped(self.span(child), message);
                }
            }
        }
        if self.desc.cameras.is_empty() {
            if !self.diagnostics.has_errors() {
                let scene = self.span(0);
                self.warn(scene, "the scene has no sensor");
            }
            self.default_recording();
        }
        self.default_integrator();
        self.passed_surfaces();
    }
}
