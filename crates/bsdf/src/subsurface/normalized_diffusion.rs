//! Normalised diffusion (Christensen and Burley 2015, "Approximate Reflectance Profiles for Efficient Subsurface
//! Scattering"): two exponentials that were fitted to what simulations of a half space give.

use super::profile::ProfileTable;

/// The scale of the exponentials by the albedo of the surface (eq. 6, for light that enters at right angles), in the
/// mean free path.
fn scale(albedo: f64) -> f64 {
    1.85 - albedo + 7.0 * (albedo - 0.8).abs().powi(3)
}

/// `2π r R(r) = A s (e^{−s r} + e^{−s r/3})/4` (eq. 3) for an albedo of the surface and lengths in mean free paths.
fn ring(albedo: f64, r: f64) -> f64 {
    let s = scale(albedo);
    0.25 * albedo * s * ((-s * r).exp() + (-s * r / 3.0).exp())
}

/// Its table, by the albedo of the surface.
pub fn normalized_diffusion() -> ProfileTable {
    ProfileTable::new(ring)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All light that leaves is the albedo, and of an albedo of 0.8, whose scale is 1.05, half of it within the radius
    /// at which `1 − e^{−x}/4 − 3 e^{−x/3}/4` is a half.
    #[test]
    fn all_light_that_leaves_is_the_albedo() {
        let table = normalized_diffusion();
        for albedo in [0.05f32, 0.3, 0.8, 0.97] {
            assert!((table.albedo(albedo) - albedo).abs() < 3e-3 * albedo, "{}", table.albedo(albedo));
        }
        let mut x = 1.0f64;
        for _ in 0..50 {
            let f = 1.0 - 0.25 * (-x).exp() - 0.75 * (-x / 3.0).exp() - 0.5;
            x -= f / (0.25 * (-x).exp() + 0.25 * (-x / 3.0).exp());
        }
        let (row, n) = (table.row(0.8), 10_000);
        let within = |i: &u32| f64::from(table.sample(row, (*i as f32 + 0.5) / n as f32)) < x / 1.05;
        let share = (0..n).filter(within).count() as f64 / f64::from(n);
        assert!((share - 0.5).abs() < 2e-3, "{share} within {}", x / 1.05);
    }
}
