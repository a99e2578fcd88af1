//! A stage for experiments: small scenes built in code, whose only parts are those an experiment is about.

use steradian_compile::{Options, compile};
use steradian_core::{ColorMode, Scene, light::Lights};
use steradian_math::{DVec3, Transform};
use steradian_scene::{ColorSpace, Family, Format, Mesh, Node, NodeId, SceneDesc, Shape, SpectrumValue, Value};

/// A scene in the making, and its camera.
pub struct Stage {
    pub desc: SceneDesc,
}

/// White of a strength: in spectral mode D65 for lights, flat for everything else.
pub fn white(v: f64) -> Value {
    rgb([v; 3])
}

pub fn rgb(v: [f64; 3]) -> Value {
    Value::Spectrum(SpectrumValue::Rgb(v, ColorSpace::Srgb))
}

pub fn material(kind: &str) -> Node {
    Node::new(Family::Material, kind, None)
}

pub fn light(kind: &str) -> Node {
    Node::new(Family::Light, kind, None)
}

pub fn shape(kind: &str) -> Node {
    Node::new(Family::Shape, kind, None)
}

pub fn medium(sigma_a: impl Into<Value>, sigma_s: impl Into<Value>) -> Node {
    Node::new(Family::Medium, "homogeneous", None).with("sigma_a", sigma_a).with("sigma_s", sigma_s)
}

pub fn diffuse(reflectance: f64) -> Node {
    material("diffuse").with("reflectance", white(reflectance))
}

pub fn sphere(center: [f64; 3], radius: f64) -> Node {
    shape("sphere").with("center", center).with("radius", radius)
}

/// The plane `n·x = offset`.
pub fn plane(normal: [f64; 3], offset: f64) -> Node {
    shape("plane").with("normal", normal).with("distance", -offset)
}

/// Camera space placed at `from`, looking at `to`.
pub fn look_at(from: [f64; 3], to: [f64; 3]) -> Transform {
    let (from, to) = (DVec3::from_array(from), DVec3::from_array(to));
    let along = to - from;
    let up = if along.x.abs() + along.z.abs() > 1e-3 * along.y.abs() { DVec3::Y } else { DVec3::Z };
    Transform::look_at(from, to, up).expect("two distinct points")
}

impl Stage {
    /// Nothing at all, seen by one pixel with a box filter and independent samples, so that the film's variance is that
    /// of the estimator.
    pub fn new() -> Self {
        let mut desc = SceneDesc { format: Format::Native, ..SceneDesc::default() };
        let sampler = desc.add(Node::new(Family::Sampler, "independent", None));
        let filter = desc.add(Node::new(Family::Filter, "box", None));
        (desc.sampler, desc.filter) = (Some(sampler), Some(filter));
        let mut stage = Self { desc };
        stage.film(1, 1);
        stage
    }

    pub fn add(&mut self, node: Node) -> NodeId {
        self.desc.add(node)
    }

    /// Places a shape; what it is made of and what it emits is for the caller to say.
    pub fn place(&mut self, node: Node) -> &mut Shape {
        let node = self.add(node);
        self.desc.shapes.push(Shape::new(node));
        self.desc.shapes.last_mut().expect("one was pushed")
    }

    /// Places a mesh.
    pub fn place_mesh(&mut self, mesh: Mesh) -> &mut Shape {
        let mesh = self.desc.add_mesh(mesh);
        let shape = self.place(shape("mesh"));
        shape.mesh = Some(mesh);
        shape
    }

    /// Places a shape of a material.
    pub fn solid(&mut self, node: Node, made_of: Node) -> &mut Shape {
        let made_of = self.add(made_of);
        let shape = self.place(node);
        shape.material = Some(made_of);
        shape
    }

    /// Places a black shape that emits a grey radiance on the side of its normal.
    pub fn lamp(&mut self, node: Node, radiance: f64) -> &mut Shape {
        let emission = self.add(light("area").with("radiance", white(radiance)));
        let shape = self.solid(node, diffuse(0.0));
        shape.emission = Some(emission);
        shape
    }

    /// A mesh that emits as [`Self::lamp`].
    pub fn mesh_lamp(&mut self, mesh: Mesh, radiance: f64) -> &mut Shape {
        let (emission, black) = (self.add(light("area").with("radiance", white(radiance))), self.add(diffuse(0.0)));
        let shape = self.place_mesh(mesh);
        (shape.emission, shape.material) = (Some(emission), Some(black));
        shape
    }

