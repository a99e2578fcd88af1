//! Bounds for culling clusters. Both hold for the exact positions: rounding is on the safe side.

use glam::{DVec3, Vec3};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: Vec3,
    /// Its radius; infinite where no finite one will do.
    pub radius: f32,
}

impl Sphere {
    /// A sphere that contains these finite points: the smaller of Ritter's ("An Efficient Bounding Sphere", Graphics
    /// Gems, 1990) and the one around the middle of their box. Without points, radius 0 at the origin.
    pub fn around(points: &[Vec3]) -> Self {
        let (Some(least), Some(largest)) =
            (points.iter().copied().reduce(Vec3::min), points.iter().copied().reduce(Vec3::max))
        else {
            return Self { center: Vec3::ZERO, radius: 0.0 };
        };
        // The middle of the box is the better centre for regular shapes, Ritter's for irregular ones: keep the smaller
        // sphere.
        let middle = 0.5 * (least.as_dvec3() + largest.as_dvec3());
        let [a, b] = [middle, ritter(points)].map(|center| Self::at(center.as_vec3(), points));
        if b.radius < a.radius { b } else { a }
    }

    fn at(center: Vec3, points: &[Vec3]) -> Self {
        let squares = points.iter().map(|p| p.as_dvec3().distance_squared(center.as_dvec3()));
        let radius = squares.fold(0.0, f64::max).sqrt();
        Self { center, radius: round_up(radius * (1.0 + 1e-14)) }
    }
}

/// The centre of Ritter's sphere.
fn ritter(points: &[Vec3]) -> DVec3 {
    let points = || points.iter().map(|p| p.as_dvec3());
    // Initial diameter: the longest of the three pairs of extreme points along the axes.
    let extremes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
        let along = |a: &DVec3, b: &DVec3| a.dot(axis).total_cmp(&b.dot(axis));
        (points().min_by(along).unwrap_or_default(), points().max_by(along).unwrap_or_default())
    });
    let longer = |a: (DVec3, DVec3), b: (DVec3, DVec3)| if a.0.distance(a.1) >= b.0.distance(b.1) { a } else { b };
    let (a, b) = extremes.into_iter().reduce(longer).unwrap_or_default();
    let (mut center, mut radius) = (0.5 * (a + b), 0.5 * a.distance(b));
    // Grow towards points outside.
    for point in points() {
        let distance = point.distance(center);
        if distance > radius {
            radius = 0.5 * (radius + distance);
            center += (point - center) * (1.0 - radius / distance);
        }
    }
    center
}

/// The least `f32` that is not below.
fn round_up(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}

/// A cone from whose points all triangles of a cluster show their backs, where corners that run counter-clockwise show
/// the front. It opens against `axis` from `apex`. (Shirmun and Abi-Ezzi, "The Cone of Normals Technique for Fast
/// Processing of Curved Patches", Computer Graphics Forum 12(3), 1993; in this form in meshoptimizer's
/// `meshopt_Bounds`.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalCone {
    /// A point behind the planes of all triangles.
    pub apex: Vec3,
    /// The mean direction of the normals, of unit length but for rounding; zero where the cone culls nothing.
    pub axis: Vec3,
    /// The sine of the largest angle between axis and a normal; 1 where the cone culls nothing.
    pub cutoff: f32,
}

/// Normals within less than this cosine of the axis make no cone that culls much.
const LEAST_COSINE: f64 = 0.1;
/// Added to the cutoff, for rounding of axis and test: about a second of arc times ¼.
const MARGIN: f64 = 1e-6;

impl NormalCone {
    /// A cone that culls nothing.
    pub const NEVER: Self = Self { apex: Vec3::ZERO, axis: Vec3::ZERO, cutoff: 1.0 };

    /// The cone of triangles with corners among these points; corners that are not among them are no corners of
    /// theirs. Triangles without area have no say, and where there are no others the cone culls nothing.
    pub fn of(points: &[Vec3], triangles: &[[u8; 3]]) -> Self {
        let corners = |t: &[u8; 3]| -> Option<[DVec3; 3]> {
            let [a, b, c] = t.map(|i| points.get(usize::from(i)).map(|p| p.as_dvec3()));
            Some([a?, b?, c?])
        };
        // Planes of the triangles that have an area.
        let planes: Vec<(DVec3, DVec3)> = triangles
            .iter()
            .filter_map(corners)
            .map(|[a, b, c]| (a, (b - a).cross(c - a).normalize_or_zero()))
            .filter(|plane| plane.1 != DVec3::ZERO)
            .collect();
        Self::of_planes(&planes).unwrap_or(Self::NEVER)
    }

    /// Cone of planes given by a point and a unit normal each.
    fn of_planes(planes: &[(DVec3, DVec3)]) -> Option<Self> {
        let normals: Vec<Vec3> = planes.iter().map(|plane| plane.1.as_vec3()).collect();
        // Axis through the centre of a sphere around the normals, seen as points on the unit sphere.
        let axis = Sphere::around(&normals).center.normalize_or_zero();
        let unit = axis.as_dvec3().normalize_or_zero();
        // The least cosine between axis and normals is the opening of the cone; wide cones cull nothing.
        let cosine = planes.iter().map(|plane| plane.1.dot(unit)).fold(1.0, f64::min);
        if cosine < LEAST_COSINE {
            return None;
        }
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt() + MARGIN;
        let cutoff = round_up(sine);
        let start = planes.first()?.0;
        let apex = apex(planes, start, unit)?;
        (cutoff < 1.0).then_some(Self { apex, axis, cutoff })
    }

    /// True if all triangles show their backs to a finite point, by exact geometry: triangles that are seen edge-on may
    /// show either side once their corners are rounded to the window's sub-pixels. The point must be in the space of
    /// the mesh.
    pub fn faces_away_from(&self, point: Vec3) -> bool {
        self.faces_away_along(self.apex.as_dvec3() - point.as_dvec3())
    }

    /// True if all triangles show their backs in a parallel view along this direction, of any length, in the space of
    /// the mesh.
    pub fn faces_away_in(&self, direction: Vec3) -> bool {
        self.faces_away_along(direction.as_dvec3())
    }

    fn faces_away_along(&self, direction: DVec3) -> bool {
        // Backfacing for all normals within the cone: d·axis ≥ sin α·|d|.
        let along = direction.dot(self.axis.as_dvec3());
        along > 0.0 && along >= f64::from(self.cutoff) * direction.length()
    }
}

/// A point on the line through `start` against `axis` that is behind all planes after it is rounded.
fn apex(planes: &[(DVec3, DVec3)], start: DVec3, axis: DVec3) -> Option<Vec3> {
    // Distance against the axis at which a point falls behind every plane.
    let farthest = |from: DVec3| planes.iter().map(|(p, n)| (from - *p).dot(*n) / n.dot(axis)).fold(f64::MIN, f64::max);
    let size = planes.iter().map(|(p, _)| p.abs().max_element()).fold(0.0, f64::max);
    let mut back = farthest(start);
    // Rounding may bring the apex in front of a plane again: move it back until it is behind all of them.
    for _ in 0..8 {
        let rounded = (start - axis * back).as_vec3();
        let left = farthest(rounded.as_dvec3());
        if rounded.is_finite() && left <= 0.0 {
            return Some(rounded);
        }
        back += 2.0 * left.max(0.0) + size * 1e-7;
    }
    None
}
