//! A rendering session: advances a film by samples, on any number of threads, with the same bits for any of them.
//!
//! The frame is cut into tiles, each owned by one thread at a time. A pixel's samples are added in the order of their index, whatever
//! the number of steps they come in, so sums do not depend on threads, tiles or steps.

use crate::{
    Counters, Integrator, IntegratorKind, dimension, features,
    partition::{Partition, Place, TILE},
    reuse::Seat,
    survey::Survey,
};
use std::{
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};
use steradian_core::{
    ColorMode, Scene, color,
    film::{Crop, FirstHit, FirstHitSums, Pixel},
    sampler::Sampler,
};
use steradian_math::{Spectrum, Vec2, spectra::Wavelengths};

/// What is to be rendered, and how.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The estimator.
    pub integrator: IntegratorKind,
    /// The random numbers; its `spp` is the number that a full render takes.
    pub sampler: Sampler,
    /// Threads; 0 for one per processor.
    pub threads: usize,
    /// Whether first hits are gathered for auxiliary layers.
    pub features: bool,
}

/// Shared with whoever watches a step: progress, and the wish to stop.
#[derive(Debug, Default)]
pub struct Control {
    /// Samples (of all pixels) taken so far.
    pub samples: AtomicU64,
    /// Rays traced so far.
    pub rays: AtomicU64,
    /// Set to stop at the next tile.
    pub cancel: AtomicBool,
}

/// The sums over a rectangle of pixels.
#[derive(Debug)]
struct Tile {
    area: Crop,
    pixels: Vec<Pixel>,
    features: Vec<FirstHitSums>,
    /// Samples each pixel has.
    done: u32,
}

/// The state of a film: what a session gives to be looked at or saved.
#[derive(Clone, Debug)]
pub struct Film {
    /// What of the full frame it shows.
    pub crop: Crop,
    /// Pixels by rows.
    pub pixels: Vec<Pixel>,
    /// First hits by rows; empty where they were not gathered.
    pub features: Vec<FirstHitSums>,
}

/// A render in progress.
#[derive(Debug)]
pub struct Session<'s> {
    scene: &'s Scene,
    plan: Plan,
    survey: Survey,
    tiles: Vec<Mutex<Tile>>,
    next: u32,
    counters: Counters,
    wall: Duration,
    cpu: Duration,
}

/// CPU time of all threads of this process.
fn cpu_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(t.tv_sec as u64, t.tv_nsec as u32)
}

impl<'s> Session<'s> {
    /// Starts with an empty film.
    pub fn new(scene: &'s Scene, plan: Plan) -> Self {
        let crop = scene.film.crop;
        let mut tiles = Vec::new();
        let aligned = |v: u32| v / TILE * TILE;
        for y in (aligned(crop.y0)..crop.y1).step_by(TILE as usize) {
            for x in (aligned(crop.x0)..crop.x1).step_by(TILE as usize) {
                let area = Crop {
                    x0: x.max(crop.x0),
                    y0: y.max(crop.y0),
                    x1: (x + TILE).min(crop.x1),
                    y1: (y + TILE).min(crop.y1),
                };
                let n = (area.width() * area.height()) as usize;
                tiles.push(Mutex::new(Tile {
                    area,
                    pixels: vec![Pixel::default(); n],
                    features: if plan.features { vec![FirstHitSums::default(); n] } else { Vec::new() },
                    done: 0,
                }));
            }
        }
        let (start, cpu) = (Instant::now(), cpu_time());
        let survey = plan.integrator.survey(scene);
        Self {
            scene,
            plan,
            survey,
            tiles,
            next: 0,
            counters: Counters::default(),
            wall: start.elapsed(),
            cpu: cpu_time().saturating_sub(cpu),
        }
    }

