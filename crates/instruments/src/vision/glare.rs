//! Glare: the point-spread function of an aperture, laid over a picture.
//!
//! Light of a point spreads as `|F(p/λ)|²`, the squared Fourier transform of the aperture (Fraunhofer; Ritschel et al.
//! 2009 for the eye). The pattern scales with the wavelength: it is computed once and resampled for each of twelve
//! wavelengths, which colours its streaks. It sums to one, so a picture keeps its light up to what leaves the frame.

use crate::laboratory::{Error, Experiment, Parameter, Picture, Report, Run, Values, rgb_from_xyz_in_gamut};
use glam::DVec3;
use rustfft::{Fft, FftPlanner, num_complex::Complex};
use std::{f64::consts::TAU, sync::Arc};
use steradian_math::{
    hash::HashRng,
    spectra::{cie, named},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "glare",
    doc: "a picture with the glare of its aperture: rings of a round one, stars of blades, the eye's lashes",
    source: "Goodman, Introduction to Fourier Optics, §4.4; Ritschel et al. 2009",
    parameters: &[
        Parameter::choice(
            "aperture",
            &["blades", "round", "eye"],
            "blades of a lens, a round hole, or an eye's pupil behind lashes",
        ),
        Parameter::count("blades", 6, (3, 24), "blades of the lens"),
        Parameter::number(
            "width",
            2.0,
            (0.2, 100.0),
            "px",
            "radius of the first dark ring of 550 nm of a round aperture",
        ),
        Parameter::number("share", 1.0, (0.0, 1.0), "", "share of the light that is spread"),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed of the lashes"),
    ],
    run: Run::OnPicture(run),
};

/// Edge of the grid of the aperture, and of the point-spread function.
const N: usize = 1024;
/// Radius of the aperture in that grid: the first dark ring is 0.61 N / RADIUS cells of the spectrum away.
const RADIUS: f64 = 24.0;
/// Edge of the function that is laid over pictures.
const SPREAD: usize = 512;

/// Transmittance of the aperture at a place, in units of its radius.
fn opening(kind: &str, blades: usize, lashes: &[(f64, f64, f64)], x: f64, y: f64) -> f64 {
    let r = x.hypot(y);
    match kind {
        "blades" => {
            let sector = TAU / blades as f64;
            let angle = (y.atan2(x)).rem_euclid(sector) - sector / 2.0;
            f64::from(u8::from(r * angle.cos() < (sector / 2.0).cos()))
        }
        "eye" if r < 1.0 => {
            let is_covered =
                lashes.iter().any(|(at, slope, width)| (x - at - slope * (1.0 - y)).abs() < *width && y > -0.2);
            f64::from(u8::from(!is_covered))
        }
        _ => f64::from(u8::from(r < 1.0)),
    }
}

/// In-place transform of rows, then of columns.
fn transform(field: &mut [Complex<f64>], width: usize, planner: &mut FftPlanner<f64>, is_inverse: bool) {
    let height = field.len() / width;
    let mut plan = |n: usize| -> Arc<dyn Fft<f64>> {
        if is_inverse { planner.plan_fft_inverse(n) } else { planner.plan_fft_forward(n) }
    };
    let (rows, columns) = (plan(width), plan(height));
    rows.process(field);
    let mut column = vec![Complex::new(0.0, 0.0); height];
    for x in 0..width {
        for (y, c) in column.iter_mut().enumerate() {
            *c = field[y * width + x];
        }
        columns.process(&mut column);
        for (y, c) in column.iter().enumerate() {
            field[y * width + x] = *c;
        }
    }
}

