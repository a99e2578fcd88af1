//! Saved state of a frame.

use super::{
    Frame, lock,
    pieces::ELSEWHERE,
    scales::{Even, SCALES},
    tile::Cell,
};
use crate::{
    adaptive::Round,
    pieces::{incomplete, invalid},
    state::{Codec, In, Out, State, fields},
};
use std::{
    io::{self, Read, Write},
    sync::atomic::AtomicU32,
};
use steradian_core::film::{Half, Pixel};

fields! {
    Round { number, start, end }
    Cell { target, rays, samples, variance, freedom }
    Even { sum, samples }
}

impl Frame {
    pub(super) fn save(&mut self, out: &mut dyn Write) -> io::Result<()> {
        if self.is_joining() {
            return Err(incomplete());
        }
        self.pass(&mut Out(out))
    }

    pub(super) fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.pass(&mut In(from))?;
        self.set_targets();
        if self.is_sound() { Ok(()) } else { Err(invalid()) }
    }

    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
        let mut pieces = [self.pieces.start, self.pieces.end];
        pieces.pass(codec)?;
        if pieces != [self.pieces.start, self.pieces.end] {
            return Err(invalid());
        }
        self.total.pass(codec)?;
        self.round.pass(codec)?;
        self.next.pass(codec)?;
        self.look.pass(codec)?;
        self.is_complete.pass(codec)?;
        self.is_good_enough.pass(codec)?;
        self.counters.pass(codec)?;
        self.time.pass(codec)?;
        let mut errors = self.errors_of_first_round.unwrap_or([f64::NAN; SCALES.len()]);
        errors.pass(codec)?;
        self.errors_of_first_round = (!errors[0].is_nan()).then_some(errors);
        for done in self.done.iter_mut().map(AtomicU32::get_mut).filter(|done| **done != ELSEWHERE) {
            done.pass(codec)?;
        }
        let round = self.round;
        for tile in &self.tiles[self.pieces.start as usize..self.pieces.end as usize] {
            let tile = &mut *lock(tile);
            tile.cells.pass(codec)?;
            tile.pixels.pass(codec)?;
            if round.number > 0 {
                tile.past.resize(tile.pixels.len(), Pixel::default());
                tile.past.pass(codec)?;
            }
            if round.number == 0 {
                tile.even.pass(codec)?;
            }
            tile.layers.pass(codec)?;
            tile.halves.pass(codec)?;
            if round.number > 0 {
                tile.past_halves.resize(tile.halves.len(), Half::default());
                tile.past_halves.pass(codec)?;
            }
        }
        Ok(())
    }
}
