//! LDR-FLIP: the difference people see when they alternate between two pictures.
//!
//! P. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", Proc. ACM CGIT 3(2), 2020. Colours are
//! filtered by the eye's contrast sensitivity (§4.1), compared in a Hunt-adjusted L*a*b* with the HyAB distance (§4.1),
//! and the difference is amplified where edges or points differ (§4.2, §4.3).

use super::colours;
use crate::{Error, Image, Result};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Pixels per degree of a 0.7 m wide 3840-pixel screen seen from 0.7 m.
pub const DEFAULT_PIXELS_PER_DEGREE: f32 = 67.0206;

/// Exponent of the colour difference.
const QC: f32 = 0.7;
/// The fraction `PC` of the largest colour difference is mapped to `PT`.
const PC: f32 = 0.4;
const PT: f32 = 0.95;
/// Width of the feature detectors in degrees.
const FEATURE_WIDTH: f32 = 0.082;
/// Exponent of the feature difference.
const QF: f32 = 0.5;

/// Pixels that are filtered at a time, about 160 bytes each.
const BAND: usize = 1 << 20;

type Colour = [f32; 3];

/// Mean FLIP error of two pictures, 0 (the same) to 1; their linear values are cut to [0, 1]. NaN counts as black.
///
/// # Errors
/// [`Error::SizeMismatch`], [`Error::MissingChannels`], [`Error::Invalid`] when `pixels_per_degree` is not in 1 to
/// 1000.
pub fn flip(image: &Image, reference: &Image, pixels_per_degree: f32) -> Result<f64> {
    let mut sum = 0.0;
    flip_bands(image, reference, pixels_per_degree, |errors| {
        sum = errors.iter().fold(sum, |sum, &e| sum + f64::from(e));
    })?;
    Ok(sum / image.pixel_count() as f64)
}

/// The FLIP error of each pixel, see [`flip`].
///
/// # Errors
/// As [`flip`].
pub fn flip_map(image: &Image, reference: &Image, pixels_per_degree: f32) -> Result<Vec<f32>> {
    let mut map = Vec::with_capacity(image.pixel_count());
    flip_bands(image, reference, pixels_per_degree, |errors| map.extend_from_slice(errors))?;
    Ok(map)
}

/// Passes on the errors of bands of rows, from the top.
fn flip_bands(image: &Image, reference: &Image, pixels_per_degree: f32, mut pass: impl FnMut(&[f32])) -> Result<()> {
    if !(1.0..=1000.0).contains(&pixels_per_degree) {
        return Err(Error::Invalid(format!("pixels per degree must be in 1 to 1000, not {pixels_per_degree}")));
    }
    let (test, truth) = colours(image, reference)?;
    let (width, count) = (image.width(), image.pixel_count());
    if count == 0 {
        return Err(Error::Invalid("the pictures are empty".into()));
    }
    let height = image.height();
    // Bands of rows, with what the filters see above and below them: memory does not grow with the picture.
    let halo = sensitivity_radius(pixels_per_degree).max(feature_radius(pixels_per_degree));
    let band = (BAND / width).max(4 * halo).min(height);
    let largest = hyab(hunt(lab(xyz([0.0, 1.0, 0.0]))), hunt(lab(xyz([0.0, 0.0, 1.0])))).powf(QC);
    for top in (0..height).step_by(band) {
        let rows = (height - top).min(band);
        let opponent = |planes: crate::RgbPlanes<'_>| -> Vec<Colour> {
            let pixel = |i: usize| {
                // Rows beyond the picture are as those at its border.
                let y = (top + i / width).saturating_sub(halo).min(height - 1);
                let linear = planes.at(y * width + i % width).map(|v| if v > 0.0 { v.min(1.0) } else { 0.0 });
                ycxcz(xyz(linear))
            };
            (0..(rows + 2 * halo) * width).into_par_iter().map(pixel).collect()
        };
        let (test, truth) = (opponent(test), opponent(truth));
        let seen = |picture: &[Colour]| perceived(picture, width, pixels_per_degree);
        let (seen_test, seen_truth) = (seen(&test), seen(&truth));
        let features = |picture: &[Colour]| Features::of(picture, width, pixels_per_degree);
        let (features_test, features_truth) = (features(&test), features(&truth));
        let errors = (halo * width..(halo + rows) * width).into_par_iter().map(|i| {
            let colour = redistribute(hyab(seen_test[i], seen_truth[i]).powf(QC), largest);
            let edge = (features_test.edge[i] - features_truth.edge[i]).abs();
            let point = (features_test.point[i] - features_truth.point[i]).abs();
            let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).powf(QF);
            colour.powf(1.0 - feature)
        });
        let errors: Vec<f32> = errors.collect();
        pass(&errors);
    }
    Ok(())
}

