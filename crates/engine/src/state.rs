//! The state of a session on its way to bytes and back. What is named here goes both ways, in this order,
//! little-endian.

use crate::Counters;
use std::{
    io::{self, Read, Write},
    time::Duration,
};
use steradian_core::film::{FirstHit, FirstHitSums, Half, Hits, LayerSums, MatteSums, Pixel};

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

/// Data that are kept.
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

/// Implements `State` for structures that have only such fields.
macro_rules! fields {
    ($($whole:ty { $($field:ident),* })*) => { $(
        impl $crate::state::State for $whole {
            fn pass(&mut self, codec: &mut impl $crate::state::Codec) -> std::io::Result<()> {
                $(self.$field.pass(codec)?;)*
                Ok(())
            }
        }
    )* };
}

pub(crate) use fields;

numbers!(u32, u64, f32, f64);

fields! {
    Counters { rays, samples, nonfinite }
    Half { part, weight }
    Pixel { sum, sum_squares, samples }
    FirstHit {
        albedo, normal, seen_albedo, seen_normal, geometric_normal,
        position, motion, depth, distance, uv, shape, material, coverage, opacity
    }
    FirstHitSums { sum, samples }
    LayerSums { features, mattes, by_light, by_band }
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
    /// Elements of a vector whose length is known.
    fn pass(&mut self, codec: &mut impl Codec) -> io::Result<()> {
        self.iter_mut().try_for_each(|value| value.pass(codec))
    }
}
