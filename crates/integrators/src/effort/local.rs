//! Effort by vertex: efficiency-aware Russian roulette and splitting.
//!
//! A path reaches a vertex with the weight `w`, what it carries over the brightness of its pixel. What a path brings
//! from there has the second moment `M`, the variance `V` and the cost `C`, in rays. If on average `q` paths go on,
//! they contribute `w² M/q` to the squares of a sample (`w² V/q` where `q > 1`) and `q C` to its cost; the product of
//! the sample's variance `V₀` and cost `C₀` is least with
//!
//! `q = w √(M/C) √(C₀/V₀)` if that is less than one, `q = w √(V/C) √(C₀/V₀)` if that is more, else `q = 1`
//!
//! (Rath, Grittmann, Herholz, Weier, Slusallek 2022, "EARS: Efficiency-Aware Russian Roulette and Splitting", ACM TOG
//! 41(4), sec. 4). Paths that are no part of the picture tell `M`, `V` and `C` beforehand, in cells by position and
//! normal. These decide about how much samples err, not about their mean: a number of paths whose mean is `q` goes on
//! with `1/q` of the weight each. Light that the paths of a group share is weighed as if it counted alike for all of
//! them.
//!
//! Roulette by throughput, with a threshold for the whole picture, and several paths by parts of the picture have been
//! the better choice in each scene that was measured (`docs/benchmarks.md`): this is done on request only.

use super::{Cost, cost};
use crate::{
    Counters,
    adaptive::FLOOR,
    dimension, live_max,
    precomputed::Precomputed,
    reuse::PathContinuation,
    walk::{Arrival, LONG_PATH, PathState, Vertex, arrive},
};
use rayon::prelude::*;
use steradian_core::{
    Scene,
    sampler::{PixelSampler, Sampler, SamplerKind},
};
use steradian_math::{Bounds3, Spectrum, Vec2, Vec3, spectra::Wavelengths};

/// Paths that explore the scene.
const PATHS: u32 = 1 << 12;
/// Cells along the longest edge of the scene, from fine to coarse; of the last there is one for all normals.
const CELLS: [f32; 3] = [32.0, 8.0, 1.0];
/// Visits of a cell that tell enough.
const ENOUGH: usize = 32;
/// What is brighter than this many times the mean counts as just so bright: a few paths cannot tell how often it is
/// met.
const BRIGHTEST: f64 = 100.0;
/// Least probability that a path goes on.
const LEAST: f32 = 0.05;
/// Most paths that go on, of which the one is taken with which a picture's samples have the least variance × cost.
const MOST: [f32; 3] = [1.0, 2.0, 8.0];
/// Paths split at so many events at most: each split takes room on the stack.
const SPLITS: u32 = 16;

/// What is known of the vertices of paths.
#[derive(Clone, Debug)]
pub(crate) struct Local {
    grid: Grid,
    /// By cell, sorted.
    cells: Vec<(u64, Cell)>,
    /// `√(C₀/V₀)`.
    unit: f32,
    /// Most paths that go on.
    most: f32,
}

/// What paths bring from a cell.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Mean luminance, as the film sees it.
    mean: f32,
    /// `√(M/C)`.
    by_square: f32,
    /// `√(V/C)`.
    by_variance: f32,
}

/// How cells are numbered.
#[derive(Clone, Copy, Debug)]
struct Grid {
    corner: Vec3,
    edge: f32,
}

impl Grid {
    fn new(bounds: &Bounds3) -> Self {
        Self { corner: bounds.min, edge: (bounds.max - bounds.min).max_element().max(f32::MIN_POSITIVE) }
    }

    /// The cell of a vertex on a level.
    fn key(&self, v: &Vertex<'_>, level: usize) -> u64 {
        let top = (level as u64) << 60;
        if level + 1 == CELLS.len() {
            return top;
        }
        let place = (v.p() - self.corner) / self.edge * CELLS[level];
        // Casts take what is not a number for zero.
        let place = place.to_array().map(|x| u64::from(x as u16));
        top | side(v) << 48 | place[0] << 32 | place[1] << 16 | place[2]
    }
}

/// Which way a surface faces, by the axis that its normal is nearest to.
fn side(v: &Vertex<'_>) -> u64 {
    let Vertex::Surface { i, .. } = v else { return 6 };
    let n = if i.surface.ns.dot(i.wo) < 0.0 { -i.surface.ns } else { i.surface.ns };
    let axis = n.abs().max_position();
    2 * axis as u64 + u64::from(n[axis] < 0.0)
}

/// What two paths brought from a vertex.
#[derive(Clone, Copy)]
struct Visit {
    /// The cells of the vertex.
    keys: [u64; CELLS.len()],
    /// Luminances, as the film sees them.
    light: [f64; 2],
    /// Rays of both.
    rays: f64,
}

