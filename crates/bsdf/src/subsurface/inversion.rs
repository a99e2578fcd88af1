//! Albedo inversion: the scattering below a surface for which a given part of the light comes back.

use super::Emergence;
use crate::gaussian::erfc_scaled;
use std::sync::OnceLock;
use steradian_math::{
    Vec2,
    hash::HashRng,
    warp::{cosine_hemisphere, exponential, sample_hg},
};

/// The albedo of single scattering, isotropic, for which a deep medium without a boundary that reflects gives back the
/// part `albedo` of diffuse light: the inverse of [`deep_albedo`].
pub fn deep_single_scattering(albedo: f32) -> f32 {
    let a = albedo.clamp(0.0, 1.0);
    // 0.139 s² − (1.139 + 1.17 a) s + 1 − a = 0: the lesser root, written so that nothing cancels.
    let b = 1.139 + 1.17 * a;
    let s = 2.0 * (1.0 - a) / (b + (b * b - 0.556 * (1.0 - a)).max(0.0).sqrt());
    (1.0 - s * s).clamp(0.0, 1.0)
}

/// The part of diffuse light that a deep medium of isotropic scattering gives back, without a boundary that reflects:
/// van de Hulst's fit (1980, Multiple Light Scattering), `(1 − s)(1 − 0.139 s)/(1 + 1.17 s)` with `s = √(1 − a)`.
pub fn deep_albedo(single: f32) -> f32 {
    let s = (1.0 - single).max(0.0).sqrt();
    (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
}

/// Walks that are simulated.
const WALKS: u32 = 1 << 15;
/// Events after which walks are no longer followed.
const MOST_EVENTS: usize = 2048;
/// Albedos that are tabulated.
const ROWS: usize = 129;

/// Albedo of random walks below a flat surface, by the albedo of single scattering; computed on first use, which takes
/// a second at most.
#[derive(Debug)]
pub struct WalkAlbedo {
    boundary: Emergence,
    g: f32,
    rows: OnceLock<Vec<f32>>,
}

impl WalkAlbedo {
    /// Below a boundary, with this mean cosine of the phase function. Walks in a medium that absorbs nothing are
    /// simulated once; of one that comes back after n events, an albedo a leaves aⁿ.
    pub fn new(boundary: Emergence, g: f32) -> Self {
        Self { boundary, g, rows: OnceLock::new() }
    }

    fn simulate(boundary: &Emergence, g: f32) -> Vec<f32> {
        let (mut rng, mut counts) = (HashRng::new(0x5eed), vec![0u32; MOST_EVENTS]);
        for _ in 0..WALKS {
            if let Some(n) = events_below(boundary, g, &mut rng) {
                counts[n] += 1;
            }
        }
        // Σ aⁿ count(n): the walks once simulated serve every albedo.
        let row = |i: usize| {
            let a = Self::single(i);
            let mut power = 1.0f64;
            let mut sum = 0.0;
            for &count in &counts {
                sum += power * f64::from(count);
                power *= a;
            }
            // The rest come back after n events with a density in proportion to n^(−3/2), as diffusion has it: with x =
            // √(−M ln a) they bring e^(−x²) (1 − √π x e^(x²) erfc x).
            let lost = f64::from(WALKS - counts.iter().sum::<u32>());
            let x = (-(MOST_EVENTS as f64) * a.max(f64::MIN_POSITIVE).ln()).sqrt();
            let tail = (-x * x).exp() * (1.0 - std::f64::consts::PI.sqrt() * x * f64::from(erfc_scaled(x as f32)));
            ((sum + lost * tail.max(0.0)) / f64::from(WALKS)) as f32
        };
        let mut rows: Vec<f32> = (0..ROWS - 1).map(row).collect();
        // Where nothing is absorbed all comes back.
        rows.push(1.0);
        rows
    }

    /// The albedo of single scattering of a row: closer to each other towards one.
    fn single(row: usize) -> f64 {
        let x = 1.0 - row as f64 / (ROWS - 1) as f64;
        1.0 - x * x * x
    }

    /// The albedo of single scattering for which this part of the light that enters comes back.
    pub fn single_scattering(&self, albedo: f32) -> f32 {
        let rows = self.rows.get_or_init(|| Self::simulate(&self.boundary, self.g));
        let high = rows.partition_point(|a| *a < albedo).clamp(1, ROWS - 1);
        let [a, b] = [rows[high - 1], rows[high]];
        let t = if b > a { f64::from(((albedo - a) / (b - a)).clamp(0.0, 1.0)) } else { 0.0 };
        // Between rows the root of what is absorbed is taken for linear, as it is near one.
        let [p, q] = [high - 1, high].map(|row| (1.0 - Self::single(row)).sqrt());
        let root = p + t * (q - p);
        (1.0 - root * root) as f32
    }
}

/// Number of scattering events of one random walk below a flat surface before it leaves.
fn events_below(boundary: &Emergence, g: f32, rng: &mut HashRng) -> Option<usize> {
    // Light that enters has, of each direction, what the boundary lets through.
    let mut inwards = loop {
        let w = cosine_hemisphere(Vec2::new(rng.next_f32(), rng.next_f32()));
        if rng.next_f32() * boundary.most_passed() < boundary.passed(w.z) {
            break boundary.refracted(w)?;
        }
    };
    let (mut z, mut n) = (0.0, 0);
    loop {
        // Free flight by the exponential distribution, in mean free paths.
        z += inwards.z * exponential(rng.next_f32(), 1.0);
        if z >= 0.0 {
            // How far it went beyond the surface says how far it had to go on from there.
            let beyond = z / inwards.z;
            if rng.next_f32() >= boundary.reflected_within(inwards.z) {
                return Some(n);
            }
            inwards.z = -inwards.z;
            z = inwards.z * beyond;
        }
        n += 1;
        if n == MOST_EVENTS {
            return None;
        }
        inwards = sample_hg(-inwards, g, Vec2::new(rng.next_f32(), rng.next_f32())).0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light that is diffuse comes back from a half space of isotropic scattering by `1 − 2 √(1 − a) ∫ H(μ) μ dμ`, with
    /// Chandrasekhar's H by iteration of its integral equation (Radiative Transfer, 1950, V): van de Hulst's fit, and
    /// walks below a boundary that reflects nothing, give it.
    #[test]
    fn half_spaces_give_back_what_was_asked_for() {
        let n = 400;
        let mu: Vec<f64> = (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).collect();
        let walks = WalkAlbedo::new(Emergence::new(1.0), 0.0);
        for albedo in [0.1f32, 0.4, 0.7, 0.9, 0.98] {
            for (single, allowed) in [(deep_single_scattering(albedo), 0.004), (walks.single_scattering(albedo), 0.006)]
            {
                let a = f64::from(single);
                let mut h = vec![1.0f64; mu.len()];
                for _ in 0..200 {
                    // 1/H = √(1 − a) + a/2 ∫ μ' H(μ')/(μ + μ') dμ'.
                    let next = |m: f64| {
                        let sum: f64 = mu.iter().zip(&h).map(|(x, h)| x * h / (m + x)).sum();
                        1.0 / ((1.0 - a).sqrt() + 0.5 * a * sum / f64::from(n))
                    };
                    h = mu.iter().map(|m| next(*m)).collect();
                }
                let first: f64 = mu.iter().zip(&h).map(|(m, h)| m * h).sum::<f64>() / f64::from(n);
                let found = 1.0 - 2.0 * (1.0 - a).sqrt() * first;
                assert!((found - f64::from(albedo)).abs() < allowed, "{albedo}: {found}");
                assert!((deep_albedo(deep_single_scattering(albedo)) - albedo).abs() < 1e-4);
            }
        }
    }
}
