//! Tiles that are computed apart: a part of a render, and the whole that parts are joined to.
//!
//! Where nothing is decided over the picture and no paths share, a tile is a function of scene and plan alone, and so
//! are its sums. A part has the sums of its tiles; tiles of others are hollow. Joining copies sums, so their order does
//! not matter.

use super::{Frame, lock, tile::Tile};
use crate::{
    Counters, FIRST_LOOK,
    adaptive::Round,
    partition::CELLS,
    pieces::{already_there, invalid},
    state_checks::are_counters,
};
use std::{
    io::{self, Read},
    ops::Range,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU32, Ordering},
    },
    time::Duration,
};

/// Number of ticks that stands for tiles which are computed elsewhere: as if they were done for ever.
pub(super) const ELSEWHERE: u32 = u32::MAX;

impl Frame {
    /// True if some of the tiles are computed elsewhere.
    pub(super) fn is_part(&self) -> bool {
        self.pieces.len() < self.tiles.len()
    }

    /// True if some of the tiles were joined, and not all as yet.
    pub(super) fn is_joining(&self) -> bool {
        !self.joined.is_empty() && !self.is_joined()
    }

    /// True if all tiles were joined.
    pub(super) fn is_joined(&self) -> bool {
        self.joined.get(self.pieces.start as usize..self.pieces.end as usize).is_some_and(|all| all.iter().all(|j| *j))
    }

    /// Pixels that are computed here.
    pub(super) fn pixels(&self) -> usize {
        self.tiles.iter().map(|tile| lock(tile).pixels.len()).sum()
    }

    /// The place of a tile among [`Self::done`], which have a row and a column before the first.
    pub(super) fn done_of(&self, tile: usize) -> usize {
        let columns = self.columns / CELLS as usize;
        (tile / columns + 1) * (columns + 1) + tile % columns + 1
    }

    /// Begins with these tiles, without samples, and leaves all others to others.
    pub(super) fn restrict(&mut self, pieces: Range<u32>) {
        (self.round, self.total) = (Round::first(self.plan.sampler.spp, self.plan.adaptive), self.plan.sampler.spp);
        (self.next, self.is_complete, self.look, self.is_good_enough) = (0, true, FIRST_LOOK, false);
        (self.counters, self.time, self.errors_of_first_round) = (Counters::default(), [Duration::ZERO; 2], None);
        (self.pieces, self.joined) = (pieces, Vec::new());
        let kept = self.kept();
        for t in self.pieces.start as usize..self.pieces.end as usize {
            let mut tile = lock(&self.tiles[t]);
            *tile = Tile::new(tile.area, &self.plan, kept, self.round.length());
        }
        // A session that computes all of them is one like any other.
        self.done.iter_mut().for_each(|done| *done.get_mut() = 0);
        if self.is_part() {
            self.hollow();
        }
        self.set_targets();
        self.watch_scales();
    }

    /// Makes all tiles but those of the pieces hollow.
    fn hollow(&mut self) {
        self.done.iter_mut().for_each(|done| *done.get_mut() = ELSEWHERE);
        let here = self.pieces.start as usize..self.pieces.end as usize;
        for t in 0..self.tiles.len() {
            if here.contains(&t) {
                let at = self.done_of(t);
                *self.done[at].get_mut() = 0;
            } else {
                let mut tile = lock(&self.tiles[t]);
                if !tile.is_hollow(self.round.length()) {
                    *tile = Tile::hollow(tile.area, self.round.length());
                }
            }
        }
    }

    /// Takes over what another frame, restricted to these pieces, has saved when it was done.
    pub(super) fn join(&mut self, from: &mut dyn Read, pieces: Range<u32>) -> io::Result<()> {
        let tiles = pieces.start as usize..pieces.end as usize;
        let is_new = self.total == self.plan.sampler.spp && self.next == 0;
        if pieces.start < self.pieces.start || pieces.end > self.pieces.end || !is_new && self.joined.is_empty() {
            return Err(invalid());
        }
        self.joined.resize(self.tiles.len(), false);
        if self.joined[tiles.clone()].contains(&true) {
            return Err(already_there());
        }
        // The tiles themselves, in a frame that is restored as that of the part would be.
        let mut part = self.part(pieces);
        part.restore(from)?;
        let mut counters = self.counters.clone();
        counters += &part.counters;
        let is_finished = part.is_complete && part.next == part.total && part.total == self.total;
        if !is_finished || part.round != self.round || !are_counters(&counters) {
            return Err(invalid());
        }
        for t in tiles {
            std::mem::swap(&mut *lock(&self.tiles[t]), &mut *lock(&part.tiles[t]));
            let at = self.done_of(t);
            *self.done[at].get_mut() = part.done[at].load(Ordering::Relaxed);
            self.joined[t] = true;
        }
        self.counters = counters;
        (0..2).for_each(|k| self.time[k] = self.time[k].saturating_add(part.time[k]));
        if self.is_joined() {
            self.next = self.total;
            // Places before the first tiles have nothing to do.
            self.done.iter_mut().for_each(|done| *done.get_mut() = (*done.get_mut()).max(self.ticks));
        }
        Ok(())
    }

    /// A frame of these pieces, which takes their tiles, without samples.
    fn part(&self, pieces: Range<u32>) -> Self {
        let hollow = |(t, tile): (usize, &Mutex<Tile>)| {
            let mut tile = lock(tile);
            let hollow = Tile::hollow(tile.area, self.round.length());
            let is_here = pieces.contains(&(t as u32));
            Mutex::new(if is_here { std::mem::replace(&mut *tile, hollow) } else { hollow })
        };
        let mut part = Self {
            scene: Arc::clone(&self.scene),
            before: None,
            parts: self.parts,
            bins: self.bins,
            bands: self.bands.clone(),
            plan: self.plan,
            tiles: self.tiles.iter().enumerate().map(hollow).collect(),
            pieces,
            joined: Vec::new(),
            columns: self.columns,
            targets: Vec::new(),
            ticks: self.ticks,
            done: (0..self.done.len()).map(|_| AtomicU32::new(0)).collect(),
            round: self.round,
            total: self.total,
            next: 0,
            is_complete: true,
            look: self.look,
            is_good_enough: false,
            errors_of_first_round: None,
            counters: Counters::default(),
            time: [Duration::ZERO; 2],
        };
        if part.is_part() {
            part.hollow();
        }
        part
    }
}
