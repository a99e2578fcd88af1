//! Samplers: random numbers as a pure function of (pixel, sample index, dimension, seed).
//!
//! A path asks for its numbers by dimension, so it does not matter in which order, on which thread, or in which run
//! they are drawn. Each sampler gives uniform numbers for any number of samples, and those of different dimensions, and
//! of different seeds, are independent of each other.
//!
//! The points of Sobol' samplers are pairs of dimensions, each of them shuffled and Owen-scrambled by hashing. With
//! `zsobol`, the default, the pixels of a block take consecutive runs of one sequence along a Z-curve, so that
//! neighbours err in opposite directions. Samplers named by pbrt and Mitsuba files are replaced by the default, with a
//! note: they change the noise only.

mod halton;
mod lattice;
mod permute;
mod pmj;
mod strata;
#[cfg(test)]
mod tests;

use steradian_math::{
    Vec2,
    hash::{combine32, combine64, mix32, mix64, unit_f32},
    sobol::Scramble,
};

/// Point set of a pixel's samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent uniform numbers.
    Independent,
    /// One number in each of `spp` strata (a jittered grid in two dimensions), in an order shuffled per dimension.
    Stratified,
    /// Correlated multi-jittering (Kensler 2013).
    MultiJitter,
    /// The Sobol' sequence, padded in pairs of dimensions that are each shuffled and Owen-scrambled by hashing (Burley
    /// 2020, "Practical Hash-based Owen Scrambling"); pixels are independent of each other.
    Sobol,
    /// The Sobol' sequence of which the pixels of a block take consecutive parts along a Z-curve, so that neighbours
    /// err in opposite directions (Ahmed, Wonka 2020, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error
    /// via Hierarchical Ordering of Pixels"); padded and scrambled as `Sobol`.
    #[default]
    ZSobol,
    /// Halton points with digits scrambled at random (Owen).
    Halton,
    /// Progressive multi-jittered (0,2) points that keep a distance (Christensen, Kensler, Kilpatrick 2018).
    Pmj02,
    /// A rank-1 lattice with random shifts.
    Lattice,
    /// Independent uniform numbers, one list for all pixels: their errors go together and form patterns.
    Fixed,
}

/// The samplers by name; the schema says what they are.
pub const SAMPLERS: &[(&str, SamplerKind)] = &[
    ("zsobol", SamplerKind::ZSobol),
    ("sobol", SamplerKind::Sobol),
    ("halton", SamplerKind::Halton),
    ("pmj02", SamplerKind::Pmj02),
    ("lattice", SamplerKind::Lattice),
    ("multijitter", SamplerKind::MultiJitter),
    ("stratified", SamplerKind::Stratified),
    ("independent", SamplerKind::Independent),
    ("fixed", SamplerKind::Fixed),
];

impl SamplerKind {
    /// The sampler of a name; `None` for names that are not in [`SAMPLERS`].
    pub fn named(name: &str) -> Option<Self> {
        SAMPLERS.iter().find(|s| s.0 == name).map(|s| s.1)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        SAMPLERS.iter().find(|s| s.1 == self).map_or("", |s| s.0)
    }
}

/// A sampler for a whole image.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    /// The point set.
    pub kind: SamplerKind,
    /// Samples per pixel; the strata of samplers that have a fixed number.
    pub spp: u32,
    /// Random seed.
    pub seed: u64,
}

/// log₂ of the edge of the blocks of pixels that share a sequence, and of the most samples of it that a pixel has:
/// together an index of 32 bits. Further samples are of other sequences.
const BLOCK: u32 = 8;
const LONGEST: u32 = 16;

/// Most consecutive points of a member of a group.
const LARGEST_BLOCK: u32 = 1024;

impl Sampler {
    /// The sampler of one sample of one pixel.
    #[inline]
    pub fn pixel(&self, x: u32, y: u32, index: u32) -> PixelSampler {
        if self.kind != SamplerKind::ZSobol {
            return self.with(PIXEL, [x, y, 0], index);
        }
        // Pixels along the Z-curve take consecutive runs of the sequence.
        let (seed, index) = z_order(self.base(PIXEL), [x, y], index, self.bits());
        self.at(seed, index)
    }

