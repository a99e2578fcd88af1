//! Path tracing in recursive form: what arrives along a ray is (1) what the point shines, or (2) the background, and from
//! the point (3) what lights send it and (4) what one random direction brings. The sum is carried along, so that it has
//! the bits of `path`, which a test compares:
//! `cargo run --release -p steradian --example path_recursive -- scenes/showcase.pbrt recursive.exr`

use std::{error::Error, io::Write, path::Path, sync::Arc};
use steradian::engine::{Integrator, PathContext, PerPixel, Session, dimension};
use steradian::math::{Ray, Spectrum};
use steradian::transport::{Depth, MAX_PASSES, NoGuide, PathState, Vertex, nee};
use steradian::{Quality, image};

/// Recursion goes no deeper than this, whatever the scene asks for: the stack is finite.
const DEEPEST: u32 = 256;

/// The recursive path tracer.
#[derive(Debug)]
pub(crate) struct Recursive(pub Depth);

impl Recursive {
    /// Adds to `sum` what arrives along a ray.
    fn arriving(&self, path_state: PathState, mut sum: Spectrum, context: &mut PathContext<'_, '_>) -> Spectrum {
        let PathContext { scene, sampler, lambda, counters } = &mut *context;
        let PathState { ray, events, passes, .. } = path_state;
        if counters.stop.is_asked() {
            return sum;
        }
        counters.rays += 1;
        let is_hidden = events == 0 && self.0.hide_emitters;
        // (2) Nothing is met: the background.
        let Some(hit) = scene.intersect(&ray) else {
            if !is_hidden {
                sum += path_state.beta * nee::background(scene, ray.origin, ray.direction, &path_state.origin, lambda);
            }
            return sum;
        };
        // (1) What is met shines.
        let i = scene.interaction_of_light(&ray, &hit);
        if !is_hidden {
            sum += path_state.beta * nee::emission(scene, &i, &path_state.origin, lambda);
        }
        // The path is long enough, unless the surface lets it through; camera rays pass hidden lights.
        let passes_straight = self.0.hides(scene, i.geometry, events);
        let is_last = events >= self.0.max.min(DEEPEST);
        if is_last && !scene.is_see_through() && !passes_straight {
            return sum;
        }
        let surface = if passes_straight {
            None
        } else {
            let choice = sampler.get_1d_lazily(path_state.dimension(dimension::MIXTURE), scene.has_mixtures());
            scene.scattering_along(&i, path_state.differential.as_ref(), choice, lambda)
        };
        match surface {
            Some(_) if is_last => sum,
            Some((scattering, frame)) => {
                let vertex = Vertex::Surface { i, scattering, frame, medium: None };
                self.leaving(&vertex, path_state, sum, context)
            }
            None if passes >= MAX_PASSES.min(DEEPEST) => sum,
            None => {
                let differential = path_state.differential.map(|d| d.advance(i.t));
                let next = PathState { ray: i.spawn(ray.direction), passes: passes + 1, differential, ..path_state };
                self.arriving(next, sum, context)
            }
        }
    }

    /// Adds to `sum` what is scattered at a vertex.
    fn leaving(
        &self,
        vertex: &Vertex<'_>,
        mut path_state: PathState,
        sum: Spectrum,
        context: &mut PathContext<'_, '_>,
    ) -> Spectrum {
        // (3) Light straight from a light.
        let sum = sum + path_state.direct::<false>(vertex, context);
        // (4) One direction, unless roulette ends the path.
        let Some(s) = path_state.sample(vertex, context.sampler, None::<&NoGuide>) else { return sum };
        path_state.turn::<false>(context.scene, vertex, &s);
        if !path_state.beta.is_finite() {
            return path_state.beta;
        }
        if path_state.survives(&self.0, context) { self.arriving(path_state, sum, context) } else { sum }
    }
}

impl Integrator for Recursive {
    type Prepared = ();
    fn radiance(&self, (): &(), ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        self.arriving(PathState::camera(context.scene, ray), Spectrum::ZERO, context)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let [file, output] = &names[..] else { return Err("usage: path_recursive SCENE OUT.exr".into()) };
    let (scene, messages) = steradian::open(file)?;
    messages.iter().try_for_each(|message| writeln!(std::io::stderr(), "{message}"))?;
    let quality = Quality { spp: Some(64), ..Quality::default() };
    let depth =
        Depth { max: scene.settings().max_depth, roulette_after: scene.settings().rr_depth, hide_emitters: false };
    let mut session = PerPixel::per_pixel(Arc::clone(&scene), Recursive(depth), quality.render(&scene)?.plan);
    session.step(u32::MAX, &Default::default());
    let picture = steradian::develop(&scene, &session.film(), &[]);
    Ok(image::write(Path::new(output), &picture, &Default::default())?)
}
