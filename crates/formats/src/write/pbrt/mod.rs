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
        motion: None,
    };
    writer.scene();
    match writer.x.beside.fault.take() {
        Some(fault) => Err(fault),
        None => Ok(Written {
            bytes: writer.out.into_bytes(),
            files: writer.x.beside.take_files(),
            diagnostics: writer.x.diagnostics,
        }),
    }
}

struct Writer<'a> {
    x: Exchange<'a>,
    out: String,
    /// Indentation depth.
    depth: usize,
    materials: HashMap<NodeId, String>,
    /// Names of textures by what they are and how they are used.
    textures: HashMap<String, String>,
    media: HashMap<NodeId, String>,
    meshes: HashMap<String, String>,
    open: HashSet<NodeId>,
    /// True if there are participating media.
    passes: bool,
    /// When what moves begins and ends to do so.
    motion: Option<[f64; 2]>,
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
        self.motion = self.x.motion_times();
        if let Some([begin, end]) = self.motion {
            self.line(&format!("TransformTimes {begin} {end}"));
        } else {
            self.x.stands_still("an exposure without length");
        }
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
            self.moving_transform(&instance.world_from_group, instance.movement.map(|m| m.end).as_ref());
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

    /// Sets the transforms at both ends of a motion, where there is one.
    fn moving_transform(&mut self, start: &Transform, end: Option<&Transform>) {
        match end.filter(|_| self.motion.is_some()) {
            None => self.transform(start),
            Some(end) => {
                for (which, transform) in [("StartTime", start), ("EndTime", end)] {
                    self.line(&format!("ActiveTransform {which}"));
                    self.transform(transform);
                }
                self.line("ActiveTransform All");
            }
        }
    }

    /// Sets the current transform; the numbers column by column.
    fn transform(&mut self, t: &Transform) {
        let numbers = t.matrix.to_cols_array().map(text::number).join(" ");
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
