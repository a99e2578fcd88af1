//! Alias tables: discrete sampling in constant time (Walker 1974; Vose 1991).

use super::weight;
use crate::hash::ONE_MINUS_EPSILON;

#[derive(Clone, Copy, Debug)]
struct Bin {
    /// Share of the bin that stays with its own index; the rest goes to `alias`.
    own: f32,
    alias: u32,
    /// Probability of the bin's own index.
    pmf: f32,
}

/// A discrete distribution sampled in constant time.
#[derive(Clone, Debug)]
pub struct AliasTable {
    bins: Vec<Bin>,
}

impl AliasTable {
    /// From weights of any scale. Negative weights count by their size, non-finite ones as zero; without a positive
    /// weight all indices are equally likely. At most `u32::MAX` weights are taken.
    pub fn new(weights: &[f32]) -> Self {
        let weights = &weights[..weights.len().min(u32::MAX as usize)];
        let n = weights.len();
        let sum: f64 = weights.iter().map(|&w| weight(w)).sum();
        if sum <= 0.0 {
            let pmf = 1.0 / n.max(1) as f32;
            return Self { bins: (0..n as u32).map(|alias| Bin { own: 1.0, alias, pmf }).collect() };
        }
        let mut bins: Vec<Bin> =
            weights.iter().map(|&w| Bin { own: 1.0, alias: 0, pmf: (weight(w) / sum) as f32 }).collect();

        // Each bin holds 1/n: the ones that are not full are filled up from those that overflow.
        let mut fill: Vec<f64> = weights.iter().map(|&w| weight(w) / sum * n as f64).collect();
        let (mut under, mut over): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| fill[i] < 1.0);
        let mut giver = 0;
        while let (Some(&small), Some(&large)) = (under.last(), over.last()) {
            under.pop();
            giver = large;
            bins[small].own = fill[small] as f32;
            bins[small].alias = large as u32;
            fill[large] -= 1.0 - fill[small];
            if fill[large] < 1.0 {
                over.pop();
                under.push(large);
            }
        }
        // Rounding may leave bins that are full but for the last digits; an index of no weight must not stay with
        // itself.
        for i in under {
            if weight(weights[i]) == 0.0 {
                bins[i].own = 0.0;
                bins[i].alias = giver as u32;
            }
        }
        Self { bins }
    }

    /// An index, its probability, and a new uniform number made of what is left of `u`. An empty table gives index 0
    /// with probability 0. The new number has `log2(n)` bits fewer than `u`.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        let n = self.bins.len();
        if n == 0 {
            return (0, 0.0, u);
        }
        let scaled = u * n as f32;
        let i = (scaled as usize).min(n - 1);
        let t = (scaled - i as f32).clamp(0.0, ONE_MINUS_EPSILON);
        let bin = &self.bins[i];
        if t < bin.own {
            (i, bin.pmf, (t / bin.own).min(ONE_MINUS_EPSILON))
        } else {
            let alias = bin.alias as usize;
            (alias, self.bins[alias].pmf, ((t - bin.own) / (1.0 - bin.own)).min(ONE_MINUS_EPSILON))
        }
    }

    /// Probability of an index; zero outside the table.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        self.bins.get(index).map_or(0.0, |b| b.pmf)
    }

    /// Number of indices.
    #[inline]
    pub fn len(&self) -> usize {
        self.bins.len()
    }

    /// True if there is no index to draw.
    pub fn is_empty(&self) -> bool {
        self.bins.is_empty()
    }
}
