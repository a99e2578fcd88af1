//! A hierarchy over triangles that move: its boxes move with them, so that a ray that asks at a time meets boxes that
//! are tight at that time (Grünschloß, Stich, Nawaz, Keller, "MSBVH: An Efficient Acceleration Data Structure for Ray
//! Traced Motion Blur", HPG 2011, on linear bounds).
//!
//! A vertex is at `(1 − time)·start + time·end`, and so are the corners of boxes. Rounding keeps the order of numbers
//! in products with what is not negative and in sums, so that boxes hold the vertices as they are rounded, without any
//! slack.

use super::shear::Shear;
use super::wide::Child;
use crate::construct::{self, Builder, Part};
use crate::geometry::WORLD;
use crate::traverse::{RayConstants, is_traceable};
use crate::{Error, Geometry, Hit, PrimId};
use steradian_math::{Bounds3, Ray, Vec3};

/// Children of a node.
const WIDTH: usize = 8;

/// An indexed triangle mesh whose vertices move in straight lines from time 0 to time 1.
#[derive(Clone, Copy, Debug)]
pub struct MovingTriangles<'a> {
    /// Vertex positions at time 0.
    pub start: &'a [Vec3],
    /// Vertex positions at time 1.
    pub end: &'a [Vec3],
    /// Three vertex indices for each triangle. Triangles with a vertex that is missing or not finite at either time are
    /// left out.
    pub indices: &'a [[u32; 3]],
}

/// A hierarchy over [`MovingTriangles`].
#[derive(Clone, Debug)]
pub struct MovingBvh {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    /// Around everything at all times.
    bounds: Bounds3,
}

/// The boxes of children at both ends: least and greatest coordinates by axis.
#[derive(Clone, Copy, Debug)]
struct Node {
    ends: [[[[f32; WIDTH]; 3]; 2]; 2],
    children: [Child; WIDTH],
}

/// A triangle at both ends.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    ends: [[Vec3; 3]; 2],
    index: u32,
}

/// Shares of the start and of the end at a time, which is brought into `[0, 1]`.
fn shares(time: f32) -> [f32; 2] {
    let time = time.clamp(0.0, 1.0);
    [1.0 - time, time]
}

impl Triangle {
    /// Where it is.
    #[inline]
    fn at(&self, [start, end]: [f32; 2]) -> [Vec3; 3] {
        std::array::from_fn(|i| self.ends[0][i] * start + self.ends[1][i] * end)
    }
}

impl MovingBvh {
    /// Builds the hierarchy.
    ///
    /// # Errors
    /// When there are too many triangles.
    pub fn build(mesh: &MovingTriangles) -> Result<Self, Error> {
        let corners = |positions: &[Vec3], indices: &[u32; 3]| {
            let [a, b, c] = indices.map(|i| positions.get(i as usize).copied().filter(|p| p.is_finite()));
            Some([a?, b?, c?])
        };
        let triangle = |(indices, index): (&[u32; 3], u32)| {
            Some(Triangle { ends: [corners(mesh.start, indices)?, corners(mesh.end, indices)?], index })
        };
        let usable: Vec<Triangle> = mesh.indices.iter().zip(0..).filter_map(triangle).collect();
        // In the middle of the time boxes are what they are on average.
        let boxes: Vec<Bounds3> = usable.iter().map(|t| Bounds3::from_points(t.at([0.5; 2]))).collect();
        let (parts, order) = construct::wide::<WIDTH>(&[Geometry::boxes(&boxes)], Builder::Sah)?;
        let triangles: Vec<Triangle> = order.iter().map(|&i| usable[i as usize]).collect();
        let mut nodes = Vec::with_capacity(parts.len());
        let mut around = vec![[Bounds3::EMPTY; 2]; parts.len()];
        // Children have greater numbers than their parents.
        for (number, parts) in parts.iter().enumerate().rev() {
            let mut node = Node { ends: [[[[0.0; WIDTH]; 3]; 2]; 2], children: [Child::NONE; WIDTH] };
            for (slot, part) in parts.iter().enumerate() {
                let Some((_, part)) = *part else { continue };
                let bounds = match part {
                    Part::Node(child) => around[child as usize],
                    Part::Leaf { first, count } => {
                        let of_leaf = &triangles[first as usize..][..count as usize];
                        [0, 1].map(|end| Bounds3::from_points(of_leaf.iter().flat_map(|t| t.ends[end])))
                    }
                };
                node.children[slot] = Child::new(part);
                for end in 0..2 {
                    around[number][end] = around[number][end].union(bounds[end]);
                    for axis in 0..3 {
                        node.ends[end][0][axis][slot] = bounds[end].min[axis];
                        node.ends[end][1][axis][slot] = bounds[end].max[axis];
                    }
                }
            }
            nodes.push(node);
        }
        nodes.reverse();
        let bounds = around.first().map_or(Bounds3::EMPTY, |ends| ends[0].union(ends[1]));
        Ok(Self { nodes, triangles, bounds })
    }

