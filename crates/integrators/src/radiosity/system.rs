//! The discrete radiosity equation and its solution by iteration.
//!
//! > `B_i = S_i + ρ_i H_i + τ_i H_i'`, `H_i = Σ_j F_ij B_j`
//!
//! with radiosities `B`, irradiances `H`, sources `S`, and `i'` the other side of a patch that transmits light (Goral
//! et al. 1984). Rows of `F` add up to one at most, so that the spectral radius is at most the largest albedo `ρ + τ`,
//! and iteration loses at least that factor of the error each time.

use super::{
    factors::Row,
    patches::{NONE, Patches},
};
use glam::DVec4;
use rayon::prelude::*;

/// The equation. Values are by patch and band.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// Form factors.
    pub rows: Vec<Row>,
    /// Reflectance.
    pub reflectance: Vec<DVec4>,
    /// Transmittance.
    pub transmittance: Vec<DVec4>,
    /// Sources.
    pub sources: Vec<DVec4>,
    /// The patch on the other side, or [`NONE`].
    pub twins: Vec<u32>,
    /// Areas.
    pub areas: Vec<f64>,
    /// Number of bands.
    pub bands: usize,
}

/// Sweeps over which the loss of light is told.
const SWEEPS: usize = 8;
/// Iteration ends where all sweeps that are allowed would lose less than this part of the light that is under way: the
/// solution is out of reach, or does not exist.
const LEAST_LOSS: f64 = 0.2;

/// Light that sweeps moved, W. Where none is lost, each moves as much as the one before, for ever.
#[derive(Debug, Default)]
struct Moved {
    light: [f64; SWEEPS],
    /// For how many sweeps it was so: the first ones may move more and more.
    hopeless: usize,
}

impl Moved {
    /// Notes what a sweep moved; whether `most` of them would come nowhere.
    fn is_hopeless(&mut self, sweep: usize, light: f64, most: usize) -> bool {
        // Loss per sweep over the last few; hopeless where all sweeps allowed would lose too little, several times in a
        // row.
        let before = std::mem::replace(&mut self.light[sweep % SWEEPS], light);
        let loss = (1.0 - light / before) / SWEEPS as f64;
        let is_lost = sweep < SWEEPS || loss * most as f64 >= LEAST_LOSS;
        self.hopeless = if is_lost { 0 } else { self.hopeless + 1 };
        self.hopeless == SWEEPS
    }
}

/// Result of an iteration.
#[derive(Clone, Debug, Default)]
pub struct Solved {
    /// Irradiance by patch and band, from patches alone.
    pub irradiance: Vec<DVec4>,
    /// Iterations or shots.
    pub steps: usize,
    /// The last change of a radiosity, or the light not yet shot, relative to the largest radiosity or all light.
    pub residual: f64,
}

impl System {
    /// The equation of patches without form factors.
    pub fn of(patches: &Patches) -> Self {
        Self {
            rows: Vec::new(),
            reflectance: patches.reflectance.clone(),
            transmittance: patches.transmittance.clone(),
            sources: patches.sources(),
            twins: patches.list.iter().map(|p| p.twin).collect(),
            areas: patches.list.iter().map(|p| p.area).collect(),
            bands: patches.bands,
        }
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.twins.len()
    }

    /// `H = F B` at a patch.
    fn gather(&self, i: usize, radiosity: &[DVec4], into: &mut [DVec4]) {
        // Σ_j F_ij B_j for each band.
        into.fill(DVec4::ZERO);
        for &(j, f) in &self.rows[i] {
            for (h, b) in into.iter_mut().zip(&radiosity[j as usize * self.bands..]) {
                *h += *b * f;
            }
        }
    }

    /// The radiosity that goes with irradiances.
    pub fn radiosity(&self, irradiance: &[DVec4]) -> Vec<DVec4> {
        (0..self.sources.len()).map(|k| self.radiosity_at(k / self.bands, k % self.bands, irradiance)).collect()
    }

    fn radiosity_at(&self, i: usize, b: usize, irradiance: &[DVec4]) -> DVec4 {
        let k = i * self.bands + b;
        // B = S + ρ H + τ H'.
        let through = match self.twins[i] {
            NONE => DVec4::ZERO,
            twin => irradiance[twin as usize * self.bands + b] * self.transmittance[k],
        };
        self.sources[k] + self.reflectance[k] * irradiance[k] + through
    }

