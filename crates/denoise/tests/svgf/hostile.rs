//! Any input.

use steradian_denoise::{
    Error, GBuffer, Image,
    svgf::{Denoiser, Settings, Term},
};
use steradian_math::{Vec2, Vec3};

use crate::scene::{Random, blind, frame, noise, wall};

fn number(random: &mut Random) -> f32 {
    match random.below(16) {
        0 => f32::from_bits(random.bits() as u32),
        1 => [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, f32::MIN, 1e-42, -0.0][random.below(7) as usize],
        2 => random.unit() * 1e5 - 5e4,
        _ => random.unit() * 3.0 - 1.0,
    }
}

fn wild(width: u32, height: u32, random: &mut Random) -> (Image<Vec3>, GBuffer) {
    let mut gbuffer = wall(width, height);
    let vector = |random: &mut Random| Vec3::from_array([(); 3].map(|()| number(random)));
    gbuffer.depth = Image::from_fn(width, height, |_, _| number(random));
    gbuffer.previous_depth = Image::from_fn(width, height, |_, _| number(random));
    gbuffer.depth_gradient = Image::from_fn(width, height, |_, _| vector(random).truncate());
    gbuffer.motion = Image::from_fn(width, height, |_, _| vector(random).truncate());
    gbuffer.normal = Image::from_fn(width, height, |_, _| vector(random));
    gbuffer.albedo = Image::from_fn(width, height, |_, _| vector(random));
    gbuffer.id = Image::from_fn(width, height, |_, _| random.below(3));
    (Image::from_fn(width, height, |_, _| vector(random)), gbuffer)
}

#[test]
fn any_input_gives_finite_pictures_with_the_same_bits_for_any_number_of_threads() {
    let sizes = [[1, 1], [1, 9], [40, 1], [2, 2], [17, 31], [64, 64]];
    for (seed, [width, height]) in (0u64..).zip(sizes.into_iter().cycle().take(36)) {
        let settings = Settings { clamp_history: seed % 2 == 0, iterations: seed as u32 % 7, ..Settings::default() };
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut denoiser = Denoiser::new(settings).unwrap();
            let mut random = Random(seed);
            let mut bits = Vec::new();
            for _ in 0..4 {
                let (radiance, gbuffer) = wild(width, height, &mut random);
                let left_out = radiance.values().iter().filter(|v| !v.is_finite()).count() as u64;
                let terms = [true, false].map(|has_albedo| Term { radiance: &radiance, has_albedo });
                for filtered in pool.install(|| denoiser.frame(&terms, &gbuffer)).unwrap() {
                    assert_eq!(filtered.left_out, left_out);
                    assert!(filtered.radiance.values().iter().all(|v| v.is_finite()), "seed {seed}");
                    assert!(filtered.variance.values().iter().all(|v| v.is_finite() && *v >= 0.0), "seed {seed}");
                    bits.extend(filtered.radiance.values().iter().flat_map(|v| v.to_array().map(f32::to_bits)));
                    bits.extend(filtered.variance.values().iter().map(|v| v.to_bits()));
                    bits.extend(filtered.history.values());
                }
            }
            bits
        };
        assert!(run(1) == run(3), "seed {seed}");
    }
}

#[test]
fn what_is_not_finite_is_left_out() {
    let gbuffer = wall(9, 9);
    let hole = |x: u32, y: u32, value: Vec3| {
        Image::from_fn(9, 9, |i, j| if [i, j] == [x, y] { Vec3::new(1.0, f32::INFINITY, 0.0) } else { value })
    };
    // Neighbours fill it; no frame is counted.
    let mut denoiser = Denoiser::new(Settings::default()).unwrap();
    let first = frame(&mut denoiser, &hole(4, 4, Vec3::splat(2.0)), &gbuffer);
    assert!((first.radiance.get(4, 4).unwrap() - 2.0).abs().max_element() < 1e-5);
    assert_eq!((first.left_out, first.history.get(4, 4), first.history.get(3, 4)), (1, Some(&0), Some(&1)));
    // A history stays as it was.
    let mut denoiser = blind(0);
    frame(&mut denoiser, &Image::filled(9, 9, Vec3::splat(2.0)), &gbuffer);
    let second = frame(&mut denoiser, &hole(4, 4, Vec3::splat(4.0)), &gbuffer);
    assert_eq!((second.radiance.get(4, 4), second.history.get(4, 4)), (Some(&Vec3::splat(2.0)), Some(&1)));
    assert_eq!((second.radiance.get(3, 4), second.history.get(3, 4)), (Some(&Vec3::splat(3.0)), Some(&2)));
    // Nothing is nothing.
    let none = frame(&mut blind(5), &Image::filled(9, 9, Vec3::NAN), &gbuffer);
    assert!(none.radiance.values().iter().all(|&v| v == Vec3::ZERO) && none.left_out == 81);
    assert!(none.variance.values().iter().all(|&v| v == 0.0));
}

