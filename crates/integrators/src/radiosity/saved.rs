//! Solutions in files: which cells were split, which sides of leaves are patches, and the light on them. Pieces of
//! surface are made of the scene again; the caller sees to it that it is the same scene.

use super::{
    bands::Bands,
    cells::Cells,
    solution::{Light, Report, Side, Solution},
    surfaces::{Refusal, Surfaces},
};
use glam::DVec3;
use std::io::{self, Read, Write};
use steradian_core::Scene;
use steradian_math::Spectrum;

/// Reason why a file is no solution of a scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The system's answer.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// Content that does not fit the scene.
    #[error("does not fit this scene: it has {0}")]
    OtherScene(&'static str),
    /// The scene is none for radiosity.
    #[error("{0}")]
    Refused(#[from] Refusal),
}

impl Solution {
    /// Writes it.
    ///
    /// # Errors
    /// Those of writing.
    pub fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        // Header: sizes, and the eye that planes were cut from. Then splits, sides and light.
        let mut number = |v: u64| out.write_all(&v.to_le_bytes());
        number(self.surfaces.pieces.len() as u64)?;
        self.surfaces.eye.to_array().iter().try_for_each(|v| number(v.to_bits()))?;
        number(self.bands.count() as u64)?;
        number(self.cells.splits.len() as u64)?;
        number(self.light.sides.len() as u64)?;
        self.cells.splits.iter().try_for_each(|k| out.write_all(&k.to_le_bytes()))?;
        let side = |s: &Side| s.cell << 1 | u32::from(s.front);
        self.light.sides.iter().try_for_each(|s| out.write_all(&side(s).to_le_bytes()))?;
        for values in [&self.light.irradiance, &self.light.reflected] {
            for v in values.iter().flat_map(|v| v.to_array()) {
                out.write_all(&v.to_le_bytes())?;
            }
        }
        Ok(())
    }

    /// Reads what [`Solution::save`] wrote; `length` bytes are there at most.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn load(scene: &Scene, from: &mut dyn Read, length: u64) -> Result<Self, LoadError> {
        let mut number = || -> io::Result<u64> {
            let mut bytes = [0; 8];
            from.read_exact(&mut bytes)?;
            Ok(u64::from_le_bytes(bytes))
        };
        let pieces = number()?;
        let eye = DVec3::new(f64::from_bits(number()?), f64::from_bits(number()?), f64::from_bits(number()?));
        let (bands, splits, sides) = (number()?, number()?, number()?);
        // Sizes are held against the length of the file before anything is allocated.
        let fits = |count: u64, bytes: u64| count.checked_mul(bytes).is_some_and(|b| b <= length);
        if !(eye.is_finite() && fits(splits, 4) && fits(sides, 4) && bands <= 256 && fits(sides, 32 * bands)) {
            return Err(LoadError::OtherScene("more than the file holds"));
        }
        let surfaces = Surfaces::seen_from(scene, eye)?;
        let of_scene = Bands::new(scene.mode(), bands as usize);
        if surfaces.pieces.len() as u64 != pieces {
            return Err(LoadError::OtherScene("other surfaces"));
        }
        if of_scene.count() as u64 != bands {
            return Err(LoadError::OtherScene("other colours"));
        }
        let mut word = || -> io::Result<[u8; 4]> {
            let mut bytes = [0; 4];
            from.read_exact(&mut bytes)?;
            Ok(bytes)
        };
        // Splits are made again in their order; each must be of a leaf.
        let mut cells = Cells::new(&surfaces);
        for _ in 0..splits {
            let cell = u32::from_le_bytes(word()?);
            if !cells.cells.get(cell as usize).is_some_and(|c| c.is_leaf()) {
                return Err(LoadError::OtherScene("other patches"));
            }
            cells.split(&surfaces.pieces, cell);
        }
        let mut light = Light::default();
        for _ in 0..sides {
            let side = u32::from_le_bytes(word()?);
            let side = Side { cell: side >> 1, front: side & 1 == 1 };
            if !cells.cells.get(side.cell as usize).is_some_and(|c| c.is_leaf()) {
                return Err(LoadError::OtherScene("other patches"));
            }
            light.sides.push(side);
        }
        // Light: four lanes for each side and band, all finite.
        for values in [&mut light.irradiance, &mut light.reflected] {
            for _ in 0..sides * bands {
                let mut lanes = [0.0; 4];
                for lane in &mut lanes {
                    *lane = f32::from_le_bytes(word()?);
                }
                if !lanes.iter().all(|lane| lane.is_finite()) {
                    return Err(LoadError::OtherScene("light that is no number"));
                }
                values.push(Spectrum::new(lanes));
            }
        }
        let report = Report { patches: sides as usize, ..Report::default() };
        let solution = Self::new(scene, surfaces, cells, of_scene, light, report, &|_| true);
        solution.ok_or(LoadError::OtherScene("other patches"))
    }
}
