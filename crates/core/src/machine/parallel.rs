//! Loops over blocks, on all threads where the feature `threads` is on. Which thread does a block never changes its result.

use std::marker::PhantomData;
use std::ops::Range;
#[cfg(feature = "threads")]
use std::{
    sync::{
        atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed},
        Condvar, Mutex, PoisonError,
    },
    time::Duration,
};

#[cfg(feature = "threads")]
use super::threads::{on_threads, scope, threads};

use crate::error::Error;
use crate::machine::progress::{report, Progress};

/// Calls `work(progress)` on a thread that shares the loops' work, where the calling one does not: one that starts many short loops
/// then waits for none of them to be taken up. The calling thread reports what `progress` is told.
pub(crate) fn on_a_working_thread<R: Send>(
    progress: &mut Progress<'_>,
    work: impl FnOnce(&mut Progress<'_>) -> Result<R, Error> + Send,
) -> Result<R, Error> {
    #[cfg(feature = "threads")]
    if rayon::current_thread_index().is_none() {
        let (sender, fractions) = std::sync::mpsc::channel();
        let mut result = Err(Error::Cancelled);
        let told = scope(|scope| {
            let result = &mut result;
            // Once the caller wants to stop there is no receiver.
            scope.spawn(move |_| *result = work(&mut |fraction| sender.send(fraction).is_ok()));
            fractions.into_iter().try_for_each(|fraction| report(progress, fraction))
        });
        return told.and(result);
    }
    work(progress)
}

/// Calls `work(index, block)` for each block of `size` elements of `out` (the last may be shorter).
pub(crate) fn for_each_block<T: Send>(
    out: &mut [T],
    size: usize,
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    // One block is done sooner than another thread has begun.
    #[cfg(feature = "threads")]
    if out.len() > size {
        use rayon::prelude::*;
        return on_threads(|| {
            out.par_chunks_mut(size).enumerate().for_each(|(index, block)| work(index, block));
        });
    }
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
    if a.len() > size_a {
        use rayon::prelude::*;
        return on_threads(|| {
            let pairs = a.par_chunks_mut(size_a).zip(b.par_chunks_mut(size_b)).enumerate();
            pairs.for_each(|(index, (a, b))| work(index, a, b));
        });
    }
    a.chunks_mut(size_a).zip(b.chunks_mut(size_b)).enumerate().for_each(|(index, (a, b))| work(index, a, b));
}

/// Calls `work(index, piece)` for each of the pieces. The calling thread begins at once: to wake another one may take as long as short
/// work. (Blocks of new memory are better shared as [`for_each_block`] does it, in which each thread has pages of its own.)
pub(crate) fn for_each_at_once<P: Send>(
    pieces: impl ExactSizeIterator<Item = P> + Send,
    work: impl Fn(usize, P) + Sync + Send,
) {
    #[cfg(feature = "threads")]
    {
        let helpers = threads().min(pieces.len()).saturating_sub(1);
        let pieces = Mutex::new(pieces.enumerate());
        let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
        let run = || std::iter::from_fn(next).for_each(|(index, piece)| work(index, piece));
        scope(|scope| {
            (0..helpers).for_each(|_| scope.spawn(|_| run()));
            run();
        });
    }
    #[cfg(not(feature = "threads"))]
    pieces.enumerate().for_each(|(index, piece)| work(index, piece));
}

/// What `each` says of the blocks of `size` elements, all of it put together by `both`, in no order; `None` of nothing.
pub(crate) fn of_blocks<T: Sync, R: Send>(
    of: &[T],
    size: usize,
    each: impl Fn(&[T]) -> R + Sync + Send,
    both: impl Fn(R, R) -> R + Sync + Send,
) -> Option<R> {
    #[cfg(feature = "threads")]
    if of.len() > size {
        use rayon::prelude::*;
        return on_threads(|| of.par_chunks(size).map(each).reduce_with(both));
    }
    of.chunks(size).map(each).reduce(both)
}

/// Whether `test` holds for one of the elements. (Sooner said of many together than of each in turn.)
pub(crate) fn any<T: Sync>(of: &[T], test: impl Fn(&T) -> bool + Sync + Send) -> bool {
    let block = |block: &[T]| block.iter().fold(false, |found, element| found | test(element));
    of_blocks(of, 1 << 14, block, |a, b| a | b).unwrap_or(false)
}

/// Calls `work(task, stop)` for each task below `count`, on all threads, each of which takes the next one when it is free. The
/// calling thread reports meanwhile, from `span.start` to `span.end`; once the caller wants to stop, `stop()` is true and no
/// further task begins.
pub(crate) fn for_each_task(
    count: usize,
    span: Range<f64>,
    progress: &mut Progress<'_>,
    work: impl Fn(usize, &(dyn Fn() -> bool + Sync)) + Sync,
) -> Result<(), Error> {
    let fraction = |done: usize| span.start + (span.end - span.start) * done as f64 / count as f64;
    #[cfg(feature = "threads")]
    {
        let queue = Queue::default();
        let run = |queue: &Queue| {
            let stop = || queue.stopped.load(Relaxed);
            while !stop() {
                let task = queue.next.fetch_add(1, Relaxed);
                if task >= count {
                    break;
                }
                work(task, &stop);
                queue.done.fetch_add(1, Relaxed);
            }
        };
        let threads = threads().min(count);
        scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|_| {
                    // Whatever becomes of the work, the calling thread must not wait for ever.
                    let _finished = Finished(&queue);
                    run(&queue);
                });
            }
            queue.watch(threads, &mut |done| report(progress, fraction(done)))
        })
    }
    #[cfg(not(feature = "threads"))]
    {
        for task in 0..count {
            report(progress, fraction(task))?;
            work(task, &|| false);
        }
        Ok(())
    }
}

