//! Shapes, each with the parameters that it has.

use super::node::Draft;
use crate::{Family, Mesh, Transform};

/// Geometry on its way into a scene: what all shapes turn into.
#[derive(Clone, Debug)]
pub struct Geometry {
    pub(super) draft: Draft,
    pub(super) mesh: Option<Mesh>,
    pub(super) placement: Transform,
    pub(super) reversed: bool,
}

impl Geometry {
    fn new(draft: Draft) -> Self {
        Self { draft, mesh: None, placement: Transform::IDENTITY, reversed: false }
    }

    /// Places it in the world, after where it is placed already.
    #[must_use]
    pub fn placed(mut self, world_from_object: Transform) -> Self {
        self.placement = world_from_object * self.placement;
        self
    }

    /// Turns its normals over.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.reversed = !self.reversed;
        self
    }

    /// The name under which layers and messages speak of it.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.draft.name = Some(name.into());
        self
    }
}

/// The methods that shapes share with [`Geometry`].
macro_rules! shape {
    ($name:ident) => {
        impl From<$name> for Geometry {
            fn from(shape: $name) -> Self {
                shape.0
            }
        }

        impl $name {
            /// Places it in the world, after where it is placed already.
            #[must_use]
            pub fn placed(self, world_from_object: Transform) -> Geometry {
                self.0.placed(world_from_object)
            }

            /// Turns its normals over.
            #[must_use]
            pub fn reversed(self) -> Geometry {
                self.0.reversed()
            }

            /// The name under which layers and messages speak of it.
            #[must_use]
            pub fn named(self, name: impl Into<String>) -> Geometry {
                self.0.named(name)
            }
        }
    };
}

/// A sphere.
#[derive(Clone, Debug)]
pub struct Sphere(Geometry);
shape!(Sphere);

impl Sphere {
    /// Around a point.
    pub fn new(center: [f64; 3], radius: f64) -> Self {
        let draft = Draft::new(Family::Shape, "sphere").with("center", center).with("radius", radius);
        Self(Geometry::new(draft))
    }
}

/// An infinite plane.
#[derive(Clone, Debug)]
pub struct Plane(Geometry);
shape!(Plane);

impl Plane {
    /// Through the origin, with that normal.
    pub fn facing(normal: [f64; 3]) -> Self {
        Self(Geometry::new(Draft::new(Family::Shape, "plane").with("normal", normal)))
    }
}

/// A disk around the z axis, facing +z.
#[derive(Clone, Debug)]
pub struct Disk(Geometry);
shape!(Disk);

impl Disk {
    /// In the plane z = 0.
    pub fn new(radius: f64) -> Self {
        Self(Geometry::new(Draft::new(Family::Shape, "disk").with("radius", radius)))
    }
}

/// A tube without ends.
#[derive(Clone, Debug)]
pub struct Cylinder(Geometry);
shape!(Cylinder);

impl Cylinder {
    /// Around the line between two points.
    pub fn between(from: [f64; 3], to: [f64; 3], radius: f64) -> Self {
        let draft = Draft::new(Family::Shape, "cylinder").with("p0", from).with("p1", to).with("radius", radius);
        Self(Geometry::new(draft))
    }
}

/// Triangles over shared vertices.
#[derive(Clone, Debug)]
pub struct TriangleMesh(Geometry);
shape!(TriangleMesh);

impl TriangleMesh {
    /// Vertices, and three of them for each triangle, counter-clockwise seen from the front. What does not fit together
    /// is reported when the scene is compiled.
    pub fn new(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        let mesh = Mesh { positions, triangles: triangles.into(), ..Mesh::default() };
        Self(Geometry { mesh: Some(mesh), ..Geometry::new(Draft::new(Family::Shape, "mesh")) })
    }

    /// A parallelogram from a corner along two edges, facing their cross product, with texture coordinates 0…1.
    pub fn parallelogram(corner: [f32; 3], u: [f32; 3], v: [f32; 3]) -> Self {
        let at = |s: f32, t: f32| std::array::from_fn(|i| corner[i] + s * u[i] + t * v[i]);
        Self::new(vec![at(0., 0.), at(1., 0.), at(1., 1.), at(0., 1.)], vec![[0, 1, 2], [0, 2, 3]]).uvs(vec![
            [0., 0.],
            [1., 0.],
            [1., 1.],
            [0., 1.],
        ])
    }

    fn with(mut self, set: impl FnOnce(&mut Mesh)) -> Self {
        if let Some(mesh) = &mut self.0.mesh {
            set(mesh);
        }
        self
    }

    /// A normal for each vertex; without them faces are flat.
    #[must_use]
    pub fn normals(self, normals: Vec<[f32; 3]>) -> Self {
        self.with(|m| m.normals = normals)
    }

    /// Texture coordinates for each vertex.
    #[must_use]
    pub fn uvs(self, uvs: Vec<[f32; 2]>) -> Self {
        self.with(|m| m.uvs = uvs)
    }
}

impl From<Mesh> for Geometry {
    fn from(mesh: Mesh) -> Self {
        Self { mesh: Some(mesh), ..Self::new(Draft::new(Family::Shape, "mesh")) }
    }
}
