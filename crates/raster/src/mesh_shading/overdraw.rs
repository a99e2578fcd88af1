//! Overdraw of a mesh: the part of its fragments that are drawn over.

use glam::{Vec3, Vec4};

use crate::{
    draw::Draw,
    error::{Result, refuse},
    pipeline::Pipeline,
    render_target::{Extent, Framebuffer},
    stages::{DepthOnly, Program, Vertex, VertexInput},
    state::{Cull, DepthState, RasterState, State},
};

/// Side of a picture in pixels.
const SIDE: u32 = 256;

/// Pixels that a mesh covers, and how often they are shaded, over six pictures of 256² pixels: along both directions of
/// each axis, without perspective, with the depth test and without triangles that show their backs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overdraw {
    /// Pixels of all pictures that the mesh covers.
    pub covered: u64,
    /// Fragments that passed the depth test when they were drawn.
    pub shaded: u64,
}

impl Overdraw {
    /// Draws triangles in this order. What is measured is what `meshopt_analyzeOverdraw` of meshoptimizer measures
    /// (Nehab, Barczak and Sander, "Triangle Order Optimization for Graphics Hardware Computation Culling", I3D 2006,
    /// define it).
    ///
    /// # Errors
    /// Where an index names no position.
    pub fn of_indices(positions: &[Vec3], indices: &[u32]) -> Result<Self> {
        if let Some(index) = indices.iter().find(|&&i| i as usize >= positions.len()) {
            let count = positions.len();
            return refuse("Overdraw::of_indices", format!("index {index}; there are {count} positions"));
        }
        // Scale the mesh to the unit cube; positions that are not finite are left out.
        let named = || indices.iter().map(|&i| positions[i as usize]).filter(|p| p.is_finite());
        let least = named().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let largest = named().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let size = (largest.as_dvec3() - least.as_dvec3()).max_element();
        let scale = if size > 0.0 { 1.0 / size } else { 0.0 };
        let unit = |position: Vec3| ((position.as_dvec3() - least.as_dvec3()) * scale).as_vec3();
        let mut all = Self { covered: 0, shaded: 0 };
        for view in 0..6 {
            let vertex = |input: VertexInput| Vertex::new(seen(unit(positions[input.vertex as usize]), view), ());
            let (covered, shaded) = draw(vertex, indices)?;
            all.covered += covered;
            all.shaded += shaded;
        }
        Ok(all)
    }

    /// Fragments for each covered pixel: 1 at best; 0 where nothing is covered.
    pub fn ratio(&self) -> f64 {
        if self.covered == 0 { 0.0 } else { self.shaded as f64 / self.covered as f64 }
    }
}

/// A position in the unit cube as one of six views sees it. Axes are exchanged in a circle, and of each pair of views
/// the second has x and depth turned round, so that orientation is kept. Depths are up to ½, before the far plane.
fn seen(p: Vec3, view: usize) -> Vec4 {
    let [x, y, z] = [p.to_array()[view / 2], p.to_array()[(view / 2 + 1) % 3], p.to_array()[(view / 2 + 2) % 3]];
    let (x, z) = if view.is_multiple_of(2) { (x, 1.0 - z) } else { (1.0 - x, z) };
    Vec4::new(2.0 * x - 1.0, 2.0 * y - 1.0, 0.5 * z, 1.0)
}

fn draw(vertex: impl Fn(VertexInput) -> Vertex<()> + Sync, indices: &[u32]) -> Result<(u64, u64)> {
    let mut framebuffer = Framebuffer::with_depth(Extent::new(SIDE, SIDE))?;
    framebuffer.clear_depth(1.0);
    let state = State {
        depth: Some(DepthState::LESS),
        raster: RasterState { cull: Cull::Back, ..RasterState::default() },
        ..State::default()
    };
    // Count the fragments that pass the depth test in the order of the triangles, then the pixels that are covered at
    // all.
    let pipeline = Pipeline::new(Program::new(vertex, DepthOnly::new()), state, framebuffer.layout())?;
    let counters = pipeline.draw(&mut framebuffer, &Draw::indexed(indices))?;
    let depths = framebuffer.depth().map(|depth| depth.to_rows(0)).unwrap_or_default();
    Ok((depths.iter().filter(|&&depth| depth < 1.0).count() as u64, counters.samples_passed))
}
