//! Local linear regressions whose windows overlap.
//!
//! About a centre, pixels weigh by how alike they are to it: by a guide's colours beyond their noise, by surface, and
//! by distance, down to nothing at the rim of the window, as a rim where weights end at once shows as a square around
//! whatever is bright. A line in place, normal and albedo is fitted to their colours, and is what the window tells of
//! each of its pixels. Centres stand on a grid; a pixel is the mean of what all windows over it tell. Pixels that too
//! few tell of, such as thin parts, become centres of their own.

use rayon::prelude::*;
use steradian_accel::{Lanes, kernel};

use super::{
    estimate::Estimate,
    features::Features,
    plane::Plane,
    settings::Settings,
    window::{REACH, SIDE, Window},
};
use crate::falloff::falloff;

/// Columns and rows from centre to centre; every other row is shifted by half of it.
const STRIDE: usize = 4;
/// Rows of centres that are summed in one strip, and strips that are summed at a time.
const ROWS: usize = 8;
const STRIPS: usize = 16;
/// A pixel whose weights have a smaller sum becomes a centre.
const COVERED: f32 = 0.5;
/// Weights below this are none: what is far brighter would be seen through them.
const CUT: f32 = 0.005;
/// By how many times its own variance that of the other counts at most. Without a bound, nothing is farther from a
/// bright pixel of few paths than 1/k², and it would shine into what is dark around.
const TRUST: f32 = 4.0;
/// Keeps quotients finite.
const TINY: f32 = 1e-20;
/// Sums of a pixel: of three weighted values, three variances, and weights.
const SUMS: usize = 7;

/// A pass: a guide and features tell weights, a source has the colours.
pub(super) struct Pass<'a> {
    pub guide: &'a Estimate,
    pub source: &'a Estimate,
    pub features: &'a Features,
    pub settings: &'a Settings,
}

/// Centres of a row, by its number.
type Centres = (usize, Vec<usize>);

impl Pass<'_> {
    /// Filters all.
    pub fn run(&self, lanes: Lanes) -> Estimate {
        let [width, height] = self.source.size();
        let mut all = Strip::new(0, height, width);
        let columns = |y: usize| (y / STRIDE % 2 * (STRIDE / 2)..width).step_by(STRIDE).collect();
        let grid: Vec<Centres> = (0..height).step_by(STRIDE).map(|y| (y, columns(y))).collect();
        self.add(lanes, &grid, &mut all);
        let is_left = |place: usize| all.at(SUMS - 1, place) < COVERED && self.features.surface.at(place) > 0.0;
        let left = |y: usize| (0..width).filter(|x| is_left(y * width + x)).collect();
        let left: Vec<Centres> = (0..height).map(|y| (y, left(y))).collect();
        self.add(lanes, &left, &mut all);
        let plane = |sum: usize| {
            Plane::new([width, height], |place| {
                let weight = all.at(SUMS - 1, place);
                if weight > 0.0 { all.at(sum, place) / weight } else { 0.0 }
            })
        };
        self.source.with([plane(0), plane(1), plane(2)], [plane(3), plane(4), plane(5)])
    }

    /// Adds what windows tell: strips of rows in parallel, then one after the other.
    fn add(&self, lanes: Lanes, centres: &[Centres], all: &mut Strip) {
        let width = self.source.size()[0];
        let strip = |centres: &[Centres]| {
            let (first, last) = (centres.first()?.0, centres.last()?.0);
            let mut strip = Strip::new(first as i64 - REACH as i64, last - first + SIDE, width);
            let mut window = Window::new(self.settings.radius);
            for (y, columns) in centres {
                for x in columns {
                    if self.features.surface.at(y * width + x) > 0.0 {
                        centre(lanes, self, [*x as i64, *y as i64], &mut window, &mut strip);
                    }
                }
            }
            Some(strip)
        };
        // A few strips at a time, to bound the memory.
        for some in centres.chunks(ROWS * STRIPS) {
            let strips: Vec<Option<Strip>> = some.par_chunks(ROWS).map(strip).collect();
            strips.iter().flatten().for_each(|strip| all.add(strip));
        }
    }

    /// Fills a window about a centre.
    #[inline(always)]
    fn fill(&self, [x, y]: [i64; 2], window: &mut Window) {
        let [width, height] = self.source.size();
        let place = y as usize * width + x as usize;
        let centre: [(f32, f32); 3] = std::array::from_fn(|c| self.guide.channel(c, place));
        let square = 3.0 * self.settings.damping * self.settings.damping;
        for j in 0..SIDE {
            let below = j as i64 - REACH as i64;
            let at = [x - REACH as i64, y + below];
            if at[1] < 0 || at[1] >= height as i64 {
                window.skip_row(j);
                continue;
            }
            let mut distances = [0.0; SIDE];
            for (c, (value, variance)) in centre.iter().enumerate() {
                // Squared distance beyond what noise explains: d² − (Var_p + min(Var_p, Var_q)), over k² (Var_p +
                // Var_q) (Rousselle et al. 2013).
                let [values, variances] = self.guide.rows::<SIDE>(c, at);
                for k in 0..SIDE {
                    let d = value - values[k];
                    let beyond = (d * d - (variance + variance.min(variances[k]))).max(0.0);
                    let noise = variance.min(TRUST * variances[k]) + variances[k].min(TRUST * variance);
                    distances[k] += beyond / (TINY + square * noise);
                }
            }
            let mut apart = [[[0.0; SIDE]; 3]; 2];
            self.features.add_distances((place, REACH), (at, below.abs() as f32), &mut distances, &mut apart);
            let inside = self.features.surface.row::<SIDE>(at);
            for k in 0..SIDE {
                distances[k] = (falloff(distances[k]) - CUT).max(0.0) * inside[k];
            }
            let colors = std::array::from_fn(|c| self.source.rows::<SIDE>(c, at));
            window.set_row(j, &distances, self.source.counts(at), &apart, &colors);
        }
    }
}

