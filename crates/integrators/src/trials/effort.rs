//! Light samples and roulette threshold of paths that share: roulette and splitting by efficiency, 1/(variance × cost).
//!
//! Let a sample have the variance `V` and the cost `C`, let light samples at x contribute the variance `D` to it at the
//! cost `d` each, and let roulette with a threshold `b` for what follows the direct light at y add `S(b)` and leave the
//! cost `C(b)`. With `n` light samples it has (Bolin, Meyer 1997, "An Error Metric for Monte Carlo Ray Tracing"; Rath
//! et al. 2022, "EARS")
//!
//! `V(n, b) = V − (1 − 1/n) D + S(b)`, `C(n, b) = C(b) + (n − 1) d`.
//!
//! A trial measures all of them over the picture, relative to its brightness, and takes what makes the product least.
//! As roulette decides by the same random numbers whatever the threshold, `S(b)` is the mean square by which samples
//! with and without it differ.

use super::probe::Probe;
use crate::{
    adaptive::FLOOR,
    partition::{MAX_GROUP, Partition, TILE},
    path::PathTracer,
    precomputed::{PathEffort, Precomputed},
};
use rayon::prelude::*;
use steradian_core::Scene;
use steradian_math::sobol;

/// Most light samples.
const LIGHTS: u32 = 4;
/// Thresholds of roulette that are tried beside the rule of all paths.
const THRESHOLDS: [f32; 2] = [0.6, 1.0];
/// The cost of a light sample over that of its ray: a light is chosen, and scattering evaluated.
const LIGHT_COST: f64 = 1.5;
/// Groups of the trial.
const GROUPS: u32 = 64;
/// Samples of a pixel, spread over each other as those of a picture are, in each of two renders.
const SAMPLES: u32 = 4;

/// Candidates: the rule of all paths, roulette, and the last again with two light samples.
const TRIED: [PathEffort; THRESHOLDS.len() + 2] = [
    PathEffort { lights: 1, roulette_below: None },
    PathEffort { lights: 1, roulette_below: Some(THRESHOLDS[0]) },
    PathEffort { lights: 1, roulette_below: Some(THRESHOLDS[1]) },
    PathEffort { lights: 2, roulette_below: Some(THRESHOLDS[1]) },
];
const LAST: usize = TRIED.len() - 1;

/// Measurements of a trial, summed over the picture.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    /// Variance of samples without roulette.
    variance: f64,
    /// Part of it that light samples contribute.
    by_lights: f64,
    /// Variance that roulette adds, by threshold; none without.
    by_roulette: [f64; LAST],
    /// Cost of each that was tried.
    cost: [f64; TRIED.len()],
}

impl Found {
    fn plus(mut self, o: Self) -> Self {
        self.variance += o.variance;
        self.by_lights += o.by_lights;
        self.by_roulette.iter_mut().zip(o.by_roulette).for_each(|(a, b)| *a += b);
        self.cost.iter_mut().zip(o.cost).for_each(|(a, b)| *a += b);
        self
    }

    /// Variance × cost with some light samples and what was tried as roulette.
    fn product(&self, lights: u32, tried: usize) -> f64 {
        // V(n, b) C(n, b) of the module's formulas.
        let n = f64::from(lights);
        let spared = (1.0 - 1.0 / n) * self.by_lights.min(self.variance);
        let light = LIGHT_COST * (self.cost[LAST] - self.cost[LAST - 1]);
        (self.variance - spared + self.by_roulette[tried]) * (self.cost[tried] + (n - 1.0) * light)
    }

    /// Candidate of the least product.
    fn best(&self) -> PathEffort {
        // Every threshold with every number of light samples.
        let all = (0..LAST).flat_map(|tried| (1..=LIGHTS).map(move |lights| (lights, tried)));
        let best = all.min_by(|a, b| self.product(a.0, a.1).total_cmp(&self.product(b.0, b.1)));
        best.map_or_else(PathEffort::default, |(lights, tried)| PathEffort { lights, ..TRIED[tried] })
    }
}

