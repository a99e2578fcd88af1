//! Noise left after filtering.

use steradian_denoise::{
    Image,
    nlm::{Picture, Settings, denoise},
};
use steradian_math::Vec3;

use crate::scene::{bare, noisy, square_error};

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

/// Without distinguishing features, each pixel becomes the mean of its window, and variance falls by the number of
/// pixels.
#[test]
fn without_a_guide_it_is_the_mean_of_the_window() {
    let truth = Image::filled(60, 60, Vec3::ONE);
    let radiance = noisy(&truth, 0.2, 1);
    let variance = Image::filled(60, 60, Vec3::splat(0.04));
    let settings = Settings { radius: 5, damping: 1e4, keeps_mean: false, ..Settings::default() };
    let found = denoise(&bare(&radiance, &variance), &settings).unwrap().radiance;
    let mean = |x: u32, y: u32| {
        let all = (y - 5..=y + 5).flat_map(|y| (x - 5..=x + 5).map(move |x| (x, y)));
        all.map(|(x, y)| *radiance.get(x, y).unwrap()).sum::<Vec3>() / 121.0
    };
    for (x, y) in (5..55).flat_map(|y| (5..55).map(move |x| (x, y))) {
        let apart = (mean(x, y) - *found.get(x, y).unwrap()).abs().max_element();
        assert!(apart < 2e-4, "{apart} at {x}, {y}");
    }
    let left = square_error(&found, &truth, 5);
    let expected = 0.04 / 121.0;
    assert!((0.5 * expected..1.7 * expected).contains(&left), "{left} of {expected}");
}

/// With its default guides of noise, most of the window counts on a plane: the noise falls 70 times at least, of 289.
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
