//! Large arrays, made by all threads.
//!
//! The first write to fresh memory costs more than the write: the system finds a page of it, and clears that. Here each thread finds
//! the pages that it fills, and pages are large where the system has large ones for those who ask (Linux, `madvise`).

use std::alloc::{alloc_zeroed, handle_alloc_error, Layout};
use std::mem::MaybeUninit;

use crate::error::Error;
use crate::machine::parallel::for_each_block;

/// Bytes of a large page.
const PAGE: usize = 2 << 20;

/// Asks for large pages, for memory that is going to be used from end to end.
pub(crate) fn in_large_pages<T>(memory: &mut [T]) {
    #[cfg(target_os = "linux")]
    {
        let bytes = memory.as_mut_ptr_range();
        let (start, end) = (bytes.start as usize, bytes.end as usize);
        let (first, last) = (start.next_multiple_of(PAGE), end - end % PAGE);
        if first < last {
            // SAFETY: the range lies in `memory`, and this advice changes nothing but how pages are found. Where it is not
            // taken, nothing is lost.
            unsafe {
                libc::madvise(
                    memory.as_mut_ptr().byte_add(first - start).cast(),
                    last - first,
                    libc::MADV_HUGEPAGE,
                )
            };
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = (memory, PAGE);
}

/// Room for `count` elements.
///
/// # Errors
/// [`Error::Memory`].
pub(crate) fn room<T>(count: usize) -> Result<Vec<T>, Error> {
    let mut room = Vec::new();
    room.try_reserve_exact(count).map_err(|_| Error::Memory)?;
    Ok(room)
}

/// Numbers of which the one whose bytes are all 0 is 0.
///
/// # Safety
/// That is so.
pub(crate) unsafe trait Zero: Copy {}
// SAFETY: as IEEE 754 has it.
unsafe impl Zero for f32 {}
// SAFETY: as IEEE 754 has it.
unsafe impl Zero for f64 {}

/// `count` zeros, whose pages the system finds when they are first written to.
///
/// # Errors
/// [`Error::Memory`].
pub(crate) fn zeros<T: Zero>(count: usize) -> Result<Vec<T>, Error> {
    let layout = Layout::array::<T>(count).map_err(|_| Error::Memory)?;
    if layout.size() == 0 {
        return Ok(Vec::new());
    }
    // SAFETY: the layout's size is not 0.
    let start = unsafe { alloc_zeroed(layout) }.cast::<T>();
    if start.is_null() {
        return Err(Error::Memory);
    }
    // SAFETY: the global allocator gave it for `count` elements of T, all of which are 0, a number of T.
    Ok(unsafe { Vec::from_raw_parts(start, count, count) })
}

/// `count` elements in the memory of `old`: each block of `size` elements begins as copies of `blank`, and is filled by
/// `work(index, block)`.
///
/// # Errors
/// [`Error::Memory`].
pub(crate) fn try_filled<T: Copy + Send + Sync>(
    mut old: Vec<T>,
    count: usize,
    blank: T,
    size: usize,
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) -> Result<Vec<T>, Error> {
    old.clear();
    if old.capacity() < count {
        // What was there is freed first.
        drop(old);
        old = room(count)?;
        in_large_pages(old.spare_capacity_mut());
    }
    for_each_block(&mut old.spare_capacity_mut()[..count], size, |index, block| {
        block.fill(MaybeUninit::new(blank));
        let block: *mut [MaybeUninit<T>] = block;
        // SAFETY: each element was written above, and nobody else has the block.
        work(index, unsafe { &mut *(block as *mut [T]) });
    });
    // SAFETY: there is room for them, and each block of the first `count` elements was written.
    unsafe { old.set_len(count) };
    Ok(old)
}

/// The same for what does not grow with the number of points.
pub(crate) fn filled<T: Copy + Send + Sync>(
    old: Vec<T>,
    count: usize,
    blank: T,
    size: usize,
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) -> Vec<T> {
    try_filled(old, count, blank, size, work)
        .unwrap_or_else(|_| handle_alloc_error(Layout::array::<T>(count).unwrap_or(Layout::new::<T>())))
}

/// A copy, made by all threads.
///
/// # Errors
/// [`Error::Memory`].
pub fn copy_of<T: Copy + Default + Send + Sync>(numbers: &[T]) -> Result<Vec<T>, Error> {
    const BLOCK: usize = 1 << 16;
    try_filled(Vec::new(), numbers.len(), T::default(), BLOCK, |index, block| {
        block.copy_from_slice(&numbers[BLOCK * index..][..block.len()]);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_block_is_filled_in_its_place() {
        let most = if cfg!(miri) { 3500 } else { 999_999 };
        for count in [0, 1, 5, most] {
            let numbers = filled(vec![7; 3], count, 1, 1000, |index, block| {
                for (i, number) in block.iter_mut().enumerate() {
                    *number += 1000 * index + i;
                }
            });
            assert_eq!(numbers, (1..=count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn zeros_are_zeros_and_what_there_is_no_room_for_is_refused() {
        assert_eq!(zeros::<f64>(1000).unwrap(), vec![0.0; 1000]);
        assert_eq!(zeros::<f32>(0).unwrap(), Vec::<f32>::new());
        // Miri refuses what is too much for itself in another way.
        let large = if cfg!(miri) { usize::MAX } else { usize::MAX / 16 };
        for count in [usize::MAX, large] {
            assert_eq!(zeros::<f64>(count), Err(Error::Memory));
            assert_eq!(room::<f64>(count), Err(Error::Memory));
        }
    }

    #[test]
    fn memory_that_is_there_is_used_again() {
        let old = vec![3u8; 5000];
        let place = old.as_ptr();
        let new = filled(old, 4000, 0, 100, |_, _| {});
        assert_eq!((new.as_ptr(), new), (place, vec![0; 4000]));
    }
}
