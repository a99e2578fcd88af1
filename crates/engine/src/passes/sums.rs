//! Sums of consecutive passes, pixel by pixel.

use super::blocks::Shape;
use crate::{
    state::{Codec, State},
    state_checks,
};
use std::{io, ops::Range};
use steradian_core::film::{FirstHit, Half, LayerInputs, LayerSums, PassFilm, Pixel};

/// Sums of some passes.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    /// Numbers of the passes.
    pub passes: Range<u32>,
    pub pixels: Vec<Pixel>,
    pub layers: LayerSums,
    /// Sums of passes of even number, by pixels; empty where they are not kept.
    even: Vec<[f64; 3]>,
}

impl Sums {
    /// No pass as yet, up to the first one.
    pub fn new(shape: &Shape, first: u32) -> Self {
        let Shape { pixels, groups, inputs } = *shape;
        Self {
            passes: first..first,
            pixels: vec![Pixel::default(); pixels],
            layers: LayerSums::new(inputs, pixels, groups, 0),
            even: vec![[0.0; 3]; if inputs.has(LayerInputs::HALVES) { pixels } else { 0 }],
        }
    }

    /// Adds the next pass and what its camera rays see first.
    pub fn add(&mut self, film: &PassFilm<'_>, hits: &[Vec<FirstHit>]) {
        for (pixel, sum) in self.pixels.iter_mut().zip(film.sums()) {
            pixel.add_value(*sum);
        }
        if self.passes.end.is_multiple_of(2) {
            add(&mut self.even, film.sums());
        }
        add(&mut self.layers.by_light, film.by_light());
        hits.iter().flatten().enumerate().for_each(|(at, hit)| self.layers.add_hit(at, hit));
        self.passes.end += 1;
    }

    /// Adds further passes; where some between are missing, those of the range count as there.
    pub fn join(&mut self, of: &Self) {
        self.pixels.iter_mut().zip(&of.pixels).for_each(|(sums, of)| sums.add_sums(of));
        self.layers.add_sums(&of.layers);
        add(&mut self.even, &of.even);
        self.passes.end = of.passes.end;
    }

    /// The halves of the pixels, where so many of the passes are even; none where they are not kept.
    pub fn halves(&self, even: u32) -> Vec<Half> {
        self.even.iter().zip(&self.pixels).map(|(sum, p)| Half::of(*sum, even, p)).collect()
    }

    /// Number of the passes that are even.
    pub fn even_passes(&self) -> u32 {
        self.passes.end.div_ceil(2) - self.passes.start.div_ceil(2)
    }

    /// True if passes can have these sums.
    pub fn is_sound(&self) -> bool {
        let passes = self.passes.len() as u32;
        let is_sum = |sum: &f64| sum.abs() <= f64::from(passes) * f64::from(f32::MAX);
        self.pixels.iter().all(|p| p.samples == passes && state_checks::is_pixel(p))
            && self.layers.features.iter().all(|sums| sums.samples == passes && state_checks::are_hits(sums))
            && self.layers.mattes.iter().all(|sums| sums.samples == passes && state_checks::are_mattes(sums))
            && self.even.iter().chain(&self.layers.by_light).flatten().all(is_sum)
    }
}

/// The sums only: which passes they are of is known.
impl State for Sums {
    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
        self.pixels.pass(codec)?;
        self.layers.pass(codec)?;
        self.even.pass(codec)
    }
}

fn add(sums: &mut [[f64; 3]], of: &[[f64; 3]]) {
    for (sum, of) in sums.iter_mut().zip(of) {
        *sum = std::array::from_fn(|c| sum[c] + of[c]);
    }
}
