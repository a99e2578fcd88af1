//! Polar slices through the lobes of a material, as a picture in SVG.

use crate::{Specimen, direction};
use std::fmt::Write;
use steradian_bsdf::TransportMode;
use steradian_math::{Vec2, sobol::shuffled_scrambled_sobol_4d};

/// Angles of incidence that are drawn, degrees, and their colours.
const SLICES: [(f64, &str); 4] = [(0.0, "#4c78a8"), (30.0, "#54a24b"), (60.0, "#f58518"), (80.0, "#e45756")];
const RADIUS: f64 = 230.0;
const CENTRE: f64 = 260.0;
/// Draws that look for specular lobes.
const DRAWS: u32 = 64;

/// One slice in the plane of incidence.
#[derive(Clone, Debug)]
pub struct Slice {
    /// Angle of incidence, degrees.
    pub theta_i: f64,
    /// Angle from the normal in degrees, −180 to 180, the mirror direction positive; and the luminance of `f` (sr⁻¹).
    pub values: Vec<(f64, f64)>,
    /// Directions of specular lobes (the same angle), and the power in them.
    pub specular: Vec<(f64, f64)>,
}

/// Measures a slice, every half degree.
pub fn slice(specimen: &Specimen<'_>, theta_i: f64) -> Slice {
    let wo = direction(theta_i, 180.0);
    let value = |theta: f64| {
        let wi = direction(theta, 0.0);
        let e = specimen.eval(wo, wi, TransportMode::Importance);
        f64::from(specimen.luminance(e.value)) / f64::from(wi.z.abs()).max(1e-4)
    };
    let values = (-360..=360).map(|i| f64::from(i) / 2.0).map(|theta| (theta, value(theta))).collect();
    let mut specular: Vec<(f64, f64)> = Vec::new();
    for i in 0..DRAWS {
        let [choice, u, x, y] = shuffled_scrambled_sobol_4d(i, 3);
        let Some(s) = specimen.sample(wo, choice, u, Vec2::new(x, y), TransportMode::Importance) else { continue };
        let power = f64::from(specimen.luminance(s.weight)) / f64::from(DRAWS);
        if s.lobe.is_specular() {
            let theta = f64::from(s.wi.x).atan2(f64::from(s.wi.z)).to_degrees();
            match specular.iter_mut().find(|l| (l.0 - theta).abs() < 1e-3) {
                Some(seen) => seen.1 += power,
                None => specular.push((theta, power)),
            }
        }
    }
    Slice { theta_i, values, specular }
}

/// The picture: slices for light at 0°, 30°, 60° and 80°, each against a common scale; arrows where light came from,
/// dashed lines for specular lobes as long as their power.
pub fn svg(specimen: &Specimen<'_>, title: &str) -> String {
    let slices: Vec<_> = SLICES.iter().map(|s| slice(specimen, s.0)).collect();
    let largest = slices.iter().flat_map(|s| &s.values).map(|v| v.1).fold(0.0, f64::max);
    let scale = if largest > 0.0 { RADIUS / largest } else { 0.0 };
    let point = |theta: f64, r: f64| {
        let (sin, cos) = theta.to_radians().sin_cos();
        (CENTRE + r * sin, CENTRE - r * cos)
    };
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 520 560\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"520\" height=\"560\" fill=\"white\"/>\n<g fill=\"none\" stroke=\"#ccc\">\n",
    );
    for r in [0.25, 0.5, 0.75, 1.0] {
        let _ = writeln!(out, "<circle cx=\"{CENTRE}\" cy=\"{CENTRE}\" r=\"{}\"/>", r * RADIUS);
    }
    for theta in (-90..90).step_by(30) {
        let ((x0, y0), (x1, y1)) = (point(f64::from(theta), RADIUS), point(f64::from(theta), -RADIUS));
        let _ = writeln!(out, "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\"/>");
    }
    let _ = writeln!(out, "</g>\n<path d=\"M20 {CENTRE}H500\" stroke=\"black\"/>");
    for (slice, (theta, colour)) in slices.iter().zip(SLICES) {
        let mut path = String::new();
        for (i, (theta, f)) in slice.values.iter().enumerate() {
            let (x, y) = point(*theta, f * scale);
            let _ = write!(path, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
        }
        let _ = writeln!(
            out,
            "<path d=\"{path}Z\" fill=\"{colour}\" fill-opacity=\"0.12\" stroke=\"{colour}\" stroke-width=\"1.5\"/>"
        );
        for (to, power) in &slice.specular {
            let (x, y) = point(*to, power.clamp(0.0, 1.0) * RADIUS);
            let _ = writeln!(
                out,
                "<path d=\"M{CENTRE} {CENTRE}L{x:.1} {y:.1}\" stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"6 3\"/>"
            );
        }
        let (x, y) = point(-theta, RADIUS);
        let (tx, ty) = point(-theta, RADIUS - 22.0);
        let _ = writeln!(out, "<path d=\"M{x:.1} {y:.1}L{tx:.1} {ty:.1}\" stroke=\"{colour}\" stroke-width=\"4\"/>");
        let (x, y) = point(-theta, RADIUS + 14.0);
        let _ =
            writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" fill=\"{colour}\" text-anchor=\"middle\">{theta}°</text>");
    }
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(
        out,
        "<text x=\"20\" y=\"522\">{title}</text>\n<text x=\"20\" y=\"544\">outer circle: {largest:.3e} per steradian; dashed: specular lobes, outer circle is all the light</text>\n</svg>"
    );
    out
}
