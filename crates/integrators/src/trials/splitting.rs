//! Path splitting per cell: parts of the picture in which a sample of a pixel is the mean of several paths.
//!
//! For a sum of squared relative errors `Σ v/s` at the cost `Σ c s`, with `v` the variance of a path in a cell of
//! pixels and `c` its cost, the best numbers of paths are `s ∝ √(v/c)` ([`crate::adaptive`]). A pilot of few paths,
//! which are no part of the picture, tells `v` and `c` of each cell beforehand; numbers are powers of two, which
//! samplers spread best. No part gets less than it would without.
//!
//! Whether that pays is asked of cells by what their neighbours found: a cell that by chance met something bright would
//! otherwise promise what it cannot keep. Numbers of paths that cost much more than one each are not taken: who asks
//! for samples expects about their time.

use super::probe::{Probe, alone, on_film};
use crate::{
    adaptive::{CELL, FLOOR, Need, around},
    partition::Partition,
    path::PathTracer,
    precomputed::{Precomputed, Splitting},
    wave::WaveBuffer,
};
use rayon::prelude::*;
use steradian_core::Scene;
use steradian_engine::MOST_PATHS;
use steradian_math::hash::{combine32, mix32};

/// Variance × cost has to become less by this factor.
const WORTH: f64 = 1.12;
/// Cost of all samples over that of one path each, at most.
const MOST_COST: f64 = 1.45;
/// Factor by which a coarse pilot, of a quarter of the cells, has to lower variance × cost for the whole pilot to be
/// run.
const PROMISING: f64 = 1.05;
/// Samples of the picture for each cell of the pilot, which has some 32 paths there, and most cells: those of larger
/// pictures, or with fewer samples, stand for others beside them.
const SAMPLES: u64 = 1024;
const MOST_CELLS: u64 = 1 << 14;

/// Selects the path splitting for a picture of so many samples in all.
pub(crate) fn trial<const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &Scene,
    precomputed: &Precomputed,
    samples: u64,
) -> Splitting {
    let film = scene.film();
    let most = (samples / SAMPLES).min(MOST_CELLS);
    // Squares as small as the budget of the pilot allows.
    let mut edge = CELL;
    while u64::from(film.width.div_ceil(edge)) * u64::from(film.height.div_ceil(edge)) > most {
        edge *= 2;
    }
    let measure = |edge| PilotStatistics::measure(path, scene, precomputed, edge);
    // A coarse pilot first: pictures in which splitting promises little end here.
    if measure(2 * edge).best().gain < PROMISING {
        return Splitting::default();
    }
    let pilot = measure(edge);
    let best = pilot.best();
    if best.gain < WORTH { Splitting::default() } else { pilot.splitting(best.unit) }
}

/// Statistics of a pilot, by rows of squares.
struct PilotStatistics {
    needs: Vec<Need>,
    columns: u32,
    edge: u32,
}

/// Numbers of paths, by the demand for one path, and the factor by which they lower variance × cost.
struct Best {
    unit: f64,
    gain: f64,
}

impl PilotStatistics {
    /// Asks one cell of each square with an edge in pixels.
    fn measure<const MEDIA: bool>(
        path: &PathTracer<MEDIA>,
        scene: &Scene,
        precomputed: &Precomputed,
        edge: u32,
    ) -> Self {
        let [columns, rows] = [scene.film().width, scene.film().height].map(|size| size.div_ceil(edge));
        let need = |buffer: &mut _, k| need(path, scene, precomputed, ([k % columns, k / columns], edge), buffer);
        Self { needs: (0..columns * rows).into_par_iter().map_init(Default::default, need).collect(), columns, edge }
    }

    /// The variance around each square.
    fn beside(&self) -> Vec<f64> {
        (0..self.needs.len()).map(|i| around(&self.needs, self.columns as usize, i, false)).collect()
    }

    /// The numbers of paths that make variance × cost least, if each square goes by those beside it.
    fn best(&self) -> Best {
        // s ∝ √(v/c), with v of the neighbours.
        let demands: Vec<f64> = self.beside().iter().zip(&self.needs).map(|(v, need)| demand(*v, need)).collect();
        // Σ v/s · Σ c s for the numbers of paths that belong to a unit; infinite where they cost too much.
        let even: f64 = self.needs.iter().map(|need| f64::from(need.pixels) * need.rays).sum();
        let product = |unit: f64| {
            let (mut variance, mut cost) = (0.0, 0.0);
            for (need, demand) in self.needs.iter().zip(&demands) {
                let (pixels, s) = (f64::from(need.pixels), f64::from(paths(*demand, unit)));
                variance += pixels * need.variance / s;
                cost += pixels * need.rays * s;
            }
            if cost > MOST_COST * even { f64::INFINITY } else { variance * cost }
        };
        // From where none has more than one path to where nearly all have the most.
        let greatest = demands.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let tried = (0..48).map(|k| greatest * 2_f64.powf(-0.25 * f64::from(k))).map(|unit| (unit, product(unit)));
        let (unit, least) = tried.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((greatest, 0.0));
        Best { unit, gain: if least > 0.0 { product(f64::INFINITY) / least } else { 1.0 } }
    }

