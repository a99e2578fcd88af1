//! Effect of surface features.

use steradian_denoise::{
    Image,
    nlm::{Picture, Settings, denoise},
};
use steradian_math::Vec3;

use crate::scene::{bare, noisy, square_error};

/// A chequered wall of two albedos under light of a noise in proportion to them.
#[test]
fn edges_of_albedo_stay_sharp() {
    let albedo = Image::from_fn(60, 44, |x, y| match (x / 7 + y / 5) % 2 {
        0 => Vec3::new(0.9, 0.6, 0.2),
        _ => Vec3::new(0.1, 0.2, 0.8),
    });
    let light = Image::filled(60, 44, Vec3::splat(2.0));
    let lit =
        |light: &Image<Vec3>| Image::from_fn(60, 44, |x, y| *light.get(x, y).unwrap() * *albedo.get(x, y).unwrap());
    let variance = Image::from_fn(60, 44, |x, y| *albedo.get(x, y).unwrap() * *albedo.get(x, y).unwrap() * 0.25);
    let truth = lit(&light);
    let still = Image::filled(60, 44, Vec3::ZERO);
    let normal = Image::filled(60, 44, Vec3::Z);
    let depth = Image::filled(60, 44, 3.0);
    let all = |radiance, variance| Picture {
        albedo: Some(&albedo),
        normal: Some(&normal),
        depth: Some(&depth),
        ..bare(radiance, variance)
    };
    let found = denoise(&all(&truth, &still), &Settings::default()).unwrap().radiance;
    assert!(square_error(&found, &truth, 0).sqrt() < 1e-6, "without noise");
    let radiance = lit(&noisy(&light, 0.5, 4));
    let found = denoise(&all(&radiance, &variance), &Settings::default()).unwrap().radiance;
    // At the edges as between them: relative to albedo.
    for (place, (found, truth)) in found.values().iter().zip(truth.values()).enumerate() {
        let apart = (*found / *truth - 1.0).abs().max_element();
        assert!(apart < 0.2, "{apart} at {place}");
    }
    assert!(square_error(&found, &truth, 0) < square_error(&radiance, &truth, 0) / 15.0);
}

/// Sky keeps its bits, and lends nothing to what stands before it, nor takes from it.
#[test]
fn the_sky_stays_as_it_is() {
    let is_sky = |x: u32, y: u32| y < 12 + x / 4;
    let truth = Image::from_fn(48, 40, |x, y| if is_sky(x, y) { Vec3::new(1.0, 2.0, 30.0) } else { Vec3::splat(0.5) });
    let mut radiance = noisy(&truth, 0.1, 5);
    *radiance.values_mut().first_mut().unwrap() = Vec3::splat(1e6);
    let variance = Image::filled(48, 40, Vec3::splat(0.01));
    let normal = Image::from_fn(48, 40, |x, y| if is_sky(x, y) { Vec3::ZERO } else { Vec3::Y });
    let depth = Image::from_fn(48, 40, |x, y| if is_sky(x, y) { f32::INFINITY } else { 4.0 });
    let picture = Picture { normal: Some(&normal), depth: Some(&depth), ..bare(&radiance, &variance) };
    let found = denoise(&picture, &Settings::default()).unwrap().radiance;
    for (x, y) in (0..40).flat_map(|y| (0..48).map(move |x| (x, y))) {
        let (found, before) = (*found.get(x, y).unwrap(), *radiance.get(x, y).unwrap());
        if is_sky(x, y) {
            assert_eq!(found, before, "{x}, {y}");
        } else {
            assert!((found - 0.5).abs().max_element() < 0.1, "{found} at {x}, {y}");
        }
    }
}

/// A lamp that is seen has no noise, and stays within its edges.
#[test]
fn lamps_are_not_smeared() {
    let is_lamp = |x: u32, y: u32| (20..28).contains(&x) && (10..16).contains(&y);
    let truth = Image::from_fn(48, 32, |x, y| Vec3::splat(if is_lamp(x, y) { 50.0 + x as f32 } else { 0.5 }));
    let noise = noisy(&truth, 0.2, 6);
    let radiance = Image::from_fn(48, 32, |x, y| *if is_lamp(x, y) { &truth } else { &noise }.get(x, y).unwrap());
    let variance = Image::from_fn(48, 32, |x, y| Vec3::splat(if is_lamp(x, y) { 0.0 } else { 0.04 }));
    let found = denoise(&bare(&radiance, &variance), &Settings::default()).unwrap().radiance;
    for (x, y) in (0..32).flat_map(|y| (0..48).map(move |x| (x, y))) {
        let (found, truth) = (found.get(x, y).unwrap().x, truth.get(x, y).unwrap().x);
        assert!((found - truth).abs() < if is_lamp(x, y) { 0.01 } else { 0.65 }, "{found} of {truth} at {x}, {y}");
    }
}