impl Local {
    /// What paths tell; `None` where they find nothing.
    pub fn explore<const MEDIA: bool, S: PathContinuation<MEDIA>>(
        continuation: &S,
        scene: &Scene,
        precomputed: &Precomputed,
    ) -> Option<Self> {
        let grid = Grid::new(&scene.bounds());
        let sampler = Sampler { kind: SamplerKind::Sobol, spp: PATHS, seed: 3 };
        let visits: Vec<Vec<Visit>> = (0..PATHS)
            .into_par_iter()
            .map(|k| trace(continuation, scene, precomputed, &grid, &sampler.pixel(0, 0, k)))
            .collect();
        let visits = || visits.iter().flatten();
        let count = visits().count().max(1) as f64;
        let most = BRIGHTEST * visits().map(|v| 0.5 * (v.light[0] + v.light[1])).sum::<f64>() / count;
        let mut by_cell: Vec<(u64, Visit)> = visits()
            .flat_map(|v| v.keys.map(|key| (key, Visit { light: v.light.map(|light| light.min(most)), ..*v })))
            .collect();
        by_cell.sort_by_key(|&(key, _)| key);
        let last = (CELLS.len() as u64 - 1) << 60;
        let cells: Vec<(u64, Cell)> = by_cell
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|visits| visits.len() >= ENOUGH || visits[0].0 == last)
            .map(|visits| (visits[0].0, Cell::of(visits)))
            .collect();
        let is_lit = cells.iter().any(|(_, cell)| cell.mean > 0.0);
        let Cost { variance, rays } = cost(continuation, scene, precomputed);
        let unit = (rays / variance).sqrt() as f32;
        if !(is_lit && unit.is_finite()) {
            return None;
        }
        let local = Self { grid, cells, unit, most: 1.0 };
        let tried = MOST.map(|most| Self { most, ..local.clone() }).map(|local| {
            let Cost { variance, rays } =
                cost(continuation, scene, &Precomputed { local: Some(local.clone()), ..precomputed.clone() });
            (variance * rays, local)
        });
        tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, local)| local)
    }

    /// What is known of a vertex.
    fn cell(&self, v: &Vertex<'_>) -> Option<&Cell> {
        (0..CELLS.len()).find_map(|level| {
            let key = self.grid.key(v, level);
            let place = self.cells.binary_search_by_key(&key, |&(key, _)| key).ok()?;
            Some(&self.cells[place].1)
        })
    }

    /// Weighs a path from the camera at its first vertex, by the brightness of the pixel that this lets expect.
    fn weigh(&self, v: &Vertex<'_>, path_state: &mut PathState, lambda: &Wavelengths) {
        let mean = self.cell(v).map_or(0.0, |cell| cell.mean) * live_max(path_state.beta, lambda);
        path_state.for_roulette /= (mean * mean + FLOOR as f32).sqrt();
    }

    /// How many paths go on from a vertex where a weighed path arrived, which then carries the part of each.
    fn branches(
        &self,
        v: &Vertex<'_>,
        path_state: &mut PathState,
        sampler: &PixelSampler,
        lambda: &Wavelengths,
    ) -> u32 {
        // Finite, so that times zero it is zero.
        let weight = (live_max(path_state.beta, lambda) * path_state.for_roulette * self.unit).min(f32::MAX);
        let mut q = self.cell(v).map_or(1.0, |cell| cell.factor(weight, self.most));
        if path_state.events >= SPLITS {
            q = q.min(1.0);
        }
        if path_state.events > LONG_PATH.0 {
            q = q.min(LONG_PATH.1);
        }
        // Chance in how many go on would count for as much as all they bring: it decides only where there may be none.
        let count = if q < 1.0 {
            u32::from(sampler.get_1d(dimension::at(path_state.events, dimension::BRANCHES)) < q)
        } else {
            q as u32
        };
        path_state.beta *= 1.0 / q;
        count
    }
}

impl PathState {
    /// Weighs it at its first vertex, where effort is spent by vertex.
    #[inline]
    pub fn weigh(&mut self, v: &Vertex<'_>, precomputed: &Precomputed, lambda: &Wavelengths) {
        if let Some(local) = &precomputed.local {
            local.weigh(v, self, lambda);
        }
    }

    /// How many paths go on where it arrived, of which each carries what it does then.
    #[inline]
    pub fn branches(
        &mut self,
        v: &Vertex<'_>,
        precomputed: &Precomputed,
        sampler: &PixelSampler,
        lambda: &Wavelengths,
    ) -> u32 {
        precomputed.local.as_ref().map_or(1, |local| local.branches(v, self, sampler, lambda))
    }
}

