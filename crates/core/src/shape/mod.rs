//! Shapes: the surfaces that rays meet.
//!
//! Triangles of meshes go into the hierarchy in world space, or in the space of their group, eight to a block.
//! Quadrics, bilinear patches, segments of curves, blocks of height fields and cells of distance grids are user
//! primitives of the same hierarchy: `steradian-accel` calls back through `UserPrimitives`, dispatched statically. Flat
//! bilinear patches, and all patches that emit, become triangles. Infinite planes have no box and are tested one by
//! one, outside the hierarchy.
//!
//! Groups with instances have hierarchies of their own; there is one level of instances. An object that moves while the
//! shutter is open is an instance whose transform is a function of the ray's time (`steradian_math::motion`); its box
//! contains it at all moments. All rays of a path, and of paths that share vertices, have one moment. Rays of scenes
//! with motion are traced one by one.

pub mod curve;
pub mod displacement;
pub mod height_field;
pub mod level;
pub mod mesh;
pub mod patch;
pub mod plane;
pub mod quadric;
pub mod sdf_grid;
pub mod subdivision;
pub mod tangents;
mod tube;

pub use curve::Curves;
pub use height_field::Field;
pub use level::{LevelSet, OwnShape};
pub use mesh::TriMesh;
pub use patch::PatchMesh;
pub use plane::Plane;
pub use quadric::{Quadric, QuadricKind};
pub use sdf_grid::SdfGrid;

use std::sync::Arc;
use steradian_accel::{Hit, UserHit};
use steradian_math::{Bounds3, Ray, Vec2, Vec3};

/// The geometry of a shape.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles.
    Mesh(Arc<TriMesh>),
    /// Sphere, disk or cylinder.
    Quadric(Arc<Quadric>),
    /// Bilinear patches.
    Patches(Arc<PatchMesh>),
    /// Curves.
    Curves(Arc<Curves>),
    /// A height field.
    Field(Arc<Field>),
    /// A surface on a grid of distances.
    Sdf(Arc<SdfGrid>),
    /// A surface where a function is zero.
    Level(Arc<LevelSet>),
    /// An infinite plane.
    Plane(Plane),
}

impl Shape {
    /// The box around it; empty for infinite planes.
    pub fn bounds(&self) -> Bounds3 {
        match self {
            Self::Mesh(m) => Bounds3::from_points(m.positions.iter().copied()),
            Self::Quadric(q) => q.bounds(),
            Self::Patches(m) => Bounds3::from_points(m.positions.iter().copied()),
            Self::Curves(c) => (0..c.count()).fold(Bounds3::EMPTY, |b, k| b.union(c.bounds(k))),
            Self::Field(f) => (0..f.count()).fold(Bounds3::EMPTY, |b, k| b.union(f.bounds(k))),
            Self::Sdf(s) => (0..s.count()).fold(Bounds3::EMPTY, |b, k| b.union(s.bounds(k))),
            Self::Level(l) => l.bounds(),
            Self::Plane(_) => Bounds3::EMPTY,
        }
    }

    /// True if it turns towards every ray: curves of all kinds, since the width of ribbons is measured across the ray.
    pub fn faces_rays(&self) -> bool {
        matches!(self, Self::Curves(_))
    }

    /// The surface at a hit of a ray, both in the space of the shape.
    #[inline]
    pub fn surface(&self, hit: &Hit, ray: &Ray) -> SurfacePoint {
        match self {
            Self::Mesh(m) => m.surface(hit.id.prim, hit.u, hit.v),
            Self::Quadric(q) => q.surface(ray, hit.t),
            Self::Patches(m) => m.surface(hit.id.prim, hit.u, hit.v),
            Self::Curves(c) => c.surface(hit.id.prim, hit.u, hit.v, ray, hit.t),
            Self::Field(f) => f.surface(hit.u, hit.v),
            Self::Sdf(s) => s.surface(hit.id.prim, ray, hit.t),
            Self::Level(l) => l.surface(ray, hit.t),
            Self::Plane(p) => p.surface(ray, hit.t),
        }
    }

    /// [`Shape::surface`] without its parametrisation, where that is dear.
    #[inline]
    pub fn bare(&self, hit: &Hit, ray: &Ray) -> SurfacePoint {
        match self {
            Self::Mesh(m) => m.bare(hit.id.prim, hit.u, hit.v),
            Self::Quadric(q) => q.bare(ray, hit.t),
            shape => shape.surface(hit, ray),
        }
    }

    /// The normal on the side from which it is seen, at a hit.
    #[inline]
    pub fn front(&self, hit: &Hit, ray: &Ray) -> Vec3 {
        match self {
            Self::Mesh(m) => m.front(hit.id.prim),
            shape => shape.surface(hit, ray).n,
        }
    }

    /// First intersection of a ray with one of its primitives, among the hits that pass; triangles of meshes and planes
    /// are intersected elsewhere.
    #[inline]
    pub fn intersect(&self, prim: u32, ray: &Ray, passes: impl Fn(&UserHit) -> bool) -> Option<UserHit> {
        match self {
            Self::Quadric(q) => {
                let first = q.intersect(ray)?;
                if passes(&first) {
                    return Some(first);
                }
                // The far side may count where the near one does not.
                let beyond = q.intersect_after(ray, first.t)?;
                passes(&beyond).then_some(beyond)
            }
            Self::Patches(m) => m.intersect(prim, ray).filter(passes),
            Self::Curves(c) => c.intersect(prim, ray).filter(passes),
            Self::Field(f) => f.intersect(prim, ray, passes),
            Self::Sdf(s) => s.intersect(prim, ray, passes),
            Self::Level(l) => l.intersect(ray, passes),
            Self::Mesh(_) | Self::Plane(_) => None,
        }
    }

    /// True if both share their geometry in memory. Planes, which no ray structure holds, count as one.
    pub fn is_same(&self, other: &Self) -> bool {
        self.address() == other.address()
    }

    /// Memory address of its geometry; `None` for planes, which are stored in place.
    pub(crate) fn address(&self) -> Option<usize> {
        Some(match self {
            Self::Mesh(m) => Arc::as_ptr(m).addr(),
            Self::Quadric(q) => Arc::as_ptr(q).addr(),
            Self::Patches(m) => Arc::as_ptr(m).addr(),
            Self::Curves(c) => Arc::as_ptr(c).addr(),
            Self::Field(f) => Arc::as_ptr(f).addr(),
            Self::Sdf(s) => Arc::as_ptr(s).addr(),
            Self::Level(l) => Arc::as_ptr(l).addr(),
            Self::Plane(_) => return None,
        })
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Mesh(m) => m.bytes(),
            Self::Patches(m) => m.bytes(),
            Self::Curves(c) => c.bytes(),
            Self::Field(f) => f.bytes(),
            Self::Sdf(s) => s.bytes(),
            Self::Level(l) => l.bytes(),
            Self::Quadric(_) => size_of::<Quadric>(),
            Self::Plane(_) => size_of::<Plane>(),
        }
    }
}

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

/// The mean over the unit square of what points of a surface tell of its area.
fn mean_area(at: impl Fn(Vec2) -> f32) -> f32 {
    const EDGE: u32 = 64;
    let centre = |k: u32| (k as f32 + 0.5) / EDGE as f32;
    let row = |y: u32| (0..EDGE).map(|x| f64::from(at(Vec2::new(centre(x), centre(y))))).sum::<f64>();
    ((0..EDGE).map(row).sum::<f64>() / f64::from(EDGE * EDGE)) as f32
}
