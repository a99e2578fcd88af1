//! Drawing in order: a partition tells, from any point, which polygons may cover which.

use super::build::for_order;
use super::polygon::Fragment;
use super::{Bsp, Child};
use crate::spatial::budget::Budget;
use crate::spatial::items::Items;
use crate::{Error, Geometry};
use steradian_math::{DVec3, Vec3};

/// In which order polygons are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The painter's: what is given later may cover what was given before.
    BackToFront,
    /// What is given earlier may cover what comes later.
    FrontToBack,
}

/// A binary space partition of a mesh that gives its polygons in order as seen from any point. Triangles that stand in
/// each other's way are split.
#[derive(Clone, Debug)]
pub struct PolygonOrder {
    bsp: Bsp,
    fragments: Vec<Fragment>,
    /// The triangle of each slot.
    prims: Vec<u32>,
}

impl PolygonOrder {
    /// Builds the partition. Triangles that have no area, or are not finite, are left out. There are at most
    /// `200 + 40 n` polygons for `n` triangles: beyond this, those that remain together are given in no particular
    /// order.
    ///
    /// # Errors
    /// When there are too many triangles.
    pub fn build(positions: &[Vec3], indices: &[[u32; 3]]) -> Result<Self, Error> {
        let items = Items::new(&[Geometry::triangles(positions, indices)])?;
        let (bsp, fragments) = for_order(&items, Budget(200 + 39 * items.list.len() as u64));
        Ok(Self { bsp, fragments, prims: items.list.iter().map(|item| item.index()).collect() })
    }

    /// How many polygons there are after splitting.
    pub fn len(&self) -> usize {
        self.fragments.len()
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.fragments.is_empty()
    }

    /// Gives every polygon in order, as seen from a point: the triangle it is part of, and its vertices.
    pub fn for_each(&self, eye: DVec3, order: Order, mut give: impl FnMut(u32, &[DVec3])) {
        let mut pending = vec![self.bsp.root];
        while let Some(child) = pending.pop() {
            match child {
                Child::List(list) => {
                    for &fragment in self.bsp.lists.get(list) {
                        let Fragment { slot, points, .. } = &self.fragments[fragment as usize];
                        give(self.prims[*slot as usize], points);
                    }
                }
                Child::Node(node) => {
                    let node = &self.bsp.nodes[node as usize];
                    let is_front = node.plane.height(eye) > 0.0;
                    let [near, far] = if is_front { [node.children[1], node.children[0]] } else { node.children };
                    let coplanar = Child::List(node.coplanar);
                    // What is pushed last is given first.
                    pending.extend(match order {
                        Order::BackToFront => [near, coplanar, far],
                        Order::FrontToBack => [far, coplanar, near],
                    });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::testing;
    use crate::{Accel, Accelerator};
    use steradian_math::{Ray, hash::HashRng};

    /// Whether a line of sight passes through a convex polygon, and not too near its rim.
    fn covers(points: &[DVec3], eye: DVec3, d: DVec3) -> Option<bool> {
        let n = points.len();
        let mut signs = Vec::new();
        for i in 0..n {
            let (a, b) = (points[i] - eye, points[(i + 1) % n] - eye);
            let normal = a.cross(b);
            let distance = normal.dot(d) / normal.length().max(1e-300);
            if distance.abs() < 1e-7 {
                return None;
            }
            signs.push(distance > 0.0);
        }
        let on_ray = points.iter().map(|p| (*p - eye).dot(d)).sum::<f64>() > 0.0;
        Some(on_ray && signs.iter().all(|s| *s == signs[0]))
    }

    #[test]
    fn the_painter_paints_what_rays_meet() {
        // Triangles that pierce each other, and some that share a plane.
        let mut mesh = testing::soup(40, 0.8, 93);
        let base = mesh.0.len() as u32;
        mesh.0.extend([[-1., 0., 0.], [1., 0., 0.], [0., 0., 1.], [0., 0., -1.]].map(Vec3::from_array));
        mesh.1.extend([[base, base + 1, base + 2], [base, base + 3, base + 1]]);
        let ordered = PolygonOrder::build(&mesh.0, &mesh.1).expect("few triangles");
        assert!(ordered.len() > mesh.1.len(), "nothing was split");
        let accel = Accel::build(Accelerator::None, &[Geometry::triangles(&mesh.0, &mesh.1)], vec![], &[]);
        let accel = accel.expect("few triangles");
        let mut rng = HashRng::new(94);
        let mut compared = 0;
        for _ in 0..6 {
            let eye = testing::direction(&mut rng) * 1.7;
            let mut polygons = Vec::new();
            ordered.for_each(eye.as_dvec3(), Order::BackToFront, |prim, points| polygons.push((prim, points.to_vec())));
            let mut reversed = Vec::new();
            ordered.for_each(eye.as_dvec3(), Order::FrontToBack, |prim, points| reversed.push((prim, points.to_vec())));
            assert_eq!((polygons.len(), reversed.len()), (ordered.len(), ordered.len()));
            for _ in 0..400 {
                let d = (testing::in_cube(&mut rng) * 0.8 - eye).normalize();
                let through: Option<Vec<u32>> = polygons
                    .iter()
                    .map(|(prim, points)| Some(covers(points, eye.as_dvec3(), d.as_dvec3())?.then_some(*prim)))
                    .filter_map(|p| p.map_or(Some(None), |p| p.map(Some)))
                    .collect();
                // Near a rim rounding decides.
                let Some(through) = through else { continue };
                let first =
                    reversed.iter().find(|(_, points)| covers(points, eye.as_dvec3(), d.as_dvec3()) == Some(true));
                let hit = accel.intersect(&Ray::new(eye, d), &()).map(|hit| hit.id.prim);
                assert_eq!(through.last().copied(), hit, "{eye} {d}");
                assert_eq!(first.map(|p| p.0), hit, "{eye} {d}");
                compared += usize::from(hit.is_some());
            }
        }
        assert!(compared > 1000, "{compared}");
    }
}
