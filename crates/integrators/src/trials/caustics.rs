//! Trial of photons: the variance of pixels with and without them, from a few paths whose directions they helped to
//! draw.
//!
//! Where a path brings contributions `c_k` by directions of which the surfaces alone have the share `r_k` of the
//! density so far, it would bring `c_k / r_k` without photons, `r_k` times as often. So its square would be
//! `Σ_k c_k (c_k / r_k + 2 Σ_{j<k} c_j / r_j)` in the mean. All of it counts, also what is so bright and rare that a
//! picture of usual length does not find it: this is what photons are for.

use crate::{Counters, dimension, path::PathTracer, precomputed::Precomputed};
use rayon::prelude::*;
use steradian_core::{
    Scene,
    sampler::{PixelSampler, Sampler, SamplerKind},
};
use steradian_engine::PathContext;
use steradian_math::{Spectrum, Vec2};
use steradian_transport::{Arrival, PathState, arrive, escape};

/// Edge of a cell of the picture, pixels, where it is small; otherwise there are at most so many to an edge.
const CELL: u32 = 8;
const MOST_CELLS: u32 = 48;
/// Paths of a cell, or more where there are few cells, for so many in all.
const PATHS: u32 = 16;
const FEWEST_PATHS: u32 = 1 << 13;
/// The share of the light by which the rarest paths are asked for: a picture that lacks it is wrong.
const MISSED: f64 = 0.02;
/// Added to squares of pixels, to which errors are relative.
const FLOOR: f64 = crate::adaptive::FLOOR;

/// Contributions of a path: luminances, each with the density of the directions before it by surfaces alone over that
/// with photons.
type Contributions = Vec<(f64, f64)>;

/// Result of the trial.
pub(crate) struct Outcome {
    /// Factor by which the photons lower the variance of the picture's samples.
    pub gain: f64,
    /// Probability that one path without photons brings one of the brightest contributions, so many of which are taken
    /// together that they carry a fiftieth of the light; `None` where photons do not lead to these.
    pub rarest_path_probability: Option<f64>,
}

/// Measures the gain of the photons of `precomputed`.
pub(crate) fn trial<const MEDIA: bool>(scene: &Scene, path: &PathTracer<MEDIA>, precomputed: &Precomputed) -> Outcome {
    // A grid of cells over the picture, with some paths in each.
    let cells = [scene.film().width, scene.film().height].map(|pixels| (pixels / CELL).clamp(1, MOST_CELLS));
    let count = PATHS.max(FEWEST_PATHS / (cells[0] * cells[1])).next_power_of_two();
    let sampler = Sampler { kind: SamplerKind::Sobol, spp: count, seed: 1 };
    let paths: Vec<Vec<Contributions>> = (0..cells[0] * cells[1])
        .into_par_iter()
        .map(|cell| {
            let at = [cell % cells[0], cell / cells[0]];
            let trace = |index| trace(scene, path, precomputed, (at, cells), &sampler.pixel(at[0], at[1], index));
            (0..count).map(trace).collect()
        })
        .collect();
    // Variances of the cells, added up: their ratio is the gain.
    let [with, without] = paths.iter().map(|cell| variances(cell)).fold([0.0; 2], |s, v| [s[0] + v[0], s[1] + v[1]]);
    Outcome {
        gain: if with > 0.0 { without / with } else { 1.0 },
        rarest_path_probability: rarest_path_probability(&paths),
    }
}

/// The brightness to which the errors of the pixels of a cell are relative, and their mean.
fn level(paths: &[Contributions]) -> (f64, f64) {
    let mean = paths.iter().flatten().map(|c| c.0).sum::<f64>() / paths.len() as f64;
    ((mean * mean + FLOOR).sqrt(), mean)
}

/// The relative variance of paths to the same cell, with photons and without.
fn variances(paths: &[Contributions]) -> [f64; 2] {
    let (pixel, mean) = level(paths);
    let (mut with, mut without) = (0.0, 0.0);
    // E[(Σ c_k)²] with photons, as it is; and without, Σ_k c_k (c_k/r_k + 2 Σ_{j<k} c_j/r_j).
    for path in paths {
        with += path.iter().map(|c| c.0).sum::<f64>().powi(2);
        let mut before = 0.0;
        for (light, ratio) in path {
            let alone = light / ratio;
            without += light * (alone + 2.0 * before);
            before += alone;
        }
    }
    [with, without].map(|squares| (squares / paths.len() as f64 - mean * mean) / (pixel * pixel))
}

