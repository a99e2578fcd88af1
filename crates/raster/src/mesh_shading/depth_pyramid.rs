//! A hierarchical depth buffer: what lies behind what was drawn.

use glam::{DVec4, Mat4};

use super::bounds::Sphere;
use crate::{
    render_target::{BLOCK, DepthTarget},
    state::DepthRange,
};

/// For squares of a picture, the largest depth in each: blocks of 8² pixels, and levels with squares twice as wide each
/// up to one that covers all (Greene, Kass and Miller, "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993).
///
/// For culling in two passes, draw the clusters that were visible in the last picture, make a pyramid of the depths,
/// and draw those of the others that it does not hide (Haar and Aaltonen, "GPU-Driven Rendering Pipelines", SIGGRAPH
/// 2015 course Advances in Real-Time Rendering).
#[derive(Clone, Debug, PartialEq)]
pub struct DepthPyramid {
    /// Columns and rows of the picture, in pixels.
    size: [u32; 2],
    levels: Vec<Level>,
    /// Margin of depth behind the largest depth at which something counts as hidden: for rounding of depths.
    margin: f64,
}

#[derive(Clone, Debug, PartialEq)]
struct Level {
    columns: usize,
    rows: usize,
    /// Row by row.
    largest: Vec<f32>,
}

impl DepthPyramid {
    /// Pyramid of a layer, `None` if it does not exist. Depths grow with distance.
    pub fn new(depth: &DepthTarget, layer: u32) -> Option<Self> {
        let extent = depth.extent();
        if layer >= extent.layers {
            return None;
        }
        let [columns, rows] = [extent.width, extent.height].map(|n| n.div_ceil(BLOCK));
        // Level 0 takes the depth bounds that the tiles keep for each block.
        let bound = |row, column| depth.block_bounds([column * BLOCK, row * BLOCK], layer).map_or(1.0, |b| b[1]);
        let blocks = (0..rows).flat_map(|row| (0..columns).map(move |column| bound(row, column)));
        let mut level = Level { columns: columns as usize, rows: rows as usize, largest: blocks.collect() };
        let mut levels = Vec::new();
        // Each further level is the maximum of 2×2 squares.
        while level.columns > 1 || level.rows > 1 {
            let next = level.halved();
            levels.push(std::mem::replace(&mut level, next));
        }
        levels.push(level);
        // Allow for rounding to the depth format.
        let steps = depth.format().steps();
        let margin = 1e-6 + if steps > 0.0 { 1.0 / steps } else { 0.0 };
        Some(Self { size: [extent.width, extent.height], levels, margin })
    }

    /// True if nothing within a sphere can pass the tests [`DepthState::LESS`](crate::state::DepthState::LESS) or
    /// less-or-equal, with any sample. The sphere is in the space of the mesh, whose vertices are multiplied with the
    /// matrix; the viewport fills the framebuffer, with depths from 0 to 1 and no bias. A sphere that reaches behind
    /// the camera or lies outside the picture is not hidden.
    pub fn hides(&self, sphere: &Sphere, clip_from_object: Mat4, range: DepthRange) -> bool {
        let Some((min, max, nearest)) = self.project(sphere, clip_from_object, range) else { return false };
        // From the level on where the box touches at most two squares along each axis.
        let last = self.levels.len() - 1;
        let mut level = 0;
        while level < last && (0..2).any(|axis| (max[axis] >> level) - (min[axis] >> level) > 1) {
            level += 1;
        }
        let squares = &self.levels[level];
        let [columns, rows] = [0, 1].map(|axis| min[axis] >> level..=max[axis] >> level);
        // Hidden where the nearest depth lies behind the largest depth of every square it touches.
        let behind = |largest: f32| nearest - self.margin > f64::from(largest);
        rows.into_iter().all(|row| columns.clone().all(|column| squares.at(column, row).is_some_and(behind)))
    }

    /// The blocks that a sphere's box may touch, first and last, and a depth that nothing in it is before.
    fn project(
        &self,
        sphere: &Sphere,
        clip_from_object: Mat4,
        range: DepthRange,
    ) -> Option<([usize; 2], [usize; 2], f64)> {
        let matrix = clip_from_object.as_dmat4();
        let size = self.size.map(f64::from);
        let (mut min, mut max, mut nearest) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2], f64::INFINITY);
        // Project the corners of the cube around the sphere; one behind the eye makes the test impossible.
        for corner in 0..8 {
            let sign = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let offset = glam::dvec3(sign(0), sign(1), sign(2)) * f64::from(sphere.radius);
            let DVec4 { x, y, z, w } = matrix * (sphere.center.as_dvec3() + offset).extend(1.0);
            if !(w > 0.0 && w.is_finite()) {
                return None;
            }
            let window = [(0.5 + 0.5 * x / w) * size[0], (0.5 - 0.5 * y / w) * size[1]];
            // A pixel of margin covers sample offsets and rounding.
            for axis in 0..2 {
                min[axis] = min[axis].min(window[axis] - 1.0);
                max[axis] = max[axis].max(window[axis] + 1.0);
            }
            nearest = nearest.min(match range {
                DepthRange::ZeroToOne => z / w,
                DepthRange::MinusOneToOne => 0.5 + 0.5 * z / w,
            });
        }
        // Outside the picture nothing was drawn that could hide it.
        let seen = (0..2).all(|axis| max[axis] >= 0.0 && min[axis] < size[axis]);
        let block = |at: f64, axis: usize| (at.clamp(0.0, size[axis] - 1.0) / f64::from(BLOCK)) as usize;
        seen.then(|| ([0, 1].map(|axis| block(min[axis], axis)), [0, 1].map(|axis| block(max[axis], axis)), nearest))
    }
}

impl Level {
    fn at(&self, column: usize, row: usize) -> Option<f32> {
        (column < self.columns).then(|| self.largest.get(row * self.columns + column).copied()).flatten()
    }

    /// With squares twice as wide.
    fn halved(&self) -> Self {
        let [columns, rows] = [self.columns, self.rows].map(|n| n.div_ceil(2));
        let of_four = |row: usize, column: usize| {
            let four = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(y, x)| self.at(2 * column + x, 2 * row + y));
            four.into_iter().flatten().fold(0.0, f32::max)
        };
        let squares = (0..rows).flat_map(|row| (0..columns).map(move |column| of_four(row, column)));
        Self { columns, rows, largest: squares.collect() }
    }
}
