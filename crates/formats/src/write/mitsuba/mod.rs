//! Mitsuba 3 scenes. What is written is for Mitsuba itself: no plugin and no parameter that it does not have.

mod light;
mod material;
mod shape;
mod texture;
mod view;
mod xml;

use super::{
    Written,
    colour::Colour,
    exchange::{Exchange, Source},
};
use std::{
    collections::{HashMap, HashSet},
    path::Path,
};
use steradian_math::Transform;
use steradian_scene::{Format, NodeId, SceneDesc};
use xml::Element;

/// Role of a spectral parameter, which decides how Mitsuba reads numbers in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Reflectance,
    Unbounded,
    Emission,
    /// One number for each point.
    Scalar,
}

/// Writes a scene in the language of Mitsuba 3.
pub(super) fn write(desc: &SceneDesc, path: &Path) -> Result<Written, String> {
    let mut writer = Writer {
        x: Exchange::new(desc, path),
        materials: HashMap::new(),
        media: HashMap::new(),
        meshes: HashMap::new(),
        open: HashSet::new(),
        scene: Element::new("scene").with("version", "3.0.0"),
        passes: false,
        no_texture: false,
        reach: 0.0,
    };
    writer.scene();
    match writer.x.beside.fault.take() {
        Some(fault) => Err(fault),
        None => {
            let mut text = String::from("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n");
            writer.scene.write(&mut text, 0);
            Ok(Written {
                bytes: text.into_bytes(),
                files: writer.x.beside.take_files(),
                diagnostics: writer.x.diagnostics,
            })
        }
    }
}

struct Writer<'a> {
    x: Exchange<'a>,
    /// Ids of the materials and media that the document has.
    materials: HashMap<NodeId, String>,
    media: HashMap<NodeId, String>,
    /// Files of meshes, by mesh and what was done to it.
    meshes: HashMap<String, String>,
    /// Materials that are being written.
    open: HashSet<NodeId>,
    scene: Element,
    /// True if light passes some surfaces unscattered (masks, interfaces, opacity), or there are media.
    passes: bool,
    /// The shape whose material is written has other texture coordinates in Mitsuba.
    no_texture: bool,
    /// Largest distance of any geometry from the origin.
    reach: f64,
}

impl Writer<'_> {
    fn scene(&mut self) {
        let desc = self.x.desc;
        self.x.stands_still("Mitsuba");
        self.look_around();
        let head = std::mem::replace(&mut self.scene, Element::new("scene"));
        for (i, group) in desc.groups.iter().enumerate() {
            self.group(i, group);
        }
        for shape in &desc.shapes {
            if let Some(element) = self.shape(shape, false) {
                self.scene.push(element);
            }
        }
        for instance in &desc.instances {
            self.instance(instance);
        }
        for &light in &desc.lights {
            self.light(light);
        }
        let cameras: Vec<Element> = desc.cameras.iter().filter_map(|&c| self.camera(c)).collect();
        let integrator = self.integrator();
        // The sight first, as files written by hand have it; objects that refer to others after those.
        let body = std::mem::replace(&mut self.scene, head);
        self.scene.push(integrator);
        body.into_children().into_iter().chain(cameras).for_each(|e| self.scene.push(e));
    }

    /// True if surfaces are visible only from the side of their normals.
    fn is_one_sided(&self) -> bool {
        self.x.desc.format == Format::Mitsuba
    }
}

/// The 16 numbers of a transform, row by row.
fn matrix(name: &str, t: &Transform) -> Element {
    let rows = t.matrix.transpose().to_cols_array().map(|v| v.to_string()).join(" ");
    Element::new("transform").named(name).child(Element::new("matrix").with("value", rows))
}

fn triple(v: [f64; 3]) -> String {
    v.map(|v| v.to_string()).join(", ")
}

/// A constant in a role.
fn colour(name: &str, c: &Colour, role: Role) -> Element {
    match c {
        Colour::Grey(v) if role == Role::Emission => {
            // Three components would mean the illuminant D65.
            spectrum(name, &[360.0, 830.0], &[*v as f32; 2])
        }
        Colour::Grey(v) if role == Role::Scalar => Element::new("float").named(name).with("value", v.to_string()),
        Colour::Grey(v) => Element::new("spectrum").named(name).with("value", v.to_string()),
        _ if role == Role::Scalar => Element::new("float").named(name).with("value", c.mean().to_string()),
        Colour::Rgb(v) => Element::new("rgb").named(name).with("value", triple(*v)),
        Colour::Curve(l, v) => spectrum(name, l, v),
    }
}

fn spectrum(name: &str, lambdas: &[f32], values: &[f32]) -> Element {
    let pairs: Vec<String> = lambdas.iter().zip(values).map(|(l, v)| format!("{l}:{v}")).collect();
    Element::new("spectrum").named(name).with("value", pairs.join(", "))
}

impl Writer<'_> {
    /// Puts a parameter that may be textured into an object.
    fn put(&mut self, out: &mut Element, name: &str, source: &Source, role: Role) {
        self.put_scaled(out, name, source, role, 1.0);
    }

    fn put_scaled(&mut self, out: &mut Element, name: &str, source: &Source, role: Role, scale: f64) {
        let element = match source {
            Source::Plain(c) => colour(name, &c.scaled(scale), role),
            Source::Texture(id) => match self.texture(name, *id, role, scale) {
                Ok(element) => element,
                Err(stand_in) => colour(name, &stand_in.scaled(scale), role),
            },
        };
        out.push(element);
    }
}