/// [`Outcome::rarest_path_probability`], by the paths to each cell.
fn rarest_path_probability(cells: &[Vec<Contributions>]) -> Option<f64> {
    // All contributions, brightest first by their value without photons.
    let mut found: Vec<(f64, f64, f64)> = Vec::new();
    for paths in cells {
        let (pixel, _) = level(paths);
        found.extend(paths.iter().flatten().map(|(light, ratio)| (light / (ratio * pixel), light / pixel, *ratio)));
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let enough = MISSED * found.iter().map(|f| f.1).sum::<f64>();
    let (mut light, mut often, mut by_photons) = (0.0, 0.0, 0.0);
    // The brightest ones, up to the share of the light that a picture may miss: how much they bring, how often they are
    // found without photons, and how much of it photons find far more often.
    for (_, bright, ratio) in &found {
        light += bright;
        often += ratio;
        by_photons += if *ratio < 0.1 { *bright } else { 0.0 };
        if light >= enough {
            break;
        }
    }
    let paths: usize = cells.iter().map(Vec::len).sum();
    (by_photons > 0.5 * light).then(|| often / paths as f64)
}

/// Follows a path from the camera.
fn trace<const MEDIA: bool>(
    scene: &Scene,
    PathTracer { depth }: &PathTracer<MEDIA>,
    precomputed: &Precomputed,
    (at, cells): ([u32; 2], [u32; 2]),
    sampler: &PixelSampler,
) -> Contributions {
    let film = scene.film();
    let mut lambda = scene.mode().wavelengths(|| sampler.get_1d(dimension::WAVELENGTH));
    if scene.is_timed() {
        lambda = lambda.at_time(sampler.get_1d(dimension::TIME));
    }
    // A camera ray through a random place of the cell.
    let within = sampler.get_2d(dimension::FILM);
    let place = |axis: usize, size: u32| (at[axis] as f32 + within[axis]) / cells[axis] as f32 * size as f32;
    let place = Vec2::new(place(0, film.width), place(1, film.height));
    let (ray, share) = scene.camera().sample(film, place, sampler.get_2d(dimension::LENS), &mut lambda);
    let counters = &mut Counters::until(&precomputed.stop);
    let context = &mut PathContext { scene, sampler, lambda: &mut lambda, counters };
    let mut path_state = PathState::camera(scene, ray);
    let (mut found, mut ratio, mut arrival) = (Contributions::new(), 1.0, Arrival::End);
    // The path tracer's loop, which notes each contribution with the ratio of densities up to it.
    loop {
        let mut light = Spectrum::ZERO;
        arrive::<MEDIA>(&mut path_state, depth, &mut light, &mut arrival, context);
        match &arrival {
            Arrival::Escaped => escape(&path_state, depth, &mut light, context),
            Arrival::Vertex(v) => light += path_state.direct::<MEDIA>(v, context),
            Arrival::End => {}
        }
        let light = f64::from(scene.mode().luminance(light, context.lambda) * film.imaging_ratio * share);
        if light.is_finite() && light != 0.0 {
            found.push((light, ratio));
        }
        let Arrival::Vertex(v) = &arrival else { return found };
        let Some(draw) = path_state.sample(v, sampler, precomputed.guide()) else { return found };
        // r ← r p_bsdf / p_mixture.
        ratio *= f64::from(draw.ratio);
        path_state.turn::<MEDIA>(scene, v, &draw);
        if !(path_state.survives(depth, context) && path_state.beta.is_finite() && ratio > 0.0) {
            return found;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::{combine32, unit_f32};

    /// Paths of up to two decisions for one of two directions, which bring light of their own each time: those of a
    /// mixture tell the variance of those without, and their own. 5σ of the 30 parts, which are compared among
    /// themselves.
    #[test]
    fn a_mixture_tells_the_variance_without() {
        // Light and probability, alone and in the mixture, of the first direction.
        let (bright, dim) = (8.0, 0.5);
        let (alone, mixed) = (0.05, 0.4);
        let paths = |p: f64, part: u32| -> Vec<Contributions> {
            (0..2000)
                .map(|path| {
                    let (mut found, mut weight, mut ratio) = (Contributions::new(), 1.0, 1.0);
                    for event in 0..2 {
                        let is_first = f64::from(unit_f32(combine32(part * 2000 + path, event))) < p;
                        let of = |q: f64| if is_first { q } else { 1.0 - q };
                        weight *= of(alone) / of(p);
                        ratio *= of(alone) / of(p);
                        found.push((weight * if is_first { bright } else { dim }, ratio));
                    }
                    found
                })
                .collect()
        };
        let stated = |values: Vec<f64>| {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            (mean, values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0)))
        };
        let told = stated((0..30).map(|part| variances(&paths(mixed, part))[1]).collect());
        let found = stated((30..60).map(|part| variances(&paths(alone, part))[0]).collect());
        assert!((told.0 - found.0).abs() < 5.0 * (told.1 + found.1).sqrt(), "{told:?} {found:?}");
        // The mixture's own is another one.
        let own = stated((0..30).map(|part| variances(&paths(mixed, part))[0]).collect());
        assert!(own.0 < 0.7 * found.0, "{own:?} {found:?}");
        // Without a mixture both are the same.
        let same = variances(&paths(alone, 99));
        assert!((same[0] - same[1]).abs() < 1e-9, "{same:?}");
    }
}
