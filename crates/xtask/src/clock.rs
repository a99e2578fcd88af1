//! Time of processors, which on a shared machine means more than the time on the wall.

use rustix::time::{ClockId, clock_gettime};
use std::time::Duration;

/// Time that this process has run, all threads together.
pub fn cpu() -> Duration {
    time(ClockId::ProcessCPUTime)
}

/// Time that this thread has run.
pub fn thread() -> Duration {
    time(ClockId::ThreadCPUTime)
}

fn time(clock: ClockId) -> Duration {
    let t = clock_gettime(clock);
    Duration::new(t.tv_sec.unsigned_abs(), t.tv_nsec.unsigned_abs() as u32)
}

/// The result of some work, and the CPU seconds that it took.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = cpu();
    let done = work();
    (done, cpu().saturating_sub(start).as_secs_f64())
}

/// The middle one of several numbers.
pub fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}
