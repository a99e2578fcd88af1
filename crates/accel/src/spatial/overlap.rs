//! Overlap test of a primitive and a cell: the thirteen separating axes of a triangle and a box (Akenine-Möller, "Fast
//! 3D Triangle-Box Overlap Testing", JGT 6(1), 2001).

use super::items::Item;
use steradian_math::{DVec3, Vec3};

/// Tests whether a primitive overlaps a closed box, which has its padding already. User primitives count as their whole
/// box.
pub(super) fn overlaps(item: &Item, [min, max]: [DVec3; 2]) -> bool {
    let [a, b, c] = item.corners.map(Vec3::as_dvec3);
    // The axes of the box first: they are the cheapest and separate most.
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let boxes = low.cmple(max).all() && high.cmpge(min).all();
    boxes && (item.is_user() || triangle_overlaps([a, b, c], (min + max) * 0.5, (max - min) * 0.5))
}

/// The axes that are not those of the box: the normal, and the products of edges with the axes.
fn triangle_overlaps(corners: [DVec3; 3], center: DVec3, half: DVec3) -> bool {
    // Move the box to the origin.
    let [a, b, c] = corners.map(|p| p - center);
    let edges = [b - a, c - b, a - c];
    // A bound on rounding, so that touching counts.
    let slack = 1e-14 * (a.abs().max(b.abs()).max(c.abs()) + half).max_element();
    // Project triangle and box onto the axis; disjoint intervals separate them.
    let separates = |axis: DVec3| {
        let [p, q, r] = [axis.dot(a), axis.dot(b), axis.dot(c)];
        let reach = half.dot(axis.abs()) + slack * axis.abs().element_sum();
        p.min(q).min(r) > reach || p.max(q).max(r) < -reach
    };
    // The normal and nine cross products of edges and axes.
    let products = edges.into_iter().flat_map(|e| DVec3::AXES.map(|axis| axis.cross(e)));
    !separates(edges[0].cross(edges[1])) && !products.into_iter().any(separates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Geometry;
    use crate::spatial::items::Items;
    use steradian_math::hash::HashRng;

    /// The triangle cut by the six planes of the box: whether anything is left.
    fn is_clipped_away(corners: [DVec3; 3], [min, max]: [DVec3; 2]) -> bool {
        let mut polygon = corners.to_vec();
        for axis in 0..3 {
            for (plane, sign) in [(min[axis], 1.0), (max[axis], -1.0)] {
                let height = |p: &DVec3| (p[axis] - plane) * sign;
                let next = |i: usize| polygon[(i + 1) % polygon.len()];
                let part = polygon.iter().enumerate().flat_map(|(i, p)| {
                    let (a, b) = (height(p), height(&next(i)));
                    let crossing = (a * b < 0.0).then(|| *p + (next(i) - *p) * (a / (a - b)));
                    [(a >= 0.0).then_some(*p), crossing].into_iter().flatten()
                });
                polygon = part.collect();
            }
        }
        polygon.is_empty()
    }

    #[test]
    fn it_agrees_with_clipping() {
        let mut rng = HashRng::new(72);
        let mut point = |scale: f32| Vec3::from_array([0; 3].map(|_| (rng.next_f32() * 2.0 - 1.0) * scale));
        let mut counts = [0; 2];
        for _ in 0..20_000 {
            let corners = [point(2.0), point(2.0), point(2.0)];
            let (center, half) = (point(0.5).as_dvec3(), point(0.7).abs().as_dvec3());
            let items = Items::new(&[Geometry::triangles(&corners, &[[0, 1, 2]])]).expect("one triangle");
            let cell = [center - half, center + half];
            let clipped = is_clipped_away(corners.map(Vec3::as_dvec3), cell);
            assert_eq!(overlaps(&items.list[0], cell), !clipped, "{corners:?} {cell:?}");
            counts[usize::from(clipped)] += 1;
        }
        assert!(counts.iter().all(|&n| n > 2000), "{counts:?}");
    }
}
