//! Media whose densities and temperatures are grids of volume files.

use super::Compiler;
use std::path::Path;
use steradian_core::medium::{Field, Glow, Grid, Medium, Variation};
use steradian_image::read_regular;
use steradian_math::{Bounds3, Transform, Vec3, transform::Affine};
use steradian_scene::Node;
use steradian_texture::Wrap;
use steradian_vdb::{Error, Limits, Volume};

/// Voxels of one grid, as of the grids that descriptions spell out.
const MOST_VOXELS: u64 = 1 << 28;

impl Compiler<'_> {
    /// A medium of a volume file: coefficients times a density, and black bodies where there is a grid of temperatures.
    pub(super) fn volume_file(&mut self, node: &Node) -> Option<Medium> {
        let span = node.param("file").and_then(|p| p.span).or(node.span);
        let Some(path) = node.path("file") else {
            self.error(span, "medium 'vdb' needs a file");
            return None;
        };
        let limits = Limits { voxels: MOST_VOXELS, bytes: self.options.image_limits.bytes };
        let name = self.word(node, "grid").to_owned();
        let fault = |e: &dyn std::fmt::Display| format!("cannot use '{}': {e}", path.display());
        let bytes = self.volume_bytes(path, limits.bytes).map_err(|e| self.error(span, fault(&e))).ok()?;
        let density = steradian_vdb::read(&bytes, &name, &limits).map_err(|e| self.error(span, fault(&e))).ok()?;
        let to_world = self.transform(node, "to_world");
        let (bounds, density_place) = box_of(&density);
        let placed = to_world * density_place;
        let Some((place, variation)) = placed.affine().zip(self.numbers(node, density)) else {
            self.error(node.span, "the transform of this medium, with that of its file, is singular or not finite");
            return None;
        };
        let mut base = self.homogeneous(node);
        // Files without temperatures do not glow; that is worth a word where they were asked for.
        let name = self.word(node, "temperature_grid").to_owned();
        match steradian_vdb::read(&bytes, &name, &limits) {
            Ok(heat) => base.glow = self.heat(node, heat, (&bounds, &density_place)),
            Err(Error::NoGrid { .. } | Error::Empty(_)) if node.get("temperature_grid").is_none() => {}
            Err(e) => {
                let what = format!("{}; the medium does not glow", fault(&e));
                self.diagnostics.warn(&self.desc.sources, span, what);
            }
        }
        let Some(field) = Field::new(&bounds, &place, Variation::Density(variation), self.mode) else {
            self.error(node.span, "the box of this medium has no volume");
            return None;
        };
        Some(Medium { field: Some(field.into()), ..base })
    }

    fn volume_bytes(&self, path: &Path, most: u64) -> Result<Vec<u8>, String> {
        match self.desc.embedded.get(path) {
            Some(bytes) => Ok(bytes.to_vec()),
            None => read_regular(path, most).map_err(|e| e.to_string()),
        }
    }

    /// The numbers of a volume. Values that are not finite count as zero.
    fn numbers(&mut self, node: &Node, mut volume: Volume) -> Option<Grid> {
        let faults = volume.values.iter_mut().filter(|v| !v.is_finite()).map(|v| *v = 0.0).count();
        if faults > 0 {
            let what = format!("{faults} values of grid '{}' are infinite or NaN; they count as zero", volume.name);
            self.diagnostics.warn(&self.desc.sources, node.span, what);
        }
        Grid::new(volume.size, volume.values, Wrap::Border)
    }

    /// Emission by a grid of temperatures, which has a box and a map of its own.
    fn heat(&mut self, node: &Node, volume: Volume, (bounds, place): (&Bounds3, &Transform)) -> Option<Glow> {
        let factor = self.float(node, "Lescale").max(0.0);
        let (own_bounds, own_place) = box_of(&volume);
        let mut grid = self.numbers(node, volume)?;
        // From the cube of the densities over the file's world into the cube of the temperatures.
        let from_cube = unit_cube(&own_bounds) * own_place.inverse()? * *place * unit_cube(bounds).inverse()?;
        grid.from_cube = from_cube.affine().filter(|map| map.m != Affine::IDENTITY.m);
        Some(Glow { source: self.black_bodies(node, grid, factor), scale: None })
    }
}

/// The box around the voxels of a volume, counted from the first of them, and the map from there to the file's world.
fn box_of(volume: &Volume) -> (Bounds3, Transform) {
    let [x, y, z] = volume.world_from_index;
    let map = Transform::from_rows([x, y, z, [0.0, 0.0, 0.0, 1.0]].concat().try_into().unwrap_or_default());
    // Numbers stand where their index is: cells begin half a voxel before.
    let first = volume.low.map(|v| v as f64 - 0.5);
    let bounds = Bounds3 { min: Vec3::ZERO, max: Vec3::from_array(volume.size.map(|s| s as f32)) };
    (bounds, map * Transform::translate(first.into()))
}

/// The map of a box to the unit cube.
fn unit_cube(bounds: &Bounds3) -> Transform {
    let size = (bounds.max - bounds.min).as_dvec3();
    Transform::scale(size.recip()) * Transform::translate(-bounds.min.as_dvec3())
}
