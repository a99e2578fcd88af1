//! Footprints: how far the point that a pixel sees moves when the sample moves by a pixel. Texture filters average over
//! them.
//!
//! Ray differentials follow Igehy, "Tracing Ray Differentials", SIGGRAPH 1999: transfer (eq. 10 to 12), reflection (14,
//! 15) and refraction (16, 17). A rough surface is taken for the mirror of the facet that the sample drew, curved as
//! the surface is: its own spread of directions is left to the samples. Where nothing was carried along, the footprint
//! is that which the camera would have if it saw the point directly, as in Pharr, Jakob, Humphreys, *Physically Based
//! Rendering* 4th ed., § 10.1.3.

use steradian_bsdf::BsdfSample;
use steradian_math::Vec3;

/// A ray's derivatives with respect to the sample's place in the film, per sample spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayDifferential {
    /// Derivatives of the origin.
    pub origin: [Vec3; 2],
    /// Derivatives of the unit direction.
    pub direction: [Vec3; 2],
}

/// Specular event of a ray at a facet: a reflection, or a refraction with the ratio of the indices on the far side and
/// on this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounce {
    /// Mirror reflection.
    Reflection,
    /// Refraction; index of the far side over that of this side.
    Refraction(f32),
}

/// Samples of rough lobes denser than this per steradian carry differentials on: those of lobes within about 10° of
/// their middle.
const NARROW: f32 = 10.0;

impl Bounce {
    /// Event of a BSDF sample that differentials follow: a specular sample, or one of a narrow lobe. Elsewhere they
    /// lose their meaning, since the scene is seen blurred far beyond them.
    #[inline]
    pub fn of(s: &BsdfSample) -> Option<Self> {
        let is_narrow = s.lobe.is_glossy() && s.pdf > NARROW;
        if !s.lobe.is_specular() && !is_narrow {
            return None;
        }
        Some(if s.lobe.is_transmission() { Self::Refraction(s.eta) } else { Self::Reflection })
    }

    /// The normal, on the side of `n`, of the facet that turns a ray from `d` to `wi`; `n` where it goes straight on,
    /// as at any facet.
    pub(crate) fn facet(self, d: Vec3, wi: Vec3, n: Vec3) -> Vec3 {
        let across = match self {
            Self::Reflection => d - wi,
            Self::Refraction(relative) => d / relative - wi,
        };
        if across.length_squared() > 1e-8 { across.normalize() * 1.0_f32.copysign(across.dot(n)) } else { n }
    }
}

impl RayDifferential {
    /// The displacements on the plane with normal `n` at distance `t` along the ray in direction `d`.
    pub fn transfer(&self, d: Vec3, t: f32, n: Vec3) -> [Vec3; 2] {
        let dn = d.dot(n);
        std::array::from_fn(|k| {
            let moved = self.origin[k] + self.direction[k] * t;
            moved - d * (moved.dot(n) / dn)
        })
    }

    /// The differential of the ray that goes straight on from distance `t`.
    #[must_use]
    pub fn advance(&self, t: f32) -> Self {
        Self { origin: std::array::from_fn(|k| self.origin[k] + self.direction[k] * t), direction: self.direction }
    }

