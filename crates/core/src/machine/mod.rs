//! What the mathematics runs on: wide registers, threads, memory; and how a long call tells how far it is.

pub mod memory;
pub(crate) mod parallel;
pub mod progress;
pub(crate) mod random;
pub(crate) mod simd;
pub(crate) mod threads;
