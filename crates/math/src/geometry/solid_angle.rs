//! Solid angles: the spherical Jacobian, the area of spherical sets, and the solid angle of area elements. In
//! steradians.

use crate::quadrature::gauss_legendre;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The Jacobian determinant `r² sin θ` of spherical coordinates: `dV = r² sinθ dr dθ dφ`, `dω = sinθ dθ dφ`.
pub fn spherical_jacobian(r: f64, theta: f64) -> f64 {
    r * r * theta.sin()
}

/// The integral of `f` over all directions: Gauss–Legendre in `cos θ` (with `n` points, which absorbs the Jacobian),
/// and the trapezoid rule in `φ` (with `2n`), which together integrate spherical harmonics up to degree `2n − 1`
/// exactly.
pub fn integrate_sphere(f: impl Fn(DVec3) -> f64, n: usize) -> f64 {
    let n = n.max(1);
    let step = TAU / (2 * n) as f64;
    let mut sum = 0.0;
    for (z, w) in gauss_legendre(n) {
        let r = ((1.0 - z) * (1.0 + z)).sqrt();
        for k in 0..2 * n {
            let (sin, cos) = ((k as f64 + 0.5) * step).sin_cos();
            sum += w * f(DVec3::new(r * cos, r * sin, z));
        }
    }
    sum * step
}

/// Area of a set of directions given by its indicator function, from `n` points of a Fibonacci lattice (all of the same
/// area): the error falls as about `n^−3/4` for sets with a smooth border.
pub fn of_set(contains: impl Fn(DVec3) -> bool, n: usize) -> f64 {
    let n = n.max(1);
    // The golden angle.
    let turn = PI * (3.0 - 5.0_f64.sqrt());
    let inside = (0..n)
        .filter(|&i| {
            let z = 1.0 - (2 * i + 1) as f64 / n as f64;
            let r = (1.0 - z * z).sqrt();
            let (sin, cos) = (turn * i as f64).sin_cos();
            contains(DVec3::new(r * cos, r * sin, z))
        })
        .count();
    4.0 * PI * inside as f64 / n as f64
}

/// The cap of half-angle `alpha`: `2π(1 − cos α)`, as `4π sin²(α/2)`, which keeps small caps precise.
pub fn cap(alpha: f64) -> f64 {
    4.0 * PI * (0.5 * alpha).sin().powi(2)
}

/// The lune between two half-planes at an angle through an axis: `2 α`.
pub fn lune(angle: f64) -> f64 {
    2.0 * angle
}

/// The spherical triangle of three unit vectors by Girard's theorem: the sum of its angles less `π`. Loses the digits
/// of small triangles; see [`triangle`].
pub fn triangle_girard(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let angle = |p: DVec3, q: DVec3, r: DVec3| super::vector::angle_between(p.cross(q), p.cross(r));
    angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - PI
}

/// The solid angle of the triangle of three vectors of any length but zero (van Oosterom and Strackee 1983); precise
/// for small ones too.
pub fn triangle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let (a, b, c) = (a.normalize_or_zero(), b.normalize_or_zero(), c.normalize_or_zero());
    2.0 * a.dot((b - a).cross(c - a)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// The rectangle `[x0, x1] × [y0, y1]` of the plane at the distance `z > 0` from the eye: a sum over its corners of
/// `± arctan(xy / (z √(x² + y² + z²)))`.
pub fn rectangle(x: [f64; 2], y: [f64; 2], z: f64) -> f64 {
    let corner = |x: f64, y: f64| (x * y).atan2(z * (x * x + y * y + z * z).sqrt());
    (corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0])).abs()
}

