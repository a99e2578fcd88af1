//! Rough metal of OpenPBR in a white furnace, and that of glTF beside it.

use super::{
    Bsdf, Microfacet, Pbr,
    TransportMode::Radiance,
    pbr::{Convention, PbrParams, plain},
};
use std::f32::consts::TAU;
use steradian_math::{Spectrum, Vec2, Vec3};

fn metal(x: f32, y: f32) -> PbrParams {
    PbrParams {
        base_color: Spectrum::ONE,
        metallic: 1.0,
        facets: Microfacet::ggx(x, y),
        convention: Convention::OpenPbr,
        ..plain()
    }
}

/// Light that is reflected along a direction, of all that arrives: at once, over a lattice of samples, and with what
/// goes between facets, by quadrature.
fn albedos(p: &PbrParams, cos: f32, phi: f32) -> [f64; 2] {
    let [once, whole] =
        [Convention::Gltf, Convention::OpenPbr].map(|convention| Bsdf::Pbr(Pbr::new(&PbrParams { convention, ..*p })));
    let direction =
        |cos: f32, phi: f32| Vec3::new((1.0 - cos * cos).sqrt() * phi.cos(), (1.0 - cos * cos).sqrt() * phi.sin(), cos);
    let wo = direction(cos, phi);
    // Powers of 1/x with x³ = x + 1, whose multiples fill the square evenly.
    let point = |i: u32| {
        [0.754_877_666_246_692_8, 0.569_840_290_998_053_2].map(|s: f64| (0.5 + f64::from(i) * s).fract() as f32)
    };
    let n = 10_000;
    let weight = |i| once.sample(wo, 0.5, Vec2::from(point(i)), Radiance).map_or(0.0, |s| f64::from(s.weight[0]));
    let reflected = (0..n).map(weight).sum::<f64>() / f64::from(n);
    // Even in the root of the cosine.
    let regained = |i| {
        let [x, y] = point(i);
        let wi = direction(x * x, TAU * y);
        let [once, whole] = [&once, &whole].map(|b| f64::from(b.eval(wo, wi, Radiance).value[0]));
        (whole - once) * f64::from(2.0 * x * TAU)
    };
    [reflected, reflected + (0..n).map(regained).sum::<f64>() / f64::from(n)]
}

#[test]
fn white_metal_reflects_all_light_at_every_roughness() {
    for roughness in [0.0, 0.02, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0f32] {
        let alpha = roughness * roughness;
        for cos in [0.05, 0.2, 0.5, 0.8, 1.0] {
            let [_, whole] = albedos(&metal(alpha, alpha), cos, 0.3);
            assert!((whole - 1.0).abs() < 2e-3, "roughness {roughness}, cosine {cos}: {whole}");
        }
    }
}

/// The colour of repeated reflection: what goes between facets is reflected once more each time.
#[test]
fn coloured_metal_regains_by_its_mean_reflectance() {
    let white = metal(0.8, 0.8);
    let grey = PbrParams { base_color: Spectrum::splat(0.5), ..white };
    let [white, grey] = [white, grey].map(|p| albedos(&p, 0.7, 0.3)).map(|[once, whole]| whole - once);
    // White light that leaves at once, over the hemisphere by the cosine; Schlick's mean (20 f0 + 1)/21.
    let once = |cos: f32| albedos(&metal(0.8, 0.8), cos, 0.3)[0];
    let n = 32;
    let mean: f64 = (0..n).map(|i| once(((i as f32 + 0.5) / n as f32).sqrt()) / f64::from(n)).sum();
    let f = 11.0 / 21.0;
    let expected = white * f * f * mean / (1.0 - f * (1.0 - mean));
    assert!((grey - expected).abs() < 0.01 * expected, "{grey} is not {expected}");
}

#[test]
fn stretched_metal_regains_half_and_gains_none() {
    for (x, y) in [(0.3, 0.2), (0.5, 0.1), (1.0, 0.3), (0.8, 0.05), (0.05, 0.02), (0.1, 0.001f32)] {
        let mut lost = [0.0; 2];
        for cos in [0.03, 0.1, 0.3, 0.6, 1.0f32] {
            for phi in [0.0, 0.4, 0.8, 1.2, 1.57] {
                let whole = albedos(&metal(x, y), cos, phi);
                assert!(whole[1] < 1.001, "{x}, {y} from {cos}, {phi}: {whole:?}");
                lost.iter_mut().zip(whole).for_each(|(sum, w)| *sum += f64::from(cos) * (1.0 - w));
            }
        }
        assert!(lost[1] < 0.5 * lost[0], "{x}, {y}: {lost:?}");
    }
}
