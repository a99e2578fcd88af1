//! Hidden surfaces without a depth test: polygons are brought into an order in which later ones may be drawn over
//! earlier ones, or the picture is divided until it is clear who is seen.
//!
//! All work on triangles of meshes, in the picture: x right and y up from −1 to 1, z the reversed depth, where more is
//! nearer, scaled to at most 1. Planes of space are planes there, and what is behind what is told by z alone.
//!
//! Parts of a polygon that was cut are drawn as the whole triangle, of which each pixel belongs to one of them by its
//! side of the cuts: outlines of the parts themselves would be rounded to the pipeline's grid, and leave gaps.

mod bsp;
mod newell;
mod painter;
mod warnock;

use steradian_math::{Ray, Vec3};
use steradian_raster::glam::{DVec3, DVec4};

use crate::{Error, options::Method, projection::Projected};

pub use warnock::{Frame, Painted};

/// A convex polygon, part of the primitive with this number.
#[derive(Clone, Debug)]
pub struct Polygon {
    pub number: u32,
    pub corners: Vec<DVec3>,
    /// The cuts that made this part; none where it is the whole triangle.
    pub cuts: Vec<Cut>,
}

/// A plane that a polygon was cut by, and the side that is kept.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    plane: DVec4,
    above: bool,
}

/// Result of a method.
pub enum Found {
    /// Polygons from the back to the front, and the space of their cuts.
    Ordered(Vec<Polygon>, Space),
    /// Pixels.
    Painted(Vec<Painted>),
}

/// The space that the planes of cuts are in.
#[derive(Clone, Copy, Debug)]
pub enum Space {
    /// In the world.
    World,
    /// In the picture, where they are lines.
    Picture,
}

/// Visible parts of triangles of the world, and the number that depths of the picture were divided by.
///
/// # Errors
/// More triangles than the method is good for, or more cuts than it may make.
pub fn solve(
    method: Method,
    triangles: &[(u32, [Vec3; 3])],
    projected: &Projected,
    frame: Frame,
) -> Result<(Found, f64), Error> {
    let (most, name) = match method {
        Method::ZBuffer | Method::Painter => (usize::MAX, "painter"),
        Method::Bsp => (200_000, "bsp"),
        Method::Newell => (50_000, "newell"),
        Method::Warnock => (1_000_000, "warnock"),
    };
    if triangles.len() > most {
        let count = triangles.len();
        return Err(Error::Scene(format!(
            "visibility={name} takes up to {most} triangles, and {count} are in the view"
        )));
    }
    let whole = |(number, corners): &(u32, [Vec3; 3])| Polygon {
        number: *number,
        corners: corners.map(Vec3::as_dvec3).to_vec(),
        cuts: Vec::new(),
    };
    let mut polygons: Vec<Polygon> = triangles.iter().map(whole).collect();
    // The BSP tree is built in the world, where it serves any eye; the other methods work in the picture.
    if method == Method::Bsp {
        let (eye, axis) = projected.eye();
        let from = if projected.is_perspective() {
            bsp::From::Point(eye.as_dvec3())
        } else {
            bsp::From::Direction(axis.as_dvec3())
        };
        polygons = bsp::ordered(polygons, from)?;
    }
    // Clipped before the division by w, so that no corner lies behind the eye.
    let in_picture = |polygon: Polygon| {
        let corners = polygon.corners.into_iter().map(|p| projected.clip(p.as_vec3()).as_dvec4()).collect();
        let corners = clipped(corners);
        (corners.len() >= 3).then_some(Polygon { corners, ..polygon })
    };
    let mut polygons: Vec<Polygon> = polygons.into_iter().filter_map(in_picture).collect();
    // Depths are scaled to at most 1, so that one tolerance serves scenes of any size.
    let largest = polygons.iter().flat_map(|p| &p.corners).fold(0f64, |z, c| z.max(c.z)).max(f64::MIN_POSITIVE);
    polygons.iter_mut().flat_map(|p| &mut p.corners).for_each(|c| c.z /= largest);
    let found = match method {
        Method::ZBuffer | Method::Bsp => Found::Ordered(polygons, Space::World),
        Method::Painter => Found::Ordered(painter::sorted(polygons), Space::World),
        Method::Newell => Found::Ordered(newell::ordered(polygons)?, Space::Picture),
        Method::Warnock => Found::Painted(warnock::paint(&polygons, frame)),
    };
    Ok((found, largest))
}

/// The point of a triangle's plane that a ray meets; not finite where it runs along it.
pub fn meet(ray: &Ray, triangle: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    // t = n·(a − o)/(n·d).
    let (o, d, n) = (ray.origin.as_dvec3(), ray.direction.as_dvec3(), (b - a).cross(c - a));
    o + d * (n.dot(a - o) / n.dot(d))
}

/// Polygons are cut where they leave this many times the picture.
const GUARD: f64 = 8.0;

