//! Spheres, disks and cylinders, whole or in part, under any affine placement.

use super::SurfacePoint;
use std::f32::consts::TAU;
use steradian_accel::UserHit;
use steradian_math::{Bounds3, Ray, Vec2, Vec3, ray::gamma, transform::Affine};

/// Quadric in object space; angles in radians.
#[derive(Clone, Copy, Debug)]
pub enum QuadricKind {
    /// Around the origin, cut at two heights.
    Sphere {
        /// Radius.
        radius: f32,
        /// Lowest z.
        z_min: f32,
        /// Highest z.
        z_max: f32,
    },
    /// A ring in a plane of constant z.
    Disk {
        /// Its z.
        height: f32,
        /// Outer radius.
        radius: f32,
        /// Inner radius.
        inner: f32,
    },
    /// Around the z axis.
    Cylinder {
        /// Radius.
        radius: f32,
        /// Lowest z.
        z_min: f32,
        /// Highest z.
        z_max: f32,
    },
}

/// A placed quadric.
#[derive(Clone, Copy, Debug)]
pub struct Quadric {
    /// Kind of the quadric.
    pub kind: QuadricKind,
    /// Largest azimuth, radians.
    pub phi_max: f32,
    /// Transform from object space.
    pub place: Affine,
    /// Turns the normals over.
    pub flip: bool,
}

impl Quadric {
    /// True for the full sphere, without cuts.
    pub fn is_whole_sphere(&self) -> bool {
        matches!(self.kind, QuadricKind::Sphere { radius, z_min, z_max }
            if z_min <= -radius && z_max >= radius && self.phi_max >= TAU * 0.999_999)
    }

    /// The uniform scale of the placement, if it is one (to rounding).
    pub fn similarity(&self) -> Option<f32> {
        self.place.similarity()
    }

    fn object_bounds(&self) -> Bounds3 {
        match self.kind {
            QuadricKind::Sphere { radius, z_min, z_max } | QuadricKind::Cylinder { radius, z_min, z_max } => {
                Bounds3::new(Vec3::new(-radius, -radius, z_min), Vec3::new(radius, radius, z_max))
            }
            QuadricKind::Disk { height, radius, .. } => {
                Bounds3::new(Vec3::new(-radius, -radius, height), Vec3::new(radius, radius, height))
            }
        }
    }

    /// The box around it, where it is placed.
    pub fn bounds(&self) -> Bounds3 {
        self.place.bounds(&self.object_bounds())
    }

    /// Surface area where it is placed; where that stretches it unevenly, a mean over many points.
    pub fn area(&self) -> f32 {
        match self.even_scale() {
            Some(scale) => scale * self.object_area(),
            None => super::mean_area(|u| self.area_at(self.surface_at(self.sample(u)).n)),
        }
    }

    /// The reciprocal of the density of [`Quadric::sample`] per area, where the unit normal is `n`: the area, if the
    /// placement stretches all of it alike.
    pub fn area_at(&self, n: Vec3) -> f32 {
        self.even_scale().unwrap_or_else(|| self.place.area(n)) * self.object_area()
    }

    /// Factor by which the placement scales areas, if it is the same everywhere.
    fn even_scale(&self) -> Option<f32> {
        let flat = || self.place.vector(Vec3::X).cross(self.place.vector(Vec3::Y)).length();
        match (self.similarity(), self.kind) {
            (Some(s), _) => Some(s * s),
            (None, QuadricKind::Disk { .. }) => Some(flat()),
            _ => None,
        }
    }

    fn object_area(&self) -> f32 {
        match self.kind {
            QuadricKind::Sphere { radius, z_min, z_max } | QuadricKind::Cylinder { radius, z_min, z_max } => {
                self.phi_max * radius * (z_max - z_min)
            }
            QuadricKind::Disk { radius, inner, .. } => self.phi_max * 0.5 * (radius * radius - inner * inner),
        }
    }

