//! Shapes, groups and instances.

use super::{Element, Role, Writer, matrix, triple};
use crate::{
    mesh::ply,
    mitsuba::solids,
    write::{
        exchange::Source,
        solid::{self, Quadric, similarity},
        surface,
    },
};
use std::fmt::Write;
use steradian_math::{DVec3, Transform};
use steradian_scene::{Family, Group, Instance, Mesh, Node, Shape};

impl Writer<'_> {
    /// Notes how far things reach, and whether light passes some of them.
    pub(super) fn look_around(&mut self) {
        let desc = self.x.desc;
        for shape in &desc.shapes {
            let t = &shape.world_from_object;
            let mut reach = |p: DVec3| self.reach = self.reach.max(t.point(p).length());
            if let Some(mesh) = shape.mesh.and_then(|m| desc.meshes.get(m)) {
                mesh.positions.iter().for_each(|p| reach(DVec3::from(p.map(f64::from))));
            } else {
                let r = desc.node(shape.node).float("radius").unwrap_or(1.0);
                reach(DVec3::splat(r));
                reach(DVec3::splat(-r));
            }
        }
        let passes = |n: &Node| n.family == Family::Material && matches!(n.kind.as_str(), "mask" | "interface");
        let shapes = || desc.shapes.iter().chain(desc.groups.iter().flat_map(|g| &g.shapes));
        self.passes = desc.nodes.iter().any(passes)
            || shapes().any(|s| s.is_medium_boundary || desc.node(s.node).get("alpha").is_some());
    }

    pub(super) fn group(&mut self, index: usize, group: &Group) {
        let shapes: Vec<Element> = group.shapes.iter().filter_map(|s| self.shape(s, true)).collect();
        let mut out = Element::plugin("shape", "shapegroup").with("id", format!("group{index}"));
        shapes.into_iter().for_each(|s| out.push(s));
        self.scene.push(out);
    }

    pub(super) fn instance(&mut self, instance: &Instance) {
        if self.x.desc.groups.get(instance.group).is_none_or(|g| g.shapes.is_empty()) {
            return;
        }
        let mut out = Element::plugin("shape", "instance");
        out.push(Element::new("ref").with("id", format!("group{}", instance.group)));
        out.push(matrix("to_world", &instance.world_from_group));
        self.scene.push(out);
    }

    /// A shape with what is attached to it; what it refers to is in the document before.
    pub(super) fn shape(&mut self, shape: &Shape, in_group: bool) -> Option<Element> {
        let node = self.x.node(shape.node);
        let mut out = self.geometry(shape, node)?;
        self.no_texture = node.kind == "disk" && self.is_plugin(&out, "disk");
        let mut bsdf = match shape.material {
            Some(id) => Element::new("ref").with("id", self.material(id)),
            None => {
                let grey = Element::plugin("bsdf", "diffuse");
                if self.is_one_sided() { grey } else { Element::plugin("bsdf", "twosided").child(grey) }
            }
        };
        self.no_texture = false;
        if let Some(alpha) = self.x.source(node, "alpha")
            && !matches!(&alpha, Source::Plain(c) if c.mean() >= 1.0)
        {
            let mut mask = Element::plugin("bsdf", "mask");
            self.put(&mut mask, "opacity", &alpha, Role::Scalar);
            bsdf = mask.child(bsdf);
        }
        out.push(bsdf);
        if let Some(light) = shape.emission {
            if in_group {
                let light = self.x.node(light);
                self.x.dropped(light, "what is instanced cannot emit in Mitsuba; the emission is left out");
            } else {
                let area = self.area(shape, node);
                if let Some(light) = self.area_light(light, area) {
                    out.push(light);
                }
            }
        }
        for (side, medium) in [("interior", shape.interior), ("exterior", shape.exterior)] {
            if let Some(id) = medium.and_then(|m| self.medium(m)) {
                out.push(Element::new("ref").named(side).with("id", id));
            }
        }
        Some(out)
    }

    fn is_plugin(&self, element: &Element, plugin: &str) -> bool {
        element.attribute("type") == Some(plugin)
    }

    /// The area in the world of what emits.
    fn area(&self, shape: &Shape, node: &Node) -> f64 {
        let t = &shape.world_from_object;
        if let Some(mesh) = shape.mesh.and_then(|m| self.x.desc.meshes.get(m)) {
            return surface::area(mesh, t);
        }
        match Quadric::of(node) {
            Some((q, moved)) => match similarity(t) {
                Some(s) => q.area() * s * s,
                None => surface::area(&q.mesh(), &(*t * moved)),
            },
            None => 1.0,
        }
    }

    fn geometry(&mut self, shape: &Shape, node: &Node) -> Option<Element> {
        let world = &shape.world_from_object;
        match node.kind.as_str() {
            "mesh" | "loop_subdivision" => {
                let mesh = shape.mesh.and_then(|m| self.x.desc.meshes.get(m))?;
                if node.kind == "loop_subdivision" {
                    self.x.approximated(node, "Mitsuba subdivides no surfaces; the coarse mesh stands for it");
                }
                self.x.without(node, &["displacement"]);
                if node.string("tangents").is_some_and(|t| t != "uv") || !mesh.tangents.is_empty() {
                    self.x.approximated(node, "tangents follow the texture coordinates");
                }
                if surface::has_curved_patches(mesh) {
                    self.x.approximated(node, "bilinear patches become two triangles each");
                }
                let flat = node.bool("flat").unwrap_or(false);
                let key = format!("{:?} {flat} {}", shape.mesh, shape.reverse_orientation);
                self.mesh(node, mesh, world, shape.reverse_orientation, flat, key)
            }
            "sphere" | "disk" | "cylinder" => self.quadric(shape, node),
            "plane" => {
                self.x.approximated(node, "an infinite plane becomes a large square");
                let mesh = solid::plane(node)?;
                self.mesh(node, &mesh, world, shape.reverse_orientation, false, format!("{node:?}"))
            }
            "curve" => self.curve(shape, node),
            "bezier_patch" => {
                self.x.approximated(node, "Bézier patches become triangles");
                let mesh = solid::bezier(node)?;
                self.mesh(node, &mesh, world, shape.reverse_orientation, false, format!("{node:?}"))
            }
            "sdf_grid" => {
                let mut out = Element::plugin("shape", "sdfgrid");
                let file = self.x.beside.path(node.path("file")?);
                out.string("filename", &file);
                out.string("normals", node.string("normals").unwrap_or("smooth"));
                out.push(matrix("to_world", world));
                Some(out)
            }
            "height_field" => {
                let mesh = solid::height_field(node);
                match mesh {
                    Some(mesh) => self.mesh(node, &mesh, world, shape.reverse_orientation, false, format!("{node:?}")),
                    None => {
                        self.x.dropped(
                            node,
                            "a height field by a picture or texture cannot be expressed and is left out",
                        );
                        None
                    }
                }
            }
            other => {
                self.x.dropped(node, format!("shape '{other}' cannot be expressed and is left out"));
                None
            }
        }
    }

    fn mesh(
        &mut self,
        node: &Node,
        mesh: &Mesh,
        world: &Transform,
        reverse: bool,
        flat: bool,
        key: String,
    ) -> Option<Element> {
        if !world.swaps_handedness() && !reverse && !flat {
            for (plugin, solid) in [("rectangle", solids::rectangle()), ("cube", solids::cube())] {
                if *mesh == solid {
                    let mut out = self.plugin(plugin, node);
                    out.push(matrix("to_world", world));
                    return Some(out);
                }
            }
        }
        let key = if world.swaps_handedness() { format!("{key} {:?}", world.matrix) } else { key };
        let (oriented, world) = surface::oriented(mesh, world, reverse, flat);
        let file = match self.meshes.get(&key) {
            Some(known) => known.clone(),
            None => {
                let name = self.x.beside.add("meshes", "mesh.ply", ply::encode(&oriented));
                self.meshes.insert(key, name.clone());
                name
            }
        };
        let mut out = self.plugin("ply", node);
        out.string("filename", &file);
        if oriented.normals.is_empty() {
            out.boolean("face_normals", true);
        }
        if world != Transform::IDENTITY {
            out.push(matrix("to_world", &world));
        }
        Some(out)
    }

    fn plugin(&mut self, plugin: &str, node: &Node) -> Element {
        let out = Element::plugin("shape", plugin);
        match &node.name {
            Some(name) => out.with("id", self.x.name(Some(name), plugin)),
            None => out,
        }
    }

    fn quadric(&mut self, shape: &Shape, node: &Node) -> Option<Element> {
        let (quadric, moved) = Quadric::of(node)?;
        let world = shape.world_from_object * moved;
        let is_disk = matches!(quadric, Quadric::Disk { .. });
        if !quadric.is_whole() || (!is_disk && similarity(&world).is_none()) {
            self.x.approximated(node, format!("a '{}' that is cut or scaled unevenly becomes triangles", node.kind));
            return self.mesh(node, &quadric.mesh(), &world, shape.reverse_orientation, false, format!("{node:?}"));
        }
        let mut out = self.plugin(&node.kind, node);
        let (to_world, flip) = match quadric {
            Quadric::Sphere { radius, .. } => {
                out.float("radius", radius);
                // v runs the other way: the reader mirrors z.
                let to_world = world * Transform::scale(DVec3::new(1.0, 1.0, -1.0));
                (to_world, shape.reverse_orientation != to_world.swaps_handedness())
            }
            Quadric::Cylinder { radius, z, .. } => {
                out.float("radius", radius);
                for (name, z) in [("p0", z[0]), ("p1", z[1])] {
                    out.push(Element::new("point").named(name).with("value", triple([0.0, 0.0, z])));
                }
                (world, shape.reverse_orientation)
            }
            Quadric::Disk { radius, height, .. } => {
                let size = Transform::scale(DVec3::new(radius, radius, 1.0));
                (world * Transform::translate(DVec3::new(0.0, 0.0, height)) * size, shape.reverse_orientation)
            }
        };
        if flip {
            out.boolean("flip_normals", true);
        }
        out.push(matrix("to_world", &to_world));
        Some(out)
    }

    /// A curve as a tube of B-splines.
    fn curve(&mut self, shape: &Shape, node: &Node) -> Option<Element> {
        let Some(splines) = solid::splines(node) else {
            self.x.dropped(node, "a quadratic B-spline curve cannot be expressed and is left out");
            return None;
        };
        if !matches!(node.string("type"), Some("cylinder" | "round")) {
            self.x.approximated(node, "curves are tubes in Mitsuba, not flat or ribbons");
        }
        let mut text = String::new();
        for spline in &splines {
            for [x, y, z, r] in &spline.points {
                let _ = writeln!(text, "{x} {y} {z} {r}");
            }
            text.push('\n');
        }
        let file = self.x.beside.add("meshes", "curve.txt", text.into_bytes());
        let mut out = self.plugin("bsplinecurve", node);
        out.string("filename", &file);
        out.push(matrix("to_world", &shape.world_from_object));
        Some(out)
    }
}
