//! Whether integrators agree on a scene: each is rendered, and held against a reference by z-tests.
//!
//! Blocks of pixels are compared, so that errors are nearly normal, at a level that is divided among all of them (Šidák
//! 1967), and so is the mean of the picture. Variances come from the spread of parts of the samples, since pixels that
//! share photons do not err independently. What the camera sees of lights is left out: all show it alike, and the noise
//! of its edges would hide the rest. Agreement says little where noise is large, so the smallest difference of the mean
//! that would be seen is told, and above [`POWER`] nothing is decided. Integrators that are biased, by less the smaller
//! their radius or patches are, are rendered twice: what they differ from the reference by must shrink, or be within
//! the noise.

use crate::{Control, Error, Film, INTEGRATORS, Plan, Quality, Scene, Session, integrators::IntegratorKind};
use std::f64::consts::PI;

/// Edge of the blocks of pixels that are compared.
const BLOCK: usize = 4;
/// The chance that an integrator that agrees is said not to; half of it for the blocks, and half for the mean.
const ALPHA: f64 = 0.01;
/// Errors smaller than this part of the picture's mean are those of rounding.
const ROUNDING: f64 = 1e-4;
/// Parts of the samples, whose spread tells variances.
const PARTS: u32 = 32;
/// Nothing is decided where a difference of the mean by this part could go unseen.
pub const POWER: f64 = 0.05;
/// Integrators that are not compared by default: those that do not compute all light, and parts of polarised light.
const OTHERS: &[&str] =
    &["ao", "direct", "whitted", "raycast", "stokes-s1", "stokes-s2", "stokes-s3", "path-recursive", "path", "volpath"];

/// What came of an integrator.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// It was compared with the reference.
    Compared(Comparison),
    /// What of the scene it cannot do.
    Cannot(String),
}

/// Whether an integrator agrees with the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No difference is seen, and one of [`POWER`] would be.
    Agrees,
    /// There is a difference, which shrinks with the radius or the size of patches.
    Converges,
    /// No difference is seen, but a large one might not be either.
    Undecided,
    /// There is a difference that noise does not explain.
    Differs,
}

/// How a picture differs from the reference.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Mean over the picture and the channels, over that of the reference.
    pub ratio: f64,
    /// The difference of that from one, in standard errors.
    pub mean_z: f64,
    /// The smallest difference of `ratio` from one that is told from noise.
    pub detects: f64,
    /// Root mean square of the differences of blocks, over the reference's mean.
    pub difference: f64,
    /// What noise alone gives in the mean.
    pub noise: f64,
    /// The largest difference of a block, in standard errors.
    pub largest: f64,
    /// The largest that is allowed.
    pub allowed: f64,
    /// For biased integrators, the difference with twice the radius, or a quarter of the patches.
    pub wider: Option<f64>,
    /// Whether it agrees.
    pub verdict: Verdict,
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
    /// The integrators with a verdict.
    pub fn with(&self, verdict: Verdict) -> Vec<&str> {
        let is = |v: &&Verified| matches!(&v.outcome, Outcome::Compared(c) if c.verdict == verdict);
        self.verified.iter().filter(is).map(|v| v.integrator.as_str()).collect()
    }
}

/// A picture, and how parts of its samples differ from each other.
#[derive(Clone, Debug)]
pub struct Picture {
    film: Film,
    /// Mean of blocks by channel, and of the picture at last, with the sums of squared differences of parts.
    means: Vec<f64>,
    squares: Vec<f64>,
    parts: u32,
    seconds: f64,
}

impl Picture {
    /// Renders a plan.
    pub fn render(scene: &Scene, plan: Plan, control: &Control) -> Self {
        let step = plan.sampler.spp.div_ceil(PARTS);
        let mut session = Session::new(scene, plan);
        let mut picture = Self { film: session.film(), means: Vec::new(), squares: Vec::new(), parts: 0, seconds: 0.0 };
        let (mut before, mut samples) = (Vec::new(), 0.0);
        while !session.is_done() && !control.cancel.load(std::sync::atomic::Ordering::Relaxed) {
            session.step(step, control);
            let (so_far, taken) = (means(&session.film()), f64::from(session.samples()));
            if taken > samples {
                let part = |(k, m): (usize, &f64)| {
                    let old = before.get(k).copied().unwrap_or(0.0);
                    (taken * m - samples * old) / (taken - samples)
                };
                let parts: Vec<f64> = so_far.iter().enumerate().map(part).collect();
                picture.add(&parts);
                (before, samples) = (so_far, taken);
            }
        }
        picture.seconds = session.cpu().as_secs_f64();
        picture.film = session.film();
        picture
    }

    /// Adds a part (Welford 1962).
    fn add(&mut self, part: &[f64]) {
        self.parts += 1;
        self.means.resize(part.len(), 0.0);
        self.squares.resize(part.len(), 0.0);
        for ((mean, squares), value) in self.means.iter_mut().zip(&mut self.squares).zip(part) {
            let d = value - *mean;
            *mean += d / f64::from(self.parts);
            *squares += d * (value - *mean);
        }
    }

