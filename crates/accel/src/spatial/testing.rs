//! Fixtures of the tests of this module.

use super::items::Items;
use crate::Geometry;
pub(super) use crate::tests::{Mesh, assorted_rays, direction, icosphere, in_cube, soup};

/// The triangles of a mesh.
pub(super) fn items(mesh: &Mesh) -> Items {
    Items::new(&[Geometry::triangles(&mesh.0, &mesh.1)]).expect("few triangles")
}
