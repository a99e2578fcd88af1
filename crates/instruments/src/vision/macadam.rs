//! MacAdam's 25 ellipses: standard deviations of matches of one observer (MacAdam, *J. Opt. Soc. Am.* 32, 1942, table
//! III; as in Wyszecki, Stiles, *Color Science*, table I(5.4.1)), and the distance that they define.
//!
//! One step is one standard deviation (SDCM), `ds² = g₁₁ dx² + 2 g₁₂ dx dy + g₂₂ dy²`; about three are just noticeable.
//! Between the centres of the ellipses the coefficients are interpolated by the inverse square of the distance (Shepard
//! 1968), which agrees with those that lamps are sorted by to a fifth.

use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};

pub const EXPERIMENT: Experiment = Experiment {
    name: "macadam",
    doc: "the difference of two chromaticities in MacAdam's steps (SDCM), and the ellipse around the first",
    source: "MacAdam 1942, table III; ANSI C78.376 (metrics of lamps)",
    parameters: &[
        Parameter::number("x", 0.3804, (0.0, 1.0), "", "reference: x (4000 K)"),
        Parameter::number("y", 0.3768, (0.0, 1.0), "", "reference: y"),
        Parameter::number("x2", 0.3830, (0.0, 1.0), "", "chromaticity compared with it: x"),
        Parameter::number("y2", 0.3850, (0.0, 1.0), "", "chromaticity compared with it: y"),
    ],
    run: Run::Alone(run),
};

/// Centre `x`, `y`, semi-axes `10³ a`, `10³ b`, and the angle of `a` from the x axis in degrees.
pub const ELLIPSES: [[f64; 5]; 25] = [
    [0.160, 0.057, 0.85, 0.35, 62.5],
    [0.187, 0.118, 2.2, 0.55, 77.0],
    [0.253, 0.125, 2.5, 0.50, 55.5],
    [0.150, 0.680, 9.6, 2.3, 105.0],
    [0.131, 0.521, 4.7, 2.0, 112.5],
    [0.212, 0.550, 5.8, 2.3, 100.0],
    [0.258, 0.450, 5.0, 2.0, 92.0],
    [0.152, 0.365, 3.8, 1.9, 110.0],
    [0.280, 0.385, 4.0, 1.5, 75.5],
    [0.380, 0.498, 4.4, 1.2, 70.0],
    [0.160, 0.200, 2.1, 0.95, 104.0],
    [0.228, 0.250, 3.1, 0.90, 72.0],
    [0.305, 0.323, 2.3, 0.90, 58.0],
    [0.385, 0.393, 3.8, 1.6, 65.5],
    [0.472, 0.399, 3.2, 1.4, 51.0],
    [0.527, 0.350, 2.6, 1.3, 20.0],
    [0.475, 0.300, 2.9, 1.1, 28.5],
    [0.510, 0.236, 2.4, 1.2, 29.5],
    [0.596, 0.283, 2.6, 1.3, 13.0],
    [0.344, 0.284, 2.3, 0.90, 60.0],
    [0.390, 0.237, 2.5, 1.0, 47.0],
    [0.441, 0.198, 2.8, 0.95, 34.5],
    [0.278, 0.223, 2.4, 0.55, 57.5],
    [0.300, 0.163, 2.9, 0.60, 54.0],
    [0.365, 0.153, 3.6, 0.95, 40.0],
];

/// Points of an ellipse, enlarged.
pub fn outline([x, y, a, b, degrees]: [f64; 5], scale: f64) -> Vec<(f64, f64)> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    (0..=48)
        .map(|k| (f64::from(k) * std::f64::consts::TAU / 48.0).sin_cos())
        .map(|(s, c)| (a * 1e-3 * scale * c, b * 1e-3 * scale * s))
        .map(|(u, v)| (x + u * cos - v * sin, y + u * sin + v * cos))
        .collect()
}

/// Coefficients `g₁₁`, `g₁₂`, `g₂₂` of an ellipse.
fn metric([_, _, a, b, degrees]: [f64; 5]) -> [f64; 3] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (p, q) = ((1e3 / a).powi(2), (1e3 / b).powi(2));
    [p * cos * cos + q * sin * sin, (p - q) * sin * cos, p * sin * sin + q * cos * cos]
}

/// At any chromaticity.
fn metric_at(x: f64, y: f64) -> [f64; 3] {
    let (mut weights, mut sums) = (0.0, [0.0; 3]);
    for e in ELLIPSES {
        let squared = (x - e[0]).powi(2) + (y - e[1]).powi(2);
        if squared < 1e-18 {
            return metric(e);
        }
        weights += squared.recip();
        sums.iter_mut().zip(metric(e)).for_each(|(sum, g)| *sum += g / squared);
    }
    sums.map(|s| s / weights)
}