    /// Means with their variances.
    fn values(&self) -> impl Iterator<Item = (f64, f64)> {
        let n = f64::from(self.parts);
        self.means.iter().zip(&self.squares).map(move |(m, s)| (*m, s / (n * (n - 1.0).max(1.0))))
    }
}

/// Renders a scene by every integrator that can, or those that are named, with independent pixels and lights that the
/// camera does not see (they stay hidden in `scene`); `told` hears which one is next.
///
/// # Errors
/// [`Error`] for unknown names and options.
pub fn verify(
    scene: &mut Scene,
    quality: &Quality,
    named: &[String],
    control: &Control,
    mut told: impl FnMut(&str),
) -> Result<Report, Error> {
    scene.settings.hide_emitters = true;
    let scene = &*scene;
    let reference = if scene.has_media { "volpath" } else { "path" };
    let seed = quality.seed.unwrap_or(scene.settings.seed);
    let plan = |integrator: &str, seed: u64| {
        let integrator = Some(integrator.to_owned());
        let sampler = Some("independent".to_owned());
        Quality { integrator, sampler, seed: Some(seed), ..quality.clone() }.plan(scene)
    };
    // Pixels that share paths have errors that are not independent of each other.
    told(reference);
    let alone = plan(&format!("{reference}:reuse=1,caustics=false,effort=even"), seed)?;
    let truth = Picture::render(scene, alone, control);
    let default: Vec<String> =
        INTEGRATORS.iter().map(|i| i.0.to_owned()).filter(|n| !OTHERS.contains(&n.as_str())).collect();
    let mut verified = Vec::new();
    for (k, name) in (1..).zip(if named.is_empty() { &default } else { named }) {
        told(name);
        let cannot = |what| Verified { integrator: name.clone(), outcome: Outcome::Cannot(what) };
        let plan = match plan(name, seed.wrapping_add(k)) {
            Err(Error::CannotRender { what, .. }) => {
                verified.push(cannot(what));
                continue;
            }
            Err(refusal) if named.is_empty() => {
                verified.push(cannot(refusal.to_string()));
                continue;
            }
            plan => plan?,
        };
        if let Some(what) = plan.integrator.cannot(scene) {
            verified.push(cannot(what));
            continue;
        }
        let mut comparison = compare(&truth, Picture::render(scene, plan, control));
        if let Some(integrator) = coarser(&plan.integrator) {
            let wider = compare(&truth, Picture::render(scene, Plan { integrator, ..plan }, control));
            // Squares of differences that noise does not explain.
            let bias = |c: &Comparison| (c.difference.powi(2) - c.noise.powi(2)).max(0.0).sqrt();
            let shrinks = bias(&comparison) <= 0.9 * bias(&wider) + 0.1 * comparison.noise;
            if comparison.verdict == Verdict::Differs && shrinks {
                comparison.verdict = Verdict::Converges;
            }
            comparison.wider = Some(wider.difference);
        }
        verified.push(Verified { integrator: name.clone(), outcome: Outcome::Compared(comparison) });
    }
    Ok(Report { reference: reference.to_owned(), film: truth.film, verified })
}

/// A biased integrator with more of its bias.
fn coarser(integrator: &IntegratorKind) -> Option<IntegratorKind> {
    match integrator {
        IntegratorKind::Passes(kind) => kind.coarser().map(IntegratorKind::Passes),
        IntegratorKind::Radiosity(view) => {
            let mut view = *view;
            view.settings.patches /= 4;
            Some(IntegratorKind::Radiosity(view))
        }
        _ => None,
    }
}

/// The means of blocks by channel, and that of the picture.
fn means(film: &Film) -> Vec<f64> {
    let (w, h) = (film.crop.width() as usize, film.crop.height() as usize);
    let mut all = Vec::new();
    for y in (0..h).step_by(BLOCK) {
        for x in (0..w).step_by(BLOCK) {
            let (mut sums, mut count) = ([0.0; 3], 0.0);
            for v in y..h.min(y + BLOCK) {
                for u in x..w.min(x + BLOCK) {
                    let m = film.pixels[v * w + u].mean();
                    (0..3).for_each(|c| sums[c] += m[c]);
                    count += 1.0;
                }
            }
            all.extend(sums.map(|s| s / count));
        }
    }
    let sum: f64 = film.pixels.iter().flat_map(|p| p.mean()).sum();
    all.push(sum / (3 * film.pixels.len()).max(1) as f64);
    all
}

