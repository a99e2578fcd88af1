//! The quick filter of finished pictures against what is known of it by other means.

#[path = "nlm/scene.rs"]
mod scene;

use scene::{Random, any_number, bare, noisy, square_error};
use steradian_denoise::{
    Error, Image,
    atrous::{SETTINGS, denoise},
    nlm::Picture,
    svgf::Settings,
};
use steradian_math::Vec3;

#[test]
fn what_is_constant_stays() {
    let radiance = Image::filled(40, 25, Vec3::new(0.7, 2.0, 1e-3));
    let variance = Image::filled(40, 25, Vec3::splat(0.1));
    for picture in [bare(&radiance, &variance), Picture { variance: None, ..bare(&radiance, &variance) }] {
        let found = denoise(&picture, &SETTINGS).unwrap();
        let apart = found.radiance.values().iter().map(|v| (*v / radiance.values()[0] - 1.0).abs().max_element());
        assert!(apart.fold(0.0, f32::max) < 1e-5);
        assert_eq!(found.not_finite, 0);
    }
}

/// Without distinguishing features, variance falls by the sum of the squares of the kernel's weights: 70/256 along each
/// axis for one passage. Several are the convolution of B₃ splines with gaps of 1, 2, 4, ….
#[test]
fn noise_falls_by_what_the_kernel_gives() {
    let (size, sigma) = (420, 0.1);
    let truth = Image::filled(size, size, Vec3::ONE);
    let variance = Image::filled(size, size, Vec3::splat(sigma * sigma));
    let radiance = noisy(&truth, sigma, 11);
    for (iterations, expected) in [(1, (70.0f32 / 256.0).powi(2)), (2, convolved(2)), (3, convolved(3))] {
        let blind = Settings { iterations, sigma_luminance: f32::INFINITY, ..SETTINGS };
        let found = denoise(&bare(&radiance, &variance), &blind).unwrap().radiance;
        let left = square_error(&found, &truth, 16) / (sigma * sigma);
        // As many independent means as kernels fit, three channels of each; four standard errors.
        let count = 3.0 * (size as f32 - 32.0).powi(2) * expected;
        let tolerance = 4.0 * (2.0 / count).sqrt();
        assert!((left / expected - 1.0).abs() < tolerance && tolerance < 0.15, "{left} for {expected} ± {tolerance}");
    }
}

fn convolved(passages: u32) -> f32 {
    let mut kernel = vec![1.0f32];
    for step in (0..passages).map(|i| 1usize << i) {
        let mut wider = vec![0.0; kernel.len() + 4 * step];
        for (tap, weight) in [1.0, 4.0, 6.0, 4.0, 1.0].into_iter().enumerate() {
            kernel.iter().enumerate().for_each(|(i, k)| wider[i + tap * step] += k * weight / 16.0);
        }
        kernel = wider;
    }
    kernel.iter().map(|k| k * k).sum::<f32>().powi(2)
}

/// With its own settings most of the kernel counts on a plane: noise falls 40 times at least.
#[test]
fn noise_on_a_plane_falls() {
    let truth = Image::filled(96, 96, Vec3::new(0.3, 0.5, 0.9));
    let variance = Image::filled(96, 96, Vec3::splat(0.01));
    let radiance = noisy(&truth, 0.1, 2);
    let found = denoise(&bare(&radiance, &variance), &SETTINGS).unwrap().radiance;
    let left = square_error(&found, &truth, 8);
    assert!(left < 0.01 / 40.0, "{left}");
    let alone = Picture { variance: None, ..bare(&radiance, &variance) };
    let left = square_error(&denoise(&alone, &SETTINGS).unwrap().radiance, &truth, 8);
    assert!(left < 0.01 / 15.0, "{left}");
}

/// Two walls whose light differs by less than its noise: what guides tells them apart.
#[test]
fn edges_of_guides_stay_sharp() {
    let is_left = |x: u32| x < 30;
    let truth = Image::from_fn(60, 44, |x, _| Vec3::splat(if is_left(x) { 1.0 } else { 1.4 }));
    let radiance = noisy(&truth, 0.5, 3);
    let variance = Image::filled(60, 44, Vec3::splat(0.25));
    let normal = Image::from_fn(60, 44, |x, _| if is_left(x) { Vec3::X } else { Vec3::Z });
    let depth = Image::from_fn(60, 44, |x, _| if is_left(x) { 3.0 } else { 4.0 });
    let found = |normal, depth| {
        let picture = Picture { normal, depth, ..bare(&radiance, &variance) };
        let found = denoise(&picture, &SETTINGS).unwrap().radiance;
        // The means of the columns on both sides.
        [29, 30].map(|x| (0..44).map(|y| found.get(x, y).unwrap().x).sum::<f32>() / 44.0)
    };
    for guides in [(Some(&normal), None), (None, Some(&depth))] {
        let [left, right] = found(guides.0, guides.1);
        assert!((left - 1.0).abs() < 0.08 && (right - 1.4).abs() < 0.08, "{left}, {right}");
    }
    let [left, right] = found(None, None);
    assert!(right - left < 0.2, "{left}, {right}: colour alone does not tell");
}

