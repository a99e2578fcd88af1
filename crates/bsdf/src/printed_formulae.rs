//! Formulae that the lectures print wrongly (rows E3 to E14 and E46 of the inventory), each beside the right one: what
//! the printed form would give, and that ours does not.

use super::{BlinnPhong, Bsdf, Conductor, Microfacet, NormalDistribution, Phong, Shadowing, TransportMode, fresnel};
use steradian_math::{Spectrum, Vec3, color::transfer};
use steradian_testkit::integrate_sphere;

#[track_caller]
fn near(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} is not {b}");
}

/// E3, E4: facets reflect `F D G/(4 cosθ_o cosθ_i)`. Without the 4, with a π in its place, or with one cosine only, a
/// rough mirror seen from above (Beckmann, m = 0.2, V-grooves) returns up to four times the light it gets.
#[test]
fn facets_are_divided_by_four() {
    let facets = Microfacet::new(NormalDistribution::Beckmann, Shadowing::VGroove, 0.2, 0.2);
    let mirror = Bsdf::Conductor(Conductor::mirror(Spectrum::ONE, facets));
    let value = |wi: Vec3| f64::from(mirror.eval(Vec3::Z, wi, TransportMode::Radiance).value[0]);
    let albedo =
        |printed_over_ours: &dyn Fn(Vec3) -> f64| integrate_sphere(|wi| value(wi) * printed_over_ours(wi), 1e-4);
    near(albedo(&|_| 1.0), 1.000, 1e-3);
    near(albedo(&|_| 4.0), 4.00, 5e-3);
    near(albedo(&|wi| 4.0 * f64::from(wi.z)), 3.70, 5e-3);
    near(albedo(&|_| 4.0 / std::f64::consts::PI), 1.273, 2e-3);
}

/// E7, E8: a reflectance is the mean of the squared amplitudes: no square root of it, and no bound of one on their sum.
#[test]
fn reflectances_are_means_of_squares() {
    let squares = |degrees: f32| {
        let a = fresnel::dielectric_amplitudes(degrees.to_radians().cos(), 1.5).unwrap();
        [f64::from(a.s * a.s), f64::from(a.p * a.p)]
    };
    for degrees in [0.0, 30.0, 56.3099, 80.0, 89.0] {
        let [s, p] = squares(degrees);
        near(f64::from(fresnel::dielectric(degrees.to_radians().cos(), 1.5)), 0.5 * (s + p), 1e-6);
    }
    let [s, p] = squares(89.0);
    near(s + p, 1.81, 5e-3);
    let [s, p] = squares(0.0);
    near((0.5 * (s + p)).sqrt(), 0.20, 1e-6);
    // The printed program at Brewster's angle.
    let [s, p] = squares(56.3099);
    near(0.45 * 0.5 * (s + p) + 0.55 * (0.5 * (s * s + p * p)).sqrt(), 0.0908, 1e-4);
}

/// E10: Phong's lobe stands around `2(n·l)n − l`, and what is behind it is black, not `cosⁿ` of a negative cosine.
#[test]
fn phongs_lobe_is_on_the_mirrors_side() {
    let phong = |n| Bsdf::Phong(Phong::modified(Spectrum::ZERO, Spectrum::ONE, n));
    let l = Vec3::new(0.6, 0.0, 0.8);
    let value = |n: f32, v: Vec3| phong(n).eval(v, l, TransportMode::Radiance).value[0];
    assert!(value(20.0, Vec3::new(-0.6, 0.0, 0.8)) > 1.0 && value(20.0, l) < 1e-6);
    // More than 90° from the mirror direction, for an even exponent too.
    let behind = Vec3::new(0.96, 0.0, 0.28);
    assert!(behind.dot(Vec3::new(-0.6, 0.0, 0.8)) < 0.0);
    assert_eq!(value(2.0, behind), 0.0);
}

/// E11: near the mirror direction Blinn's lobe with four times the exponent falls off as Phong's, for the half vector
/// turns half as far.
#[test]
fn blinns_exponent_is_four_times_phongs() {
    let phong = Bsdf::Phong(Phong::modified(Spectrum::ZERO, Spectrum::ONE, 50.0));
    let blinn = |n| Bsdf::BlinnPhong(BlinnPhong::normalised(Spectrum::ZERO, Spectrum::ONE, n));
    let falloff = |b: Bsdf<'_>, degrees: f32| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let f = |wi: Vec3| f64::from(b.eval(Vec3::Z, wi, TransportMode::Radiance).value[0] / wi.z);
        f(Vec3::new(sin, 0.0, cos)) / f(Vec3::Z)
    };
    for degrees in [2.0f32, 5.0, 8.0] {
        near(falloff(blinn(200.0), degrees), falloff(phong, degrees), 2e-3);
        assert!(falloff(blinn(50.0), degrees) > falloff(phong, degrees) + 0.01);
    }
}

/// E46: the sRGB column of the table of reflectances at normal incidence follows from the linear one.
#[test]
fn the_table_of_reflectances_is_encoded_right() {
    near(f64::from(transfer::srgb_encode(0.03)), 0.190, 1e-3);
    near(f64::from(transfer::srgb_encode(0.05)), 0.248, 1e-3);
}
