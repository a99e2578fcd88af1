//! Agreement of integrators on a scene: each is rendered, and held against a reference by statistical tests.
//!
//! - **The reference** finds all light of the scene, and its error is known: path tracing guided by photons, or
//!   bidirectional path tracing, whichever errs less with as many samples. Path tracing does not find caustics of
//!   lights without size, nor connections those that are seen in mirrors and through glass; where neither is complete
//!   nothing is decided.
//! - **Errors** come from the spread of parts of the samples, since pixels that share photons do not err independently.
//!   Where few bright paths make them they are not known: then larger blocks are compared, which more of these paths
//!   meet, and where that is of no avail nothing is decided.
//! - **Effort** is added until a method is seen to agree: the samples are doubled, up to [`BUDGET`] times those asked
//!   for, and then as many taken as noise still asks for, up to [`MOST`] times. What differs then differs.
//! - **Tests** compare blocks of pixels, at a level that is divided among all of them (Šidák 1967), and the mean.
//!   Agreement says little where noise is large: a difference of [`POWER`] must be one that would be seen.
//! - **Bias** is tested by its limit. Integrators with a radius or patches are rendered twice, photons with half their
//!   radius and with all of it; what they differ from the reference by is little more than what they changed by when
//!   the radius was halved, in that direction.
//!
//! What the camera sees of lights is left out, black: all show it alike, and the noise of its edges would hide the
//! rest.

mod judge;
mod picture;
mod quantile;
#[cfg(test)]
mod tests;

pub use judge::{Difference, POWER, Verdict};

use crate::{Control, Error, Film, Plan, Quality, Scene, Session, missed};
use picture::Picture;
use std::sync::{Arc, atomic::Ordering};
use steradian_engine::{Refusal, specular_material};
use steradian_integrators::{Depth, Method as Integrator, passes::missed_caustics};
use steradian_scene::Family;

/// Rounds of the samples asked for that are spent on whatever is not decided.
pub const BUDGET: u32 = 16;
/// Most rounds, spent where they are seen to lead to a decision.
pub const MOST: u32 = 64;
/// Rounds from which on larger blocks are compared where errors of small ones are not known.
const COARSE: u32 = 4;
/// The part of the light that a reference may leave out.
const COMPLETE: f64 = 1e-3;
/// Integrators that are not compared by default: those that do not compute all light, parts of polarised
/// light, `gather`, whose paths are those of `path` without lights asked, and `irradiance-cache`, whose pixels err
/// alike.
const OTHERS: &[&str] = &[
    "ao",
    "direct",
    "gather",
    "irradiance-cache",
    "whitted",
    "raycast",
    "structure",
    "stokes-s1",
    "stokes-s2",
    "stokes-s3",
    "raster",
];

/// Outcome of an integrator.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Comparison with the reference.
    Compared(Box<Comparison>),
    /// Unsupported feature of the scene.
    Cannot(String),
}

/// Comparison of an integrator with the reference.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Difference of its picture.
    pub difference: Difference,
    /// CPU seconds.
    pub seconds: f64,
    /// Samples per pixel of its picture.
    pub spp: u32,
    /// The picture.
    pub film: Film,
}

/// An integrator with its outcome.
#[derive(Clone, Debug)]
pub struct Verified {
    /// Its name.
    pub integrator: String,
    /// Outcome.
    pub outcome: Outcome,
}

/// The reference, and what came of every integrator.
#[derive(Clone, Debug)]
pub struct Report {
    /// The integrator that all others are held against.
    pub reference: String,
    /// Its picture.
    pub film: Film,
    /// Reason why nothing is decided, where no reference finds all light.
    pub incomplete: Option<String>,
    /// Outcomes in the order of the registry.
    pub verified: Vec<Verified>,
}

impl Report {
    /// The integrators with a verdict.
    pub fn with(&self, verdict: Verdict) -> Vec<&str> {
        let is = |v: &&Verified| matches!(&v.outcome, Outcome::Compared(c) if c.difference.verdict == verdict);
        self.verified.iter().filter(is).map(|v| v.integrator.as_str()).collect()
    }
}

/// An integrator, and what is asked of it.
#[derive(Clone, Debug)]
struct Render {
    integrator: Arc<dyn Integrator>,
    plan: Plan,
}

impl Render {
    fn session(&self, scene: &Arc<Scene>) -> Result<Box<dyn Session>, Refusal> {
        self.integrator.session(Arc::clone(scene), self.plan)
    }
}

/// Renderer of a round of a method; tests put faulty ones in its place.
type Taker<'r> = &'r dyn Fn(&str, &Arc<Scene>, Render, &Control, &mut Picture);

/// Renders a scene by every integrator that can, or those that are named, with independent pixels and lights that the
/// camera does not see (they stay hidden in `scene`); `told` hears which one is next.
///
/// # Errors
/// [`Error`] for unknown names and options.
pub fn verify(
    scene: &mut Arc<Scene>,
    quality: &Quality,
    named: &[String],
    control: &Control,
    told: impl FnMut(&str),
) -> Result<Report, Error> {
    let take: Taker<'_> = &|_, scene, render, control, picture| picture.add(scene, render, control);
    verify_by(take, scene, quality, named, control, told)
}

