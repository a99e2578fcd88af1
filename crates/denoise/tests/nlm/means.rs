//! Filters keep the light of a picture: its mean after is its mean before, of scenes with long tails of noise.

use steradian_denoise::{
    Image, atrous,
    nlm::{self, Picture, Sequence, Settings},
};
use steradian_math::Vec3;

use crate::scene::Random;

const SIZE: [u32; 2] = [72, 56];

/// A picture that was sampled, with what is known of it.
struct Sampled {
    truth: Image<Vec3>,
    radiance: Image<Vec3>,
    variance: Image<Vec3>,
    albedo: Image<Vec3>,
    normal: Image<Vec3>,
}

/// Distribution of a pixel's samples: a colour with a probability, else another.
type Odds = (f32, Vec3, Vec3);

impl Sampled {
    fn new(odds: impl Fn(u32, u32) -> Odds, albedo: impl Fn(u32, u32) -> Vec3, spp: u32, seed: u64) -> Self {
        let mut random = Random(seed);
        let [width, height] = SIZE;
        let black = || Image::filled(width, height, Vec3::ZERO);
        let (mut truth, mut radiance, mut variance) = (black(), black(), black());
        for place in 0..(width * height) as usize {
            let (x, y) = (place as u32 % width, place as u32 / width);
            let (p, bright, dark) = odds(x, y);
            let factor = albedo(x, y);
            let samples =
                (0..spp).map(|_| if random.unit() < p { bright } else { dark * (0.5 + random.unit()) } * factor);
            let samples: Vec<Vec3> = samples.collect();
            let mean = samples.iter().sum::<Vec3>() / spp as f32;
            let squares = samples.iter().map(|s| (*s - mean) * (*s - mean)).sum::<Vec3>();
            truth.values_mut()[place] = (bright * p + dark * (1.0 - p)) * factor;
            radiance.values_mut()[place] = mean;
            variance.values_mut()[place] = squares / (spp * (spp - 1)) as f32;
        }
        let normal = Image::filled(width, height, Vec3::Z);
        Self { truth, radiance, variance, albedo: Image::from_fn(width, height, albedo), normal }
    }

    fn picture(&self) -> Picture<'_> {
        let (albedo, normal) = (Some(&self.albedo), Some(&self.normal));
        Picture { radiance: &self.radiance, variance: Some(&self.variance), albedo, normal, depth: None }
    }
}

/// Distance of a pixel's middle from a place.
fn far(x: u32, y: u32, at: [f32; 2]) -> f32 {
    (x as f32 - at[0]).hypot(y as f32 - at[1])
}

/// Small bright lamps that cover parts of pixels, before what is dark; caustics that few paths find; textures under
/// light that half of the paths find; fireflies everywhere.
fn scenes(spp: u32, seed: u64) -> Vec<(&'static str, Sampled)> {
    let white = |_: u32, _: u32| Vec3::ONE;
    let lamp = |x: u32, y: u32| {
        let covered =
            (2.0 - far(x, y, [20.3, 17.6])).clamp(0.0, 1.0).max((1.1 - far(x, y, [50.4, 30.2])).clamp(0.0, 1.0));
        (covered, Vec3::new(900.0, 700.0, 400.0), Vec3::splat(0.05))
    };
    let caustic = |x: u32, y: u32| match far(x, y, [36.0, 28.0]) {
        r if r < 12.0 => (0.04, Vec3::new(30.0, 24.0, 20.0), Vec3::splat(0.3)),
        _ => (0.0, Vec3::ZERO, Vec3::splat(0.3)),
    };
    let tiles = |x: u32, y: u32| match (x / 5 + y / 7) % 2 {
        0 => Vec3::new(0.9, 0.6, 0.2),
        _ => Vec3::new(0.1, 0.2, 0.8),
    };
    let half = |x: u32, _: u32| (0.2 + 0.6 * x as f32 / SIZE[0] as f32, Vec3::splat(2.0), Vec3::splat(0.1));
    let fireflies = |_: u32, _: u32| (0.002, Vec3::splat(60.0), Vec3::new(0.2, 0.3, 0.4));
    vec![
        ("lamps", Sampled::new(lamp, white, spp, seed)),
        ("caustic", Sampled::new(caustic, white, spp, seed + 1)),
        ("textures", Sampled::new(half, tiles, spp, seed + 2)),
        ("fireflies", Sampled::new(fireflies, white, spp, seed + 3)),
    ]
}

fn mean(image: &Image<Vec3>) -> Vec3 {
    image.values().iter().sum::<Vec3>() / image.values().len() as f32
}

/// relMSE.
fn relative_error(image: &Image<Vec3>, truth: &Image<Vec3>) -> f32 {
    let of = |(a, t): (&Vec3, &Vec3)| ((*a - *t) * (*a - *t) / (*t * *t + Vec3::splat(0.01))).element_sum() / 3.0;
    image.values().iter().zip(truth.values()).map(of).sum::<f32>() / truth.values().len() as f32
}

fn assert_kept(name: &str, before: &Image<Vec3>, after: &Image<Vec3>) {
    let ratio = mean(after) / mean(before);
    assert!((ratio - 1.0).abs().max_element() < 0.01, "{name}: {ratio}");
}

/// By each filter, with variance and without, as halves, and in sequence: within 1 %. The relative error
/// falls all the same, and is less than three times that of what lost light. Beside lamps alone noise is so low that
/// it grows.
#[test]
fn the_mean_of_a_picture_stays() {
    let settings = Settings::default();
    for spp in [8, 32] {
        let others = scenes(spp, 50);
        for ((name, sampled), (_, other)) in scenes(spp, 1).into_iter().zip(others) {
            let before = &sampled.radiance;
            let known = sampled.picture();
            for picture in [known, Picture { variance: None, ..known }] {
                let slow = nlm::denoise(&picture, &settings).unwrap().radiance;
                let quick = atrous::denoise(&picture, &atrous::SETTINGS).unwrap().radiance;
                for (filter, after) in [("nlm", &slow), ("atrous", &quick)] {
                    assert_kept(&format!("{filter}, {name}, {spp}"), before, after);
                    let errors = [before, after].map(|image| relative_error(image, &sampled.truth));
                    assert!(name == "lamps" || errors[1] < errors[0], "{filter}, {name}, {spp}: {errors:?}");
                }
                let biased = nlm::denoise(&picture, &Settings { keeps_mean: false, ..settings }).unwrap().radiance;
                let errors = [&biased, &slow].map(|image| relative_error(image, &sampled.truth));
                assert!(errors[1] < 3.0 * errors[0], "{name}, {spp}: {errors:?}");
            }
            let halves = nlm::denoise_halves([&known, &other.picture()], &settings).unwrap().0.radiance;
            let both = Image::from_fn(SIZE[0], SIZE[1], |x, y| {
                (*before.get(x, y).unwrap() + *other.radiance.get(x, y).unwrap()) * 0.5
            });
            assert_kept(&format!("halves, {name}, {spp}"), &both, &halves);
            let mut sequence = Sequence::default();
            let after = sequence.frame(&known, &Image::filled(SIZE[0], SIZE[1], Vec3::ZERO)).unwrap().radiance;
            assert_kept(&format!("sequence, {name}, {spp}"), before, &after);
        }
    }
}