    /// The nearest hit in `(0, ray.t_max)` at a time; of hits at equal distance the one on the triangle with the
    /// smaller index.
    pub fn intersect(&self, ray: &Ray, time: f32) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.walk(ray, time, |hit, t| {
            let is_first = best.is_none_or(|best| hit.id < best.id);
            if hit.t < *t || hit.t == *t && best.is_some() && is_first {
                (*t, best) = (hit.t, Some(hit));
            }
            false
        });
        best
    }

    /// Whether anything is hit in `(0, ray.t_max)` at a time.
    pub fn occluded(&self, ray: &Ray, time: f32) -> bool {
        let mut found = false;
        self.walk(ray, time, |hit, t| {
            found |= hit.t < *t;
            found
        });
        found
    }

    /// The box around everything at all times.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Memory of the hierarchy, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.triangles[..]) + size_of::<Self>()
    }

    /// Shows hits with `t <= t_max` along a ray until one is enough. What is told of them may bring `t_max` nearer.
    fn walk(&self, ray: &Ray, time: f32, mut hit: impl FnMut(Hit, &mut f32) -> bool) {
        if self.nodes.is_empty() || !is_traceable(ray) || time.is_nan() {
            return;
        }
        let shares = shares(time);
        let (constants, shear) = (RayConstants::new(ray, &self.bounds), Shear::new(ray));
        let (inverse, offset) = (constants.inverse.to_array(), constants.offset.map(|offset| offset.to_array()));
        let mut t = ray.t_max;
        let mut pending = vec![(0.0, Child::ROOT)];
        while let Some((entry, child)) = pending.pop() {
            if entry > t {
                continue;
            }
            let (count, index) = child.get();
            for triangle in &self.triangles[index..][..count] {
                if let Some(found) = shear.hit(&triangle.at(shares), t) {
                    let id = PrimId { instance: WORLD, geom: 0, prim: triangle.index };
                    if hit(Hit { t: found.t, u: found.u, v: found.v, id }, &mut t) {
                        return;
                    }
                }
            }
            if count > 0 {
                continue;
            }
            let node = &self.nodes[index];
            let (mut enter, mut leave) = ([0.0_f32; WIDTH], [t; WIDTH]);
            for axis in 0..3 {
                let near = usize::from(inverse[axis].is_sign_negative());
                for slot in 0..WIDTH {
                    let plane = |side: usize| {
                        node.ends[0][side][axis][slot] * shares[0] + node.ends[1][side][axis][slot] * shares[1]
                    };
                    enter[slot] = enter[slot].max(plane(near) * inverse[axis] + offset[0][axis]);
                    leave[slot] = leave[slot].min(plane(1 - near) * inverse[axis] + offset[1][axis]);
                }
            }
            let first = pending.len();
            for slot in (0..WIDTH).filter(|&slot| node.children[slot] != Child::NONE && enter[slot] <= leave[slot]) {
                // Farther ones below.
                let nearer = pending[first..].partition_point(|&(entry, _)| entry > enter[slot]);
                pending.insert(first + nearer, (enter[slot], node.children[slot]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bvh;
    use crate::tests::{assorted_rays, in_cube, soup};
    use steradian_math::hash::HashRng;

    /// At every time the answers are those of all triangles where they are then, bit by bit.
    #[test]
    fn moving_triangles_are_hit_where_they_are() {
        let mut hits = [0; 2];
        for (seed, count, reach) in [(1, 3, 1.0), (2, 300, 0.3), (3, 900, 3.0), (4, 400, 0.0)] {
            let (start, indices) = soup(count, 0.15, seed);
            let mut rng = HashRng::new(seed + 50);
            // Each triangle goes its own way, and turns and grows on it.
            let mut end = Vec::new();
            for corners in start.chunks(3) {
                let constants = in_cube(&mut rng) * reach;
                end.extend(corners.iter().map(|p| *p + constants + in_cube(&mut rng) * 0.1 * reach));
            }
            let bvh = MovingBvh::build(&MovingTriangles { start: &start, end: &end, indices: &indices }).expect("few");
            for time in [0.0, 0.1, 0.5, 0.77, 1.0, -3.0, 7.0] {
                let [a, b] = shares(time);
                let now: Vec<Vec3> = start.iter().zip(&end).map(|(p, q)| *p * a + *q * b).collect();
                let single: Vec<Bvh> = indices
                    .iter()
                    .map(|triangle| {
                        Bvh::build(&[Geometry::triangles(&now, std::slice::from_ref(triangle))]).expect("one")
                    })
                    .collect();
                for ray in assorted_rays(Vec3::ZERO, 1.5, 60, seed) {
                    let of_triangle = |(bvh, prim): (&Bvh, u32)| {
                        let hit = bvh.intersect(&ray, &())?;
                        Some(Hit { id: PrimId { prim, ..hit.id }, ..hit })
                    };
                    let all = single.iter().zip(0..).filter_map(of_triangle);
                    let nearest = all.min_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
                    assert_eq!(bvh.intersect(&ray, time), nearest, "{seed} at {time}: {ray:?}");
                    assert_eq!(bvh.occluded(&ray, time), nearest.is_some());
                    hits[usize::from(nearest.is_some())] += 1;
                }
            }
        }
        assert!(hits.iter().all(|&n| n > 100), "{hits:?}");
    }

    #[test]
    fn boxes_are_tight_at_each_time() {
        // A thousand triangles move by a hundred of their size side by side: boxes over all times would all be entered.
        let (start, indices) = soup(1000, 0.02, 9);
        let end: Vec<Vec3> = start.iter().map(|p| *p + Vec3::X * 2.0).collect();
        let bvh = MovingBvh::build(&MovingTriangles { start: &start, end: &end, indices: &indices }).expect("few");
        let tested = |ray: &Ray| {
            let mut hits = 0;
            bvh.walk(ray, 0.0, |_, _| {
                hits += 1;
                false
            });
            hits
        };
        // At time 0 nothing is beyond x = 1.05, though all of it passes there later.
        assert_eq!(tested(&Ray::new(Vec3::new(2.0, -3.0, 0.0), Vec3::Y)), 0);
        assert!(bvh.bounds().max.x > 2.5);
        let (min, max) = (bvh.nodes[0].ends[0][0], bvh.nodes[0].ends[0][1]);
        for slot in (0..WIDTH).filter(|&slot| bvh.nodes[0].children[slot] != Child::NONE) {
            assert!(max[0][slot] < 1.05 && min[0][slot] > -1.05);
        }
    }

    #[test]
    fn what_cannot_be_is_left_out() {
        let start = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN)];
        let indices = [[0, 1, 3], [0, 1, 9], [0, 1, 2]];
        let bvh = MovingBvh::build(&MovingTriangles { start: &start, end: &start, indices: &indices }).expect("few");
        let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
        assert_eq!(bvh.intersect(&ray, 0.3).map(|hit| hit.id.prim), Some(2));
        assert_eq!(bvh.intersect(&ray, f32::NAN), None);
        assert!(!bvh.occluded(&Ray::new(Vec3::NAN, Vec3::Z), 0.5));
        let none = MovingBvh::build(&MovingTriangles { start: &[], end: &[], indices: &[] }).expect("none");
        assert_eq!(none.intersect(&ray, 0.5), None);
    }
}
