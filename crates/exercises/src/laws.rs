//! Laws that right functions obey, whatever their values: tests of what cannot be compared point by point.

use crate::{
    exercise::{Asked, Density, Exercise, Finding, Wrong},
    numbers::{listed, shown},
    points::{Random, dot},
};
use std::f64::consts::{PI, TAU};
use steradian_math::{Vec3, sphere_grid::SphereGrid};

impl Finding {
    /// A finding without a mistake to name.
    fn new(holds: bool, text: impl Into<String>) -> Self {
        Self { holds, text: text.into(), mistake: None }
    }
}

/// Samples of a law by chance.
pub(crate) const SAMPLES: usize = 8_000;
/// Standard deviations beyond which chance explains nothing; seeds are fixed, so that a verdict never changes.
const DEVIATIONS: f64 = 4.5;
/// Relative error of the midpoint rule over the hemisphere.
const QUADRATURE: f64 = 0.01;
/// Midpoints along the height, and around.
const GRID: [usize; 2] = [32, 64];
const CELLS: SphereGrid = SphereGrid { bands: 20, sectors: 16 };

/// Directions of the hemisphere at midpoints of equal solid angle, and that angle.
fn midpoints() -> (impl Iterator<Item = [f64; 3]>, f64) {
    let [n, m] = GRID;
    let at = move |i: usize| {
        let (z, phi) = (((i / m) as f64 + 0.5) / n as f64, ((i % m) as f64 + 0.5) / m as f64 * TAU);
        let r = (1.0 - z * z).sqrt();
        [r * phi.cos(), r * phi.sin(), z]
    };
    ((0..n * m).map(at), TAU / (n * m) as f64)
}

/// Questions for the integral over the hemisphere: a function at all midpoints.
pub(crate) fn over_hemisphere(function: &'static str, inputs: impl Fn([f64; 3]) -> Vec<f64>) -> Vec<Asked> {
    midpoints().0.map(|w| (function, inputs(w))).collect()
}

/// The albedo `∫ f cosθ dω` is at most 1.
pub(crate) fn energy(answers: &[Vec<f64>]) -> Finding {
    let (directions, weight) = midpoints();
    let albedo: f64 = directions.zip(first(answers)).map(|(w, f)| f * w[2] * weight).sum();
    Finding::new(albedo <= 1.0 + QUADRATURE, format!("∫ f cosθ dω = {}, at most 1", shown(albedo)))
}

/// The integral of a density is 1.
pub(crate) fn density(answers: &[Vec<f64>]) -> Finding {
    let integral = first(answers).sum::<f64>() * midpoints().1;
    Finding::new((integral - 1.0).abs() <= QUADRATURE, format!("∫ pdf dω = {}, must be 1", shown(integral)))
}

/// `f(a, b) = f(b, a)`, of answers in pairs.
pub(crate) fn reciprocity(answers: &[Vec<f64>]) -> Finding {
    let values: Vec<f64> = first(answers).collect();
    let apart = values.chunks_exact(2).map(|p| (p[0] - p[1]).abs() / p[0].abs().max(p[1].abs()).max(1e-6));
    let most = apart.fold(0.0, f64::max);
    Finding::new(most <= 1e-3, format!("f(wo, wi) and f(wi, wo) differ by {} of their value at most", shown(most)))
}

/// The first numbers of answers.
fn first(answers: &[Vec<f64>]) -> impl Iterator<Item = f64> {
    answers.iter().map(|a| a.first().copied().unwrap_or(f64::NAN))
}

/// Questions for samples: fixed inputs, then two random numbers.
pub(crate) fn samples(function: &'static str, fixed: &[f64]) -> Vec<Asked> {
    let mut random = Random::new(41);
    (0..SAMPLES).map(|_| (function, [fixed, &[random.unit(), random.unit()]].concat())).collect()
}