/// Steps of a difference.
fn steps([g11, g12, g22]: [f64; 3], dx: f64, dy: f64) -> f64 {
    (g11 * dx * dx + 2.0 * g12 * dx * dy + g22 * dy * dy).max(0.0).sqrt()
}

/// The ellipse of a metric, with its centre, as in [`ELLIPSES`].
fn ellipse(x: f64, y: f64, [g11, g12, g22]: [f64; 3]) -> [f64; 5] {
    let (mean, half) = (0.5 * (g11 + g22), (0.5 * (g11 - g22)).hypot(g12));
    // The long axis lies where the form grows least.
    let angle = 0.5 * (-g12).atan2(0.5 * (g22 - g11));
    [x, y, 1e3 / (mean - half).sqrt(), 1e3 / (mean + half).sqrt(), angle.to_degrees().rem_euclid(180.0)]
}

fn run(values: &Values) -> Result<Report, Error> {
    let [x, y, x2, y2] = ["x", "y", "x2", "y2"].map(|name| values.number(name));
    if x + y > 1.0 || x2 + y2 > 1.0 {
        return Err(Error::Impossible("the coordinates of a chromaticity add up to more than 1".into()));
    }
    let g = metric_at(x, y);
    let around = ellipse(x, y, g);
    let distance = steps(g, x2 - x, y2 - y);
    let mut report = Report::default();
    report.quantity("steps", distance, "SDCM");
    report.fact(
        "an eye",
        if distance < 1.0 {
            "takes them for the same"
        } else if distance < 3.0 {
            "hardly tells them apart"
        } else {
            "tells them apart"
        },
    );
    for (name, value, unit) in [
        ("g11", g[0], ""),
        ("g12", g[1], ""),
        ("g22", g[2], ""),
        ("first semi-axis of a step", around[2] * 1e-3, ""),
        ("second semi-axis of a step", around[3] * 1e-3, ""),
        ("direction of the first axis", around[4], "°"),
    ] {
        report.quantity(name, value, unit);
    }
    let mut chart = Chart::new("MacAdam's steps", Axis::linear("x"), Axis::linear("y"));
    chart.is_isometric = true;
    for (n, name) in [(1.0, "1 step"), (3.0, "3 steps"), (5.0, "5 steps"), (7.0, "7 steps")] {
        chart = chart.with(Series::line(name, outline(around, n)));
    }
    let dots = |name, p| Series::line(name, vec![p]).drawn(Marker::Dots);
    report.chart = Some(chart.with(dots("reference", (x, y))).with(dots("compared", (x2, y2))));
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Centre, and for four of the directions that MacAdam measured the slope dy/dx and 10⁵ ds.
    type Measured = (f64, f64, [(f64, f64); 4]);

    /// Readings of his table III.
    const READINGS: [Measured; 25] = [
        (0.258, 0.450, [(-5.18, 388.0), (1.66, 323.0), (-1.02, 237.0), (-6.33, 430.0)]),
        (0.441, 0.198, [(0.58, 270.0), (-0.06, 137.0), (1.02, 241.0), (-0.39, 114.0)]),
        (0.280, 0.385, [(0.12, 138.0), (1.37, 320.0), (5.54, 375.0), (-11.47, 326.0)]),
        (0.212, 0.550, [(-0.32, 266.0), (0.97, 283.0), (-2.3, 491.0), (2.87, 308.0)]),
        (0.475, 0.300, [(-0.16, 152.0), (-2.76, 102.0), (0.64, 276.0), (1.39, 190.0)]),
        (0.150, 0.680, [(-4.88, 918.0), (-2.0, 719.0), (-0.77, 359.0), (0.62, 250.0)]),
        (0.510, 0.236, [(0.53, 234.0), (1.3, 202.0), (-0.91, 120.0), (2.08, 185.0)]),
        (0.380, 0.498, [(-11.9, 264.0), (2.03, 373.0), (-1.09, 132.0), (1.19, 219.0)]),
        (0.160, 0.200, [(0.02, 99.0), (-1.44, 160.0), (2.46, 128.0), (-6.06, 203.0)]),
        (0.390, 0.237, [(0.03, 126.0), (92.3, 123.0), (-0.54, 107.0), (0.42, 197.0)]),
        (0.385, 0.393, [(-26.1, 242.0), (1.74, 361.0), (-0.67, 160.0), (0.85, 247.0)]),
        (0.344, 0.284, [(-1.01, 89.0), (0.61, 142.0), (2.7, 198.0), (-12.85, 163.0)]),
        (0.228, 0.250, [(1.38, 228.0), (2.84, 296.0), (-0.38, 80.0), (0.94, 160.0)]),
        (0.152, 0.365, [(-2.09, 347.0), (-1.29, 324.0), (0.89, 175.0), (-0.23, 232.0)]),
        (0.187, 0.118, [(0.15, 54.0), (6.82, 197.0), (1.02, 92.0), (-3.61, 82.0)]),
        (0.253, 0.125, [(-0.97, 57.0), (0.76, 153.0), (1.22, 227.0), (1.71, 221.0)]),
        (0.160, 0.057, [(1.41, 84.0), (0.44, 47.0), (-0.32, 36.0), (-1.3, 40.0)]),
        (0.365, 0.153, [(1.16, 294.0), (-0.24, 122.0), (0.21, 175.0), (0.66, 336.0)]),
        (0.527, 0.350, [(-4.08, 128.0), (1.25, 201.0), (0.07, 194.0), (0.44, 252.0)]),
        (0.305, 0.323, [(-2.59, 101.0), (1.28, 228.0), (0.27, 95.0), (2.09, 215.0)]),
        (0.596, 0.283, [(0.34, 241.0), (1.2, 152.0), (-0.14, 203.0), (0.03, 236.0)]),
        (0.131, 0.521, [(0.39, 212.0), (3.6, 326.0), (-2.0, 418.0), (-1.12, 389.0)]),
        (0.278, 0.223, [(3.8, 137.0), (1.61, 224.0), (-2.91, 89.0), (-1.89, 68.0)]),
        (0.300, 0.163, [(0.79, 181.0), (0.33, 121.0), (1.48, 283.0), (-2.36, 76.0)]),
        (0.472, 0.399, [(2.22, 290.0), (0.14, 152.0), (5.85, 201.0), (-0.72, 111.0)]),
    ];

    /// M118: one step at each of the 25 centres is the standard deviation that was measured there, in every direction,
    /// as far as an ellipse can follow it (MacAdam 1942, table III).
    #[test]
    fn a_step_is_the_measured_standard_deviation() {
        let (mut sum, mut squares) = (0.0, 0.0);
        for (x, y, readings) in READINGS {
            assert!(ELLIPSES.iter().any(|e| (e[0], e[1]) == (x, y)));
            for (slope, ds) in readings {
                let dx = 1e-5 * ds / f64::hypot(1.0, slope);
                let found = steps(metric_at(x, y), dx, slope * dx);
                assert!((0.75..1.3).contains(&found), "{x} {y} {slope}: {found}");
                sum += found;
                squares += found * found;
            }
        }
        let mean = sum / 100.0;
        let deviation = (squares / 100.0 - mean * mean).sqrt();
        assert!((mean - 1.0).abs() < 0.05 && deviation < 0.11, "{mean} ± {deviation}");
    }

    /// Between the centres: the metrics of fluorescent lamps, 10⁻⁴ g₁₁, g₁₂, g₂₂ (ANSI C78.376, IEC 60081), to a fifth
    /// of the steps in every direction.
    #[test]
    fn lamps_are_sorted_as_the_standard_has_it() {
        for (x, y, [g11, g12, g22]) in [
            (0.294, 0.309, [111.0, -56.5, 54.5]),
            (0.313, 0.337, [86.0, -40.0, 45.0]),
            (0.346, 0.359, [56.0, -25.0, 28.0]),
            (0.380, 0.380, [39.5, -21.5, 26.0]),
            (0.409, 0.394, [38.0, -20.0, 25.0]),
            (0.440, 0.403, [39.0, -19.5, 27.5]),
            (0.463, 0.420, [44.0, -18.6, 27.0]),
        ] {
            for k in 0..12 {
                let (dy, dx) = (f64::from(k) * std::f64::consts::PI / 12.0).sin_cos();
                let ratio = steps(metric_at(x, y), dx, dy) / steps([g11, g12, g22].map(|g| g * 1e4), dx, dy);
                assert!((ratio - 1.0).abs() < 0.2, "{x} {y} {k}: {ratio}");
            }
        }
    }

    /// The ellipse that is drawn is the table's where the reference is one of its centres.
    #[test]
    fn the_ellipse_comes_back_from_its_metric() {
        for e in ELLIPSES {
            let found = ellipse(e[0], e[1], metric_at(e[0], e[1]));
            assert!(e.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-9), "{e:?} {found:?}");
        }
    }
}