/// Solid angle per area of an element at `x` (from the eye) with the unit normal `n`: `dω/dA = |⟨n, x⟩| / |x|³`.
pub fn area_element(n: DVec3, x: DVec3) -> f64 {
    let r2 = x.length_squared();
    n.dot(x).abs() / (r2 * r2.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::coordinates::Spherical;
    use crate::geometry::random::Random;
    use crate::quadrature::integrate;

    #[test]
    fn the_sphere_has_four_pi() {
        assert!((integrate_sphere(|_| 1.0, 4) - 4.0 * PI).abs() < 1e-13);
        assert!((integrate(|t| TAU * spherical_jacobian(1.0, t), 0.0, PI, 20) - 4.0 * PI).abs() < 1e-13);
        // Moments of the coordinates: ∫x² = 4π/3, ∫x⁴ = 4π/5, ∫x²y² = 4π/15, odd ones vanish.
        assert!((integrate_sphere(|d| d.x * d.x, 4) - 4.0 * PI / 3.0).abs() < 1e-13);
        assert!((integrate_sphere(|d| d.x.powi(4), 4) - 4.0 * PI / 5.0).abs() < 1e-13);
        assert!((integrate_sphere(|d| (d.x * d.y).powi(2), 4) - 4.0 * PI / 15.0).abs() < 1e-13);
        assert!(integrate_sphere(|d| d.x * d.y * d.z + d.z.powi(3), 4).abs() < 1e-13);
    }

    #[test]
    fn the_jacobian_is_the_determinant_of_the_map() {
        let mut r = Random::new(18);
        for _ in 0..200 {
            let s = Spherical { r: 1.5 + r.number(), theta: 1.57 + 1.5 * r.number(), phi: 3.0 + 3.0 * r.number() };
            let h = 1e-5;
            let d = |a: Spherical, b: Spherical| (a.to_cartesian() - b.to_cartesian()) / (2.0 * h);
            let dr = d(Spherical { r: s.r + h, ..s }, Spherical { r: s.r - h, ..s });
            let dt = d(Spherical { theta: s.theta + h, ..s }, Spherical { theta: s.theta - h, ..s });
            let dp = d(Spherical { phi: s.phi + h, ..s }, Spherical { phi: s.phi - h, ..s });
            let det = crate::geometry::vector::determinant(dr, dt, dp);
            assert!((det - spherical_jacobian(s.r, s.theta)).abs() < 1e-7, "{det}");
        }
    }

    #[test]
    fn caps_and_lunes() {
        for alpha in [0.1, 1.0, 2.5, PI] {
            assert!((cap(alpha) - TAU * (1.0 - alpha.cos())).abs() < 1e-13);
            let axis = DVec3::new(1.0, 2.0, -0.5).normalize();
            let counted = of_set(|d| d.dot(axis) > alpha.cos(), 200_000);
            assert!((counted - cap(alpha)).abs() < 2e-3, "{alpha}: {counted}");
            let counted = of_set(|d| Spherical::from_cartesian(d).phi < alpha, 200_000);
            assert!((counted - lune(alpha)).abs() < 2e-3, "{alpha}: {counted}");
        }
        assert!((cap(1e-9) / (PI * 1e-18) - 1.0).abs() < 1e-12);
        assert!((lune(TAU) - 4.0 * PI).abs() < 1e-15);
    }

    #[test]
    fn triangles_by_three_ways() {
        assert!((triangle(DVec3::X, DVec3::Y, DVec3::Z) - PI / 2.0).abs() < 1e-15);
        assert!((triangle_girard(DVec3::X, DVec3::Y, DVec3::Z) - PI / 2.0).abs() < 1e-15);
        let mut r = Random::new(19);
        for i in 0..200 {
            let (a, b, c) = (r.direction(), r.direction(), r.direction());
            let area = triangle(a, b, c);
            assert!((area - triangle_girard(a, b, c)).abs() < 1e-9);
            if i < 10 {
                let side = a.cross(b).dot(c).signum();
                let counted =
                    of_set(|d| [(a, b), (b, c), (c, a)].iter().all(|(p, q)| p.cross(*q).dot(d) * side > 0.0), 100_000);
                assert!((counted - area).abs() < 4e-3, "{counted} {area}");
            }
        }
        // A small triangle: flat, at distance one.
        let e = 1e-6;
        let small = triangle(DVec3::Z, DVec3::new(e, 0.0, 1.0), DVec3::new(0.0, e, 1.0));
        assert!((small / (0.5 * e * e) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn rectangles_and_area_elements() {
        // One face of a cube sees a sixth of the sphere.
        assert!((rectangle([-1.0, 1.0], [-1.0, 1.0], 1.0) - 4.0 * PI / 6.0).abs() < 1e-14);
        for (x, y, z) in [([-0.5, 2.0], [0.3, 1.0], 0.7), ([1.0, 1.2], [-3.0, -1.0], 2.0)] {
            let by_elements = integrate(
                |s| integrate(|t| area_element(DVec3::Z, DVec3::new(s, t, z)), y[0], y[1], 40),
                x[0],
                x[1],
                40,
            );
            assert!((rectangle(x, y, z) - by_elements).abs() < 1e-9);
            let corner = |i: usize, j: usize| DVec3::new(x[i], y[j], z);
            let halves =
                triangle(corner(0, 0), corner(1, 0), corner(1, 1)) + triangle(corner(0, 0), corner(1, 1), corner(0, 1));
            assert!((rectangle(x, y, z) - halves).abs() < 1e-12);
        }
        // A patch of a sphere of radius r seen from its centre: dω = dA/r².
        let x = DVec3::new(0.6, 0.0, 0.8) * 3.0;
        assert!((area_element(x.normalize(), x) - 1.0 / 9.0).abs() < 1e-15);
        // Seen from inside anywhere, the elements of a closed surface add up to 4π.
        let eye = DVec3::new(0.3, -0.5, 0.2);
        let total = integrate_sphere(|n| area_element(n, n - eye), 60);
        assert!((total - 4.0 * PI).abs() < 1e-9);
    }
}
