//! The stack of a packet: children that wait, with the node whose slot they are in, so that their box can be tested
//! when their turn comes.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::construct::MAX_DEPTH;
use crate::layout::ChildRef;
use crate::simd::{LANES, last_key};
use std::mem::MaybeUninit;

/// Room for every tree: a node puts at most eight children on the stack, of which one is taken at once, and the builder
/// bounds the depth.
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

/// Children that wait to be visited, by rows.
pub(super) struct PacketStack {
    keys: [MaybeUninit<u32>; CAPACITY],
    children: [MaybeUninit<u32>; CAPACITY],
    parents: [MaybeUninit<u32>; CAPACITY],
    len: usize,
}

impl PacketStack {
    /// An empty stack.
    #[inline(always)]
    pub fn new() -> Self {
        let rows = [const { MaybeUninit::uninit() }; CAPACITY];
        Self { keys: rows, children: rows, parents: rows, len: 0 }
    }

    /// Puts the first `count` children of a node on the stack.
    ///
    /// # Safety
    /// `count <= LANES`, and the stack must hold at most `CAPACITY − LANES` children.
    #[inline(always)]
    pub unsafe fn push(&mut self, keys: [u32; LANES], children: [u32; LANES], parent: ChildRef, count: usize) {
        debug_assert!(count <= LANES && self.len + LANES <= CAPACITY);
        // Write whole registers and advance by the count: what lies beyond is overwritten by the next push.
        // SAFETY: the caller promises that there is room for whole groups.
        unsafe {
            self.keys.as_mut_ptr().add(self.len).cast::<[u32; LANES]>().write_unaligned(keys);
            self.children.as_mut_ptr().add(self.len).cast::<[u32; LANES]>().write_unaligned(children);
            self.parents.as_mut_ptr().add(self.len).cast::<[u32; LANES]>().write_unaligned([parent.0; LANES]);
        }
        self.len += count;
    }

    /// Takes children from the top up to one whose box begins at `t` or nearer.
    #[inline(always)]
    pub fn pop(&mut self, t: f32) -> Option<Waiting> {
        // Compare keys as integers: distances are not negative, so their bits are ordered as the numbers are.
        let last = last_key(t);
        loop {
            self.len = self.len.checked_sub(1)?;
            // SAFETY: entries below the length have been written, and the length is below the capacity.
            let (key, child, parent) = unsafe {
                (
                    self.keys.get_unchecked(self.len).assume_init(),
                    self.children.get_unchecked(self.len).assume_init(),
                    self.parents.get_unchecked(self.len).assume_init(),
                )
            };
            if key <= last {
                return Some(Waiting { key, child: ChildRef(child), parent: ChildRef(parent) });
            }
        }
    }
}

/// Children that wait to be visited by some of the rays.
pub(super) struct BundleStack {
    children: [MaybeUninit<(ChildRef, u32)>; CAPACITY],
    len: usize,
}

impl BundleStack {
    /// An empty stack.
    #[inline(always)]
    pub fn new() -> Self {
        Self { children: [const { MaybeUninit::uninit() }; CAPACITY], len: 0 }
    }

    /// Puts a child on the stack with the rays that visit it, if there are any.
    ///
    /// # Safety
    /// The stack must hold less than `CAPACITY` children.
    #[inline(always)]
    pub unsafe fn push(&mut self, child: ChildRef, lanes: u32) {
        debug_assert!(self.len < CAPACITY);
        // Write in any case and count only entries that have rays, without a branch.
        // SAFETY: the caller promises that there is room.
        unsafe { self.children.get_unchecked_mut(self.len).write((child, lanes)) };
        self.len += usize::from(lanes != 0);
    }

    /// Takes the top child.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<(ChildRef, u32)> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: entries below the length have been written, and the length is below the capacity.
        Some(unsafe { self.children.get_unchecked(self.len).assume_init() })
    }
}
