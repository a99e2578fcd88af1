//! Pictures without noise stay as they are.

use steradian_denoise::{
    Image,
    svgf::{Denoiser, Settings, Term},
};
use steradian_math::{Vec2, Vec3};

use crate::scene::{Random, blind, frame, largest, noise, wall};

#[test]
fn constants_stay_whatever_the_surfaces() {
    let (width, height) = (37, 23);
    let color = Vec3::new(0.3, 7.0, 1e-4);
    for iterations in [0, 1, 5, 16] {
        let mut random = Random(u64::from(iterations));
        let mut gbuffer = wall(width, height);
        gbuffer.id.values_mut().iter_mut().for_each(|id| *id = random.below(3));
        gbuffer.depth.values_mut().iter_mut().for_each(|z| *z = 1.0 + random.unit());
        gbuffer.normal.values_mut().iter_mut().for_each(|n| *n = (random.color() - 0.5).normalize());
        gbuffer.albedo = noise(width, height, 5);
        let lit = Image::from_fn(width, height, |x, y| color * *gbuffer.albedo.get(x, y).unwrap());
        let flat = Image::filled(width, height, color);
        let terms = [Term { radiance: &lit, has_albedo: true }, Term { radiance: &flat, has_albedo: false }];
        let mut denoiser = Denoiser::new(Settings { iterations, ..Settings::default() }).unwrap();
        for n in 0..6 {
            gbuffer.motion = Image::from_fn(width, height, |_, _| Vec2::new(random.unit(), 2.0 * random.unit()));
            for (filtered, term) in denoiser.frame(&terms, &gbuffer).unwrap().iter().zip(terms) {
                let pairs = filtered.radiance.values().iter().zip(term.radiance.values());
                let error = largest(pairs.map(|(a, b)| ((a - b) / b.max(Vec3::splat(1e-9))).abs().max_element()));
                assert!(error < 5e-5, "{error} in frame {n}, {iterations} iterations");
                assert_eq!(filtered.left_out, 0);
            }
        }
    }
}

#[test]
fn a_history_is_a_mean_and_then_exponential() {
    let gbuffer = wall(1, 1);
    let mut denoiser = blind(0);
    let (mut sum, mut expected) = (0.0, 0.0);
    for n in 1..20u32 {
        let sample = (n * n % 7) as f32;
        sum += sample;
        let filtered = frame(&mut denoiser, &Image::filled(1, 1, Vec3::splat(sample)), &gbuffer);
        // A weight of 1/n until it is 0.2.
        expected = if n <= 5 { sum / n as f32 } else { 0.8 * expected + 0.2 * sample };
        let found = filtered.radiance.get(0, 0).unwrap().x;
        assert!((found - expected).abs() < 1e-5, "{found} for {expected} in frame {n}");
        assert_eq!(filtered.history.get(0, 0), Some(&n));
    }
    denoiser.forget();
    let filtered = frame(&mut denoiser, &Image::filled(1, 1, Vec3::ONE), &gbuffer);
    assert_eq!((filtered.history.values(), filtered.radiance.values()), (&[1][..], &[Vec3::ONE][..]));
}

#[test]
fn a_history_that_is_clamped_follows_light_at_once() {
    let gbuffer = wall(9, 9);
    let after = |clamp_history| {
        let mut denoiser = Denoiser::new(Settings { clamp_history, ..Settings::default() }).unwrap();
        (0..9).for_each(|_| drop(frame(&mut denoiser, &Image::filled(9, 9, Vec3::ONE), &gbuffer)));
        frame(&mut denoiser, &Image::filled(9, 9, Vec3::splat(6.0)), &gbuffer).radiance.get(4, 4).unwrap().x
    };
    assert!((after(true) - 6.0).abs() < 1e-5 && (after(false) - 2.0).abs() < 1e-5);
}
