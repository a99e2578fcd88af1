//! Closed forms over a globe so large that it is flat, and what comes in and goes out.

use super::{
    super::{medium::TOP, moments, orders::Orders, path::Sunward},
    *,
};
use steradian_math::quadrature::gauss_legendre;

fn flat(contents: Contents, ground: f32) -> Medium {
    let mut medium = Medium::new(&contents, [ground; BANDS]);
    medium.radius = 6.371e6;
    medium
}

const CLEAN: Contents = Contents { ozone: 0.0, aerosol: 0.0, ..Contents::CLEAR };

/// Light that is scattered once, of layers whatever their heights: `p μ₀/(μ₀ − μ) (e^(−τ/μ₀) − e^(−τ/μ))`.
#[test]
fn single_scattering() {
    for dust in [0.0, 0.2] {
        let contents = Contents { aerosol: dust, pressure: if dust > 0.0 { 1e-6 } else { 1013.25 }, ..CLEAN };
        let medium = flat(contents, 0.5);
        for sun in [25.0f64, 70.0] {
            let eye = Eye::new(&medium, sun.to_radians().sin(), false);
            for (to, azimuth) in [(90.0, 0.0), (50.0, 40.0), (20.0, 170.0), (32.0, 0.0)] {
                let way = way(0.0, sun, to, azimuth);
                let found = seen(&eye, &medium, &way);
                for band in [0, 20, 47] {
                    let (a, b) = medium.molecules(band);
                    let (nu, o) = (way.nu as f32, &medium.optics);
                    let phase = if dust > 0.0 { 0.95 * aerosols(medium.g, nu) } else { a + b * nu * nu };
                    let tau = f64::from(o.rayleigh[band] + o.aerosol[band]);
                    let (mu, sun) = (way.mu, way.mu_sun);
                    let closed = f64::from(phase) * sun / (sun - mu) * ((-tau / sun).exp() - (-tau / mu).exp());
                    assert!(
                        (f64::from(found[band]) / closed - 1.0).abs() < 0.01,
                        "{dust} {sun} {to} {band}: {} {closed}",
                        found[band]
                    );
                }
            }
        }
    }
}

/// Energy is conserved in air without absorption: the light that arrives leaves upwards or is left to the ground,
/// within a fiftieth for ground that reflects all, of which the series of orders is the longest.
#[test]
fn light_is_kept() {
    for (dust, ground) in [(0.0, 0.0), (0.0, 1.0), (0.3, 0.0), (0.3, 1.0)] {
        let contents = Contents { aerosol: dust, aerosol_albedo: 1.0, ..CLEAN };
        let mut medium = flat(contents, ground);
        medium.optics = medium.optics.without_forward(moments::of_aerosols(medium.g).0);
        let sunward = Sunward::new(&medium);
        for sun in [60.0f64, 25.0] {
            let mu_sun = sun.to_radians().sin();
            let orders = Orders::new(&medium, mu_sun.acos(), &sunward);
            // Through a level plane at a height, from above or from below.
            let flux = |height: f64, side: f64| {
                let mut sum = [0.0_f64; 16];
                for (x, weight) in gauss_legendre(12) {
                    let mu = side * 0.5 * (x + 1.0);
                    for k in 0..8 {
                        let across = (1.0 - mu * mu).sqrt() * (std::f64::consts::PI * (f64::from(k) + 0.5) / 8.0).cos();
                        let nu = across * (1.0 - mu_sun * mu_sun).sqrt() + mu * mu_sun;
                        let way = Way { height, mu, mu_sun, nu, can_hit: true };
                        let once = orders.light(&medium, None, &sunward, &way);
                        let again = orders.light(&medium, Some(&orders), &sunward, &way);
                        let w = weight * 0.5 * std::f64::consts::PI / 4.0 * mu.abs();
                        (0..16).for_each(|b| sum[b] += w * f64::from(once[b] + again[b]));
                    }
                }
                sum
            };
            let (up, down) = (flux(TOP - 1.0, -1.0), flux(0.0, 1.0));
            for b in [0, 3, 8, 15] {
                let tau = f64::from(medium.optics.rayleigh[3 * b] + medium.optics.aerosol[3 * b]);
                let kept = (1.0 - f64::from(ground)) * (down[b] + mu_sun * (-tau / mu_sun).exp());
                let balance = (up[b] + kept) / mu_sun;
                assert!((balance - 1.0).abs() < 0.02, "{dust} {ground} {sun} {b}: {balance}");
            }
        }
    }
}
