//! Statistics of a draw.

use std::ops::AddAssign;

/// Counts of a draw. They do not depend on the number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Vertices asked for.
    pub vertices: u64,
    /// Calls of the vertex shader.
    pub vertex_shader: u64,
    /// Patches that were tessellated.
    pub patches: u64,
    /// Calls of the tessellation evaluation shader.
    pub evaluation_shader: u64,
    /// Calls of the geometry shader.
    pub geometry_shader: u64,
    /// Primitives that came to the rasteriser.
    pub primitives: u64,
    /// Primitives among these that were dropped as outside the view, or as of a layer or viewport that does not exist.
    pub outside: u64,
    /// Dropped for a position that is not finite.
    pub not_finite: u64,
    /// Dropped by the side that they show.
    pub culled: u64,
    /// Dropped because they cover no sample, as far as their corners tell.
    pub empty: u64,
    /// Cut by a plane.
    pub clipped: u64,
    /// Primitives in tiles: each counts once for each tile that it may touch.
    pub binned: u64,
    /// 8×8 blocks that the bounds of the depths ruled out.
    pub hidden_blocks: u64,
    /// Pixels that a primitive covers in part or whole, tests aside, hidden blocks not counted.
    pub covered_pixels: u64,
    /// Calls of the fragment shader, helpers not counted.
    pub fragments: u64,
    /// Samples that passed all tests: an occlusion query.
    pub samples_passed: u64,
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.vertices += other.vertices;
        self.vertex_shader += other.vertex_shader;
        self.patches += other.patches;
        self.evaluation_shader += other.evaluation_shader;
        self.geometry_shader += other.geometry_shader;
        self.primitives += other.primitives;
        self.outside += other.outside;
        self.not_finite += other.not_finite;
        self.culled += other.culled;
        self.empty += other.empty;
        self.clipped += other.clipped;
        self.binned += other.binned;
        self.hidden_blocks += other.hidden_blocks;
        self.covered_pixels += other.covered_pixels;
        self.fragments += other.fragments;
        self.samples_passed += other.samples_passed;
    }
}
