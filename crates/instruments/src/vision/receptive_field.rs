//! Receptive fields of the retina: a centre against its surround, as a difference of Gaussians (Rodieck 1965), and the
//! discrete Laplacian kernels.
//!
//! Kernels sum to zero, so even areas give no response; edges give the over- and undershoot that is seen as Mach bands.
//! Beyond its edges a picture goes on as its last pixels.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values};
use steradian_math::color;

pub const EXPERIMENT: Experiment = Experiment {
    name: "receptive-field",
    doc: "the response of on- or off-centre cells of the retina, or of a Laplacian kernel, to a picture",
    source: "Rodieck 1965; Marr, Hildreth 1980",
    parameters: &[
        Parameter::choice(
            "kind",
            &["on", "off", "laplacian-4", "laplacian-8"],
            "cells, or a 3 × 3 kernel of 4 or 8 neighbours",
        ),
        Parameter::number("center", 1.5, (0.3, 200.0), "px", "standard deviation of the centre"),
        Parameter::number("surround", 4.0, (0.3, 400.0), "px", "standard deviation of the surround"),
        Parameter::number("gain", 2.0, (0.0, 1e3), "", "of the drawn response, around mid-grey"),
    ],
    run: Run::OnPicture(run),
};

/// Luminances by rows.
pub(super) struct Plane {
    pub width: usize,
    pub height: usize,
    pub values: Vec<f64>,
}

impl Plane {
    pub fn of(picture: &Picture) -> Self {
        let values = picture.rgb.iter().map(|c| f64::from(color::luminance((*c).into()))).collect();
        Self { width: picture.width, height: picture.height, values }
    }

    fn at(&self, x: i64, y: i64) -> f64 {
        let (x, y) = (x.clamp(0, self.width as i64 - 1) as usize, y.clamp(0, self.height as i64 - 1) as usize);
        self.values[y * self.width + x]
    }

    /// Filtered by a kernel of weights that is separable and symmetric: `half[0]` is its middle.
    fn separable(&self, half: &[f64]) -> Self {
        let along = |plane: &Self, (dx, dy): (i64, i64)| -> Self {
            let value = |i: usize| {
                let (x, y) = ((i % self.width) as i64, (i / self.width) as i64);
                let sides: f64 = half[1..]
                    .iter()
                    .zip(1..)
                    .map(|(w, k)| w * (plane.at(x + k * dx, y + k * dy) + plane.at(x - k * dx, y - k * dy)))
                    .sum();
                half[0] * plane.at(x, y) + sides
            };
            Self { values: (0..self.values.len()).map(value).collect(), ..*plane }
        };
        along(&along(self, (1, 0)), (0, 1))
    }

    /// Blurred by a Gaussian whose weights sum to one.
    pub fn gaussian(&self, sigma: f64) -> Self {
        let reach = (4.0 * sigma).ceil() as usize;
        let half: Vec<f64> = (0..=reach).map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp()).collect();
        let sum = half[0] + 2.0 * half[1..].iter().sum::<f64>();
        self.separable(&half.iter().map(|w| w / sum).collect::<Vec<_>>())
    }

    /// The response of a kind of receptive field.
    pub fn response(&self, kind: &str, center: f64, surround: f64) -> Vec<f64> {
        match kind {
            "laplacian-4" | "laplacian-8" => (0..self.values.len())
                .map(|i| {
                    let (x, y) = ((i % self.width) as i64, (i / self.width) as i64);
                    let near = self.at(x - 1, y) + self.at(x + 1, y) + self.at(x, y - 1) + self.at(x, y + 1);
                    if kind == "laplacian-4" {
                        return near - 4.0 * self.at(x, y);
                    }
                    let far =
                        self.at(x - 1, y - 1) + self.at(x + 1, y - 1) + self.at(x - 1, y + 1) + self.at(x + 1, y + 1);
                    near + far - 8.0 * self.at(x, y)
                })
                .collect(),
            _ => {
                let (c, s) = (self.gaussian(center), self.gaussian(surround));
                let sign = if kind == "off" { -1.0 } else { 1.0 };
                c.values.iter().zip(&s.values).map(|(c, s)| sign * (c - s)).collect()
            }
        }
    }
}