/// How a picture differs from a reference.
pub fn compare(reference: &Picture, picture: Picture) -> Comparison {
    let (mut ours, mut theirs): (Vec<_>, Vec<_>) = (picture.values().collect(), reference.values().collect());
    let ((mean, v), (level, w)) = (ours.pop().unwrap_or_default(), theirs.pop().unwrap_or_default());
    let (values, level) = (ours.len(), level.abs().max(f64::MIN_POSITIVE));
    let (mut squares, mut noise, mut largest) = (0.0, 0.0, 0.0_f64);
    // Errors of blocks are heavier-tailed than normal ones where few paths carry much, and their variances are
    // underestimated where none of these came: no block counts as surer than half the picture's usual error.
    let usual = ours.iter().chain(&theirs).map(|b| b.1).sum::<f64>() / values as f64;
    for (a, b) in ours.iter().zip(&theirs) {
        let (d, v) = (a.0 - b.0, a.1 + b.1);
        squares += d * d;
        noise += v;
        let sigma = v.max(0.25 * usual).sqrt();
        largest = largest.max((d.abs() - ROUNDING * level).max(0.0) / sigma.max(f64::MIN_POSITIVE));
    }
    let freedom = picture.parts.min(reference.parts).saturating_sub(1) as usize;
    let allowed = quantile(0.5 * ALPHA, values, freedom);
    // The mean of the picture.
    let sigma = (v + w).sqrt() / level;
    let ratio = mean / level;
    let detects = ROUNDING + quantile(0.5 * ALPHA, 1, freedom) * sigma;
    let verdict = if largest > allowed || (ratio - 1.0).abs() > detects {
        Verdict::Differs
    } else if detects <= POWER {
        Verdict::Agrees
    } else {
        Verdict::Undecided
    };
    let root = |v: f64| (v / values as f64).sqrt() / level;
    Comparison {
        ratio,
        mean_z: ((ratio - 1.0).abs() - ROUNDING).max(0.0) / sigma.max(f64::MIN_POSITIVE),
        detects,
        difference: root(squares),
        noise: root(noise),
        largest,
        allowed,
        wider: None,
        verdict,
        seconds: picture.seconds,
        film: picture.film,
    }
}

/// How many standard errors one of so many variables of Student's distribution exceeds with a probability.
fn quantile(alpha: f64, tests: usize, freedom: usize) -> f64 {
    let level = -((-alpha).ln_1p() / tests.max(1) as f64).exp_m1();
    // By bisection of the logarithm.
    let (mut low, mut high) = (1e-3_f64, 1e12_f64);
    for _ in 0..80 {
        let middle = (low * high).sqrt();
        if within(middle, freedom.clamp(1, 2000)) < 1.0 - level { low = middle } else { high = middle }
    }
    high
}

/// The probability that a variable of Student's distribution is within `t` of zero (Abramowitz, Stegun 1964, eq. 26.7.3
/// and 26.7.4).
fn within(t: f64, freedom: usize) -> f64 {
    let theta = (t / (freedom as f64).sqrt()).atan();
    let (sin, cos) = theta.sin_cos();
    let odd = freedom % 2;
    // Terms of cos^k with every second k below the number of degrees of freedom.
    let (mut term, mut sum) = (if odd == 1 { cos } else { 1.0 }, 0.0);
    for k in (odd..freedom.saturating_sub(1)).step_by(2) {
        sum += term;
        term *= (k + 1) as f64 / (k + 2) as f64 * cos * cos;
    }
    if odd == 1 { 2.0 / PI * (theta + sin * sum) } else { sin * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (alpha, freedom, expected) in
            [(0.05, 1, 12.706), (0.05, 2, 4.303), (0.05, 5, 2.571), (0.01, 15, 2.947), (0.05, 120, 1.980)]
        {
            let t = quantile(alpha, 1, freedom);
            assert!((t - expected).abs() < 2e-3, "{freedom}: {t}");
        }
        // One of ten thousand at a hundredth: 1.005e-6 for each, of nearly normal variables.
        assert!((quantile(0.01, 10_000, 2000) - 4.906).abs() < 1e-2, "{}", quantile(0.01, 10_000, 2000));
    }

    fn of(parts: &[f64]) -> Picture {
        use steradian_core::film::{Crop, Pixel};
        let mut pixel = Pixel::default();
        parts.iter().for_each(|p| pixel.add_value([*p; 3]));
        let film = Film {
            crop: Crop { x0: 0, y0: 0, x1: 4, y1: 4 },
            pixels: vec![pixel; 16],
            features: Vec::new(),
            by_light: Vec::new(),
            mattes: Vec::new(),
        };
        let mut picture = Picture { film, means: Vec::new(), squares: Vec::new(), parts: 0, seconds: 0.0 };
        parts.iter().for_each(|p| picture.add(&[*p; 4]));
        picture
    }

    #[test]
    fn what_noise_hides_is_not_decided() {
        let noisy = |level: f64, noise: f64| -> Vec<f64> {
            (0..32).map(|k| level * (1.0 + noise * (f64::from(k) - 15.5) / 15.5)).collect()
        };
        let verdict = |level, noise| compare(&of(&noisy(1.0, noise)), of(&noisy(level, noise))).verdict;
        assert_eq!(verdict(1.0, 0.01), Verdict::Agrees);
        assert_eq!(verdict(1.1, 0.01), Verdict::Differs);
        assert_eq!(verdict(1.02, 0.5), Verdict::Undecided);
        // A hundredth is told from noise that is small.
        assert_eq!(verdict(1.01, 0.002), Verdict::Differs);
    }
}