    /// The differential of the ray that leaves towards `wi` after an event at a facet; `dn` are the derivatives of its
    /// unit normal `n` for the displacements `dp`.
    pub fn scatter(&self, d: Vec3, wi: Vec3, n: Vec3, dp: [Vec3; 2], dn: [Vec3; 2], bounce: Bounce) -> Self {
        // The normal is taken against the ray.
        let side = if d.dot(n) > 0.0 { -1.0 } else { 1.0 };
        let n = n * side;
        let direction = std::array::from_fn(|k| {
            let dn = dn[k] * side;
            let cos = d.dot(n);
            let dcos = self.direction[k].dot(n) + d.dot(dn);
            match bounce {
                Bounce::Reflection => self.direction[k] - (dn * cos + n * dcos) * 2.0,
                Bounce::Refraction(relative) => {
                    let eta = 1.0 / relative;
                    let cos_t = wi.dot(n);
                    let mu = eta * cos - cos_t;
                    let dmu = (eta - eta * eta * cos / cos_t) * dcos;
                    self.direction[k] * eta - (dn * mu + n * dmu)
                }
            }
        });
        Self { origin: dp, direction }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.origin.iter().chain(&self.direction).all(|v| v.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::Ray;

    /// Ray distance of the first or the last intersection with the unit sphere around the origin.
    fn meet(ray: &Ray, far: bool) -> f32 {
        let (b, c) = (ray.origin.dot(ray.direction), ray.origin.length_squared() - 1.0);
        let root = (b * b - c).sqrt();
        if far { -b + root } else { -b - root }
    }

    fn bend(d: Vec3, n: Vec3, bounce: Bounce) -> Vec3 {
        let n = if d.dot(n) > 0.0 { -n } else { n };
        let cos = d.dot(n);
        match bounce {
            Bounce::Reflection => d - n * (2.0 * cos),
            Bounce::Refraction(relative) => {
                let eta = 1.0 / relative;
                let cos_t = -(1.0 - eta * eta * (1.0 - cos * cos)).sqrt();
                d * eta - n * (eta * cos - cos_t)
            }
        }
    }

    /// M65: through a glass ball and off a mirror ball, differentials are the differences of neighbouring rays.
    #[test]
    fn differentials_through_spheres_are_finite_differences() {
        let camera = |x: f64, y: f64| {
            let d = glam::DVec3::new(x, y, -1.0).normalize();
            Ray::new(Vec3::new(0.1, 0.2, 3.0), d.as_vec3())
        };
        // In f64, the whole way: rays of pixels at (x, y).
        let path = |x: f64, y: f64, bounces: &[Bounce]| {
            let (mut o, mut d) = (glam::DVec3::new(0.1, 0.2, 3.0), glam::DVec3::new(x, y, -1.0).normalize());
            for (k, bounce) in bounces.iter().enumerate() {
                let (b, c) = (o.dot(d), o.length_squared() - 1.0);
                let root = (b * b - c).sqrt();
                o += d * if k > 0 { -b + root } else { -b - root };
                let n = if d.dot(o) > 0.0 { -o } else { o };
                let cos = d.dot(n);
                d = match bounce {
                    Bounce::Reflection => d - n * (2.0 * cos),
                    Bounce::Refraction(relative) => {
                        let eta = 1.0 / f64::from(*relative);
                        d * eta - n * (eta * cos + (1.0 - eta * eta * (1.0 - cos * cos)).sqrt())
                    }
                };
            }
            (o, d)
        };
        let (x, y, h) = (0.11, -0.17, 1e-4);
        for bounces in [
            &[Bounce::Reflection][..],
            &[Bounce::Refraction(1.5)],
            &[Bounce::Refraction(1.5), Bounce::Refraction(1.0 / 1.5)],
            &[Bounce::Refraction(1.5), Bounce::Reflection, Bounce::Refraction(1.0 / 1.5)],
        ] {
            let mut ray = camera(x, y);
            let across =
                |v: Vec3| (v - ray.direction * v.dot(ray.direction)) / Vec3::new(x as f32, y as f32, 1.0).length();
            let mut differential =
                RayDifferential { origin: [Vec3::ZERO; 2], direction: [across(Vec3::X), across(Vec3::Y)] };
            for (k, bounce) in bounces.iter().enumerate() {
                let t = meet(&ray, k > 0);
                let n = ray.at(t).normalize();
                let wi = bend(ray.direction, n, *bounce);
                // The normal of the unit sphere moves as the point does.
                let dp = differential.transfer(ray.direction, t, n);
                differential = differential.scatter(ray.direction, wi, n, dp, dp, *bounce);
                ray = Ray::new(n, wi);
            }
            for (k, (dx, dy)) in [(h, 0.0), (0.0, h)].into_iter().enumerate() {
                let ((o0, d0), (o1, d1)) = (path(x - dx, y - dy, bounces), path(x + dx, y + dy, bounces));
                let (o, d) = (((o1 - o0) / (2.0 * h)).as_vec3(), ((d1 - d0) / (2.0 * h)).as_vec3());
                assert!((differential.origin[k] - o).length() < 2e-3 * o.length(), "{bounces:?} {k}");
                assert!((differential.direction[k] - d).length() < 2e-3 * d.length(), "{bounces:?} {k}");
            }
        }
    }
}
