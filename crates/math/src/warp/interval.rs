//! One-dimensional warps: exponential distances and the tent filter.

use crate::elementary;

/// A distance with density `rate·e^(−rate·t)` on `[0, ∞)`, by inversion: `−ln(1 − u)/rate`. Infinite for a rate of
/// zero, unless `u` is zero too (then 0/0: the caller skips empty media).
#[inline(always)]
pub fn exponential(u: f32, rate: f32) -> f32 {
    -elementary::ln_1p(-u) / rate
}

/// Density of [`exponential`].
#[inline]
pub fn exponential_pdf(t: f32, rate: f32) -> f32 {
    rate * elementary::exp(-rate * t)
}

/// A number with density `(1 − |x|/r)/r` on `[−r, r]`: the tent filter of half-width `r`. Continuous and increasing in
/// `u`.
#[inline]
pub fn tent(u: f32, r: f32) -> f32 {
    if u < 0.5 { r * ((2.0 * u).sqrt() - 1.0) } else { r * (1.0 - (2.0 * (1.0 - u)).sqrt()) }
}

/// Density of [`tent`].
#[inline]
pub fn tent_pdf(x: f32, r: f32) -> f32 {
    (1.0 - x.abs() / r).max(0.0) / r
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::test_rectangle;
    use crate::hash::ONE_MINUS_EPSILON;

    #[test]
    fn exponential_distances_follow_their_density() {
        let (rate, end) = (1.7_f32, 12.0);
        let density = |t: f64, _| f64::from(exponential_pdf(t as f32, rate));
        test_rectangle(
            "exponential",
            (end, 1.0),
            (60, 1),
            200_000,
            |u| (f64::from(exponential(u.x, rate)).min(end), f64::from(u.y)),
            density,
        );
        assert_eq!(exponential(0.0, rate), 0.0);
        assert!(exponential(ONE_MINUS_EPSILON, rate).is_finite());
        // ln(1 − u) would lose all digits here.
        assert!((exponential(1e-9, 1.0) / 1e-9 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn tent_points_follow_their_density() {
        let r = 1.5_f32;
        let density = |x: f64, _| f64::from(tent_pdf(x as f32 - r, r));
        test_rectangle(
            "tent",
            (2.0 * f64::from(r), 1.0),
            (30, 1),
            200_000,
            |u| (f64::from(tent(u.x, r) + r), f64::from(u.y)),
            density,
        );
        assert_eq!((tent(0.0, r), tent(0.5, r)), (-r, 0.0));
    }
}
