//! Hybrid frames: what is seen by rasterisation; shadows, reflections, transparency, occlusion and one bounce of light
//! by rays through the ray-tracing pipeline, each a pass of a graph.

mod diagram;
mod filter;
mod frame;
mod graph;
mod surface;

use crate::{
    Error,
    draw_list::DrawList,
    options::{Options, Show},
    projection::Projected,
    rasterizer::{first_ray, place},
    shadow::Shadowing,
    world::World,
};
use filter::Filters;
use frame::Frame;
use graph::{Graph, Node, Resource};
use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};
use steradian_core::{
    Scene,
    film::{LayerInputs, PassFilm},
};
use steradian_engine::{Counters, History, Indivisible, Pass, Plan, Run};
use steradian_math::{Ray, Vec2, spectra::Wavelengths};
use steradian_transport::Depth;
use surface::Before;

/// Function of a pass of the graph.
type Step = fn(&mut Frame<'_>) -> Result<(), Error>;

/// The terms of the picture, with noise and without, and which are over albedo.
const TERMS: [(Resource, Resource, bool); 5] = [
    (Resource::Emission, Resource::Emission, false),
    (Resource::Direct, Resource::FilteredDirect, true),
    (Resource::Indirect, Resource::FilteredIndirect, true),
    (Resource::Reflections, Resource::FilteredReflections, false),
    (Resource::Transparency, Resource::FilteredTransparency, false),
];

const fn node(name: &'static str, reads: &'static [Resource], writes: &'static [Resource]) -> Node {
    Node { name, reads, writes }
}

/// All passes, with filters or without.
fn passes(filter: bool) -> Vec<(Node, Step)> {
    use Resource::{
        Direct, Emission, FilteredDirect, FilteredIndirect, FilteredOcclusion, FilteredReflections,
        FilteredTransparency, History, Indirect, Occlusion, Picture, Reflections, Surfaces, Transparency, Visibility,
    };
    const NOISY: [Resource; 6] = [Surfaces, Emission, Direct, Indirect, Reflections, Transparency];
    const LIGHT: [Resource; 4] = [FilteredDirect, FilteredIndirect, FilteredReflections, FilteredTransparency];
    // Declare every pass with its reads and writes; the graph derives the order and drops what nothing needs.
    let mut passes: Vec<(Node, Step)> = vec![
        (node("visibility buffer", &[], &[Visibility]), |frame| frame.rasterise()),
        (node("g-buffer", &[Visibility], &[Surfaces]), |frame| frame.gbuffer()),
        (node("emission", &[Surfaces], &[Emission]), |frame| frame.emission()),
        (node("direct light", &[Surfaces], &[Direct]), |frame| frame.direct()),
        (node("indirect light", &[Surfaces], &[Indirect]), |frame| frame.indirect()),
        (node("reflections", &[Surfaces], &[Reflections]), |frame| frame.reflections()),
        (node("transparency", &[Surfaces], &[Transparency]), |frame| frame.transparency()),
        (node("ambient occlusion", &[Surfaces], &[Occlusion]), |frame| frame.occlusion()),
    ];
    if filter {
        passes.extend([
            (
                node("filter light", &[Surfaces, Direct, Indirect, Reflections, Transparency, History], &LIGHT),
                (|frame| {
                    // Denoise all noisy terms of light together: they share reprojection and guides.
                    let terms: Vec<_> = TERMS[1..].iter().map(|(from, to, _)| (*from, *to)).collect();
                    frame.filter(&terms, |filters| &mut filters.light)
                }) as Step,
            ),
            (node("filter occlusion", &[Surfaces, Occlusion, History], &[FilteredOcclusion]), |frame| {
                frame.filter(&[(Occlusion, FilteredOcclusion)], |filters| &mut filters.occlusion)
            }),
            (
                node(
                    "composite",
                    &[Surfaces, Emission, FilteredDirect, FilteredIndirect, FilteredReflections, FilteredTransparency],
                    &[Picture],
                ),
                |frame| frame.composite(&TERMS.map(|(_, filtered, over_albedo)| (filtered, over_albedo))),
            ),
        ]);
    } else {
        passes.push((node("composite", &NOISY, &[Picture]), |frame| {
            frame.composite(&TERMS.map(|(noisy, _, over_albedo)| (noisy, over_albedo)))
        }));
    }
    passes
}

/// LayerInputs of a frame.
struct Setting<'a> {
    run: &'a Run<'a>,
    list: &'a DrawList,
    world: &'a World,
    pool: &'a rayon::ThreadPool,
    options: &'a Options,
    depth: &'a Depth,
    shadows: &'a Shadowing,
    before: Option<&'a Before>,
    /// Which of the passes over the picture this is.
    number: u32,
}

