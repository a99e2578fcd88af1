//! Shapes: what rays meet.

pub mod curve;
pub mod displacement;
pub mod height_field;
pub mod mesh;
pub mod patch;
pub mod plane;
pub mod quadric;
pub mod sdf_grid;
pub mod subdivision;
pub mod tangents;

pub use curve::Curves;
pub use height_field::Field;
pub use mesh::TriMesh;
pub use patch::PatchMesh;
pub use plane::Plane;
pub use quadric::{Quadric, QuadricKind};
pub use sdf_grid::SdfGrid;

use steradian_math::{Vec2, Vec3};

/// The shapes by name, for the registry.
pub const SHAPES: &[(&str, &str)] = &[
    ("mesh", "triangles and bilinear patches; alpha, flat, displacement, edge_length, tangents"),
    ("sphere", "center, radius, z_min, z_max, phi_max (degrees)"),
    ("disk", "height, radius, inner_radius, phi_max (degrees)"),
    ("cylinder", "radius, z_min, z_max, phi_max (degrees); or p0, p1, radius"),
    ("height_field", "heights over the unit square, traced without triangles; heights, nu, nv, file, scale, smooth"),
    ("sdf_grid", "where a signed distance function on a grid over the unit cube is zero; file, normals"),
    ("plane", "the infinite plane n·x + d = 0; normal, distance"),
    ("loop_subdivision", "the limit surface of a mesh by Loop's rules; levels"),
    ("curve", "cubic or quadratic Bézier or B-spline; points, degree, basis, type, width0, width1, normals"),
];

/// The surface at a point, in the space of the shape's placement.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// The point.
    pub p: Vec3,
    /// Half size of a box around `p` that holds the true point.
    pub error: Vec3,
    /// Unit geometric normal, oriented.
    pub n: Vec3,
    /// Unit shading normal.
    pub ns: Vec3,
    /// ∂p/∂u; may be zero.
    pub dpdu: Vec3,
    /// Surface parameters.
    pub uv: Vec2,
}

impl SurfacePoint {
    /// A point with the error of its place and a normal, without a parametrisation.
    #[inline]
    pub fn bare(p: Vec3, error: Vec3, n: Vec3) -> Self {
        Self { p, error, n, ns: n, dpdu: Vec3::ZERO, uv: Vec2::ZERO }
    }
}
