//! Bounding volumes in the picture.

use super::Bounding;
use crate::projection::Projected;
use std::ops::RangeInclusive;
use steradian_core::Scene;
use steradian_math::{DMat4, DVec3, Vec4};
use steradian_raster::glam::{DVec2, DVec4};

/// Margin beyond a plane at which a volume counts as outside, relative to the summands of the test: for rounding of
/// positions.
const MARGIN: f64 = 1e-6;

/// Pixels around a footprint that may show what lies in it, for rounding of positions and places within pixels.
pub(super) const BORDER: f64 = 1.0;

/// Relative margin of depths, for rounding.
const DEPTH_MARGIN: f64 = 1e-5;

/// Margin of depths relative to the greatest one of a volume, between whose corners depths are interpolated.
const INTERPOLATION: f64 = 1e-6;

/// A view that volumes are tested against.
#[derive(Debug)]
pub struct Screen {
    clip_from_world: DMat4,
    /// Normals that point inside, and offsets: left, right, bottom, top, near.
    planes: [DVec4; 5],
    /// Top left of the view in the picture, and its size, in pixels.
    view: [[f64; 2]; 2],
    /// Margin of depths that do not depend on their size: where rays are parallel, depths are differences.
    slack: f64,
    /// Size of the picture in pixels.
    pub size: [u32; 2],
}

/// Rectangle and depths of a volume in the picture.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    /// Left and top, in pixels.
    pub min: [f64; 2],
    /// Right and bottom.
    pub max: [f64; 2],
    /// Reversed depth that nothing in the volume is before.
    pub nearest: f64,
    /// Reversed depth that nothing in it is behind.
    pub farthest: f64,
}

impl Screen {
    /// View of a camera.
    pub fn new(scene: &Scene, projected: &Projected) -> Self {
        // Columns by the images of the axes and of the origin, which lose no digits to each other.
        let [x, y, z, w] = [Vec4::X, Vec4::Y, Vec4::Z, Vec4::W].map(|p| projected.clip_homogeneous(p).as_dvec4());
        let clip_from_world = DMat4::from_cols(x, y, z, w);
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_world.row(i));
        let (extent, viewport) = projected.frame(scene);
        Self {
            clip_from_world,
            planes: [w + x, w - x, w + y, w - y, w - z],
            view: [[viewport.x, viewport.y].map(f64::from), [viewport.width, viewport.height].map(f64::from)],
            slack: if projected.is_perspective() { 0.0 } else { 1e-6 },
            size: [extent.width, extent.height],
        }
    }

    /// Rows of the matrix to homogeneous pixels.
    pub fn pixel_from_world(&self) -> [DVec4; 3] {
        let [x, y, w] = [0, 1, 3].map(|i| self.clip_from_world.row(i));
        let [[left, top], [width, height]] = self.view;
        [w * left + (w + x) * (0.5 * width), w * top + (w - y) * (0.5 * height), w]
    }

    /// Plane at which the view begins, with its normal inwards.
    pub fn near_plane(&self) -> DVec4 {
        self.planes[4]
    }

    /// Corners of the picture in pixels, with a border for rounding.
    pub fn frame(&self) -> Vec<DVec2> {
        let [x, y] = self.size.map(|side| f64::from(side) + BORDER);
        [[-BORDER, -BORDER], [x, -BORDER], [x, y], [-BORDER, y]].map(DVec2::from).to_vec()
    }

    /// True if a volume lies outside one plane of the view. Some volumes near two planes and in the view of neither are
    /// not found.
    pub fn misses(&self, volume: &Bounding) -> bool {
        let farthest = volume.corners.iter().map(|p| p.length()).fold(0.0, f64::max) + volume.radius;
        self.planes.iter().any(|plane| {
            // Greatest signed distance of the volume, in the plane's own scale.
            let normal: DVec3 = plane.truncate();
            let reach = volume.corners.iter().map(|p| normal.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
            let size = normal.length() * farthest + plane.w.abs();
            reach + volume.radius * normal.length() + plane.w < -MARGIN * size
        })
    }

    /// Footprint of a volume; `None` where it reaches the plane at which the view begins.
    pub fn footprint(&self, volume: &Bounding) -> Option<Footprint> {
        let [inf, none] = [f64::INFINITY, f64::NEG_INFINITY];
        let mut found = Footprint { min: [inf; 2], max: [none; 2], nearest: none, farthest: inf };
        for corner in volume.outer_corners() {
            let DVec4 { x, y, z, w } = self.clip_from_world * corner.extend(1.0);
            if !(w > 0.0 && w.is_finite() && z <= w) {
                return None;
            }
            let [[left, top], [width, height]] = self.view;
            let place = [left + (0.5 + 0.5 * x / w) * width, top + (0.5 - 0.5 * y / w) * height];
            for (axis, at) in place.into_iter().enumerate() {
                found.min[axis] = found.min[axis].min(at);
                found.max[axis] = found.max[axis].max(at);
            }
            found.nearest = found.nearest.max(z / w);
            found.farthest = found.farthest.min(z / w);
        }
        found.farthest -= DEPTH_MARGIN * found.farthest.abs() + INTERPOLATION * found.nearest.abs() + self.slack;
        found.nearest += DEPTH_MARGIN * found.nearest.abs() + self.slack;
        Some(found)
    }
}

impl Footprint {
    /// Area in pixels.
    pub fn area(&self) -> f64 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }

    /// Area in pixels of the part in a picture.
    pub fn area_in(&self, size: [u32; 2]) -> f64 {
        let side = |axis: usize| self.max[axis].min(f64::from(size[axis])) - self.min[axis].max(0.0);
        side(0).max(0.0) * side(1).max(0.0)
    }

    /// Columns and rows of the pixels that may show it, with a border for rounding; `None` where the picture has none
    /// of them.
    pub fn pixels(&self, size: [u32; 2]) -> Option<[RangeInclusive<u32>; 2]> {
        let range = |axis: usize| {
            let (low, high) = ((self.min[axis] - BORDER).floor(), (self.max[axis] + BORDER).floor());
            let is_in = high >= 0.0 && low < f64::from(size[axis]);
            is_in.then(|| low.max(0.0) as u32..=(high as u32).min(size[axis] - 1))
        };
        Some([range(0)?, range(1)?])
    }
}