kernel! {
    /// Adds what the window about a centre tells.
    fn centre(pass: &'a Pass<'a>, at: [i64; 2], window: &'a mut Window, strip: &'a mut Strip) {
        pass.fill(at, window);
        let Some(variances) = window.fit() else { return };
        for j in 0..SIDE {
            let y = at[1] + j as i64 - REACH as i64;
            if y < 0 || y >= pass.source.size()[1] as i64 {
                continue;
            }
            let weights = window.weights(j);
            for (c, variance) in variances.iter().enumerate() {
                let (values, sums) = (window.told(c, j), strip.row(c, [at[0], y]));
                for k in 0..SIDE {
                    sums[k] += weights[k] * values[k];
                }
                let sums = strip.row(3 + c, [at[0], y]);
                for k in 0..SIDE {
                    sums[k] += weights[k] * variance;
                }
            }
            let sums = strip.row(SUMS - 1, [at[0], y]);
            for k in 0..SIDE {
                sums[k] += weights[k];
            }
        }
    }
}

/// Rows of sums: of weighted values, of weighted variances, of weights. Columns and rows go on beyond the picture.
struct Strip {
    /// The first row.
    top: i64,
    width: usize,
    sums: [Vec<f32>; SUMS],
}

impl Strip {
    fn new(top: i64, rows: usize, width: usize) -> Self {
        Self { top, width, sums: std::array::from_fn(|_| vec![0.0; rows * (width + SIDE)]) }
    }

    /// A sum of a pixel; of a strip from the first row on.
    fn at(&self, sum: usize, place: usize) -> f32 {
        self.sums[sum][place / self.width * (self.width + SIDE) + REACH + place % self.width]
    }

    /// Sums of a row of the window about a centre.
    #[inline(always)]
    fn row(&mut self, sum: usize, [x, y]: [i64; 2]) -> &mut [f32; SIDE] {
        let from = (y - self.top) as usize * (self.width + SIDE) + x as usize;
        self.sums[sum][from..].first_chunk_mut().expect("a window lies in its strip")
    }

    /// Adds the rows of another that lie in this one, whose first is that of the picture.
    fn add(&mut self, other: &Self) {
        let stride = self.width + SIDE;
        let (skip, from) = (other.top.min(0).unsigned_abs() as usize * stride, other.top.max(0) as usize * stride);
        for (sums, others) in self.sums.iter_mut().zip(&other.sums) {
            sums.iter_mut().skip(from).zip(&others[skip..]).for_each(|(sum, other)| *sum += other);
        }
    }
}
