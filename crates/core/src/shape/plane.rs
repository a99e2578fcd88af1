//! The infinite plane `n·x + d = 0`. It has no bounds, so it is tested apart from the hierarchy.

use super::SurfacePoint;
use steradian_math::{Frame, Ray, Vec2, Vec3, ray::gamma};

/// An infinite plane.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Unit normal.
    pub n: Vec3,
    /// Offset.
    pub d: f32,
    /// Turns the reported normals over.
    pub reverse: bool,
}

impl Plane {
    /// The plane `n·x + d = 0`, for a normal of any length; `None` for a zero or non-finite one.
    pub fn new(n: Vec3, d: f32, reverse: bool) -> Option<Self> {
        let len = n.length();
        (len > 0.0 && len.is_finite() && d.is_finite()).then(|| Self { n: n / len, d: d / len, reverse })
    }

    /// Distance to the plane within `(0, t_max)`.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<f32> {
        let t = -(self.n.dot(ray.origin) + self.d) / self.n.dot(ray.direction);
        (t > 0.0 && t < ray.t_max).then_some(t)
    }

    /// The surface where the ray meets the plane at `t`.
    pub fn surface(&self, ray: &Ray, t: f32) -> SurfacePoint {
        let hit = ray.at(t);
        // Back onto the plane.
        let p = hit - self.n * (self.n.dot(hit) + self.d);
        let frame = Frame::from_z(self.n);
        let n = if self.reverse { -self.n } else { self.n };
        SurfacePoint {
            p,
            error: (p.abs() + Vec3::splat(self.d.abs())) * gamma(6),
            n,
            ns: n,
            dpdu: frame.x,
            uv: Vec2::new(frame.x.dot(p), frame.y.dot(p)),
        }
    }

    /// ∂p/∂v.
    pub fn dpdv(&self) -> Vec3 {
        Frame::from_z(self.n).y
    }
}
