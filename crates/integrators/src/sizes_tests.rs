//! Frames of all sizes and crops at all offsets, by every integrator and every tactic of path tracers, splitting forced
//! upon them.

use crate::{
    Control, Depth, Film, METHODS, Method, PathEffort, Plan, Precomputed, Session, SharedPath, Stop, VarianceReduction,
    adaptive::CELL, path::PathTracer, precomputed::Splitting,
};
use std::sync::Arc;
use steradian_compile::{Options, compile};
use steradian_core::{
    ColorMode, Scene,
    film::{Crop, LayerInputs, Pixel},
    sampler::{Sampler, SamplerKind},
};
use steradian_engine::{Asked, GroupIntegrator, PixelSample, Tiles};
use steradian_math::{DVec3, Transform};
use steradian_request::{MethodRequest, Request};
use steradian_scene::{ColorSpace, Family, Format, Node, SceneDesc, Shape, SpectrumValue, Value};

/// A glass and a rough metal ball on a floor before a wall, under a small lamp and a dim sky; a light fog about one
/// ball.
fn scene(width: u32, height: u32) -> Scene {
    let grey = |v: f64| Value::Spectrum(SpectrumValue::Rgb([v; 3], ColorSpace::Srgb));
    let mut desc = SceneDesc { format: Format::Native, ..SceneDesc::default() };
    let film = Node::new(Family::Film, "rgb", None).with("width", i64::from(width)).with("height", i64::from(height));
    desc.film = Some(desc.add(film));
    let place = Transform::look_at(DVec3::new(0.0, 1.0, -4.0), DVec3::new(0.0, 0.7, 0.0), DVec3::Y).unwrap();
    desc.cameras =
        vec![desc.add(Node::new(Family::Camera, "perspective", None).with("fov", 50.0).with("to_world", place))];
    let material = |kind: &str| Node::new(Family::Material, kind, None);
    let shape = |kind: &str| Node::new(Family::Shape, kind, None);
    let sphere = |c: [f64; 3], r: f64| shape("sphere").with("center", c).with("radius", r);
    let plane = |n: [f64; 3], d: f64| shape("plane").with("normal", n).with("distance", -d);
    let parts = [
        (plane([0.0, 1.0, 0.0], 0.0), material("diffuse").with("reflectance", grey(0.6))),
        (plane([0.0, 0.0, -1.0], -2.0), material("diffuse").with("reflectance", grey(0.4))),
        (sphere([-0.6, 0.5, 0.0], 0.5), material("dielectric").with("eta", 1.5)),
        (sphere([0.6, 0.5, 0.3], 0.5), material("conductor").with("alpha_u", 0.3).with("alpha_v", 0.3)),
        (sphere([0.3, 2.2, -0.5], 0.1), material("diffuse").with("reflectance", grey(0.0))),
    ];
    let emission = desc.add(Node::new(Family::Light, "area", None).with("radiance", grey(60.0)));
    for (node, made_of) in parts {
        let (node, made_of) = (desc.add(node), desc.add(made_of));
        desc.shapes.push(Shape { material: Some(made_of), ..Shape::new(node) });
    }
    desc.shapes.last_mut().unwrap().emission = Some(emission);
    let sky = desc.add(Node::new(Family::Light, "environment", None).with("radiance", grey(0.1)));
    desc.lights.push(sky);
    compile(&desc, &Options { mode: Some(ColorMode::Rgb), spp: Some(1), ..Options::default() }).scene.unwrap()
}

/// Every tactic with every other.
fn variance_reduction() -> Vec<VarianceReduction> {
    let mut all = Vec::new();
    for reuse in [Some(1), Some(4), Some(16), None] {
        for caustics in [Some(false), Some(true)] {
            for effort in [Some(PathEffort::default()), None] {
                all.push(VarianceReduction { reuse, caustics, effort, guiding: Some(false) });
            }
        }
    }
    all
}

/// A method and its plan.
#[derive(Clone, Copy, Debug)]
struct Render {
    name: &'static str,
    variance_reduction: VarianceReduction,
    plan: Plan,
}

fn plan(name: &'static str, variance_reduction: VarianceReduction, spp: u32) -> Render {
    let sampler = Sampler { kind: SamplerKind::ZSobol, spp, seed: 0 };
    let plan = Plan { threads: 1, inputs: LayerInputs::FIRST_HITS, ..Plan::new(sampler) };
    Render { name, variance_reduction, plan }
}

impl Render {
    fn path<const MEDIA: bool>(self) -> SharedPath<MEDIA> {
        let depth = Depth { max: 6, roulette_after: 2, hide_emitters: false };
        SharedPath { path: PathTracer { depth }, variance_reduction: self.variance_reduction }
    }

    /// By a method other than path tracing, which has no tactics.
    fn other(self, scene: &Arc<Scene>) -> Box<dyn Session> {
        // Records are made for the whole frame: a few rays of each will do.
        let options = if self.name == "irradiance-cache" { "irradiance-cache:rays=16" } else { self.name };
        let options = MethodRequest::parse(options).unwrap();
        let asked = Asked { request: &Request { max_depth: Some(6), ..Request::default() }, options: &options, scene };
        let kind = METHODS.iter().find(|kind| kind.name == self.name).unwrap();
        (kind.new)(&asked).unwrap().session(Arc::clone(scene), self.plan).unwrap()
    }
}