/// Textures are divided out.
#[test]
fn edges_of_albedo_stay_sharp() {
    let albedo = Image::from_fn(60, 44, |x, y| match (x / 7 + y / 5) % 2 {
        0 => Vec3::new(0.9, 0.6, 0.2),
        _ => Vec3::new(0.1, 0.2, 0.8),
    });
    let light = noisy(&Image::filled(60, 44, Vec3::splat(2.0)), 0.5, 4);
    let of = |x, y| *albedo.get(x, y).unwrap();
    let radiance = Image::from_fn(60, 44, |x, y| of(x, y) * *light.get(x, y).unwrap());
    let variance = Image::from_fn(60, 44, |x, y| of(x, y) * of(x, y) * 0.25);
    let picture = Picture { albedo: Some(&albedo), ..bare(&radiance, &variance) };
    let found = denoise(&picture, &SETTINGS).unwrap().radiance;
    for (place, (found, albedo)) in found.values().iter().zip(albedo.values()).enumerate() {
        let apart = (*found / (2.0 * *albedo) - 1.0).abs().max_element();
        assert!(apart < 0.2, "{apart} at {place}");
    }
}

/// Sky and lamps keep their bits, and lend nothing to what stands before or beside them.
#[test]
fn sky_and_lamps_stay_as_they_are() {
    let is_sky = |x: u32, y: u32| y < 12 + x / 4;
    let is_lamp = |x: u32, y: u32| (20..28).contains(&x) && (30..36).contains(&y);
    let truth = Image::from_fn(48, 40, |x, y| match [is_sky(x, y), is_lamp(x, y)] {
        [true, _] => Vec3::new(1.0, 2.0, 30.0),
        [_, true] => Vec3::splat(50.0 + x as f32),
        _ => Vec3::splat(0.5),
    });
    let noise = noisy(&truth, 0.1, 5);
    let radiance = Image::from_fn(48, 40, |x, y| *if is_lamp(x, y) { &truth } else { &noise }.get(x, y).unwrap());
    let variance = Image::from_fn(48, 40, |x, y| Vec3::splat(if is_lamp(x, y) { 0.0 } else { 0.01 }));
    let normal = Image::from_fn(48, 40, |x, y| if is_sky(x, y) { Vec3::ZERO } else { Vec3::Y });
    let depth = Image::from_fn(48, 40, |x, y| if is_sky(x, y) { f32::INFINITY } else { 4.0 });
    let picture = Picture { normal: Some(&normal), depth: Some(&depth), ..bare(&radiance, &variance) };
    let found = denoise(&picture, &SETTINGS).unwrap().radiance;
    for (x, y) in (0..40).flat_map(|y| (0..48).map(move |x| (x, y))) {
        let (found, before) = (*found.get(x, y).unwrap(), *radiance.get(x, y).unwrap());
        if is_sky(x, y) || is_lamp(x, y) {
            assert_eq!(found, before, "{x}, {y}");
        } else {
            assert!((found - 0.5).abs().max_element() < 0.15, "{found} at {x}, {y}");
        }
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
    let normal = Image::filled(40, 30, Vec3::ZERO);
    for normal in [None, Some(&normal)] {
        let found = denoise(&Picture { normal, ..bare(&radiance, &variance) }, &SETTINGS).unwrap();
        assert_eq!(found.not_finite, 4);
        for place in [5, 417, 418, 600] {
            let value = found.radiance.values()[place];
            assert!((value - truth.values()[place]).abs().max_element() < 0.1, "{value} at {place}");
        }
        assert!(normal.is_some() || square_error(&found.radiance, &truth, 0) < 0.01 / 20.0);
    }
}

#[test]
fn any_input_gives_the_same_bits_for_any_number_of_threads() {
    let sizes = [[1, 1], [1, 9], [70, 1], [2, 2], [17, 31], [150, 37]];
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
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| denoise(&picture, &Settings { iterations: seed as u32 % 7, ..SETTINGS })).unwrap()
        };
        let (one, many) = (run(1), run(5));
        let bits =
            |image: &Image<Vec3>| image.values().iter().map(|v| v.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&one.radiance), bits(&many.radiance), "{width}×{height}, {seed}");
        assert!(one.radiance.values().iter().all(|v| v.is_finite()), "{width}×{height}, {seed}");
        assert_eq!(one.not_finite, radiance.values().iter().filter(|v| !v.is_finite()).count());
    }
}

#[test]
fn what_cannot_be_filtered_is_refused() {
    let image = Image::filled(4, 3, Vec3::ONE);
    let other = Image::filled(3, 4, Vec3::ONE);
    let wrong = denoise(&Picture { albedo: Some(&other), ..bare(&image, &image) }, &SETTINGS).unwrap_err();
    assert_eq!(wrong, Error::Size { what: "albedo", found: [3, 4], expected: [4, 3] });
    let none = Image::filled(0, 3, Vec3::ONE);
    assert_eq!(denoise(&bare(&none, &none), &SETTINGS).unwrap_err(), Error::Empty);
    let wrong = denoise(&bare(&image, &image), &Settings { sigma_depth: 0.0, ..SETTINGS });
    assert!(matches!(wrong, Err(Error::Setting { what: "sigma_depth", .. })), "{wrong:?}");
}
