//! Panics are ours to answer for, not the user's: they are explained once and end in an exit code.

use crate::terminal::Terminal;
use std::{
    backtrace::{Backtrace, BacktraceStatus},
    panic::{AssertUnwindSafe, catch_unwind, set_hook},
    sync::atomic::{AtomicBool, Ordering},
};

/// A panic that was caught and explained.
#[derive(Debug)]
pub struct Contained;

/// From now on a panic on any thread says what happened and whose fault it is. Those that follow from the first are not
/// repeated.
pub fn explain(terminal: Terminal) {
    static TOLD: AtomicBool = AtomicBool::new(false);
    set_hook(Box::new(move |info| {
        if TOLD.swap(true, Ordering::Relaxed) {
            return;
        }
        let payload = info.payload();
        let what = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
        let place = info.location().map(|l| format!(" at {}:{}", l.file(), l.line())).unwrap_or_default();
        // As the environment asks for it (RUST_BACKTRACE).
        let backtrace = Backtrace::capture();
        let frames = match backtrace.status() {
            BacktraceStatus::Captured => format!("\n{backtrace}"),
            _ => " RUST_BACKTRACE=1 adds the calls that led there.".to_owned(),
        };
        terminal.error(&format!(
            "{}{place}\nThis is a bug in Steradian, not in your file. Please report it with this message, the command line and, where you can, \
             the scene.{frames}",
            what.unwrap_or("stopped by an unknown panic")
        ));
    }));
}

/// Runs `work` to its end or to its first panic.
pub fn contain<T>(work: impl FnOnce() -> T) -> Result<T, Contained> {
    // What `work` leaves half done is not looked at again: the process ends.
    catch_unwind(AssertUnwindSafe(work)).map_err(|_| Contained)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_on_another_thread_is_contained() {
        let work = || std::thread::scope(|s| s.spawn(|| panic!("on purpose")).join().is_err());
        assert!(matches!(contain(work), Ok(true)));
        let nested = || std::thread::scope(|s| drop(s.spawn(|| panic!("on purpose"))));
        assert!(contain(nested).is_err());
    }
}
