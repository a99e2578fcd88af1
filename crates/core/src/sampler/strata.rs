//! Jittered strata: one point in each cell of a grid, in random order.
//!
//! Both samplers know how many samples there will be; further ones are a set of their own.

use super::permute::permute;
use steradian_math::{
    Vec2,
    hash::{ONE_MINUS_EPSILON, combine32, unit_f32},
};

/// A jittered point of one of `n` strata of the unit interval.
fn stratum_point(stratum: u32, n: u32, jitter: u32) -> f32 {
    ((stratum as f32 + unit_f32(jitter)) / n as f32).min(ONE_MINUS_EPSILON)
}

/// Columns and rows of the grid for `n` samples, nearly square, with at least as many cells.
fn grid(n: u32) -> [u32; 2] {
    // Nearly square grid with at least n cells.
    let columns = n.isqrt().max(1);
    [columns, n.div_ceil(columns)]
}

/// The seed of the set that an index belongs to, and the place in it.
fn set(index: u32, n: u32, seed: u32) -> (u32, u32) {
    (combine32(seed, index / n), index % n)
}

/// One of `n` strata.
pub(super) fn stratified_1d(index: u32, n: u32, seed: u32) -> f32 {
    // Take the strata in a random order, jittered within.
    let (seed, at) = set(index, n, seed);
    stratum_point(permute(at, n, seed), n, combine32(seed, at ^ 0x68bc_21eb))
}

/// A cell of the grid.
pub(super) fn stratified_2d(index: u32, n: u32, seed: u32) -> Vec2 {
    let (seed, at) = set(index, n, seed);
    let [columns, rows] = grid(n);
    // Permute the cells, so that any prefix is a random subset.
    let cell = permute(at, columns * rows, seed);
    let (a, b) = (combine32(seed, at ^ 0x68bc_21eb), combine32(seed, at ^ 0x02e5_be93));
    Vec2::new(stratum_point(cell % columns, columns, a), stratum_point(cell / columns, rows, b))
}

/// Correlated multi-jittering: a cell of the grid, within which the point lies in the row and column of finer strata of
/// which each has one point too; cells of a row share the order of columns, and the reverse (Kensler 2013, "Correlated
/// Multi-Jittered Sampling").
pub(super) fn multijitter_2d(index: u32, n: u32, seed: u32) -> Vec2 {
    let (seed, at) = set(index, n, seed);
    let [columns, rows] = grid(n);
    let cell = permute(at, columns * rows, seed ^ 0x51_63_3e_2d);
    let (x, y) = (cell % columns, cell / columns);
    // Sub-strata: a row shares the order of its columns, a column that of its rows.
    let fine_x = permute(y, rows, combine32(seed, 0x02e5_be93));
    let fine_y = permute(x, columns, combine32(seed, 0x68bc_21eb));
    let jitter = |salt: u32| combine32(combine32(seed, salt), cell);
    let place = |coarse: u32, fine: u32, n: u32, m: u32, salt: u32| {
        ((coarse as f32 + stratum_point(fine, m, jitter(salt))) / n as f32).min(ONE_MINUS_EPSILON)
    };
    Vec2::new(place(x, fine_x, columns, rows, 0x967a_889b), place(y, fine_y, rows, columns, 0x368c_c8b7))
}
