//! The parts of a triangle on either side of a plane.

use steradian_math::{Bounds3, Vec3};

/// Boxes around the parts of a triangle below and above a plane across an axis, no greater than a box that holds what
/// is wanted of the triangle. They are rounded outwards, and both hold what lies in the plane.
pub(super) fn clip(corners: [Vec3; 3], within: &Bounds3, axis: usize, plane: f32) -> [Bounds3; 2] {
    let mut parts = [Bounds3::EMPTY; 2];
    // Walk the edges: vertices go to the side they are on, crossings to both (Sutherland and Hodgman 1974).
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a[axis] <= plane {
            parts[0] = parts[0].union_point(a);
        }
        if a[axis] >= plane {
            parts[1] = parts[1].union_point(a);
        }
        if a[axis] < plane && b[axis] > plane || a[axis] > plane && b[axis] < plane {
            let crossing = crossing(a, b, axis, plane);
            parts = parts.map(|part| part.union(crossing));
        }
    }
    // Clip to the box of the reference, which earlier planes may have cut already.
    let [mut below, mut above] = parts.map(|part| intersection(&part, within));
    below.max[axis] = below.max[axis].min(plane);
    above.min[axis] = above.min[axis].max(plane);
    [below, above]
}

/// A box around the point where an edge crosses a plane.
fn crossing(a: Vec3, b: Vec3, axis: usize, plane: f32) -> Bounds3 {
    // In the same direction for both triangles of an edge, and exact enough that a step of `f32` covers the rounding.
    let (a, b) = if a[axis] < b[axis] { (a.as_dvec3(), b.as_dvec3()) } else { (b.as_dvec3(), a.as_dvec3()) };
    let p = a + (b - a) * ((f64::from(plane) - a[axis]) / (b[axis] - a[axis]));
    let p = p.as_vec3();
    let (mut min, mut max) = (p.map(f32::next_down), p.map(f32::next_up));
    (min[axis], max[axis]) = (plane, plane);
    Bounds3 { min, max }
}

/// Intersection of two boxes.
pub(super) fn intersection(a: &Bounds3, b: &Bounds3) -> Bounds3 {
    Bounds3 { min: a.min.max(b.min), max: a.max.min(b.max) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::in_cube;
    use steradian_math::hash::HashRng;

    #[test]
    fn parts_hold_what_is_on_their_side() {
        let mut rng = HashRng::new(31);
        for _ in 0..2000 {
            let corners: [Vec3; 3] = std::array::from_fn(|_| in_cube(&mut rng));
            let whole = Bounds3::from_points(corners);
            let (axis, plane) = ((rng.next_u64() % 3) as usize, rng.next_f32() - 0.5);
            let parts = clip(corners, &whole, axis, plane);
            for _ in 0..20 {
                let (mut u, mut v) = (f64::from(rng.next_f32()), f64::from(rng.next_f32()));
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let [a, b, c] = corners.map(Vec3::as_dvec3);
                let p = a * (1.0 - u - v) + b * u + c * v;
                let side = usize::from(p[axis] > f64::from(plane));
                let part = &parts[side];
                let inside = p.cmpge(part.min.as_dvec3() - 1e-15).all() && p.cmple(part.max.as_dvec3() + 1e-15).all();
                assert!(inside, "{p} of {corners:?} is not in {part:?}");
            }
            // And they are tight: neither reaches beyond the plane or the whole.
            for (side, part) in parts.iter().enumerate().filter(|(_, part)| !part.is_empty()) {
                assert!(if side == 0 { part.max[axis] <= plane } else { part.min[axis] >= plane });
                assert!(part.min.cmpge(whole.min).all() && part.max.cmple(whole.max).all());
            }
        }
    }
}
