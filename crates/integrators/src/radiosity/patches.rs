//! The unknowns: the sides of leaves that reflect, transmit or emit light.

use super::{
    bands::Bands,
    cells::Cells,
    direct,
    matter::{self, Matter},
    polygon::Polygon,
    surfaces::Surfaces,
};
use glam::DVec4;
use rayon::prelude::*;
use steradian_core::Scene;
use steradian_math::{Spectrum, Vec2, Vec3};

/// Marks sides that are no unknowns.
pub const NONE: u32 = u32::MAX;
/// Points of a patch that are looked from.
pub const POINTS: usize = 16;

/// A point of a patch.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Position.
    pub p: Vec3,
    /// Half size of a box around it that holds the surface.
    pub error: Vec3,
    /// Unit normal of the side.
    pub n: Vec3,
}

/// A side of a leaf.
#[derive(Clone, Debug)]
pub struct Patch {
    /// The leaf.
    pub cell: u32,
    /// True for the side that the normal points to.
    pub front: bool,
    /// Its polygon, as seen from the side.
    pub polygon: Polygon,
    /// Area, m².
    pub area: f64,
    /// The patch on the other side, or [`NONE`].
    pub twin: u32,
    /// Points of the surface, stratified.
    pub points: Vec<Point>,
}

/// All patches, with what they are made of.
#[derive(Clone, Debug, Default)]
pub struct Patches {
    /// The patches.
    pub list: Vec<Patch>,
    /// For each cell the patches on its front and its back.
    of_cell: Vec<[u32; 2]>,
    /// Number of bands.
    pub bands: usize,
    /// Reflectance, by patch and band.
    pub reflectance: Vec<DVec4>,
    /// Transmittance, by patch and band.
    pub transmittance: Vec<DVec4>,
    /// Emitted radiosity, by patch and band; W/m².
    pub emission: Vec<DVec4>,
    /// Irradiance from lights without extent, by patch and band; W/m².
    pub sharp: Vec<DVec4>,
    /// Irradiance from environments, by patch and band; W/m².
    pub sky: Vec<DVec4>,
    /// Indices of materials that scatter otherwise than Lambert.
    pub impure: Vec<u32>,
}

fn lanes(s: Spectrum) -> DVec4 {
    s.0.as_dvec4()
}

impl Patches {
    /// The patches of the leaves; `None` where told to stop.
    pub fn new(
        scene: &Scene,
        surfaces: &Surfaces,
        cells: &Cells,
        bands: &Bands,
        tell: &(dyn Fn(usize) -> bool + Sync),
    ) -> Option<Self> {
        // Both sides of all leaves, in parallel; sides that neither scatter nor emit are no patches.
        let leaves: Vec<u32> = cells.leaves().collect();
        let sides: Vec<[Made; 2]> = leaves
            .par_iter()
            .map(|&k| tell(0).then(|| [true, false].map(|front| make(scene, surfaces, cells, bands, k, front))))
            .collect::<Option<_>>()?;
        let mut all = Self { bands: bands.count(), of_cell: vec![[NONE; 2]; cells.cells.len()], ..Self::default() };
        for (leaf, sides) in leaves.iter().zip(sides) {
            let mut twins = [NONE; 2];
            for (side, made) in sides.into_iter().enumerate() {
                if !made.is_pure {
                    let piece = &surfaces.pieces[cells.cells[*leaf as usize].piece as usize];
                    all.impure.push(scene.geometries()[piece.geometry as usize].material);
                }
                let Some((patch, matter)) = made.patch else { continue };
                let index = all.list.len() as u32;
                twins[side] = index;
                all.list.push(patch);
                for m in matter {
                    all.reflectance.push(lanes(m.reflectance));
                    all.transmittance.push(lanes(m.transmittance));
                    all.emission.push(lanes(m.emission));
                }
            }
            // Both sides of a leaf know each other, for transmission.
            all.of_cell[*leaf as usize] = twins;
            for (side, index) in twins.iter().enumerate() {
                if *index != NONE {
                    all.list[*index as usize].twin = twins[1 - side];
                }
            }
        }
        all.impure.sort_unstable();
        all.impure.dedup();
        // Irradiance from lights that are no patches.
        all.sharp = direct::irradiance(scene, &all.list, bands, true, tell);
        all.sky = direct::irradiance(scene, &all.list, bands, false, tell);
        tell(0).then_some(all)
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// The patch on a side of a cell, or [`NONE`].
    #[inline]
    pub fn of(&self, cell: u32, front: bool) -> u32 {
        self.of_cell[cell as usize][usize::from(!front)]
    }

    /// Radiosity of light that was not reflected among patches: emitted, and reflected and transmitted from lights that
    /// are no patches.
    pub fn sources(&self) -> Vec<DVec4> {
        // S = E + ρ H_direct + τ H_direct'.
        let direct = |k: usize| self.sharp[k] + self.sky[k];
        let twins = |i: usize, b: usize| match self.list[i].twin {
            NONE => DVec4::ZERO,
            twin => direct(twin as usize * self.bands + b),
        };
        (0..self.len() * self.bands)
            .map(|k| {
                let (i, b) = (k / self.bands, k % self.bands);
                self.emission[k] + self.reflectance[k] * direct(k) + self.transmittance[k] * twins(i, b)
            })
            .collect()
    }
}

/// A side of a cell.
pub struct Made {
    /// The patch, and what it is made of by band; `None` for sides that neither scatter nor emit as Lambert has it, and
    /// those without area.
    pub patch: Option<(Patch, Vec<Matter>)>,
    /// True if it scatters as Lambert has it and in no other way.
    pub is_pure: bool,
}

/// A side of a cell, with what it is made of.
pub fn make(scene: &Scene, surfaces: &Surfaces, cells: &Cells, bands: &Bands, k: u32, front: bool) -> Made {
    let cell = &cells.cells[k as usize];
    let piece = &surfaces.pieces[cell.piece as usize];
    let (matter, is_pure) = matter::of_cell(scene, piece, cell, front, bands);
    let is_black = |m: &Matter| m.reflectance.is_black() && m.transmittance.is_black() && m.emission.is_black();
    if matter.iter().all(is_black) {
        return Made { patch: None, is_pure };
    }
    // The back has the polygon in reverse.
    let polygon = cell.polygon(&surfaces.pieces);
    let polygon = if front { polygon } else { polygon.reversed() };
    let area = polygon.area();
    if !(area > 0.0 && area.is_finite()) {
        return Made { patch: None, is_pure };
    }
    // Stratified points with their error bounds, for visibility and light samples.
    let points = (0..POINTS as u32)
        .map(|j| {
            let u = Vec2::from(steradian_math::sobol::shuffled_scrambled_sobol_2d(j, k ^ 0x2f6b_93a1));
            let s = piece.seen(scene, cell.at(u), front);
            Point { p: s.surface.p, error: s.surface.error, n: s.wo }
        })
        .collect();
    Made { patch: Some((Patch { cell: k, front, polygon, area, twin: NONE, points }, matter)), is_pure }
}