    /// Numbers of paths by a square and those beside it.
    fn splitting(&self, unit: f64) -> Splitting {
        let demands =
            self.beside().into_iter().zip(&self.needs).map(|(v, need)| demand(0.5 * (v + need.variance), need));
        Splitting { paths: demands.map(|d| paths(d, unit)).collect(), columns: self.columns, edge: self.edge }
    }
}

/// Demand for paths, `√(v/c)`.
fn demand(variance: f64, need: &Need) -> f64 {
    (variance / need.rays.max(1.0)).sqrt().min(1e150)
}

/// The power of two nearest to what is demanded.
fn paths(demand: f64, unit: f64) -> u8 {
    (demand / unit).max(1.0).log2().round().exp2().min(f64::from(MOST_PATHS)) as u8
}

/// Variance and cost of a square, by one of its cells.
fn need<'s, const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &Precomputed,
    (square, edge): ([u32; 2], u32),
    buffer: &mut WaveBuffer<'s>,
) -> Need {
    // A random cell of the square.
    let hash = combine32(mix32(square[0]), square[1]);
    let size = [scene.film().width, scene.film().height];
    // A cell of it that begins on the film.
    let at: [u32; 2] = std::array::from_fn(|axis| {
        let first = square[axis] * edge;
        let cells = (size[axis] - first).min(edge).div_ceil(CELL);
        first + (hash >> (16 * axis)) % cells * CELL
    });
    // Two samples of each pixel: variance from their difference, brightness from their sum.
    let (mut variance, mut level, mut cost, mut count) = (0.0, 0.0, 0.0, 0);
    let mut add = |[a, b]: [&[f64]; 2], rays: f64| {
        count += a.len() as u32;
        cost += 0.5 * rays;
        for (a, b) in a.iter().zip(b) {
            variance += (a - b).powi(2) / 2.0;
            level += (a + b) / 2.0;
        }
    };
    // Larger groups reach far beyond the cell: small ones stand for them.
    let partition = Partition::new(precomputed.reuse().min(4), 0);
    if precomputed.reuse() > 1 {
        for window in partition.about(at, hash) {
            let mut probe = Probe::new(scene, &partition, window);
            let [a, b] = [0, 1].map(|seed| probe.sample(path, scene, precomputed, seed, (0, 1)));
            let count = probe.places.len();
            add([&a.0[..count], &b.0[..count]], a.1 + b.1);
        }
    } else {
        let places: Vec<_> = partition.about(at, hash).flat_map(|w| on_film(scene, &partition, w)).collect();
        let (light, rays) = alone(path, scene, precomputed, (&partition, &places), buffer);
        let (a, b) = light.split_at(places.len());
        add([a, b], rays);
    }
    let n = f64::from(count.max(1));
    level /= n;
    Need { pixels: count, variance: variance / n / (level * level + FLOOR), rays: cost / n }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of 32 × 32 cells, a part of which errs and costs more.
    fn pilot(part: impl Fn(u32, u32) -> bool, variance: f64, rays: f64) -> PilotStatistics {
        let need = |k: u32| {
            let (variance, rays) = if part(k % 32, k / 32) { (variance, rays) } else { (1.0, 2.0) };
            Need { pixels: 64, variance, rays }
        };
        PilotStatistics { needs: (0..1024).map(need).collect(), columns: 32, edge: CELL }
    }

    /// An eighth of the picture with 200 times the variance: four paths there take 11/8 of the cost and leave 57/207 of
    /// the variance, so the gain is 2.64; cells at its border, which go by those beside them, take a little away. Where
    /// it is a quarter, four would cost too much.
    #[test]
    fn what_errs_more_gets_more() {
        let splitting = |rows: u32, gain: std::ops::Range<f64>| {
            let pilot = pilot(|x, y| x < 16 && y < rows, 200.0, 2.0);
            let best = pilot.best();
            assert!(gain.contains(&best.gain), "{}", best.gain);
            let splitting = pilot.splitting(best.unit);
            [[3, 3], [14, 0], [20, 3], [31, 31]].map(|[x, y]| splitting.paths([x * CELL + 3, y * CELL + 7]))
        };
        assert_eq!(splitting(8, 2.3..2.65), [4, 4, 1, 1]);
        assert_eq!(splitting(16, 1.4..1.58), [2, 2, 1, 1]);
    }

    /// Nothing is gained where all is alike, and nothing by what one cell met that its neighbours know nothing of, in a
    /// hundred places.
    #[test]
    fn chance_promises_nothing() {
        assert_eq!(pilot(|_, _| false, 0.0, 0.0).best().gain, 1.0);
        assert_eq!(pilot(|_, _| true, 0.0, 1.0).best().gain, 1.0);
        let gain = pilot(|x, y| x % 3 == 1 && y % 3 == 1, 1e4, 2.0).best().gain;
        assert!(gain < 1.1, "{gain}");
        // Variance that costs as much more to remove.
        assert!(pilot(|x, _| x < 16, 9.0, 18.0).best().gain < 1.01);
        // The greatest that luminances can give.
        assert!(pilot(|x, _| x < 16, 1e77, 2.0).best().gain.is_finite());
    }
}
