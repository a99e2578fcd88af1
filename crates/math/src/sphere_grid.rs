//! Histograms and integrals over the sphere of directions.

use crate::Vec3;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Cells of equal solid angle: bands of equal `z`, sectors of equal azimuth.
#[derive(Clone, Copy, Debug)]
pub struct SphereGrid {
    /// Bands in `z`.
    pub bands: usize,
    /// Sectors in azimuth.
    pub sectors: usize,
}

impl SphereGrid {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.bands * self.sectors
    }

    /// Index of the cell that the unit vector `w` lies in.
    pub fn cell(&self, w: Vec3) -> usize {
        let band = (f64::from(w.z) + 1.0) * 0.5 * self.bands as f64;
        let sector = (f64::from(w.y).atan2(f64::from(w.x)) / (2.0 * PI)).rem_euclid(1.0) * self.sectors as f64;
        (band as usize).min(self.bands - 1) * self.sectors + (sector as usize).min(self.sectors - 1)
    }

    /// The integral of `density` over each cell, by adaptive quadrature.
    ///
    /// Each cell is first cut into 16 parts, then divided until two levels agree within `tolerance` (absolute, per
    /// cell) or 4⁹ parts are reached. Features much smaller than a 64th of a cell can be missed.
    pub fn integrate(&self, density: impl Fn(Vec3) -> f64, tolerance: f64) -> Vec<f64> {
        (0..self.cells()).map(|i| self.integrate_cell(i, &density, tolerance, LEVELS)).collect()
    }

    /// Expected counts of `histogram`, of `samples` draws, if it follows `density`, to a small part of its own noise.
    ///
    /// Cells that differ from what is seen by more than noise often does, and those where something is seen that
    /// nothing accounts for, are integrated again by a finer quadrature, so that corners which an edge of the density
    /// cuts off, and which samples hit, are not overlooked.
    pub fn expected_counts(&self, density: impl Fn(Vec3) -> f64, histogram: &[u64], samples: u64) -> Vec<f64> {
        let n = samples as f64;
        let cell = |(i, &seen): (usize, &u64)| {
            let noise = (seen as f64 + 5.0).sqrt();
            let expected = n * self.integrate_cell(i, &density, 0.5 * noise / n, LEVELS);
            let is_accounted_for = seen == 0 || expected > 1e-6;
            if is_accounted_for && (expected - seen as f64).abs() < 3.0 * noise {
                return expected;
            }
            n * self.integrate_cell(i, &density, 0.05 * noise / n, FINE_LEVELS)
        };
        histogram.iter().enumerate().map(cell).collect()
    }

    fn integrate_cell(
        &self,
        i: usize,
        density: &impl Fn(Vec3) -> f64,
        tolerance: f64,
        levels: RangeInclusive<u32>,
    ) -> f64 {
        let (dz, dphi) = (2.0 / self.bands as f64, 2.0 * PI / self.sectors as f64);
        let (z, phi) = ((i / self.sectors) as f64 * dz - 1.0, (i % self.sectors) as f64 * dphi);
        integrate_patch(density, ([z, z + dz], [phi, phi + dphi]), tolerance, &levels, 0, None)
    }
}

/// The integral of `f` over the sphere, by adaptive quadrature; `tolerance` is the absolute error aimed at.
pub fn integrate_sphere(f: impl Fn(Vec3) -> f64, tolerance: f64) -> f64 {
    let grid = SphereGrid { bands: 16, sectors: 16 };
    grid.integrate(f, tolerance / grid.cells() as f64).iter().sum()
}

fn direction(z: f64, (sin, cos): (f64, f64)) -> Vec3 {
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new((r * cos) as f32, (r * sin) as f32, z as f32).normalize_or(Vec3::Z)
}

/// Values at the corners of a patch that is drawn in to parts `at` of its sides, one row of equal `z` after the other.
fn corners(f: &impl Fn(Vec3) -> f64, z: [f64; 2], phi: [f64; 2], at: [f64; 2]) -> [f64; 4] {
    let z = at.map(|a| z[0] + (z[1] - z[0]) * a);
    let turns = at.map(|a| (phi[0] + (phi[1] - phi[0]) * a).sin_cos());
    [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| f(direction(z[i], turns[j])))
}

/// Two-point Gauss–Legendre abscissae of `[0, 1]`.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

fn gauss(f: &impl Fn(Vec3) -> f64, z: [f64; 2], phi: [f64; 2]) -> f64 {
    corners(f, z, phi, GAUSS).iter().sum::<f64>() * 0.25 * (z[1] - z[0]) * (phi[1] - phi[0])
}

/// True if the density is zero in some corners of a patch and matters in others.
fn ends_here(f: &impl Fn(Vec3) -> f64, z: [f64; 2], phi: [f64; 2], tolerance: f64) -> bool {
    // Not on the sides themselves, of which some are the horizon.
    let corners = corners(f, z, phi, [1e-3, 1.0 - 1e-3]).map(|v| v * (z[1] - z[0]) * (phi[1] - phi[0]));
    corners.contains(&0.0) && corners.iter().any(|v| *v > tolerance)
}

/// Levels of division that are always made, and that are made at most.
const LEVELS: RangeInclusive<u32> = 2..=9;
/// Levels where something was overlooked.
const FINE_LEVELS: RangeInclusive<u32> = 6..=11;
/// Relative differences below this are rounding of single precision.
const ROUNDING: f64 = 1e-5;

/// The integral over a patch in `(z, φ)`, dividing it in four where the rule and its refinement differ, and where the
/// density ends: there they may agree by chance. `whole` is the rule's value for the patch, where it is known.
fn integrate_patch(
    f: &impl Fn(Vec3) -> f64,
    (z, phi): ([f64; 2], [f64; 2]),
    tolerance: f64,
    levels: &RangeInclusive<u32>,
    level: u32,
    whole: Option<f64>,
) -> f64 {
    let (zm, pm) = (0.5 * (z[0] + z[1]), 0.5 * (phi[0] + phi[1]));
    let quarters = [
        ([z[0], zm], [phi[0], pm]),
        ([z[0], zm], [pm, phi[1]]),
        ([zm, z[1]], [phi[0], pm]),
        ([zm, z[1]], [pm, phi[1]]),
    ];
    let mut parts = [None; 4];
    if level >= *levels.start() {
        let whole = whole.unwrap_or_else(|| gauss(f, z, phi));
        let found = quarters.map(|(z, phi)| gauss(f, z, phi));
        let sum: f64 = found.iter().sum();
        let agree = (sum - whole).abs() < tolerance.max(ROUNDING * sum.abs());
        if level >= *levels.end() || (agree && !ends_here(f, z, phi, tolerance)) {
            return sum;
        }
        parts = found.map(Some);
    }
    let divided = quarters.into_iter().zip(parts);
    divided.map(|(quarter, part)| integrate_patch(f, quarter, 0.25 * tolerance, levels, level + 1, part)).sum()
}