fn run(values: &Values, picture: &Picture) -> Result<Report, Error> {
    let (center, surround) = (values.number("center"), values.number("surround"));
    let kind = values.choice("kind");
    if center >= surround && !kind.starts_with("laplacian") {
        return Err(Error::Impossible("the surround must be wider than the center".into()));
    }
    let plane = Plane::of(picture);
    let response = plane.response(kind, center, surround);
    let mut report = Report::default();
    report.quantity("strongest response", response.iter().copied().fold(f64::NEG_INFINITY, f64::max), "");
    report.quantity("weakest response", response.iter().copied().fold(f64::INFINITY, f64::min), "");
    report.quantity("mean response", response.iter().sum::<f64>() / response.len().max(1) as f64, "");
    let row = picture.height / 2 * picture.width..(picture.height / 2 + 1) * picture.width;
    let points = |v: &[f64]| v[row.clone()].iter().enumerate().map(|(x, v)| (x as f64, *v)).collect::<Vec<_>>();
    report.chart = Some(
        Chart::new("middle row", Axis::linear("pixel"), Axis::linear("luminance; response"))
            .with(Series::line("luminance", points(&plane.values)))
            .with(Series::line("response", points(&response))),
    );
    let gain = values.number("gain");
    let drawn = Picture::from_fn(picture.width, picture.height, |x, y| {
        [(0.2 + gain * response[y * picture.width + x]) as f32; 3]
    });
    report.picture = Some(drawn.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M121: an even picture gives nothing; a step gives a positive and a negative lobe, odd about the step, of the
    /// closed form of two error functions; a parabola has the Laplacian 2 along it, 6 with the diagonal neighbours.
    #[test]
    fn even_areas_are_silent_and_steps_are_not() {
        let even = Picture::from_fn(40, 30, |_, _| [0.3; 3]);
        for kind in ["on", "off", "laplacian-4", "laplacian-8"] {
            assert!(Plane::of(&even).response(kind, 1.5, 4.0).iter().all(|r| r.abs() < 1e-12), "{kind}");
        }
        let step = Plane::of(&Picture::from_fn(64, 5, |x, _| [f32::from(u8::from(x >= 32)); 3]));
        let on = step.response("on", 2.0, 5.0);
        let off = step.response("off", 2.0, 5.0);
        for x in 0..32 {
            let (left, right) = (on[2 * 64 + x], on[2 * 64 + 63 - x]);
            assert!((left + right).abs() < 1e-12 && (left + off[2 * 64 + x]).abs() < 1e-15);
            // Sums over pixels differ from integrals by the midpoint rule's error, at most 0.242/(24 σ²).
            let cumulative = |sigma: f64| {
                let n = 4000;
                let d = 31.5 - x as f64;
                // Φ(−d/σ) by the midpoint rule.
                (0..n)
                    .map(|k| d + 10.0 * sigma * (f64::from(k) + 0.5) / f64::from(n))
                    .map(|t| (-0.5 * (t / sigma).powi(2)).exp())
                    .sum::<f64>()
                    * 10.0
                    / f64::from(n)
                    / (2.0 * std::f64::consts::PI).sqrt()
            };
            assert!((left - (cumulative(2.0) - cumulative(5.0))).abs() < 3e-3, "{x}: {left}");
        }
        let parabola = Plane { width: 20, height: 20, values: (0..400).map(|i| f64::from(i % 20).powi(2)).collect() };
        for (kind, exact) in [("laplacian-4", 2.0), ("laplacian-8", 6.0)] {
            assert!((parabola.response(kind, 1.0, 2.0)[10 * 20 + 10] - exact).abs() < 1e-12);
        }
    }
}