/// Lights that the camera meets are black.
fn hide_lights(settings: &mut steradian_core::scene::Settings) {
    (settings.hide_emitters, settings.hidden_emitters_block) = (true, true);
}

/// [`verify`], with what renders.
fn verify_by(
    take: Taker<'_>,
    scene: &mut Arc<Scene>,
    quality: &Quality,
    named: &[String],
    control: &Control,
    mut told: impl FnMut(&str),
) -> Result<Report, Error> {
    if !(scene.settings().hide_emitters && scene.settings().hidden_emitters_block) {
        Arc::make_mut(scene).change(|parts| hide_lights(&mut parts.settings));
    }
    let scene = &*scene;
    let seed = quality.seed.unwrap_or(scene.settings().seed);
    let maker = Maker { take, scene, quality, control, seed };
    let (mut reference, has_caustics) = maker.reference(&mut told)?;
    let incomplete = reference.lacks(scene);
    let is_default = |name: &&str| !OTHERS.contains(name) && (*name != "volpath" || scene.has_media());
    let default: Vec<String> = Family::Integrator.kinds().filter(is_default).map(str::to_owned).collect();
    let mut verified = Vec::new();
    for (k, name) in (1..).zip(if named.is_empty() { &default } else { named }) {
        told(name);
        let outcome = match maker.method(name, k) {
            Err(Error::CannotRender { what, .. }) => Outcome::Cannot(what),
            Err(Error::Refused(refusal)) => Outcome::Cannot(refusal.to_string()),
            Err(refusal) if named.is_empty() => Outcome::Cannot(refusal.to_string()),
            Err(refusal) => return Err(refusal),
            Ok(method) => match method.render.integrator.limits(scene).into_iter().next() {
                Some(limit) => Outcome::Cannot(limit.what),
                None => {
                    let unsure = Unsure { of_all: incomplete.is_some(), of_paths: has_caustics };
                    Outcome::Compared(Box::new(maker.decide(method, &mut reference, unsure)))
                }
            },
        };
        verified.push(Verified { integrator: name.clone(), outcome });
    }
    let film = reference.picture.film.unwrap_or_else(|| empty(scene));
    Ok(Report { reference: reference.name, film, incomplete, verified })
}

/// A method, and what it has rendered.
#[derive(Clone, Debug)]
struct Method {
    name: String,
    render: Render,
    picture: Picture,
    rounds: u32,
    /// Integrator with a larger bias and its picture, for methods that are biased.
    wider: Option<(Arc<dyn Integrator>, Picture)>,
}

/// Comparisons that cannot be decided.
#[derive(Clone, Copy, Debug)]
struct Unsure {
    /// Anything: no reference finds all light.
    of_all: bool,
    /// Differences of paths that photons do not guide: they hardly find some of the light.
    of_paths: bool,
}

impl Method {
    /// True if it follows paths from the camera without a guide.
    fn is_unguided(&self) -> bool {
        self.render.integrator.camera_paths().is_some() && !self.picture.is_guided
    }

    /// Light that a reference does not find.
    fn lacks(&self, scene: &Scene) -> Option<String> {
        let settings = scene.settings();
        let depth = Depth { max: settings.max_depth, roulette_after: settings.rr_depth, hide_emitters: true };
        let missed = missed_caustics(scene, &depth);
        if missed::share_of(missed, self.picture.film.as_ref()?) <= COMPLETE {
            return None;
        }
        match self.render.integrator.camera_paths() {
            None => specular_material(scene)
                .map(|name| format!("caustics of lights without size, seen by way of the material '{name}'")),
            Some(_) => Some("caustics of lights without size".into()),
        }
    }
}

/// Inputs of all renders.
struct Maker<'a> {
    take: Taker<'a>,
    scene: &'a Arc<Scene>,
    quality: &'a Quality,
    control: &'a Control,
    seed: u64,
}