/// How far the tasks are.
#[cfg(feature = "threads")]
#[derive(Default)]
struct Queue {
    next: AtomicUsize,
    done: AtomicUsize,
    stopped: AtomicBool,
    finished: Mutex<usize>,
    changed: Condvar,
}

/// Counts a thread as finished when it is dropped.
#[cfg(feature = "threads")]
struct Finished<'a>(&'a Queue);

#[cfg(feature = "threads")]
impl Drop for Finished<'_> {
    fn drop(&mut self) {
        *self.0.finished.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        self.0.changed.notify_all();
    }
}

#[cfg(feature = "threads")]
impl Queue {
    /// Reports every 20 ms until all `threads` have finished.
    fn watch(&self, threads: usize, report: &mut dyn FnMut(usize) -> Result<(), Error>) -> Result<(), Error> {
        let mut result = report(0);
        loop {
            self.stopped.fetch_or(result.is_err(), Relaxed);
            // Where the calling thread is itself one of the pool's, it must do the work that waits for it.
            while rayon::yield_now() == Some(rayon::Yield::Executed) {}
            let finished = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
            let (finished, _) = self
                .changed
                .wait_timeout_while(finished, Duration::from_millis(20), |finished| *finished < threads)
                .unwrap_or_else(PoisonError::into_inner);
            if *finished == threads {
                return result;
            }
            drop(finished);
            if result.is_ok() {
                result = report(self.done.load(Relaxed));
            }
        }
    }
}

/// Rows of a matrix that several threads fill, each its own ones.
pub(crate) struct SharedRows<'a> {
    start: *mut f32,
    rows: usize,
    width: usize,
    matrix: PhantomData<&'a mut [f32]>,
}

// SAFETY: it hands out rows under the promise of `row` only, by which no two threads have the same one.
unsafe impl Sync for SharedRows<'_> {}

impl<'a> SharedRows<'a> {
    pub(crate) fn new(matrix: &'a mut [f32], width: usize) -> SharedRows<'a> {
        let rows = matrix.len() / width;
        SharedRows { start: matrix.as_mut_ptr(), rows, width, matrix: PhantomData }
    }

    /// Tells the processor that row `index` is going to be written, where it can be told. (Of a row longer than a cache line, its
    /// ends: the processor itself sees to what is between.)
    #[inline(always)]
    pub(crate) fn prefetch(&self, index: usize) {
        assert!(index < self.rows);
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_mm_prefetch, _MM_HINT_ET0};
            // SAFETY: a prefetch reads and writes nothing, and the row lies in the matrix.
            unsafe {
                let row = self.start.add(index * self.width);
                _mm_prefetch::<_MM_HINT_ET0>(row.cast());
                _mm_prefetch::<_MM_HINT_ET0>(row.add(self.width - 1).cast());
            }
        }
    }

    /// Row `index`.
    ///
    /// # Safety
    /// As long as the row is in use, nobody else may ask for the same one.
    #[allow(clippy::mut_from_ref)]
    #[inline(always)]
    pub(crate) unsafe fn row(&self, index: usize) -> &mut [f32] {
        assert!(index < self.rows);
        // SAFETY: the row lies in the matrix, which is borrowed mutably as long as `self` lives.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(index * self.width), self.width) }
    }
}

#[cfg(test)]
mod tests;
