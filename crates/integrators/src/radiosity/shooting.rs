//! Progressive shooting (Cohen et al. 1988): the patch with the most unshot light sends it to all others, again and
//! again. It is Southwell's relaxation; only one row of form factors is needed at a time, and the picture is useful
//! from the first shots on.

use super::{
    factors::Row,
    patches::NONE,
    system::{Solved, System},
};
use glam::DVec4;

/// The state of shooting.
#[derive(Clone, Debug)]
pub struct Shooting {
    /// Irradiance so far, by patch and band.
    pub irradiance: Vec<DVec4>,
    /// Radiosity that was not shot yet.
    unshot: Vec<DVec4>,
    /// Shots so far.
    pub shots: usize,
    initial: f64,
}

impl Shooting {
    /// With all sources unshot.
    pub fn new(system: &System) -> Self {
        let unshot = system.sources.clone();
        let mut new = Self { irradiance: vec![DVec4::ZERO; unshot.len()], unshot, shots: 0, initial: 0.0 };
        new.initial = (0..system.len()).map(|i| new.power(system, i)).sum();
        new
    }

    /// Unshot light of a patch, over all bands; W.
    fn power(&self, system: &System, i: usize) -> f64 {
        let unshot = &self.unshot[i * system.bands..(i + 1) * system.bands];
        unshot.iter().map(|u| u.element_sum()).sum::<f64>() * system.areas[i]
    }

    /// Unshot light relative to that of all sources.
    pub fn left(&self, system: &System) -> f64 {
        if self.initial <= 0.0 {
            return 0.0;
        }
        (0..system.len()).map(|i| self.power(system, i)).sum::<f64>() / self.initial
    }

    /// Shoots from the patch with the most unshot light; `row` gives its form factors. By reciprocity a receiver `j`
    /// has `ΔH_j = F_ij A_i / A_j ΔB_i`.
    pub fn shoot(&mut self, system: &System, row: impl FnOnce(usize) -> Row) {
        // The patch with the most unshot light, area times radiosity.
        let brightest = (0..system.len())
            .map(|i| (self.power(system, i), i))
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let Some((_, i)) = brightest.filter(|b| b.0 > 0.0) else { return };
        let n = system.bands;
        let shot: Vec<DVec4> = self.unshot[i * n..(i + 1) * n].to_vec();
        self.unshot[i * n..(i + 1) * n].fill(DVec4::ZERO);
        // Receivers: irradiance grows, and what is reflected or transmitted becomes unshot there.
        for (j, f) in row(i) {
            let j = j as usize;
            let share = f * system.areas[i] / system.areas[j];
            for (b, shot) in shot.iter().enumerate() {
                let more = *shot * share;
                let k = j * n + b;
                self.irradiance[k] += more;
                self.unshot[k] += system.reflectance[k] * more;
                if system.twins[j] != NONE {
                    let other = system.twins[j] as usize * n + b;
                    self.unshot[other] += system.transmittance[other] * more;
                }
            }
        }
        self.shots += 1;
    }

    /// Solution so far; with the ambient term of Cohen et al. where it is asked for: as if the unshot light, over one
    /// less the mean albedo, lit all patches evenly.
    pub fn solved(mut self, system: &System, ambient: bool) -> Solved {
        let residual = self.left(system);
        if ambient {
            for b in 0..system.bands {
                let area: f64 = system.areas.iter().sum();
                let mean = |values: &[DVec4]| -> DVec4 {
                    (0..system.len()).map(|i| values[i * system.bands + b] * system.areas[i]).sum::<DVec4>() / area
                };
                // Ambient: mean unshot radiosity times 1 + ρ + ρ² + … = 1/(1 − ρ).
                let albedo = mean(&system.reflectance) + mean(&system.transmittance);
                let ambient = mean(&self.unshot) / (DVec4::ONE - albedo.min(DVec4::splat(0.99)));
                (0..system.len()).for_each(|i| self.irradiance[i * system.bands + b] += ambient);
            }
        }
        Solved { irradiance: self.irradiance, steps: self.shots, residual }
    }
}
