//! Ray and planar polygon, concave and self-crossing ones included.
//!
//! A horizontal half-line from the point counts edges by the half-open rule: an edge spans `y` where
//! `y_low ≤ y < y_high`, so horizontal edges never count and a vertex counts once. Edges are evaluated from their lower
//! to their upper end, so two polygons that share an edge decide alike, and a point on it belongs to exactly one of
//! them.

use super::plane_point_normal;
use crate::{Ray, Vec2, Vec3};

/// Which points a polygon that crosses itself contains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FillRule {
    /// Points whose half-line meets the boundary an odd number of times.
    #[default]
    EvenOdd,
    /// Points that the boundary winds around.
    NonZero,
}

/// Winding number of the polygon around the point, counter-clockwise positive. Cost: one pass over the vertices.
pub fn winding_number(p: Vec2, polygon: &[Vec2]) -> i32 {
    crossings(p, polygon).sum()
}

/// True if the point lies in the polygon. Fewer than three vertices contain nothing.
pub fn is_inside(p: Vec2, polygon: &[Vec2], rule: FillRule) -> bool {
    match rule {
        FillRule::EvenOdd => crossings(p, polygon).count() % 2 == 1,
        FillRule::NonZero => winding_number(p, polygon) != 0,
    }
}

/// The edges that the half-line from `p` towards `+x` meets: `1` for one that goes up, `−1` for one that goes down.
fn crossings(p: Vec2, polygon: &[Vec2]) -> impl Iterator<Item = i32> {
    let p = p.as_dvec2();
    let last = polygon.last().copied();
    let from = last.into_iter().chain(polygon.iter().copied());
    from.zip(polygon.iter().copied()).filter_map(move |(a, b)| {
        let (a, b) = (a.as_dvec2(), b.as_dvec2());
        let upward = a.y <= b.y;
        let (low, high) = if upward { (a, b) } else { (b, a) };
        let spans = low.y <= p.y && p.y < high.y;
        // The edge lies to the right where the point is on its left side, seen upwards.
        let is_right = (high - low).perp_dot(p - low) > 0.0;
        (spans && is_right).then_some(if upward { 1 } else { -1 })
    })
}

/// A planar polygon in space.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// Corner on the plane, and the unit normal by Newell's method: right-handed to the order of the vertices.
    anchor: Vec3,
    normal: Vec3,
    /// The two axes that are left when the one nearest to the normal is dropped.
    axes: [usize; 2],
    outline: Vec<Vec2>,
}

impl Polygon {
    /// From at least three vertices in order; `None` for fewer, for a polygon without area, and for one that is not
    /// finite. Vertices are taken as lying in the plane of the Newell normal through their mean.
    pub fn new(vertices: &[Vec3]) -> Option<Self> {
        let last = *vertices.last()?;
        let first = vertices.first()?.as_dvec3();
        let mut n = glam::DVec3::ZERO;
        let mut sum = glam::DVec3::ZERO;
        let mut from = last;
        for &to in vertices {
            n += (from.as_dvec3() - first).cross(to.as_dvec3() - first);
            sum += to.as_dvec3();
            from = to;
        }
        let normal = n.try_normalize()?.as_vec3();
        let anchor = (sum / vertices.len() as f64).as_vec3();
        let size = normal.abs();
        let axes = if size.x >= size.y && size.x >= size.z {
            [1, 2]
        } else if size.y >= size.z {
            [2, 0]
        } else {
            [0, 1]
        };
        let outline = vertices.iter().map(|v| Vec2::new(v[axes[0]], v[axes[1]])).collect();
        anchor.is_finite().then_some(Self { anchor, normal, axes, outline })
    }

