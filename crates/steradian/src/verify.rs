//! Whether integrators agree on a scene: each is rendered, and held against a reference by z-tests.
//!
//! Blocks of pixels are compared, so that errors are nearly normal, at a level that is divided among all of them (Šidák 1967). Integrators that are
//! biased, by less the smaller their radius or patches are, are rendered twice: what they differ from the reference by must shrink, or be within the noise.

use crate::{Control, Error, Film, INTEGRATORS, Quality, Scene, Session, integrators::IntegratorKind};

/// Edge of the blocks of pixels that are compared.
const BLOCK: usize = 4;
/// The chance that an integrator that agrees is said not to.
const ALPHA: f64 = 0.01;
/// Errors smaller than this part of the picture's mean are those of rounding.
const ROUNDING: f64 = 1e-4;
/// Integrators that are not compared by default: those that do not compute all light, and parts of polarised light.
const OTHERS: &[&str] =
    &["ao", "direct", "whitted", "raycast", "stokes-s1", "stokes-s2", "stokes-s3", "path-recursive", "path", "volpath"];

/// What came of an integrator.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// It agrees with the reference, or not.
    Compared(Comparison),
    /// What of the scene it cannot do.
    Cannot(String),
}

/// How a picture differs from the reference.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Mean over the picture and the channels, over that of the reference.
    pub ratio: f64,
    /// Root mean square of the differences of blocks, over the reference's mean; that of what noise would give.
    pub difference: f64,
    /// What noise alone gives in the mean.
    pub noise: f64,
    /// The largest difference of a block, in standard errors, and the one that is allowed.
    pub largest: f64,
    /// See `largest`.
    pub allowed: f64,
    /// For biased integrators, the difference with twice the radius, or a quarter of the patches.
    pub wider: Option<f64>,
    /// Whether it agrees.
    pub agrees: bool,
    /// CPU seconds.
    pub seconds: f64,
    /// The picture.
    pub film: Film,
}

/// An integrator with its outcome.
#[derive(Clone, Debug)]
pub struct Verified {
    /// Its name.
    pub integrator: String,
    /// What came of it.
    pub outcome: Outcome,
}

/// The reference, and what came of every integrator.
#[derive(Clone, Debug)]
pub struct Report {
    /// The integrator that all others are held against.
    pub reference: String,
    /// Its picture.
    pub film: Film,
    /// By the order of the registry.
    pub verified: Vec<Verified>,
}

impl Report {
    /// Whether all that can render the scene agree.
    pub fn agrees(&self) -> bool {
        self.verified.iter().all(|v| match &v.outcome {
            Outcome::Compared(c) => c.agrees,
            Outcome::Cannot(_) => true,
        })
    }
}

/// Renders a scene by every integrator that can, or those that are named, with independent pixels; `told` hears which one is next.
///
/// # Errors
/// [`Error`] for unknown names and options.
pub fn verify(
    scene: &Scene,
    quality: &Quality,
    named: &[String],
    control: &Control,
    mut told: impl FnMut(&str),
) -> Result<Report, Error> {
    let reference = if scene.has_media { "volpath" } else { "path" };
    let of = |integrator: &str, seed: u64| Quality {
        integrator: Some(integrator.to_owned()),
        sampler: Some("independent".to_owned()),
        seed: Some(seed),
        ..quality.clone()
    };
    let render = |integrator: &str, seed| -> Result<(Film, f64), Error> {
        let mut session = Session::new(scene, of(integrator, seed).plan(scene)?);
        session.step(u32::MAX, control);
        Ok((session.film(), session.cpu().as_secs_f64()))
    };
    // Pixels that share paths have errors that are not independent of each other.
    let alone = format!("{reference}:reuse=1,caustics=false,effort=even");
    told(reference);
    let seed = quality.seed.unwrap_or(scene.settings.seed);
    let (film, _) = render(&alone, seed)?;
    let default: Vec<String> =
        INTEGRATORS.iter().map(|i| i.0.to_owned()).filter(|n| !OTHERS.contains(&n.as_str())).collect();
    let mut verified = Vec::new();
    for (k, name) in (1..).zip(if named.is_empty() { &default } else { named }) {
        told(name);
        let plan = match of(name, seed).plan(scene) {
            Err(Error::CannotRender { what, .. }) => {
                verified.push(Verified { integrator: name.clone(), outcome: Outcome::Cannot(what) });
                continue;
            }
            Err(refusal) if named.is_empty() => {
                verified.push(Verified { integrator: name.clone(), outcome: Outcome::Cannot(refusal.to_string()) });
                continue;
            }
            plan => plan?,
        };
        if let Some(what) = plan.integrator.cannot(scene) {
            verified.push(Verified { integrator: name.clone(), outcome: Outcome::Cannot(what) });
            continue;
        }
        let (picture, seconds) = render(name, seed.wrapping_add(k))?;
        let mut comparison = compare(&film, picture, seconds);
        // What makes a biased one more so.
        let coarse = match &plan.integrator {
            IntegratorKind::Passes(kind) if kind.is_biased() => Some("pixels=6"),
            IntegratorKind::Radiosity(_) => Some("patches=500"),
            _ => None,
        };
        if let Some(coarse) = coarse {
            let separator = if name.contains(':') { ',' } else { ':' };
            let (wide, _) = render(&format!("{name}{separator}{coarse}"), seed.wrapping_add(k))?;
            let wider = compare(&film, wide, 0.0);
            // Squares of differences that noise does not explain.
            let bias = |c: &Comparison| (c.difference.powi(2) - c.noise.powi(2)).max(0.0).sqrt();
            comparison.agrees |= bias(&comparison) <= 0.9 * bias(&wider) + 0.1 * comparison.noise;
            comparison.wider = Some(wider.difference);
        }
        verified.push(Verified { integrator: name.clone(), outcome: Outcome::Compared(comparison) });
    }
    Ok(Report { reference: reference.to_owned(), film, verified })
}