    /// Threads that a step uses.
    pub fn threads(&self) -> usize {
        match self.plan.threads {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get()),
            n => n,
        }
    }

    /// Takes further samples of every pixel, up to the plan's number; fewer where `control` cancels. Tiles that a cancelled step did
    /// not reach are caught up by the next one.
    pub fn step(&mut self, samples: u32, control: &Control) {
        self.next = self.next.saturating_add(samples).min(self.plan.sampler.spp);
        let (start, cpu) = (Instant::now(), cpu_time());
        let counters = match &self.plan.integrator {
            IntegratorKind::Path(i) => self.run(i, control),
            IntegratorKind::VolPath(i) => self.run(i, control),
            IntegratorKind::Whitted(i) => self.run(i, control),
            IntegratorKind::Raycast(i) => self.run(i, control),
            IntegratorKind::PathRecursive(i) => self.run(i, control),
            IntegratorKind::Stokes(i) => self.run(i, control),
        };
        self.counters += counters;
        self.wall += start.elapsed();
        self.cpu += cpu_time().saturating_sub(cpu);
    }

    /// Samples that a pixel has when the steps so far are complete.
    pub fn samples(&self) -> u32 {
        self.next
    }

    /// Whether the plan is carried out.
    pub fn is_done(&self) -> bool {
        self.next >= self.plan.sampler.spp
    }

    /// What was done so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Wall time spent in steps.
    pub fn wall(&self) -> Duration {
        self.wall
    }

    /// CPU time spent in steps.
    pub fn cpu(&self) -> Duration {
        self.cpu
    }

    /// The film as it is.
    pub fn film(&self) -> Film {
        let crop = self.scene.film.crop;
        let n = crop.width() as usize * crop.height() as usize;
        let mut film = Film {
            crop,
            pixels: vec![Pixel::default(); n],
            features: vec![FirstHitSums::default(); if self.plan.features { n } else { 0 }],
        };
        for tile in &self.tiles {
            let tile = lock(tile);
            let w = tile.area.width() as usize;
            for (row, y) in (tile.area.y0..tile.area.y1).enumerate() {
                let to = (y - crop.y0) as usize * crop.width() as usize + (tile.area.x0 - crop.x0) as usize;
                film.pixels[to..to + w].copy_from_slice(&tile.pixels[row * w..(row + 1) * w]);
                if self.plan.features {
                    film.features[to..to + w].copy_from_slice(&tile.features[row * w..(row + 1) * w]);
                }
            }
        }
        film
    }

    fn run<I: Integrator>(&self, integrator: &I, control: &Control) -> Counters {
        let next_tile = AtomicUsize::new(0);
        let total = Mutex::new(Counters::default());
        let work = || {
            let mut counters = Counters::default();
            while let Some(tile) = self.tiles.get(next_tile.fetch_add(1, Ordering::Relaxed)) {
                if control.cancel.load(Ordering::Relaxed) {
                    break;
                }
                let mut mine = Counters::default();
                self.render_tile(integrator, &mut lock(tile), &mut mine);
                control.samples.fetch_add(mine.samples, Ordering::Relaxed);
                control.rays.fetch_add(mine.rays, Ordering::Relaxed);
                counters += mine;
            }
            *lock(&total) += counters;
        };
        std::thread::scope(|scope| {
            for _ in 1..self.threads() {
                scope.spawn(work);
            }
            work();
        });
        total.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    fn render_tile<I: Integrator>(&self, integrator: &I, tile: &mut Tile, counters: &mut Counters) {
        let (scene, sampler) = (self.scene, &self.plan.sampler);
        let (film, area) = (&scene.film, tile.area);
        let corner = [area.x0 / TILE * TILE, area.y0 / TILE * TILE];
        let partition = Partition::new(corner, integrator.reuse(), sampler.seed);
        let in_area = |p: &Place| (area.x0..area.x1).contains(&p.x) && (area.y0..area.y1).contains(&p.y);
        let (mut places, mut seats, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for index in tile.done..self.next {
            for group in 0..partition.groups() {
                // Members beyond the crop take part, so that a crop has the bits of the whole.
                places.clear();
                places.extend(partition.places(group).filter(|p| p.x < film.width && p.y < film.height));
                if !places.iter().any(in_area) {
                    continue;
                }
                let common = partition.sampler(sampler, group, index, 0);
                seats.clear();
                weights.clear();
                for p in &places {
                    let own = sampler.pixel(p.x, p.y, index);
                    let (offset, weight) = film.filter.sample(own.get_2d(dimension::FILM));
                    let point = Vec2::new(p.x as f32 + 0.5, p.y as f32 + 0.5) + offset;
                    let lens =
                        if scene.camera.lens_radius > 0.0 { own.get_2d(dimension::LENS) } else { Vec2::splat(0.5) };
                    let ray = scene.camera.ray(film, point, lens);
                    let lambda = match scene.mode {
                        ColorMode::Rgb => Wavelengths::RGB,
                        ColorMode::Spectral => Wavelengths::sample_visible(common.get_1d(dimension::WAVELENGTH)),
                    };
                    let lambda = lambda.at_time(common.get_1d(dimension::TIME));
                    let joint = partition.sampler(sampler, group, index, p.rank);
                    seats.push(Seat { ray, own, joint, lambda, radiance: Spectrum::ZERO });
                    weights.push(weight);
                }
                match &mut seats[..] {
                    [s] => {
                        s.radiance = integrator.radiance(scene, &self.survey, s.ray, &s.own, &mut s.lambda, counters)
                    }
                    seats => integrator.group(scene, &self.survey, seats, counters),
                }
                for ((p, seat), weight) in places.iter().zip(&seats).zip(&weights).filter(|((p, _), _)| in_area(p)) {
                    let at = ((p.y - area.y0) * area.width() + p.x - area.x0) as usize;
                    let mut l = seat.radiance * film.imaging_ratio;
                    if film.max_component.is_finite() {
                        let m = l.max_element();
                        if m > film.max_component {
                            l *= film.max_component / m;
                        }
                    }
                    counters.samples += 1;
                    if !tile.pixels[at].add(color::to_rgb(l, &seat.lambda, scene.mode) * *weight) {
                        counters.nonfinite += 1;
                    }
                    if self.plan.features {
                        let hit: FirstHit = features::first_hit(scene, seat.ray, &seat.lambda);
                        tile.features[at].add(&hit);
                    }
                }
            }
        }
        tile.done = self.next;
    }
}

/// A thread that panicked leaves whole samples behind: the data is sound.
fn lock<T>(m: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    m.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
