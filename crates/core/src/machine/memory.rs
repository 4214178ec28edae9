//! Large arrays, made by all threads.
//!
//! The first write to fresh memory costs more than the write: the system finds a page of it, and clears that. Here each thread finds
//! the pages that it fills, and pages are large where the system has large ones for those who ask (Linux, `madvise`).

use std::mem::MaybeUninit;

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

/// `count` elements in the memory of `old`: each block of `size` elements begins as copies of `blank`, and is filled by
/// `work(index, block)`.
pub(crate) fn filled<T: Copy + Send + Sync>(
    mut old: Vec<T>,
    count: usize,
    blank: T,
    size: usize,
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) -> Vec<T> {
    old.clear();
    if old.capacity() < count {
        // What was there is freed first.
        old = Vec::new();
        old.reserve_exact(count);
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
    old
}

/// A copy, made by all threads.
pub fn copy_of<T: Copy + Default + Send + Sync>(numbers: &[T]) -> Vec<T> {
    const BLOCK: usize = 1 << 16;
    filled(Vec::new(), numbers.len(), T::default(), BLOCK, |index, block| {
        block.copy_from_slice(&numbers[BLOCK * index..][..block.len()]);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_block_is_filled_in_its_place() {
        for count in [0, 1, 5, 999_999] {
            let numbers = filled(vec![7; 3], count, 1, 1000, |index, block| {
                for (i, number) in block.iter_mut().enumerate() {
                    *number += 1000 * index + i;
                }
            });
            assert_eq!(numbers, (1..=count).collect::<Vec<_>>());
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
