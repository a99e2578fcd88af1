//! Mesh files: PLY, OBJ with MTL, STL, Mitsuba serialized, Bézier patches.
//!
//! Every reader takes bytes and gives a [`steradian_scene::Mesh`] that passes its `validate`, or a [`MeshError`] that
//! says where the file is wrong. Counts that a file declares are held against the bytes it really has before anything
//! is allocated.

mod error;
pub(crate) mod polygon;
pub(crate) mod recentre;
pub(crate) mod text;

#[cfg(test)]
pub(crate) mod test_files;

pub mod bpt;
pub mod model;
pub mod mtl;
pub mod obj;
pub mod ply;
pub mod serialized;
pub mod stl;

pub use error::{MeshError, MeshErrorKind, Place};
