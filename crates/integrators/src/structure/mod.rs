//! Pictures of the acceleration structure itself: the steps of the ray of each pixel, the boxes of a level, and the
//! cells (leaves) that visible points lie in. Surfaces are lit from the camera, `0.1 + 0.9 |cos θ|`.

mod boxes;
mod colors;
mod rebuilt;

use crate::support;
use boxes::Boxes;
use std::sync::Arc;
use steradian_accel::{Accelerator, Hit, Steps};
use steradian_core::{Scene, film::PassFilm, scene::Interaction};
use steradian_engine::{
    Asked, Counters, Feature, Method, MethodKind, Pass, Passes, Plan, Refusal, Run, Session,
    Support::{self, Approximates, LeavesOut, Refuses},
};
use steradian_math::{Ray, Vec2, Vec3, spectra::Wavelengths};
use steradian_request::MethodRequest;

/// Pictures of the acceleration structure.
#[derive(Clone, Copy, Debug)]
pub struct Structure {
    accelerator: Option<Accelerator>,
    show: Show,
}

/// Subject of the picture.
#[derive(Clone, Copy, Debug)]
enum Show {
    /// Nodes visited and primitives tested, on a scale from zero to this number.
    Steps(u32),
    /// Boxes of a level.
    Boxes(u32),
    /// Leaves of visible points.
    Cells,
}

/// `structure`.
pub const STRUCTURE: MethodKind = MethodKind { check, ..MethodKind::new("structure", new) };

fn new(asked: &Asked<'_>) -> Result<Arc<dyn Method>, Refusal> {
    let options = asked.options;
    let show = match options.word("show") {
        "boxes" => Show::Boxes(options.count("level")),
        "cells" => Show::Cells,
        _ => Show::Steps(options.count("most")),
    };
    let given = options.given("structure").is_some();
    let accelerator = given.then(|| Accelerator::by_name(options.word("structure"))).flatten();
    Ok(Arc::new(Structure { accelerator, show }))
}

/// Refuses options of another view than the one that is shown, and boxes of a BSP.
fn check(options: &MethodRequest) -> Result<(), Refusal> {
    let shown = options.word("show");
    for (name, view) in [("most", "steps"), ("level", "boxes")] {
        if options.given(name).is_some() && shown != view {
            return Err(Refusal(format!("option '{name}' is of show={view}, not of show={shown}")));
        }
    }
    match options.word("structure") {
        "bsp" if shown == "boxes" => Err(Refusal(boxes::NO_BOXES.into())),
        _ => Ok(()),
    }
}

impl Method for Structure {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::Motion | Feature::MovingCamera => Approximates("it is shown as the shutter opens"),
            Feature::Polarization => Support::Exact,
            Feature::ShadowCatchers => LeavesOut(""),
            Feature::Transparency => Refuses(""),
            Feature::Denoising => Refuses("it has no noise"),
            Feature::LightGroups | Feature::Bounces => Refuses("it shows no light"),
            Feature::Bands => LeavesOut("it shows no light"),
            Feature::Adaptivity => Refuses("it makes whole pictures pass by pass"),
            _ => support::of_camera_rays(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        let scene = match self.accelerator {
            Some(accelerator) => Arc::new(rebuilt::scene(&scene, accelerator)?),
            None => scene,
        };
        let view = match self.show {
            Show::Steps(most) => View::Steps { most, seen: Seen::default() },
            Show::Boxes(level) => View::Boxes(Boxes::new(scene.accel(), level)?),
            Show::Cells => View::Cells,
        };
        Ok(Box::new(Passes::new(scene, view, plan)))
    }

    fn default_spp(&self, _of_scene: u32) -> u32 {
        1
    }
}

/// Pictures under way.
#[derive(Debug)]
enum View {
    Steps { most: u32, seen: Seen },
    Boxes(Boxes),
    Cells,
}

/// Cost of the rays through the centres of all pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Seen {
    rays: u64,
    sum: Steps,
    /// Largest sum of steps and tests.
    most: u64,
}

impl Seen {
    fn plus(self, other: Self) -> Self {
        let sum = Steps { steps: self.sum.steps + other.sum.steps, tests: self.sum.tests + other.sum.tests };
        Self { rays: self.rays + other.rays, sum, most: self.most.max(other.most) }
    }
}