    /// Azimuth in `[0, 2π)`.
    #[inline]
    fn azimuth(p: Vec3) -> f32 {
        let phi = p.y.atan2(p.x);
        if phi < 0.0 { phi + TAU } else { phi }
    }

    /// Tests whether an object-space point on the full surface belongs to the part.
    #[inline]
    fn keeps(&self, p: Vec3) -> bool {
        let in_height = match self.kind {
            QuadricKind::Sphere { radius, z_min, z_max } => {
                (z_min <= -radius || p.z >= z_min) && (z_max >= radius || p.z <= z_max)
            }
            QuadricKind::Cylinder { z_min, z_max, .. } => p.z >= z_min && p.z <= z_max,
            QuadricKind::Disk { radius, inner, .. } => {
                let r2 = p.x * p.x + p.y * p.y;
                r2 <= radius * radius && r2 >= inner * inner
            }
        };
        in_height && (self.phi_max >= TAU * 0.999_999 || Self::azimuth(p) <= self.phi_max)
    }

    /// The candidate parameters along an object-space ray, nearer first.
    #[inline]
    fn roots(&self, r: &Ray) -> Option<[f32; 2]> {
        let (o, d) = (r.origin, r.direction);
        match self.kind {
            QuadricKind::Sphere { radius, .. } => quadratic_roots(o, d, radius),
            QuadricKind::Cylinder { radius, .. } => {
                quadratic_roots(Vec3::new(o.x, o.y, 0.0), Vec3::new(d.x, d.y, 0.0), radius)
            }
            QuadricKind::Disk { height, .. } => {
                let t = (height - o.z) / d.z;
                t.is_finite().then_some([t, t])
            }
        }
    }

