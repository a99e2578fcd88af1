//! One-dimensional warps: exponential distances and the tent filter.

/// A distance with density `rate·e^(−rate·t)` on `[0, ∞)`, by inversion: `−ln(1 − u)/rate`. Infinite for a rate of zero, unless
/// `u` is zero too (then 0/0: the caller skips empty media).
#[inline]
pub fn exponential(u: f32, rate: f32) -> f32 {
    -(-u).ln_1p() / rate
}

/// Density of [`exponential`].
#[inline]
pub fn exponential_pdf(t: f32, rate: f32) -> f32 {
    rate * (-rate * t).exp()
}

/// A number with density `(1 − |x|/r)/r` on `[−r, r]`: the tent filter of half-width `r`. Continuous and increasing in `u`.
#[inline]
pub fn tent(u: f32, r: f32) -> f32 {
    if u < 0.5 { r * ((2.0 * u).sqrt() - 1.0) } else { r * (1.0 - (2.0 * (1.0 - u)).sqrt()) }
}

/// Density of [`tent`].
#[inline]
pub fn tent_pdf(x: f32, r: f32) -> f32 {
    (1.0 - x.abs() / r).max(0.0) / r
}
