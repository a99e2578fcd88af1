//! Bounds of the exit pupil, at which rays from the film are aimed (pbrt-v3, 6.4.5).

use super::{D_LINE, LensSystem, surface::Beam};
use steradian_math::DVec3;

/// Parts into which the film's radius is divided.
pub(super) const INTERVALS: usize = 64;

/// Rays across a search, per side.
const GRID: usize = 64;

/// Bounds on the plane through the rear vertex, for points of the film on the +x axis: x0, x1, and y1 = −y0. mm.
pub(super) type Bounds = [f64; 3];

impl LensSystem {
    /// Bounds for intervals of the film's radius, up to `radius` mm; `None` where nothing passes.
    pub(super) fn pupils(&self, radius: f64) -> Vec<Option<Bounds>> {
        // Bound the pupil at the ends of the intervals and unite neighbours.
        let ends: Vec<Option<Bounds>> =
            (0..=INTERVALS).map(|k| self.pupil(radius * k as f64 / INTERVALS as f64)).collect();
        ends.windows(2).map(|w| w.iter().flatten().copied().reduce(union)).collect()
    }

    /// Bounds for a point of the film.
    fn pupil(&self, x: f64) -> Option<Bounds> {
        // Search the rear element generously: the pupil may be larger than its rim.
        let rim = 1.5 * self.surfaces.last()?.rim;
        let whole = [-rim, rim, rim];
        // A small pupil may lie between the rays of a coarse search.
        let search = |grid| self.passing(x, whole, grid, D_LINE);
        let coarse = search(GRID).or_else(|| search(4 * GRID))?;
        let colors = if self.is_dispersive { &[380.0, 780.0][..] } else { &[D_LINE][..] };
        // Search again within the coarse bounds, for both ends of the spectrum where glass disperses.
        let fine = colors.iter().filter_map(|nm| self.passing(x, coarse, GRID, *nm)).reduce(union);
        fine.or(Some(coarse))
    }

    /// Bounds of the rays of a grid that pass, with a cell around them.
    fn passing(&self, x: f64, [x0, x1, y1]: Bounds, grid: usize, nm: f64) -> Option<Bounds> {
        let z = self.surfaces.last()?.vertex;
        let (origin, n) = (DVec3::new(x, 0.0, 0.0), grid as f64);
        let (dx, dy) = ((x1 - x0) / n, 2.0 * y1 / n);
        let mut bounds: Option<Bounds> = None;
        // The lens, if not its stop, is the same on both sides of the x axis. From the outermost row inwards, what lies
        // between rays that passed need not be tried.
        for k in (0..grid * grid / 2).rev() {
            let px = x0 + (0.5 + (k % grid) as f64) * dx;
            let py = (0.5 + (k / grid) as f64) * dy;
            let is_known = bounds.is_some_and(|b| px > b[0] && px < b[1] && py < b[2]);
            if !is_known && self.towards_scene(Beam::between(origin, DVec3::new(px, py, z)), nm).is_some() {
                let here = [px, px, py];
                bounds = Some(bounds.map_or(here, |b| union(b, here)));
            }
        }
        // Grow by one cell against what lies between grid points.
        bounds.map(|b| [b[0] - dx, b[1] + dx, b[2] + dy])
    }
}

fn union(a: Bounds, b: Bounds) -> Bounds {
    [a[0].min(b[0]), a[1].max(b[1]), a[2].max(b[2])]
}
