//! The rainbow: rays through drops of water.
//!
//! A ray that meets a drop at the angle `i` and is reflected `k` times inside is deviated by `2(i − r) + k(π − 2r)`,
//! `sin i = n sin r` (Descartes 1637; van de Hulst, *Light Scattering by Small Particles*, §13.2). Where the deviation
//! is stationary, rays crowd: the bow of order `k`. Rays are spread evenly over the drop's disc, lose light by
//! Fresnel's formulae at each meeting with the surface, and are counted by angle; the disc of the sun blurs what they
//! draw.

use super::refractive_index::index;
use crate::laboratory::{
    Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use std::f64::consts::PI;
use steradian_math::{
    golden_section::golden_section,
    spectra::{cie, named},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "rainbow",
    doc: "the primary and secondary rainbow from rays through drops of water",
    source: "van de Hulst, Light Scattering by Small Particles, §13.2",
    parameters: &[
        Parameter::number("sun", 0.533, (0.0, 20.0), "°", "angular diameter of the sun"),
        Parameter::number(
            "field",
            120.0,
            (20.0, 170.0),
            "°",
            "width of the picture, the point opposite to the sun in the middle below",
        ),
        Parameter::number("exposure", 0.0, (-20.0, 20.0), "EV", "of the picture"),
    ],
    run: Run::Alone(run),
};

/// Deviation in radians of a ray at the impact parameter `b` (in radii of the drop) after `k` reflections inside.
fn deviation(b: f64, n: f64, k: u32) -> f64 {
    let (i, r) = (b.asin(), (b / n).asin());
    2.0 * (i - r) + f64::from(k) * (PI - 2.0 * r)
}

/// Share of unpolarised light that takes that way: two transmissions and `k` reflections, for both polarisations.
fn share(b: f64, n: f64, k: u32) -> f64 {
    let (i, r) = (b.asin(), (b / n).asin());
    let (ci, cr) = (i.cos(), r.cos());
    let s = ((ci - n * cr) / (ci + n * cr)).powi(2);
    let p = ((n * ci - cr) / (n * ci + cr)).powi(2);
    [s, p].iter().map(|f| (1.0 - f).powi(2) * f.powi(k as i32)).sum::<f64>() / 2.0
}

/// Angle in degrees from the point opposite to the sun under which the bow of order `k` appears: the stationary
/// deviation, found by golden section.
pub(super) fn bow(n: f64, k: u32) -> f64 {
    let stationary = golden_section(|offset| deviation(offset, n, k), 0.0, 1.0);
    antisolar(deviation(stationary, n, k)).to_degrees()
}

/// Angle from the direction opposite to the sun, in [0, π].
fn antisolar(deviation: f64) -> f64 {
    (PI - deviation.rem_euclid(2.0 * PI)).abs()
}

/// Index of the air around the drops at 15 °C and 589 nm (Ciddor 1996); between 400 and 700 nm it varies by 6e-6.
const AIR: f64 = 1.000_277;

const BINS: usize = 3600;

/// Light per steradian by angle from the point opposite to the sun (bins of 1/20°), of both bows and of light reflected
/// outside, for unit light on the disc of the drop.
fn by_angle(n: f64, sun: f64) -> Vec<f64> {
    let mut light = vec![0.0; BINS];
    const RAYS: u32 = 20_000;
    for ray in 0..RAYS {
        let b = ((f64::from(ray) + 0.5) / f64::from(RAYS)).sqrt();
        for k in 1..=2 {
            let at = antisolar(deviation(b, n, k)) / PI * BINS as f64;
            light[(at as usize).min(BINS - 1)] += share(b, n, k) / f64::from(RAYS);
        }
    }
    let edge = |k: usize| (PI * k as f64 / BINS as f64).cos();
    for (k, l) in light.iter_mut().enumerate() {
        *l /= 2.0 * PI * (edge(k) - edge(k + 1));
    }
    // A disc of uniform radiance, seen edge on to the bow: a semicircle of chords.
    let radius = sun / 2.0 / 180.0 * BINS as f64;
    let reach = radius.ceil() as i64;
    let chord = |d: i64| (radius * radius - (d * d) as f64).max(0.0).sqrt();
    let whole: f64 = (-reach..=reach).map(chord).sum();
    if whole == 0.0 {
        return light;
    }
    (0..BINS as i64)
        .map(|k| {
            let at = |d: i64| {
                light[(k + d).rem_euclid(2 * BINS as i64).min((-(k + d) - 1).rem_euclid(2 * BINS as i64)) as usize]
            };
            (-reach..=reach).map(|d| chord(d) * at(d)).sum::<f64>() / whole
        })
        .collect()
}

fn run(values: &Values) -> Result<Report, Error> {
    let water = index("water", 0.0, 0.0);
    let sun = values.number("sun");
    let mut report = Report::default();
    for (name, nm) in [("red (656 nm)", 656.3), ("violet (405 nm)", 404.7)] {
        let n = water.eval(nm) / AIR;
        report.quantity(format!("primary bow, {name}"), bow(n, 1), "°");
        report.quantity(format!("secondary bow, {name}"), bow(n, 2), "°");
    }
    let angle = |k: usize| 180.0 * (k as f64 + 0.5) / BINS as f64;
    let mut chart = Chart::new(
        "light from drops of water",
        Axis::linear("angle from the point opposite to the sun (°)").over(30.0, 65.0),
        Axis::linear("light per steradian, for unit light on a drop").over(0.0, 0.2),
    );
    let mut sky = vec![DVec3::ZERO; BINS];
    const STEP: u32 = 8;
    for nm in (384..=776).step_by(STEP as usize) {
        let light = by_angle(water.eval(f64::from(nm)) / AIR, sun);
        let weight = f64::from(named::d65().eval(nm as f32)) * f64::from(STEP) / cie::CIE_Y_INTEGRAL;
        let xyz = DVec3::from(cie::matching_linear(f64::from(nm))) * weight;
        for (s, l) in sky.iter_mut().zip(&light) {
            *s += xyz * *l;
        }
        if let Some((_, name, color)) = [
            (648, "red, 648 nm", [200, 40, 30]),
            (544, "green, 544 nm", [40, 140, 50]),
            (456, "blue, 456 nm", [40, 70, 190]),
        ]
        .into_iter()
        .find(|c| c.0 == nm)
        {
            let points = light.iter().enumerate().map(|(k, l)| (angle(k), *l)).filter(|p| (25.0..70.0).contains(&p.0));
            chart = chart.with(Series::line(name, points.collect()).colored(color));
        }
    }
    report.chart = Some(chart);
    let gain = 5.0 * values.number("exposure").exp2();
    let rgb: Vec<[f32; 3]> = sky.iter().map(|s| rgb_from_xyz_in_gamut(*s * gain)).collect();
    const WIDTH: usize = 1024;
    const HEIGHT: usize = 512;
    // The angle grows evenly with the distance from the middle of the lower edge.
    let scale = values.number("field") / WIDTH as f64;
    let picture = Picture::from_fn(WIDTH, HEIGHT, |x, y| {
        let (dx, dy) = (x as f64 + 0.5 - WIDTH as f64 / 2.0, HEIGHT as f64 - y as f64 - 0.5);
        let k = dx.hypot(dy) * scale / 180.0 * BINS as f64;
        rgb[(k as usize).min(BINS - 1)]
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M129: closed forms of Descartes: cos²i = (n² − 1)/(k(k + 2)). Red of the primary bow is at 42.4°, the
    /// secondary's at 50.4°.
    #[test]
    fn bows_are_where_descartes_has_them() {
        for n in [1.331, 1.343, 1.5] {
            for k in [1, 2] {
                let m = f64::from(k);
                let i = ((n * n - 1.0) / (m * (m + 2.0))).sqrt().acos();
                let r = (i.sin() / n).asin();
                let exact = antisolar(2.0 * (i - r) + m * (PI - 2.0 * r)).to_degrees();
                assert!((bow(n, k) - exact).abs() < 1e-6, "{n} {k}: {} {exact}", bow(n, k));
            }
        }
        let report = EXPERIMENT.run(&[], None).unwrap();
        assert!((report.value("primary bow, red (656 nm)") - 42.4).abs() < 0.06);
        assert!((report.value("secondary bow, red (656 nm)") - 50.4).abs() < 0.06);
        assert!(report.value("primary bow, violet (405 nm)") < 40.8);
    }

    /// Rays that enter and leave carry what Fresnel's formulae let through, and all of it is counted.
    #[test]
    fn light_is_counted_once() {
        let n = 1.333;
        let light = by_angle(n, 0.0);
        let edge = |k: usize| (PI * k as f64 / BINS as f64).cos();
        let sum: f64 = light.iter().enumerate().map(|(k, l)| l * 2.0 * PI * (edge(k) - edge(k + 1))).sum();
        let rays = 20_000;
        let exact: f64 = (0..rays)
            .map(|k| ((f64::from(k) + 0.5) / f64::from(rays)).sqrt())
            .map(|b| (share(b, n, 1) + share(b, n, 2)) / f64::from(rays))
            .sum();
        assert!((sum / exact - 1.0).abs() < 1e-9);
        let blurred: f64 =
            by_angle(n, 0.5).iter().enumerate().map(|(k, l)| l * 2.0 * PI * (edge(k) - edge(k + 1))).sum();
        assert!((blurred / exact - 1.0).abs() < 0.01, "{blurred} {exact}");
    }
}
