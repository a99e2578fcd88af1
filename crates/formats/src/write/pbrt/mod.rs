//! pbrt-v4 scenes. What is written is for pbrt itself: no kind and no parameter that it does not have.

mod light;
mod material;
mod shape;
mod text;
mod texture;
mod view;

use super::{Written, exchange::Exchange};
use std::{
    collections::{HashMap, HashSet},
    path::Path,
};
use steradian_math::Transform;
use steradian_scene::{NodeId, SceneDesc, Value};
use text::Directive;

/// Writes a scene in the language of pbrt-v4.
pub(super) fn write(desc: &SceneDesc, path: &Path) -> Result<Written, String> {
    let mut writer = Writer {
        x: Exchange::new(desc, path),
        out: String::new(),
        depth: 0,
        materials: HashMap::new(),
        textures: HashMap::new(),
        media: HashMap::new(),
        meshes: HashMap::new(),
        open: HashSet::new(),
        passes: false,
    };
    writer.scene();
    match writer.x.beside.fault {
        Some(fault) => Err(fault),
        None => Ok(Written {
            bytes: writer.out.into_bytes(),
            files: writer.x.beside.files,
            diagnostics: writer.x.diagnostics,
        }),
    }
}

struct Writer<'a> {
    x: Exchange<'a>,
    out: String,
    /// Of indentation.
    depth: usize,
    materials: HashMap<NodeId, String>,
    /// Names of textures by what they are and how they are used.
    textures: HashMap<String, String>,
    media: HashMap<NodeId, String>,
    meshes: HashMap<String, String>,
    open: HashSet<NodeId>,
    /// Whether there are media.
    passes: bool,
}

impl Writer<'_> {
    fn scene(&mut self) {
        let desc = self.x.desc;
        let shapes = || desc.shapes.iter().chain(desc.groups.iter().flat_map(|g| &g.shapes));
        self.passes = shapes().any(|s| s.is_medium_boundary);
        self.integrator();
        self.sampler();
        self.filter();
        self.film();
        self.camera();
        self.line("\nWorldBegin\n");
        for &light in &desc.lights {
            self.light(light);
        }
        for (i, group) in desc.groups.iter().enumerate() {
            // Materials are the scene's, not the object's.
            group.shapes.iter().for_each(|s| self.attachments(s));
            self.line(&format!("ObjectBegin \"group{i}\""));
            self.depth += 1;
            group.shapes.iter().for_each(|s| self.shape(s, true));
            self.depth -= 1;
            self.line("ObjectEnd");
        }
        for shape in &desc.shapes {
            self.attachments(shape);
            self.shape(shape, false);
        }
        for instance in &desc.instances {
            self.line("AttributeBegin");
            self.depth += 1;
            self.transform(&instance.world_from_group);
            self.line(&format!("ObjectInstance \"group{}\"", instance.group));
            self.depth -= 1;
            self.line("AttributeEnd");
        }
    }

    fn line(&mut self, text: &str) {
        self.out.push_str(&"    ".repeat(self.depth));
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn put(&mut self, directive: &Directive) {
        let text = directive.text(self.depth);
        self.line(&text);
    }

    /// Sets the current transform; the numbers column by column.
    fn transform(&mut self, t: &Transform) {
        let numbers = t.matrix.to_cols_array().map(|v| v.to_string()).join(" ");
        self.line(&format!("Transform [ {numbers} ]"));
    }
}

/// A transform of a node, or none.
fn place(node: &steradian_scene::Node, name: &str) -> Transform {
    match node.get(name) {
        Some(Value::Transform(t)) => *t,
        _ => Transform::IDENTITY,
    }
}
