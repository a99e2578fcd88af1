//! The stacks of a traversal: arrays on the machine's stack that are not initialised beyond their length.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::construct::MAX_DEPTH;
use crate::layout::ChildRef;
use crate::simd::{LANES, last_key};
use std::mem::MaybeUninit;

/// Room for every tree: a node puts at most eight children on the stack, of which one is taken at once, and the builder
/// bounds the depth; a push may write a whole group of eight.
const CAPACITY: usize = (LANES - 1) * MAX_DEPTH + 2 * LANES;

/// Number of children written at once.
const HALF: usize = LANES / 2;

/// A stack, made in its place: to move one is to copy much that means nothing.
pub(crate) trait Waiting: Sized {
    /// An empty stack.
    fn emptied(place: &mut MaybeUninit<Self>) -> &mut Self;
}

impl Waiting for Stack {
    #[inline(always)]
    fn emptied(place: &mut MaybeUninit<Self>) -> &mut Self {
        // SAFETY: the length is written; the children may be anything.
        unsafe {
            (&raw mut (*place.as_mut_ptr()).len).write(0);
            place.assume_init_mut()
        }
    }
}

impl Waiting for OrderedStack {
    #[inline(always)]
    fn emptied(place: &mut MaybeUninit<Self>) -> &mut Self {
        // SAFETY: as above.
        unsafe {
            (&raw mut (*place.as_mut_ptr()).len).write(0);
            place.assume_init_mut()
        }
    }
}

/// Children that wait to be visited.
pub(crate) struct Stack {
    children: [MaybeUninit<ChildRef>; CAPACITY],
    len: usize,
}

impl Stack {
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
    /// Puts the first `count` children of a node that are sorted by distance on the stack, but for the last of them,
    /// which is the nearest.
    ///
    /// # Safety
    /// `1 <= count <= LANES`, and the stack must hold at most `CAPACITY − LANES` children.
    #[inline(always)]
    pub unsafe fn push_all_but_nearest(&mut self, keys: [u32; LANES], children: [u32; LANES], count: usize) {
        debug_assert!((1..=LANES).contains(&count) && self.len + LANES <= CAPACITY);
        let (place_of_keys, place_of_children) = (self.keys.as_mut_ptr(), self.children.as_mut_ptr());
        let write = |half: usize| {
            let part = |all: &[u32; LANES]| -> [u32; HALF] { std::array::from_fn(|i| all[half + i]) };
            // SAFETY: the caller promises that there is room for whole groups.
            unsafe {
                place_of_keys.add(self.len + half).cast::<[u32; HALF]>().write_unaligned(part(&keys));
                place_of_children.add(self.len + half).cast::<[u32; HALF]>().write_unaligned(part(&children));
            }
        };
        // Mostly there are few, and short writes seldom cross the end of a cache line.
        write(0);
        if count > HALF + 1 {
            write(HALF);
        }
        self.len += count - 1;
    }

    /// Takes children from the top up to one whose box begins at `t` or nearer.
    #[inline(always)]
    pub fn pop(&mut self, t: f32) -> Option<ChildRef> {
        let last = last_key(t);
        loop {
            self.len = self.len.checked_sub(1)?;
            // SAFETY: entries below the length have been written, and the length is below the capacity.
            let (key, child) = unsafe {
                (self.keys.get_unchecked(self.len).assume_init(), self.children.get_unchecked(self.len).assume_init())
            };
            if key <= last {
                return Some(child);
            }
        }
    }
}
