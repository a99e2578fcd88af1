//! Phong's illumination (M86): pixels of a glossy plane under several lights, by hand.

use crate::{
    shot::{Shot, mean},
    stage::{Stage, light, material, rectangle, rgb},
};
use std::f64::consts::{PI, TAU};

const EYE: [f64; 3] = [1.2, 0.0, 1.6];
/// Position and intensity (W/sr, in three channels).
const LIGHTS: [([f64; 3], [f64; 3]); 3] = [
    ([-1.5, 0.2, 2.0], [10.0, 8.0, 6.0]),
    ([0.5, 2.0, 1.0], [1.0, 2.0, 5.0]),
    // Below the horizon: it must add nothing.
    ([0.0, 1.0, -1.0], [50.0; 3]),
];
const DIFFUSE: [f64; 3] = [0.3, 0.2, 0.1];
const SPECULAR: f64 = 0.4;
const EXPONENT: f64 = 12.0;

/// A glossy square that glows by itself, which is what an ambient term looks like.
fn stage(form: &str, ambient: f64) -> Stage {
    let mut stage = Stage::new();
    let glossy = material("phong").with("diffuse_reflectance", rgb(DIFFUSE)).with("specular_reflectance", SPECULAR);
    let glossy = stage.add(glossy.with("exponent", EXPONENT).with("form", form));
    let glow = (ambient > 0.0).then(|| stage.add(light("area").with("radiance", rgb([ambient; 3]))));
    let square = stage.place_mesh(rectangle([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    (square.material, square.emission) = (Some(glossy), glow);
    for (position, intensity) in LIGHTS {
        stage.light(light("point").with("position", position).with("intensity", rgb(intensity)));
    }
    stage.probe(EYE, [0.0; 3]);
    stage
}

/// `Σ I/r² (k_d/π cosθ + k_s g(cosα))` over the lights above the plane, with α between the view and the mirrored light.
fn by_hand(lobe: impl Fn(f64, f64) -> f64) -> [f64; 3] {
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        (v.map(|x| x / length), length)
    };
    let (view, _) = unit(EYE);
    std::array::from_fn(|c| {
        let of = |(position, intensity): &([f64; 3], [f64; 3])| {
            let (l, r) = unit(*position);
            let mirrored = [-l[0], -l[1], l[2]];
            let cos_alpha = (0..3).map(|i| mirrored[i] * view[i]).sum::<f64>().max(0.0);
            let reflected = DIFFUSE[c] / PI * l[2] + SPECULAR * lobe(cos_alpha, l[2]);
            if l[2] > 0.0 { intensity[c] / (r * r) * reflected } else { 0.0 }
        };
        LIGHTS.iter().map(of).sum()
    })
}

#[test]
fn phongs_illumination_is_the_sum_over_lights() {
    let seen = |form, ambient| mean(&Shot::of("direct", 40_000).take(&stage(form, ambient).scene()));
    let first_published = by_hand(|cos_alpha, _| cos_alpha.powf(EXPONENT));
    seen("empirical", 0.0).is_near("as first published", first_published, 5e-3);
    let normalised = by_hand(|cos_alpha, cos| (EXPONENT + 2.0) / TAU * cos_alpha.powf(EXPONENT) * cos);
    seen("modified", 0.0).is_near("normalised", normalised, 5e-3);
    seen("modified", 0.05).is_near("with an ambient term", normalised.map(|v| v + 0.05), 8e-3);
}