/// Selects the effort of the least variance × cost.
pub(crate) fn trial<const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &Scene,
    precomputed: &Precomputed,
) -> PathEffort {
    if precomputed.reuse() < 2 || !scene.lights().can_sample() {
        return PathEffort::default();
    }
    // Every candidate renders the same groups, spread over the picture.
    let trials = TRIED.map(|effort| Precomputed { effort, ..precomputed.clone() });
    let found: Vec<Found> =
        (0..GROUPS).into_par_iter().map(|k| of_group(path, scene, &trials, tile(scene, k, 1), k)).collect();
    found.into_iter().fold(Found::default(), Found::plus).best()
}

/// The `k`th of some tiles, spread over the picture.
fn tile(scene: &Scene, k: u32, seed: u32) -> [i32; 2] {
    let place = sobol::shuffled_scrambled_sobol_2d(k, seed);
    let tiles = [scene.film().width, scene.film().height].map(|size| size.div_ceil(TILE));
    [0, 1].map(|axis| (place[axis] * tiles[axis] as f32) as i32)
}

/// Measurements of a group of a tile.
fn of_group<const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &Scene,
    trials: &[Precomputed; TRIED.len()],
    tile: [i32; 2],
    k: u32,
) -> Found {
    let partition = Partition::new(trials[0].reuse(), 0);
    let Some(window) = partition.parts(tile, k % Partition::LAYERS, &partition).next() else { return Found::default() };
    let mut probe = Probe::new(scene, &partition, window);
    let (mut found, all) = (Found::default(), f64::from(2 * SAMPLES));
    // The mean luminance of each pixel, by render and by what is tried.
    let mut means = [[[0.0_f64; TRIED.len()]; MAX_GROUP]; 2];
    // Two independent renders of a few samples; their difference gives the variance, the sums the brightness.
    for (seed, means) in (0..).zip(&mut means) {
        for index in 0..SAMPLES {
            let mut light = [[0.0; TRIED.len()]; MAX_GROUP];
            for (tried, precomputed) in trials.iter().enumerate() {
                let (luminances, cost) = probe.sample(path, scene, precomputed, seed, (index, SAMPLES));
                found.cost[tried] += cost / all;
                light.iter_mut().zip(luminances).for_each(|(light, l)| light[tried] = l);
            }
            for (light, mean) in light.iter().zip(&mut *means) {
                mean.iter_mut().zip(light).for_each(|(m, l)| *m += l / f64::from(SAMPLES));
                // S(b): mean square of the difference to the sample without roulette.
                found.by_roulette.iter_mut().zip(light).for_each(|(sum, l)| *sum += (l - light[0]).powi(2) / all);
            }
        }
    }
    let mut level = 0.0;
    for [a, b] in means[0].iter().zip(&means[1]).map(|(a, b)| [a, b]) {
        let samples = f64::from(SAMPLES);
        level += (a[0] + b[0]) / (2 * probe.places.len().max(1)) as f64;
        found.variance += samples * (a[0] - b[0]).powi(2) / 2.0;
        // Half the difference of two independent light samples.
        found.by_lights += [a, b].map(|m| samples * (m[LAST] - m[LAST - 1]).powi(2)).iter().sum::<f64>();
    }
    // Errors count relative to the brightness of the group.
    let scale = 1.0 / (level * level + FLOOR);
    found.variance *= scale;
    found.by_lights *= scale;
    found.by_roulette.iter_mut().for_each(|s| *s *= scale);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of the variance by light samples at a tenth of the cost, and a fifth of the cost in what adds nothing.
    #[test]
    fn the_best_product_is_chosen() {
        let found = Found { variance: 2.0, by_lights: 1.0, by_roulette: [0.0, 0.1, 2.0], cost: [10.0, 8.0, 7.0, 7.5] };
        // V C for n = 1, 2, 3, 4: 16.8, 14.0, 13.61, 13.84.
        assert_eq!(found.best(), PathEffort { lights: 3, roulette_below: Some(THRESHOLDS[0]) });
        // Where light samples cost as much as all else, and roulette adds more than it spares.
        let dear = Found { by_roulette: [0.0, 1.0, 2.0], cost: [10.0, 8.0, 7.0, 14.0], ..found };
        assert_eq!(dear.best(), PathEffort::default());
        assert_eq!(Found::default().best(), PathEffort::default());
    }
}
