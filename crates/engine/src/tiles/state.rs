//! Saved state of a frame.

use super::{
    Frame, lock,
    scales::{Even, SCALES},
    tile::Cell,
};
use crate::{
    adaptive::Round,
    state::{Codec, In, Out, State, fields},
};
use std::io::{self, Error, ErrorKind, Read, Write};
use steradian_core::film::{Half, Pixel};

fields! {
    Round { number, start, end }
    Cell { target, rays, samples, variance, freedom }
    Even { sum, samples }
}

impl Frame {
    pub(super) fn save(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.pass(&mut Out(out))
    }

    pub(super) fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.pass(&mut In(from))?;
        self.set_targets();
        if self.is_sound() { Ok(()) } else { Err(Error::from(ErrorKind::InvalidData)) }
    }

    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
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
        for done in &mut self.done {
            done.get_mut().pass(codec)?;
        }
        let round = self.round;
        for tile in &self.tiles {
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