impl Cell {
    /// By the visits of its vertices.
    fn of(visits: &[(u64, Visit)]) -> Self {
        let mean = |of: &dyn Fn(&Visit) -> f64| visits.iter().map(|(_, v)| of(v)).sum::<f64>() / visits.len() as f64;
        let rays = mean(&|v| 0.5 * v.rays).max(1.0);
        let square = mean(&|v| 0.5 * (v.light[0] * v.light[0] + v.light[1] * v.light[1]));
        let variance = mean(&|v| 0.5 * (v.light[0] - v.light[1]).powi(2));
        Self {
            mean: mean(&|v| 0.5 * (v.light[0] + v.light[1])) as f32,
            by_square: (square / rays).sqrt() as f32,
            by_variance: (variance / rays).sqrt() as f32,
        }
    }

    /// The number of paths that pays for a weight, which is given times `√(C₀/V₀)`.
    fn factor(&self, weight: f32, most: f32) -> f32 {
        if weight * self.by_square < 1.0 {
            (weight * self.by_square).max(LEAST)
        } else {
            (weight * self.by_variance).clamp(1.0, most).round()
        }
    }
}

/// Follows a path from anywhere on the film, and two more from each of its vertices.
fn trace<const MEDIA: bool, S: PathContinuation<MEDIA>>(
    continuation: &S,
    scene: &Scene,
    precomputed: &Precomputed,
    grid: &Grid,
    sampler: &PixelSampler,
) -> Vec<Visit> {
    let (film, depth) = (&scene.film, continuation.depth());
    let mut lambda = scene.mode.wavelengths(|| sampler.get_1d(dimension::WAVELENGTH));
    if scene.is_timed {
        lambda = lambda.at_time(sampler.get_1d(dimension::TIME));
    }
    let place = sampler.get_2d(dimension::FILM) * Vec2::new(film.width as f32, film.height as f32);
    let mut path_state =
        PathState::camera(scene, scene.camera.ray_at(film, place, sampler.get_2d(dimension::LENS), lambda.time));
    let (mut visits, mut next) = (Vec::new(), Arrival::End);
    let counters = &mut Counters::until(&precomputed.stop);
    loop {
        let mut sum = Spectrum::ZERO;
        arrive::<MEDIA>(scene, &mut path_state, &mut sum, depth, sampler, &mut lambda, counters, &mut next);
        let Arrival::Vertex(v) = &next else { return visits };
        let before = counters.rays;
        let light = [0, 1].map(|k| {
            let (mut lambda, path_state) = (lambda, PathState { beta: Spectrum::ONE, for_roulette: 1.0, ..path_state });
            let light = continuation.leaving(
                scene,
                precomputed,
                v,
                path_state,
                &sampler.branch(path_state.events, k),
                &mut lambda,
                counters,
            );
            f64::from(scene.mode.luminance(light, &lambda) * film.imaging_ratio)
        });
        if light.iter().all(|light| light.is_finite()) {
            let keys = std::array::from_fn(|level| grid.key(v, level));
            visits.push(Visit { keys, light, rays: (counters.rays - before) as f64 });
        }
        let Some(draw) = v.sample(&path_state, sampler, precomputed) else { return visits };
        path_state.turn::<MEDIA>(scene, v, &draw);
        if !(path_state.beta.is_finite() && path_state.survives(depth, sampler, &lambda)) {
            return visits;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vertex in samples that have the variance `p` and the cost `k` beside what it brings: with `√(C₀/V₀)` of such
    /// samples, the number of paths is that with the least variance × cost.
    #[test]
    fn the_number_of_paths_is_the_best() {
        for (p, k, square, variance, cost) in
            [(1.0, 2.0, 0.5, 0.2, 4.0), (4.0, 1.0, 0.3, 0.3, 9.0), (0.2, 6.0, 3.0, 2.5, 2.0), (0.1, 3.0, 0.9, 0.1, 3.0)]
        {
            let product = |q: f64| {
                let err = if q < 1.0 { square / q - (square - variance) } else { variance / q };
                (p + err) * (k + q * cost)
            };
            let cell = Cell {
                mean: 0.0,
                by_square: f64::sqrt(square / cost) as f32,
                by_variance: f64::sqrt(variance / cost) as f32,
            };
            let mut q = 1.0;
            for _ in 0..100 {
                let err = if q < 1.0 { square / q - (square - variance) } else { variance / q };
                q = f64::from(cell.factor(f64::sqrt((k + q * cost) / (p + err)) as f32, 8.0));
            }
            let tried = (5..100).map(|k| f64::from(k) / 100.0).chain((1..=8).map(f64::from));
            let best = tried.min_by(|a, b| product(*a).total_cmp(&product(*b))).unwrap();
            assert!(product(q) < 1.03 * product(best), "{q} for {best}: {} for {}", product(q), product(best));
        }
    }
}
