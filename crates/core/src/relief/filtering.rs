//! Normals that are averaged leave their spread to the roughness: Toksvig's estimate from the length of the mean, and
//! LEAN mapping from the second moments of the slopes.

use steradian_math::{Vec2, Vec3};

/// The Blinn–Phong exponent (the lecture calls it roughness; it is a power: E55) of normals whose mean has length
/// `len`, for a surface of exponent `power`: `len·s/(len + s (1 − len))` (Toksvig, "Mipmapping Normal Maps", 2005).
pub fn toksvig_power(power: f32, len: f32) -> f32 {
    let len = len.clamp(0.0, 1.0);
    let d = len + power * (1.0 - len);
    if d > 0.0 { len * power / d } else { 0.0 }
}

/// Toksvig's factor for the α of Beckmann and GGX, by `s = 2/α² − 2` (Walter et al. 2007): the factor turns into a sum
/// of the variances of slopes, `α'² ≈ α² + 2 (1 − len)/len` for small α.
pub fn toksvig_alpha(alpha: f32, len: f32) -> f32 {
    if len >= 1.0 {
        return alpha;
    }
    let a2 = (alpha * alpha).clamp(1e-8, 1.0);
    let power = toksvig_power(2.0 / a2 - 2.0, len);
    (2.0 / (power + 2.0)).sqrt().max(alpha)
}

/// Moments of the slopes `(n_x, n_y)/n_z` of a surface, which can be averaged (Olano, Baker, "LEAN Mapping", I3D 2010).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Mean of the slopes.
    pub mean: Vec2,
    /// Means of their squares.
    pub square: Vec2,
    /// Mean of their product.
    pub product: f32,
}

impl Moments {
    /// Moments of a single normal.
    pub fn of(n: Vec3) -> Self {
        // The slope of a surface that is seen edge-on is held at a thousand.
        let b = (n.truncate() / n.z.max(1e-3)).clamp(Vec2::splat(-1e3), Vec2::splat(1e3));
        Self { mean: b, square: b * b, product: b.x * b.y }
    }

    /// The mean of several.
    pub fn average(all: impl IntoIterator<Item = Self>) -> Self {
        let (mut sum, mut n) = (Self::default(), 0.0);
        for m in all {
            sum.mean += m.mean;
            sum.square += m.square;
            sum.product += m.product;
            n += 1.0;
        }
        if n > 0.0 { Self { mean: sum.mean / n, square: sum.square / n, product: sum.product / n } } else { sum }
    }

    /// The mean normal.
    pub fn normal(&self) -> Vec3 {
        self.mean.extend(1.0).normalize_or(Vec3::Z)
    }

    /// Variances of the slopes along u and v, and their covariance.
    pub fn covariance(&self) -> (Vec2, f32) {
        ((self.square - self.mean * self.mean).max(Vec2::ZERO), self.product - self.mean.x * self.mean.y)
    }

    /// The roughness along the axes of the slopes' ellipse for a surface of Beckmann roughness `alpha` (variance of
    /// slopes `α²/2`), and the angle of the first axis from u.
    pub fn roughness(&self, alpha: f32) -> (f32, f32, f32) {
        let (v, c) = self.covariance();
        let (mid, half) = (0.5 * (v.x + v.y), 0.5 * (v.x - v.y));
        let r = (half * half + c * c).sqrt();
        let along = |s: f32| (alpha * alpha + 2.0 * s.max(0.0)).sqrt();
        (along(mid + r), along(mid - r), 0.5 * c.atan2(half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    /// E55: what Toksvig's formula changes is the exponent of Blinn and Phong, which falls as normals spread; a
    /// roughness would rise.
    #[test]
    fn equal_normals_leave_the_roughness() {
        assert_eq!(toksvig_power(50.0, 1.0), 50.0);
        assert!(toksvig_power(50.0, 0.9) < 50.0 && toksvig_alpha(0.2, 0.9) > 0.2);
        assert!((toksvig_power(50.0, 0.9) - 45.0 / 5.9).abs() < 1e-5);
        assert_eq!((toksvig_power(50.0, 0.0), toksvig_alpha(0.3, 1.0)), (0.0, 0.3));
        assert_eq!(toksvig_alpha(0.0, 0.0), 1.0);
        let m = Moments::average([Vec3::new(0.6, 0.0, 0.8); 4].map(Moments::of));
        let (a, b, _) = m.roughness(0.25);
        assert!((a - 0.25).abs() < 1e-4 && (b - 0.25).abs() < 1e-4);
        assert!((m.normal() - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-6);
    }

    #[test]
    fn the_spread_of_slopes_becomes_roughness() {
        // Slopes of variance 0.02 along u and 0.005 along v, turned by 30°.
        let mut rng = HashRng::new(6);
        let (s, c) = std::f32::consts::FRAC_PI_6.sin_cos();
        let mut normals = Vec::new();
        for _ in 0..40_000 {
            // Sums of twelve numbers are nearly Gaussian, with variance one.
            let mut g = || (0..12).map(|_| rng.next_f32()).sum::<f32>() - 6.0;
            let (a, b) = (g() * 0.02_f32.sqrt(), g() * 0.005_f32.sqrt());
            normals.push(Vec3::new(a * c - b * s, a * s + b * c, 1.0).normalize());
        }
        let m = Moments::average(normals.iter().map(|n| Moments::of(*n)));
        let (major, minor, angle) = m.roughness(0.1);
        // α² = 0.01 + 2σ²; a percent of the variance is two standard errors of it.
        assert!((major * major - 0.05).abs() < 0.0012, "{major}");
        assert!((minor * minor - 0.02).abs() < 0.0004, "{minor}");
        assert!((angle - std::f32::consts::FRAC_PI_6).abs() < 0.02);
        // Toksvig has one roughness for both axes: between the two, and near the mean of the variances for small
        // spreads.
        let mean = normals.iter().sum::<Vec3>() / normals.len() as f32;
        let t = toksvig_alpha(0.1, mean.length());
        assert!(t > minor && t < major, "{minor} {t} {major}");
        assert!((t * t - 0.035).abs() < 0.003, "{}", t * t);
    }
}