    /// Jacobi's method: all irradiances from the radiosities before. Ends when no radiosity changes by more than
    /// `tolerance` of the largest, and where light is not lost.
    pub fn jacobi(&self, tolerance: f64, most: usize, tell: &dyn Fn(usize) -> bool) -> Solved {
        self.jacobi_from(self.sources.clone(), tolerance, most, tell)
    }

    /// Jacobi's method from other radiosities than the sources. From what is emitted, `most` steps are the irradiances
    /// of all light that was scattered less than `most` times: the partial sums of Neumann's series.
    pub fn jacobi_from(
        &self,
        mut radiosity: Vec<DVec4>,
        tolerance: f64,
        most: usize,
        tell: &dyn Fn(usize) -> bool,
    ) -> Solved {
        let mut irradiance = vec![DVec4::ZERO; radiosity.len()];
        let mut solved = Solved { residual: f64::INFINITY, ..Solved::default() };
        let (mut light, mut is_hopeless) = (Moved::default(), false);
        // One sweep: H = F B in parallel, then B from H, and the change between both.
        while solved.steps < most && solved.residual > tolerance && !is_hopeless && tell(solved.steps) {
            irradiance
                .par_chunks_mut(self.bands.max(1))
                .enumerate()
                .for_each(|(i, into)| self.gather(i, &radiosity, into));
            let next = self.radiosity(&irradiance);
            solved.residual = change(&radiosity, &next);
            let moved = radiosity.iter().zip(&next).enumerate().map(|(k, (a, b))| self.power(k, *b - *a)).sum();
            is_hopeless = light.is_hopeless(solved.steps, moved, most);
            radiosity = next;
            solved.steps += 1;
        }
        Solved { irradiance, ..solved }
    }

    /// The method of Gauss and Seidel: each irradiance from the newest radiosities, in both orders by turns.
    pub fn gauss_seidel(&self, tolerance: f64, most: usize, tell: &dyn Fn(usize) -> bool) -> Solved {
        let n = self.len();
        let mut radiosity = self.sources.clone();
        let mut irradiance = vec![DVec4::ZERO; radiosity.len()];
        let mut into = vec![DVec4::ZERO; self.bands];
        let mut solved = Solved { residual: f64::INFINITY, ..Solved::default() };
        let (mut light, mut is_hopeless) = (Moved::default(), false);
        while solved.steps < most && solved.residual > tolerance && !is_hopeless && tell(solved.steps) {
            let (mut largest, mut moved, mut power) = (0.0_f64, 0.0_f64, 0.0);
            for k in 0..n {
                if k.is_multiple_of(256) && !tell(0) {
                    break;
                }
                // Symmetric sweeps: forwards and backwards in turn.
                let i = if solved.steps.is_multiple_of(2) { k } else { n - 1 - k };
                self.gather(i, &radiosity, &mut into);
                irradiance[i * self.bands..(i + 1) * self.bands].copy_from_slice(&into);
                // The patch and the one behind it take the new irradiance at once.
                for i in [i as u32, self.twins[i]].into_iter().filter(|i| *i != NONE) {
                    for b in 0..self.bands {
                        let next = self.radiosity_at(i as usize, b, &irradiance);
                        let k = i as usize * self.bands + b;
                        moved = moved.max((next - radiosity[k]).abs().max_element());
                        power += self.power(k, next - radiosity[k]);
                        largest = largest.max(next.abs().max_element());
                        radiosity[k] = next;
                    }
                }
            }
            solved.residual = if largest > 0.0 { moved / largest } else { 0.0 };
            is_hopeless = light.is_hopeless(solved.steps, power, most);
            solved.steps += 1;
        }
        Solved { irradiance, ..solved }
    }

    /// The size of a change of radiosity over its patch, W.
    fn power(&self, k: usize, change: DVec4) -> f64 {
        self.areas[k / self.bands] * change.abs().element_sum()
    }

    /// The largest difference between the two sides of the equation, relative to the largest radiosity.
    pub fn residual(&self, radiosity: &[DVec4]) -> f64 {
        let mut irradiance = vec![DVec4::ZERO; radiosity.len()];
        irradiance.par_chunks_mut(self.bands.max(1)).enumerate().for_each(|(i, into)| self.gather(i, radiosity, into));
        change(radiosity, &self.radiosity(&irradiance))
    }
}

/// The largest change of a value relative to the largest value.
fn change(before: &[DVec4], after: &[DVec4]) -> f64 {
    // max |Δ| / max |B|.
    let largest = after.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
    let moved = before.iter().zip(after).map(|(a, b)| (*b - *a).abs().max_element()).fold(0.0, f64::max);
    if largest > 0.0 { moved / largest } else { 0.0 }
}
