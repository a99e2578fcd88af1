//! Fresnel diffraction: the light behind a screen at a finite distance, by its angular spectrum.
//!
//! The field just behind the screen is a sum of plane waves, each of which goes on with the phase
//! `z √(k² − k_x² − k_y²)`; waves with `k_x² + k_y² > k²` are evanescent (Goodman, *Introduction to Fourier Optics*,
//! §3.10). Two fast Fourier transforms do it. The window is periodic, so its edge is twice as wide as what is shown,
//! and the phase is cut where it would alias (Matsushima, Shimobaba 2009, eq. 13).

use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, monochromatic,
};
use rustfft::{FftPlanner, num_complex::Complex};
use std::f64::consts::{PI, TAU};

pub const EXPERIMENT: Experiment = Experiment {
    name: "near-field",
    doc: "Fresnel diffraction behind a hole, a disc (Poisson's spot), a square, a slit or an edge",
    source: "Goodman, Introduction to Fourier Optics, eq. 3-74; Matsushima, Shimobaba 2009, eq. 13",
    parameters: &[
        Parameter::choice("shape", &["hole", "disc", "square", "slit", "edge"], "a hole, or a disc that is in the way"),
        Parameter::number(
            "size",
            1.0,
            (1e-3, 100.0),
            "mm",
            "diameter of the hole or disc, edge of the square, width of the slit",
        ),
        Parameter::number("distance", 0.5, (1e-4, 1e4), "m", "from the screen to the picture"),
        Parameter::number("wavelength", 633.0, (10.0, 1e5), "nm", "of the light"),
        Parameter::number("view", 3.0, (1e-2, 1000.0), "mm", "width of the picture"),
        Parameter::choice("resolution", &["512", "256", "1024"], "pixels of the picture along an edge"),
    ],
    run: Run::Alone(run),
};

/// Relative intensities behind the screen, in the middle `n × n` of a `2n × 2n` window. The axis goes through the
/// middle of pixel `(n/2, n/2)`.
fn intensities(shape: &str, size: f64, distance: f64, lambda: f64, view: f64, n: usize) -> Vec<f64> {
    let edge = 2 * n;
    let pixel = view / n as f64;
    // Open area of a pixel, by 4 × 4 points.
    let open = |x: usize, y: usize| -> f64 {
        let place = |i: usize, k: usize| (i as f64 - 0.5 + (k as f64 + 0.5) / 4.0 - n as f64) * pixel;
        let inside = (0..16).filter(|k| {
            let (px, py) = (place(x, k % 4), place(y, k / 4));
            match shape {
                "hole" => px.hypot(py) < size / 2.0,
                "disc" => px.hypot(py) >= size / 2.0,
                "square" => px.abs().max(py.abs()) < size / 2.0,
                "slit" => px.abs() < size / 2.0,
                _ => px > 0.0,
            }
        });
        inside.count() as f64 / 16.0
    };
    let mut field: Vec<Complex<f64>> = (0..edge * edge).map(|i| Complex::new(open(i % edge, i / edge), 0.0)).collect();
    let mut planner = FftPlanner::new();
    transform(&mut field, edge, &planner.plan_fft_forward(edge));
    let width = edge as f64 * pixel;
    let frequency = |i: usize| (if i < n { i as f64 } else { i as f64 - edge as f64 }) / width;
    // Beyond this frequency neighbouring samples of the phase differ by more than half a turn.
    let limit = 1.0 / (lambda * ((2.0 * distance / width).powi(2) + 1.0).sqrt());
    for (i, f) in field.iter_mut().enumerate() {
        let (u, v) = (frequency(i % edge), frequency(i / edge));
        let s = 1.0 / (lambda * lambda) - u * u - v * v;
        // `√s − 1/λ`, without the loss of digits; a common phase does not matter.
        let phase = if s > 0.0 { -TAU * distance * (u * u + v * v) / (s.sqrt() + 1.0 / lambda) } else { 0.0 };
        let is_kept = s > 0.0 && u.abs() < limit && v.abs() < limit;
        *f *= if is_kept { Complex::from_polar(1.0, phase) } else { Complex::new(0.0, 0.0) };
    }
    transform(&mut field, edge, &planner.plan_fft_inverse(edge));
    let scale = 1.0 / (edge as f64).powi(4);
    (0..n * n).map(|i| field[(i / n + n / 2) * edge + i % n + n / 2].norm_sqr() * scale).collect()
}

