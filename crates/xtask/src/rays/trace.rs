//! Ray queries, their results, and our ways to trace them.

use steradian_accel::{Hit, TopLevel};
use steradian_math::Ray;

/// Rays that are handed over at once, where they are not sorted.
const BATCH: usize = 256;

/// Kind of a ray query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The nearest hit.
    Closest,
    /// Any hit.
    Occluded,
}

impl Query {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest",
            Self::Occluded => "occluded",
        }
    }
}

/// Result of tracing rays: the number with a hit, and the sum of the distances of nearest hits.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    pub hits: usize,
    pub sum: f64,
}

impl Found {
    /// Adds hits with given distances. The sum over them begins anew, so that it stays in a register.
    #[inline(always)]
    pub fn add(&mut self, distances: impl Iterator<Item = f32>) {
        let (mut hits, mut sum) = (0, 0.0);
        for t in distances {
            hits += 1;
            sum += f64::from(t);
        }
        self.hits += hits;
        self.sum += sum;
    }

    /// True if another program has found the same, but for a few rays at edges.
    pub fn agrees(self, other: Self) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-4 * a.abs().max(b.abs());
        close(self.hits as f64, other.hits as f64) && close(self.sum, other.sum)
    }
}

/// Our ways to trace many rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// One by one.
    Single,
    /// In slices.
    Batch,
    /// All together, to be sorted first.
    Stream,
}

impl Mode {
    /// Every way.
    pub const ALL: [Self; 3] = [Self::Single, Self::Batch, Self::Stream];
}

/// Traces rays.
pub fn trace(top: &TopLevel, rays: &[Ray], query: Query, mode: Mode) -> Found {
    let mut found = Found::default();
    let batch = if mode == Mode::Stream { rays.len().max(1) } else { BATCH };
    match (query, mode) {
        (Query::Closest, Mode::Single) => {
            found.add(rays.iter().filter_map(|ray| top.intersect(ray, &())).map(|hit| hit.t));
        }
        (Query::Occluded, Mode::Single) => found.hits = rays.iter().filter(|ray| top.occluded(ray, &())).count(),
        (Query::Closest, _) => {
            let mut hits: Vec<Option<Hit>> = vec![None; batch.min(rays.len())];
            for rays in rays.chunks(batch) {
                let hits = &mut hits[..rays.len()];
                if mode == Mode::Stream {
                    top.intersect_stream(rays, &(), hits);
                } else {
                    top.intersect_batch(rays, &(), hits);
                }
                found.add(hits.iter().flatten().map(|hit| hit.t));
            }
        }
        (Query::Occluded, _) => {
            let mut occluded = vec![false; batch.min(rays.len())];
            for rays in rays.chunks(batch) {
                let occluded = &mut occluded[..rays.len()];
                if mode == Mode::Stream {
                    top.occluded_stream(rays, &(), occluded);
                } else {
                    top.occluded_batch(rays, &(), occluded);
                }
                found.hits += occluded.iter().filter(|&&o| o).count();
            }
        }
    }
    found
}
