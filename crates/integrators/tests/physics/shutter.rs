//! Surfaces that change while the shutter is open (M104): a picture has the mean over the exposure.

use crate::{
    shot::{ROUNDING, Shot, mean},
    stage::{Stage, material, plane, rgb, sphere},
};
use steradian_scene::{Family, Node, NodeId, Value};

fn time(stage: &mut Stage) -> NodeId {
    stage.add(Node::new(Family::Texture, "time", None))
}

/// Texture that takes the colours of a list in turn, at even places of the exposure.
fn film_strip(stage: &mut Stage, interpolation: &str, colors: &[f64]) -> NodeId {
    let input = time(stage);
    let ramp = Node::new(Family::Texture, "ramp", None).with("input", input).with("interpolation", interpolation);
    stage.add(ramp.with("colors", Value::Floats(colors.into())))
}

#[test]
fn an_albedo_that_changes_is_averaged_over_the_exposure() {
    let mut stage = Stage::new();
    let fading = film_strip(&mut stage, "linear", &[0.1, 0.9, 0.0, 0.5, 0.1, 0.8]);
    stage.solid(plane([0.0, 0.0, 1.0], 0.0), material("diffuse").with("reflectance", fading));
    stage.sky(2.0).probe([1.0, 0.5, 3.0], [0.0; 3]);
    for name in ["path", "volpath", "direct"] {
        // What arrives is the albedo of the moment times the sky: its mean is that of the two ends, and nothing else
        // spreads it.
        let seen = mean(&Shot::of(name, 40_000).take(&stage.scene()));
        seen.is_near(name, [0.6, 1.0, 0.8], 3e-3);
    }
}

#[test]
fn one_path_sees_one_moment() {
    // Between two parallel walls that are white and black in turn light lives on or ends for good: with one moment for
    // all its bounces a path sees Σ ρᵏ over moments, with a moment each it would see (Σ ρ)ᵏ. A closed white sphere with
    // a glow of one gives 1/(1 − ρ).
    let mut stage = Stage::new();
    let flashing = film_strip(&mut stage, "linear", &[0.0, 0.0, 0.0, 0.8, 0.8, 0.8]);
    let walls = stage.add(material("diffuse").with("reflectance", flashing));
    let glow =
        stage.add(Node::new(Family::Light, "area", None).with("radiance", rgb([1.0; 3])).with("two_sided", true));
    let ball = stage.place(sphere([0.0; 3], 2.0));
    (ball.material, ball.emission) = (Some(walls), Some(glow));
    stage.probe([0.0; 3], [0.0, 0.0, 1.0]);
    let seen = mean(&Shot::of("path", 40_000).take(&stage.scene()));
    // ∫ dt/(1 − 0.8 t) over [0, 1] = ln 5/0.8.
    seen.is_near("a flashing furnace", [5f64.ln() / 0.8; 3], 8e-3);
}

#[test]
fn roughness_may_change_too() {
    // A rough mirror under an even sky shows the sky less what its facets lose, which a furnace of either roughness
    // bounds.
    let reflected = |alpha: fn(&mut Stage) -> Value| {
        let mut stage = Stage::new();
        let alpha = alpha(&mut stage);
        stage.solid(plane([0.0, 0.0, 1.0], 0.0), material("conductor").with("alpha_u", alpha));
        stage.sky(1.0).probe([1.0, 0.0, 1.0], [0.0; 3]);
        mean(&Shot::of("path", 40_000).take(&stage.scene())).mean[1]
    };
    let (smooth, rough) = (reflected(|_| 0.05.into()), reflected(|_| 1.0.into()));
    let both = reflected(|stage| {
        let input = time(stage);
        let steps = Node::new(Family::Texture, "curve", None).with("input", input).with("interpolation", "step");
        stage
            .add(steps.with("values", Value::Floats(vec![0.05, 1.0])).with("places", Value::Floats(vec![0.0, 0.5])))
            .into()
    });
    assert!(rough < 0.97 * smooth, "{rough} {smooth}");
    assert!((both - 0.5 * (smooth + rough)).abs() < 0.004 + ROUNDING, "{both} between {smooth} and {rough}");
}
