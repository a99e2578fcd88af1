//! Structures other than the hierarchy: the uniform grid, the octree, k-d trees, the binary space partition, and none
//! at all. They answer the same queries with the same bits, and are there to be compared ([`Accelerator`] chooses one).
//!
//! All of them sort primitives into cells and walk the cells along a ray. The test of a triangle is that of the
//! hierarchy (`shear`), and of equal distances the smaller primitive id wins, so that it does not matter which cells
//! are visited in which order, as long as none is left out that holds something the test accepts; `line` says how that
//! is made sure.

mod accel;
mod bsp;
mod budget;
mod grid;
mod hierarchy;
mod items;
mod kdtree;
mod line;
mod lists;
mod octree;
mod overlap;
mod partition;
mod scene;
mod search;
mod shear;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod wide;

pub use accel::{Accel, Accelerator, Object};
pub use search::Steps;
