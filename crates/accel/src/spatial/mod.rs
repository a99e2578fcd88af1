//! Structures other than the hierarchy: the uniform grid, the octree, k-d trees, the binary space partition, and none
//! at all. They answer the same queries with the same bits, and are there to be compared ([`Accelerator`] chooses one).
//!
//! All of them sort primitives into cells and walk the cells along a ray. The test of a triangle is that of the
//! hierarchy (`shear`), and of equal distances the smaller primitive id wins, so that it does not matter which cells
//! are visited in which order, as long as none is left out that holds something the test accepts; `line` says how that
//! is made sure.
//!
//! The memory of each structure is bounded: the grid has at most 5 cells and 24 entries for each primitive, the octree
//! 16 levels and 17 entries, the k-d tree 8 + 1.3 log₂ n levels and 7 entries, the BSP 48 levels and 4 fragments.
//! Hierarchies of other widths and with quantised boxes (`wide`) are there for comparison too. The choice costs queries
//! of the eight-wide hierarchy one branch each.

mod accel;
mod bsp;
mod budget;
#[cfg(test)]
mod cells_tests;
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
