//! Polar slices through the lobes of a material, as a picture in SVG.

use crate::{
    Specimen, direction,
    svg::{self, Entry, FONT, LINE, MARGIN, WIDTH},
};
use std::fmt::Write;
use steradian_bsdf::TransportMode;
use steradian_math::{Vec2, sobol::shuffled_scrambled_sobol_4d};

/// Angles of incidence that are drawn, degrees, and their colours.
const SLICES: [(f64, &str); 4] = [(0.0, "#4c78a8"), (30.0, "#54a24b"), (60.0, "#f58518"), (80.0, "#e45756")];
const RADIUS: f64 = 236.0;
/// Height of the middle.
const CENTRE: f64 = 324.0;
/// Decades from the middle to the outer circle of a logarithmic radius.
const DECADES: f64 = 4.0;
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

/// Radial scale of values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Radius {
    /// In proportion to it.
    #[default]
    Linear,
    /// By its logarithm, over four decades below the largest: what is weak beside a narrow lobe can be seen.
    Log,
}

/// Values and the radii that they are drawn at.
struct Scale {
    radius: Radius,
    /// Value at the outer circle.
    outer: f64,
}

impl Scale {
    /// Scale of values up to a largest one; the outer circle is at a round one.
    fn new(radius: Radius, largest: f64) -> Self {
        let unit = 10f64.powf(largest.max(f64::MIN_POSITIVE).log10().floor());
        let round = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].map(|m| m * unit);
        let linear = round.into_iter().find(|v| *v >= largest * (1.0 - 1e-9)).unwrap_or(10.0 * unit);
        let outer = match radius {
            _ if largest <= 0.0 => 1.0,
            Radius::Linear => linear,
            Radius::Log => 10f64.powf((largest.log10() - 1e-9).ceil()),
        };
        Self { radius, outer }
    }

    fn at(&self, value: f64) -> f64 {
        let part = value / self.outer;
        RADIUS
            * match self.radius {
                Radius::Linear => part,
                Radius::Log => (1.0 + part.max(1e-30).log10() / DECADES).max(0.0),
            }
    }

    /// Values of the circles.
    fn circles(&self) -> [f64; 4] {
        match self.radius {
            Radius::Linear => [0.25, 0.5, 0.75, 1.0],
            Radius::Log => [1e-3, 1e-2, 1e-1, 1.0],
        }
        .map(|part| part * self.outer)
    }
}

/// A point at an angle from the normal, so far from the middle.
fn point(theta: f64, r: f64) -> (f64, f64) {
    let (sin, cos) = theta.to_radians().sin_cos();
    (0.5 * WIDTH + r * sin, CENTRE - r * cos)
}

/// The picture: slices for light at 0°, 30°, 60° and 80°, each against a common scale; arrows where light came from,
/// dashed lines for specular lobes as long as their power. The lower half is drawn where light gets there.
pub fn svg(specimen: &Specimen<'_>, title: &str, radius: Radius) -> String {
    let slices: Vec<_> = SLICES.iter().map(|s| slice(specimen, s.0)).collect();
    let largest = slices.iter().flat_map(|s| &s.values).map(|v| v.1).fold(0.0, f64::max);
    let below = |lobe: &(f64, f64)| lobe.0.abs() > 90.5 && lobe.1 > 1e-6 * largest;
    let is_whole = slices.iter().any(|s| s.values.iter().any(below) || s.specular.iter().any(|l| l.0.abs() > 90.0));
    let scale = Scale::new(radius, largest);
    let mut out = String::new();
    let more = svg::paragraph(&mut out, title, 26.0, "font-weight=\"bold\"") - LINE;
    let _ = writeln!(out, "<g transform=\"translate(0 {:.0})\">", more.max(0.0));
    grid(&mut out, is_whole);
    for (slice, (theta, colour)) in slices.iter().zip(SLICES) {
        lobe(&mut out, slice, colour, &scale);
        arrow(&mut out, theta, colour);
    }
    if largest > 0.0 {
        values(&mut out, &scale);
    }
    let mut bottom = CENTRE + if is_whole { RADIUS + 30.0 } else { 34.0 };
    let has_lines = slices.iter().any(|s| !s.specular.is_empty());
    let names = SLICES.map(|s| format!("light at {}°", s.0));
    let mut entries: Vec<_> = names
        .iter()
        .zip(SLICES)
        .map(|(text, s)| Entry { stroke: format!("stroke=\"{}\"", s.1), is_dot: false, text })
        .collect();
    if has_lines {
        let stroke = "stroke=\"#555\" stroke-dasharray=\"6 3\"".to_owned();
        entries.push(Entry { stroke, is_dot: false, text: "mirror-like: at the outer circle all the light" });
    }
    bottom += svg::legend(&mut out, &entries, bottom);
    let caption = match radius {
        _ if largest <= 0.0 => "The material scatters into single directions only.",
        Radius::Linear => "Distance from the middle: f in sr⁻¹, in the plane of incidence.",
        Radius::Log => "Distance from the middle: f in sr⁻¹ on a logarithmic scale, in the plane of incidence.",
    };
    bottom += svg::paragraph(&mut out, caption, bottom + FONT, "fill=\"#444\"");
    format!("{}{out}</g>\n</svg>\n", svg::open(bottom + more.max(0.0) + 14.0))
}

