//! The program under stress: random events, kills, long drives, and any number of threads.

mod determinism;
mod kills;
mod live_day;
mod long_drive;
mod monkey;
mod process;

use peak_alloc::PeakAlloc;

/// Counts the allocations of the whole process: a test that reads it runs by [`process::alone`].
#[global_allocator]
static ALLOCATED: PeakAlloc = PeakAlloc;
