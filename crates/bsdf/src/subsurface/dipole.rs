//! The dipole (Jensen et al. 2001, "A Practical Model for Subsurface Light Transport"): light that enters scatters
//! first at one mean free path below the surface, a point source there and its image above fulfil the boundary
//! condition.

use super::profile::{ProfileTable, internal_moment};

/// The distance of the image from the boundary, in units of that of the source: `A = (1 + F)/(1 − F)` with the mean
/// reflectance of diffuse light from within.
fn mismatch(eta: f64) -> f64 {
    // Diffuse reflectance from within: F_dr = 2 ∫ F μ dμ.
    let reflected = 2.0 * internal_moment(eta, 1);
    (1.0 + reflected) / (1.0 - reflected)
}

/// `2π r R_d(r)` for the reduced albedo α′ and lengths in reduced mean free paths (eq. 4).
fn ring(albedo: f64, r: f64, mismatch: f64) -> f64 {
    // Effective transport coefficient √(3 σ_a σ_t'), in units of the reduced extinction.
    let transport = (3.0 * (1.0 - albedo)).sqrt();
    let source = 1.0;
    // Source one mean free path deep; its image above mirrors it at the extrapolated boundary.
    let image = source + 4.0 * mismatch / 3.0;
    let of = |z: f64| {
        let d = (r * r + z * z).sqrt();
        z * (1.0 + transport * d) * (-transport * d).exp() / (d * d * d)
    };
    0.5 * albedo * r * (of(source) + of(image))
}

/// Its table for a medium of this index.
pub fn dipole(eta: f32) -> ProfileTable {
    let mismatch = mismatch(f64::from(eta));
    ProfileTable::new(|albedo, r| ring(albedo, r, mismatch))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral over the plane has a closed form (Jensen et al. 2001, eq. 15):
    /// `R = α′/2 (1 + e^{−4A√(3(1−α′))/3}) e^{−√(3(1−α′))}`.
    #[test]
    fn all_light_that_leaves_is_the_closed_form() {
        for eta in [1.0f32, 1.33, 1.5] {
            let (table, a) = (dipole(eta), mismatch(f64::from(eta)));
            for albedo in [0.1f64, 0.5, 0.9, 0.99, 0.999] {
                let x = (3.0 * (1.0 - albedo)).sqrt();
                let expected = 0.5 * albedo * (1.0 + (-4.0 / 3.0 * a * x).exp()) * (-x).exp();
                let found = f64::from(table.albedo(albedo as f32));
                // Between rows of the table it is linear.
                assert!(
                    (found - expected).abs() < 3e-3 * expected + 2e-4,
                    "η {eta}, α′ {albedo}: {found}, not {expected}"
                );
                let back = table.single_scattering_albedo(found as f32);
                assert!((f64::from(back) - albedo).abs() < 1e-3, "{back} for {albedo}");
            }
        }
    }

    /// Diffuse light from within is reflected by 0.472 at an index of 1.33 and 0.596 at 1.5 (Egan and Hilgeman 1979).
    #[test]
    fn reflection_from_within_has_its_published_mean() {
        for (eta, expected) in [(1.0, 0.0), (1.33, 0.472), (1.5, 0.596)] {
            let found = 2.0 * internal_moment(eta, 1);
            assert!((found - expected).abs() < 2e-3, "{found}");
        }
    }
}
