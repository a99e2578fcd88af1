//! The stack of a packet: children that wait, with the node whose slot they are in, so that their box can be tested when their turn
//! comes.
#![allow(unsafe_code)]

use crate::build::MAX_DEPTH;
use crate::layout::ChildRef;
use crate::simd::{LANES, key_number};
use std::mem::MaybeUninit;

/// Room for every tree: a node puts at most eight children on the stack, of which one is taken at once, and the builder bounds the
/// depth.
const CAPACITY: usize = (LANES - 1) * MAX_DEPTH + 2 * LANES;

/// A child that waits.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    /// Distance and slot, see [`crate::simd::key`].
    pub key: u32,
    pub child: ChildRef,
    /// The node that it is a child of.
    pub parent: ChildRef,
}

/// Children that wait to be visited.
pub(super) struct PacketStack {
    waiting: [MaybeUninit<Waiting>; CAPACITY],
    len: usize,
}

impl PacketStack {
    /// An empty stack.
    #[inline(always)]
    pub fn new() -> Self {
        Self { waiting: [const { MaybeUninit::uninit() }; CAPACITY], len: 0 }
    }

    /// Puts a child on the stack.
    ///
    /// # Safety
    /// The stack must hold less than `CAPACITY` children.
    #[inline(always)]
    pub unsafe fn push(&mut self, waiting: Waiting) {
        debug_assert!(self.len < CAPACITY);
        // SAFETY: the caller promises that there is room.
        unsafe { self.waiting.get_unchecked_mut(self.len).write(waiting) };
        self.len += 1;
    }

    /// Takes children from the top up to one whose box begins at `t` or nearer.
    #[inline(always)]
    pub fn pop(&mut self, t: f32) -> Option<Waiting> {
        loop {
            self.len = self.len.checked_sub(1)?;
            // SAFETY: entries below the length have been written, and the length is below the capacity.
            let waiting = unsafe { self.waiting.get_unchecked(self.len).assume_init() };
            if key_number(waiting.key) <= t {
                return Some(waiting);
            }
        }
    }
}