/// The spread of light of one wavelength, in cells of the spectrum around its middle.
fn diffraction(values: &Values, planner: &mut FftPlanner<f64>) -> Vec<f64> {
    let mut rng = HashRng::new(values.count("seed") as u64);
    let mut u = || f64::from(rng.next_f32());
    let lashes: Vec<_> = (0..14).map(|_| (2.0 * u() - 1.0, 0.6 * (u() - 0.5), 0.008 + 0.012 * u())).collect();
    let (kind, blades) = (values.choice("aperture"), values.count("blades"));
    let mut field: Vec<Complex<f64>> = (0..N * N)
        .map(|i| {
            let at = |v: usize, k: u32| (v as f64 + (f64::from(k) + 0.5) / 4.0 - N as f64 / 2.0) / RADIUS;
            let near = at(i % N, 0).abs().max(at(i / N, 0).abs()) < 1.1;
            let open = if near {
                (0..16).map(|k| opening(kind, blades, &lashes, at(i % N, k % 4), at(i / N, k / 4))).sum::<f64>() / 16.0
            } else {
                0.0
            };
            Complex::new(open, 0.0)
        })
        .collect();
    transform(&mut field, N, planner, false);
    // The middle of the spectrum comes to the middle of the grid.
    let shift = |v: usize| (v + N / 2) % N;
    let power: Vec<f64> = (0..N * N).map(|i| field[shift(i / N) * N + shift(i % N)].norm_sqr()).collect();
    let sum: f64 = power.iter().sum();
    power.into_iter().map(|p| p / sum).collect()
}

/// The point-spread function in linear Rec.709, `SPREAD × SPREAD` pixels, each channel summing to one.
fn spread(values: &Values, planner: &mut FftPlanner<f64>) -> Vec<DVec3> {
    let power = diffraction(values, planner);
    // Cells of the spectrum for a pixel at 550 nm: the first dark ring, at 1.22 λ/D, is 0.61 N / RADIUS cells out.
    let cells = 0.61 * N as f64 / RADIUS / values.number("width");
    let at = |x: f64, y: f64| -> f64 {
        let (x, y) = (x + N as f64 / 2.0, y + N as f64 / 2.0);
        if !(0.0..(N - 1) as f64).contains(&x) || !(0.0..(N - 1) as f64).contains(&y) {
            return 0.0;
        }
        let (i, j, s, t) = (x as usize, y as usize, x.fract(), y.fract());
        let row = |j: usize| power[j * N + i] * (1.0 - s) + power[j * N + i + 1] * s;
        row(j) * (1.0 - t) + row(j + 1) * t
    };
    let bands: Vec<(f64, DVec3)> = (0..12)
        .map(|k| 400.0 + 25.0 * (f64::from(k) + 0.5))
        .map(|nm| (nm, DVec3::from(cie::matching_linear(nm)) * f64::from(named::d65().eval(nm as f32))))
        .collect();
    let mut rgb = vec![DVec3::ZERO; SPREAD * SPREAD];
    for (i, out) in rgb.iter_mut().enumerate() {
        let mut xyz = DVec3::ZERO;
        for (nm, cmf) in &bands {
            let scale = cells * 550.0 / nm;
            // A pixel averages what falls on it.
            let samples = scale.ceil().clamp(1.0, 8.0) as u32;
            let place = |v: usize, k: u32| {
                (v as f64 - SPREAD as f64 / 2.0 + (f64::from(k) + 0.5) / f64::from(samples) - 0.5) * scale
            };
            let mean = (0..samples * samples)
                .map(|k| at(place(i % SPREAD, k % samples), place(i / SPREAD, k / samples)))
                .sum::<f64>()
                / f64::from(samples * samples);
            xyz += *cmf * (mean * scale * scale);
        }
        *out = DVec3::from(rgb_from_xyz_in_gamut(xyz).map(f64::from));
    }
    let sum: DVec3 = rgb.iter().sum();
    rgb.into_iter().map(|c| c / sum.max(DVec3::splat(1e-30))).collect()
}

