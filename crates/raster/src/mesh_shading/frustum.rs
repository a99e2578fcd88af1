//! Frustum culling.

use glam::{DVec3, Mat4, Vec4};

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
        let center = sphere.center.as_dvec3();
        let radius = f64::from(sphere.radius);
        self.planes.iter().any(|(normal, offset)| {
            // Signed distance below −r for any plane, in the plane's own scale.
            let size = normal.length() * (center.length() + radius) + offset.abs();
            normal.dot(center) + offset < -radius * normal.length() - MARGIN * size
        })
    }
}
