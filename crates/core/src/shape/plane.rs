//! The infinite plane `n·x + d = 0`. It has no bounds, so it is tested apart from the hierarchy.

use super::SurfacePoint;
use steradian_math::{Frame, Ray, Vec2, Vec3, Vec4, ray::gamma};

/// An infinite plane.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Unit normal.
    pub n: Vec3,
    /// Offset.
    pub d: f32,
    /// Turns the reported normals over.
    pub reverse: bool,
    /// ∂p/∂u and ∂p/∂v.
    axes: [Vec3; 2],
    /// The parameters u and v as affine functions of the point.
    parameters: [Vec4; 2],
}

impl Plane {
    /// The plane `n·x + d = 0`, for a normal of any length; `None` for a zero or non-finite one. Parameters are lengths
    /// along two orthogonal directions.
    pub fn new(n: Vec3, d: f32, reverse: bool) -> Option<Self> {
        let len = n.length();
        (len > 0.0 && len.is_finite() && d.is_finite()).then(|| {
            let frame = Frame::from_z(n / len);
            let axes = [frame.x, frame.y];
            Self { n: n / len, d: d / len, reverse, axes, parameters: axes.map(|axis| axis.extend(0.0)) }
        })
    }

    /// The plane `p + u a + v b` with the normal a × b, whose parameters are u and v; `None` for directions that span
    /// no plane.
    pub fn spanned(p: Vec3, [a, b]: [Vec3; 2], reverse: bool) -> Option<Self> {
        let n = a.cross(b);
        let plane = Self::new(n, -n.dot(p), reverse)?;
        // The dual basis: u = a*·(x − p), with a*·a = 1 and a*·b = 0.
        let dual = [b.cross(plane.n), plane.n.cross(a)].map(|v| v / n.length());
        let parameters = dual.map(|v| v.extend(-v.dot(p)));
        parameters.iter().all(|v| v.is_finite()).then_some(Self { axes: [a, b], parameters, ..plane })
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
        let n = if self.reverse { -self.n } else { self.n };
        SurfacePoint {
            p,
            error: (p.abs() + Vec3::splat(self.d.abs())) * gamma(6),
            n,
            ns: n,
            dpdu: self.axes[0],
            uv: Vec2::from_array(self.parameters.map(|v| v.truncate().dot(p) + v.w)),
        }
    }

    /// ∂p/∂v.
    pub fn dpdv(&self) -> Vec3 {
        self.axes[1]
    }
}
