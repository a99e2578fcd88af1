//! Samplers: random numbers as a pure function of (pixel, sample index, dimension, seed).
//!
//! A path asks for its numbers by dimension, so it does not matter in which order, on which thread, or in which run they are drawn.

use steradian_math::{
    Vec2,
    hash::{ONE_MINUS_EPSILON, combine32, mix32, unit_f32},
    sobol,
};

/// Which point set the samples of a pixel form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent uniform numbers.
    Independent,
    /// One number in each of `spp` strata (a jittered grid in two dimensions), in an order shuffled per dimension.
    Stratified,
    /// The Sobol' sequence, padded in pairs of dimensions that are each shuffled and Owen-scrambled by hashing (Burley 2020,
    /// "Practical Hash-based Owen Scrambling").
    #[default]
    Sobol,
}

/// The samplers by name, for the registry: name, kind, what it is.
pub const SAMPLERS: &[(&str, SamplerKind, &str)] = &[
    ("sobol", SamplerKind::Sobol, "Owen-scrambled Sobol' pairs, shuffled per dimension (Burley 2020); the default"),
    ("independent", SamplerKind::Independent, "independent uniform random numbers"),
    ("stratified", SamplerKind::Stratified, "jittered strata over the samples of a pixel, shuffled per dimension"),
];

/// A sampler for a whole image.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    /// The point set.
    pub kind: SamplerKind,
    /// Samples per pixel; the strata of [`SamplerKind::Stratified`].
    pub spp: u32,
    /// Chooses among statistically equal images.
    pub seed: u64,
}

impl Sampler {
    /// The sampler of one sample of one pixel.
    #[inline]
    pub fn pixel(&self, x: u32, y: u32, index: u32) -> PixelSampler {
        let seed = combine32(combine32(mix32(self.seed as u32 ^ (self.seed >> 32) as u32 ^ 0x5d4e_8a1b), x), y);
        PixelSampler { kind: self.kind, spp: self.spp.max(1), seed, index }
    }

    /// The sampler of one sample of a group of pixels, whose samples together form one point set: the member `rank` of `of` has a block of
    /// consecutive points, so that its own are stratified too. `x`, `y` and `group` name the group.
    #[inline]
    pub fn group(&self, x: u32, y: u32, group: u32, index: u32, rank: u32, of: u32) -> PixelSampler {
        let base = mix32(self.seed as u32 ^ (self.seed >> 32) as u32 ^ 0x91e1_0da5);
        let seed = combine32(combine32(combine32(base, x), y), group);
        let block = self.spp.clamp(1, LARGEST_BLOCK).next_power_of_two();
        let index = (index / block * of + rank).wrapping_mul(block).wrapping_add(index % block);
        PixelSampler { kind: self.kind, spp: self.spp.max(1).saturating_mul(of), seed, index }
    }
}

/// Most consecutive points of a member of a group.
const LARGEST_BLOCK: u32 = 1024;

/// The random numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSampler {
    kind: SamplerKind,
    spp: u32,
    seed: u32,
    index: u32,
}

impl PixelSampler {
    /// The number in `[0, 1)` of a dimension.
    #[inline]
    pub fn get_1d(&self, dimension: u32) -> f32 {
        let seed = combine32(self.seed, dimension);
        match self.kind {
            SamplerKind::Sobol => sobol::shuffled_scrambled_sobol_1d(self.index, seed),
            SamplerKind::Independent => unit_f32(combine32(seed, self.index)),
            SamplerKind::Stratified => {
                let stratum = permute(self.index % self.spp, self.spp, seed);
                stratum_point(stratum, self.spp, combine32(seed, self.index ^ 0x68bc_21eb))
            }
        }
    }

    /// The number of a dimension if it is needed, else one half.
    #[inline]
    pub fn get_1d_lazily(&self, dimension: u32, needed: bool) -> f32 {
        if needed { self.get_1d(dimension) } else { 0.5 }
    }

    /// The point in `[0, 1)²` of a dimension (the pair counts as one).
    #[inline]
    pub fn get_2d(&self, dimension: u32) -> Vec2 {
        let seed = combine32(self.seed, dimension);
        match self.kind {
            SamplerKind::Sobol => Vec2::from(sobol::shuffled_scrambled_sobol_2d(self.index, seed)),
            SamplerKind::Independent => {
                let a = combine32(seed, self.index);
                Vec2::new(unit_f32(a), unit_f32(mix32(a ^ 0x02e5_be93)))
            }
            SamplerKind::Stratified => {
                let columns = (self.spp as f32).sqrt() as u32;
                let columns = columns.max(1);
                let rows = self.spp.div_ceil(columns);
                let cells = columns * rows;
                let cell = permute(self.index % self.spp, cells, seed);
                let (a, b) = (combine32(seed, self.index ^ 0x68bc_21eb), combine32(seed, self.index ^ 0x02e5_be93));
                Vec2::new(stratum_point(cell % columns, columns, a), stratum_point(cell / columns, rows, b))
            }
        }
    }

