//! Shapes, groups and instances.

use super::{
    graph::{Category, ObjectId},
    meshes::{MeshFormat, MeshKey},
    normals,
    reader::Reader,
    solids,
    texture::{Role, rgb},
    told::NOISE,
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Family, Group, Instance, Mesh, Node, NodeId, Shape};

/// The geometry of a shape before anything is attached to it.
struct Geometry {
    node: Node,
    mesh: Option<usize>,
    world_from_object: Transform,
    reverse_orientation: bool,
}

impl Reader<'_> {
    /// A shape of the scene: placed itself, or as an instance.
    pub fn scene_shape(&mut self, object: ObjectId) {
        match self.plugin(object) {
            // A group is only seen through its instances.
            "shapegroup" => {
                self.group(object);
            }
            "instance" => self.instance(object),
            _ => {
                let shapes = self.shapes(object);
                self.desc.shapes.extend(shapes);
            }
        }
    }

    /// The shapes that an object stands for: several where it merges others, none after an error.
    fn shapes(&mut self, object: ObjectId) -> Vec<Shape> {
        self.graph.objects[object].visited = true;
        if self.plugin(object) != "merge" {
            self.on_disk = self.plugin(object) == "disk";
            let shape = self.shape(object);
            self.on_disk = false;
            let more = std::mem::take(&mut self.more_curves);
            let more: Vec<Shape> =
                more.into_iter().flat_map(|node| shape.clone().map(|s| Shape { node, ..s })).collect();
            return shape.into_iter().chain(more).collect();
        }
        // Merged shapes that merge each other in turn would double at every step.
        if !self.merged.insert(object) {
            self.error(self.span(object), "a merged shape can be used once");
            return Vec::new();
        }
        if !self.enter(object) {
            return Vec::new();
        }
        let mut shapes = Vec::new();
        for (_, child) in self.graph.children(object, Category::Shape) {
            match self.plugin(child) {
                "instance" | "shapegroup" => {
                    self.error(self.span(child), "groups and instances cannot be merged");
                }
                _ => shapes.extend(self.shapes(child)),
            }
            if self.diagnostics.is_full() {
                break;
            }
        }
        self.leave();
        shapes
    }

    /// The index of a group.
    fn group(&mut self, object: ObjectId) -> usize {
        if let Some(&index) = self.groups.get(&object) {
            return index;
        }
        self.graph.objects[object].visited = true;
        let index = self.desc.groups.len();
        self.groups.insert(object, index);
        let name = self.graph.objects[object].id.clone().unwrap_or_default();
        self.desc.groups.push(Group { name, shapes: Vec::new() });
        let mut shapes = Vec::new();
        for (_, child) in self.graph.children(object, Category::Shape) {
            if ["shapegroup", "instance"].contains(&self.plugin(child)) {
                self.error(self.span(child), "a shape group cannot hold groups or instances");
                continue;
            }
            shapes.extend(self.shapes(child));
        }
        self.left_out(object, "to_world", &[], "its instances place a shape group");
        self.desc.groups[index].shapes = shapes;
        index
    }

    fn instance(&mut self, object: ObjectId) {
        let span = self.span(object);
        let world_from_group = self.transform(object, "to_world");
        let children = self.graph.children(object, Category::Shape);
        let [(_, child)] = children[..] else {
            return self.error(span, "an instance needs one shape group");
        };
        if self.plugin(child) != "shapegroup" {
            let message = format!("an instance places a shape group, not a '{}'", self.plugin(child));
            return self.error(span, message);
        }
        if self.desc.instances.len() >= self.options.limits.instances {
            return self.error(span, format!("more than {} instances", self.options.limits.instances));
        }
        let group = self.group(child);
        self.desc.instances.push(Instance { span: Some(span), ..Instance::new(group, world_from_group) });
    }

    fn shape(&mut self, object: ObjectId) -> Option<Shape> {
        let geometry = self.geometry(object);
        let emitters = self.graph.children(object, Category::Emitter);
        let emission = emitters.first().and_then(|&(_, e)| self.surface_emitter(e));
        let material = self.surface(object, !emitters.is_empty());
        let media = self.graph.children(object, Category::Medium);
        let mut side = |name: &str| {
            let (_, medium) = media.iter().find(|(n, _)| n == name)?;
            self.medium(*medium)
        };
        let (interior, exterior) = (side("interior"), side("exterior"));
        for (name, medium) in &media {
            if name != "interior" && name != "exterior" {
                self.error(self.span(*medium), "a medium on a shape is named 'interior' or 'exterior'");
            }
        }
        if let Some((_, second)) = emitters.get(1) {
            self.error(self.span(*second), "a shape has one emitter");
        }
        for (_, sensor) in self.graph.children(object, Category::Sensor) {
            match self.plugin(sensor) {
                "irradiancemeter" => self.irradiance_meter(sensor, object),
                _ => self.dropped(self.span(sensor), "a sensor on a shape is left out"),
            }
        }
        self.no_effect(object, &["silhouette_sampling_weight"], NOISE);
        let geometry = geometry?;
        let node = self.desc.add(geometry.node);
        Some(Shape {
            node,
            mesh: geometry.mesh,
            world_from_object: geometry.world_from_object,
            reverse_orientation: geometry.reverse_orientation,
            material,
            emission,
            is_medium_boundary: !media.is_empty(),
            interior,
            exterior,
        })
    }

    /// The material: what the file nests, else grey, or black where the shape emits.
    fn surface(&mut self, object: ObjectId, emits: bool) -> Option<NodeId> {
        let bsdfs = self.graph.children(object, Category::Bsdf);
        if let Some((_, second)) = bsdfs.get(1) {
            self.error(self.span(*second), "a shape has one BSDF");
        }
        match bsdfs.first() {
            Some(&(_, bsdf)) => self.material(bsdf),
            None => {
                let reflectance = if emits { 0.0 } else { 0.5 };
                Some(
                    self.desc
                        .add(Node::new(Family::Material, "diffuse", None).with("reflectance", rgb([reflectance; 3]))),
                )
            }
        }
    }

    fn geometry(&mut self, object: ObjectId) -> Option<Geometry> {
        let world_from_object = self.transform(object, "to_world");
        let node = self.node(Family::Shape, "mesh", object);
        match self.plugin(object).to_owned().as_str() {
            "obj" => self.mesh_file(object, node, MeshFormat::Obj, world_from_object),
            "ply" => self.mesh_file(object, node, MeshFormat::Ply, world_from_object),
            "serialized" => {
                let index = self.int(object, "shape_index").unwrap_or(0);
                let Ok(index) = usize::try_from(index) else {
                    self.error(self.value_span(object, "shape_index"), "'shape_index' cannot be negative");
                    return None;
                };
                self.mesh_file(object, node, MeshFormat::Serialized(index), world_from_object)
            }
            "rectangle" => Some(self.solid(object, node, solids::rectangle(), world_from_object)),
            "cube" => Some(self.solid(object, node, solids::cube(), world_from_object)),
            "sphere" => self.sphere(object, world_from_object),
            "disk" => {
                let mut node = self.node(Family::Shape, "disk", object);
                node.set("radius", 1.0, None).set("height", 0.0, None);
                let reverse_orientation = self.bool(object, "flip_normals").unwrap_or(false);
                Some(Geometry { node, mesh: None, world_from_object, reverse_orientation })
            }
            "cylinder" => self.cylinder(object, world_from_object),
            "heightfield" => self.height_field(object, world_from_object),
            "sdfgrid" => self.sdf_grid(object, world_from_object),
            "bsplinecurve" => {
                let mut nodes = self.curves(object)?.into_iter();
                let node = nodes.next()?;
                self.more_curves = nodes.map(|node| self.desc.add(node)).collect();
                Some(Geometry { node, mesh: None, world_from_object, reverse_orientation: false })
            }
            known if self.is_known(object) => {
                self.error(self.span(object), format!("there is no shape '{known}'"));
                self.graph.objects[object].props.iter_mut().for_each(|p| p.used = true);
                None
            }
            _ => {
                self.unknown_plugin(object);
                None
            }
        }
    }

    fn mesh_file(
        &mut self,
        object: ObjectId,
        node: Node,
        format: MeshFormat,
        world_from_object: Transform,
    ) -> Option<Geometry> {
        let path = self.needed_file(object, "filename");
        let face_normals = self.bool(object, "face_normals");
        let flip_normals = self.bool(object, "flip_normals").unwrap_or(false);
        // Mitsuba turns the texture coordinates of OBJ files over unless told not to.
        let flip_uvs = self.bool(object, "flip_tex_coords").unwrap_or(format == MeshFormat::Obj);
        if let Some(prop) = self.graph.take(object, "max_smooth_angle") {
            self.dropped(prop.span, "'max_smooth_angle' is left out: normals are smooth everywhere or nowhere");
        }
        match format {
            MeshFormat::Obj => {
                self.left_out(object, "load_materials", &["false"], "materials are those of the scene");
                self.no_effect(object, &["collapse"], "all parts of a file are one shape");
            }
            MeshFormat::Ply => {
                self.left_out(object, "srgb", &["false"], "colours of vertices are taken as linear");
            }
            MeshFormat::Serialized(_) => {}
        }
        let mut key = MeshKey::new(format, path?, &world_from_object);
        (key.face_normals, key.flip_uvs, key.flip_normals) = (face_normals, flip_uvs, flip_normals);
        let mesh = self.queue_mesh(key, self.value_span(object, "filename"));
        Some(Geometry { node, mesh: Some(mesh), world_from_object, reverse_orientation: false })
    }

    fn solid(&mut self, object: ObjectId, node: Node, mut mesh: Mesh, world_from_object: Transform) -> Geometry {
        if self.bool(object, "face_normals").unwrap_or(false) {
            mesh.normals.clear();
        }
        if self.bool(object, "flip_normals").unwrap_or(false) {
            normals::flip(&mut mesh);
        }
        let mesh = Some(self.desc.add_mesh(mesh));
        Geometry { node, mesh, world_from_object, reverse_orientation: false }
    }

    /// Mitsuba's v runs from the pole at +z, Steradian's to it: the sphere is mirrored in z, which keeps u.
    fn sphere(&mut self, object: ObjectId, to_world: Transform) -> Option<Geometry> {
        let node = self.node(Family::Shape, "sphere", object);
        let center = self.vec3(object, "center").unwrap_or([0.0; 3]);
        let (radius, span) = (self.float(object, "radius").unwrap_or(1.0), self.value_span(object, "radius"));
        let flip = self.bool(object, "flip_normals").unwrap_or(false);
        if radius <= 0.0 {
            self.error(span, "the radius must be above zero");
            return None;
        }
        self.uneven(object, &to_world);
        let world_from_object =
            to_world * Transform::translate(center.into()) * Transform::scale(DVec3::new(1.0, 1.0, -1.0));
        Some(Geometry {
            node: node.with("radius", radius),
            mesh: None,
            world_from_object,
            // A mirrored sphere faces inwards in Mitsuba.
            reverse_orientation: flip != to_world.swaps_handedness(),
        })
    }

    /// Says so where a round shape is not placed by a similarity, which Mitsuba warns of and then takes for one.
    fn uneven(&mut self, object: ObjectId, to_world: &Transform) {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_world.vector(axis));
        let longest = x.length().max(y.length()).max(z.length());
        let shortest = x.length().min(y.length()).min(z.length());
        let skewed = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs()) > 1e-3 * longest * longest;
        if skewed || shortest < longest * (1.0 - 1e-3) {
            let message =
                format!("Mitsuba scales a '{}' evenly only; it is drawn as its transform says", self.plugin(object));
            self.note(self.value_span(object, "to_world"), message);
        }
    }

    /// Mitsuba 0.6's: a picture's heights over [-1, 1]².
    fn height_field(&mut self, object: ObjectId, to_world: Transform) -> Option<Geometry> {
        let mut node = self.node(Family::Shape, "height_field", object);
        let nested = self.graph.children(object, Category::Texture).first().map(|&(_, texture)| texture);
        match nested {
            Some(texture) => {
                let heights = self.texture(texture, Role::Scalar)?;
                node.set("heights", heights, None);
                for (from, to) in [("width", "nu"), ("height", "nv")] {
                    if let Some(count) = self.int(object, from) {
                        node.set(to, count, Some(self.value_span(object, from)));
                    }
                }
            }
            None => {
                let span = self.value_span(object, "filename");
                node.set("file", self.needed_file(object, "filename")?, Some(span));
            }
        }
        node.set("scale", self.float(object, "scale").unwrap_or(1.0), None);
        node.set("smooth", self.bool(object, "shading_normals").unwrap_or(true), None);
        let square = Transform::translate(DVec3::new(-1.0, -1.0, 0.0)) * Transform::scale(DVec3::new(2.0, 2.0, 1.0));
        let reverse_orientation = self.bool(object, "flip_normals").unwrap_or(false);
        Some(Geometry { node, mesh: None, world_from_object: to_world * square, reverse_orientation })
    }

    /// Distances over the unit cube.
    fn sdf_grid(&mut self, object: ObjectId, world_from_object: Transform) -> Option<Geometry> {
        let mut node = self.node(Family::Shape, "sdf_grid", object);
        let normals = self.choice(object, "normals", &["smooth", "analytic"]);
        let span = self.value_span(object, "filename");
        node.set("file", self.needed_file(object, "filename")?, Some(span)).set("normals", normals, None);
        Some(Geometry { node, mesh: None, world_from_object, reverse_orientation: false })
    }

    fn cylinder(&mut self, object: ObjectId, to_world: Transform) -> Option<Geometry> {
        let node = self.node(Family::Shape, "cylinder", object);
        let p0 = DVec3::from(self.vec3(object, "p0").unwrap_or([0.0; 3]));
        let p1 = DVec3::from(self.vec3(object, "p1").unwrap_or([0.0, 0.0, 1.0]));
        let (radius, span) = (self.float(object, "radius").unwrap_or(1.0), self.value_span(object, "radius"));
        let flip = self.bool(object, "flip_normals").unwrap_or(false);
        if radius <= 0.0 {
            self.error(span, "the radius must be above zero");
            return None;
        }
        self.uneven(object, &to_world);
        let length = (p1 - p0).length();
        let Some(axis) = (p1 - p0).try_normalize() else {
            self.error(self.value_span(object, "p1"), "'p0' and 'p1' are the same point");
            return None;
        };
        let [s, t] = frame(axis);
        let from_axis = Transform::from_columns([
            s.x, s.y, s.z, 0.0, t.x, t.y, t.z, 0.0, axis.x, axis.y, axis.z, 0.0, p0.x, p0.y, p0.z, 1.0,
        ]);
        Some(Geometry {
            node: node.with("radius", radius).with("z_min", 0.0).with("z_max", length),
            mesh: None,
            world_from_object: to_world * from_axis,
            // A mirrored cylinder faces outwards in Mitsuba, unlike a sphere.
            reverse_orientation: flip,
        })
    }
}

/// Two directions at right angles to a unit vector and to each other, where Mitsuba starts to count u (Duff et al.,
/// Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017).
fn frame(n: DVec3) -> [DVec3; 2] {
    let sign = 1f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y)]
}
