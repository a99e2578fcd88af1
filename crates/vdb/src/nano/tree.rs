//! The tree of a grid: a root's table, nodes of 32³, nodes of 16³, leaves of 8³ voxels.
//!
//! Children stand at offsets from their parents, which may be anywhere in the grid. The keys of the root are held to be
//! distinct, so that no index belongs to two children.

use super::file::GRID_SIZE;
use crate::{
    Error, Limits, Volume,
    bytes::{Bytes, bit},
    dense::Cube,
};
use std::collections::HashSet;

/// Encoding of the values of leaves.
pub(super) enum Leaves {
    /// 32 bits each.
    Plain,
    /// Multiples of a step above the least, in so many bits each.
    Codes(u32),
    /// As before; each leaf has its count of bits.
    AnyCodes,
}

impl Leaves {
    /// The encoding of a type of grid, else a name for what it has.
    pub fn of(kind: u32) -> Result<Self, String> {
        Ok(match kind {
            1 => Self::Plain,
            13 => Self::Codes(4),
            14 => Self::Codes(8),
            15 => Self::Codes(16),
            16 => Self::AnyCodes,
            2 => return Err("numbers of 64 bits".into()),
            6 => return Err("vectors".into()),
            7 => return Err("vectors of 64 bits".into()),
            3..=5 | 21 => return Err("integers".into()),
            8 | 12 => return Err("masks".into()),
            9 => return Err("numbers of 16 bits".into()),
            17 | 18 | 23 | 24 => return Err("vectors of four".into()),
            19 | 20 => return Err("indices".into()),
            other => return Err(format!("type {other}")),
        })
    }

    /// Copies what of a leaf lies in the box.
    fn copy(&self, grid: &Bytes, at: u64, cube: &Cube, all: &mut Volume) -> Result<(), Error> {
        let bits = match self {
            Self::Plain => {
                let values = grid.part(at, 96 + 4 * 512)?.split_at(96).1;
                let value = |n: usize| f32::from_le_bytes(std::array::from_fn(|i| values[4 * n + i]));
                all.fill_leaf(cube, value);
                return Ok(());
            }
            Self::Codes(bits) => *bits,
            // The logarithm stands in the highest bits of the flags.
            Self::AnyCodes => 1 << (grid.part(at + 15, 1)?[0] >> 5).min(4),
        } as usize;
        let (least, step) = (grid.f32(at + 80)?, grid.f32(at + 84)?);
        let codes = grid.part(at, 96 + 64 * bits as u64)?.split_at(96).1;
        let value = |n: usize| {
            let code = match bits {
                16 => u32::from(u16::from_le_bytes([codes[2 * n], codes[2 * n + 1]])),
                _ => u32::from(codes[n * bits / 8]) >> (n * bits % 8) & ((1 << bits) - 1),
            };
            code as f32 * step + least
        };
        all.fill_leaf(cube, value);
        Ok(())
    }
}

/// Node with a table of children and tiles.
struct Kind {
    /// Logarithm of the children along each axis.
    log: u32,
    /// Offset of the mask of children, and that of the table of 8 bytes for each.
    mask: u64,
    table: u64,
}

const NODES: [Kind; 2] = [Kind { log: 5, mask: 4128, table: 8256 }, Kind { log: 4, mask: 544, table: 1088 }];

/// The dense grid of a tree.
pub(super) fn dense(grid: &Bytes, leaves: &Leaves, name: &str, limits: &Limits) -> Result<Volume, Error> {
    let root = within(GRID_SIZE, grid.u64(GRID_SIZE + 24)? as i64)?;
    // An empty tree has no root.
    let corner = |at: u64| -> Result<[i64; 3], Error> {
        let [x, y, z] = [0, 4, 8].map(|i| grid.i32(root + at + i).map(i64::from));
        Ok([x?, y?, z?])
    };
    let mut all = Volume::new(name, [corner(0)?, corner(12)?], grid.f32(root + 28)?, limits)?;
    let mut seen = HashSet::new();
    for i in 0..u64::from(grid.u32(root + 24)?) {
        let tile = root + 64 + 32 * i;
        let (key, child) = (grid.u64(tile)?, grid.u64(tile + 8)? as i64);
        if !seen.insert(key) {
            return Err(Error::Malformed(format!("its grid '{name}' has two parts at one place")));
        }
        // Keys have 21 bits for each axis, x highest, of which the lower 20 count.
        let axis = |shift: u32| i64::from(((key >> shift) as u32 & 0x1f_ffff).wrapping_shl(12) as i32);
        let cube = Cube { origin: [axis(42), axis(21), axis(0)], side: 4096 };
        if child != 0 {
            node(grid, leaves, within(root, child)?, &cube, 0, &mut all)?;
        } else if let Some(part) = all.shared(&cube) {
            all.fill(part, grid.f32(tile + 20)?);
        }
    }
    Ok(all)
}

/// A place at an offset.
fn within(at: u64, offset: i64) -> Result<u64, Error> {
    at.checked_add_signed(offset).filter(|at| *at < u64::MAX / 2).ok_or(Error::Short("its grid"))
}

/// Copies what of a node lies in the box.
fn node(grid: &Bytes, leaves: &Leaves, at: u64, cube: &Cube, level: usize, all: &mut Volume) -> Result<(), Error> {
    let Some(kind) = NODES.get(level) else { return leaves.copy(grid, at, cube, all) };
    let count = 1_u64 << (3 * kind.log);
    let mask = grid.part(at + kind.mask, count / 8)?;
    for (n, part) in all.children(cube, kind.log) {
        let entry = at + kind.table + 8 * n as u64;
        if bit(mask, n) {
            node(grid, leaves, within(at, grid.u64(entry)? as i64)?, &part, level + 1, all)?;
        } else if let Some(shared) = all.shared(&part) {
            all.fill(shared, grid.f32(entry)?);
        }
    }
    Ok(())
}
