//! Frames of an animation, one after the other.

use steradian_denoise::{
    Image,
    nlm::{Picture, Sequence, Settings, denoise},
};
use steradian_math::Vec3;

use crate::scene::{Random, any_number, bare, noisy, square_error};

const SIZE: [u32; 2] = [72, 48];
const SIGMA: f32 = 0.2;

/// A pattern of little contrast that a frame alone does not tell from noise, moved to the right.
fn pattern(by: f32) -> Image<Vec3> {
    let wave = |x: f32, y: f32| 1.0 + 0.15 * (0.7 * (x - by)).sin() * (0.5 * y).cos();
    Image::from_fn(SIZE[0], SIZE[1], |x, y| Vec3::splat(wave(x as f32, y as f32)))
}

/// A shadow that ends at a column.
fn shadow(end: f32) -> Image<Vec3> {
    Image::from_fn(SIZE[0], SIZE[1], |x, _| Vec3::splat((x as f32 - end).clamp(0.0, 4.0) / 4.0 * 0.5 + 0.5))
}

fn moved(x: f32) -> Image<Vec3> {
    Image::filled(SIZE[0], SIZE[1], Vec3::X * x)
}

/// Errors of filtered frames with noise: with those before, and alone.
fn errors(frames: &[Image<Vec3>], motion: &Image<Vec3>) -> Vec<[f32; 2]> {
    let variance = Image::filled(SIZE[0], SIZE[1], Vec3::splat(SIGMA * SIGMA));
    let mut sequence = Sequence::new(Settings::default()).unwrap();
    let of = |(truth, seed): (&Image<Vec3>, u64)| {
        let radiance = noisy(truth, SIGMA, 100 + seed);
        let picture = bare(&radiance, &variance);
        let together = sequence.frame(&picture, motion).unwrap();
        let alone = denoise(&picture, &Settings::default()).unwrap();
        [together, alone].map(|found| square_error(&found.radiance, truth, 8))
    };
    frames.iter().zip(0..).map(of).collect()
}

/// Means of the errors of frames from one on.
fn means(errors: &[[f32; 2]], from: usize) -> [f32; 2] {
    [0, 1].map(|k| errors[from..].iter().map(|e| e[k]).sum::<f32>() / (errors.len() - from) as f32)
}

/// The first frame is a picture of its own. What stays the same is known better with time, and so is what moves, by
/// whole pixels or parts of them: errors fall to 0.41, 0.41 and 0.44 of those of frames alone.
#[test]
fn frames_get_better_with_time() {
    for (speed, most) in [(0.0, 0.5), (2.0, 0.5), (1.3, 0.55)] {
        let frames: Vec<_> = (0..10).map(|k| pattern(speed * k as f32)).collect();
        let errors = errors(&frames, &moved(speed));
        assert_eq!(errors[0][0].to_bits(), errors[0][1].to_bits());
        let [together, alone] = means(&errors, 5);
        assert!(together < most * alone, "{together} of {alone} at {speed}: {errors:?}");
    }
}

/// A shadow that moves over a surface at rest is not smeared: errors are 0.68, 0.79 and 0.81 of those of frames alone.
#[test]
fn moving_shadows_leave_no_ghosts() {
    for speed in [1.0, 3.0, 8.0] {
        let frames: Vec<_> = (0..7).map(|k| shadow(8.0 + speed * k as f32)).collect();
        let [together, alone] = means(&errors(&frames, &moved(0.0)), 1);
        assert!(together < alone, "{together} of {alone} at {speed}");
    }
}

