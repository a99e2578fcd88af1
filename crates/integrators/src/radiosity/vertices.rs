//! Reconstruction: patches meet in vertices, whose value is the mean of the patches there; in between it is
//! interpolated. Patches share a vertex where their corners are in one place and their normals nearly the same.

use super::{cells::Cells, solution::Side, surfaces::Surfaces};
use rayon::prelude::*;
use std::collections::HashMap;
use steradian_core::Scene;
use steradian_math::{Spectrum, Vec3};

/// Corners are in one place when they are this near, relative to the extent of all.
const NEAR: f32 = 1e-5;
/// The least cosine between normals of patches that are smooth across a vertex.
const SMOOTH: f32 = 0.9;

/// Vertices at the corners of patches.
#[derive(Clone, Debug, Default)]
pub struct Vertices {
    /// For each patch the vertices of its corners, in their order.
    pub of_patch: Vec<[u32; 4]>,
    /// Number of vertices.
    pub count: usize,
}

impl Vertices {
    /// Finds them; `None` where told to stop.
    pub fn new(
        scene: &Scene,
        surfaces: &Surfaces,
        cells: &Cells,
        sides: &[Side],
        tell: &(dyn Fn(usize) -> bool + Sync),
    ) -> Option<Self> {
        // Place and oriented shading normal of every corner.
        let corners: Vec<Vec<(Vec3, Vec3)>> = sides
            .par_iter()
            .map(|patch| {
                if !tell(0) {
                    return None;
                }
                let cell = &cells.cells[patch.cell as usize];
                let piece = &surfaces.pieces[cell.piece as usize];
                let corner = |uv: &steradian_math::Vec2| {
                    let s = piece.seen(scene, *uv, patch.front);
                    let n = s.surface.ns;
                    (piece.point(*uv).as_vec3(), if n.dot(s.wo) < 0.0 { -n } else { n })
                };
                Some(cell.corners().iter().map(corner).collect())
            })
            .collect::<Option<_>>()?;
        let all = || corners.iter().flatten().map(|c| c.0);
        let (low, high) = all().fold((Vec3::MAX, Vec3::MIN), |(l, h), p| (l.min(p), h.max(p)));
        // Places are quantised: equal cells are the same place.
        let grain = ((high - low).max_element() * NEAR).max(f32::MIN_POSITIVE);
        // Off the round numbers that corners like to lie on.
        let place = |p: Vec3| ((p - low) / grain + 0.377).floor().to_array().map(|v| v as i64);
        let mut known: HashMap<[i64; 3], Vec<(Vec3, u32)>> = HashMap::new();
        let mut vertices = Self { of_patch: Vec::with_capacity(corners.len()), count: 0 };
        for corners in &corners {
            if !tell(0) {
                return None;
            }
            let mut of_patch = [0; 4];
            for (slot, (p, n)) in of_patch.iter_mut().zip(corners) {
                // A corner joins the vertex whose normal is close to its own, or begins a new one.
                let here = known.entry(place(*p)).or_default();
                *slot = match here.iter().find(|(m, _)| m.dot(*n) > SMOOTH) {
                    Some((_, index)) => *index,
                    None => {
                        here.push((*n, vertices.count as u32));
                        vertices.count += 1;
                        vertices.count as u32 - 1
                    }
                };
            }
            vertices.of_patch.push(of_patch);
        }
        Some(vertices)
    }

    /// Values at the vertices from those of the patches, by `n` bands.
    pub fn values(&self, cells: &Cells, sides: &[Side], n: usize, of_patches: &[Spectrum]) -> Vec<Spectrum> {
        let mut sums = vec![Spectrum::ZERO; self.count * n];
        let mut weights = vec![0.0_f32; self.count];
        // The mean of the patches that meet in a vertex.
        for (i, patch) in sides.iter().enumerate() {
            let corners = cells.cells[patch.cell as usize].corners().len();
            for &vertex in &self.of_patch[i][..corners] {
                weights[vertex as usize] += 1.0;
                for b in 0..n {
                    sums[vertex as usize * n + b] += of_patches[i * n + b];
                }
            }
        }
        sums.iter().enumerate().map(|(k, s)| *s / weights[k / n].max(1.0)).collect()
    }
}
