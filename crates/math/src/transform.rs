//! Affine and projective maps with their inverses.

mod linear;
mod orientation;

use crate::{Bounds3, Ray, Vec3};
use glam::{DMat4, DVec3, DVec4, Mat4};
use serde::{Deserialize, Serialize};

/// A 4×4 map in `f64`, column vectors (`p' = M p`). Scene files compose these; [`Transform::affine`] rounds once for
/// rendering.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// The matrix.
    pub matrix: DMat4,
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl std::ops::Mul for Transform {
    type Output = Self;
    /// `(a * b)` applies `b` first.
    fn mul(self, o: Self) -> Self {
        Self { matrix: self.matrix * o.matrix }
    }
}

impl Transform {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self { matrix: DMat4::IDENTITY };

    /// From 16 numbers, row by row (Mitsuba's order).
    pub fn from_rows(m: [f64; 16]) -> Self {
        Self { matrix: DMat4::from_cols_array(&m).transpose() }
    }

    /// From 16 numbers, column by column (pbrt's order).
    pub fn from_columns(m: [f64; 16]) -> Self {
        Self { matrix: DMat4::from_cols_array(&m) }
    }

    /// `p + d`.
    pub fn translate(d: DVec3) -> Self {
        Self { matrix: DMat4::from_translation(d) }
    }

    /// `(s.x x, s.y y, s.z z)`.
    pub fn scale(s: DVec3) -> Self {
        Self { matrix: DMat4::from_scale(s) }
    }

    /// Right-handed rotation by an angle in radians around an axis of any length but zero; the identity for a zero
    /// axis.
    pub fn rotate(axis: DVec3, angle: f64) -> Self {
        match axis.try_normalize() {
            Some(a) => Self { matrix: DMat4::from_axis_angle(a, angle) },
            None => Self::IDENTITY,
        }
    }

    /// Camera-to-world of a camera at `origin` that looks along local +z to `target` with local +y near `up`, in a
    /// left-handed sense (`x = up × z`, the convention of pbrt and Mitsuba); `None` where `up` is parallel to the view
    /// or `origin` equals `target`.
    pub fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> Option<Self> {
        let z = (target - origin).try_normalize()?;
        let x = up.try_normalize()?.cross(z).try_normalize()?;
        let y = z.cross(x);
        Some(Self { matrix: DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), origin.extend(1.0)) })
    }

    /// The inverse, or `None` for a singular or non-finite map. An affine map is singular where the volume of the
    /// images of the unit vectors is below rounding error, relative to their lengths.
    pub fn inverse(&self) -> Option<Self> {
        let m = &self.matrix;
        let det = m.determinant();
        if !det.is_finite() || det == 0.0 {
            return None;
        }
        if m.row(3) == DVec4::W {
            let edges = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
            if det.abs() <= 4.0 * f64::EPSILON * edges {
                return None;
            }
        }
        let inv = m.inverse();
        inv.is_finite().then_some(Self { matrix: inv })
    }

    /// True if the linear part turns a right-handed basis into a left-handed one.
    pub fn swaps_handedness(&self) -> bool {
        glam::DMat3::from_mat4(self.matrix).determinant() < 0.0
    }

    /// True if every entry is finite.
    pub fn is_finite(&self) -> bool {
        self.matrix.is_finite()
    }

    /// Image of a point (with the division by `w`).
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.matrix.project_point3(p)
    }

    /// Image of a direction (no translation).
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.matrix.transform_vector3(v)
    }

    /// The map and its inverse rounded to `f32` for rendering; `None` when singular.
    pub fn affine(&self) -> Option<Affine> {
        let inv = self.inverse()?;
        let a = Affine { m: self.matrix.as_mat4(), inv: inv.matrix.as_mat4() };
        (a.m.is_finite() && a.inv.is_finite()).then_some(a)
    }
}

/// An invertible affine map in `f32` with its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// Forward matrix.
    pub m: Mat4,
    /// Its inverse.
    pub inv: Mat4,
}

impl Default for Affine {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl std::ops::Mul for Affine {
    type Output = Self;

    /// The map that applies `other` first.
    fn mul(self, other: Self) -> Self {
        Self { m: self.m * other.m, inv: other.inv * self.inv }
    }
}

impl Affine {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self { m: Mat4::IDENTITY, inv: Mat4::IDENTITY };

    /// The inverse map.
    pub fn inverse(&self) -> Self {
        Self { m: self.inv, inv: self.m }
    }

    /// Image of a point.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.m.transform_point3(p)
    }

    /// Image of a direction.
    #[inline]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.m.transform_vector3(v)
    }

    /// Factor by which the map enlarges the solid angle about a unit direction: `|det M| / |M d|³`.
    pub fn solid_angle(&self, d: Vec3) -> f32 {
        let [x, y, z] = [self.m.x_axis, self.m.y_axis, self.m.z_axis].map(glam::Vec4::truncate);
        let length = (x * d.x + y * d.y + z * d.z).length();
        (x.cross(y).dot(z) / (length * length * length)).abs()
    }

    /// Factor by which the map enlarges the area about a point of a surface with unit normal `n`: `|det M| / |Mᵀ n|`.
    pub fn area(&self, n: Vec3) -> f32 {
        let [x, y, z] = [self.m.x_axis, self.m.y_axis, self.m.z_axis].map(glam::Vec4::truncate);
        (x.cross(y).dot(z) / Vec3::new(x.dot(n), y.dot(n), z.dot(n)).length()).abs()
    }

    /// The uniform scale, if it is a similarity (to rounding).
    pub fn similarity(&self) -> Option<f32> {
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|e| self.vector(e));
        let s = x.length();
        let close = |a: f32| (a - s).abs() < 1e-4 * s;
        let square = |a: Vec3, b: Vec3| a.dot(b).abs() < 1e-4 * s * s;
        (close(y.length()) && close(z.length()) && square(x, y) && square(y, z) && square(x, z)).then_some(s)
    }

    /// Image of a normal, by the inverse transpose; not normalised.
    #[inline]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        let i = &self.inv;
        Vec3::new(i.x_axis.truncate().dot(n), i.y_axis.truncate().dot(n), i.z_axis.truncate().dot(n))
    }

    /// Image of a ray; the direction is not normalised, so `t` keeps its meaning.
    #[inline]
    pub fn ray(&self, r: &Ray) -> Ray {
        Ray { origin: self.point(r.origin), direction: self.vector(r.direction), ..*r }
    }

    /// The box around the images of the eight corners; empty stays empty.
    pub fn bounds(&self, b: &Bounds3) -> Bounds3 {
        if b.is_empty() {
            return Bounds3::EMPTY;
        }
        Bounds3::from_points((0..8).map(|i| self.point(b.corner(i))))
    }

    /// A bound on the absolute rounding error of the image of the point `p`, whose own error is within `error`.
    pub fn point_error(&self, p: Vec3, error: Vec3) -> Vec3 {
        let g3 = crate::ray::gamma(3);
        let abs = |v: Vec3| {
            self.m.x_axis.truncate().abs() * v.x.abs()
                + self.m.y_axis.truncate().abs() * v.y.abs()
                + self.m.z_axis.truncate().abs() * v.z.abs()
        };
        (abs(p) + self.m.w_axis.truncate().abs()) * g3 + abs(error) * (1.0 + g3)
    }
}
