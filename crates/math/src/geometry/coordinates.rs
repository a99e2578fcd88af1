//! Polar and spherical coordinates.

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Polar coordinates in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polar {
    /// Distance from the origin, `≥ 0`.
    pub r: f64,
    /// Angle from `+x` towards `+y`, in `[0, 2π)`; 0 at the origin.
    pub phi: f64,
}

impl Polar {
    /// From Cartesian coordinates.
    pub fn from_cartesian(p: DVec2) -> Self {
        Self { r: p.length(), phi: azimuth(p.x, p.y) }
    }

    /// `(r cos φ, r sin φ)`.
    pub fn to_cartesian(self) -> DVec2 {
        self.r * DVec2::from_angle(self.phi)
    }
}

/// Spherical coordinates in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical {
    /// Distance from the origin, `≥ 0`.
    pub r: f64,
    /// Angle from `+z`, in `[0, π]`; 0 at the origin.
    pub theta: f64,
    /// Azimuth from `+x` towards `+y`, in `[0, 2π)`; 0 on the z axis.
    pub phi: f64,
}

impl Spherical {
    /// From Cartesian coordinates. `θ` is an arc tangent of the distance from the axis, so it is precise at the poles
    /// and never NaN.
    pub fn from_cartesian(p: DVec3) -> Self {
        let from_axis = p.x.hypot(p.y);
        Self { r: p.length(), theta: from_axis.atan2(p.z), phi: azimuth(p.x, p.y) }
    }

    /// `r (cos φ sin θ, sin φ sin θ, cos θ)`.
    pub fn to_cartesian(self) -> DVec3 {
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (self.theta.sin_cos(), self.phi.sin_cos());
        self.r * DVec3::new(cos_phi * sin_theta, sin_phi * sin_theta, cos_theta)
    }
}

/// The angle of `(x, y)` in `[0, 2π)`. The library function gives `(−π, π]` and tells `−0` from `0`; here zero is zero.
fn azimuth(x: f64, y: f64) -> f64 {
    if x == 0.0 && y == 0.0 {
        return 0.0;
    }
    let phi = (y + 0.0).atan2(x);
    let phi = if phi < 0.0 { phi + TAU } else { phi };
    if phi < TAU { phi } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    /// The five cases in which textbooks write the angle.
    fn by_cases(x: f64, y: f64) -> f64 {
        if x > 0.0 && y >= 0.0 {
            (y / x).atan()
        } else if x > 0.0 {
            (y / x).atan() + TAU
        } else if x < 0.0 {
            (y / x).atan() + PI
        } else if y > 0.0 {
            FRAC_PI_2
        } else {
            1.5 * PI
        }
    }

    #[test]
    fn quadrants_and_axes() {
        for (p, phi) in [
            ([1.0, 0.0], 0.0),
            ([1.0, -0.0], 0.0),
            ([1.0, 1.0], FRAC_PI_4),
            ([0.0, 2.0], FRAC_PI_2),
            ([-1.0, 1.0], 3.0 * FRAC_PI_4),
            ([-3.0, 0.0], PI),
            ([-3.0, -0.0], PI),
            ([-1.0, -1.0], 5.0 * FRAC_PI_4),
            ([0.0, -1.0], 1.5 * PI),
            ([1.0, -1.0], 7.0 * FRAC_PI_4),
            ([0.0, -0.0], 0.0),
            ([1.0, -1e-300], 0.0),
        ] {
            let polar = Polar::from_cartesian(DVec2::from(p));
            assert!((polar.phi - phi).abs() < 1e-15 && polar.phi < TAU, "{p:?}: {}", polar.phi);
        }
    }

    #[test]
    fn round_trips() {
        let mut r = Random::new(5);
        for _ in 0..10_000 {
            let p = r.vector2();
            let polar = Polar::from_cartesian(p);
            assert!((0.0..TAU).contains(&polar.phi) && (polar.phi - by_cases(p.x, p.y)).abs() < 1e-14);
            assert!((polar.to_cartesian() - p).length() < 4e-15);
            let v = r.vector() * 5.0;
            let s = Spherical::from_cartesian(v);
            assert!((0.0..=PI).contains(&s.theta) && (0.0..TAU).contains(&s.phi));
            assert!((s.to_cartesian() - v).length() < 1e-14);
        }
    }

    #[test]
    fn poles_and_origin() {
        assert_eq!(Spherical::from_cartesian(DVec3::Z * 2.0), Spherical { r: 2.0, theta: 0.0, phi: 0.0 });
        assert_eq!(Spherical::from_cartesian(-DVec3::Z), Spherical { r: 1.0, theta: PI, phi: 0.0 });
        assert_eq!(Spherical::from_cartesian(DVec3::ZERO), Spherical { r: 0.0, theta: 0.0, phi: 0.0 });
        // arccos(z/r) has lost this angle altogether.
        let near = Spherical::from_cartesian(DVec3::new(1e-9, 0.0, 1.0));
        assert!((near.theta / 1e-9 - 1.0).abs() < 1e-15);
    }
}
