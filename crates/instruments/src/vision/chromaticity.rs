//! Chromaticity diagrams: CIE 1931 `(x, y)` and CIE 1976 `u' = 4x/(−2x + 12y + 3)`, `v' = 9y/(−2x + 12y + 3)` (CIE
//! 15:2004, §8.1), with the spectral locus, the black bodies, gamuts of RGB spaces, and MacAdam's ellipses.

use super::macadam::{ELLIPSES, outline};
use crate::laboratory::{
    Axis, Chart, Error, Experiment, Marker, Parameter, Picture, Report, Run, Series, Values, rgb_from_xyz_in_gamut,
};
use glam::DVec3;
use steradian_math::{
    color::{
        RgbSpace,
        xyz::{xyy_from_xyz, xyz_from_xyy},
    },
    minimum::golden_section,
    spectra::{blackbody::planck_wavelength, cie},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "chromaticity",
    doc: "the chromaticity diagram with the spectral locus, black bodies, gamuts and MacAdam's ellipses",
    source: "CIE 15:2004, §7.3 and §8.1; MacAdam 1942",
    parameters: &[
        Parameter::choice("diagram", &["1931", "1976"], "coordinates: x, y or u', v'"),
        Parameter::choice("ellipses", &["yes", "no"], "whether MacAdam's ellipses are drawn"),
        Parameter::number("enlarged", 10.0, (1.0, 30.0), "", "how much the ellipses are enlarged"),
        Parameter::number("x", 0.3127, (0.0, 1.0), "", "chromaticity to be described: x"),
        Parameter::number("y", 0.3290, (1e-6, 1.0), "", "chromaticity to be described: y"),
    ],
    run: Run::Alone(run),
};

/// `(u', v')` of `(x, y)`.
fn uv_from_xy((x, y): (f64, f64)) -> (f64, f64) {
    let d = -2.0 * x + 12.0 * y + 3.0;
    (4.0 * x / d, 9.0 * y / d)
}

/// `(x, y)` of `(u', v')`.
fn xy_from_uv((u, v): (f64, f64)) -> (f64, f64) {
    let d = 6.0 * u - 16.0 * v + 12.0;
    (9.0 * u / d, 4.0 * v / d)
}

fn xy(xyz: DVec3) -> (f64, f64) {
    let [x, y, _] = xyy_from_xyz(xyz);
    (x, y)
}

fn spectral(nm: f64) -> (f64, f64) {
    xy(DVec3::from(cie::matching_linear(nm)))
}

fn black_body(kelvin: f64) -> (f64, f64) {
    xy((0..=470)
        .map(|k| 360.0 + f64::from(k))
        .map(|nm| DVec3::from(cie::matching_linear(nm)) * planck_wavelength(nm * 1e-9, kelvin))
        .sum())
}

/// The outline of all chromaticities: the spectrum from 390 to 700 nm, closed by the line of purples. Beyond, it turns
/// back by the noise of the tables.
fn locus() -> Vec<(f64, f64)> {
    (390..=700).map(|nm| spectral(f64::from(nm))).chain([spectral(390.0)]).collect()
}

/// Whether a point is inside a closed outline (even–odd rule).
fn is_inside(outline: &[(f64, f64)], (x, y): (f64, f64)) -> bool {
    outline
        .windows(2)
        .filter(|w| (w[0].1 <= y) != (w[1].1 <= y))
        .filter(|w| x < w[0].0 + (y - w[0].1) / (w[1].1 - w[0].1) * (w[1].0 - w[0].0))
        .count()
        % 2
        == 1
}

/// The temperature whose black body is nearest in the 1960 diagram, `(u', 2v'/3)`: the correlated colour temperature
/// (CIE 15:2004, §9.5), with the distance there. `None` where the nearest is hotter than 50 000 K or cooler than 1000
/// K: what is beyond the ends of the locus, with the ends of the search for answers.
fn correlated_temperature(at: (f64, f64)) -> Option<(f64, f64)> {
    let uv60 = |p: (f64, f64)| {
        let (u, v) = uv_from_xy(p);
        (u, v * 2.0 / 3.0)
    };
    let to = uv60(at);
    let distance = |mired: f64| {
        let b = uv60(black_body(1e6 / mired));
        (b.0 - to.0).hypot(b.1 - to.1)
    };
    let coarse =
        (4..=200).map(|k| f64::from(k) * 5.0).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(150.0);
    let mired = golden_section(distance, coarse - 5.0, coarse + 5.0);
    (20.0..=1000.0).contains(&mired).then(|| (1e6 / mired, distance(mired)))
}

