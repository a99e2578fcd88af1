//! Holding a material to the laws of scattering: values that are not negative, reciprocity, energy, and directions
//! drawn by the density that is told for them.
//!
//! What is computed is held against a tolerance, what is drawn at random against chance: all p-values together fail a
//! sound material once in a hundred times (Šidák).

use crate::{
    Specimen, TransportMode,
    albedo::{WATCHED, albedo},
    chi_square::ChiSquare,
    direction,
    specimen::MIXTURE_STRATA,
};
use serde::Serialize;
use statrs::function::erf::erfc;
use std::fmt;
use steradian_math::{Vec2, Vec3, hash::HashRng, sphere_grid::SphereGrid, warp::uniform_sphere};

/// A law, and what was found of it.
#[derive(Clone, Debug, Serialize)]
pub struct Law {
    /// The law.
    pub law: &'static str,
    /// Angle of the fixed direction from the normal, degrees, beyond 90 from below; none for pairs of all angles.
    pub angle: Option<f64>,
    /// Measured value: the least value, the greatest relative difference, an albedo, a probability, or χ².
    pub found: f64,
    /// Expected value, or the upper bound (for the least value, the lower); degrees of freedom for χ².
    pub expected: f64,
    /// The probability of a deviation as great as this or greater by chance, where chance has a part.
    pub p: Option<f64>,
    /// True if the law is kept.
    pub holds: bool,
}

/// All laws of a material.
#[derive(Clone, Debug, Serialize)]
pub struct Laws {
    /// One row for each law and angle.
    pub laws: Vec<Law>,
    /// Probabilities below this break a law.
    pub level: f64,
    /// True if all hold.
    pub hold: bool,
}

/// Angles of the fixed direction in degrees; those from below where light comes back from there.
const ANGLES: [f64; 6] = [10.0, 45.0, 75.0, 85.0, 105.0, 135.0];
/// Most pairs of directions for the laws of values.
const PAIRS: u32 = 20_000;
/// Relative difference that single precision may make in narrow lobes.
const ROUNDING: f64 = 0.02;
/// Absolute error of integrals over densities.
const QUADRATURE: f64 = 1e-3;
/// Probability with which a sound material fails one of the tests.
const FALSE_ALARM: f64 = 0.01;
const GRID: SphereGrid = SphereGrid { bands: 20, sectors: 40 };

/// Tests a material with so many samples for each angle, and as many pairs of directions, 20 000 at most.
pub fn laws(specimen: &Specimen<'_>, samples: u32) -> Laws {
    let mut laws = values(specimen, samples.min(PAIRS));
    let below = ANGLES.into_iter().filter(|angle| *angle > 90.0);
    laws.extend(WATCHED.into_iter().chain(below).filter_map(|angle| energy(specimen, angle, samples)));
    for angle in ANGLES {
        laws.extend(at_angle(specimen, angle, samples));
    }
    let tests = laws.iter().filter(|l| l.p.is_some()).count().max(1);
    let level = 1.0 - (1.0 - FALSE_ALARM).powf(1.0 / tests as f64);
    for law in &mut laws {
        law.holds &= law.p.is_none_or(|p| p >= level);
    }
    Laws { hold: laws.iter().all(|l| l.holds), laws, level }
}

/// A number for the choices of mixtures: one of those that [`Specimen::eval`] averages over.
fn choice(rng: &mut HashRng) -> f32 {
    ((rng.next_f32() * MIXTURE_STRATA as f32).floor() + 0.5) / MIXTURE_STRATA as f32
}

fn square(rng: &mut HashRng) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

/// Two values relative to the greater, with a floor where both are next to nothing.
fn difference(a: f64, b: f64) -> f64 {
    (a - b).abs() / (a.abs().max(b.abs()) + 1e-3)
}

/// The laws of values, over pairs of which half are drawn by the material, so that peaks are met.
fn values(specimen: &Specimen<'_>, pairs: u32) -> Vec<Law> {
    use TransportMode::{Importance, Radiance};
    let mut rng = HashRng::new(1);
    let (mut least, mut reciprocity, mut adjoint) = (f64::INFINITY, 0.0f64, 0.0f64);
    for k in 0..pairs {
        let wo = uniform_sphere(square(&mut rng));
        let drawn = (k % 2 == 0)
            .then(|| specimen.sample(wo, choice(&mut rng), rng.next_f32(), square(&mut rng), Radiance))
            .flatten();
        let wi = drawn.map_or_else(|| uniform_sphere(square(&mut rng)), |s| s.wi);
        let lanes = |wo: Vec3, wi: Vec3, mode| specimen.eval(wo, wi, mode).value.to_array().map(f64::from);
        let e = specimen.eval(wo, wi, Radiance);
        for v in e.value.to_array().into_iter().chain([e.pdf]).map(f64::from) {
            least = if v.is_finite() { least.min(v) } else { f64::NEG_INFINITY };
        }
        // Closer to the horizon rounding of the cosines counts.
        if wo.z.abs().min(wi.z.abs()) < 0.02 {
            continue;
        }
        let (cos_o, cos_i) = (f64::from(wo.z.abs()), f64::from(wi.z.abs()));
        let apart = |forth: [f64; 4], back: [f64; 4]| {
            forth.into_iter().zip(back).map(|(f, b)| difference(f / cos_i, b / cos_o)).fold(0.0, f64::max)
        };
        let forth = lanes(wo, wi, Radiance);
        adjoint = adjoint.max(apart(forth, lanes(wi, wo, Importance)));
        if wo.z * wi.z > 0.0 {
            reciprocity = reciprocity.max(apart(forth, lanes(wi, wo, Radiance)));
        }
    }
    let row = |law, found, expected, holds| Law { law, angle: None, found, expected, p: None, holds };
    vec![
        row("positivity: least value", least, 0.0, least >= 0.0),
        row("reciprocity: f(a, b) = f(b, a)", reciprocity, ROUNDING, reciprocity <= ROUNDING),
        row("light's paths carry as much", adjoint, ROUNDING, adjoint <= ROUNDING),
    ]
}

