//! Frustum culling.

use glam::{DVec3, Mat4, Vec3, Vec4};

use super::bounds::Sphere;
use crate::state::{DepthRange, RasterState};

/// The planes around the view, in the space of the mesh (Gribb and Hartmann, "Fast Extraction of Viewing Frustum Planes
/// from the World-View-Projection Matrix", 2001).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Normals that point inside, and offsets. A plane of zeros culls nothing.
    planes: [(DVec3, f64); 6],
}

/// Margin beyond a plane at which a sphere counts as outside, relative to the summands of the test: for rounding of
/// positions.
const MARGIN: f64 = 1e-6;

impl Frustum {
    /// Frustum of the matrix that vertices are multiplied with. The state tells the near and far planes, if depths are
    /// clipped.
    pub fn new(clip_from_object: Mat4, raster: &RasterState) -> Self {
        // Rows of the matrix combine to planes: w ± x, w ± y, w − z and the near plane.
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_object.row(i));
        let near = match raster.depth_range {
            DepthRange::ZeroToOne => z,
            DepthRange::MinusOneToOne => w + z,
        };
        let depth = |plane: Vec4| if raster.depth_clip { plane } else { Vec4::ZERO };
        let plane = |p: Vec4| (p.truncate().as_dvec3(), f64::from(p.w));
        Self { planes: [w + x, w - x, w + y, w - y, depth(near), depth(w - z)].map(plane) }
    }

    /// True if a sphere lies outside one of the planes. Some spheres near two planes and in the view of neither are not
    /// found.
    pub fn misses(&self, sphere: &Sphere) -> bool {
        let radius = f64::from(sphere.radius);
        self.is_beyond_a_plane(sphere.center.as_dvec3(), |normal| radius * normal.length())
    }

    /// True if the box of half axes around a centre, which need not be orthogonal, lies outside one of the planes. Some
    /// boxes near two planes and in the view of neither are not found.
    pub fn misses_box(&self, center: Vec3, half_axes: [Vec3; 3]) -> bool {
        // The corner farthest along a normal is Σ |n·a| from the centre.
        let axes = half_axes.map(Vec3::as_dvec3);
        self.is_beyond_a_plane(center.as_dvec3(), |normal| axes.iter().map(|a| normal.dot(*a).abs()).sum())
    }

    /// True if what reaches `extent` along a normal from a centre lies outside one of the planes, in the planes' own
    /// scales, beyond rounding.
    fn is_beyond_a_plane(&self, center: DVec3, extent: impl Fn(DVec3) -> f64) -> bool {
        self.planes.iter().any(|(normal, offset)| {
            let extent = extent(*normal);
            let size = normal.length() * center.length() + extent + offset.abs();
            normal.dot(center) + offset < -extent - MARGIN * size
        })
    }
}