/// Another depth, normal or albedo, a place outside, or motion that is not known: what was seen before is another
/// surface, and the frame is as alone, to the bit.
#[test]
fn other_surfaces_tell_nothing() {
    let variance = Image::filled(SIZE[0], SIZE[1], Vec3::splat(SIGMA * SIGMA));
    let [first, second] = [1, 2].map(|seed| noisy(&pattern(0.0), SIGMA, seed));
    let plain = [Vec3::splat(0.5), Vec3::Z].map(|v| Image::filled(SIZE[0], SIZE[1], v));
    let other = [Vec3::new(0.9, 0.5, 0.5), Vec3::X].map(|v| Image::filled(SIZE[0], SIZE[1], v));
    let depths = [2.0, 2.5, f32::INFINITY].map(|z| Image::filled(SIZE[0], SIZE[1], z));
    let before = Picture {
        albedo: Some(&plain[0]),
        normal: Some(&plain[1]),
        depth: Some(&depths[0]),
        ..bare(&first, &variance)
    };
    let now = Picture { radiance: &second, ..before };
    let after = |picture: &Picture<'_>, motion: Vec3| {
        let mut sequence = Sequence::new(Settings::default()).unwrap();
        sequence.frame(&before, &moved(0.0)).unwrap();
        sequence.frame(picture, &Image::filled(SIZE[0], SIZE[1], motion)).unwrap().radiance
    };
    let alone = |picture: &Picture<'_>| denoise(picture, &Settings::default()).unwrap().radiance;
    assert_ne!(after(&now, Vec3::ZERO), alone(&now));
    for (picture, motion) in [
        (Picture { depth: Some(&depths[1]), ..now }, Vec3::ZERO),
        (Picture { depth: Some(&depths[2]), ..now }, Vec3::ZERO),
        (Picture { normal: Some(&other[1]), ..now }, Vec3::ZERO),
        (Picture { albedo: Some(&other[0]), ..now }, Vec3::ZERO),
        (now, Vec3::X * 100.0),
        (now, Vec3::Z * 0.5),
        (now, Vec3::NAN),
    ] {
        assert_eq!(after(&picture, motion), alone(&picture), "{motion}");
    }
    // What has come nearer is the same surface where motion tells so.
    let deeper = Picture { depth: Some(&depths[1]), ..now };
    assert_ne!(after(&deeper, Vec3::Z * 0.5), alone(&deeper));
    // Another size begins anew; images that do not fit are refused.
    let (small, noise) = (Image::filled(9, 7, Vec3::ONE), Image::filled(9, 7, Vec3::splat(0.01)));
    let mut sequence = Sequence::new(Settings::default()).unwrap();
    sequence.frame(&before, &moved(0.0)).unwrap();
    assert!(sequence.frame(&bare(&small, &noise), &moved(0.0)).is_err());
    let found = sequence.frame(&bare(&small, &noise), &Image::filled(9, 7, Vec3::ZERO)).unwrap();
    assert_eq!(found.radiance, alone(&bare(&small, &noise)));
}

/// Any numbers give finite frames, and the same bits with any number of threads.
#[test]
fn bits_do_not_depend_on_threads() {
    let run = |threads: usize, is_hostile: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut random = Random(7);
            let mut sequence = Sequence::new(Settings::default()).unwrap();
            let frames = (0..4).map(|k| {
                let mut value = |plain: f32| if is_hostile { any_number(&mut random) } else { plain };
                let motion = Image::from_fn(SIZE[0], SIZE[1], |_, _| Vec3::new(value(1.4), value(-0.3), value(0.0)));
                let depth = Image::from_fn(SIZE[0], SIZE[1], |_, _| value(2.0));
                let variance = Image::from_fn(SIZE[0], SIZE[1], |_, _| Vec3::splat(value(SIGMA * SIGMA)));
                let mut radiance = noisy(&pattern(k as f32), SIGMA, k);
                radiance.values_mut().iter_mut().for_each(|v| v.x = value(v.x));
                let picture = Picture { depth: Some(&depth), ..bare(&radiance, &variance) };
                sequence.frame(&picture, &motion).unwrap().radiance
            });
            frames.collect::<Vec<_>>()
        })
    };
    assert_eq!(run(1, false), run(3, false));
    let hostile = run(2, true);
    assert!(hostile.iter().flat_map(|frame| frame.values()).all(|v| v.is_finite()));
}