/// Made before the first pass.
#[derive(Debug)]
struct Prepared {
    list: DrawList,
    world: World,
    shadows: Shadowing,
    pool: rayon::ThreadPool,
}

/// A render of hybrid frames.
#[derive(Debug)]
pub struct Hybrid {
    options: Options,
    depth: Depth,
    prepared: Option<Prepared>,
    before: Option<Arc<Before>>,
    /// Projection and denoisers of the last pass over the picture, kept for the next frame.
    after: Mutex<Option<(Projected, Filters)>>,
    /// Times of each pass of the graph, in all passes over the picture.
    times: Mutex<Vec<(&'static str, Duration)>>,
    failure: Mutex<Option<String>>,
}

impl Hybrid {
    /// Draws hybrid frames of a scene as the options say.
    ///
    /// # Errors
    /// Cameras that have no projection to a plane, and layers that these frames do not have.
    pub fn new(scene: &Scene, options: Options, depth: Depth, plan: &Plan) -> Result<Self, Error> {
        Projected::new(scene, Vec2::splat(0.5))?;
        if plan.has(LayerInputs::LIGHT_GROUPS) {
            return Err(Error::Option("raster:frame=hybrid does not tell groups of lights apart".into()));
        }
        let (after, times, failure) = Default::default();
        Ok(Self { options, depth, prepared: None, before: None, after, times, failure })
    }

