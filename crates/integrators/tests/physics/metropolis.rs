//! Multiplexed Metropolis light transport against path tracing.

use crate::{
    bidirectional::{furnish, lamp, room},
    shot::{Shot, mean},
    stage::{Stage, material},
};
use steradian_core::{ColorMode, Scene};

/// A glass ball in a small room with a lamp.
fn glass(edge: f64, radiance: f64) -> Stage {
    let mut stage = room(0.6);
    lamp(&mut stage, edge, radiance);
    furnish(&mut stage, material("dielectric"));
    stage
}

/// Means of independent pictures, with their standard error: chains of one picture are few and correlated.
fn repeated(shot: Shot, scene: &Scene, seeds: u64) -> (f64, f64) {
    let means: Vec<f64> = (1..=seeds).map(|seed| mean(&shot.seed(seed).take(scene)).mean[1]).collect();
    let n = seeds as f64;
    let all = means.iter().sum::<f64>() / n;
    (all, (means.iter().map(|m| (m - all).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt())
}

/// Paths up to each number of scattering events have the mean of path tracing: no technique is counted twice or left
/// out.
#[test]
fn paths_of_each_length_agree_with_path_tracing() {
    for (what, mode) in [("", ColorMode::Rgb), ("spectral", ColorMode::Spectral)] {
        let scene = glass(1.2, 2.0).scene_in(mode);
        let depths = if mode == ColorMode::Rgb { 1..=6 } else { 6..=6 };
        for depth in depths {
            let (right, a) = repeated(Shot::of("path", 8).depth(depth), &scene, 8);
            let (found, b) = repeated(Shot::of("mmlt", 32).depth(depth), &scene, 8);
            let sigma = a.hypot(b);
            assert!(sigma < 0.05 * right, "{what} {depth} events: {right} ± {sigma} tells nothing");
            assert!((found - right).abs() < 4.0 * sigma, "{what} {depth} events: {found} for {right} ± {sigma}");
        }
    }
}
