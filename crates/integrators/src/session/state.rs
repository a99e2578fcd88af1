//! The state of a session on its way to bytes and back. What is named here goes both ways, in this order,
//! little-endian.

use super::{
    Session, lock,
    scales::{Half, SCALES},
    tile::Cell,
};
use crate::{Counters, adaptive::Round};
use std::{
    io::{self, Error, ErrorKind, Read, Write},
    time::Duration,
};
use steradian_core::film::{FirstHit, FirstHitSums, Hits, MatteSums, Pixel};

/// Turns bytes of values into bytes of a file, or those of a file into those of values.
pub(crate) trait Codec {
    fn pass(&mut self, bytes: &mut [u8]) -> io::Result<()>;
}

pub(crate) struct Out<'w>(pub &'w mut dyn Write);

impl Codec for Out<'_> {
    fn pass(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }
}

pub(crate) struct In<'r>(pub &'r mut dyn Read);

impl Codec for In<'_> {
    fn pass(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.0.read_exact(bytes)
    }
}

/// What is kept.
pub(crate) trait State {
    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()>;
}

macro_rules! numbers {
    ($($number:ty),*) => { $(
        impl State for $number {
            fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
                let mut bytes = self.to_le_bytes();
                codec.pass(&mut bytes)?;
                *self = Self::from_le_bytes(bytes);
                Ok(())
            }
        }
    )* };
}

macro_rules! fields {
    ($($whole:ty { $($field:ident),* })*) => { $(
        impl State for $whole {
            fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
                $(self.$field.pass(codec)?;)*
                Ok(())
            }
        }
    )* };
}

numbers!(u32, u64, f32, f64);

fields! {
    Round { number, start, end }
    Counters { rays, samples, nonfinite }
    Cell { target, rays, samples, variance, freedom }
    Pixel { sum, sum_squares, samples }
    Half { sum, samples }
    FirstHit { albedo, normal, geometric_normal, position, depth, distance, uv, shape, material, coverage }
    FirstHitSums { sum, samples }
    Hits { ids, counts }
    MatteSums { objects, materials, samples }
}

impl State for bool {
    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
        let mut number = u32::from(*self);
        number.pass(codec)?;
        *self = number != 0;
        Ok(())
    }
}

impl State for Duration {
    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
        let mut nanoseconds = u64::try_from(self.as_nanos()).unwrap_or(u64::MAX);
        nanoseconds.pass(codec)?;
        *self = Self::from_nanos(nanoseconds);
        Ok(())
    }
}

impl<T: State, const N: usize> State for [T; N] {
    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
        self.iter_mut().try_for_each(|value| value.pass(codec))
    }
}

impl<T: State> State for Vec<T> {
    /// Of a length that is known.
    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
        self.iter_mut().try_for_each(|value| value.pass(codec))
    }
}

impl Session<'_> {
    /// Writes what it takes to go on later. Not while a step is under way, which `&mut` sees to.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn save(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.pass(&mut Out(out))
    }

    /// Goes on from what another session of the same scene and plan [saved](Self::save); the picture then has the bits
    /// of one that was never left. How many threads there are may differ.
    ///
    /// # Errors
    /// Those of the reader, and [`ErrorKind::InvalidData`] where no such session can have been; the session is of no
    /// use then.
    pub fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.pass(&mut In(from))?;
        self.aim();
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
        self.wall.pass(codec)?;
        self.cpu.pass(codec)?;
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
            tile.features.pass(codec)?;
            tile.mattes.pass(codec)?;
            tile.by_light.pass(codec)?;
        }
        Ok(())
    }
}