/// The part of a polygon before the eye and around the picture, divided by w.
fn clipped(mut corners: Vec<DVec4>) -> Vec<DVec3> {
    let planes: [fn(&DVec4) -> f64; 6] = [
        |c| c.w - 1e-20,
        |c| c.w - c.z,
        |c| GUARD * c.w + c.x,
        |c| GUARD * c.w - c.x,
        |c| GUARD * c.w + c.y,
        |c| GUARD * c.w - c.y,
    ];
    // Clip in homogeneous coordinates against near and far plane and a guard band, then divide by w.
    for plane in planes {
        if corners.iter().any(|c| plane(c) < 0.0 || !c.is_finite()) {
            corners = half(&corners, plane, |a, b, t| *a + (*b - *a) * t);
        }
    }
    corners.into_iter().map(|c| c.truncate() / c.w).collect()
}

/// The part of a convex polygon where `distance` is not negative (Sutherland, Hodgman 1974).
fn half<T: Copy>(corners: &[T], distance: impl Fn(&T) -> f64, between: impl Fn(&T, &T, f64) -> T) -> Vec<T> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (i, a) in corners.iter().enumerate() {
        let b = &corners[(i + 1) % corners.len()];
        let (da, db) = (distance(a), distance(b));
        if da >= 0.0 {
            kept.push(*a);
        }
        // From the inside outwards, so that both neighbours of an edge find the same point.
        if da > 0.0 && db < 0.0 {
            kept.push(between(a, b, da / (da - db)));
        } else if da < 0.0 && db > 0.0 {
            kept.push(between(b, a, db / (db - da)));
        }
    }
    kept
}

impl Polygon {
    /// True if a point of the whole triangle, in the space of the cuts, is in this part. Points that are not finite are
    /// below every cut.
    pub fn has(&self, p: DVec3) -> bool {
        self.cuts.iter().all(|cut| (cut.plane.dot(p.extend(1.0)) >= 0.0) == cut.above)
    }

    /// The normal, as long as twice the area (Newell's sum).
    fn normal(&self) -> DVec3 {
        // Fan of triangles about the first corner; the sum is twice the area vector.
        let next = |i: usize| self.corners[(i + 1) % self.corners.len()];
        let start = self.corners[0];
        self.corners.iter().enumerate().map(|(i, c)| (*c - start).cross(next(i) - start)).sum()
    }

    /// The unit normal and offset of its plane; `None` for what has no area.
    fn plane(&self) -> Option<DVec4> {
        let n = self.normal().try_normalize()?;
        let middle = self.corners.iter().sum::<DVec3>() / self.corners.len() as f64;
        Some(n.extend(-n.dot(middle)))
    }

    /// The parts on both sides of a plane, the upper first; `None` where it lies on one, within `within`. The cut that
    /// the parts keep is the plane through their common edge along `up`: what is within rounding of a plane that is
    /// nearly the polygon's own may be far from where the two meet.
    fn cut(&self, plane: DVec4, within: f64, up: DVec3) -> Option<[Self; 2]> {
        // Snap corners within the tolerance to the plane: slivers would not get thinner by further cuts.
        let distance = |c: &DVec3| {
            let d = plane.dot(c.extend(1.0));
            if d.abs() <= within { 0.0 } else { d }
        };
        // All corners on one side: there is nothing to cut.
        let (low, high) = self.corners.iter().map(distance).fold((0f64, 0f64), |(l, h), d| (l.min(d), h.max(d)));
        if low == 0.0 || high == 0.0 {
            return None;
        }
        let between = |a: &DVec3, b: &DVec3, t: f64| *a + (*b - *a) * t;
        let above = half(&self.corners, distance, between);
        // The same cuts: both sides begin at the same points.
        let (mut below, mut edge) = (Vec::new(), Vec::new());
        for (i, a) in self.corners.iter().enumerate() {
            let b = &self.corners[(i + 1) % self.corners.len()];
            let (da, db) = (distance(a), distance(b));
            if da <= 0.0 {
                below.push(*a);
            }
            if da == 0.0 {
                edge.push(*a);
            }
            if da > 0.0 && db < 0.0 {
                below.push(between(a, b, da / (da - db)));
                edge.extend(below.last());
            } else if da < 0.0 && db > 0.0 {
                below.push(between(b, a, db / (db - da)));
                edge.extend(below.last());
            }
        }
        // The common edge runs from the first point on the plane to the last; the plane through it along `up` separates
        // both parts in the picture as well.
        let across =
            edge[..].split_first().and_then(|(p, rest)| Some((*p, up.cross(*rest.last()? - *p).try_normalize()?)));
        let line = across.map_or(plane, |(p, n)| {
            let highest = self.corners.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)));
            let n = if highest.is_some_and(|c| n.dot(*c - p) < 0.0) { -n } else { n };
            n.extend(-n.dot(p))
        });
        let part = |corners, above| {
            let mut cuts = self.cuts.clone();
            cuts.push(Cut { plane: line, above });
            Self { number: self.number, corners, cuts }
        };
        Some([part(above, true), part(below, false)])
    }
}
