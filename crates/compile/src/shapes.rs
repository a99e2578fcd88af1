//! Compiling shapes: geometry placed in the space it is traced in, with material, emission and media.

use super::{
    Compiler, height_field,
    incremental::{KeptShape, Origin},
    schedule::Lamp,
};
use std::sync::Arc;
use steradian_accel::Geometry as AccelGeometry;
use steradian_core::{
    material::Needs,
    scene::{self, Geometry, Shape},
    shape::{
        self, Curves, PatchMesh, Quadric, QuadricKind, SdfGrid, TriMesh,
        curve::{CurveBasis, CurveKind, CurveParams},
        subdivision::loop_subdivide,
    },
};
use steradian_math::{Bounds3, DVec3, Transform, Vec3, spectra::ColorMode, transform::Affine};
use steradian_scene::{Mesh, Node};
use steradian_texture::FloatTexture;

/// For each geometry of a group the boxes of its user primitives; empty for meshes and planes.
pub(super) type Boxes = Vec<Vec<Bounds3>>;

/// A shape's parameters, how it lies in space, and whether it emits light.
pub(super) struct Placed<'a> {
    pub(super) node: &'a Node,
    pub(super) place: Affine,
    /// True if the transform swaps left and right.
    swaps: bool,
    /// True if normals are to point to the other side.
    pub(super) reverse: bool,
    pub(super) emits: bool,
}

impl Placed<'_> {
    /// A quadric at a place of its own, with its extent around the axis in degrees.
    fn quadric(&self, kind: QuadricKind, phi_max: f32, place: Affine) -> Vec<Shape> {
        vec![Shape::Quadric(Arc::new(Quadric { kind, phi_max: phi_max.to_radians(), place, flip: self.reverse }))]
    }
}

/// Input of the hierarchy, for `boxes.len()` geometries from `base` on.
pub(super) fn accel_geometries<'g>(
    geometries: &'g [Geometry],
    base: usize,
    boxes: &'g Boxes,
) -> Vec<AccelGeometry<'g>> {
    geometries[base..]
        .iter()
        .zip(boxes)
        .map(|(g, boxes)| {
            let shape = match &g.shape {
                Shape::Mesh(m) => AccelGeometry::triangles(&m.positions, &m.triangles),
                _ => AccelGeometry::boxes(boxes),
            };
            shape.filtered(g.is_masked() || g.is_interface)
        })
        .collect()
}