#[test]
fn sizes_that_do_not_fit_are_refused_and_histories_stay() {
    let gbuffer = wall(5, 4);
    let picture = noise(5, 4, 1);
    let mut denoiser = blind(1);
    frame(&mut denoiser, &picture, &gbuffer);
    let mut refused = |radiance: &Image<Vec3>, gbuffer: &GBuffer| {
        denoiser.frame(&[Term { radiance, has_albedo: true }], gbuffer).unwrap_err()
    };
    let (found, expected) = ([4, 5], [5, 4]);
    assert_eq!(refused(&noise(4, 5, 1), &gbuffer), Error::Size { what: "radiance", found, expected });
    let turned = || wall(4, 5);
    let wrong = [
        ("depth_gradient", GBuffer { depth_gradient: turned().depth_gradient, ..gbuffer.clone() }),
        ("previous_depth", GBuffer { previous_depth: turned().previous_depth, ..gbuffer.clone() }),
        ("normal", GBuffer { normal: turned().normal, ..gbuffer.clone() }),
        ("albedo", GBuffer { albedo: turned().albedo, ..gbuffer.clone() }),
        ("id", GBuffer { id: turned().id, ..gbuffer.clone() }),
        ("motion", GBuffer { motion: turned().motion, ..gbuffer.clone() }),
    ];
    for (what, wrong) in wrong {
        assert_eq!(refused(&picture, &wrong), Error::Size { what, found, expected });
    }
    assert_eq!(refused(&picture, &wall(0, 7)), Error::Empty);
    assert_eq!(refused(&picture, &wall(4, 5)).to_string(), "radiance has 5×4 pixels; the frame has 4×5");
    assert_eq!(frame(&mut denoiser, &picture, &gbuffer).history.get(0, 0), Some(&2));
    // Another size begins anew, and so does a term more.
    assert_eq!(frame(&mut denoiser, &noise(4, 5, 1), &wall(4, 5)).history.get(0, 0), Some(&1));
    let radiance = &noise(4, 5, 2);
    let both = denoiser.frame(&[Term { radiance, has_albedo: false }; 2], &wall(4, 5)).unwrap();
    assert_eq!([&both[0], &both[1]].map(|filtered| filtered.history.values()[0]), [2, 1]);
    assert!(denoiser.frame(&[], &wall(4, 5)).unwrap().is_empty());
}

#[test]
fn settings_and_images_are_checked() {
    let refused = |settings| Denoiser::new(settings).unwrap_err().to_string();
    let good = Settings::default();
    assert_eq!(refused(Settings { alpha: 0.0, ..good }), "alpha is not above 0 and at most 1");
    assert_eq!(refused(Settings { moments_alpha: f32::NAN, ..good }), "moments_alpha is not above 0 and at most 1");
    assert_eq!(refused(Settings { iterations: 17, ..good }), "iterations is not at most 16");
    assert_eq!(refused(Settings { sigma_depth: -1.0, ..good }), "sigma_depth is not above 0");
    assert_eq!(refused(Settings { sigma_luminance: f32::NAN, ..good }), "sigma_luminance is not above 0");
    assert_eq!(Image::new(2, 2, vec![0; 3]), Err(Error::Values { found: 3, size: [2, 2] }));
    let image = Image::new(3, 2, vec![0, 1, 2, 3, 4, 5]).unwrap();
    assert_eq!((image.get(0, 1), image.get(3, 0), image.get(0, 2)), (Some(&3), None, None));
    assert_eq!(Image::from_fn(3, 2, |x, y| x + 3 * y), image);
    assert_eq!(Image::<Vec2>::new(0, u32::MAX, vec![]).unwrap().size(), [0, u32::MAX]);
}