fn run(values: &Values, picture: &Picture) -> Result<Report, Error> {
    let (w, h) = (picture.width + SPREAD, picture.height + SPREAD);
    if w * h > 1 << 27 {
        return Err(Error::Impossible("the picture has more than 2^27 pixels".into()));
    }
    let mut planner = FftPlanner::new();
    let kernel = spread(values, &mut planner);
    let share = values.number("share");
    let mut rgb = picture.rgb.clone();
    for c in 0..3 {
        let zero = Complex::new(0.0, 0.0);
        let mut field = vec![zero; w * h];
        let mut other = vec![zero; w * h];
        for (i, pixel) in picture.rgb.iter().enumerate() {
            field[i / picture.width * w + i % picture.width].re = f64::from(pixel[c]);
        }
        for (i, k) in kernel.iter().enumerate() {
            let wrap = |v: usize, n: usize| (v + n - SPREAD / 2) % n;
            other[wrap(i / SPREAD, h) * w + wrap(i % SPREAD, w)].re = k[c];
        }
        transform(&mut field, w, &mut planner, false);
        transform(&mut other, w, &mut planner, false);
        field.iter_mut().zip(&other).for_each(|(f, o)| *f *= o);
        transform(&mut field, w, &mut planner, true);
        for (i, pixel) in rgb.iter_mut().enumerate() {
            let blurred = field[i / picture.width * w + i % picture.width].re / (w * h) as f64;
            // Rounding of the transforms may leave a little below zero.
            let mixed = f64::from(pixel[c]) * (1.0 - share) + blurred.max(0.0) * share;
            pixel[c] = mixed as f32;
        }
    }
    let sum = |p: &[[f32; 3]]| p.iter().map(|c| f64::from(c[1])).sum::<f64>();
    let mut report = Report::default();
    report.quantity("share of the light that stays in the frame", sum(&rgb) / sum(&picture.rgb).max(1e-300), "");
    let middle = kernel[SPREAD / 2 * SPREAD + SPREAD / 2];
    report.quantity("share of a point's light in its own pixel", middle.y, "");
    report.picture = Some(Picture { rgb, ..*picture }.to_image()?);
    Ok(report)
}

/// Fraction of an Airy pattern's light within `v = π D sin θ/λ`, for tests.
#[cfg(test)]
fn encircled(v: f64) -> f64 {
    use std::f64::consts::PI;
    let j = |n: i32| {
        let f = |k: i32| (f64::from(n) * PI * f64::from(k) / 400.0 - v * (PI * f64::from(k) / 400.0).sin()).cos();
        (0.5 * (f(0) + f(400)) + (1..400).map(f).sum::<f64>()) / 400.0
    };
    1.0 - j(0).powi(2) - j(1).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M133: a point in the middle keeps its light; a round aperture's disc holds what Airy's formula says; six blades
    /// make six streaks.
    #[test]
    fn a_point_becomes_the_pattern_of_its_aperture() {
        let mut point = Picture::from_fn(129, 97, |_, _| [0.0; 3]);
        point.rgb[48 * 129 + 64] = [100.0; 3];
        let run_with = |given: &[(&str, &str)]| {
            let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
            EXPERIMENT.run(&given, Some(&point)).unwrap().picture.unwrap()
        };
        let round = run_with(&[("aperture", "round"), ("width", "8")]);
        let green = round.channel("G").unwrap();
        let within = |r: f64| -> f64 {
            let d = |i: usize| ((i % 129) as f64 - 64.0).hypot((i / 129) as f64 - 48.0);
            green.iter().enumerate().filter(|(i, _)| d(*i) < r).map(|(_, v)| f64::from(*v)).sum::<f64>() / 100.0
        };
        // Green light is near 545 nm; pixels at the edge of the disc count wholly or not.
        let exact = encircled(3.8317);
        assert!((within(8.0) - exact).abs() < 0.04, "{} {exact}", within(8.0));
        let star = run_with(&[("aperture", "blades"), ("width", "3")]);
        let g = star.channel("G").unwrap();
        // Light by direction, 15 to 40 pixels out.
        let mut by_angle = [0.0f64; 72];
        for (i, v) in g.iter().enumerate() {
            let (x, y) = ((i % 129) as f64 - 64.0, (i / 129) as f64 - 48.0);
            if (15.0..40.0).contains(&x.hypot(y)) {
                by_angle[(y.atan2(x).rem_euclid(TAU) / TAU * 72.0) as usize % 72] += f64::from(*v);
            }
        }
        let mean = by_angle.iter().sum::<f64>() / 72.0;
        let streaks = (0..72)
            .filter(|k| {
                by_angle[*k] > 2.0 * mean
                    && by_angle[*k] >= by_angle[(k + 71) % 72]
                    && by_angle[*k] > by_angle[(k + 1) % 72]
            })
            .count();
        assert_eq!(streaks, 6, "{by_angle:?}");
    }
}
