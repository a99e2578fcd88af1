//! Dense grids, and what of a sparse tree they have room for.

use crate::{Error, Limits};
use std::ops::Range;

/// A dense grid around the active voxels of a volume.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// Name of the grid.
    pub name: String,
    /// Index of the first voxel along x, y, z.
    pub low: [i64; 3],
    /// Voxels along x, y, z: those of the box of the active voxels, and one more on each side that is zero, so that
    /// linear interpolation fades there.
    pub size: [usize; 3],
    /// Values, x fastest, z slowest. A value stands where its index is, not half a voxel further.
    pub values: Vec<f32>,
    /// Rows of the affine map from indices to the grid's world: `x' = m[0][0] x + m[0][1] y + m[0][2] z + m[0][3]`.
    pub world_from_index: [[f64; 4]; 3],
}

/// A cube of indices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cube {
    pub origin: [i64; 3],
    pub side: i64,
}

impl Cube {
    /// A child of a cube that is divided into `2^log` along each axis, z fastest.
    pub fn child(&self, n: usize, log: u32) -> Self {
        let side = self.side >> log;
        let mask = (1 << log) - 1;
        let at = [n >> (2 * log), n >> log & mask, n & mask];
        Self { origin: std::array::from_fn(|a| self.origin[a] + at[a] as i64 * side), side }
    }
}

/// Indices along x, y, z.
pub(crate) type Indices = [Range<i64>; 3];

/// Box of indices, ends included.
pub(crate) type IndexBox = [[i64; 3]; 2];

impl Volume {
    /// A grid with room for a box, of one value; the limit is checked before there is memory for it.
    pub(crate) fn new(name: &str, [low, high]: IndexBox, value: f32, limits: &Limits) -> Result<Self, Error> {
        if (0..3).any(|a| high[a] < low[a]) {
            return Err(Error::Empty(name.into()));
        }
        // Indices are of 32 bits, so that sizes and their product fit 128.
        let size = std::array::from_fn(|a| high[a] - low[a] + 3);
        let count: i128 = size.iter().map(|s: &i64| i128::from(*s)).product();
        let [x, y, z] = size;
        if count > i128::from(limits.voxels) {
            let what = format!("the {x} × {y} × {z} voxels around its grid '{name}' are more than {}", limits.voxels);
            return Err(Error::Limit(what));
        }
        let mut values = Vec::new();
        if values.try_reserve_exact(count as usize).is_err() {
            return Err(Error::Limit(format!("there is no memory for {x} × {y} × {z} voxels")));
        }
        values.resize(count as usize, 0.0);
        let mut all = Self {
            name: name.into(),
            low: low.map(|v| v - 1),
            size: size.map(|s| s as usize),
            values,
            world_from_index: [[0.0; 4]; 3],
        };
        if let Some(inner) = all.shared(&Cube { origin: low, side: 1 << 33 }).filter(|_| value != 0.0) {
            all.fill(inner, value);
        }
        Ok(all)
    }

    /// Indices that a cube shares with the box of the active voxels, which has no part in the outermost ones here.
    pub(crate) fn shared(&self, cube: &Cube) -> Option<Indices> {
        let ranges: Indices = std::array::from_fn(|a| {
            let inner = self.low[a] + 1..self.low[a] + self.size[a] as i64 - 1;
            inner.start.max(cube.origin[a])..inner.end.min(cube.origin[a] + cube.side)
        });
        ranges.iter().all(|r| !r.is_empty()).then_some(ranges)
    }

    /// The children of a cube that reach into the box, by number, where it is divided into `2^log` along each axis.
    pub(crate) fn children(&self, cube: &Cube, log: u32) -> impl Iterator<Item = (usize, Cube)> + use<> {
        let (cube, side) = (*cube, cube.side >> log);
        let steps = self.shared(&cube).map_or([0..0, 0..0, 0..0], |ranges| {
            std::array::from_fn(|a| {
                let step = |index: i64| (index - cube.origin[a]) / side;
                step(ranges[a].start)..step(ranges[a].end - 1) + 1
            })
        });
        each(steps).map(move |[x, y, z]| {
            let n = (x << (2 * log) | y << log | z) as usize;
            (n, cube.child(n, log))
        })
    }

    /// Puts one value into a part of the box.
    pub(crate) fn fill(&mut self, [xs, ys, zs]: Indices, value: f32) {
        let width = (xs.end - xs.start) as usize;
        for z in zs {
            for y in ys.clone() {
                let first = self.offset([xs.start, y, z]);
                self.values[first..first + width].fill(value);
            }
        }
    }

    /// Puts the values of a leaf of 8³ voxels, z fastest, into the part of it within the box.
    pub(crate) fn fill_leaf(&mut self, cube: &Cube, value: impl Fn(usize) -> f32) {
        for [x, y, z] in self.shared(cube).into_iter().flat_map(each) {
            let [i, j, k] = [x - cube.origin[0], y - cube.origin[1], z - cube.origin[2]];
            let at = self.offset([x, y, z]);
            self.values[at] = value((i << 6 | j << 3 | k) as usize);
        }
    }

    fn offset(&self, index: [i64; 3]) -> usize {
        let [x, y, z]: [usize; 3] = std::array::from_fn(|a| (index[a] - self.low[a]) as usize);
        (z * self.size[1] + y) * self.size[0] + x
    }
}

/// All indices of a box, z fastest.
fn each([xs, ys, zs]: Indices) -> impl Iterator<Item = [i64; 3]> {
    xs.flat_map(move |x| {
        let zs = zs.clone();
        ys.clone().flat_map(move |y| zs.clone().map(move |z| [x, y, z]))
    })
}
