//! Saved state of a render by passes, and the states of parts of one that are joined.
//!
//! A state has the sums that its number of passes tells: of a whole render those of all full blocks together, of a part
//! those of each full block, and of the block under way.

use super::{Blocks, Pass, Passes, sums::Sums};
use crate::{
    Counters,
    pieces::{already_there, incomplete, invalid, within},
    state::{In, Out, State, fields},
    state_checks,
};
use std::{
    io::{self, Read, Write},
    ops::Range,
    time::Duration,
};

/// Numbers before the sums.
struct Progress {
    /// Blocks that are computed: first and end.
    pieces: [u32; 2],
    total: u32,
    passes: u32,
    look: u32,
    is_good_enough: bool,
    counters: Counters,
    time: [Duration; 2],
}

fields! {
    Progress { pieces, total, passes, look, is_good_enough, counters, time }
}

impl Blocks {
    /// Writes the sums.
    fn save(&mut self, codec: &mut Out<'_>) -> io::Result<()> {
        if self.part().is_none() {
            self.sums.pass(codec)?;
        }
        self.apart.values_mut().chain(&mut self.block).try_for_each(|block| block.pass(codec))
    }

    /// Reads the sums of so many passes into blocks without any.
    fn restore(&mut self, passes: u32, codec: &mut In<'_>) -> io::Result<()> {
        let part = self.part();
        let first = part.as_ref().map_or(0, |part| part.start);
        let (end, mut next) = (first + passes, first);
        let shape = self.shape;
        let mut read = |passes: Range<u32>| {
            let mut sums = Sums::new(&shape, passes.start);
            sums.passes = passes;
            sums.pass(codec)?;
            if sums.is_sound() { Ok(sums) } else { Err(invalid()) }
        };
        (self.block, self.joined) = (None, Vec::new());
        self.apart.clear();
        if part.is_none() {
            next = end / self.length * self.length;
            self.sums = read(0..next)?;
        }
        while next < end {
            let block = read(next..end.min(next + self.length))?;
            next = block.passes.end;
            self.put(block);
        }
        Ok(())
    }
}

impl<P: Pass> Passes<P> {
    pub(super) fn save_state(&mut self, out: &mut dyn Write) -> io::Result<()> {
        if self.blocks.is_joining() {
            return Err(incomplete());
        }
        let codec = &mut Out(out);
        let pieces = self.blocks.pieces();
        let mut progress = Progress {
            pieces: [pieces.start, pieces.end],
            total: self.total,
            passes: self.blocks.passes(),
            look: self.look,
            is_good_enough: self.is_good_enough,
            counters: self.counters.clone(),
            time: self.time,
        };
        progress.pass(codec)?;
        self.blocks.save(codec)
    }

    pub(super) fn restore_state(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let codec = &mut In(from);
        let progress = self.progress(&self.blocks.pieces(), codec)?;
        self.blocks.restore(progress.passes, codec)?;
        let Progress { total, look, is_good_enough, counters, time, .. } = progress;
        (self.total, self.look, self.is_good_enough) = (total, look, is_good_enough);
        (self.counters, self.time) = (counters, time);
        Ok(())
    }

    /// Reads the numbers of a state of these blocks, and believes only what steps can have led to.
    fn progress(&self, pieces: &Range<u32>, codec: &mut In<'_>) -> io::Result<Progress> {
        let mut p = Progress {
            pieces: [0; 2],
            total: 0,
            passes: 0,
            look: 0,
            is_good_enough: false,
            counters: Counters::default(),
            time: [Duration::ZERO; 2],
        };
        p.pass(codec)?;
        let (plan, is_part) = (&self.plan, *pieces != (0..self.blocks.count()));
        let all = match is_part {
            true => self.blocks.passes_of(pieces.clone()).len() as u32,
            false => p.total.div_ceil(self.integrator.samples_per_pass().max(1)),
        };
        let is_sound = p.pieces == [pieces.start, pieces.end]
            && state_checks::is_total(p.total, plan.sampler.spp)
            && (!is_part || p.total == plan.sampler.spp)
            && p.passes <= all
            && state_checks::is_look(p.look, p.passes, plan.error)
            && !(p.is_good_enough && plan.error.is_none())
            && state_checks::are_counters(&p.counters);
        if is_sound { Ok(p) } else { Err(invalid()) }
    }

    pub(super) fn join_state(&mut self, from: &mut dyn Read, pieces: Range<u32>) -> io::Result<()> {
        let of = crate::Session::pieces(self).map_err(|_| invalid())?;
        within(&pieces, of).map_err(|_| invalid())?;
        let here = self.blocks.pieces();
        let is_new = self.total == self.plan.sampler.spp && self.blocks.passes() == 0;
        if pieces.start < here.start || pieces.end > here.end || !is_new && self.blocks.joined.is_empty() {
            return Err(invalid());
        }
        self.blocks.joined.resize(of as usize, false);
        let joined = &mut self.blocks.joined[pieces.start as usize..pieces.end as usize];
        if joined.contains(&true) {
            return Err(already_there());
        }
        joined.fill(true);
        // Finished, and not gone on with beyond the plan.
        let codec = &mut In(from);
        let progress = self.progress(&pieces, codec)?;
        let passes = self.blocks.passes_of(pieces.clone());
        let mut counters = self.counters.clone();
        counters += &progress.counters;
        let is_finished = progress.total == self.total && progress.passes as usize == passes.len();
        if !is_finished || !state_checks::are_counters(&counters) {
            return Err(invalid());
        }
        if pieces == (0..of) {
            self.blocks.restore(progress.passes, codec)?;
            self.blocks.joined = vec![true; of as usize];
        } else {
            let mut part = self.blocks.part_of(pieces);
            part.restore(progress.passes, codec)?;
            part.apart.into_values().chain(part.block).for_each(|block| self.blocks.put(block));
        }
        self.counters = counters;
        (0..2).for_each(|k| self.time[k] = self.time[k].saturating_add(progress.time[k]));
        Ok(())
    }
}