    fn draw(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Result<Option<Counters>, Error> {
        let Some(Prepared { list, world, shadows, pool }) = &self.prepared else { return Ok(None) };
        let (offset, weight) = place(run.scene.film(), number);
        // One sample alone is the whole pixel.
        let weight = if run.sampler.spp > 1 { weight } else { 1.0 };
        let (options, depth, before) = (&self.options, &self.depth, self.before.as_deref());
        let setting = Setting { run, list, world, pool, options, depth, shadows, before, number };
        // Each pass goes on from the frame before: it does not matter which others there were.
        let filters = before.map_or_else(Filters::new, |before| Ok(before.filters.clone()))?;
        let projected = Projected::new(run.scene, offset)?.hiding_emitters(depth.hide_emitters);
        let mut frame = Frame::new(&setting, projected, filters);
        let crop = run.scene.film().crop;
        let passes = passes(options.filter);
        let shown = shown(options.show, options.filter);
        let picture = if options.show == Show::Graph {
            // The diagram shows all passes, those of the occlusion view too.
            let ends = [Resource::Picture, self::shown(Show::Occlusion, options.filter)];
            diagram::draw(&graph(&passes, &ends)?, [crop.width(), crop.height()])
        } else {
            // The graph keeps the passes that the shown resource depends on, in an order of their dependencies.
            for pass in graph(&passes, &[shown])?.passes() {
                let start = Instant::now();
                if let Some((_, step)) = passes.iter().find(|(node, _)| node.name == pass.name) {
                    step(&mut frame)?;
                }
                self.note(pass.name, start.elapsed());
            }
            frame.picture(shown)
        };
        // Accumulate the picture with the weight of the pixel filter.
        for (at, value) in picture.iter().enumerate() {
            let (x, y) = (crop.x0 + at as u32 % crop.width(), crop.y0 + at as u32 / crop.width());
            film.add(x, y, *value * weight);
        }
        // Leave projection and histories to the next frame.
        *lock(&self.after) = Some((frame.projected, frame.filters));
        let mut counters = frame.counters;
        counters.samples = picture.len() as u64;
        Ok(Some(counters))
    }

    fn note(&self, pass: &'static str, time: Duration) {
        let mut times = lock(&self.times);
        match times.iter_mut().find(|(name, _)| *name == pass) {
            Some((_, sum)) => *sum += time,
            None => times.push((pass, time)),
        }
    }

    fn fail(&self, why: String) {
        *lock(&self.failure) = Some(why);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The passes that some results need.
fn graph(passes: &[(Node, Step)], wanted: &[Resource]) -> Result<Graph, Error> {
    let nodes: Vec<Node> = passes.iter().map(|(node, _)| *node).collect();
    Graph::new(&nodes, &[Resource::History], wanted).map_err(|fault| Error::Scene(fault.to_string()))
}

/// Resource that is shown, with noise or without.
fn shown(show: Show, filter: bool) -> Resource {
    let (noisy, filtered) = match show {
        Show::Emission => (Resource::Emission, Resource::Emission),
        Show::Direct => (Resource::Direct, Resource::FilteredDirect),
        Show::Indirect => (Resource::Indirect, Resource::FilteredIndirect),
        Show::Reflections => (Resource::Reflections, Resource::FilteredReflections),
        Show::Transparency => (Resource::Transparency, Resource::FilteredTransparency),
        Show::Occlusion => (Resource::Occlusion, Resource::FilteredOcclusion),
        _ => (Resource::Picture, Resource::Picture),
    };
    if filter { filtered } else { noisy }
}

impl Pass for Hybrid {
    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        let prepare = || -> Result<Prepared, Error> {
            // A pool of the render's threads, structures for rays, and the draw list are made once.
            let pool = rayon::ThreadPoolBuilder::new().num_threads(run.threads).build();
            let pool = pool.map_err(|e| Error::Scene(format!("the system gives no threads: {e}")))?;
            let list = DrawList::new(run.scene);
            let world = pool.install(|| World::new(run.scene, &list))?;
            Ok(Prepared { list, world, shadows: Shadowing::by_rays(false), pool })
        };
        match prepare() {
            Ok(prepared) => self.prepared = Some(prepared),
            Err(e) => self.fail(e.to_string()),
        }
        self.prepared.is_some().then_some(())
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        self.draw(run, number, film).unwrap_or_else(|e| {
            if e != Error::Cancelled {
                self.fail(e.to_string());
            }
            None
        })
    }

    fn first_ray(&self, run: &Run<'_>, pixel: [u32; 2], number: u32) -> (Ray, Wavelengths) {
        first_ray(run.scene, pixel, number)
    }

    fn notes(&self) -> Vec<String> {
        let times = lock(&self.times);
        let of = |(name, time): &(&str, Duration)| format!("{name} {:.1} ms", time.as_secs_f64() * 1e3);
        let all: Vec<String> = times.iter().map(of).collect();
        if all.is_empty() { Vec::new() } else { vec![format!("passes: {}", all.join(", "))] }
    }

    fn take_history(&mut self, scene: &Arc<Scene>) -> Option<History> {
        let (projected, filters) = lock(&self.after).take()?;
        Some(History(Arc::new(Before { scene: Arc::clone(scene), projected, filters })))
    }

    fn indivisible(&self) -> Option<Indivisible> {
        Some(Indivisible::Follows)
    }

    fn follow(&mut self, History(before): &History) {
        self.before = Arc::clone(before).downcast().ok();
    }

    fn failure(&self) -> Option<String> {
        lock(&self.failure).clone()
    }
}
