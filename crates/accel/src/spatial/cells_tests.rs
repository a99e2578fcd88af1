//! Leaves of points: each holds its point and the primitive, by the boxes of all leaves.

use super::testing::{Mesh, assorted_rays, soup};
use super::{Accel, Accelerator};
use crate::Geometry;
use crate::levels::Levels;
use std::collections::BTreeSet;
use steradian_math::{Bounds3, Vec3};

fn over(accelerator: Accelerator, mesh: &Mesh) -> Accel {
    Accel::build(accelerator, &[Geometry::triangles(&mesh.0, &mesh.1)], Vec::new(), &[]).expect("few triangles")
}

/// Boxes of the leaves of a tree that hold a primitive, with their numbers.
pub(super) fn holders<L: Levels>(levels: &L, primitive: u32) -> Vec<(u32, Bounds3)> {
    let (mut found, mut pending) = (Vec::new(), vec![levels.root()]);
    while let Some(node) = pending.pop() {
        if !levels.open(node, &mut pending) {
            found.extend(levels.holder(node, primitive).map(|number| (number, levels.bounds(node))));
        }
    }
    found
}

/// Every point that a ray finds is in the box of its leaf, and the leaf lists the primitive. Structures divide the
/// points among more than a few leaves.
#[test]
fn leaves_hold_their_points() {
    let mesh = soup(500, 0.3, 31);
    for accelerator in Accelerator::ALL {
        let accel = over(accelerator, &mesh);
        let mut cells = BTreeSet::new();
        for ray in assorted_rays(Vec3::ZERO, 1.2, 2000, 32) {
            let Some(hit) = accel.intersect(&ray, &()) else { continue };
            let p = ray.at(hit.t);
            let cell = accel.cell(hit.id, p, -ray.direction).expect("a leaf");
            let slack = 1e-4;
            let is_in = |b: Bounds3| Bounds3 { min: b.min - slack, max: b.max + slack }.contains(p);
            match &accel {
                Accel::Bvh(top) => {
                    let all = holders(top.tree(), top.tree().index(hit.id));
                    assert!(all.iter().any(|(number, b)| *number == cell && is_in(*b)), "{accelerator:?} {hit:?}");
                }
                Accel::Partition(scene) => assert!(scene.holds(hit.id, cell, is_in), "{accelerator:?} {hit:?}"),
            }
            cells.insert(cell);
        }
        assert_eq!(cells.len() == 1, accelerator == Accelerator::None, "{accelerator:?}");
        assert!(accelerator == Accelerator::None || cells.len() > 20, "{accelerator:?}: {}", cells.len());
    }
}

/// The root of every structure is the box around two triangles in opposite corners of a cube. The first plane of a k-d
/// tree by the heuristic is where the lower one ends; of the cells of the grid two hold something.
#[test]
fn levels_of_two_triangles() {
    let corner = |p: Vec3| [p, p + Vec3::X * 0.1, p + Vec3::Y * 0.1];
    let mesh = ([corner(Vec3::ZERO), corner(Vec3::splat(0.9))].concat(), vec![[0, 1, 2], [3, 4, 5]]);
    for accelerator in Accelerator::ALL {
        let Some(boxes) = over(accelerator, &mesh).boxes(0) else {
            assert_eq!(accelerator, Accelerator::Bsp);
            continue;
        };
        let [b] = boxes[..] else { panic!("{accelerator:?}: {boxes:?}") };
        let wrong = b.min.abs().max((b.max - Vec3::new(1.0, 1.0, 0.9)).abs()).max_element();
        assert!(wrong < 1e-4, "{accelerator:?}: {b:?}");
    }
    let below = over(Accelerator::KdTree, &mesh).boxes(1).expect("boxes");
    let [low, high] = below[..] else { panic!("{below:?}") };
    assert!(low.max.x == high.min.x && (low.max.x - 0.1).abs() < 1e-4 && high.max.x > 0.99, "{below:?}");
    assert_eq!(over(Accelerator::Grid, &mesh).boxes(1).expect("boxes").len(), 2);
}