    /// Unit normal.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Distance to the polygon, from either side.
    pub fn intersect(&self, ray: &Ray, rule: FillRule) -> Option<f32> {
        let t = plane_point_normal(self.anchor, self.normal, ray)?;
        let p = ray.at(t);
        is_inside(Vec2::new(p[self.axes[0]], p[self.axes[1]]), &self.outline, rule).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;
    use crate::intersect::triangle;

    fn polygon(points: &[[f32; 2]]) -> Vec<Vec2> {
        points.iter().map(|&p| Vec2::from(p)).collect()
    }

    #[test]
    fn concave_and_crossing_polygons() {
        // An L: the notch is outside.
        let l = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
        for (p, inside) in [([0.5, 1.5], true), ([1.5, 1.5], false), ([1.5, 0.5], true), ([-0.1, 0.5], false)] {
            for rule in [FillRule::EvenOdd, FillRule::NonZero] {
                assert_eq!(is_inside(Vec2::from(p), &l, rule), inside, "{p:?} {rule:?}");
            }
        }
        // A pentagram: its heart has winding number two.
        let star: Vec<Vec2> =
            (0..5).map(|i| (i * 2) as f32 * std::f32::consts::TAU / 5.0).map(|a| Vec2::new(a.sin(), a.cos())).collect();
        assert_eq!(winding_number(Vec2::ZERO, &star).abs(), 2);
        assert!(!is_inside(Vec2::ZERO, &star, FillRule::EvenOdd));
        assert!(is_inside(Vec2::ZERO, &star, FillRule::NonZero));
        assert!(is_inside(Vec2::new(0.0, 0.8), &star, FillRule::EvenOdd));
        assert_eq!(winding_number(Vec2::ZERO, &polygon(&[[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]])), 1);
        assert!(!is_inside(Vec2::ZERO, &[], FillRule::EvenOdd));
        assert!(!is_inside(Vec2::ZERO, &polygon(&[[-1.0, 0.0], [1.0, 0.0]]), FillRule::EvenOdd));
    }

    #[test]
    fn points_on_edges_and_vertices_belong_to_one_tile() {
        // A square cut into four triangles around its middle, and its neighbour: grid points on edges and vertices are
        // in exactly one.
        let c = [1.0, 1.0];
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let mut tiles: Vec<Vec<Vec2>> = (0..4).map(|i| polygon(&[c, corners[i], corners[(i + 1) % 4]])).collect();
        tiles.push(polygon(&[[2.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 2.0]]));
        for i in 0..16 {
            for j in 0..8 {
                let p = Vec2::new(i as f32 * 0.25, j as f32 * 0.25);
                let n = tiles.iter().filter(|t| is_inside(p, t, FillRule::EvenOdd)).count();
                assert_eq!(n, 1, "{p}");
            }
        }
    }

    #[test]
    fn a_triangle_as_a_polygon_is_a_triangle() {
        let mut rng = HashRng::new(6);
        let mut hits = 0;
        for _ in 0..20_000 {
            let mut v = || Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5);
            let t = [v(), v(), v()];
            let origin = v() * 3.0;
            let ray = Ray::new(origin, v() * 0.5 + (t[0] + t[1] + t[2]) / 3.0 - origin);
            let Some(p) = Polygon::new(&t) else { continue };
            assert!((p.normal() - (t[1] - t[0]).cross(t[2] - t[0]).normalize()).length() < 1e-3);
            match (triangle(t, &ray), p.intersect(&ray, FillRule::EvenOdd)) {
                (Some(a), Some(b)) => {
                    assert!((a.t - b).abs() < 1e-3 * a.t.max(1.0));
                    hits += 1;
                }
                (None, None) => {}
                // Only next to an edge, or for a sliver, may the rounding of the hit point decide.
                (Some(a), None) => assert!(a.u.min(a.v).min(1.0 - a.u - a.v) < 1e-2),
                (None, Some(b)) => {
                    let grown = t.map(|x| x + (x - (t[0] + t[1] + t[2]) / 3.0) * 0.05);
                    assert!(triangle(grown, &Ray { t_max: b * 1.1, ..ray }).is_some());
                }
            }
        }
        assert!(hits > 300);
    }

    #[test]
    fn polygons_without_a_plane_are_refused() {
        assert!(Polygon::new(&[]).is_none());
        assert!(Polygon::new(&[Vec3::ZERO, Vec3::X]).is_none());
        assert!(Polygon::new(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0]).is_none());
        assert!(Polygon::new(&[Vec3::ZERO, Vec3::X, Vec3::Y * f32::INFINITY]).is_none());
        let far = Vec3::splat(1000.0);
        let square = Polygon::new(&[far, far + Vec3::X, far + Vec3::X + Vec3::Z, far + Vec3::Z]).expect("a square");
        assert!((square.normal() + Vec3::Y).length() < 1e-6);
        let ray = Ray::new(far + Vec3::new(0.5, 2.0, 0.25), -Vec3::Y);
        assert_eq!(square.intersect(&ray, FillRule::NonZero), Some(2.0));
    }
}