/// The transform of rows and of columns, in place.
fn transform(field: &mut [Complex<f64>], edge: usize, fft: &std::sync::Arc<dyn rustfft::Fft<f64>>) {
    for _ in 0..2 {
        for row in field.chunks_exact_mut(edge) {
            fft.process(row);
        }
        for y in 0..edge {
            for x in 0..y {
                field.swap(y * edge + x, x * edge + y);
            }
        }
    }
}

fn run(values: &Values) -> Result<Report, Error> {
    let (shape, size) = (values.choice("shape"), values.number("size") * 1e-3);
    let (distance, lambda) = (values.number("distance"), values.number("wavelength") * 1e-9);
    let view = values.number("view") * 1e-3;
    let n: usize = values.choice("resolution").parse().unwrap_or(512);
    if view / n as f64 > size {
        return Err(Error::Impossible("a pixel is wider than 'size': make 'view' smaller".into()));
    }
    let light = intensities(shape, size, distance, lambda, view, n);
    let middle = light[n / 2 * n + n / 2];
    let mut report = Report::default();
    report.quantity("Fresnel number", (size / 2.0).powi(2) / (lambda * distance), "");
    report.quantity("intensity in the middle", middle, "");
    if shape == "hole" {
        let exact = 4.0 * (PI * (size / 2.0).powi(2) / (2.0 * lambda * distance)).sin().powi(2);
        report.quantity("4 sin²(π a²/2λz)", exact, "");
    }
    let place = |x: usize| (x as f64 / n as f64 - 0.5) * view * 1e3;
    let row = (0..n).map(|x| (place(x), light[n / 2 * n + x])).collect();
    report.chart = Some(
        Chart::new(
            format!("{shape}, {} mm, at {distance} m, {} nm", size * 1e3, lambda * 1e9),
            Axis::linear("place (mm)"),
            Axis::linear("relative intensity"),
        )
        .with(Series::line("intensity", row)),
    );
    let color = monochromatic(lambda * 1e9);
    let brightest = color.iter().copied().fold(0.0, f32::max);
    let color = if brightest > 0.0 { color.map(|c| 0.5 * c / brightest) } else { [0.5; 3] };
    report.picture = Some(Picture::from_fn(n, n, |x, y| color.map(|c| c * light[y * n + x] as f32)).to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On the axis behind a hole the intensity is 4 sin²(πa²/2λz) in Fresnel's approximation (Born, Wolf, §8.8). The
    /// rim is drawn by pixels, which moves the Fresnel number by about a pixel over the radius times it.
    #[test]
    fn the_axis_behind_a_hole_is_dark_and_bright_by_turns() {
        let (radius, lambda, view, n) = (0.5e-3_f64, 633e-9, 3e-3, 256);
        for number in [1.0, 1.5, 2.0, 3.0] {
            let distance = radius * radius / (lambda * number);
            let light = intensities("hole", 2.0 * radius, distance, lambda, view, n);
            let axis = light[n / 2 * n + n / 2];
            let exact = 4.0 * (PI * number / 2.0).sin().powi(2);
            assert!((axis - exact).abs() < 0.12, "N = {number}: {axis} {exact}");
        }
    }

    /// Poisson's spot: behind a disc the axis is as bright as without it. The edge of the geometric shadow of an edge
    /// has a quarter.
    #[test]
    fn the_shadow_of_a_disc_has_a_bright_middle_and_that_of_an_edge_a_quarter() {
        let n = 512;
        let light = intensities("disc", 1e-3, 0.1, 633e-9, 4e-3, n);
        let middle = light[n / 2 * n + n / 2];
        let beside = light[n / 2 * n + n / 2 + n / 16];
        assert!((middle - 1.0).abs() < 0.15 && beside < 0.3, "{middle} {beside}");
        let light = intensities("edge", 1e-3, 0.2, 633e-9, 4e-3, n);
        let at_edge = light[n / 2 * n + n / 2];
        assert!((at_edge - 0.25).abs() < 0.02, "{at_edge}");
    }

    /// Energy through the screen arrives, but for that diffracted out of the window: `2/(π v)` of the light of a hole
    /// is beyond `v = k a θ`.
    #[test]
    fn energy_is_kept() {
        let (n, radius, lambda, distance, view) = (256, 0.5e-3, 633e-9, 0.1, 4e-3);
        let pixel = view / n as f64;
        let light = intensities("hole", 2.0 * radius, distance, lambda, view, n);
        let share = light.iter().sum::<f64>() * pixel * pixel / (PI * radius * radius);
        let v = TAU / lambda * radius * (view / 2.0 - radius) / distance;
        assert!((share - (1.0 - 2.0 / (PI * v))).abs() < 0.004, "{share}");
    }
}
