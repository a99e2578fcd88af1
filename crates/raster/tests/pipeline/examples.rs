//! The examples have the same bits everywhere.

use crate::stage::fingerprint;

#[path = "../../examples/compute_histogram.rs"]
mod compute_histogram;
#[path = "../../examples/forest.rs"]
pub mod forest;
#[path = "../../examples/geometry_normals.rs"]
mod geometry_normals;
#[path = "../../examples/icosphere_lod.rs"]
pub mod icosphere_lod;
#[path = "../../examples/meshlets.rs"]
pub mod meshlets;
#[path = "../../examples/objects.rs"]
mod objects;
#[path = "../../examples/shadow_map.rs"]
mod shadow_map;
#[path = "../../examples/tessellated_patch.rs"]
mod tessellated_patch;
#[path = "../../examples/textured_cube.rs"]
mod textured_cube;
#[path = "../../examples/triangle.rs"]
mod triangle;

/// Fingerprints of pictures that were looked at. They use no function whose bits differ from machine to machine.
#[test]
fn examples_are_what_they_were() {
    let pictures = [
        ("triangle", triangle::picture(), 0x07f5a23e6032cdc1),
        ("textured_cube", textured_cube::picture(), 0x393cdb64860aa65a),
        ("tessellated_patch", tessellated_patch::picture(), 0x1712f3291de9a3ec),
        ("geometry_normals", geometry_normals::picture(), 0xa656b6b7c6df78ff),
        ("shadow_map", shadow_map::picture(), 0x920aa77448f6d122),
        ("forest", forest::picture(), 0x0270c15c9c0e7a2b),
        ("icosphere_lod", icosphere_lod::picture(), 0x5ef939f37600f6ee),
        ("meshlets", meshlets::draw().map(|(picture, _)| picture), 0xd0f446dd56584527),
        ("objects", objects::draw().map(|(picture, _)| picture), 0xc4b1623f18b7c35b),
        ("compute_histogram", compute_histogram::picture(), 0xd6fdb1094faa8c75),
    ];
    let found: Vec<_> =
        pictures.iter().map(|(name, picture, _)| (*name, fingerprint(picture.as_ref().unwrap()))).collect();
    let expected: Vec<_> = pictures.iter().map(|(name, _, hash)| (*name, *hash)).collect();
    assert_eq!(found, expected);
}
