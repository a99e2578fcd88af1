//! A solved scene: irradiance on every patch, looked up where a ray meets a surface.

use super::{
    bands::Bands,
    cells::Cells,
    direct::sharp_lights,
    patches::{NONE, Patches},
    surfaces::Surfaces,
    vertices::Vertices,
};
use glam::DVec4;
use steradian_core::{Scene, scene::Interaction};
use steradian_math::{Spectrum, spectra::Wavelengths};

/// The side of a leaf that a patch is.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The leaf.
    pub cell: u32,
    /// True for the side that the normal points to.
    pub front: bool,
}

/// Light on the patches; values are by patch and band.
#[derive(Clone, Debug, Default)]
pub struct Light {
    /// The patches, by leaf.
    pub sides: Vec<Side>,
    /// Irradiance from all light but lights without extent; W/m².
    pub irradiance: Vec<Spectrum>,
    /// Radiosity without what is emitted; W/m².
    pub reflected: Vec<Spectrum>,
}

/// A solved scene.
#[derive(Clone, Debug)]
pub struct Solution {
    pub(super) surfaces: Surfaces,
    pub(super) cells: Cells,
    pub(super) bands: Bands,
    pub(super) light: Light,
    /// For each cell the patches on its front and its back.
    of_cell: Vec<[u32; 2]>,
    vertices: Vertices,
    /// Irradiance at vertices, by band.
    at_vertices: Vec<Spectrum>,
    /// Lights without extent, which are asked for at every point that is seen.
    pub(super) sharp_lights: Vec<u32>,
    /// Report of the solver.
    pub report: Report,
}

/// Statistics of a solution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Number of patches.
    pub patches: usize,
    /// Number of clusters of patches that share their irradiance, where there are more pieces of surface than patches
    /// were asked for.
    pub clusters: Option<usize>,
    /// Iterations, shots, rounds or runs.
    pub steps: usize,
    /// The last relative change, or the share of light that was not shot.
    pub residual: f64,
    /// Form factors that are kept, or links.
    pub factors: usize,
    /// Rays traced.
    pub rays: u64,
    /// Names of materials of which the Lambertian part takes part alone.
    pub impure: Vec<String>,
    /// Kinds of shapes that take no part but in casting shadows.
    pub left_out: Vec<String>,
}

impl Light {
    /// From the irradiance that patches exchange.
    pub(super) fn new(patches: &Patches, exchanged: &[DVec4]) -> Self {
        // Light that may be interpolated, and all light.
        let smooth: Vec<DVec4> = exchanged.iter().zip(&patches.sky).map(|(a, b)| *a + *b).collect();
        let total: Vec<DVec4> = smooth.iter().zip(&patches.sharp).map(|(a, b)| *a + *b).collect();
        let n = patches.bands;
        let single = |v: DVec4| Spectrum(v.as_vec4());
        // ρ H + τ H' of the mean irradiance.
        let reflected = |k: usize| {
            let through = match patches.list[k / n].twin {
                NONE => DVec4::ZERO,
                twin => total[twin as usize * n + k % n],
            };
            single(patches.reflectance[k] * total[k] + patches.transmittance[k] * through)
        };
        Self {
            sides: patches.list.iter().map(|p| Side { cell: p.cell, front: p.front }).collect(),
            irradiance: smooth.iter().map(|v| single(*v)).collect(),
            reflected: (0..total.len()).map(reflected).collect(),
        }
    }
}

impl Solution {
    /// Makes what is looked up; `None` where told to stop.
    pub(super) fn new(
        scene: &Scene,
        surfaces: Surfaces,
        cells: Cells,
        bands: Bands,
        light: Light,
        report: Report,
        tell: &(dyn Fn(usize) -> bool + Sync),
    ) -> Option<Self> {
        // Vertices for interpolation, and an index from sides of leaves to patches.
        let vertices = Vertices::new(scene, &surfaces, &cells, &light.sides, tell)?;
        let at_vertices = vertices.values(&cells, &light.sides, bands.count(), &light.irradiance);
        let mut of_cell = vec![[NONE; 2]; cells.cells.len()];
        for (k, side) in light.sides.iter().enumerate() {
            of_cell[side.cell as usize][usize::from(!side.front)] = k as u32;
        }
        let sharp_lights = sharp_lights(scene);
        Some(Self { surfaces, cells, bands, light, of_cell, vertices, at_vertices, sharp_lights, report })
    }