    /// The nearest hit in `(0, t_max)`.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<UserHit> {
        let local = self.place.inverse().ray(ray);
        let is_whole = self.is_whole_sphere();
        for t in self.roots(&local)? {
            if t > 0.0 && t < ray.t_max && (is_whole || self.keeps(self.project(local.at(t)))) {
                return Some(UserHit { t, u: 0.0, v: 0.0 });
            }
        }
        None
    }

    /// The nearest hit beyond `t`.
    pub fn intersect_after(&self, ray: &Ray, after: f32) -> Option<UserHit> {
        let local = self.place.inverse().ray(ray);
        let t = self.roots(&local)?[1];
        (t > after && t < ray.t_max && self.keeps(self.project(local.at(t)))).then_some(UserHit { t, u: 0.0, v: 0.0 })
    }

    /// Moves a computed hit back onto the surface.
    #[inline]
    fn project(&self, mut p: Vec3) -> Vec3 {
        match self.kind {
            QuadricKind::Sphere { radius, .. } => {
                p *= radius / p.length().max(f32::MIN_POSITIVE);
                if p.x == 0.0 && p.y == 0.0 {
                    p.x = 1e-5 * radius;
                }
            }
            QuadricKind::Cylinder { radius, .. } => {
                let k = radius / p.x.hypot(p.y).max(f32::MIN_POSITIVE);
                p.x *= k;
                p.y *= k;
            }
            QuadricKind::Disk { height, .. } => p.z = height,
        }
        p
    }

    /// The object-space point where the ray meets the surface at `t`.
    #[inline]
    fn object_point(&self, ray: &Ray, t: f32) -> Vec3 {
        self.project(self.place.inverse().ray(ray).at(t))
    }

    /// The surface where the ray meets it at `t`.
    pub fn surface(&self, ray: &Ray, t: f32) -> SurfacePoint {
        self.surface_at(self.object_point(ray, t))
    }

    /// The surface where the ray meets it at `t`, without its parametrisation.
    #[inline]
    pub fn bare(&self, ray: &Ray, t: f32) -> SurfacePoint {
        self.bare_at(self.object_point(ray, t))
    }

    /// The surface at an object-space point on it.
    pub fn surface_at(&self, p: Vec3) -> SurfacePoint {
        let dpdu = Vec3::new(-p.y, p.x, 0.0) * self.phi_max;
        SurfacePoint { dpdu: self.place.vector(dpdu), uv: self.parameters(p), ..self.bare_at(p) }
    }

    /// The surface at an object-space point on it, without its parametrisation.
    #[inline]
    fn bare_at(&self, p: Vec3) -> SurfacePoint {
        let (n, error) = match self.kind {
            QuadricKind::Sphere { radius, .. } => (p / radius, p.abs() * gamma(5)),
            QuadricKind::Cylinder { radius, .. } => (Vec3::new(p.x, p.y, 0.0) / radius, p.abs() * gamma(3)),
            QuadricKind::Disk { .. } => (Vec3::Z, Vec3::ZERO),
        };
        let n = self.place.normal(n).normalize();
        let n = if self.flip { -n } else { n };
        SurfacePoint::bare(self.place.point(p), self.place.point_error(p, error), n)
    }

    /// The surface parameters at an object-space point.
    fn parameters(&self, p: Vec3) -> Vec2 {
        let v = match self.kind {
            QuadricKind::Sphere { radius, z_min, z_max } => {
                let theta = |z: f32| (z / radius).clamp(-1.0, 1.0).acos();
                let (t0, t1) = (theta(z_min), theta(z_max));
                (theta(p.z) - t0) / (t1 - t0)
            }
            QuadricKind::Cylinder { z_min, z_max, .. } => (p.z - z_min) / (z_max - z_min),
            QuadricKind::Disk { radius, inner, .. } => (radius - p.x.hypot(p.y)) / (radius - inner),
        };
        Vec2::new(Self::azimuth(p) / self.phi_max, v)
    }

    /// ∂p/∂v at a point of the surface, in the space it is placed in; zero on the axis of spheres and disks.
    pub fn dpdv(&self, p: Vec3) -> Vec3 {
        let p = self.place.inverse().point(p);
        let radial = Vec3::new(p.x, p.y, 0.0).normalize_or_zero();
        self.place.vector(match self.kind {
            QuadricKind::Sphere { radius, z_min, z_max } => {
                let theta = |z: f32| (z / radius).clamp(-1.0, 1.0).acos();
                (radial * p.z - Vec3::Z * p.x.hypot(p.y)) * (theta(z_max) - theta(z_min))
            }
            QuadricKind::Cylinder { z_min, z_max, .. } => Vec3::Z * (z_max - z_min),
            QuadricKind::Disk { radius, inner, .. } => radial * (inner - radius),
        })
    }

    /// The radius where it is placed; of the mean scale where that is not uniform.
    pub fn world_radius(&self) -> f32 {
        let (QuadricKind::Sphere { radius, .. }
        | QuadricKind::Cylinder { radius, .. }
        | QuadricKind::Disk { radius, .. }) = self.kind;
        radius * [Vec3::X, Vec3::Y, Vec3::Z].map(|e| self.place.vector(e).length()).iter().sum::<f32>() / 3.0
    }

    /// An object-space point, uniform over the area in object space.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let phi = self.phi_max * u.y;
        match self.kind {
            QuadricKind::Sphere { radius, z_min, z_max } => {
                // Archimedes: area is uniform in z.
                let z = z_min + (z_max - z_min) * u.x;
                let r = (radius * radius - z * z).max(0.0).sqrt();
                self.project(Vec3::new(r * phi.cos(), r * phi.sin(), z))
            }
            QuadricKind::Cylinder { radius, z_min, z_max } => {
                Vec3::new(radius * phi.cos(), radius * phi.sin(), z_min + (z_max - z_min) * u.x)
            }
            QuadricKind::Disk { height, radius, inner } => {
                let r = (inner * inner + (radius * radius - inner * inner) * u.x).sqrt();
                Vec3::new(r * phi.cos(), r * phi.sin(), height)
            }
        }
    }
}