/// The mean of blocks and the variance of that, by channel.
fn blocks(film: &Film) -> Vec<[(f64, f64); 3]> {
    let (w, h) = (film.crop.width() as usize, film.crop.height() as usize);
    let mut all = Vec::new();
    for y in (0..h).step_by(BLOCK) {
        for x in (0..w).step_by(BLOCK) {
            let mut sums = [(0.0, 0.0); 3];
            let mut count = 0.0;
            for v in y..h.min(y + BLOCK) {
                for u in x..w.min(x + BLOCK) {
                    let p = &film.pixels[v * w + u];
                    let (m, s) = (p.mean(), p.variance_of_mean());
                    (0..3).for_each(|c| sums[c] = (sums[c].0 + m[c], sums[c].1 + s[c]));
                    count += 1.0;
                }
            }
            all.push(sums.map(|(m, s)| (m / count, s / (count * count))));
        }
    }
    all
}

/// How a picture differs from a reference.
pub fn compare(reference: &Film, film: Film, seconds: f64) -> Comparison {
    let (ours, theirs) = (blocks(&film), blocks(reference));
    let values = 3 * ours.len();
    let mean = |blocks: &[[(f64, f64); 3]]| blocks.iter().flatten().map(|b| b.0).sum::<f64>() / values as f64;
    let level = mean(&theirs).abs().max(f64::MIN_POSITIVE);
    let (mut squares, mut noise, mut largest) = (0.0, 0.0, 0.0_f64);
    // Errors of blocks are heavier-tailed than normal ones where few paths carry much: no block counts as surer than the picture's average of
    // variances tells.
    let usual = ours.iter().chain(&theirs).flatten().map(|b| b.1).sum::<f64>() / values as f64;
    for (a, b) in ours.iter().zip(&theirs) {
        for (a, b) in a.iter().zip(b) {
            let (d, v) = (a.0 - b.0, a.1 + b.1);
            squares += d * d;
            noise += v;
            let sigma = v.max(0.05 * usual).sqrt();
            largest = largest.max((d.abs() - ROUNDING * level).max(0.0) / sigma.max(f64::MIN_POSITIVE));
        }
    }
    let samples = |f: &Film| f.pixels.iter().map(|p| p.samples).min().unwrap_or(0);
    let freedom = f64::from(samples(&film).min(samples(reference)).saturating_sub(1).max(1));
    let allowed = student(quantile(ALPHA, values), freedom);
    let root = |v: f64| (v / values as f64).sqrt() / level;
    Comparison {
        ratio: mean(&ours) / mean(&theirs),
        difference: root(squares),
        noise: root(noise),
        largest,
        allowed,
        wider: None,
        agrees: largest <= allowed,
        seconds,
        film,
    }
}

/// How many standard errors one of so many normal variables exceeds with a probability.
fn quantile(alpha: f64, tests: usize) -> f64 {
    let level = 1.0 - (1.0 - alpha).powf(1.0 / tests.max(1) as f64);
    // By bisection.
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if two_sided_p(middle) > level { low = middle } else { high = middle }
    }
    high
}

/// The quantile of Student's distribution for that of the normal one, since variances are estimates (Abramowitz, Stegun 1964, eq. 26.7.5).
fn student(z: f64, freedom: f64) -> f64 {
    let (z3, z5) = (z.powi(3), z.powi(5));
    z + (z3 + z) / (4.0 * freedom) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom * freedom)
}

/// The probability that a normal variable is at least `z > 0` from its mean, by Laplace's continued fraction for the tail.
fn two_sided_p(z: f64) -> f64 {
    if z < 0.1 {
        return 1.0;
    }
    let fraction = (1..400).rev().fold(z, |f, k| z + f64::from(k) / f);
    2.0 * (-0.5 * z * z).exp() / (std::f64::consts::TAU.sqrt() * fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_normal_distribution() {
        assert!((quantile(0.05, 1) - 1.959_964).abs() < 1e-4);
        // One of ten thousand at a hundredth: 1.005e-6 for each.
        assert!((quantile(0.01, 10_000) - 4.891).abs() < 1e-2, "{}", quantile(0.01, 10_000));
    }
}
