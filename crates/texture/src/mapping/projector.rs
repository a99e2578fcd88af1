//! Projectors: the inverse of the parametrisation of a simple surface.

// Comparisons are negated on purpose: NaN takes the way of the exception.
#![expect(clippy::neg_cmp_op_on_partial_ord, reason = "a NaN takes the branch, too")]

use super::{Intermediary, ObjectMap, two_part};
use crate::{TextureContext, exact};
use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};
use steradian_math::{Vec2, Vec3, transform::Affine};

/// Projection of a point to a pair of coordinates. Space is that of the texture, which the mapping's transform leads
/// to.
#[derive(Clone, Debug)]
pub enum Projector {
    /// The surface's own parameters.
    Uv,
    /// A two-component vertex attribute of the mesh, as further sets of texture coordinates are; the surface's own
    /// parameters where it has none of that name.
    Attribute(Arc<str>),
    /// Polar angle from +z over π and azimuth over 2π (pbrt's order).
    Spherical,
    /// Azimuth over 2π and height along z.
    Cylindrical,
    /// Distances along two vectors, with an offset: `(p·v₁, p·v₂) + d`. Any affine map of three points to three pairs
    /// is one.
    Planar(Vec3, Vec3, Vec2),
    /// The face of the cube \[−1, 1]³ that is nearest in direction from its centre; each shows the whole unit square.
    Cube,
    /// A simple surface around the object, and the rule that leads to it.
    TwoPart(ObjectMap, Intermediary),
}

/// A projected point.
#[derive(Clone, Copy, Debug)]
pub struct Projected {
    /// Texture coordinates.
    pub uv: Vec2,
    /// Which of several pieces it lies on.
    pub face: u8,
    /// True if u wraps around at one.
    pub wraps: bool,
}

/// Azimuth around z over 2π, in [0, 1): `atan2` gives (−π, π].
pub(crate) fn azimuth(v: Vec3) -> f32 {
    let turns = exact::atan2(v.y.into(), v.x.into()) / TAU;
    let turns = (if turns < 0.0 { turns + 1.0 } else { turns }) as f32;
    if turns >= 1.0 { 0.0 } else { turns }
}

/// Angle from +z over π. By its tangent: the arc cosine of z/r is not a number where rounding makes z exceed r.
pub(super) fn polar(v: Vec3) -> f32 {
    let v = v.as_dvec3();
    (exact::atan2((v.x * v.x + v.y * v.y).sqrt(), v.z) / PI) as f32
}

/// The face of a cube that a direction leaves by (+x, −x, +y, −y, +z, −z), or a given one, and the coordinates on it in
/// [−1, 1], u to the right and v up for a viewer outside who has +z (for ±z: +y) above.
pub(super) fn cube(v: Vec3, face: Option<u8>) -> (u8, Vec2) {
    let a = v.abs();
    let face = face.unwrap_or_else(|| {
        let (axis, sign) = if a.x >= a.y && a.x >= a.z {
            (0, v.x)
        } else if a.y >= a.z {
            (1, v.y)
        } else {
            (2, v.z)
        };
        2 * axis + u8::from(sign < 0.0)
    });
    let (depth, s, t) = match face {
        0 => (a.x, v.y, v.z),
        1 => (a.x, -v.y, v.z),
        2 => (a.y, -v.x, v.z),
        3 => (a.y, v.x, v.z),
        4 => (a.z, v.x, v.y),
        _ => (a.z, -v.x, v.y),
    };
    let st = Vec2::new(s, t) / depth;
    (face, if st.is_finite() { st } else { Vec2::ZERO })
}

/// The set of coordinates of a name, moved by a change of the surface parameters.
pub(super) fn attribute(name: &str, at: &TextureContext, duv: Vec2) -> Option<Vec2> {
    let (mesh, triangle, b) = at.mesh?;
    let b = if duv == Vec2::ZERO { b } else { b + mesh.barycentric_change(triangle, duv) };
    let (v, n) = mesh.attribute(name, Some(crate::Domain::Vertex), triangle, b)?;
    (n >= 2).then(|| Vec2::new(v[0], v[1]))
}

impl Projector {
    /// The affine map of the plane of three points `x` that takes them to the pairs `uv`: the lecture's 3 × 3 matrix,
    /// for points in space. `None` for points on a line.
    pub fn triangle(x: [Vec3; 3], uv: [Vec2; 3]) -> Option<Self> {
        let (e1, e2) = ((x[1] - x[0]).as_dvec3(), (x[2] - x[0]).as_dvec3());
        let (d1, d2) = ((uv[1] - uv[0]).as_dvec2(), (uv[2] - uv[0]).as_dvec2());
        // The dual basis: g₁·e₁ = g₂·e₂ = 1, g₁·e₂ = g₂·e₁ = 0.
        let (a, b, c) = (e1.dot(e1), e1.dot(e2), e2.dot(e2));
        let det = a * c - b * b;
        if !(det > 1e-24 * a * c) {
            return None;
        }
        let (g1, g2) = ((e1 * c - e2 * b) / det, (e2 * a - e1 * b) / det);
        let (v1, v2) = (g1 * d1.x + g2 * d2.x, g1 * d1.y + g2 * d2.y);
        let o = x[0].as_dvec3();
        let d = uv[0] - Vec2::new(v1.dot(o) as f32, v2.dot(o) as f32);
        let (v1, v2) = (v1.as_vec3(), v2.as_vec3());
        (v1.is_finite() && v2.is_finite() && d.is_finite()).then_some(Self::Planar(v1, v2, d))
    }

    /// Projects the point of a lookup, moved by `dp` in the world; on a given face where the surface has several.
    pub(super) fn project(&self, local: &Affine, at: &TextureContext, dp: Vec3, face: Option<u8>) -> Projected {
        let p = || local.point(at.p + dp);
        let (uv, face, wraps) = match self {
            Self::Uv => (at.uv, 0, false),
            Self::Attribute(name) => (attribute(name, at, Vec2::ZERO).unwrap_or(at.uv), 0, false),
            Self::Spherical => {
                let v = p();
                // pbrt's order; the azimuth is the second, so it is unwrapped here.
                let (theta, mut phi) = (polar(v), azimuth(v));
                if dp != Vec3::ZERO {
                    let here = azimuth(local.point(at.p));
                    phi -= (phi - here).round();
                }
                (Vec2::new(theta, phi), 0, false)
            }
            Self::Cylindrical => {
                let v = p();
                (Vec2::new(azimuth(v), v.z), 0, true)
            }
            Self::Planar(v1, v2, d) => {
                let v = p();
                (Vec2::new(v.dot(*v1), v.dot(*v2)) + *d, 0, false)
            }
            Self::Cube => {
                let (face, st) = cube(p(), face);
                (st * 0.5 + 0.5, face, false)
            }
            Self::TwoPart(object, surface) => return two_part::project(*object, *surface, local, at, dp, face),
        };
        Projected { uv, face, wraps }
    }
}