    /// Adds a light that is not a surface.
    pub fn light(&mut self, node: Node) -> &mut Self {
        let node = self.add(node);
        self.desc.lights.push(node);
        self
    }

    /// Adds an environment of one white radiance in all directions.
    pub fn sky(&mut self, radiance: f64) -> &mut Self {
        self.light(light("environment").with("radiance", white(radiance)))
    }

    /// Sets the frame.
    pub fn film(&mut self, width: i64, height: i64) -> &mut Self {
        let film = Node::new(Family::Film, "rgb", None).with("width", width).with("height", height);
        self.desc.film = Some(self.desc.add(film));
        self
    }

    /// Sets the camera, with an angle of view (degrees) across the width.
    pub fn look(&mut self, from: [f64; 3], to: [f64; 3], fov: f64) -> &mut Self {
        self.camera(
            Node::new(Family::Camera, "perspective", None)
                .with("fov", fov)
                .with("fov_axis", "x")
                .with("to_world", look_at(from, to)),
        )
    }

    /// Sets the camera to a single ray: what arrives at `from` out of the direction of `to`.
    pub fn probe(&mut self, from: [f64; 3], to: [f64; 3]) -> &mut Self {
        self.look(from, to, 1e-4)
    }

    pub fn camera(&mut self, node: Node) -> &mut Self {
        let camera = self.add(node);
        self.desc.cameras = vec![camera];
        self
    }

    /// The scene in RGB mode.
    pub fn scene(&self) -> Scene {
        self.scene_in(ColorMode::Rgb)
    }

    /// The scene in a colour mode. Nothing may be approximated or dropped on the way.
    pub fn scene_in(&self, mode: ColorMode) -> Scene {
        let compiled = compile(&self.desc, &Options { mode: Some(mode), ..Options::default() });
        let said: Vec<String> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
        assert!(!compiled.diagnostics.is_lossy() && !compiled.diagnostics.has_errors(), "{said:?}");
        compiled.scene.expect("a scene without errors")
    }
}

/// Variant of a scene whose surfaces shine without being lights that next-event estimation could find: all light is
/// then met by scattering.
pub fn found_by_scattering_alone(scene: Scene) -> Scene {
    let scene = scene.changed(|parts| {
        for geometry in &mut parts.geometries {
            geometry.lights = Box::default();
        }
        parts.lights = Lights::new(Vec::new(), parts.lights.emitters.clone(), parts.mode);
    });
    assert!(!scene.lights().can_sample());
    scene
}

/// A parallelogram of two triangles, its normal along `ex × ey`.
pub fn rectangle(corner: [f64; 3], ex: [f64; 3], ey: [f64; 3]) -> Mesh {
    let at = |s: f64, t: f64| std::array::from_fn(|i| (corner[i] + ex[i] * s + ey[i] * t) as f32);
    Mesh {
        positions: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        ..Mesh::default()
    }
}

/// A box between two corners, normals outwards.
pub fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for side in 0..2 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let (mut corner, mut ex, mut ey) = (lo, [0.0; 3], [0.0; 3]);
            (ex[u], ey[v]) = (hi[u] - lo[u], hi[v] - lo[v]);
            if side == 1 {
                corner[axis] = hi[axis];
            } else {
                std::mem::swap(&mut ex, &mut ey);
            }
            let face = rectangle(corner, ex, ey);
            let base = mesh.positions.len() as u32;
            mesh.positions.extend(face.positions);
            mesh.triangles.extend(face.triangles.iter().map(|t| t.map(|i| i + base)));
        }
    }
    mesh
}

/// An icosahedron whose faces are divided in four `levels` times and pushed out to a sphere; flat faces, normals
/// outwards.
pub fn icosphere(center: [f64; 3], radius: f64, levels: u32) -> Mesh {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let corners = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    let mut triangles: Vec<[DVec3; 3]> =
        faces.iter().map(|f| f.map(|i: usize| DVec3::from_array(corners[i]).normalize())).collect();
    for _ in 0..levels {
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    // Corners of the same place get the same index, so that the mesh is closed.
    let mut mesh = Mesh::default();
    let mut index = std::collections::HashMap::new();
    for t in triangles {
        mesh.triangles.push(t.map(|p| {
            let q: [f32; 3] = (DVec3::from_array(center) + p * radius).as_vec3().to_array();
            let key = (p * 1e6).round().as_i64vec3();
            *index.entry(key).or_insert_with(|| {
                mesh.positions.push(q);
                mesh.positions.len() as u32 - 1
            })
        }));
    }
    mesh
}