/// Roots of `|o + t d|² = r²`, nearer first. The discriminant comes from the distance of the line to the centre, which
/// stays exact where `b² − 4ac` cancels (Haines et al., Ray Tracing Gems, chapter 7).
#[inline]
fn quadratic_roots(o: Vec3, d: Vec3, radius: f32) -> Option<[f32; 2]> {
    let a = d.length_squared();
    if a == 0.0 || !a.is_finite() {
        return None;
    }
    let b = -o.dot(d);
    let foot = o + d * (b / a);
    let gap = radius * radius - foot.length_squared();
    if gap < 0.0 {
        return None;
    }
    let c = o.length_squared() - radius * radius;
    let q = b + b.signum() * (a * gap).sqrt();
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
    Some(if t0 < t1 { [t0, t1] } else { [t1, t0] })
}

/// `1 − cosθ_max` of the cone that a sphere subtends from a distance, for cone sampling.
pub fn one_minus_cos_max(radius: f32, distance_squared: f32) -> f32 {
    let sin2 = (radius * radius / distance_squared).min(1.0);
    // 1 − cos = sin² / (1 + cos): no cancellation for small cones.
    sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;
    use steradian_math::{DVec3, Transform, hash::HashRng, warp};

    fn placed(kind: QuadricKind, t: Transform) -> Quadric {
        Quadric { kind, phi_max: TAU, place: t.affine().unwrap(), flip: false }
    }

    /// M57, M59: a scaled sphere is the ellipsoid; hits satisfy its implicit equation; normals follow the inverse
    /// transpose.
    #[test]
    fn scaled_sphere_is_an_ellipsoid() {
        let s = Vec3::new(2.0, 0.5, 1.0);
        let q = placed(
            QuadricKind::Sphere { radius: 1.0, z_min: -1.0, z_max: 1.0 },
            Transform::translate(DVec3::new(1.0, 2.0, 3.0)) * Transform::scale(s.as_dvec3()),
        );
        let mut rng = HashRng::new(3);
        let mut hits = 0;
        for _ in 0..2000 {
            let o = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())) * 9.0;
            let to = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())) + Vec3::new(1.0, 2.0, 3.0);
            let ray = Ray::new(o, (to - o) * 3.0);
            let Some(hit) = q.intersect(&ray) else { continue };
            hits += 1;
            let point = q.surface(&ray, hit.t);
            let local = (point.p - Vec3::new(1.0, 2.0, 3.0)) / s;
            assert!((local.length() - 1.0).abs() < 1e-5);
            let gradient = (local / s).normalize();
            assert!((gradient - point.n).length() < 1e-3);
            assert!((ray.at(hit.t) - point.p).length() < 1e-4);
        }
        assert!(hits > 500);
    }

    #[test]
    fn parts_are_cut_and_areas_add_up() {
        let half = Quadric {
            phi_max: PI,
            ..placed(QuadricKind::Sphere { radius: 2.0, z_min: -2.0, z_max: 0.0 }, Transform::IDENTITY)
        };
        assert!((half.area() - 4.0 * PI * 4.0 / 4.0).abs() < 1e-4);
        // Straight up through the missing northern half, to the southern one behind.
        let down = Ray::new(Vec3::new(0.0, 1.0, 5.0), -Vec3::Z);
        let hit = half.intersect(&down).unwrap();
        assert!(down.at(hit.t).z < 0.0);
        assert!(half.intersect(&Ray::new(Vec3::new(0.0, -1.0, 5.0), -Vec3::Z)).is_none());
    }

    #[test]
    fn distant_and_tangent_rays() {
        let q = placed(QuadricKind::Sphere { radius: 1.0, z_min: -1.0, z_max: 1.0 }, Transform::IDENTITY);
        let far = Ray::new(Vec3::new(0.3, 0.2, -1e6), Vec3::Z);
        let p = q.surface(&far, q.intersect(&far).unwrap().t).p;
        assert!((p.length() - 1.0).abs() < 1e-6 && p.z < 0.0);
        assert!(q.intersect(&Ray::new(Vec3::new(1.000_01, 0.0, -5.0), Vec3::Z)).is_none());
        let inside = Ray::new(Vec3::ZERO, Vec3::X);
        assert!((q.intersect(&inside).unwrap().t - 1.0).abs() < 1e-6);
    }
}
