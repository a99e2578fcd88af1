//! Maps from the unit square to the domains that rendering integrates over, with their densities.
//!
//! Every map takes `u ∈ [0,1)²` (or `u ∈ [0,1)`), is continuous where the domain allows it (so stratified points stay
//! stratified) and allocates nothing. Hemispheres lie around `+z`. Densities are per solid angle (1/sr) unless said
//! otherwise.

mod equal_area;
mod interval;
mod latlong;
mod phase;
mod spherical_rectangle;
mod spherical_triangle;

pub use equal_area::{equal_area_sphere_to_square, equal_area_square_to_sphere, wrap_equal_area_square};
pub use interval::{exponential, exponential_pdf, tent, tent_pdf};
pub use latlong::{direction_from_latlong, latlong_from_direction, spherical_angles, spherical_direction};
pub use phase::{hg_phase, sample_hg};
pub use spherical_rectangle::SphericalRectangle;
pub use spherical_triangle::{spherical_triangle, spherical_triangle_area, spherical_triangle_pdf};

use crate::{Vec2, Vec3, elementary::sin_cos_octant};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

/// Density of [`uniform_hemisphere`], `1/2π`.
pub const UNIFORM_HEMISPHERE_PDF: f32 = 0.5 * FRAC_1_PI;

/// Density of [`uniform_sphere`], `1/4π`.
pub const UNIFORM_SPHERE_PDF: f32 = 0.25 * FRAC_1_PI;

/// A uniform point of the unit disk in polar form, for directions about an axis.
#[derive(Clone, Copy, Debug)]
pub struct DiskPoint {
    /// Distance from the centre, in `[0, 1]`, of which the square is uniform.
    pub radius: f32,
    /// Unit vector from the centre to the point.
    pub azimuth: Vec2,
}

impl DiskPoint {
    /// The concentric map (Shirley and Chiu 1997): concentric squares go to concentric circles. Density `1/π` per area.
    #[inline(always)]
    pub fn new(u: Vec2) -> Self {
        let p = 2.0 * u - Vec2::ONE;
        let (x, y) = (p.x.abs(), p.y.abs());
        // Along the longer axis the cosine, with its sign. The middle is no exception: zero over the smallest number.
        let is_high = x <= y;
        let (long, short) = if is_high { (p.y, p.x) } else { (p.x, p.y) };
        let (sin, cos) = sin_cos_octant(short / long.abs().max(f32::MIN_POSITIVE));
        let cos = cos.copysign(long);
        let azimuth = if is_high { Vec2::new(sin, cos) } else { Vec2::new(cos, sin) };
        Self { radius: if x > y { x } else { y }, azimuth }
    }

    /// The point itself.
    #[inline(always)]
    pub fn point(self) -> Vec2 {
        self.radius * self.azimuth
    }

    /// The unit direction above it: density `cosθ/π`, by Malley's method.
    #[inline(always)]
    pub fn lifted(self) -> Vec3 {
        self.point().extend(((1.0 - self.radius) * (1.0 + self.radius)).sqrt())
    }
}

/// A uniform point of the unit disk, by [`DiskPoint`].
#[inline]
pub fn concentric_disk(u: Vec2) -> Vec2 {
    DiskPoint::new(u).point()
}

/// A direction with density `cosθ/π`, by Malley's method: a uniform point of the disk, lifted to the hemisphere.
#[inline(always)]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    DiskPoint::new(u).lifted()
}

/// Density of [`cosine_hemisphere`]; zero below the horizon.
#[inline]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// A direction uniform in solid angle over the upper hemisphere: `cosθ = 1 − u.x`.
#[inline]
pub fn uniform_hemisphere(u: Vec2) -> Vec3 {
    uniform_cone(u, 1.0)
}

/// A direction of the upper hemisphere uniform in the two angles, `θ = u.x·π/2`, `φ = 2π·u.y`.
#[inline]
pub fn uniform_angle_hemisphere(u: Vec2) -> Vec3 {
    let (sin_theta, cos_theta) = (u.x * FRAC_PI_2).sin_cos();
    spherical_direction(sin_theta, cos_theta, TAU * u.y)
}

/// Density of [`uniform_angle_hemisphere`], `1/(π² sinθ)`: unbounded at the pole.
#[inline]
pub fn uniform_angle_hemisphere_pdf(sin_theta: f32) -> f32 {
    1.0 / (PI * PI * sin_theta)
}

/// A direction uniform in solid angle over the whole sphere: `cosθ = 1 − 2u.x`.
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    uniform_cone(u, 2.0)
}

/// A direction uniform in solid angle within the cone around `+z` whose half-angle `α` is given as `1 − cosα`.
///
/// The cone is given by `1 − cosα` and not by the cosine because `sinθ = √(x(2 − x))`, `x = 1 − cosθ`, keeps full
/// precision for the smallest cones, where the cosine rounds to one.
#[inline]
pub fn uniform_cone(u: Vec2, one_minus_cos_max: f32) -> Vec3 {
    let x = u.x * one_minus_cos_max;
    let sin_theta = (x * (2.0 - x)).max(0.0).sqrt();
    spherical_direction(sin_theta, 1.0 - x, TAU * u.y)
}

/// Density of [`uniform_cone`], `1/(2π(1 − cosα))`.
#[inline]
pub fn uniform_cone_pdf(one_minus_cos_max: f32) -> f32 {
    1.0 / (TAU * one_minus_cos_max)
}

