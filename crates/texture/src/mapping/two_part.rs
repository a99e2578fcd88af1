//! Two-part mapping (Bier, Sloan, "Two-Part Texture Mappings", IEEE CG&A 1986): an O-map leads from the object to a
//! simple surface around it, an S-map from there to texture coordinates.

use super::projector::{Projected, azimuth, cube, polar};
use crate::TextureContext;
use steradian_math::{Vec2, Vec3, transform::Affine};

/// From the object to the surface around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectMap {
    /// Along the reflection of the line of sight: environment mapping.
    Reflection,
    /// Along the object's normal.
    Normal,
    /// Along the line from the origin of texture space through the point.
    Centroid,
    /// The point of the surface whose own normal leads here: shrink-wrapping.
    ProxyNormal,
}

/// The surface around the object, about the origin of texture space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intermediary {
    /// The square \[−1, 1]² of the plane z = 1; u along x, v along y.
    Plane,
    /// The cylinder of radius one around z between z = −1 and 1; u is the azimuth over 2π, v the height.
    Cylinder,
    /// The unit sphere; u is the azimuth over 2π, v the angle from +z over π.
    Sphere,
    /// The cube \[−1, 1]³. Its faces lie side by side in three columns (x, y, z) and two rows (+, −).
    Cube,
}

/// Point at which a line from `o` along `d` leaves the region within the surface; for the plane, its intersection. A
/// line that misses gives the point at infinity, by its direction.
fn reach(surface: Intermediary, o: Vec3, d: Vec3) -> Vec3 {
    let t = match surface {
        Intermediary::Plane => (1.0 - o.z) / d.z,
        Intermediary::Sphere => last_root(d.dot(d), o.dot(d), o.dot(o) - 1.0),
        Intermediary::Cylinder => {
            let (o, d) = (o.truncate(), d.truncate());
            last_root(d.dot(d), o.dot(d), o.dot(o) - 1.0)
        }
        Intermediary::Cube => {
            let far = (Vec3::ONE.copysign(d) - o) / d;
            let far = Vec3::select(d.cmpeq(Vec3::ZERO), Vec3::INFINITY, far);
            far.min_element()
        }
    };
    let q = o + d * t;
    if t.is_finite() && t >= 0.0 && q.is_finite() { q } else { d }
}

/// The larger root of `a t² + 2 b t + c`.
fn last_root(a: f32, b: f32, c: f32) -> f32 {
    let (a, b, c) = (f64::from(a), f64::from(b), f64::from(c));
    let d = b * b - a * c;
    if d >= 0.0 && a > 0.0 {
        let s = d.sqrt();
        // Without cancellation.
        (if b > 0.0 { -c / (b + s) } else { (s - b) / a }) as f32
    } else {
        f32::NAN
    }
}

pub(super) fn project(
    object: ObjectMap,
    surface: Intermediary,
    local: &Affine,
    at: &TextureContext,
    dp: Vec3,
    face: Option<u8>,
) -> Projected {
    let p = local.point(at.p + dp);
    let normal = || local.normal(at.n).normalize_or_zero();
    let q = match object {
        ObjectMap::Centroid if surface == Intermediary::Plane => p,
        ObjectMap::Centroid => reach(surface, Vec3::ZERO, p),
        ObjectMap::Normal => reach(surface, p, normal()),
        ObjectMap::Reflection => {
            let n = normal();
            let wo = local.vector(at.wo).normalize_or_zero();
            reach(surface, p, n * (2.0 * n.dot(wo)) - wo)
        }
        // Lines along the normals of plane and cylinder are those on which these coordinates are constant; those of the
        // sphere come from its centre. Those of the cube are parallel to the axes.
        ObjectMap::ProxyNormal => p,
    };
    let (uv, face, wraps) = match surface {
        Intermediary::Plane => (Vec2::new(q.x, q.y) * 0.5 + 0.5, 0, false),
        Intermediary::Cylinder => (Vec2::new(azimuth(q), q.z * 0.5 + 0.5), 0, true),
        Intermediary::Sphere => (Vec2::new(azimuth(q), polar(q)), 0, true),
        Intermediary::Cube => {
            let (face, st) = match object {
                ObjectMap::ProxyNormal => {
                    let (face, _) = cube(q, face);
                    // Straight onto the face: the depth does not shrink the coordinates.
                    let depth = q.abs()[usize::from(face / 2)];
                    let (_, st) = cube(q, Some(face));
                    (face, (st * depth).clamp(Vec2::NEG_ONE, Vec2::ONE))
                }
                _ => cube(q, face),
            };
            let cell = Vec2::new(f32::from(face / 2), f32::from(face % 2));
            ((cell + st * 0.5 + 0.5) / Vec2::new(3.0, 2.0), face, false)
        }
    };
    Projected { uv, face, wraps }
}
