//! Noise left after filtering.

use steradian_denoise::{
    Image,
    nlm::{Picture, Settings, denoise},
};
use steradian_math::Vec3;

use crate::scene::{Random, bare, noisy, square_error};

#[test]
fn what_is_constant_stays() {
    let radiance = Image::filled(40, 25, Vec3::new(0.7, 2.0, 1e-3));
    let variance = Image::filled(40, 25, Vec3::splat(0.1));
    for picture in [bare(&radiance, &variance), Picture { variance: None, ..bare(&radiance, &variance) }] {
        let found = denoise(&picture, &Settings::default()).unwrap();
        let apart = found.radiance.values().iter().map(|v| (*v / radiance.values()[0] - 1.0).abs().max_element());
        assert!(apart.fold(0.0, f32::max) < 1e-5);
        assert_eq!(found.not_finite, 0);
    }
}

/// Light that falls off evenly is a line in each window: whatever is taken for noise, it stays, and so does its slope
/// beside the edges of the picture.
#[test]
fn slopes_stay() {
    let truth = Image::from_fn(60, 60, |x, y| Vec3::splat(1.0 + 0.02 * x as f32 + 0.01 * y as f32));
    let variance = Image::filled(60, 60, Vec3::splat(4.0));
    let settings = Settings { keeps_mean: false, ..Settings::default() };
    let found = denoise(&bare(&truth, &variance), &settings).unwrap().radiance;
    for (place, (found, truth)) in found.values().iter().zip(truth.values()).enumerate() {
        let apart = (*found - *truth).abs().max_element();
        assert!(apart < 0.01, "{apart} at {place}");
    }
}

/// Remaining noise has no edges: rare bright paths over light that falls off leave no squares of a window's
/// size about them. Steps from row to row and from column to column are a small part of the picture's variation.
#[test]
fn windows_do_not_show() {
    let truth = Image::from_fn(96, 96, |x, _| Vec3::splat(0.5 + x as f32 / 96.0));
    let mut random = Random(11);
    let (mut radiance, mut variance) = (truth.clone(), Image::filled(96, 96, Vec3::ZERO));
    for place in 0..96 * 96 {
        // 16 samples, of which few are bright.
        let light = truth.values()[place].x;
        let samples = [(); 16].map(|()| if random.unit() < 0.05 { 10.0 * light } else { light * 10.0 / 19.0 });
        let mean = samples.iter().sum::<f32>() / 16.0;
        let squares = samples.iter().map(|s| (s - mean) * (s - mean)).sum::<f32>();
        radiance.values_mut()[place] = Vec3::splat(mean);
        variance.values_mut()[place] = Vec3::splat(squares / (16.0 * 15.0));
    }
    let found = denoise(&bare(&radiance, &variance), &Settings::default()).unwrap().radiance;
    let error = |x: u32, y: u32| found.get(x, y).unwrap().x - truth.get(x, y).unwrap().x;
    let inner = || (8..88).flat_map(|y| (8..88).map(move |x| (x, y)));
    let mean = inner().map(|(x, y)| error(x, y)).sum::<f32>() / 6400.0;
    let spread = inner().map(|(x, y)| (error(x, y) - mean).powi(2)).sum::<f32>();
    let steps = inner().map(|(x, y)| (error(x + 1, y) - error(x, y)).powi(2) + (error(x, y + 1) - error(x, y)).powi(2));
    let part = steps.sum::<f32>() / (2.0 * spread);
    assert!(part < 0.04, "{part}");
}

/// Single bright paths on a wall are gone, and their light is not.
#[test]
fn fireflies_go_and_their_light_stays() {
    let truth = Image::filled(80, 60, Vec3::new(0.3, 0.4, 0.5));
    let (mut radiance, mut variance) = (noisy(&truth, 0.05, 12), Image::filled(80, 60, Vec3::splat(0.0025)));
    for (x, y) in [(9, 9), (40, 30), (41, 30), (70, 12), (15, 50), (60, 45)] {
        // One of 16 paths: its standard deviation is as large as what it brought.
        radiance.values_mut()[y * 80 + x] = Vec3::splat(12.0);
        variance.values_mut()[y * 80 + x] = Vec3::splat(144.0);
    }
    let found = denoise(&bare(&radiance, &variance), &Settings::default()).unwrap().radiance;
    let mean = |image: &Image<Vec3>| image.values().iter().sum::<Vec3>() / 4800.0;
    let ratio = mean(&found) / mean(&radiance);
    assert!((ratio - 1.0).abs().max_element() < 0.01, "{ratio}");
    for (place, value) in found.values().iter().enumerate() {
        let apart = (*value - truth.values()[place]).abs().max_element();
        assert!(apart < 0.2, "{apart} at {}, {}", place % 80, place / 80);
    }
}

/// With its default guides of noise, most of the window counts on a plane: the noise falls 70 times at least.
#[test]
fn noise_on_a_plane_falls() {
    let truth = Image::filled(64, 64, Vec3::new(0.3, 0.5, 0.9));
    let variance = Image::filled(64, 64, Vec3::splat(0.01));
    let radiance = noisy(&truth, 0.1, 2);
    let found = denoise(&bare(&radiance, &variance), &Settings::default()).unwrap().radiance;
    let left = square_error(&found, &truth, 8);
    assert!(left < 0.01 / 70.0, "{left}");
    // A picture that tells no variance is filtered by what its neighbourhoods tell.
    let alone = Picture { variance: None, ..bare(&radiance, &variance) };
    let left = square_error(&denoise(&alone, &Settings::default()).unwrap().radiance, &truth, 8);
    assert!(left < 0.01 / 30.0, "{left}");
}

/// Differences that noise does not explain stay: a step of ten standard deviations is not smeared.
#[test]
fn edges_of_colour_stay() {
    let truth = Image::from_fn(64, 40, |x, _| Vec3::splat(if x < 32 { 1.0 } else { 2.0 }));
    let variance = Image::filled(64, 40, Vec3::splat(0.01));
    let found = denoise(&bare(&noisy(&truth, 0.1, 3), &variance), &Settings::default()).unwrap().radiance;
    for y in 0..40 {
        let (left, right) = (found.get(31, y).unwrap().x, found.get(32, y).unwrap().x);
        assert!((left - 1.0).abs() < 0.15 && (right - 2.0).abs() < 0.15, "{left} {right} in row {y}");
    }
}
