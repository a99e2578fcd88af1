//! Values of other renderers at fixed directions: Mitsuba 3.9.1 (`scalar_rgb`), `f·cosθ_i` and density as it prints
//! them.

use super::{
    Bsdf, CoatSeries, CoatTable, Coated, Conductor, Dielectric, Microfacet, NormalDistribution, Shadowing,
    TransportMode,
};
use NormalDistribution::{Beckmann, Ggx};
use steradian_math::{Spectrum, Vec3};

fn direction(cos: f32, phi: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).sqrt();
    Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

/// `(cosθ, φ)` of `wo` and `wi` for the reflected pairs.
const REFLECTED: [[f32; 4]; 4] =
    [[0.9, 0.3, 0.8, 2.5], [0.5, 0.0, 0.6, 3.0], [0.2, 1.0, 0.7, 4.5], [0.3, 1.0, 0.25, 4.0]];
const TRANSMITTED: [[f32; 4]; 3] = [[0.9, 0.3, -0.93, 3.4], [0.5, 0.0, -0.8, 3.2], [-0.9, 0.3, 0.8, 3.4]];

/// Compares value and density (where the sampling is the same) at each pair.
#[track_caller]
fn compare(bsdf: Bsdf<'_>, pairs: &[[f32; 4]], values: &[f32], pdfs: &[f32], tolerance: f32) {
    let near = |a: f32, b: f32, what: &str| {
        assert!((a - b).abs() <= tolerance * b, "{what}: {a} is not {b} ({:+.3} %)", (a / b - 1.0) * 100.0);
    };
    assert_eq!(pairs.len(), values.len());
    for (i, p) in pairs.iter().enumerate() {
        let e = bsdf.eval(direction(p[0], p[1]), direction(p[2], p[3]), TransportMode::Radiance);
        near(e.value[0], values[i], &format!("value {i}"));
        if let Some(&pdf) = pdfs.get(i) {
            near(e.pdf, pdf, &format!("density {i}"));
        }
    }
}

fn separable(distribution: NormalDistribution, alpha_x: f32, alpha_y: f32) -> Microfacet {
    Microfacet::new(distribution, Shadowing::Separable, alpha_x, alpha_y)
}

#[test]
fn rough_conductors_are_those_of_mitsuba() {
    let metal = |microfacet| {
        Bsdf::Conductor(Conductor {
            eta: Spectrum::splat(0.37),
            k: Spectrum::splat(2.82),
            tint: Spectrum::ONE,
            microfacet,
        })
    };
    let values = [0.7940191, 1.480791, 0.02213995, 0.1260822];
    let pdfs = [0.9435866, 1.764148, 0.02724357, 0.1884041];
    compare(metal(separable(Ggx, 0.1, 0.4)), &REFLECTED, &values, &pdfs, 1e-4);
    // Mitsuba's masking of Beckmann is a rational fit within 0.35 %.
    let values = [0.3861251, 1.301133, 0.5471014, 1.346239];
    let pdfs = [0.4548186, 1.541265, 0.6483077, 1.641352];
    compare(metal(separable(Beckmann, 0.3, 0.3)), &REFLECTED, &values, &pdfs, 7e-3);
}

#[test]
fn rough_dielectrics_are_those_of_mitsuba() {
    let glass = |m| Bsdf::Dielectric(Dielectric::new(1.5, m));
    let (values, pdfs) =
        ([0.01249045, 0.08970822, 0.04024071, 0.1741042], [0.01264658, 0.09316347, 0.04116198, 0.2205004]);
    compare(glass(separable(Ggx, 0.3, 0.3)), &REFLECTED, &values, &pdfs, 2e-4);
    compare(
        glass(separable(Ggx, 0.3, 0.3)),
        &TRANSMITTED,
        &[5.892148, 4.69638, 17.39598],
        &[13.30376, 10.69894, 7.82819],
        2e-4,
    );
    let (values, pdfs) =
        ([0.01312846, 0.2084607, 0.009313228, 0.3571287], [0.01312846, 0.2084607, 0.009313228, 0.3586376]);
    compare(glass(separable(Beckmann, 0.2, 0.2)), &REFLECTED, &values, &pdfs, 7e-3);
    compare(
        glass(separable(Beckmann, 0.2, 0.2)),
        &TRANSMITTED,
        &[8.669606, 11.05631, 37.9436],
        &[19.50661, 24.8767, 16.86382],
        7e-3,
    );
}

#[test]
fn plastics_are_those_of_mitsuba() {
    let plastic = |distribution, alpha: f32, nonlinear, values: &[f32], tolerance| {
        let series = CoatSeries::Plastic { nonlinear };
        let table = CoatTable::new(distribution, Shadowing::Separable, 1.49, (alpha, alpha), series);
        let value = Coated::new(&table, Spectrum::splat(0.5), Spectrum::ONE, alpha, alpha);
        compare(Bsdf::Coated(value), &REFLECTED, values, &[], tolerance);
    };
    plastic(Ggx, 0.0, false, &[0.1288644, 0.08985661, 0.07725712, 0.0256549], 2e-5);
    plastic(Ggx, 0.0, true, &[0.07484742, 0.05219078, 0.04487271, 0.01490096], 2e-5);
    plastic(Ggx, 0.1, false, &[0.1203487, 0.2672798, 0.08632788, 0.1461914], 3e-3);
    plastic(Ggx, 0.3, false, &[0.09873271, 0.1466616, 0.1003636, 0.1924059], 3e-3);
    plastic(Beckmann, 0.1, true, &[0.07406399, 0.3151232, 0.04555826, 0.02871969], 7e-3);
}
