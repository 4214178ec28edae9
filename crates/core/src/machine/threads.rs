//! The threads that loops are shared by, and locks that a fork cannot leave held.

use std::sync::{Mutex, MutexGuard, TryLockError};

#[cfg(feature = "threads")]
pub(crate) use pool::{on_threads, scope};

/// Threads that share the work.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "threads")]
    return if rayon::current_thread_index().is_some() {
        rayon::current_num_threads()
    } else {
        pool::pool().current_num_threads()
    };
    #[cfg(not(feature = "threads"))]
    return 1;
}

/// A lock that is held but for moments; none if it is held for longer. In a process that was forked, that is for ever: by a thread that
/// there is no more.
pub(crate) fn briefly<T>(lock: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    for _ in 0..1 << 10 {
        match lock.try_lock() {
            Ok(guard) => return Some(guard),
            Err(TryLockError::Poisoned(guard)) => return Some(guard.into_inner()),
            Err(TryLockError::WouldBlock) => std::thread::yield_now(),
        }
    }
    None
}

#[cfg(feature = "threads")]
mod pool {
    use std::sync::atomic::AtomicPtr;
    use std::sync::atomic::Ordering::{AcqRel, Acquire};

    use rayon::{Scope, ThreadPool, ThreadPoolBuilder};

    /// The threads of one process.
    ///
    /// Not rayon's own ones: a process that forks has none of its parent's threads, so that work that is given to them waits for ever. Here
    /// a child makes its own when it first needs them. What it has of its parent's pool is left alone.
    struct Pool {
        process: u32,
        threads: ThreadPool,
    }

    /// The last one that was made; none is ever freed.
    static POOL: AtomicPtr<Pool> = AtomicPtr::new(std::ptr::null_mut());

    pub(super) fn pool() -> &'static ThreadPool {
        let process = std::process::id();
        let last = POOL.load(Acquire);
        // SAFETY: it points to nothing, or to a pool that is whole and never freed.
        if let Some(pool) = unsafe { last.as_ref() } {
            if pool.process == process {
                return &pool.threads;
            }
        }
        let threads = ThreadPoolBuilder::new().thread_name(|index| format!("neuralmls-{index}")).build();
        let new =
            Box::new(Pool { process, threads: threads.expect("the system gives this process threads") });
        let new = Box::into_raw(new);
        match POOL.compare_exchange(last, new, AcqRel, Acquire) {
            // SAFETY: it was made above, and from now on is never freed.
            Ok(_) => unsafe { &(*new).threads },
            Err(other) => {
                // SAFETY: it was made above, and nobody else has seen it.
                drop(unsafe { Box::from_raw(new) });
                // SAFETY: another thread of this process made it meanwhile; it is whole, and never freed.
                unsafe { &(*other).threads }
            }
        }
    }

    /// Runs `work` where the loops' threads are: on one of them, or on the calling one if that is a thread of some pool.
    pub(crate) fn on_threads<R: Send>(work: impl FnOnce() -> R + Send) -> R {
        if rayon::current_thread_index().is_some() {
            work()
        } else {
            pool().install(work)
        }
    }

    /// A scope whose tasks run on those threads; the calling thread does `work`.
    pub(crate) fn scope<'scope, R>(work: impl FnOnce(&Scope<'scope>) -> R) -> R {
        if rayon::current_thread_index().is_some() {
            rayon::in_place_scope(work)
        } else {
            pool().in_place_scope(work)
        }
    }
}
