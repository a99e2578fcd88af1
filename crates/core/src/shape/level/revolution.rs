//! Quadrics of revolution: a line, or half a parabola, turned around z. pbrt-v3 calls them cone, hyperboloid and
//! paraboloid (Pharr, Jakob, Humphreys, Physically Based Rendering, 3rd ed., 3.5).

use glam::DVec3;
use std::f64::consts::TAU;
use steradian_math::{Vec2, intersect::Quadric};

/// Profile of a surface of revolution.
#[derive(Clone, Copy, Debug)]
enum Profile {
    /// A line between two points, at different heights.
    Line(DVec3, DVec3),
    /// `r² = k z` between two heights.
    Parabola(f64, [f64; 2]),
}

/// A surface swept by a profile.
#[derive(Clone, Copy, Debug)]
pub struct Revolution {
    profile: Profile,
    /// Largest azimuth, radians, counted from the profile.
    phi_max: f64,
    quadric: Quadric,
}

impl Revolution {
    /// The line from `a` to `b` turned around z by `phi_max` radians; `None` where both are at one height.
    pub fn line(a: DVec3, b: DVec3, phi_max: f64) -> Option<Self> {
        let slope = ((b - a) / (b.z - a.z)).truncate();
        let foot = a.truncate() - slope * a.z;
        let c = [1.0, 1.0, -slope.length_squared(), 0.0, 0.0, 0.0, 0.0, 0.0, -foot.dot(slope), -foot.length_squared()];
        let is_sound = a.z != b.z && c.iter().all(|c| c.is_finite());
        is_sound.then(|| Self { profile: Profile::Line(a, b), phi_max, quadric: Quadric::new(c) })
    }

    /// The paraboloid with its apex at the origin and a radius at the height `z[1]`, above 0, from the height `z[0]`
    /// on; turned by `phi_max` radians.
    pub fn parabola(radius: f64, z: [f64; 2], phi_max: f64) -> Option<Self> {
        let k = radius * radius / z[1];
        let quadric = Quadric::new([1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.5 * k, 0.0]);
        let is_sound = k.is_finite() && k > 0.0 && z[0] >= 0.0 && z[0] < z[1];
        is_sound.then_some(Self { profile: Profile::Parabola(k, z), phi_max, quadric })
    }

    /// The quadric it is a part of, which grows away from the axis.
    pub fn quadric(&self) -> &Quadric {
        &self.quadric
    }

    /// The box around the full turn.
    pub fn corners(&self) -> [DVec3; 2] {
        // The square of the radius is convex in z: it is largest at an end.
        let (radius, z) = match self.profile {
            Profile::Line(a, b) => (a.truncate().length().max(b.truncate().length()), [a.z.min(b.z), a.z.max(b.z)]),
            Profile::Parabola(k, z) => ((k * z[1]).sqrt(), z),
        };
        [DVec3::new(-radius, -radius, z[0]), DVec3::new(radius, radius, z[1])]
    }

    /// Parameter along the profile at a height.
    fn along(&self, z: f64) -> f64 {
        match self.profile {
            Profile::Line(a, b) => (z - a.z) / (b.z - a.z),
            Profile::Parabola(_, [z0, z1]) => (z - z0) / (z1 - z0),
        }
    }

    /// The azimuth in `[0, 2π)` from the profile.
    fn azimuth(&self, p: DVec3) -> f64 {
        let from = match self.profile {
            Profile::Line(a, b) => a.lerp(b, self.along(p.z)).truncate(),
            Profile::Parabola(..) => DVec3::X.truncate(),
        };
        let p = p.truncate();
        let phi = from.perp_dot(p).atan2(from.dot(p));
        if phi < 0.0 { phi + TAU } else { phi }
    }

    /// Tests whether a point of the quadric lies within the swept angle.
    pub fn keeps(&self, p: DVec3) -> bool {
        self.phi_max >= TAU * 0.999_999 || self.azimuth(p) <= self.phi_max
    }

    /// Around and along.
    pub fn parameters(&self, p: DVec3) -> Vec2 {
        let u = if self.phi_max > 0.0 { self.azimuth(p) / self.phi_max } else { 0.0 };
        Vec2::new(u.min(1.0) as f32, self.along(p.z).clamp(0.0, 1.0) as f32)
    }

    /// The point of the profile at a part of it.
    pub(super) fn profile_at(&self, v: f64) -> DVec3 {
        match self.profile {
            Profile::Line(a, b) => a.lerp(b, v),
            Profile::Parabola(k, [z0, z1]) => {
                let z = z0 + (z1 - z0) * v;
                DVec3::new((k * z).sqrt(), 0.0, z)
            }
        }
    }

    /// The area that a turn by one radian sweeps, by how much of the profile it is of: `|∂p/∂φ × ∂p/∂v|`.
    pub(super) fn speed(&self, v: f64) -> f64 {
        match self.profile {
            Profile::Line(a, b) => {
                let (p, along) = (a.lerp(b, v).truncate(), b - a);
                (p.length() * along.z).hypot(p.dot(along.truncate()))
            }
            // r √(1 + r'²) with r² = k z.
            Profile::Parabola(k, [z0, z1]) => (z1 - z0) * (0.25 * k * k + k * self.profile_at(v).z).sqrt(),
        }
    }

    /// Swept angle, radians.
    pub(super) fn turn(&self) -> f64 {
        self.phi_max
    }

    /// ∂p/∂u.
    pub fn dpdu(&self, p: DVec3) -> DVec3 {
        DVec3::new(-p.y, p.x, 0.0) * self.phi_max
    }

    /// ∂p/∂v; zero at the apex of a paraboloid.
    pub fn dpdv(&self, p: DVec3) -> DVec3 {
        match self.profile {
            Profile::Line(a, b) => glam::DMat3::from_rotation_z(self.azimuth(p)) * (b - a),
            Profile::Parabola(_, [z0, z1]) => {
                let slope = DVec3::new(0.5 * p.x / p.z, 0.5 * p.y / p.z, 1.0) * (z1 - z0);
                if slope.is_finite() { slope } else { DVec3::ZERO }
            }
        }
    }
}
