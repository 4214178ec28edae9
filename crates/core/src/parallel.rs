//! Loops over blocks, on all threads where the feature `threads` is on. Which thread does a block never changes its result.

/// Calls `work(index, block)` for each block of `size` elements of `out` (the last may be shorter).
pub(crate) fn for_each_block<T: Send>(
    out: &mut [T],
    size: usize,
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    #[cfg(feature = "threads")]
    {
        use rayon::prelude::*;
        out.par_chunks_mut(size).enumerate().for_each(|(index, block)| work(index, block));
    }
    #[cfg(not(feature = "threads"))]
    out.chunks_mut(size).enumerate().for_each(|(index, block)| work(index, block));
}

/// The same for two slices that are cut in step: `size_a` elements of `a` belong to `size_b` of `b`.
pub(crate) fn for_each_block_pair<A: Send, B: Send>(
    a: &mut [A],
    size_a: usize,
    b: &mut [B],
    size_b: usize,
    work: impl Fn(usize, &mut [A], &mut [B]) + Sync + Send,
) {
    #[cfg(feature = "threads")]
    {
        use rayon::prelude::*;
        a.par_chunks_mut(size_a)
            .zip(b.par_chunks_mut(size_b))
            .enumerate()
            .for_each(|(index, (a, b))| work(index, a, b));
    }
    #[cfg(not(feature = "threads"))]
    a.chunks_mut(size_a).zip(b.chunks_mut(size_b)).enumerate().for_each(|(index, (a, b))| work(index, a, b));
}
