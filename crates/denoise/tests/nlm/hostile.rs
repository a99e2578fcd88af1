//! Any input.

use steradian_denoise::{
    Error, Image,
    nlm::{Picture, Settings, denoise},
};
use steradian_math::Vec3;

use crate::scene::{Random, any_number, bare, noisy};

#[test]
fn any_input_gives_the_same_bits_for_any_number_of_threads() {
    let sizes = [[1, 1], [1, 9], [40, 1], [2, 2], [17, 31], [50, 37]];
    for (seed, [width, height]) in (0u64..).zip(sizes.into_iter().cycle().take(24)) {
        let mut random = Random(seed);
        let mut wild =
            || Image::from_fn(width, height, |_, _| Vec3::from_array([(); 3].map(|()| any_number(&mut random))));
        let [radiance, variance, albedo, normal] = [(); 4].map(|()| wild());
        let depth = Image::from_fn(width, height, |_, _| any_number(&mut random));
        let picture = Picture {
            radiance: &radiance,
            variance: (seed % 2 == 0).then_some(&variance),
            albedo: Some(&albedo),
            normal: (seed % 3 == 0).then_some(&normal),
            depth: (seed % 5 == 0).then_some(&depth),
        };
        let settings = Settings { radius: 1 + seed as u32 % 11, ..Settings::default() };
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| denoise(&picture, &settings)).unwrap()
        };
        let (one, many) = (run(1), run(5));
        let bits =
            |image: &Image<Vec3>| image.values().iter().map(|v| v.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&one.radiance), bits(&many.radiance), "{width}×{height}, {seed}");
        assert!(one.radiance.values().iter().all(|v| v.is_finite()), "{width}×{height}, {seed}");
        let bad = radiance.values().iter().filter(|v| !v.is_finite()).count();
        assert_eq!(one.not_finite, bad);
    }
}

/// Pixels that are not finite become what their neighbours are, and change nothing around.
#[test]
fn what_is_not_finite_is_contained() {
    let truth = Image::filled(40, 30, Vec3::new(0.5, 1.0, 2.0));
    let variance = Image::filled(40, 30, Vec3::splat(0.01));
    let mut radiance = noisy(&truth, 0.1, 9);
    for (place, value) in [(5, f32::NAN), (417, f32::INFINITY), (418, f32::NAN), (600, -f32::INFINITY)] {
        radiance.values_mut()[place] = Vec3::new(1.0, value, 1.0);
    }
    let found = denoise(&bare(&radiance, &variance), &Settings::default()).unwrap();
    assert_eq!(found.not_finite, 4);
    for (place, value) in found.radiance.values().iter().enumerate() {
        assert!((*value - truth.values()[place]).abs().max_element() < 0.08, "{value} at {place}");
    }
}

#[test]
fn what_cannot_be_filtered_is_refused() {
    let image = Image::filled(4, 3, Vec3::ONE);
    let other = Image::filled(3, 4, Vec3::ONE);
    let run = |picture: &Picture<'_>, settings| denoise(picture, &settings).unwrap_err();
    let default = Settings::default();
    let wrong = run(&Picture { albedo: Some(&other), ..bare(&image, &image) }, default);
    assert_eq!(wrong, Error::Size { what: "albedo", found: [3, 4], expected: [4, 3] });
    let none = Image::filled(0, 3, Vec3::ONE);
    assert_eq!(run(&bare(&none, &none), default), Error::Empty);
    for settings in [
        Settings { radius: 0, ..default },
        Settings { radius: 12, ..default },
        Settings { damping: f32::NAN, ..default },
        Settings { pilot: 1.5, ..default },
        Settings { sigma_albedo: 0.0, ..default },
    ] {
        assert!(matches!(run(&bare(&image, &image), settings), Error::Setting { .. }), "{settings:?}");
    }
}
