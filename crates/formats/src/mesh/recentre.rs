//! Models in coordinates of a country, which single precision has no room for, are moved near the origin.

/// Coordinates from here on have steps of 1/128 and more in single precision.
pub const FAR: f64 = 65_536.0;

/// What is taken from all positions of a model whose first is this: whole numbers, so that it can be added again
/// without an error; zero along axes that are not far.
pub(super) fn origin(first: [f64; 3]) -> [f64; 3] {
    first.map(|v| if v.abs() >= FAR && v.abs() <= f64::from(f32::MAX) { v.round() } else { 0.0 })
}
