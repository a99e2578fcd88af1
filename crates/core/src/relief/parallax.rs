//! Parallax mapping: one step from the coordinates that a ray meets on the flat surface to those on the relief. The
//! raster pipeline's approximations, and the measure of the searches.
//!
//! Directions are in the tangent frame (x along u, y along v, z out of the surface), point to the viewer, and need no
//! unit length. Heights are in units of texture coordinates, above the surface where positive.

use steradian_math::{Vec2, Vec3};

/// The line of sight meets the plane of the height found at `uv`: `uv' = uv + h (Vx, Vy)/Vz` (Kaneko et al. 2001). It
/// grows without bound at grazing angles.
pub fn single_step(uv: Vec2, h: f32, v: Vec3) -> Vec2 {
    let offset = v.truncate() * (h / v.z);
    if offset.is_finite() { uv + offset } else { uv }
}

/// Parallax with the offset limited to the height: `uv' = uv + h (Vx, Vy)` for a unit `V` (Welsh 2004).
pub fn offset_limited(uv: Vec2, h: f32, v: Vec3) -> Vec2 {
    uv + v.normalize_or_zero().truncate() * h
}

/// The line of sight meets the plane through the point of the relief at `uv` with its normal `n`:
/// `uv' = uv + h n_z/(n·V) (Vx, Vy)` (Szirmay-Kalos, Umenhoffer, "Displacement Mapping on the GPU — State of the Art",
/// 2008).
pub fn with_slope(uv: Vec2, h: f32, n: Vec3, v: Vec3) -> Vec2 {
    let offset = v.truncate() * (h * n.z / n.dot(v));
    if offset.is_finite() { uv + offset } else { uv }
}

/// Parallax with slope and a limited offset: `uv' = uv + h n_z (Vx, Vy)` for unit `n` and `V`.
pub fn with_slope_limited(uv: Vec2, h: f32, n: Vec3, v: Vec3) -> Vec2 {
    uv + v.normalize_or_zero().truncate() * (h * n.normalize_or_zero().z)
}

/// Steps with slope, one after another: each goes from the place reached, whose point on the line of sight is
/// `q = (uv', z)`, to where the line meets the relief's tangent plane there (Premecz 2006).
pub fn iterated(uv: Vec2, v: Vec3, steps: u32, relief: impl Fn(Vec2) -> (f32, Vec3)) -> Vec2 {
    let v = v.normalize_or_zero();
    let mut q = uv.extend(0.0);
    for _ in 0..steps {
        let (h, n) = relief(q.truncate());
        // Along the line of sight, limited as above.
        q += v * ((h - q.z) * n.normalize_or_zero().z);
    }
    if q.is_finite() { q.truncate() } else { uv }
}

#[cfg(test)]
mod tests {
    use super::*;

    const V: Vec3 = Vec3::new(0.6, 0.0, 0.8);

    #[test]
    fn formulae_by_hand() {
        let uv = Vec2::new(0.5, 0.25);
        assert!((single_step(uv, 0.1, V) - Vec2::new(0.575, 0.25)).length() < 1e-6);
        assert!((offset_limited(uv, 0.1, V) - Vec2::new(0.56, 0.25)).length() < 1e-6);
        assert_eq!(with_slope(uv, 0.1, Vec3::Z, V), single_step(uv, 0.1, V));
        assert_eq!(with_slope_limited(uv, 0.1, Vec3::Z, V), offset_limited(uv, 0.1, V));
        let n = Vec3::new(-0.6, 0.0, 0.8);
        // n·V = 0.28: 0.1 × 0.8 × 0.6/0.28.
        assert!((with_slope(uv, 0.1, n, V).x - (0.5 + 0.048 / 0.28)).abs() < 1e-6);
        assert_eq!(single_step(uv, 0.1, Vec3::X), uv);
        assert_eq!(with_slope(uv, 0.1, Vec3::Z, Vec3::ZERO), uv);
    }

    #[test]
    fn what_each_form_is_exact_for() {
        // A relief of constant height: the single step. A tilted plane: the step with slope.
        let (h, k) = (0.2, 0.5);
        let plane = |uv: Vec2| h + k * uv.x;
        let n = Vec3::new(-k, 0.0, 1.0).normalize();
        let uv = Vec2::new(0.1, 0.7);
        let to = with_slope(uv, plane(uv), n, V);
        // On the line of sight: (to − uv)/Vx·Vz is its height there.
        assert!(((to.x - uv.x) / V.x * V.z - plane(to)).abs() < 1e-6);
        let to = single_step(uv, h, V);
        assert!(((to.x - uv.x) / V.x * V.z - h).abs() < 1e-6);
    }

    #[test]
    fn iteration_comes_closer() {
        let f = |x: f32| 0.03 * (6.0 * x).sin();
        let relief = |uv: Vec2| (f(uv.x), Vec3::new(-0.18 * (6.0 * uv.x).cos(), 0.0, 1.0).normalize());
        for x in [0.0_f32, 0.3, 0.77] {
            let uv = Vec2::new(x, 0.0);
            let off = |to: Vec2| ((to.x - x) / V.x * V.z - f(to.x)).abs();
            let errors: Vec<f32> = [1, 2, 4, 12].into_iter().map(|n| off(iterated(uv, V, n, relief))).collect();
            assert!(errors.windows(2).all(|e| e[1] <= e[0] + 1e-6), "{errors:?}");
            assert!(errors[3] < 1e-4, "{errors:?}");
        }
    }
}