/// Where the line from white D65 through a chromaticity meets the spectrum: the dominant wavelength, or `None` at
/// purples.
fn dominant_wavelength(at: (f64, f64)) -> Option<f64> {
    let white = (0.3127, 0.3290);
    let d = (at.0 - white.0, at.1 - white.1);
    if d.0.hypot(d.1) < 1e-6 {
        return None;
    }
    let side = |nm: f64| {
        let p = spectral(nm);
        ((p.0 - white.0) * d.1 - (p.1 - white.1) * d.0, (p.0 - white.0) * d.0 + (p.1 - white.1) * d.1)
    };
    let nm = (390..700).map(f64::from).find(|nm| {
        let (a, b) = (side(*nm), side(nm + 1.0));
        a.0 * b.0 <= 0.0 && a.1 > 0.0
    })?;
    let (a, b) = (side(nm).0, side(nm + 1.0).0);
    Some(nm + a / (a - b))
}

fn run(values: &Values) -> Result<Report, Error> {
    let is_1976 = values.choice("diagram") == "1976";
    let at = (values.number("x"), values.number("y"));
    if at.0 + at.1 > 1.0 {
        return Err(Error::Impossible("'x' and 'y' add up to more than 1".into()));
    }
    let place = |p: (f64, f64)| if is_1976 { uv_from_xy(p) } else { p };
    let outline_xy = locus();
    let mut report = Report::default();
    let (u, v) = uv_from_xy(at);
    report.quantity("u'", u, "");
    report.quantity("v'", v, "");
    let is_real = is_inside(&outline_xy, at);
    match correlated_temperature(at).filter(|_| is_real) {
        Some((kelvin, distance)) if distance < 0.05 => {
            report.quantity("correlated colour temperature", kelvin, "K");
            report.quantity("distance from the black bodies (u, v 1960)", distance, "");
        }
        Some(_) => report.fact("correlated colour temperature", "none: farther than 0.05 from the black bodies"),
        None if !is_real => report.fact("correlated colour temperature", "none: outside the locus of spectral colours"),
        None => {
            report.fact("correlated colour temperature", "none: outside the locus of black bodies, 1000 to 50 000 K")
        }
    }
    if let Some(nm) = dominant_wavelength(at) {
        report.quantity("dominant wavelength (white D65)", nm, "nm");
    }
    report.quantity("is a colour that exists", f64::from(u8::from(is_real)), "");
    let outline_area = area(&outline_xy.iter().map(|p| uv_from_xy(*p)).collect::<Vec<_>>());
    let (label_x, label_y) = if is_1976 { ("u'", "v'") } else { ("x", "y") };
    let mut chart = Chart::new(
        format!("CIE {} chromaticity", values.choice("diagram")),
        Axis::linear(label_x).over(0.0, if is_1976 { 0.65 } else { 0.8 }),
        Axis::linear(label_y).over(0.0, if is_1976 { 0.62 } else { 0.9 }),
    );
    chart.is_isometric = true;
    chart = chart.with(
        Series::line("spectral locus", outline_xy.iter().map(|p| place(*p)).collect()).colored([0x20, 0x20, 0x20]),
    );
    for (space, color) in RgbSpace::all().into_iter().zip([
        [0xd0, 0x5a, 0x1e],
        [0x2f, 0x86, 0x3c],
        [0x1f, 0x5f, 0xa8],
        [0x88, 0x88, 0x88],
    ]) {
        let [r, g, b] = space.primaries().map(|p| (p[0], p[1]));
        let triangle: Vec<_> = [r, g, b, r].into_iter().map(place).collect();
        let share = area(&[r, g, b, r].map(uv_from_xy)) / outline_area;
        report.quantity(format!("gamut of {}, share of the 1976 diagram", space.name()), share, "");
        chart = chart.with(Series::line(space.name(), triangle).drawn(Marker::Dashed).colored(color));
    }
    let planckian =
        (0..=100).map(|k| 1000.0 * 30f64.powf(f64::from(k) / 100.0)).map(|t| place(black_body(t))).collect();
    chart = chart.with(Series::line("black bodies, 1000 to 30 000 K", planckian).colored([0xa8, 0x2c, 0x62]));
    chart = chart.with(Series::line("the chromaticity", vec![place(at)]).drawn(Marker::Dots).colored([0, 0, 0]));
    if values.choice("ellipses") == "yes" {
        for (k, e) in ELLIPSES.into_iter().enumerate() {
            let name = if k == 0 { "MacAdam's ellipses" } else { "" };
            let points = outline(e, values.number("enlarged")).into_iter().map(place).collect();
            chart = chart.with(Series::line(name, points).colored([0x6b, 0x4f, 0xa0]));
        }
    }
    report.chart = Some(chart);
    const EDGE: usize = 512;
    let picture = Picture::from_fn(EDGE, EDGE, |x, y| {
        let p = (0.85 * (x as f64 + 0.5) / EDGE as f64, 0.9 - 0.9 * (y as f64 + 0.5) / EDGE as f64);
        let p = if is_1976 { xy_from_uv((p.0 * 0.75, p.1 * 0.7)) } else { p };
        if !is_inside(&outline_xy, p) {
            return [1.0; 3];
        }
        let rgb = rgb_from_xyz_in_gamut(xyz_from_xyy(p.0, p.1, 1.0));
        let most = rgb.iter().copied().fold(1e-6, f32::max);
        rgb.map(|c| c / most)
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

/// Area of a closed outline.
fn area(outline: &[(f64, f64)]) -> f64 {
    0.5 * outline.windows(2).map(|w| w[0].0 * w[1].1 - w[1].0 * w[0].1).sum::<f64>().abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M118, M135: D65 has 6504 K, u' = 0.1978, v' = 0.4683 (CIE 15); sRGB takes 33 % of the 1976 diagram; red of 620
    /// nm is told as such.
    #[test]
    fn whites_gamuts_and_wavelengths() {
        let r = EXPERIMENT.run(&[], None).unwrap();
        assert!((r.value("correlated colour temperature") - 6504.0).abs() < 10.0);
        assert!((r.value("u'") - 0.1978).abs() < 1e-4 && (r.value("v'") - 0.4683).abs() < 1e-4);
        let srgb = r.value("gamut of srgb, share of the 1976 diagram");
        assert!((srgb - 0.333).abs() < 0.01, "{srgb}");
        for nm in [470.0, 520.0, 580.0, 620.0] {
            let p = spectral(nm);
            let inside = (0.3127 + 0.7 * (p.0 - 0.3127), 0.3290 + 0.7 * (p.1 - 0.3290));
            assert!((dominant_wavelength(inside).unwrap() - nm).abs() < 0.02, "{nm}");
            assert!(
                is_inside(&locus(), inside)
                    && !is_inside(&locus(), (1.2 * p.0 - 0.2 * 0.3127, 1.2 * p.1 - 0.2 * 0.3290))
            );
        }
        assert!(dominant_wavelength((0.35, 0.15)).is_none());
        let back = xy_from_uv(uv_from_xy((0.2, 0.5)));
        assert!((back.0 - 0.2).abs() < 1e-12 && (back.1 - 0.5).abs() < 1e-12);
        // Illuminant A is a black body of 2856 K.
        let (kelvin, distance) = correlated_temperature((0.44758, 0.40745)).unwrap();
        assert!((kelvin - 2856.0).abs() < 3.0 && distance < 1e-4, "{kelvin}");
    }

    /// Where there is no colour temperature, that is said and no end of the search is printed: a blue beyond infinitely
    /// hot bodies (x = 0.2399, y = 0.2341), a red beyond 1000 K, a green far off, what is no colour.
    #[test]
    fn what_has_no_temperature_is_told() {
        for ((x, y), why) in [
            ((0.2399, 0.2341), "outside the locus of black bodies"),
            ((0.69, 0.305), "outside the locus of black bodies"),
            ((0.25, 0.65), "farther than"),
            ((0.1, 0.1), "outside the locus of spectral colours"),
        ] {
            let given = [("x".to_owned(), x.to_string()), ("y".to_owned(), y.to_string())];
            let r = EXPERIMENT.run(&given, None).unwrap();
            assert!(r.facts[0].text.contains(why), "{x} {y}: {:?}", r.facts);
            assert!(r.value("correlated colour temperature").is_nan());
        }
    }
}