impl Maker<'_> {
    /// A method by name; those of a report have seeds of their own.
    fn method(&self, name: &str, number: u64) -> Result<Method, Error> {
        let quality = Quality {
            integrator: Some(name.to_owned()),
            sampler: Some("independent".to_owned()),
            // Rounds and wider radii lie between the numbers of methods.
            seed: Some(self.seed.wrapping_add(number << 8)),
            ..self.quality.clone()
        };
        let crate::Render { method: integrator, plan, .. } = quality.render(self.scene)?;
        let mut render = Render { integrator, plan };
        render.session(self.scene)?;
        let mut wider = None;
        if let Some([finer, coarser]) = render.integrator.bias_pair() {
            render.integrator = finer;
            wider = Some((coarser, Picture::default()));
        }
        Ok(Method { name: name.to_owned(), render, picture: Picture::default(), rounds: 0, wider })
    }

    /// Renders until a method has so many rounds.
    fn extend(&self, method: &mut Method, rounds: u32) {
        while method.rounds < rounds {
            let mut render = method.render.clone();
            let seed = &mut render.plan.sampler.seed;
            *seed = seed.wrapping_add(2 * u64::from(method.rounds));
            (self.take)(&method.name, self.scene, render.clone(), self.control, &mut method.picture);
            if let Some((integrator, picture)) = &mut method.wider {
                render.plan.sampler.seed = render.plan.sampler.seed.wrapping_add(1);
                render.integrator = Arc::clone(integrator);
                (self.take)(&method.name, self.scene, render, self.control, picture);
            }
            method.rounds += 1;
        }
    }

    /// The method that all others are held against: of those that find all light the one that errs least; and whether
    /// paths alone hardly find some of it.
    fn reference(&self, told: &mut impl FnMut(&str)) -> Result<(Method, bool), Error> {
        let path = if self.scene.has_media() { "volpath" } else { "path" };
        let mut found: Vec<Method> = Vec::new();
        // Pixels that share paths have errors that are not independent of each other.
        for (number, name) in [(0, &*format!("{path}:reuse=1,effort=even")), (u64::from(u16::MAX), "bdpt")] {
            let method = match self.method(name, number) {
                Ok(method) if method.render.integrator.limits(self.scene).is_empty() => method,
                Ok(_) => continue,
                Err(_) if number > 0 => continue,
                Err(refusal) => return Err(refusal),
            };
            told(&format!("{name} for reference"));
            let mut method = Method { wider: None, ..method };
            self.extend(&mut method, 1);
            found.push(method);
        }
        let has_caustics = found.iter().any(|m| m.picture.is_guided);
        let worth = |m: &Method| {
            let v = m.picture.values();
            // Not by the time that it takes: verdicts would depend on the machine.
            let error = v.blocks.iter().map(|b| b.variance).sum::<f64>();
            (m.lacks(self.scene).is_some(), !v.is_reliable, error)
        };
        found.sort_by(|a, b| worth(a).partial_cmp(&worth(b)).unwrap_or(std::cmp::Ordering::Equal));
        found.truncate(1);
        let none = || Error::CannotRender { integrator: path.to_owned(), what: "this scene".into() };
        Ok((found.pop().ok_or_else(none)?, has_caustics))
    }

    /// Compares a method with the reference, with more and more samples of both.
    fn decide(&self, mut method: Method, reference: &mut Method, unsure: Unsure) -> Comparison {
        let mut rounds = 1;
        let difference = loop {
            self.extend(&mut method, rounds);
            self.extend(reference, rounds);
            let found = compare(&method, reference, rounds);
            let is_cancelled = self.control.cancel.load(Ordering::Relaxed);
            let is_over = unsure.of_all || rounds >= BUDGET || is_cancelled;
            let needed = found.needed(rounds).filter(|_| rounds == BUDGET && !unsure.of_all && !is_cancelled);
            if let Some(needed) = needed {
                rounds = needed;
                continue;
            }
            // A difference may be that of rare light, which few samples do not find: it must remain.
            if is_over || matches!(found.verdict, Verdict::Agrees | Verdict::Converges) {
                let is_blind = unsure.of_paths && method.is_unguided();
                let is_unsure = unsure.of_all || is_blind && found.verdict == Verdict::Differs;
                break Difference { verdict: if is_unsure { Verdict::Undecided } else { found.verdict }, ..found };
            }
            rounds *= 2;
        };
        let seconds = method.picture.seconds + method.wider.map_or(0.0, |w| w.1.seconds);
        let spp = method.rounds.saturating_mul(method.render.plan.sampler.spp);
        let film = method.picture.film.unwrap_or_else(|| empty(self.scene));
        Comparison { difference, seconds, spp, film }
    }
}

/// Holds a method against the reference: by the smallest blocks whose errors are known, after some rounds.
fn compare(method: &Method, reference: &Method, rounds: u32) -> Difference {
    let [reference, ours] = [&reference.picture, &method.picture];
    let wider = method.wider.as_ref().map(|(_, picture)| picture);
    let finest = judge::compare(&reference.values(), &ours.values(), wider.map(Picture::values).as_ref());
    if finest.is_reliable || rounds < COARSE {
        return finest;
    }
    let coarser = |times: usize| {
        let wider = wider.and_then(|picture| picture.coarser(times));
        Some(judge::compare(&reference.coarser(times)?, &ours.coarser(times)?, wider.as_ref()))
    };
    [2, 4, 8].into_iter().map_while(coarser).find(|difference| difference.is_reliable).unwrap_or(finest)
}

/// The film of a render that was cancelled before it began.
fn empty(scene: &Scene) -> Film {
    let crop = scene.film().crop;
    Film { crop, pixels: Vec::new(), layers: Default::default(), halves: Vec::new(), bins: 0, bands: None }
}
