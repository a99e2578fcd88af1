//! Chromaticity diagrams: CIE 1931 `(x, y)` and CIE 1976 `u' = 4x/(−2x + 12y + 3)`, `v' = 9y/(−2x + 12y + 3)` (CIE
//! 15:2004, §8.1), with the spectral locus, the black bodies, gamuts of RGB spaces, and MacAdam's ellipses.

use super::{
    diagram::Diagram,
    macadam::{ELLIPSES, outline},
};
use crate::laboratory::{
    Axis, Backdrop, Chart, Error, Experiment, Label, Marker, Parameter, Report, Run, Series, Values,
};
use glam::DVec3;
use steradian_math::{
    color::{RgbSpace, xyz::xyy_from_xyz},
    golden_section::golden_section,
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

/// Width of the picture, pixels.
const PICTURE: usize = 640;

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

/// Tests containment of a point in a closed outline (even–odd rule).
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

/// Intersection of the line from white D65 through a chromaticity with the spectral locus: the dominant wavelength, or
/// `None` at purples.
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
    let range = if is_1976 { [0.65, 0.62] } else { [0.8, 0.9] };
    let mut chart = Chart::new(
        format!("CIE {} chromaticity", values.choice("diagram")),
        Axis::linear(label_x).over(0.0, range[0]),
        Axis::linear(label_y).over(0.0, range[1]),
    );
    chart.is_isometric = true;
    let diagram = Diagram {
        outline: outline_xy.iter().map(|p| place(*p)).collect(),
        range,
        xy_at: if is_1976 { xy_from_uv } else { |p| p },
    };
    chart.backdrop = Some(Backdrop { png: diagram.png()? });
    chart = chart.with(Series::line("spectral locus", diagram.outline.clone()).colored([0xff; 3]));
    for nm in [460, 480, 490, 500, 520, 540, 560, 580, 600, 620, 700] {
        let at = place(spectral(f64::from(nm)));
        let is_free = |l: &Label| {
            let apart = [(l.at.0 - at.0).abs() / range[0], (l.at.1 - at.1).abs() / range[1]];
            apart[0] > 0.1 || apart[1] > 0.04
        };
        if chart.labels.iter().all(is_free) {
            chart.labels.push(Label { at, text: format!("{nm}") });
        }
    }
    const LINES: [[u8; 3]; 4] = [[0xff; 3], [0x20; 3], [0x50; 3], [0xd0; 3]];
    for (k, (space, color)) in RgbSpace::all().into_iter().zip(LINES).enumerate() {
        let [r, g, b] = space.primaries().map(|p| (p[0], p[1]));
        let triangle: Vec<_> = [r, g, b, r].into_iter().map(place).collect();
        let share = area(&[r, g, b, r].map(uv_from_xy)) / outline_area;
        report.quantity(format!("gamut of {}, share of the 1976 diagram", space.name()), share, "");
        // Beside the side from green to blue, each lower than the last; none of a space whose green no eye sees.
        if is_inside(&outline_xy, (0.99 * g.0 + 0.003, 0.99 * g.1 + 0.003)) {
            let down = 0.12 + 0.2 * k as f64;
            let at = place((g.0 + down * (b.0 - g.0), g.1 + down * (b.1 - g.1)));
            chart.labels.push(Label { at, text: written(space.name()).into() });
        }
        let marker = if space.name() == "srgb" { Marker::Line } else { Marker::Dashed };
        chart = chart.with(Series::line(written(space.name()), triangle).drawn(marker).colored(color));
    }
    let planckian =
        (0..=100).map(|k| 1000.0 * 30f64.powf(f64::from(k) / 100.0)).map(|t| place(black_body(t))).collect();
    chart = chart.with(Series::line("black bodies, 1000 to 30 000 K", planckian).colored([0x90, 0x20, 0x50]));
    chart = chart.with(Series::line("the chromaticity", vec![place(at)]).drawn(Marker::Dots).colored([0; 3]));
    if values.choice("ellipses") == "yes" {
        for (k, e) in ELLIPSES.into_iter().enumerate() {
            let name = if k == 0 { "MacAdam's ellipses" } else { "" };
            let points = outline(e, values.number("enlarged")).into_iter().map(place).collect();
            chart = chart.with(Series::line(name, points).colored([0x50, 0x38, 0x80]));
        }
    }
    report.chart = Some(chart);
    report.picture = Some(diagram.picture(PICTURE, [1.0; 3]).to_image()?);
    Ok(report)
}

/// A colour space's name as its standard writes it.
fn written(space: &'static str) -> &'static str {
    match space {
        "srgb" => "sRGB",
        "dci-p3" => "DCI-P3",
        "rec2020" => "Rec. 2020",
        "aces2065-1" => "ACES2065-1",
        other => other,
    }
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

    /// Without a colour temperature, that is said and no end of the search is printed: a blue beyond infinitely hot
    /// bodies (x = 0.2399, y = 0.2341), a red beyond 1000 K, a green far off, a point that is no colour.
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