/// Barycentric coordinates of a uniform point of a triangle, with little distortion (Heitz 2019). Density `1/area` per
/// area.
#[inline(always)]
pub fn uniform_triangle(u: Vec2) -> [f32; 3] {
    let (b0, b1) = if u.x < u.y {
        let b0 = 0.5 * u.x;
        (b0, u.y - b0)
    } else {
        let b1 = 0.5 * u.y;
        (u.x - b1, b1)
    };
    [b0, b1, (1.0 - b0 - b1).max(0.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::{test_rectangle, test_sphere};
    use crate::hash::{HashRng, ONE_MINUS_EPSILON};

    const N: usize = 200_000;

    #[test]
    fn hemispheres_and_spheres_follow_their_densities() {
        let up = |d: Vec3, p: f32| if d.z > 0.0 { f64::from(p) } else { 0.0 };
        test_sphere("cosine", N, cosine_hemisphere, |d| f64::from(cosine_hemisphere_pdf(d.z)));
        test_sphere("uniform hemisphere", N, uniform_hemisphere, |d| up(d, UNIFORM_HEMISPHERE_PDF));
        test_sphere("uniform angle", N, uniform_angle_hemisphere, |d| {
            up(d, uniform_angle_hemisphere_pdf(d.x.hypot(d.y)))
        });
        test_sphere("uniform sphere", N, uniform_sphere, |_| f64::from(UNIFORM_SPHERE_PDF));
        test_sphere("equal area", N, equal_area_square_to_sphere, |_| f64::from(UNIFORM_SPHERE_PDF));
    }

    #[test]
    fn mean_cosines_are_the_known_ones() {
        // E[cosθ]: 2/π for uniform angles (M146), 1/2 for uniform solid angle (M147), 2/3 for cosine weights (M148).
        type Map = fn(Vec2) -> Vec3;
        let maps: [(Map, f64); 3] = [
            (uniform_angle_hemisphere, 2.0 / std::f64::consts::PI),
            (uniform_hemisphere, 0.5),
            (cosine_hemisphere, 2.0 / 3.0),
        ];
        for (map, mean) in maps {
            let n = 256;
            let sum: f64 =
                (0..n * n).map(|i| map((Vec2::new((i % n) as f32, (i / n) as f32) + 0.5) / n as f32).z as f64).sum();
            assert!((sum / (n * n) as f64 - mean).abs() < 5e-4);
        }
        // A Lambert surface under a constant sky has zero variance: cosθ/π/pdf is one for every sample.
        for d in [cosine_hemisphere(Vec2::new(0.1, 0.2)), cosine_hemisphere(Vec2::new(0.7, 0.9))] {
            assert!((d.z * FRAC_1_PI / cosine_hemisphere_pdf(d.z) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_disk_is_uniform_and_keeps_the_corners_inside() {
        test_rectangle(
            "disk",
            (1.0, std::f64::consts::TAU),
            (12, 24),
            N,
            |u| {
                let d = concentric_disk(u).as_dvec2();
                (d.length_squared().min(1.0), d.y.atan2(d.x).rem_euclid(std::f64::consts::TAU))
            },
            |_, _| 1.0 / std::f64::consts::TAU,
        );
        assert_eq!(concentric_disk(Vec2::splat(0.5)), Vec2::ZERO);
        for u in [Vec2::ZERO, Vec2::new(0.0, ONE_MINUS_EPSILON), Vec2::splat(ONE_MINUS_EPSILON)] {
            let d = concentric_disk(u);
            assert!(d.is_finite() && d.length() < 1.0 + 1e-6);
            let c = cosine_hemisphere(u);
            assert!(c.is_finite() && c.z >= 0.0);
        }
    }

    #[test]
    fn cones_are_uniform_down_to_the_smallest() {
        let wide = 0.4;
        test_sphere(
            "cone",
            N,
            |u| uniform_cone(u, wide),
            |d| {
                if d.z > 1.0 - wide { f64::from(uniform_cone_pdf(wide)) } else { 0.0 }
            },
        );
        // The mean of sin²θ in a small cone of half-angle α is α²/2: at α = 1e-6 a cosine in f32 has no digits left.
        let alpha = 1e-6_f64;
        let m = (2.0 * (0.5 * alpha).sin().powi(2)) as f32;
        let mut rng = HashRng::new(1);
        let mean: f64 = (0..N)
            .map(|_| {
                let d = uniform_cone(Vec2::new(rng.next_f32(), rng.next_f32()), m).as_dvec3();
                d.x * d.x + d.y * d.y
            })
            .sum::<f64>()
            / N as f64;
        assert!((mean / (alpha * alpha / 2.0) - 1.0).abs() < 0.01, "{mean}");
    }

    #[test]
    fn triangle_points_are_uniform() {
        // (1 − b0)² and b1/(1 − b0) are independent and uniform exactly when the point is uniform in the triangle.
        test_rectangle(
            "triangle",
            (1.0, 1.0),
            (16, 16),
            N,
            |u| {
                let [b0, b1, b2] = uniform_triangle(u).map(f64::from);
                assert!((b0 + b1 + b2 - 1.0).abs() < 1e-6 && b0 >= 0.0 && b1 >= 0.0 && b2 >= 0.0);
                let rest = 1.0 - b0;
                (rest * rest, if rest > 0.0 { (b1 / rest).min(1.0) } else { 0.0 })
            },
            |_, _| 1.0,
        );
    }
}
