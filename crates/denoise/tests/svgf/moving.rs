//! A square that moves over a textured plane.

use steradian_denoise::{
    GBuffer, Image,
    svgf::{Denoiser, Filtered, Settings, Term},
};
use steradian_math::{Vec2, Vec3};

use crate::scene::{Random, wall};

const SIZE: [u32; 2] = [96, 64];
/// Pixels from frame to frame.
const SPEED: f32 = 3.5;
const FRAMES: u32 = 14;

/// True if a pixel shows the square.
fn is_square(x: u32, y: u32, frame: f32) -> bool {
    let left = 8.0 + SPEED * frame;
    (left..left + 24.0).contains(&(x as f32)) && (20..44).contains(&y)
}

/// A frame without noise, illumination and albedo, and what is known of it.
fn render(frame: u32) -> (Image<Vec3>, GBuffer) {
    let [width, height] = SIZE;
    let square = |x, y| is_square(x, y, frame as f32);
    let mut gbuffer = wall(width, height);
    gbuffer.id = Image::from_fn(width, height, |x, y| if square(x, y) { 2 } else { 1 });
    gbuffer.depth = Image::from_fn(width, height, |x, y| if square(x, y) { 4.0 } else { 6.0 });
    gbuffer.previous_depth = gbuffer.depth.clone();
    gbuffer.motion = Image::from_fn(width, height, |x, y| Vec2::new(if square(x, y) { -SPEED } else { 0.0 }, 0.0));
    gbuffer.albedo = Image::from_fn(width, height, |x, y| {
        let checks = if (x / 3 + y / 3) % 2 == 0 { 0.9 } else { 0.2 };
        if square(x, y) { Vec3::new(0.9, 0.3, 0.1) } else { Vec3::new(1.0, 0.8, 0.6) * checks }
    });
    let light = |x, y| if square(x, y) { 0.25 } else { 1.0 + 0.01 * x as f32 };
    (Image::from_fn(width, height, |x, y| light(x, y) * *gbuffer.albedo.get(x, y).unwrap()), gbuffer)
}

/// One sample for each pixel: all of twice the light, or none.
fn sampled(truth: &Image<Vec3>, random: &mut Random) -> Image<Vec3> {
    Image::from_fn(SIZE[0], SIZE[1], |x, y| *truth.get(x, y).unwrap() * if random.unit() < 0.5 { 0.0 } else { 2.0 })
}

/// The last of some frames: its truth, one sample of it, and two denoisers' results, of which the other sees only it.
pub fn last_frame(settings: Settings, seed: u64) -> (Image<Vec3>, Image<Vec3>, Filtered, Filtered) {
    let mut random = Random(seed);
    let denoiser = || Denoiser::new(settings).unwrap();
    let mut long = denoiser();
    for frame in 0..FRAMES - 1 {
        let (truth, gbuffer) = render(frame);
        let radiance = sampled(&truth, &mut random);
        long.frame(&[Term { radiance: &radiance, has_albedo: true }], &gbuffer).unwrap();
    }
    let (truth, gbuffer) = render(FRAMES - 1);
    let radiance = sampled(&truth, &mut random);
    let terms = [Term { radiance: &radiance, has_albedo: true }];
    let [with, without] = [long, denoiser()].map(|mut d| d.frame(&terms, &gbuffer).unwrap().remove(0));
    (truth, radiance, with, without)
}

/// Sums over pixels of errors of the green component, and of their squares.
fn errors(found: &Image<Vec3>, truth: &Image<Vec3>, is_asked: impl Fn(u32, u32) -> bool) -> [f64; 2] {
    let (mut sum, mut squares) = (0.0, 0.0);
    for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).filter(|&(x, y)| is_asked(x, y)) {
        let error = f64::from(found.get(x, y).unwrap().y - truth.get(x, y).unwrap().y);
        (sum, squares) = (sum + error, squares + error * error);
    }
    [sum, squares]
}

#[test]
fn the_error_falls_below_a_third() {
    for seed in 0..4 {
        let (truth, single, filtered, fresh) = last_frame(Settings::default(), seed);
        let of = |picture| errors(picture, &truth, |_, _| true)[1].sqrt();
        let [single, filtered, fresh] = [of(&single), of(&filtered.radiance), of(&fresh.radiance)];
        assert!(filtered < single / 3.0 && filtered < fresh, "{filtered} of {single}; {fresh} from one frame");
    }
}

/// Behind the moving square, the picture is what it would be if the square had never been there.
#[test]
fn nothing_stays_behind() {
    let last = (FRAMES - 1) as f32;
    let has_left = |x, y| is_square(x, y, last - 1.0) && !is_square(x, y, last);
    // For each seed, sums of errors and of their squares, less those of a history that begins.
    let mut differences = Vec::new();
    for seed in 0..24 {
        let (truth, _, with, without) = last_frame(Settings::default(), 100 + seed);
        for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).filter(|&(x, y)| has_left(x, y)) {
            assert_eq!(with.history.get(x, y), Some(&1), "{x}, {y}");
        }
        let [a, b] = [with, without].map(|filtered| errors(&filtered.radiance, &truth, has_left));
        differences.push([a[0] - b[0], a[1] - b[1]]);
    }
    let n = differences.len() as f64;
    let of = |i: usize| {
        let mean = differences.iter().map(|d| d[i]).sum::<f64>() / n;
        let variance = differences.iter().map(|d| (d[i] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean, (variance / n).sqrt())
    };
    let (bias, squares) = (of(0), of(1));
    assert!(bias.0.abs() < 3.5 * bias.1, "{bias:?}");
    assert!(squares.0 < 3.5 * squares.1, "{squares:?}");
}

/// The square's own history goes with it.
#[test]
fn what_moves_keeps_its_history() {
    let (_, _, filtered, _) = last_frame(Settings::default(), 7);
    let inner = |x, y| [0.0, -1.0, 1.0].iter().all(|d| is_square(x, y, (FRAMES - 1) as f32 + d));
    for (x, y) in (22..42).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).filter(|&(x, y)| inner(x, y)) {
        assert_eq!(filtered.history.get(x, y), Some(&FRAMES), "{x}, {y}");
    }
}
