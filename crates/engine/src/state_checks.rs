//! Tests of a state read from a file: it may match its checksum and be false all the same. Each number is held against
//! the plan, the film, and those numbers that follow from the same samples.

use crate::{Counters, FIRST_LOOK};
use steradian_core::film::{FirstHitSums, Hits, MatteSums, Pixel};

/// Most samples per pixel that a render goes on to, unless its plan has more.
const MOST_SAMPLES: u32 = 1 << 24;
/// Most rays: a hundred threads trace them in a century.
const MOST_RAYS: u64 = 1 << 56;

/// True if the error of a picture with so many samples per pixel is looked at next when it has `look` of them.
pub(crate) fn is_look(look: u32, samples: u32, error: Option<f64>) -> bool {
    if error.is_none() {
        return look == FIRST_LOOK;
    }
    let mut due = FIRST_LOOK;
    while due < look {
        due = due.saturating_add(due / 4);
    }
    due == look && samples <= look
}

/// True if a render planned with `spp` samples per pixel can have gone on to `total`.
pub(crate) fn is_total(total: u32, spp: u32) -> bool {
    (spp..=spp.max(MOST_SAMPLES)).contains(&total)
}

/// True if so much can have been counted.
pub(crate) fn are_counters(counters: &Counters) -> bool {
    counters.rays.max(counters.samples).max(counters.nonfinite) <= MOST_RAYS
}

/// True if values that the film takes can have these sums.
pub(crate) fn is_pixel(pixel: &Pixel) -> bool {
    let (n, largest) = (f64::from(pixel.samples), f64::from(f32::MAX));
    // The squares of rounds that were joined follow from a variance of up to `n` times the largest square.
    pixel.sum.iter().all(|sum| sum.abs() <= n * largest)
        && pixel.sum_squares.iter().all(|sum| (0.0..=2.0 * n * n * largest * largest).contains(sum))
}

/// True if first hits can have these sums.
pub(crate) fn are_hits(sums: &FirstHitSums) -> bool {
    let s = &sums.sum;
    let vectors = [s.albedo, s.normal, s.geometric_normal, s.position, s.motion];
    // Surfaces are counted by ones.
    let is_count = s.coverage >= 0.0 && s.coverage <= sums.samples as f32 && s.coverage.fract() == 0.0;
    let is_opacity = (0.0..=s.coverage).contains(&s.opacity);
    is_count
        && is_opacity
        && vectors.as_flattened().iter().chain(&s.uv).chain(&[s.depth, s.distance]).all(|v| v.is_finite())
}

/// True if things can have been counted so.
pub(crate) fn are_mattes(sums: &MatteSums) -> bool {
    let is_sound = |hits: &Hits| {
        let counted = hits.counts.iter().map(|n| u64::from(*n)).sum::<u64>();
        counted <= u64::from(sums.samples) && hits.ids.iter().zip(&hits.counts).all(|(id, n)| (*id == 0) == (*n == 0))
    };
    is_sound(&sums.objects) && is_sound(&sums.materials)
}