    /// A hash of everything this sample is for, to seed decisions that need more numbers than dimensions.
    #[inline]
    pub fn hash(&self, dimension: u32) -> u32 {
        combine32(combine32(self.seed, dimension), self.index ^ 0x9e37_79b9)
    }
}

/// A jittered point of one of `n` strata of the unit interval.
fn stratum_point(stratum: u32, n: u32, jitter: u32) -> f32 {
    ((stratum as f32 + unit_f32(jitter)) / n as f32).min(ONE_MINUS_EPSILON)
}

/// A random permutation of `0..n`, evaluated at `i` (Kensler 2013, "Correlated Multi-Jittered Sampling").
fn permute(mut i: u32, n: u32, p: u32) -> u32 {
    let w = n.next_power_of_two().wrapping_sub(1);
    loop {
        i ^= p;
        i = i.wrapping_mul(0xe170_893d);
        i ^= p >> 16;
        i ^= (i & w) >> 4;
        i ^= p >> 8;
        i = i.wrapping_mul(0x0929_eb3f);
        i ^= p >> 23;
        i ^= (i & w) >> 1;
        i = i.wrapping_mul(1 | p >> 27);
        i = i.wrapping_mul(0x6935_fa69);
        i ^= (i & w) >> 11;
        i = i.wrapping_mul(0x74dc_b303);
        i ^= (i & w) >> 2;
        i = i.wrapping_mul(0x9e50_1cc3);
        i ^= (i & w) >> 2;
        i = i.wrapping_mul(0xc860_a3df);
        i &= w;
        i ^= i >> 5;
        if i < n {
            return (i.wrapping_add(p)) % n;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds() -> impl Iterator<Item = SamplerKind> {
        SAMPLERS.iter().map(|s| s.1)
    }

    #[test]
    fn permutations_are_bijective() {
        for n in [1, 2, 3, 7, 64, 100] {
            let mut seen = vec![false; n as usize];
            (0..n).for_each(|i| seen[permute(i, n, 0x1234_5678) as usize] = true);
            assert!(seen.iter().all(|&s| s));
        }
    }

    #[test]
    fn numbers_lie_in_the_unit_interval_and_integrate() {
        // ∫ x² y dx dy = 1/6; the standard error of 4096 independent samples is 0.0034.
        for kind in kinds() {
            let s = Sampler { kind, spp: 4096, seed: 7 };
            let mean = (0..4096)
                .map(|i| {
                    let p = s.pixel(3, 5, i).get_2d(9);
                    assert!(p.min_element() >= 0.0 && p.max_element() < 1.0);
                    f64::from(p.x * p.x * p.y)
                })
                .sum::<f64>()
                / 4096.0;
            assert!((mean - 1.0 / 6.0).abs() < 0.014, "{kind:?}: {mean}");
        }
    }

    /// M153: the error of stratified and low-discrepancy samples falls faster than `n^-1/2`.
    #[test]
    fn structured_samplers_converge_faster() {
        let error = |kind, n: u32| {
            let pixels = 64;
            let mse = (0..pixels)
                .map(|x| {
                    let s = Sampler { kind, spp: n, seed: 1 };
                    let mean = (0..n).map(|i| s.pixel(x, 0, i).get_2d(4)).map(|p| f64::from(p.x * p.y)).sum::<f64>();
                    (mean / f64::from(n) - 0.25).powi(2)
                })
                .sum::<f64>();
            (mse / f64::from(pixels)).sqrt()
        };
        let slope = |kind| (error(kind, 16) / error(kind, 1024)).log2() / 6.0;
        assert!((slope(SamplerKind::Independent) - 0.5).abs() < 0.15, "{}", slope(SamplerKind::Independent));
        assert!(slope(SamplerKind::Stratified) > 0.8, "{}", slope(SamplerKind::Stratified));
        assert!(slope(SamplerKind::Sobol) > 1.1, "{}", slope(SamplerKind::Sobol));
    }

    #[test]
    fn every_argument_matters() {
        for kind in kinds() {
            let s = Sampler { kind, spp: 16, seed: 1 };
            let base = s.pixel(1, 2, 3).get_1d(4);
            assert_eq!(base, s.pixel(1, 2, 3).get_1d(4));
            for other in [
                s.pixel(2, 2, 3).get_1d(4),
                s.pixel(1, 3, 3).get_1d(4),
                s.pixel(1, 2, 4).get_1d(4),
                s.pixel(1, 2, 3).get_1d(5),
                Sampler { seed: 2, ..s }.pixel(1, 2, 3).get_1d(4),
            ] {
                assert_ne!(base, other, "{kind:?}");
            }
        }
    }
}
