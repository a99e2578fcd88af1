//! The stacks of a traversal: arrays on the machine's stack that are not initialised beyond their length.
#![allow(unsafe_code)]

use crate::build::MAX_DEPTH;
use crate::layout::ChildRef;
use crate::simd::{LANES, key_number};
use std::mem::MaybeUninit;

/// Room for every tree: a node puts at most seven children on the stack and the builder bounds the depth; a push may write a whole
/// group of eight.
const CAPACITY: usize = (LANES - 1) * MAX_DEPTH + LANES;

/// Children that wait to be visited.
pub(crate) struct Stack {
    children: [MaybeUninit<ChildRef>; CAPACITY],
    len: usize,
}

impl Stack {
    /// An empty stack.
    #[inline(always)]
    pub fn new() -> Self {
        Self { children: [const { MaybeUninit::uninit() }; CAPACITY], len: 0 }
    }

    /// Puts a child on the stack.
    ///
    /// # Safety
    /// The stack must hold less than `CAPACITY` children.
    #[inline(always)]
    pub unsafe fn push(&mut self, child: ChildRef) {
        debug_assert!(self.len < CAPACITY);
        // SAFETY: the caller promises that there is room.
        unsafe { self.children.get_unchecked_mut(self.len).write(child) };
        self.len += 1;
    }

    /// Takes the top child.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<ChildRef> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: entries below the length have been written, and the length is below the capacity.
        Some(unsafe { self.children.get_unchecked(self.len).assume_init() })
    }
}

/// Children that wait to be visited, with the distances of their boxes.
pub(crate) struct OrderedStack {
    keys: [MaybeUninit<u32>; CAPACITY],
    children: [MaybeUninit<ChildRef>; CAPACITY],
    len: usize,
}

impl OrderedStack {
    /// An empty stack.
    #[inline(always)]
    pub fn new() -> Self {
        const { assert!(size_of::<ChildRef>() == size_of::<u32>()) };
        Self {
            keys: [const { MaybeUninit::uninit() }; CAPACITY],
            children: [const { MaybeUninit::uninit() }; CAPACITY],
            len: 0,
        }
    }

    /// Puts the first `count` children of a node that is sorted by distance on the stack, and takes the last of them, which is
    /// the nearest.
    ///
    /// # Safety
    /// `1 <= count <= LANES`, and the stack must hold at most `CAPACITY − LANES` children.
    #[inline(always)]
    pub unsafe fn push_all_but_nearest(
        &mut self,
        keys: [u32; LANES],
        children: [ChildRef; LANES],
        count: usize,
    ) -> ChildRef {
        debug_assert!((1..=LANES).contains(&count) && self.len + LANES <= CAPACITY);
        // SAFETY: the caller promises that there is room for whole groups, and the entry read has just been written.
        unsafe {
            self.keys.as_mut_ptr().add(self.len).cast::<[u32; LANES]>().write_unaligned(keys);
            self.children.as_mut_ptr().add(self.len).cast::<[ChildRef; LANES]>().write_unaligned(children);
            self.len += count - 1;
            self.children.get_unchecked(self.len).assume_init()
        }
    }

    /// Takes children from the top up to one whose box begins at `t` or nearer.
    #[inline(always)]
    pub fn pop(&mut self, t: f32) -> Option<ChildRef> {
        loop {
            self.len = self.len.checked_sub(1)?;
            // SAFETY: entries below the length have been written, and the length is below the capacity.
            let (key, child) = unsafe {
                (self.keys.get_unchecked(self.len).assume_init(), self.children.get_unchecked(self.len).assume_init())
            };
            if key_number(key) <= t {
                return Some(child);
            }
        }
    }
}