/// Ray through a point of the film, in pixels, at the moment when the shutter opens.
fn ray_at(scene: &Scene, at: Vec2) -> Ray {
    scene.camera().ray(scene.film(), at, Vec2::splat(0.5))
}

/// Point of a pixel at which a pass looks, and its weight: the centre first, then as the filter is spread.
fn place(run: &Run<'_>, [x, y]: [u32; 2], number: u32) -> (Vec2, f32) {
    if number == 0 {
        return (Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 1.0);
    }
    let sample = run.camera_sample(x, y, number);
    (sample.at, sample.weight)
}

impl View {
    /// Linear colour of a point of the film.
    fn color(&self, scene: &Scene, at: Vec2) -> Vec3 {
        let ray = ray_at(scene, at);
        if let Self::Steps { most, .. } = self {
            let Steps { steps, tests } = scene.intersect_cost(&ray);
            return colors::heat((steps + tests) as f32 / *most as f32);
        }
        let hit = scene.intersect(&ray);
        let surface = hit.map(|hit| (hit, scene.interaction(&ray, &hit)));
        let lit = surface.as_ref().map_or(0.0, |(_, i)| 0.1 + 0.9 * i.surface.ns.dot(i.wo).abs());
        match self {
            Self::Boxes(boxes) => {
                let next = ray_at(scene, at + Vec2::X);
                boxes.before(&ray, &next, hit.map_or(f32::INFINITY, |hit| hit.t), Vec3::splat(lit * 0.6))
            }
            _ => {
                let cell = surface.and_then(|(hit, i)| cell(scene, &hit, &i).map(|cell| (hit.id.instance, cell)));
                cell.map_or(Vec3::splat(0.5), |(instance, cell)| colors::number(instance, cell)) * lit
            }
        }
    }
}

/// Number of the leaf that a visible point lies in; `None` on infinite planes, which no structure holds.
fn cell(scene: &Scene, hit: &Hit, i: &Interaction) -> Option<u32> {
    if scene.planes().contains(&i.geometry) {
        return None;
    }
    let (mut p, mut towards) = (i.surface.p, i.wo);
    if let Some(place) = scene.place(hit.id, i.time) {
        let inverse = place.inverse();
        (p, towards) = (inverse.point(p), inverse.vector(towards));
    }
    scene.accel().cell(hit.id, p, towards)
}

impl Pass for View {
    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        let Self::Steps { seen, .. } = self else { return Some(()) };
        let crop = run.scene.film().crop;
        let (rows, _) = run.in_order(crop.height() as usize, |row, _| {
            let of_pixel = |x| {
                let sum = run.scene.intersect_cost(&ray_at(run.scene, place(run, [x, crop.y0 + row as u32], 0).0));
                Seen { rays: 1, sum, most: sum.steps + sum.tests }
            };
            (crop.x0..crop.x1).map(of_pixel).fold(Seen::default(), Seen::plus)
        })?;
        *seen = rows.into_iter().fold(Seen::default(), Seen::plus);
        Some(())
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let crop = film.crop();
        let (rows, counters) = run.in_order(crop.height() as usize, |row, counters| {
            let pixel = |x| {
                counters.samples += 1;
                counters.rays += 1;
                let (at, weight) = place(run, [x, crop.y0 + row as u32], number);
                self.color(run.scene, at) * weight
            };
            (crop.x0..crop.x1).take_while(|_| !run.is_cancelled()).map(pixel).collect::<Vec<_>>()
        })?;
        film.add_rows(&rows);
        Some(counters)
    }

    fn first_ray(&self, run: &Run<'_>, pixel: [u32; 2], number: u32) -> (Ray, Wavelengths) {
        (ray_at(run.scene, place(run, pixel, number).0), run.scene.mode().wavelengths(|| 0.5))
    }

    fn notes(&self) -> Vec<String> {
        match self {
            Self::Steps { most, seen } if seen.rays > 0 => {
                let mean = |sum: u64| sum as f64 / seen.rays as f64;
                let Steps { steps, tests } = seen.sum;
                vec![format!(
                    "a ray visits {:.2} nodes and tests {:.2} primitives on average, {} together at most; \
                     the colours end at {most}",
                    mean(steps),
                    mean(tests),
                    seen.most
                )]
            }
            Self::Boxes(boxes) => vec![format!("level {} has {} boxes", boxes.level, boxes.len())],
            _ => Vec::new(),
        }
    }
}
