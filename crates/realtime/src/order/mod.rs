//! Hidden surfaces without a depth test: polygons are brought into an order in which later ones may be drawn over
//! earlier ones, or the picture is divided until it is clear who is seen.
//!
//! All work on triangles of meshes, in the picture: x right and y up from −1 to 1, z the reversed depth, where more is
//! nearer, scaled to at most 1. Planes of space are planes there, and what is behind what is told by z alone.

mod bsp;
mod newell;
mod painter;
mod warnock;

use steradian_math::{Vec3, Vec4};
use steradian_raster::glam::{DVec3, DVec4};

use crate::{Error, options::Method, projection::Projected};

pub use warnock::{Frame, Painted};

/// A convex polygon, part of the primitive with this number.
#[derive(Clone, Debug)]
pub struct Polygon {
    pub number: u32,
    pub corners: Vec<DVec3>,
}

/// What a method found.
pub enum Found {
    /// Polygons of the picture from the back to the front.
    Ordered(Vec<Polygon>),
    /// Pixels.
    Painted(Vec<Painted>),
}

/// The largest z of the picture, by which depths are scaled, and what it takes to undo that.
#[derive(Clone, Copy, Debug)]
pub struct Scale(pub f64);

/// What is seen of triangles of the world.
///
/// # Errors
/// More triangles than the method is good for, or more cuts than it may make.
pub fn solve(
    method: Method,
    triangles: &[(u32, [Vec3; 3])],
    projected: &Projected,
    frame: Frame,
) -> Result<(Found, Scale), Error> {
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
    let whole = |(number, corners): &(u32, [Vec3; 3])| (*number, corners.map(Vec3::as_dvec3).to_vec());
    let pieces: Vec<(u32, Vec<DVec3>)> = if method == Method::Bsp {
        let polygons = triangles.iter().map(whole).map(|(number, corners)| Polygon { number, corners }).collect();
        let (eye, axis) = projected.eye();
        let from = if projected.is_perspective() {
            bsp::From::Point(eye.as_dvec3())
        } else {
            bsp::From::Direction(axis.as_dvec3())
        };
        bsp::ordered(polygons, from)?.into_iter().map(|p| (p.number, p.corners)).collect()
    } else {
        triangles.iter().map(whole).collect()
    };
    let in_picture = |(number, corners): (u32, Vec<DVec3>)| {
        let corners = corners.into_iter().map(|p| projected.clip(p.as_vec3()).as_dvec4()).collect();
        let corners = clipped(corners);
        (corners.len() >= 3).then_some(Polygon { number, corners })
    };
    let mut polygons: Vec<Polygon> = pieces.into_iter().filter_map(in_picture).collect();
    let largest = polygons.iter().flat_map(|p| &p.corners).fold(0f64, |z, c| z.max(c.z)).max(f64::MIN_POSITIVE);
    polygons.iter_mut().flat_map(|p| &mut p.corners).for_each(|c| c.z /= largest);
    let found = match method {
        Method::ZBuffer | Method::Bsp => Found::Ordered(polygons),
        Method::Painter => Found::Ordered(painter::sorted(polygons)),
        Method::Newell => Found::Ordered(newell::ordered(polygons)?),
        Method::Warnock => Found::Painted(warnock::paint(&polygons, frame)),
    };
    Ok((found, Scale(largest)))
}

impl Scale {
    /// A corner in clip space.
    pub fn undo(self, corner: DVec3) -> Vec4 {
        Vec4::new(corner.x as f32, corner.y as f32, (corner.z * self.0) as f32, 1.0)
    }
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
        if da >= 0.0 && db < 0.0 {
            kept.push(between(a, b, da / (da - db)));
        } else if da < 0.0 && db >= 0.0 {
            kept.push(between(b, a, db / (db - da)));
        }
    }
    kept
}

impl Polygon {
    /// The normal, as long as twice the area (Newell's sum).
    fn normal(&self) -> DVec3 {
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

    /// The parts on both sides of a plane, the upper first; `None` where it lies on one, within `within`.
    fn cut(&self, plane: DVec4, within: f64) -> Option<[Self; 2]> {
        let distance = |c: &DVec3| {
            let d = plane.dot(c.extend(1.0));
            if d.abs() <= within { 0.0 } else { d }
        };
        let (low, high) = self.corners.iter().map(distance).fold((0f64, 0f64), |(l, h), d| (l.min(d), h.max(d)));
        if low == 0.0 || high == 0.0 {
            return None;
        }
        let between = |a: &DVec3, b: &DVec3, t: f64| *a + (*b - *a) * t;
        let above = half(&self.corners, distance, between);
        // The same cuts: both sides begin at the same points.
        let mut below = Vec::new();
        for (i, a) in self.corners.iter().enumerate() {
            let b = &self.corners[(i + 1) % self.corners.len()];
            let (da, db) = (distance(a), distance(b));
            if da <= 0.0 {
                below.push(*a);
            }
            if da > 0.0 && db < 0.0 {
                below.push(between(a, b, da / (da - db)));
            } else if da < 0.0 && db > 0.0 {
                below.push(between(b, a, db / (db - da)));
            }
        }
        Some([above, below].map(|corners| Self { number: self.number, corners }))
    }
}