    /// The sampler of a pixel whose seed and index are known.
    #[inline]
    pub fn at(&self, seed: u32, index: u32) -> PixelSampler {
        PixelSampler { kind: self.kind, spp: self.spp.max(1), seed, index, reversed: index.reverse_bits() }
    }

    /// The sampler of the half that a sample of a number belongs to, by whether that is even: two sequences that are
    /// independent of each other, each of half as many samples. In its half the sample has the number `number / 2`.
    #[must_use]
    pub fn half(&self, number: u32) -> Self {
        // Halve the strata and hash the half into the seed.
        Self { spp: self.spp.div_ceil(2), seed: combine64(self.seed, HALF + u64::from(number % 2)), ..*self }
    }

    /// First argument of [`z_order`] for pixels; `None` for samplers other than `ZSobol`.
    pub fn z_base(&self) -> Option<u32> {
        (self.kind == SamplerKind::ZSobol).then(|| self.base(PIXEL))
    }

    /// A pixel's samples are 2^bits consecutive points of the block's sequence, so they are a net of their own.
    #[inline]
    pub fn bits(&self) -> u32 {
        self.spp.max(1).next_power_of_two().trailing_zeros().min(LONGEST)
    }

    #[inline]
    fn base(&self, salt: u32) -> u32 {
        mix32(self.seed as u32 ^ (self.seed >> 32) as u32 ^ salt)
    }

    /// The sampler of one sample of a group of `of` pixels, whose samples together form one point set. It is that of
    /// the first member; each has a block of consecutive points, so that its own are stratified too
    /// ([`GroupSampler::member`]). `x`, `y` and `group` name the group.
    #[inline]
    pub fn group(&self, x: u32, y: u32, group: u32, index: u32, of: u32) -> GroupSampler {
        // Members take blocks of consecutive points, a power of two each.
        let block = self.spp.clamp(1, LARGEST_BLOCK).next_power_of_two();
        let bits = block.trailing_zeros();
        let first = ((index >> bits).wrapping_mul(of) << bits) | (index & (block - 1));
        let sampler = self.with(0x91e1_0da5, [x, y, group], first);
        GroupSampler { first: PixelSampler { spp: sampler.spp.saturating_mul(of), ..sampler }, block }
    }

    /// A sample of the point set that some numbers name.
    #[inline]
    fn with(&self, salt: u32, name: [u32; 3], index: u32) -> PixelSampler {
        let name = if self.kind == SamplerKind::Fixed { [0; 3] } else { name };
        self.at(name.iter().fold(self.base(salt), |seed, n| combine32(seed, *n)), index)
    }
}

/// Salt of the seed of the first half; that of the other is one more.
const HALF: u64 = 0x9d8f_31c7_44b2_6e50;

/// Salt of pixel coordinates.
const PIXEL: u32 = 0x5d4e_8a1b;

/// Seed and index of a sample of a pixel where the pixels of a block take consecutive parts of one sequence.
#[inline(always)]
pub fn z_order(base: u32, [x, y]: [u32; 2], index: u32, bits: u32) -> (u32, u32) {
    // Blocks of pixels have seeds of their own; within one the Morton code orders them.
    let seed = combine32(combine32(combine32(base, x >> BLOCK), y >> BLOCK), index >> bits);
    let place = spread_bits(x) | spread_bits(y) << 1;
    (seed, place << bits | index & ((1 << bits) - 1))
}

/// Puts a zero above each of the last bits of a coordinate in a block.
#[inline(always)]
const fn spread_bits(v: u32) -> u32 {
    // Interleave the coordinate's bits with zeros.
    let v = v & ((1 << BLOCK) - 1);
    let v = (v | v << 4) & 0x0f0f;
    let v = (v | v << 2) & 0x3333;
    (v | v << 1) & 0x5555
}

/// The random numbers of one sample of a group of pixels.
#[derive(Clone, Copy, Debug)]
pub struct GroupSampler {
    first: PixelSampler,
    /// Points of a member.
    block: u32,
}