/// A path tracer with more paths in squares of an edge than elsewhere.
#[derive(Debug)]
struct Uneven<const MEDIA: bool>(SharedPath<MEDIA>, u32);

impl<const MEDIA: bool> GroupIntegrator for Uneven<MEDIA> {
    type Prepared = Precomputed;
    type Buffer<'s> = <SharedPath<MEDIA> as GroupIntegrator>::Buffer<'s>;

    fn prepare(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Precomputed {
        let edge = self.1;
        let [columns, rows] = [scene.film().width, scene.film().height].map(|size| size.div_ceil(edge));
        let paths = (0..columns * rows).map(|k| 1 << (k % 3)).collect();
        let splitting = Splitting { paths, columns, edge };
        Precomputed { splitting, ..self.0.prepare(scene, plan, stop) }
    }

    fn works_unprepared(&self) -> bool {
        true
    }

    fn group<'s>(
        &self,
        scene: &'s Scene,
        precomputed: &Precomputed,
        pixel_samples: &mut [PixelSample],
        buffer: &mut Self::Buffer<'s>,
        counters: &mut crate::Counters,
    ) {
        self.0.group(scene, precomputed, pixel_samples, buffer, counters);
    }

    fn group_size(&self, precomputed: &Precomputed) -> u32 {
        self.0.group_size(precomputed)
    }

    fn paths(&self, precomputed: &Precomputed, pixel: [u32; 2]) -> u32 {
        self.0.paths(precomputed, pixel)
    }
}

/// All samples of a render, of path tracers with more paths in squares of an edge than elsewhere.
fn take(scene: &Scene, render: Render, edge: u32) -> Film {
    let scene = Arc::new(scene.clone());
    let mut session: Box<dyn Session> = match render.name {
        "path" => Box::new(Tiles::new(scene, Uneven(render.path::<false>(), edge), render.plan)),
        "volpath" => Box::new(Tiles::new(scene, Uneven(render.path::<true>(), edge), render.plan)),
        _ => render.other(&scene),
    };
    session.step(u32::MAX, &Control::default());
    assert!(session.is_done(), "{render:?}");
    session.film()
}

/// Sizes about those of cells and tiles, and some between; each with a partner that runs the other way.
fn sizes() -> impl Iterator<Item = [u32; 2]> {
    (1..=70).map(|k| [k, (k * 37) % 70 + 1])
}

#[test]
fn frames_of_every_size_are_whole() {
    let all = variance_reduction();
    for (k, [width, height]) in sizes().enumerate() {
        let scene = scene(width, height);
        // Every tactic is met by a few of the sizes, among which all remainders by the tile are, in both directions.
        let variance_reduction = all[k * 5 % all.len()];
        for (name, adaptive) in [("path", false), ("volpath", k % 2 == 0)] {
            let mut render = plan(name, variance_reduction, if adaptive { 6 } else { 2 });
            render.plan.adaptive = adaptive;
            let film = take(&scene, render, CELL << (k % 3));
            assert!(film.pixels.len() == (width * height) as usize && film.pixels.iter().all(|p| p.samples > 0));
        }
    }
}

/// Also by what the trials would do, which long renders have.
#[test]
fn trials_look_at_frames_of_every_size() {
    for [width, height] in [[1, 1], [1, 70], [70, 1], [17, 8], [24, 33], [33, 24], [7, 59], [50, 40]] {
        let scene = Arc::new(scene(width, height));
        for variance_reduction in variance_reduction().into_iter().filter(|t| t.effort.is_none()) {
            let render = plan("path", VarianceReduction { caustics: None, ..variance_reduction }, 1 << 21);
            let mut session = render.path::<false>().session(Arc::clone(&scene), render.plan).unwrap();
            session.step(1, &Control::default());
            assert!(session.film().pixels.iter().all(|p| p.samples == 1), "{width} x {height}");
        }
    }
}

/// A render of a crop is that part of the whole, bit for bit, wherever it begins.
#[test]
fn crops_at_odd_offsets_are_parts_of_the_whole() {
    let (width, height) = (41, 39);
    let scene = scene(width, height);
    for (k, name) in Family::Integrator.kinds().filter(|name| *name != "raster").enumerate() {
        let of_path = variance_reduction();
        let few = if name.contains("path") { &of_path[..] } else { &of_path[..1] };
        for (t, variance_reduction) in few.iter().enumerate() {
            let plan = plan(name, *variance_reduction, 2);
            let whole = take(&scene, plan, CELL);
            for at in 0..3 {
                let n = (7 * k + 5 * t + 11 * at) as u32;
                let (x0, y0) = (n % width, n * 13 % height);
                let (x1, y1) = ((x0 + 1 + n * 3 % 19).min(width), (y0 + 1 + n * 5 % 23).min(height));
                let cropped = Scene::clone(&scene).changed(|parts| parts.film.crop = Crop { x0, y0, x1, y1 });
                let part = take(&cropped, plan, CELL);
                for (i, p) in (0..).zip(&part.pixels) {
                    let [x, y] = [x0 + i % (x1 - x0), y0 + i / (x1 - x0)];
                    let q = &whole.pixels[(y * width + x) as usize];
                    let bits = |p: &Pixel| [p.sum, p.sum_squares].map(|v| v.map(f64::to_bits));
                    assert_eq!(
                        bits(p),
                        bits(q),
                        "{name} {variance_reduction:?} of {:?}, pixel {x}, {y}",
                        cropped.film().crop
                    );
                }
            }
        }
    }
}
