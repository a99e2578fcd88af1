//! Light that enters surfaces and leaves them elsewhere.

mod interface;
mod layered;

use std::sync::Arc;
use steradian::{Quality, Scene, render};

/// A scene by an integrator, with a camera that sees from −1 to 1 in both directions.
fn text(integrator: &str, world: &str) -> String {
    format!(
        "steradian: 1
         conventions: pbrt
         film: {{film: rgb, width: 24, height: 24}}
         filter: {{filter: box}}
         integrator: {{integrator: {integrator}, max_depth: 100000}}
         cameras: [{{camera: orthographic, screen_window: [-1, 1, -1, 1],
                    to_world: {{matrix: [-1, 0, 0, 0,  0, 1, 0, 0,  0, 0, -1, 5,  0, 0, 0, 1]}}}}]
         {world}"
    )
}

/// The mean of each colour over some frames, and the variance of that mean.
fn seen(scene: &Arc<Scene>, spp: u32) -> [(f64, f64); 3] {
    const FRAMES: u64 = 6;
    let frame = |seed| {
        let quality = Quality { spp: Some(spp), seed: Some(seed), ..Quality::default() };
        let picture = render(scene, &quality).expect("a picture");
        ["R", "G", "B"].map(|name| {
            let plane = picture.channel(name).expect("a colour");
            plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64
        })
    };
    let frames: Vec<[f64; 3]> = (0..FRAMES).map(frame).collect();
    std::array::from_fn(|c| {
        let mean = frames.iter().map(|f| f[c]).sum::<f64>() / FRAMES as f64;
        let spread = frames.iter().map(|f| (f[c] - mean).powi(2)).sum::<f64>();
        (mean, spread / (FRAMES * (FRAMES - 1)) as f64)
    })
}