impl Compiler<'_> {
    /// Compiles a list of shapes to geometries; gives the boxes of each. `is_kept_square` says that right angles stay
    /// right where the shapes are placed.
    pub(super) fn shapes(&mut self, shapes: &[steradian_scene::Shape], is_kept_square: bool) -> Boxes {
        let mut boxes = Boxes::new();
        for shape in shapes {
            self.shape(shape, is_kept_square, &mut boxes);
        }
        boxes
    }

    fn shape(&mut self, shape: &steradian_scene::Shape, is_kept_square: bool, boxes: &mut Boxes) {
        let node = self.node(shape.node);
        let Some(place) = shape.world_from_object.affine() else {
            self.error(node.span, format!("the transform of shape '{}' is singular or not finite", node.kind));
            return;
        };
        let material = self.material(shape.material);
        let mut alpha = material.alpha;
        if node.get("alpha").is_some() {
            let own = self.float_texture(node, "alpha");
            alpha = match (alpha, own) {
                (None, own) => Some(own),
                (Some(mask), FloatTexture::Constant(v)) if v >= 1.0 => Some(mask),
                (Some(_), own) => Some(own),
            };
        }
        if matches!(alpha, Some(FloatTexture::Constant(v)) if v >= 1.0) {
            alpha = None;
        }
        let is_single_sided = self.bool(node, "single_sided");
        let catches_shadows = self.bool(node, "shadow_catcher");
        let media = shape.is_medium_boundary.then(|| (self.medium(shape.interior), self.medium(shape.exterior)));
        let emission = shape.emission.map(|id| self.node(id));
        let placed = Placed {
            node,
            place,
            swaps: shape.world_from_object.swaps_handedness(),
            reverse: shape.reverse_orientation,
            emits: emission.is_some(),
        };
        let parts = self.kept_parts(shape, &placed);
        let group_from_object = self.has_object_normals.then(|| Arc::new(placed.place));
        let is_interface = scene::is_interface(&self.materials[material.id as usize]);
        for part in parts {
            let part_boxes = match &part {
                Shape::Mesh(_) | Shape::Plane(_) => Vec::new(),
                Shape::Quadric(q) => vec![q.bounds()],
                Shape::Patches(m) => (0..m.patches.len() as u32).map(|i| m.bounds(i)).collect(),
                Shape::Curves(c) => (0..c.count()).map(|i| c.bounds(i)).collect(),
                Shape::Field(f) => (0..f.count()).map(|i| f.bounds(i)).collect(),
                Shape::Sdf(s) => (0..s.count()).map(|i| s.bounds(i)).collect(),
                Shape::Level(l) => vec![l.bounds()],
            };
            let reach_is_finite = match &part {
                Shape::Mesh(m) => m.positions.iter().all(|p| p.is_finite()),
                _ => part_boxes.iter().all(|b| b.is_empty() || (b.min.is_finite() && b.max.is_finite())),
            };
            if !reach_is_finite {
                self.error(node.span, format!("shape '{}' reaches beyond the range of numbers", node.kind));
                continue;
            }
            let mut geometry = Geometry {
                shape: part,
                material: material.id,
                alpha,
                is_single_sided,
                catches_shadows,
                emitter: None,
                lights: Box::default(),
                media,
                is_interface,
                needs: Needs::default(),
                group_from_object: group_from_object.clone(),
                id: shape.node.0 + 1,
            };
            if let Some(light) = emission {
                let before = self.emitters.len();
                self.emission(light, is_kept_square, &mut geometry);
                if let (true, Some(id)) = (self.emitters.len() > before, shape.emission) {
                    let group = self.light_group(light.name.as_deref().or(node.name.as_deref()), id);
                    self.light_groups.of_emitters.resize(self.emitters.len(), group);
                    self.schedule(light, Lamp::Emitter(before as u32));
                }
            }
            self.geometries.push(geometry);
            boxes.push(part_boxes);
        }
    }

    /// The geometry of a shape, that of an earlier compilation if it was made from the same.
    fn kept_parts(&mut self, shape: &steradian_scene::Shape, placed: &Placed<'_>) -> Vec<Shape> {
        let origin = Origin::of(self.desc, shape, self.mode);
        let (Some([before, _]), Some(from)) = (&mut self.kept_shapes, origin) else {
            return self.parts(shape, placed);
        };
        let known = before.remove(&shape.node).filter(|kept| kept.from == from);
        let told = self.diagnostics.iter().count();
        let parts = known.map_or_else(|| self.parts(shape, placed), |kept| kept.parts);
        // What there is to say about a shape is said each time.
        if let (Some([_, now]), true) = (&mut self.kept_shapes, told == self.diagnostics.iter().count()) {
            now.insert(shape.node, KeptShape { from, parts: parts.clone() });
        }
        parts
    }

    /// The geometry of a shape; none where it is refused.
    fn parts(&mut self, shape: &steradian_scene::Shape, placed: &Placed<'_>) -> Vec<Shape> {
        let node = placed.node;
        match node.kind.as_str() {
            "mesh" | "loop_subdivision" if shape.mesh.is_none() => {
                self.error(node.span, format!("shape '{}' has no mesh data", node.kind));
                Vec::new()
            }
            "mesh" => {
                let flat = self.bool(node, "flat");
                match shape.mesh.and_then(|m| self.desc.meshes.get(m)) {
                    Some(mesh) if node.get("displacement").is_some() => {
                        match self.displaced(node, mesh, &placed.place) {
                            Some(mesh) => self.mesh_parts(placed, &mesh, flat),
                            None => Vec::new(),
                        }
                    }
                    Some(mesh) => self.mesh_parts(placed, mesh, flat),
                    None => Vec::new(),
                }
            }
            "loop_subdivision" => {
                let levels = self.int(node, "levels").clamp(0, 16) as u32;
                match shape.mesh.and_then(|m| self.desc.meshes.get(m)).map(|m| loop_subdivide(m, levels)) {
                    Some(Ok(mesh)) => self.mesh_parts(placed, &mesh, false),
                    Some(Err(e)) => {
                        self.error(node.span, format!("cannot subdivide this mesh: {e}"));
                        Vec::new()
                    }
                    None => Vec::new(),
                }
            }
            "sphere" => self.sphere(shape.world_from_object, placed),
            "disk" => {
                let kind = QuadricKind::Disk {
                    height: self.float(node, "height"),
                    radius: self.positive(node, "radius"),
                    inner: self.float(node, "inner_radius").max(0.0),
                };
                placed.quadric(kind, self.float(node, "phi_max").clamp(0.0, 360.0), placed.place)
            }
            "cylinder" => self.cylinder(shape.world_from_object, placed),
            "plane" => self.plane(placed),
            "curve" => self.curve(placed),
            "height_field" => {
                let most = if placed.emits { height_field::MOST_EMITTING } else { height_field::MOST };
                match self.height_field(node, &placed.place, placed.swaps, placed.reverse, most) {
                    // Lights need samples of their area, which triangles give.
                    Some(field) if placed.emits => self.mesh_parts(placed, &field.mesh(), false),
                    Some(field) => vec![Shape::Field(Arc::new(field))],
                    None => Vec::new(),
                }
            }
            "sdf_grid" => self.sdf_grid(placed),
            "bezier_patch" => {
                self.bezier_patches(node).map_or_else(Vec::new, |mesh| self.mesh_parts(placed, &mesh, false))
            }
            "polygon" => self.polygon(node).map_or_else(Vec::new, |mesh| self.mesh_parts(placed, &mesh, false)),
            "paraboloid" | "cone" | "hyperboloid" | "quadric" | "implicit" => self.level(placed),
            other => self.own_shape(placed).unwrap_or_else(|| {
                let help = self.nearest_kind(node);
                self.error_help(node.span, format!("shape '{other}' is not implemented"), help);
                Vec::new()
            }),
        }
    }

    fn sphere(&mut self, world_from_object: Transform, placed: &Placed<'_>) -> Vec<Shape> {
        let node = placed.node;
        let radius = self.positive(node, "radius");
        let (z0, z1) =
            (self.float_or(node, "z_min", f64::from(-radius)), self.float_or(node, "z_max", f64::from(radius)));
        let (z_min, z_max) = (z0.min(z1).clamp(-radius, radius), z0.max(z1).clamp(-radius, radius));
        let center = self.dvec3(node, "center");
        let Some(place) = (world_from_object * Transform::translate(center)).affine() else {
            self.error(node.span, "the centre of this sphere is not finite");
            return Vec::new();
        };
        let phi = self.float(node, "phi_max").clamp(0.0, 360.0);
        placed.quadric(QuadricKind::Sphere { radius, z_min, z_max }, phi, place)
    }

    /// A cylinder around the z axis, or from `p0` to `p1`.
    fn cylinder(&mut self, mut world_from_object: Transform, placed: &Placed<'_>) -> Vec<Shape> {
        let node = placed.node;
        let radius = self.positive(node, "radius");
        let phi = self.float(node, "phi_max").clamp(0.0, 360.0);
        let (mut z0, mut z1) = (self.float(node, "z_min"), self.float(node, "z_max"));
        if node.get("p0").is_some() || node.get("p1").is_some() {
            let (a, b) = (self.dvec3_or(node, "p0", DVec3::ZERO), self.dvec3_or(node, "p1", DVec3::Z));
            let Some(axis) = (b - a).try_normalize() else {
                self.error(node.span, "the two ends of this cylinder are the same point");
                return Vec::new();
            };
            let x = axis.any_orthonormal_vector();
            let m = steradian_math::DMat4::from_cols(
                x.extend(0.0),
                axis.cross(x).extend(0.0),
                axis.extend(0.0),
                a.extend(1.0),
            );
            world_from_object = world_from_object * Transform { matrix: m };
            (z0, z1) = (0.0, (b - a).length() as f32);
        }
        let Some(place) = world_from_object.affine() else {
            self.error(node.span, "the ends of this cylinder are not finite");
            return Vec::new();
        };
        placed.quadric(QuadricKind::Cylinder { radius, z_min: z0.min(z1), z_max: z0.max(z1) }, phi, place)
    }

    fn mesh_parts(&mut self, placed: &Placed<'_>, mesh: &Mesh, flat: bool) -> Vec<Shape> {
        let &Placed { node, ref place, swaps, reverse, emits } = placed;
        if let Err(e) = mesh.validate() {
            self.error(node.span, format!("malformed mesh: {e}"));
            return Vec::new();
        }
        for a in &mesh.attributes {
            let faults = a.data.iter().filter(|v| !v.is_finite()).count();
            if faults > 0 {
                let what = format!(
                    "{faults} values of the mesh attribute '{}' are infinite or NaN; they count as zero",
                    a.name
                );
                self.diagnostics.warn(&self.desc.sources, node.span, what);
            }
        }
        let mut parts = Vec::new();
        let (extra, curved) = shape::mesh::split_patches(mesh, emits);
        if !mesh.triangles.is_empty() || !extra.is_empty() {
            let mut triangles = TriMesh::new(mesh, place, swaps, reverse, flat);
            if !extra.is_empty() {
                triangles.triangles.extend(extra);
            }
            if self.mode == ColorMode::Spectral {
                let is_shown = |name: &str| {
                    let mut nodes = self.desc.nodes.iter().filter(|n| n.kind == "mesh_attribute");
                    nodes.any(|n| n.string("name") == Some(name))
                };
                triangles.attributes.iter_mut().filter(|a| is_shown(&a.name)).for_each(|a| a.upsample());
            }
            if let Some(word) = self.given_word(node, "tangents") {
                self.tangents(node, word, &mut triangles, place, swaps ^ reverse);
            }
            parts.push(Shape::Mesh(Arc::new(triangles)));
        }
        if !curved.is_empty() {
            let curved = Mesh { patches: curved, triangles: Vec::new().into(), attributes: Vec::new(), ..mesh.clone() };
            parts.push(Shape::Patches(Arc::new(PatchMesh::new(&curved, place, swaps, reverse, flat))));
        }
        parts
    }

    /// Tangents for normal maps: those of the coordinates, MikkTSpace's, or a vertex attribute.
    fn tangents(&mut self, node: &Node, word: &str, mesh: &mut TriMesh, place: &Affine, turned: bool) {
        match word {
            "uv" => {}
            "mikktspace" => mesh.tangents = shape::tangents::mikktspace(mesh),
            "mikktspace_down" => mesh.tangents = shape::tangents::mikktspace_down(mesh),
            name => match shape::tangents::from_attribute(mesh, name, place, turned) {
                Some(tangents) => mesh.tangents = tangents,
                None => {
                    let what = format!("this mesh has no vertex attribute '{name}' of three or four numbers");
                    self.error_help(
                        node.span,
                        what,
                        Some("known are 'uv', 'mikktspace', 'mikktspace_down', and attributes".into()),
                    );
                }
            },
        }
    }

    /// The surface of a grid of distances.
    fn sdf_grid(&mut self, placed: &Placed<'_>) -> Vec<Shape> {
        let node = placed.node;
        let smooth = self.choice(node, "normals", &[("smooth", true), ("analytic", false)]);
        let span = node.param("file").and_then(|p| p.span).or(node.span);
        let Some(grid) = self.voxel_grid(node) else { return Vec::new() };
        let ([w, h, d], channels) = (grid.size, grid.channels);
        if channels != 1 || w.min(h).min(d) < 2 {
            let what = format!(
                "a grid of distances needs one channel, and two samples along each axis at least; this one has {w} × \
                 {h} × {d} of {channels}"
            );
            self.error(span, what);
            return Vec::new();
        }
        match SdfGrid::new(grid, placed.place, placed.reverse, smooth) {
            Some(surface) if surface.count() == 0 => {
                let what = "the distances of this grid are nowhere zero: there is no surface";
                self.diagnostics.warn(&self.desc.sources, span, what);
                Vec::new()
            }
            Some(surface) => vec![Shape::Sdf(Arc::new(surface))],
            None => {
                self.error(
                    span,
                    format!("a grid of {w} × {h} × {d} distances whose surface passes this many cells is too large"),
                );
                Vec::new()
            }
        }
    }

    fn curve(&mut self, placed: &Placed<'_>) -> Vec<Shape> {
        let node = placed.node;
        let mut vectors = |name: &str| -> Vec<Vec3> {
            let list = self.list(node, name).unwrap_or_default();
            list.chunks_exact(3).map(Vec3::from_slice).collect()
        };
        let (points, normals) = (vectors("points"), vectors("normals"));
        let params = CurveParams {
            points,
            degree: self.int(node, "degree").clamp(0, 255) as u32,
            basis: self.choice(node, "basis", &[("bezier", CurveBasis::Bezier), ("bspline", CurveBasis::BSpline)]),
            kind: self.choice(
                node,
                "type",
                &[
                    ("flat", CurveKind::Flat),
                    ("cylinder", CurveKind::Cylinder),
                    ("round", CurveKind::Round),
                    ("ribbon", CurveKind::Ribbon),
                ],
            ),
            width: [self.float(node, "width0"), self.float(node, "width1")],
            normals,
        };
        if placed.emits && params.segments().is_ok() {
            // Lights need samples of their area, which triangles give.
            match params.surface() {
                Ok(mesh) => return self.mesh_parts(placed, &mesh, false),
                Err(why) => {
                    let what = format!("this curve cannot emit light, which is left out: {why}");
                    self.diagnostics.dropped(&self.desc.sources, node.span, what);
                }
            }
        }
        let split = self.int(node, "split_depth").clamp(0, 8) as u32;
        match Curves::new(&params, &placed.place, split, placed.swaps, placed.reverse) {
            Ok(curves) => vec![Shape::Curves(Arc::new(curves))],
            Err(e) => {
                self.error(node.span, format!("malformed curve: {e}"));
                Vec::new()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Options, compile};
    use steradian_math::{Ray, Vec3};
    use steradian_scene::{Family, Node, SceneDesc, Shape};

    /// A scene with a grid of distances of this size and these channels, what was said, and how far a ray down its
    /// middle goes.
    fn on_a_grid(size: [i32; 4], values: &[f32], emits: bool, normals: Option<&str>) -> (Option<f32>, String) {
        let folder = tempfile::tempdir().unwrap();
        let mut bytes = b"VOL\x03\x01\0\0\0".to_vec();
        size.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().chain(values).for_each(|v| bytes.extend(v.to_le_bytes()));
        let path = folder.path().join("a.vol");
        std::fs::write(&path, bytes).unwrap();
        let mut node = Node::new(Family::Shape, "sdf_grid", None).with("file", path);
        if let Some(normals) = normals {
            node.set("normals", normals, None);
        }
        above(node, emits, [0.5, 0.5])
    }

    /// Distance of a ray to a shape, down from z = 9 at a place, and the messages.
    fn above(node: Node, emits: bool, [x, y]: [f32; 2]) -> (Option<f32>, String) {
        let mut desc = SceneDesc::default();
        let node = desc.add(node);
        let emission = emits.then(|| desc.add(Node::new(Family::Light, "area", None)));
        desc.shapes.push(Shape { emission, ..Shape::new(node) });
        let camera = desc.add(Node::new(Family::Camera, "perspective", None));
        let light = desc.add(Node::new(Family::Light, "point", None));
        desc.cameras.push(camera);
        desc.lights.push(light);
        let compiled = compile(&desc, &Options::default());
        let said = compiled.diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("; ");
        let ray = Ray::new(Vec3::new(x, y, 9.0), -Vec3::Z);
        (compiled.scene.and_then(|s| s.intersect(&ray)).map(|hit| hit.t), said)
    }

    #[test]
    fn surfaces_by_equations() {
        let new = |kind: &str| Node::new(Family::Shape, kind, None);
        let sphere = |last: f64| vec![1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, last];
        for (node, expected) in [
            (new("cone"), 8.25),
            (new("paraboloid"), 9.0 - 0.0625),
            (new("hyperboloid").with("p1", [1.0, 0.0, 0.0]).with("p2", [0.0, 0.0, 2.0]), 7.5),
            (new("implicit").with("expression", "z - y - 0.5"), 8.5),
            // z = xy, where y is 0.
            (new("quadric").with("coefficients", vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0]), 9.0),
            (new("quadric").with("coefficients", sphere(-0.0625 - 0.25)), 8.5),
        ] {
            let (t, said) = above(node.clone(), false, [0.25, 0.0]);
            assert!(said.is_empty() && t.is_some_and(|t| (t - expected).abs() < 1e-6), "{node:?}: {t:?} {said}");
        }
        let says = |node: Node, emits| above(node, emits, [0.25, 0.0]).1;
        let (missing, faulty) =
            (says(new("implicit"), false), says(new("implicit").with("expression", "x +* y"), false));
        assert!(missing.contains("needs an 'expression'") && faulty.contains("column 4"), "{missing} {faulty}");
        assert_eq!(says(new("cone"), true), "");
        assert!(says(new("quadric").with("coefficients", sphere(-0.25)), true).contains("by chance"));
        assert!(says(new("quadric"), false).contains("here are 0"));
        assert!(says(new("quadric").with("coefficients", vec![1.0; 9]), false).contains("here are 9"));
        assert!(
            says(new("quadric").with("coefficients", [vec![0.0; 9], vec![1.0]].concat()), false).contains("no surface")
        );
        let boxless = new("quadric").with("coefficients", sphere(-1.0)).with("min", [2.0, 0.0, 0.0]);
        assert!(says(boxless, false).contains("empty"));
        assert!(says(new("hyperboloid").with("p2", [1.0, 0.0, 0.0]), false).contains("disk"));
        assert!(says(new("paraboloid").with("z_max", -1.0), false).contains("above"));
    }

    /// M56: a frame with a hole, from above and from below, and what is wrong with others.
    #[test]
    fn polygons() {
        let new = |points: &[[f64; 3]]| Node::new(Family::Shape, "polygon", None).with("points", points.concat());
        let square = [[-1.0, -1.0, 0.5], [1.0, -1.0, 0.5], [1.0, 1.0, 0.5], [-1.0, 1.0, 0.5]];
        let hole = square.map(|[x, y, z]| [0.5 * x, 0.5 * y, z]);
        let ring = new(&[square, hole].concat()).with("loops", vec![4.0, 4.0]);
        assert_eq!(above(new(&square), false, [0.25, 0.0]), (Some(8.5), String::new()));
        assert_eq!(above(ring.clone(), false, [0.25, 0.0]), (None, String::new()));
        assert_eq!(above(ring.with("rule", "nonzero"), false, [0.25, 0.0]), (Some(8.5), String::new()));
        // It shines; a slanted one is where its plane is.
        assert_eq!(above(new(&square), true, [0.25, 0.0]), (Some(8.5), String::new()));
        let slanted = square.map(|[x, y, _]| [x, y, x - 2.0 * y]);
        assert_eq!(above(new(&slanted), false, [0.25, 0.0]), (Some(8.75), String::new()));
        let says = |node: Node| above(node, false, [0.25, 0.0]).1;
        let missing = Node::new(Family::Shape, "polygon", None);
        let bent = [square[0], square[1], square[2], [-1.0, 1.0, 0.7]];
        for (node, said) in [
            (missing, "needs 'points'"),
            (new(&square[..2]), "three points or more"),
            (new(&[square[0], square[0], square[0]]), "on a line"),
            (new(&bent), "off that of the others"),
            (new(&square).with("loops", vec![3.0]), "their sum is to be 4"),
            (new(&square).with("loops", vec![5.0, -1.0]), "their sum is to be 4"),
        ] {
            assert!(says(node.clone()).contains(said), "{said}: {}", says(node));
        }
    }

    #[test]
    fn bezier_patches() {
        let grid = |z: fn(f64, f64) -> f64| -> Vec<f64> {
            let at = |k: usize| ((k % 4) as f64 / 1.5 - 1.0, (k / 4) as f64 / 1.5 - 1.0);
            (0..16).map(at).flat_map(|(x, y)| [x, y, z(x, y)]).collect()
        };
        let new = |points: Vec<f64>| Node::new(Family::Shape, "bezier_patch", None).with("points", points);
        let flat = new(grid(|x, y| x - 0.5 * y));
        for emits in [false, true] {
            let (t, said) = above(flat.clone(), emits, [0.25, 0.0]);
            assert!(said.is_empty() && (t.unwrap() - 8.75).abs() < 1e-6, "{t:?} {said}");
        }
        // The parabola with 1 at its ends and −1/3 between, of which these are the heights by degree raising.
        let bowl = new(grid(|x, _| if x.abs() > 0.5 { 1.0 } else { 1.0 / 9.0 }));
        for (node, within) in [(bowl.clone(), 3e-3), (bowl.with("level", 256_i64), 1e-5)] {
            let (t, said) = above(node, false, [0.25, 0.0]);
            assert!(said.is_empty() && (t.unwrap() - 8.625).abs() < within, "{t:?} {said}");
        }
        let says = |node: Node| above(node, false, [0.25, 0.0]).1;
        assert!(says(Node::new(Family::Shape, "bezier_patch", None)).contains("here are 0 numbers"));
        assert!(says(new(vec![0.0; 47])).contains("here are 47 numbers"));
        assert!(says(new(vec![0.0; 48])).contains("no area"));
        let many = new(grid(|x, _| x).repeat(200)).with("level", 256_i64);
        assert!(says(many).contains("too many"));
    }

    #[test]
    fn grids_of_distances() {
        // z − ¼ on two samples each way.
        let slab = [-0.25, -0.25, -0.25, -0.25, 0.75, 0.75, 0.75, 0.75];
        for normals in [None, Some("smooth"), Some("analytic")] {
            let (t, said) = on_a_grid([2, 2, 2, 1], &slab, false, normals);
            assert!(said.is_empty() && (t.unwrap() - 8.75).abs() < 1e-5, "{t:?} {said}");
        }
        let says = |size, values: &[f32], emits, normals| on_a_grid(size, values, emits, normals).1;
        assert!(says([2, 2, 2, 1], &slab, true, None).contains("by chance"));
        assert!(says([2, 2, 2, 1], &slab, false, Some("flat")).contains("flat"));
        assert!(says([2, 2, 1, 2], &slab, false, None).contains("needs one channel"));
        assert!(says([8, 1, 1, 1], &slab, false, None).contains("two samples along each axis"));
        assert!(says([2, 2, 2, 1], &[1.0; 8], false, None).contains("there is no surface"));
        assert!(says([2, 2, 2, 1], &[f32::NAN; 8], false, None).contains("8 values of this grid"));
    }
}