/// Radius of the filters of contrast sensitivity, pixels.
fn sensitivity_radius(ppd: f32) -> usize {
    (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * ppd).ceil() as usize
}

/// Standard deviation of the feature detectors, pixels.
fn feature_deviation(ppd: f32) -> f32 {
    0.5 * FEATURE_WIDTH * ppd
}

/// Radius of the feature detectors, pixels.
fn feature_radius(ppd: f32) -> usize {
    (3.0 * feature_deviation(ppd)).ceil() as usize
}

/// Maps a colour difference to [0, 1], most of the range to the small ones.
fn redistribute(difference: f32, largest: f32) -> f32 {
    let knee = PC * largest;
    if difference < knee { PT / knee * difference } else { PT + (difference - knee) / (largest - knee) * (1.0 - PT) }
}

/// Perceived colour of each pixel: filtered per opponent channel, clipped to the displayable gamut, in Hunt-adjusted
/// L*a*b*.
fn perceived(picture: &[Colour], width: usize, ppd: f32) -> Vec<Colour> {
    // Contrast sensitivity as sums of Gaussians a·exp(−b f²) (paper, table 1): amplitudes and spreads per channel.
    const ACHROMATIC: [[f32; 2]; 1] = [[1.0, 0.0047]];
    const RED_GREEN: [[f32; 2]; 1] = [[1.0, 0.0053]];
    const BLUE_YELLOW: [[f32; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];
    let radius = sensitivity_radius(ppd);
    let channel = |lane: usize| -> Vec<f32> { picture.iter().map(|c| c[lane]).collect() };
    let filtered = [
        sensitivity(&channel(0), width, &ACHROMATIC, radius, ppd),
        sensitivity(&channel(1), width, &RED_GREEN, radius, ppd),
        sensitivity(&channel(2), width, &BLUE_YELLOW, radius, ppd),
    ];
    (0..picture.len())
        .into_par_iter()
        .map(|i| {
            let rgb = rgb_from_xyz(xyz_from_ycxcz([filtered[0][i], filtered[1][i], filtered[2][i]]));
            hunt(lab(xyz(rgb.map(|v| v.clamp(0.0, 1.0)))))
        })
        .collect()
}

/// Filters a plane with the inverse Fourier transform of a contrast sensitivity: a·√(π/b)·exp(−π²x²/b) per term, each
/// separable, normalised to sum 1 together.
fn sensitivity(plane: &[f32], width: usize, terms: &[[f32; 2]], radius: usize, ppd: f32) -> Vec<f32> {
    let kernels: Vec<(Vec<f32>, f32)> = terms
        .iter()
        .map(|&[a, b]| (kernel(radius, |x| (-PI * PI * (x / ppd).powi(2) / b).exp()), a * (PI / b).sqrt()))
        .collect();
    // Two-dimensional weight of each term: the amplitude once, its kernel in x and in y.
    let weight = |(k, a): &(Vec<f32>, f32)| a * k.iter().sum::<f32>().powi(2);
    let total: f32 = kernels.iter().map(weight).sum();
    let mut sum = vec![0.0; plane.len()];
    for (k, a) in &kernels {
        let filtered = separable(plane, width, k, k);
        sum.iter_mut().zip(filtered).for_each(|(s, f)| *s += a / total * f);
    }
    sum
}

/// Strength of edges and of points at each pixel.
struct Features {
    edge: Vec<f32>,
    point: Vec<f32>,
}

impl Features {
    /// Gradient and second-derivative magnitudes of the luminance, with Gaussian derivatives (paper, §4.2).
    fn of(picture: &[Colour], width: usize, ppd: f32) -> Self {
        let luminance: Vec<f32> = picture.iter().map(|c| (c[0] + 16.0) / 116.0).collect();
        let (deviation, radius) = (feature_deviation(ppd), feature_radius(ppd));
        let bell = |x: f32| (-x * x / (2.0 * deviation * deviation)).exp();
        let smooth = balanced(kernel(radius, bell));
        let first = balanced(kernel(radius, |x| -x * bell(x)));
        let second = balanced(kernel(radius, |x| (x * x / (deviation * deviation) - 1.0) * bell(x)));
        let magnitude = |derivative: &[f32]| -> Vec<f32> {
            let dx = separable(&luminance, width, derivative, &smooth);
            let dy = separable(&luminance, width, &smooth, derivative);
            dx.into_iter().zip(dy).map(|(x, y)| x.hypot(y)).collect()
        };
        Self { edge: magnitude(&first), point: magnitude(&second) }
    }
}

/// A kernel of 2·radius + 1 values.
fn kernel(radius: usize, f: impl Fn(f32) -> f32) -> Vec<f32> {
    (0..=2 * radius).map(|i| f(i as f32 - radius as f32)).collect()
}

/// Scales the positive values to sum 1 and the negative ones to sum −1.
fn balanced(mut kernel: Vec<f32>) -> Vec<f32> {
    let positive: f32 = kernel.iter().filter(|v| **v > 0.0).sum();
    let negative: f32 = -kernel.iter().filter(|v| **v < 0.0).sum::<f32>();
    kernel.iter_mut().for_each(|v| {
        *v /= if *v > 0.0 {
            positive
        } else if *v < 0.0 {
            negative
        } else {
            1.0
        }
    });
    kernel
}

/// Convolves rows with one kernel and columns with another; the border pixels continue outside.
fn separable(plane: &[f32], width: usize, along_x: &[f32], along_y: &[f32]) -> Vec<f32> {
    let height = plane.len() / width;
    let tap = |at: usize, k: usize, radius: usize, size: usize| (at + k).saturating_sub(radius).min(size - 1);
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(out, row)| {
        let radius = along_x.len() / 2;
        for (x, out) in out.iter_mut().enumerate() {
            *out = along_x.iter().enumerate().map(|(k, w)| w * row[tap(x, k, radius, width)]).sum();
        }
    });
    let mut result = vec![0.0; plane.len()];
    result.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        let radius = along_y.len() / 2;
        for (k, &w) in along_y.iter().enumerate() {
            let row = &rows[tap(y, k, radius, height) * width..][..width];
            out.iter_mut().zip(row).for_each(|(o, v)| *o += w * v);
        }
    });
    result
}

