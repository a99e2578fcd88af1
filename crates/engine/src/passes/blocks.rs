//! Sums of passes in blocks: pieces of a render that are computed apart and joined.
//!
//! Sums of floating point numbers depend on their order. So passes are cut into blocks of equal length, which the plan
//! fixes. The film's sums are the sums, in the order of blocks, of the sums of each block's passes in theirs. A render
//! as a whole keeps the sums of all full blocks together, and those of the block under way. One that is restricted to
//! some blocks keeps each apart; joined to the others, they are added as soon as all before them are there.

use super::sums::Sums;
use std::{borrow::Cow, collections::BTreeMap, ops::Range};
use steradian_core::film::{Crop, Film, FirstHit, LayerInputs, PassFilm, Pixel};

/// Most blocks of a plan.
const MOST: u32 = 64;

/// Size of the sums of a pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub pixels: usize,
    /// Groups of lights that are summed apart.
    pub groups: usize,
    pub inputs: LayerInputs,
}

impl Shape {
    /// True if layers depend on what camera rays see first.
    pub fn has_hits(&self) -> bool {
        self.inputs.has(LayerInputs::FIRST_HITS) || self.inputs.has(LayerInputs::MATTES)
    }
}

/// Sums of passes.
#[derive(Debug)]
pub(super) struct Blocks {
    pub shape: Shape,
    /// Passes of the plan, and of a block.
    pub planned: u32,
    pub length: u32,
    /// Blocks that are computed here, where these are not all.
    part: Option<Range<u32>>,
    /// Sums of full blocks from the first on.
    pub sums: Sums,
    /// Full blocks that cannot be added to these as yet, by number.
    pub apart: BTreeMap<u32, Sums>,
    /// The block that is not full.
    pub block: Option<Sums>,
    /// True for blocks that were joined; empty where none was.
    pub joined: Vec<bool>,
}

impl Blocks {
    /// Blocks of a plan of so many passes.
    pub fn new(shape: Shape, planned: u32) -> Self {
        Self {
            planned,
            length: planned.div_ceil(MOST).max(1),
            part: None,
            sums: Sums::new(&shape, 0),
            apart: BTreeMap::new(),
            block: None,
            joined: Vec::new(),
            shape,
        }
    }

    /// Blocks without passes of a part of a plan like this one.
    pub fn part_of(&self, pieces: Range<u32>) -> Self {
        let mut blocks = Self::new(Shape { pixels: 0, ..self.shape }, self.planned);
        blocks.shape = self.shape;
        blocks.part = Some(pieces);
        blocks
    }

    /// Number of blocks.
    pub fn count(&self) -> u32 {
        self.planned.div_ceil(self.length)
    }

    /// Blocks that are computed here.
    pub fn pieces(&self) -> Range<u32> {
        self.part.clone().unwrap_or(0..self.count())
    }

    /// Passes of the plan in a range of blocks.
    pub fn passes_of(&self, blocks: Range<u32>) -> Range<u32> {
        blocks.start * self.length..blocks.end.saturating_mul(self.length).min(self.planned)
    }

    /// The passes that are taken here, if these are not all.
    pub fn part(&self) -> Option<Range<u32>> {
        self.part.clone().map(|part| self.passes_of(part))
    }

    /// Number of passes that are there.
    pub fn passes(&self) -> u32 {
        let of = |sums: &Sums| sums.passes.len() as u32;
        of(&self.sums) + self.apart.values().chain(&self.block).map(of).sum::<u32>()
    }

    /// Number of the pass to be taken next.
    pub fn next(&self) -> u32 {
        self.part().map_or(0, |part| part.start) + self.passes()
    }

    /// Begins with these blocks, without passes, and leaves all others to others.
    pub fn restrict(&mut self, pieces: Range<u32>) {
        (self.apart, self.block, self.joined) = (BTreeMap::new(), None, Vec::new());
        // A session that computes all of them is one like any other.
        self.part = (pieces != (0..self.count())).then_some(pieces);
        // Sums of a part are those of its blocks.
        let pixels = if self.part.is_some() { 0 } else { self.shape.pixels };
        self.sums = Sums::new(&Shape { pixels, ..self.shape }, 0);
    }

    /// Adds the next pass and what its camera rays see first.
    pub fn add(&mut self, film: &PassFilm<'_>, hits: &[Vec<FirstHit>]) {
        if self.length == 1 && self.part.is_none() {
            // As a block of one pass would.
            return self.sums.add(film, hits);
        }
        let next = self.next();
        let mut block = self.block.take().unwrap_or_else(|| Sums::new(&self.shape, next));
        block.add(film, hits);
        self.put(block);
    }

    /// Takes a block, full or not, with those that follow on it.
    pub fn put(&mut self, block: Sums) {
        if (block.passes.len() as u32) < self.length {
            self.block = Some(block);
            return;
        }
        self.apart.insert(block.passes.start / self.length, block);
        while self.part.is_none()
            && let Some(next) = self.apart.remove(&(self.sums.passes.end / self.length))
        {
            self.sums.join(&next);
        }
    }

    /// True if some of the blocks were joined, and not all as yet.
    pub fn is_joining(&self) -> bool {
        !self.joined.is_empty() && self.pieces().any(|piece| !self.joined[piece as usize])
    }

    /// True if all blocks were joined.
    pub fn is_joined(&self) -> bool {
        !self.joined.is_empty() && !self.is_joining()
    }

    /// The blocks behind the sums, in their order.
    fn rest(&self) -> impl Iterator<Item = &Sums> {
        self.apart.values().chain(&self.block)
    }

    /// The sums of pixels.
    pub fn pixels(&self) -> Cow<'_, [Pixel]> {
        if self.part.is_none() && self.rest().next().is_none() {
            return Cow::Borrowed(&self.sums.pixels);
        }
        let mut pixels = self.sums.pixels.clone();
        pixels.resize(self.shape.pixels, Pixel::default());
        for block in self.rest() {
            pixels.iter_mut().zip(&block.pixels).for_each(|(sums, of)| sums.add_sums(of));
        }
        Cow::Owned(pixels)
    }

    /// The film as it is.
    pub fn film(&self, crop: Crop) -> Film {
        let mut sums = if self.part.is_some() { Sums::new(&self.shape, 0) } else { self.sums.clone() };
        self.rest().for_each(|block| sums.join(block));
        let even = self.sums.even_passes() + self.rest().map(Sums::even_passes).sum::<u32>();
        let halves = sums.halves(even);
        Film { crop, pixels: sums.pixels, layers: sums.layers, halves, bins: 0, bands: None }
    }
}
