//! Two pictures that guide each other.

use steradian_denoise::{
    Error, Image,
    nlm::{Settings, denoise_halves},
};
use steradian_math::Vec3;

use crate::scene::{bare, noisy, square_error};

/// The error that is told is the one that is there.
#[test]
fn the_error_is_honest() {
    let truth = Image::from_fn(64, 48, |x, _| Vec3::splat(if x < 30 { 1.0 } else { 1.6 }));
    let variance = Image::filled(64, 48, Vec3::splat(0.04));
    let [a, b] = [7, 8].map(|seed| noisy(&truth, 0.2, seed));
    let (found, told) = denoise_halves([&bare(&a, &variance), &bare(&b, &variance)], &Settings::default()).unwrap();
    let squares = found.radiance.values().iter().zip(truth.values()).map(|(f, t)| {
        let apart = *f - *t;
        (apart * apart / (*t * *t + Vec3::splat(0.01))).element_sum() / 3.0
    });
    let error = f64::from(squares.sum::<f32>() / (64.0 * 48.0)).sqrt();
    assert!((0.7..1.4).contains(&(told / error)), "{told} for {error}");
    assert!(square_error(&found.radiance, &truth, 0) < 0.02 / 25.0);
}

#[test]
fn both_have_one_size() {
    let [a, b] = [8, 9].map(|width| Image::filled(width, 5, Vec3::ONE));
    let refusal = denoise_halves([&bare(&a, &a), &bare(&b, &b)], &Settings::default());
    assert!(matches!(refusal, Err(Error::Size { found: [9, 5], expected: [8, 5], .. })), "{refusal:?}");
}