/// Energy at an angle, as [`crate::summary`] tells it; nothing where no light comes back.
fn energy(specimen: &Specimen<'_>, angle: f64, samples: u32) -> Option<Law> {
    let light = albedo(specimen, angle, samples);
    (light.total() > 0.0).then(|| Law {
        law: "energy: albedo in the white furnace",
        angle: Some(angle),
        found: light.total().into(),
        expected: 1.0,
        p: None,
        holds: light.conserves_energy(),
    })
}

/// The density's integral, χ² and weights at an angle; nothing where no light comes back at all.
fn at_angle(specimen: &Specimen<'_>, angle: f64, samples: u32) -> Vec<Law> {
    let (wo, n) = (direction(angle, 20.0), f64::from(samples));
    let mut rng = HashRng::new(2 + angle.to_bits());
    let mut histogram = vec![0u64; GRID.cells()];
    let (mut drawn, mut rough, mut weights) = (0u64, 0u64, 0.0f64);
    for _ in 0..samples {
        let (choice, u, u2) = (choice(&mut rng), rng.next_f32(), square(&mut rng));
        let Some(s) = specimen.sample(wo, choice, u, u2, TransportMode::Radiance) else { continue };
        drawn += 1;
        if s.lobe.is_specular() {
            continue;
        }
        rough += 1;
        histogram[GRID.cell(s.wi)] += 1;
        // The parts of a mixture have weights of their own.
        if rough <= u64::from(PAIRS) && !specimen.is_mixed() {
            let value = specimen.eval(wo, s.wi, TransportMode::Radiance).value.to_array();
            let apart = s.weight.to_array().into_iter().zip(value);
            let apart = apart.map(|(w, v)| difference(f64::from(w * s.pdf), f64::from(v)));
            weights = apart.fold(weights, f64::max);
        }
    }
    if drawn == 0 {
        return Vec::new();
    }
    let row = |law, found, expected, p, holds| Law { law, angle: Some(angle), found, expected, p, holds };
    let mut laws = Vec::new();
    let density = |wi: Vec3| f64::from(specimen.eval(wo, wi, TransportMode::Radiance).pdf);
    let expected = GRID.expected_counts(density, &histogram, u64::from(samples));
    let integral = expected.iter().sum::<f64>() / n;
    if rough == 0 && integral < QUADRATURE {
        // What mirrors has no density.
        return laws;
    }
    let share = rough as f64 / n;
    let deviation = ((share * (1.0 - share)).max(0.0) / n + QUADRATURE * QUADRATURE).sqrt();
    let p = erfc((integral - share).abs() / deviation / std::f64::consts::SQRT_2);
    laws.push(row("density: its integral", integral, share, Some(p), integral <= 1.0 + 3.0 * QUADRATURE));
    let observed = histogram.iter().map(|c| *c as f64).chain([n - rough as f64]);
    let expected: Vec<f64> = expected.into_iter().chain([(n * (1.0 - integral)).max(0.0)]).collect();
    // What quadrature leaves of a density that integrates to one is not the share of anything.
    let (observed, expected) = if rough == u64::from(samples) {
        (observed.take(GRID.cells()).collect::<Vec<_>>(), expected[..GRID.cells()].to_vec())
    } else {
        (observed.collect(), expected)
    };
    let test = ChiSquare::of(&observed, &expected);
    laws.push(row("samples: χ² against the density", test.statistic, test.freedom, Some(test.p), true));
    if !specimen.is_mixed() {
        laws.push(row("samples: weight · density = value", weights, ROUNDING, None, weights <= ROUNDING));
    }
    laws
}

impl fmt::Display for Laws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:36} {:>6} {:>12} {:>12} {:>9}", "law", "angle", "found", "expected", "p")?;
        for l in &self.laws {
            let angle = l.angle.map_or_else(String::new, |a| format!("{a}°"));
            let p = l.p.map_or_else(String::new, |p| format!("{p:.4}"));
            let verdict = if l.holds { "holds" } else { "BROKEN" };
            writeln!(f, "{:36} {angle:>6} {:>12.5} {:>12.5} {p:>9}  {verdict}", l.law, l.found, l.expected)?;
        }
        let verdict = if self.hold { "all laws hold" } else { "not all laws hold" };
        write!(f, "{verdict} (p-values below {:.1e} break one)", self.level)
    }
}