    /// The patch on a side of a cell, or [`NONE`].
    fn of(&self, cell: u32, front: bool) -> u32 {
        self.of_cell[cell as usize][usize::from(!front)]
    }

    /// The patch on the side that a surface is seen from (`front`), or on the other, and the weights of its corners.
    fn patch(&self, i: &Interaction, front: bool) -> Option<(usize, [f32; 4])> {
        // From the hit to a piece, to the leaf that holds its parameters, to the patch on the side.
        let (piece, uv) = self.surfaces.locate(i).or_else(|| self.surfaces.nearest_on_plane(i))?;
        let cell = self.cells.find(piece, uv);
        let patch = self.of(cell, front);
        (patch != NONE).then(|| (patch as usize, self.cells.cells[cell as usize].weights(uv)))
    }

    /// Irradiance on a side of a surface from all but lights without extent; W/m². Zero where the side scatters
    /// nothing.
    pub fn irradiance(&self, i: &Interaction, front: bool, smooth: bool, lambda: &Wavelengths) -> Spectrum {
        let Some((patch, weights)) = self.patch(i, front) else { return Spectrum::ZERO };
        let n = self.bands.count();
        // The patch's own value, or that of its corners with the weights of the point.
        if !smooth {
            return self.bands.at(&self.light.irradiance[patch * n..(patch + 1) * n], lambda);
        }
        let mut sum = Spectrum::ZERO;
        for (vertex, w) in self.vertices.of_patch[patch].iter().zip(weights) {
            if w > 0.0 {
                let k = *vertex as usize * n;
                sum += self.bands.at(&self.at_vertices[k..k + n], lambda) * w;
            }
        }
        sum
    }

    /// Radiosity of what a side of a surface reflects and transmits, the mean over its patch; W/m².
    pub fn reflected(&self, i: &Interaction, front: bool, lambda: &Wavelengths) -> Spectrum {
        let Some((patch, _)) = self.patch(i, front) else { return Spectrum::ZERO };
        let n = self.bands.count();
        self.bands.at(&self.light.reflected[patch * n..(patch + 1) * n], lambda)
    }

    /// Refinement need of each leaf: the largest difference between its irradiance and that of its corners, times its
    /// area, for the sides together.
    pub(super) fn needs(&self) -> Vec<f32> {
        let n = self.bands.count();
        let of = |cell: u32, front: bool| {
            let patch = self.of(cell, front);
            if patch == NONE {
                return 0.0;
            }
            let own = &self.light.irradiance[patch as usize * n..][..n];
            let leaf = &self.cells.cells[cell as usize];
            // Greatest difference between patch and corner over all bands.
            let differs = |vertex: &u32| {
                let there = &self.at_vertices[*vertex as usize * n..][..n];
                own.iter().zip(there).map(|(a, b)| (*a - *b).0.abs().max_element()).fold(0.0, f32::max)
            };
            let corners = &self.vertices.of_patch[patch as usize][..leaf.corners().len()];
            corners.iter().map(differs).fold(0.0, f32::max) * leaf.area
        };
        self.cells.leaves().map(|cell| of(cell, true) + of(cell, false)).collect()
    }

    /// The patches: area (m²), irradiance from all but lights without extent, and reflected radiosity (W/m²) by band.
    pub fn patches(&self) -> impl Iterator<Item = (f64, &[Spectrum], &[Spectrum])> {
        let n = self.bands.count();
        let all = self.light.sides.iter().zip(self.light.irradiance.chunks(n)).zip(self.light.reflected.chunks(n));
        all.map(|((p, h), r)| (f64::from(self.cells.cells[p.cell as usize].area), h, r))
    }
}
