//! Every part of the work is done once; and a process that was forked has threads.

use super::*;
use crate::machine::threads::briefly;

fn squares(count: usize) -> Vec<usize> {
    let mut numbers = vec![0; count];
    for_each_block(&mut numbers, 7, |block, numbers| {
        numbers.iter_mut().enumerate().for_each(|(i, number)| *number = (7 * block + i).pow(2));
    });
    numbers
}

#[test]
fn every_block_and_task_is_done_once() {
    let count = if cfg!(miri) { 40 } else { 4000 };
    let expected: Vec<usize> = (0..count).map(|i| i * i).collect();
    assert_eq!(squares(count), expected);
    assert_eq!(
        of_blocks(&expected, 5, |block| block.iter().sum(), |a: usize, b| a + b),
        Some(expected.iter().sum())
    );
    let mut rows = vec![0.0; 3 * count];
    let shared = SharedRows::new(&mut rows, 3);
    for_each_task(count, 0.0..1.0, &mut |_| true, |task, _| {
        // SAFETY: each task has a row of its own.
        unsafe { shared.row(task) }.fill(task as f32);
    })
    .unwrap();
    assert!(rows.chunks(3).enumerate().all(|(i, row)| row == [i as f32; 3]));
    let mut done = vec![false; count];
    for_each_at_once(done.iter_mut(), |_, done| *done = true);
    assert!(done.iter().all(|done| *done));
}

#[test]
fn a_lock_that_nobody_gives_back_is_not_waited_for() {
    let lock = Mutex::new(1);
    let held = briefly(&lock);
    assert!(briefly(&lock).is_none());
    drop(held);
    assert_eq!(briefly(&lock).as_deref(), Some(&1));
}

/// Its parent's threads are not there; so it must not wait for them.
#[cfg(all(target_os = "linux", feature = "threads", not(miri)))]
#[test]
fn a_forked_child_has_threads_of_its_own() {
    let expected: Vec<usize> = (0..4000).map(|i| i * i).collect();
    assert_eq!(squares(4000), expected);
    // SAFETY: the child does nothing but this, and ends without going back to what it was in the middle of.
    let child = unsafe { libc::fork() };
    if child == 0 {
        let right = squares(4000) == expected;
        // SAFETY: ends the process.
        unsafe { libc::_exit(i32::from(!right)) };
    }
    let mut status = -1;
    for _ in 0..600 {
        // SAFETY: `status` may be written.
        if unsafe { libc::waitpid(child, &mut status, libc::WNOHANG) } == child {
            break;
        }
        std::thread::sleep(Duration::from_millis(100));
        status = -1;
    }
    if status == -1 {
        // SAFETY: that child, which has not ended.
        unsafe { libc::kill(child, libc::SIGKILL) };
    }
    assert_eq!(status, 0, "-1: it hangs");
}