impl GroupSampler {
    /// Sampler of a member of the group.
    #[inline]
    pub fn member(&self, rank: u32) -> PixelSampler {
        // Later members continue where the block of the first ends.
        let index = self.first.index.wrapping_add(rank.wrapping_mul(self.block));
        PixelSampler { index, reversed: index.reverse_bits(), ..self.first }
    }
}

/// Shuffling and scrambling of the Sobol' points of a dimension, for a seed.
#[inline(always)]
pub fn sobol_scramble(seed: u32, dimension: u32) -> Scramble {
    Scramble::new(mix64(u64::from(seed) << 32 | u64::from(dimension)))
}

/// The random numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSampler {
    kind: SamplerKind,
    spp: u32,
    seed: u32,
    index: u32,
    /// The index with its bits reversed.
    reversed: u32,
}

impl PixelSampler {
    /// The number in `[0, 1)` of a dimension.
    #[inline]
    pub fn get_1d(&self, dimension: u32) -> f32 {
        // Sobol' points by hashing; the other kinds are rare and out of line.
        match self.kind {
            SamplerKind::ZSobol | SamplerKind::Sobol => self.scramble(dimension).point_1d(self.reversed),
            _ => self.other_1d(dimension),
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
        match self.kind {
            SamplerKind::ZSobol | SamplerKind::Sobol => Vec2::from(self.scramble(dimension).point_2d(self.reversed)),
            _ => self.other_2d(dimension),
        }
    }

    /// Shuffling and scrambling of the points of a dimension.
    #[inline]
    fn scramble(&self, dimension: u32) -> Scramble {
        sobol_scramble(self.seed, dimension)
    }

    /// The seed and the index with its bits reversed, of which and of a dimension its numbers are made by
    /// [`sobol_scramble`]; `None` for other points than Sobol's.
    #[inline]
    pub fn sobol(&self) -> Option<(u32, u32)> {
        matches!(self.kind, SamplerKind::ZSobol | SamplerKind::Sobol).then_some((self.seed, self.reversed))
    }

    /// Out of the way of the default.
    #[inline(never)]
    fn other_1d(&self, dimension: u32) -> f32 {
        let seed = combine32(self.seed, dimension);
        // Decorrelate dimensions by the seed; each kind then makes its own point.
        match self.kind {
            SamplerKind::Stratified | SamplerKind::MultiJitter => strata::stratified_1d(self.index, self.spp, seed),
            SamplerKind::Halton if dimension < halton::PAIRS => halton::coordinate(self.index, dimension, 0, seed),
            SamplerKind::Pmj02 => pmj::point(self.index, self.spp, seed).x,
            SamplerKind::Lattice => lattice::point(self.index, dimension, self.seed, seed).x,
            _ => unit_f32(combine32(seed, self.index)),
        }
    }

    #[inline(never)]
    fn other_2d(&self, dimension: u32) -> Vec2 {
        // The same in two dimensions; kinds without pairs of their own hash the index.
        let seed = combine32(self.seed, dimension);
        match self.kind {
            SamplerKind::Stratified => strata::stratified_2d(self.index, self.spp, seed),
            SamplerKind::MultiJitter => strata::multijitter_2d(self.index, self.spp, seed),
            SamplerKind::Halton if dimension < halton::PAIRS => {
                Vec2::from([0, 1].map(|axis| halton::coordinate(self.index, dimension, axis, seed)))
            }
            SamplerKind::Pmj02 => pmj::point(self.index, self.spp, seed),
            SamplerKind::Lattice => lattice::point(self.index, dimension, self.seed, seed),
            _ => {
                let a = combine32(seed, self.index);
                Vec2::new(unit_f32(a), unit_f32(mix32(a ^ 0x02e5_be93)))
            }
        }
    }

    /// The numbers of one of several paths that go on from a scattering event.
    #[inline]
    pub fn branch(&self, event: u32, number: u32) -> Self {
        // A new seed for each branch: its dimensions start anew.
        Self { seed: combine32(combine32(self.seed, event), number ^ 0x5851_f42d), ..*self }
    }

    /// A hash of everything this sample is for, to seed decisions that need more numbers than dimensions.
    #[inline]
    pub fn hash(&self, dimension: u32) -> u32 {
        combine32(combine32(self.seed, dimension), self.index ^ 0x9e37_79b9)
    }
}