/// Directions that are drawn follow a density (sr⁻¹); those of length 0 are failed draws, of which it has as many.
pub(crate) fn follows(exercise: &Exercise, function: &str, right: Density, answers: &[Vec<f64>]) -> Finding {
    for w in answers {
        let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
        // Also NaN.
        if !((length - 1.0).abs() < 1e-3 || length == 0.0) {
            let text = format!("a direction has length 1, and {} has length {}", listed(w), shown(length));
            return Finding::new(false, text);
        }
    }
    let mut histogram = vec![0u64; CELLS.cells()];
    for w in answers.iter().filter(|w| w.iter().any(|x| *x != 0.0)) {
        if let [x, y, z] = w[..] {
            histogram[CELLS.cell(Vec3::new(x as f32, y as f32, z as f32))] += 1;
        }
    }
    let score = |density: Density| score(&histogram, answers.len(), density);
    let found = score(right);
    if found < DEVIATIONS {
        return Finding::new(
            true,
            format!("{} directions follow the density: χ² is off by {found:.1} σ", answers.len()),
        );
    }
    let wrong = exercise.mistakes.iter().filter(|m| m.function == function);
    let explained = wrong.filter_map(|m| match m.wrong {
        Wrong::Density(density) => Some((score(density), m)),
        _ => None,
    });
    let best = explained.filter(|(score, _)| *score < DEVIATIONS).min_by(|a, b| a.0.total_cmp(&b.0));
    let below = answers.iter().filter(|w| w.get(2).is_some_and(|z| *z < 0.0)).count();
    let mean = |i: usize| answers.iter().filter_map(|w| w.get(i)).sum::<f64>() / answers.len() as f64;
    let text = best.map_or_else(
        || {
            let mean = listed(&[mean(0), mean(1), mean(2)]);
            let most = "the directions do not follow the density (χ²)";
            let sky = if below > 0 {
                format!("; {below} of {} point below the surface", answers.len())
            } else {
                String::new()
            };
            format!("{most}; their mean is {mean}{sky}")
        },
        |(_, m)| m.hint.to_owned(),
    );
    Finding { holds: false, text, mistake: best.map(|(_, m)| m.key) }
}

/// The deviation of χ² from its mean in standard deviations, by Wilson and Hilferty (1931).
fn score(histogram: &[u64], samples: usize, density: Density) -> f64 {
    let at = |w: Vec3| density(w.to_array().map(f64::from));
    let n = samples as f64;
    // A tenth of the noise of cells that expect five.
    let expected: Vec<f64> = CELLS.integrate(at, 0.2 / n).iter().map(|part| n * part).collect();
    let drawn = histogram.iter().sum::<u64>() as f64;
    let lost = (n - expected.iter().sum::<f64>()).max(0.0);
    let all = histogram.iter().map(|c| *c as f64).zip(expected).chain([(n - drawn, lost)]);
    let (mut chi2, mut cells, mut pool) = (0.0, 0.0, (0.0, 0.0));
    for (o, e) in all {
        if e >= 5.0 {
            (chi2, cells) = (chi2 + (o - e) * (o - e) / e, cells + 1.0);
        } else {
            pool = (pool.0 + o, pool.1 + e);
        }
    }
    // What little is expected in the rest, with the error of quadrature.
    chi2 += (pool.0 - pool.1).powi(2) / (pool.1 + 1.0);
    let freedom: f64 = f64::max(cells, 2.0);
    let k = 2.0 / (9.0 * freedom);
    ((chi2 / freedom).cbrt() - (1.0 - k)) / k.sqrt()
}

/// The mean of a function of random numbers is a known value.
pub(crate) fn mean(exercise: &Exercise, function: &str, right: f64, answers: &[Vec<f64>]) -> Finding {
    let n = answers.len() as f64;
    let mean = first(answers).sum::<f64>() / n;
    let variance = first(answers).map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    let z = |value: f64| (mean - value) / (variance / n).sqrt().max(1e-9 * value.abs());
    let text = format!("the mean of {} values is {}, right is {}", answers.len(), shown(mean), shown(right));
    if z(right).abs() < DEVIATIONS {
        return Finding::new(true, format!("{text} ({:+.1} σ)", z(right)));
    }
    let explained = exercise.mistakes.iter().filter(|m| m.function == function).filter_map(|m| match m.wrong {
        Wrong::Mean(value) if z(value).abs() < DEVIATIONS => Some((z(value).abs(), m)),
        _ => None,
    });
    match explained.min_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((_, m)) => Finding { holds: false, text: format!("{} ({text})", m.hint), mistake: Some(m.key) },
        None => Finding::new(false, format!("{text} ({:+.1} σ)", z(right))),
    }
}

/// The density of cosine-weighted directions.
pub(crate) fn cosine([_, _, z]: [f64; 3]) -> f64 {
    z.max(0.0) / PI
}

/// The density of even directions above the surface.
pub(crate) fn even([_, _, z]: [f64; 3]) -> f64 {
    if z > 0.0 { 1.0 / TAU } else { 0.0 }
}

/// The density of `(n + 1)/2π cosⁿα` around an axis.
pub(crate) fn lobe(axis: [f64; 3], exponent: f64, w: [f64; 3]) -> f64 {
    (exponent + 1.0) / TAU * dot(axis, w).max(0.0).powf(exponent)
}
