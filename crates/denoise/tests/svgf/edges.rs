//! Edges that stop the filter.

use steradian_denoise::{
    GBuffer, Image,
    svgf::{Denoiser, Settings},
};
use steradian_math::{Vec2, Vec3};

use crate::scene::{blind, frame, largest, noise, wall};

const SIZE: u32 = 48;
/// The first column of the right half.
const EDGE: u32 = 21;

/// The left half after some frames whose right half has noise of a seed and scale; everything moves by a fraction of a
/// pixel.
fn left_half(denoiser: &mut Denoiser, gbuffer: &mut GBuffer, seed: u64, scale: f32) -> Vec<[u32; 5]> {
    let mut left = Vec::new();
    for n in 0..6 {
        let same = noise(SIZE, SIZE, 1000 + n);
        let other = noise(SIZE, SIZE, seed + n);
        gbuffer.motion = Image::filled(SIZE, SIZE, Vec2::new([0.4, -0.6][n as usize % 2], 0.3));
        let picture = |x, y| if x < EDGE { *same.get(x, y).unwrap() } else { scale * *other.get(x, y).unwrap() };
        let filtered = frame(denoiser, &Image::from_fn(SIZE, SIZE, picture), gbuffer);
        left = (0..SIZE)
            .flat_map(|y| (0..EDGE).map(move |x| (x, y)))
            .map(|(x, y)| {
                let [r, g, b] = filtered.radiance.get(x, y).unwrap().to_array().map(f32::to_bits);
                [r, g, b, filtered.variance.get(x, y).unwrap().to_bits(), *filtered.history.get(x, y).unwrap()]
            })
            .collect();
    }
    left
}

fn halves(change: impl Fn(&mut GBuffer, usize)) -> GBuffer {
    let mut gbuffer = wall(SIZE, SIZE);
    for i in (0..(SIZE * SIZE) as usize).filter(|i| i % SIZE as usize >= EDGE as usize) {
        change(&mut gbuffer, i);
    }
    gbuffer
}

/// Not a bit.
#[test]
fn nothing_leaks_from_one_object_to_another() {
    for (clamp_history, normal_power) in [(false, 128), (true, 128), (false, 0)] {
        let mut gbuffer = halves(|gbuffer, i| gbuffer.id.values_mut()[i] = 2);
        let settings = Settings { clamp_history, normal_power, ..Settings::default() };
        let mut left = |seed, scale| left_half(&mut Denoiser::new(settings).unwrap(), &mut gbuffer, seed, scale);
        let first = left(1, 1.0);
        assert!(first == left(100, 1e6) && first == left(100, f32::NAN));
    }
}

#[test]
fn nothing_leaks_across_edges_of_depth_and_normal() {
    let edges: [fn(&mut GBuffer, usize); 2] = [
        |gbuffer, i| {
            gbuffer.depth.values_mut()[i] = 4.0;
            gbuffer.previous_depth.values_mut()[i] = 4.0;
        },
        |gbuffer, i| gbuffer.normal.values_mut()[i] = Vec3::X,
    ];
    for edge in edges {
        let mut gbuffer = halves(edge);
        let mut left = |seed, scale| left_half(&mut blind(5), &mut gbuffer, seed, scale);
        assert!(left(1, 1.0) == left(100, 1e6));
        // Without the edge it does.
        let mut gbuffer = wall(SIZE, SIZE);
        let mut left = |seed, scale| left_half(&mut blind(5), &mut gbuffer, seed, scale);
        assert!(left(1, 1.0) != left(100, 1e6));
    }
}

/// A plane at a slant is one surface, as far as its gradient tells.
#[test]
fn a_slanted_plane_is_no_edge() {
    let mut gbuffer = wall(SIZE, SIZE);
    gbuffer.depth = Image::from_fn(SIZE, SIZE, |x, y| 10.0 + x as f32 + 0.5 * y as f32);
    gbuffer.previous_depth = gbuffer.depth.clone();
    let picture = noise(SIZE, SIZE, 3);
    let spread = |gbuffer: &GBuffer| {
        let filtered = frame(&mut blind(5), &picture, gbuffer).radiance;
        largest(filtered.values().iter().map(|v| (v - 0.5).abs().max_element()))
    };
    let as_edges = spread(&gbuffer);
    gbuffer.depth_gradient = Image::filled(SIZE, SIZE, Vec2::new(1.0, 0.5));
    let as_plane = spread(&gbuffer);
    assert!(as_plane < 0.25 && as_edges > 0.45, "{as_plane} {as_edges}");
}

/// A step of ten standard deviations of the noise stays where it is.
#[test]
fn edges_of_light_stay() {
    let picture = |seed| {
        let noise = noise(SIZE, SIZE, seed);
        Image::from_fn(SIZE, SIZE, |x, y| noise.get(x, y).unwrap() + Vec3::splat(if x < EDGE { 0.0 } else { 3.0 }))
    };
    let mut denoiser = Denoiser::new(Settings::default()).unwrap();
    let mut filtered = frame(&mut denoiser, &picture(0), &wall(SIZE, SIZE));
    for n in 1..12 {
        filtered = frame(&mut denoiser, &picture(n), &wall(SIZE, SIZE));
    }
    for y in 0..SIZE {
        let [left, right] = [EDGE - 1, EDGE].map(|x| filtered.radiance.get(x, y).unwrap().y);
        assert!((left - 0.5).abs() < 0.5 && (right - 3.5).abs() < 0.5, "{left} {right}");
    }
}
