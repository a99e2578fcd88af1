//! The filter of a wall is the convolution that it is in theory.

use steradian_denoise::Image;
use steradian_math::Vec3;

use crate::scene::{blind, frame, noise, wall};

/// Combined kernel of the passages with gaps of 1, 2, 4, … along an axis: 2 (2ⁿ − 1) on either side.
fn together(iterations: u32) -> Vec<f64> {
    let mut kernel = vec![1.0];
    for step in (0..iterations).map(|i| 1usize << i) {
        let mut wider = vec![0.0; kernel.len() + 4 * step];
        for (tap, weight) in [1.0, 4.0, 6.0, 4.0, 1.0].into_iter().enumerate() {
            kernel.iter().enumerate().for_each(|(i, k)| wider[i + tap * step] += k * weight / 16.0);
        }
        kernel = wider;
    }
    kernel
}

fn sum_of_squares(kernel: &[f64]) -> f64 {
    kernel.iter().map(|k| k * k).sum()
}

#[test]
fn a_point_of_light_becomes_the_kernel() {
    // Large enough for kernels that are cut off at no pixel within.
    let size = 193;
    let middle = size / 2;
    for iterations in 0..=5 {
        let point = Image::from_fn(size, size, |x, y| if [x, y] == [middle; 2] { Vec3::ONE } else { Vec3::ZERO });
        let filtered = frame(&mut blind(iterations), &point, &wall(size, size)).radiance;
        let kernel = together(iterations);
        let weight = |x: u32| {
            let place = i64::from(x) - i64::from(middle) + kernel.len() as i64 / 2;
            usize::try_from(place).ok().and_then(|place| kernel.get(place)).copied().unwrap_or(0.0)
        };
        let mut energy = 0.0;
        for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
            let (found, expected) = (f64::from(filtered.get(x, y).unwrap().x), weight(x) * weight(y));
            energy += found * found;
            assert!((found - expected).abs() <= 2e-6 * expected, "{found} for {expected} at {x}, {y}");
        }
        // By this factor the variance of independent pixels falls: 1, 0.0748, …
        let factor = sum_of_squares(&kernel).powi(2);
        assert!((energy / factor - 1.0).abs() < 1e-5, "{energy} for {factor}");
    }
}

#[test]
fn the_variance_of_noise_falls_as_in_theory() {
    let size = 400;
    for iterations in 1..=3 {
        let filtered = frame(&mut blind(iterations), &noise(size, size, 77), &wall(size, size)).radiance;
        let kernel = together(iterations);
        let margin = kernel.len() as u32 / 2;
        let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for (x, y) in (margin..size - margin).flat_map(|y| (margin..size - margin).map(move |x| (x, y))) {
            for value in filtered.get(x, y).unwrap().to_array().map(|v| f64::from(v) - 0.5) {
                (n, sum, squares) = (n + 1.0, sum + value, squares + value * value);
            }
        }
        // Uniform numbers have variance 1/12.
        let factor = sum_of_squares(&kernel).powi(2);
        let found = 12.0 * (squares / n - (sum / n).powi(2));
        // Pixels of one kernel are one pixel: Σ (k∗k)² / (Σk²)² is their number, along each axis.
        let correlation = |lag: usize| kernel.iter().zip(&kernel[lag..]).map(|(a, b)| a * b).sum::<f64>();
        let all: f64 =
            (1..kernel.len()).map(|lag| 2.0 * correlation(lag).powi(2)).sum::<f64>() + correlation(0).powi(2);
        let sigma = (2.0 / n).sqrt() * all / correlation(0).powi(2);
        assert!((found / factor - 1.0).abs() < 4.0 * sigma && sigma < 0.05, "{found} for {factor} ± {sigma}");
    }
}

/// The variance that is filtered along takes what it averages for independent.
#[test]
fn variance_is_filtered_with_squared_weights() {
    let size = 141;
    let gbuffer = wall(size, size);
    for iterations in 0..=5 {
        let mut denoiser = blind(iterations);
        let mut filtered = None;
        // Weights of 1/n until 0.2: after eight frames the moments are those of the last frames.
        let (mut mean, mut square) = (0.0, 0.0);
        for n in 1..=8u32 {
            let sample = (n % 2) as f64;
            let weight = (1.0 / f64::from(n)).max(0.2);
            (mean, square) = (mean + (sample - mean) * weight, square + (sample * sample - square) * weight);
            filtered = Some(frame(&mut denoiser, &Image::filled(size, size, Vec3::splat(sample as f32)), &gbuffer));
        }
        let factor = sum_of_squares(&together(1)).powi(2 * iterations as i32);
        let expected = (square - mean * mean) * factor;
        let found = f64::from(*filtered.unwrap().variance.get(size / 2, size / 2).unwrap());
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} for {expected}");
    }
}

/// The history takes the first passage alone.
#[test]
fn the_first_passage_is_the_next_history() {
    let size = 65;
    let middle = size / 2;
    let point = Image::from_fn(size, size, |x, y| if [x, y] == [middle; 2] { Vec3::ONE } else { Vec3::ZERO });
    let dark = Image::filled(size, size, Vec3::ZERO);
    for iterations in 0..=3 {
        let mut denoiser = blind(iterations);
        frame(&mut denoiser, &point, &wall(size, size));
        let filtered = frame(&mut denoiser, &dark, &wall(size, size));
        let kernel = together(iterations);
        let history = together(iterations.min(1));
        // At the middle: the sum of products of two kernels, both symmetric.
        let apart = (kernel.len() - history.len()) / 2;
        let product: f64 = history.iter().zip(&kernel[apart..]).map(|(a, b)| a * b).sum();
        let (found, expected) = (f64::from(filtered.radiance.get(middle, middle).unwrap().x), 0.5 * product * product);
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} for {expected}");
    }
}

/// Over 7×7 pixels and larger where histories are short, over time where they are long.
#[test]
fn variance_is_that_of_the_noise() {
    let size = 160;
    let mut denoiser = blind(0);
    let of_luminance = [0.2126f64, 0.7152, 0.0722].map(|w| w * w).iter().sum::<f64>() / 12.0;
    for n in 1..=5u32 {
        let variance = frame(&mut denoiser, &noise(size, size, u64::from(n)), &wall(size, size)).variance;
        let inside = (3..size - 3).flat_map(|y| (3..size - 3).map(move |x| (x, y)));
        let found: f64 = inside.map(|(x, y)| f64::from(*variance.get(x, y).unwrap())).sum();
        let found = found / f64::from((size - 6) * (size - 6));
        // Of m numbers about their own mean: less by a part of 1/m.
        let n = f64::from(n);
        let part = if n < 4.0 { (1.0 - 1.0 / (49.0 * n)) * 4.0 / n } else { 1.0 - 1.0 / n };
        let expected = part * of_luminance;
        assert!((found / expected - 1.0).abs() < 0.02, "{found} for {expected} after {n} frames");
    }
}