/// Circles, directions and the surface.
fn grid(out: &mut String, is_whole: bool) {
    let mut rings = String::new();
    for r in [0.25, 0.5, 0.75, 1.0].map(|k| k * RADIUS) {
        let (x0, x1) = (0.5 * WIDTH - r, 0.5 * WIDTH + r);
        let _ = write!(rings, "M{x0:.1} {CENTRE}A{r} {r} 0 0 1 {x1:.1} {CENTRE}");
        if is_whole {
            let _ = write!(rings, "A{r} {r} 0 0 1 {x0:.1} {CENTRE}");
        }
    }
    for theta in (-60..=60).step_by(30).map(f64::from) {
        let ((x0, y0), (x1, y1)) = (point(theta, RADIUS), point(theta, if is_whole { -RADIUS } else { 0.0 }));
        let _ = write!(rings, "M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}");
    }
    let _ = writeln!(out, "<path d=\"{rings}\" fill=\"none\" stroke=\"#ccc\"/>");
    let (from, to) = (MARGIN, WIDTH - MARGIN);
    let _ = writeln!(out, "<path d=\"M{from} {CENTRE}H{to}\" stroke=\"black\"/>");
    for theta in [30.0, 60.0] {
        let (x, y) = point(theta, RADIUS + 10.0);
        let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{:.1}\" fill=\"#666\">{theta}°</text>", y + 4.0);
    }
}

/// One slice: its curve, and its specular lobes.
fn lobe(out: &mut String, slice: &Slice, colour: &str, scale: &Scale) {
    let mut path = String::new();
    for (i, (theta, f)) in slice.values.iter().enumerate() {
        let (x, y) = point(*theta, scale.at(*f));
        let _ = write!(path, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
    }
    let _ = writeln!(
        out,
        "<path d=\"{path}Z\" fill=\"{colour}\" fill-opacity=\"0.12\" stroke=\"{colour}\" stroke-width=\"2\"/>"
    );
    for (to, power) in &slice.specular {
        let (x, y) = point(*to, power.clamp(0.0, 1.0) * RADIUS);
        let _ = writeln!(
            out,
            "<path d=\"M{:.1} {CENTRE}L{x:.1} {y:.1}\" stroke=\"{colour}\" stroke-width=\"2.5\" stroke-dasharray=\"6 3\"/>",
            0.5 * WIDTH
        );
    }
}

/// Mark of the incident direction: an arrow outside the circles, and the angle.
fn arrow(out: &mut String, theta: f64, colour: &str) {
    let at = |along: f64, aside: f64| {
        let ((x, y), (sin, cos)) = (point(-theta, RADIUS + along), theta.to_radians().sin_cos());
        (x + aside * cos, y - aside * sin)
    };
    let [(x0, y0), (x1, y1), (x2, y2), (x3, y3)] = [at(26.0, 0.0), at(10.0, 0.0), at(11.0, 5.0), at(11.0, -5.0)];
    let (x4, y4) = at(2.0, 0.0);
    let (x, y) = at(if theta == 0.0 { 32.0 } else { 30.0 }, 0.0);
    let anchor = if theta == 0.0 { "middle" } else { "end" };
    let _ = writeln!(
        out,
        "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"{colour}\" stroke-width=\"3\"/>\
         <path d=\"M{x2:.1} {y2:.1}L{x4:.1} {y4:.1}L{x3:.1} {y3:.1}Z\" fill=\"{colour}\"/>\
         <text x=\"{x:.1}\" y=\"{:.1}\" fill=\"{colour}\" text-anchor=\"{anchor}\">{theta}°</text>",
        y + if theta == 0.0 { 0.0 } else { 4.0 }
    );
}

/// The values of the circles, below the surface to the right of where each meets it.
fn values(out: &mut String, scale: &Scale) {
    let circles = scale.circles();
    let is_wide = circles.iter().any(|v| svg::width(&svg::number(*v)) > 0.25 * RADIUS - 6.0);
    for v in circles.into_iter().skip(usize::from(is_wide)).step_by(1 + usize::from(is_wide)) {
        let (x, y) = point(90.0, scale.at(v));
        let _ = writeln!(out, "<path d=\"M{x:.1} {y:.1}v5\" stroke=\"black\"/>");
        let text = svg::number(v);
        let half = 0.5 * svg::width(&text);
        let x = x.min(WIDTH - 2.0 - half);
        let _ = writeln!(
            out,
            "<text x=\"{x:.1}\" y=\"{0:.1}\" text-anchor=\"middle\" stroke=\"white\" stroke-width=\"4\">{text}</text>\
             <text x=\"{x:.1}\" y=\"{0:.1}\" text-anchor=\"middle\">{text}</text>",
            y + 20.0
        );
    }
}
