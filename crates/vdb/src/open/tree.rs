//! The tree of a grid: a root's lists of tiles and children, nodes of 32³, nodes of 16³, leaves of 8³ voxels.
//!
//! All nodes come first, depth first, with masks and the values of their tiles, then the values of all leaves. Nodes
//! are walked twice: for the box of what is active, and for the tiles.

use super::values::Values;
use crate::{
    Error, Limits, Volume,
    bytes::bit,
    dense::{Cube, IndexBox},
};
use std::collections::HashSet;

/// Logarithms of the children of nodes along each axis, from the root to the leaves.
const NODES: [u32; 2] = [5, 4];
/// Side of the children of the root.
const SIDE: i64 = 4096;
/// Bytes of the mask of a leaf.
const LEAF_MASK: u64 = 64;

/// Purpose of a walk.
trait Visitor {
    /// True if it asks for the values of tiles.
    const VALUES: bool;
    fn tile(&mut self, cube: &Cube, value: f32, is_active: bool);
    fn leaf(&mut self, cube: &Cube, active: &[u8]);
}

/// Box of the active voxels, and the leaves in their order.
struct Outline {
    around: IndexBox,
    leaves: Vec<Cube>,
}

impl Outline {
    fn add(&mut self, cube: &Cube) {
        for a in 0..3 {
            self.around[0][a] = self.around[0][a].min(cube.origin[a]);
            self.around[1][a] = self.around[1][a].max(cube.origin[a] + cube.side - 1);
        }
    }
}

impl Visitor for Outline {
    const VALUES: bool = false;

    fn tile(&mut self, cube: &Cube, _: f32, is_active: bool) {
        if is_active {
            self.add(cube);
        }
    }

    fn leaf(&mut self, cube: &Cube, active: &[u8]) {
        self.leaves.push(*cube);
        (0..512).filter(|n| bit(active, *n)).for_each(|n| self.add(&cube.child(n, 3)));
    }
}

impl Visitor for Volume {
    const VALUES: bool = true;

    fn tile(&mut self, cube: &Cube, value: f32, _: bool) {
        if let Some(part) = self.shared(cube) {
            self.fill(part, value);
        }
    }

    fn leaf(&mut self, _: &Cube, _: &[u8]) {}
}

/// The dense grid of a tree.
pub(super) fn dense(mut values: Values, name: &str, limits: &Limits) -> Result<Volume, Error> {
    // Count of buffers, which is one.
    values.stream.u32()?;
    values.background = values.stream.f32()?;
    let mut outline = Outline { around: [[i64::MAX; 3], [i64::MIN; 3]], leaves: Vec::new() };
    root(&mut values.clone(), &mut outline)?;
    let mut all = Volume::new(name, outline.around, values.background, limits)?;
    root(&mut values, &mut all)?;
    for cube in &outline.leaves {
        let active = values.stream.take(LEAF_MASK)?;
        let is_wanted = all.shared(cube).is_some();
        let leaf = values.node(active, is_wanted)?;
        all.fill_leaf(cube, |n| leaf[n]);
    }
    Ok(all)
}

/// Walks the root. Its parts are held to stand at distinct multiples of their side, so that no index belongs to two.
fn root(values: &mut Values, visitor: &mut impl Visitor) -> Result<(), Error> {
    let (tiles, children) = (values.stream.u32()?, values.stream.u32()?);
    let mut seen = HashSet::new();
    let mut cube = |values: &mut Values| {
        let [x, y, z] = [values.stream.i32()?, values.stream.i32()?, values.stream.i32()?].map(i64::from);
        let origin = [x, y, z];
        if origin.iter().any(|v| v % SIDE != 0) || !seen.insert(origin) {
            return Err(Error::Malformed(format!("its grid has a part at {x}, {y}, {z} that overlaps others")));
        }
        Ok(Cube { origin, side: SIDE })
    };
    for _ in 0..tiles {
        let cube = cube(values)?;
        let (value, is_active) = (values.stream.f32()?, values.stream.u8()? != 0);
        visitor.tile(&cube, value, is_active);
    }
    for _ in 0..children {
        let cube = cube(values)?;
        node(values, &cube, 0, visitor)?;
    }
    Ok(())
}

/// Walks a node.
fn node<V: Visitor>(values: &mut Values, cube: &Cube, level: usize, visitor: &mut V) -> Result<(), Error> {
    let Some(log) = NODES.get(level).copied() else {
        visitor.leaf(cube, values.stream.take(LEAF_MASK)?);
        return Ok(());
    };
    let count = 1_usize << (3 * log);
    let (children, active) = (values.stream.take(count as u64 / 8)?, values.stream.take(count as u64 / 8)?);
    let tiles = values.node(active, V::VALUES)?;
    for n in 0..count {
        let part = cube.child(n, log);
        if bit(children, n) {
            node(values, &part, level + 1, visitor)?;
        } else {
            visitor.tile(&part, tiles.get(n).copied().unwrap_or_default(), bit(active, n));
        }
    }
    Ok(())
}