/// CIE XYZ of linear Rec.709, in the exact fractions of its primaries.
const XYZ: [[f32; 3]; 3] = [
    [10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0],
    [2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0],
    [1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0],
];
const RGB: [[f32; 3]; 3] = [
    [3.241_003, -1.537_399, -0.498_616],
    [-0.969_224, 1.875_93, 0.041_554_2],
    [0.055_639_4, -0.204_011_2, 1.057_148_9],
];

/// XYZ of white (1, 1, 1).
fn white() -> Colour {
    XYZ.map(|row| row[0] + row[1] + row[2])
}

fn xyz(rgb: Colour) -> Colour {
    multiply(&XYZ, rgb)
}

fn rgb_from_xyz(xyz: Colour) -> Colour {
    multiply(&RGB, xyz)
}

fn multiply(matrix: &[[f32; 3]; 3], [x, y, z]: Colour) -> Colour {
    matrix.map(|row| row[0] * x + row[1] * y + row[2] * z)
}

/// The linearised L*a*b* in which the eye's filters act.
fn ycxcz(xyz: Colour) -> Colour {
    let w = white();
    let [x, y, z] = [xyz[0] / w[0], xyz[1] / w[1], xyz[2] / w[2]];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_from_ycxcz(c: Colour) -> Colour {
    let w = white();
    let y = (c[0] + 16.0) / 116.0;
    [(y + c[1] / 500.0) * w[0], y * w[1], (y - c[2] / 200.0) * w[2]]
}

/// CIE L*a*b*.
fn lab(xyz: Colour) -> Colour {
    const DELTA: f32 = 6.0 / 29.0;
    let w = white();
    let f = |t: f32| if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let [x, y, z] = [f(xyz[0] / w[0]), f(xyz[1] / w[1]), f(xyz[2] / w[2])];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Hunt effect: colours look more colourful when brighter.
fn hunt([l, a, b]: Colour) -> Colour {
    [l, 0.01 * l * a, 0.01 * l * b]
}

/// The HyAB distance: city block in lightness, Euclidean in colour.
fn hyab(p: Colour, q: Colour) -> f32 {
    (p[0] - q[0]).abs() + (p[1] - q[1]).hypot(p[2] - q[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [96, 64];

    /// Waves in red, a checkerboard in green, a sawtooth in blue.
    fn pattern(shift: usize, gain: f32) -> Image {
        let pixels: Vec<Colour> = (0..SIZE[0] * SIZE[1])
            .map(|i| {
                let (x, y) = (i % SIZE[0], i / SIZE[0]);
                let red = 0.5 + 0.45 * (0.21 * (x + shift) as f32).sin() * (0.13 * y as f32).cos();
                let green = ((x / 8 + y / 8) % 2) as f32 * 0.6 * gain + 0.1;
                let blue = ((x * 7 + y * 13) % 32) as f32 / 32.0 * gain;
                [red, green, blue]
            })
            .collect();
        Image::from_rgb(SIZE[0], SIZE[1], &pixels).unwrap()
    }

    /// The numbers are those of the authors' own program (`flip-evaluator` 1.7, LDR, linear input) on the same
    /// pictures.
    #[test]
    fn agrees_with_the_authors_program() {
        for (shift, gain, ppd, expected) in [
            (1, 1.0, DEFAULT_PIXELS_PER_DEGREE, 0.110_857_494),
            (1, 1.0, 30.0, 0.107_490_748),
            (0, 0.9, DEFAULT_PIXELS_PER_DEGREE, 0.189_546_064),
            (0, 0.9, 30.0, 0.190_156_922),
            (3, 0.5, DEFAULT_PIXELS_PER_DEGREE, 0.614_546_418),
            (3, 0.5, 30.0, 0.618_891_418),
        ] {
            let seen = flip(&pattern(shift, gain), &pattern(0, 1.0), ppd).unwrap();
            assert!((seen - expected).abs() < 2e-4, "shift {shift}, gain {gain}, {ppd}: {seen}, expected {expected}");
        }
        let flat = |v: f32| Image::from_rgb(SIZE[0], SIZE[1], &[[v; 3]; SIZE[0] * SIZE[1]]).unwrap();
        let black_to_white = flip(&flat(1.0), &flat(0.0), DEFAULT_PIXELS_PER_DEGREE).unwrap();
        assert!((black_to_white - 0.967_325_21).abs() < 2e-4, "{black_to_white}");
    }

    /// A tall picture is compared in bands, which give what the whole gives.
    #[test]
    fn bands_do_not_show() {
        let size = [2, 600_000];
        let picture = |gain: f32| {
            let pixel = |i: usize| [(i % 7) as f32 / 7.0 * gain, (i / 300 % 5) as f32 / 5.0, 0.3 * gain];
            Image::from_rgb(size[0], size[1], &(0..size[0] * size[1]).map(pixel).collect::<Vec<_>>()).unwrap()
        };
        let (a, b) = (picture(1.0), picture(0.8));
        let whole = flip(&a, &b, DEFAULT_PIXELS_PER_DEGREE).unwrap();
        // The same rows, the other way around, have the ends of their bands elsewhere.
        let turned = |image: &Image| {
            let mut pixels = image.to_rgb().unwrap();
            pixels.reverse();
            Image::from_rgb(size[0], size[1], &pixels).unwrap()
        };
        let other = flip(&turned(&a), &turned(&b), DEFAULT_PIXELS_PER_DEGREE).unwrap();
        assert!((whole - other).abs() < 1e-7 && whole > 0.05, "{whole} {other}");
    }

    #[test]
    fn equal_pictures_and_bad_input() {
        let a = pattern(0, 1.0);
        assert_eq!(flip(&a, &a, DEFAULT_PIXELS_PER_DEGREE).unwrap(), 0.0);
        let nan = Image::from_rgb(1, 1, &[[f32::NAN, f32::INFINITY, -1.0]]).unwrap();
        let black = Image::from_rgb(1, 1, &[[0.0, 1.0, 0.0]]).unwrap();
        assert_eq!(flip(&nan, &black, DEFAULT_PIXELS_PER_DEGREE).unwrap(), 0.0);
        assert!(flip(&a, &nan, DEFAULT_PIXELS_PER_DEGREE).is_err());
        assert!(flip(&a, &a, 0.0).is_err() && flip(&a, &a, f32::NAN).is_err());
    }
}
