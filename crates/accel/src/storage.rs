//! Memory for the large arrays of a hierarchy, on huge pages where the system has them: rays that go everywhere then
//! miss the translation buffer less.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use rayon::prelude::*;
use std::alloc::{Layout, alloc, dealloc, handle_alloc_error};
use std::mem::MaybeUninit;
use std::ptr::NonNull;

/// Size of a huge page. Arrays of at least this size begin at a multiple of it.
const HUGE_PAGE: usize = 2 << 20;

/// A boxed slice of plain data.
pub(crate) struct Storage<T: Copy> {
    start: NonNull<T>,
    len: usize,
}

// SAFETY: a storage owns its elements like a boxed slice.
unsafe impl<T: Copy + Send> Send for Storage<T> {}
// SAFETY: shared access only reads elements.
unsafe impl<T: Copy + Sync> Sync for Storage<T> {}

impl<T: Copy> Storage<T> {
    /// The place of `len` elements in memory; `None` for none.
    fn layout(len: usize) -> Option<Layout> {
        let layout = Layout::array::<T>(len).ok().filter(|layout| layout.size() > 0)?;
        let huge = layout.size() >= HUGE_PAGE;
        if huge { layout.align_to(HUGE_PAGE).ok() } else { Some(layout) }
    }

    /// Memory for `len` elements that are not initialised.
    fn allocated(len: usize) -> Storage<MaybeUninit<T>> {
        let Some(layout) = Self::layout(len) else { return Storage { start: NonNull::dangling(), len: 0 } };
        // SAFETY: the layout has a size.
        let start = unsafe { alloc(layout) };
        if layout.align() >= HUGE_PAGE {
            advise_huge_pages(start, layout.size());
        }
        match NonNull::new(start.cast()) {
            Some(start) => Storage { start, len },
            None => handle_alloc_error(layout),
        }
    }

    /// `len` elements that may be anything.
    ///
    /// # Safety
    /// Any bits, even none, must be an element.
    pub unsafe fn uninit(len: usize) -> Self {
        let storage = Self::allocated(len);
        let anything = Self { start: storage.start.cast(), len };
        std::mem::forget(storage);
        anything
    }

    /// `len` elements that are made in parallel by a function of the index.
    pub fn from_fn(len: usize, element: impl Fn(usize) -> T + Sync) -> Self
    where
        T: Send,
    {
        let mut storage = Self::allocated(len);
        storage.par_iter_mut().enumerate().for_each(|(i, place)| {
            place.write(element(i));
        });
        let initialised = Self { start: storage.start.cast(), len: storage.len };
        // What is initialised now owns the memory.
        std::mem::forget(storage);
        initialised
    }
}

impl<T: Copy> Drop for Storage<T> {
    fn drop(&mut self) {
        if let Some(layout) = Self::layout(self.len) {
            // SAFETY: the memory was allocated with this layout, and elements need no dropping.
            unsafe { dealloc(self.start.as_ptr().cast(), layout) };
        }
    }
}

impl<T: Copy> std::ops::Deref for Storage<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: there are `len` initialised elements (or ones that may be anything) at `start`.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl<T: Copy> std::ops::DerefMut for Storage<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        // SAFETY: as above, and the borrow is exclusive.
        unsafe { std::slice::from_raw_parts_mut(self.start.as_ptr(), self.len) }
    }
}

impl<T: Copy + Send + Sync> Clone for Storage<T> {
    fn clone(&self) -> Self {
        Self::from_fn(self.len, |i| self[i])
    }
}

impl<T: Copy + std::fmt::Debug> std::fmt::Debug for Storage<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        (**self).fmt(f)
    }
}

/// An empty vector with room for elements.
pub(crate) fn vec_with_capacity<T: Copy>(capacity: usize) -> Vec<T> {
    let mut vec = Vec::with_capacity(capacity);
    let room = vec.spare_capacity_mut();
    advise_huge_pages(room.as_mut_ptr().cast(), size_of_val(room));
    vec
}

/// Asks the system for huge pages. It may refuse; then there are small ones.
#[cfg(target_os = "linux")]
fn advise_huge_pages(start: *mut u8, len: usize) {
    unsafe extern "C" {
        fn madvise(start: *mut std::ffi::c_void, len: usize, advice: std::ffi::c_int) -> std::ffi::c_int;
    }
    const MADV_HUGEPAGE: std::ffi::c_int = 14;
    if !start.is_null() {
        // Only whole pages within the range are named.
        let skip = start.align_offset(HUGE_PAGE);
        let len = len.saturating_sub(skip) & !(HUGE_PAGE - 1);
        // SAFETY: the range has just been allocated, and the advice changes nothing but the size of its pages.
        unsafe { madvise(start.wrapping_add(skip).cast(), len, MADV_HUGEPAGE) };
    }
}

/// Other systems choose their pages themselves.
#[cfg(not(target_os = "linux"))]
fn advise_huge_pages(_start: *mut u8, _len: usize) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_where_they_belong() {
        for len in [0, 1, 1000, HUGE_PAGE / 4, HUGE_PAGE + 123] {
            let storage = Storage::from_fn(len, |i| i as u32 ^ 0x5555);
            assert_eq!(storage.len(), len);
            assert!(storage.iter().enumerate().all(|(i, &x)| x == i as u32 ^ 0x5555));
            assert_eq!(storage[..], storage.clone()[..]);
            if len * 4 >= HUGE_PAGE {
                assert_eq!(storage.as_ptr() as usize % HUGE_PAGE, 0);
            }
        }
    }
}
