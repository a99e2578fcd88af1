//! Detection of standard output that was closed when the program started (`>&-`). Rust's runtime opens a device in its
//! place that takes everything, before `main` can see that it was: output would be lost without a word. So this is
//! looked at earlier, where the system lets a program do so.

// A function in the table of those that run before `main` cannot be declared otherwise.
#![allow(unsafe_code, reason = "file descriptors of the system")]

use std::{
    io::{Error, Result},
    sync::atomic::{AtomicBool, Ordering},
};

static CLOSED: AtomicBool = AtomicBool::new(false);

// SAFETY: the C library calls each function of this table once, on the first thread and after it is ready itself. This
// one takes no arguments, asks the system about a descriptor, and cannot unwind.
#[cfg(all(target_os = "linux", not(test)))]
#[used]
#[unsafe(link_section = ".init_array")]
static LOOK: extern "C" fn() = {
    extern "C" fn look() {
        let is_closed = rustix::io::fcntl_getfd(std::io::stdout()) == Err(rustix::io::Errno::BADF);
        CLOSED.store(is_closed, Ordering::Relaxed);
    }
    look
};

/// Nothing where standard output was open at the start.
///
/// # Errors
/// The system's error of a closed descriptor (EBADF).
pub fn check() -> Result<()> {
    const BAD_DESCRIPTOR: i32 = 9;
    if CLOSED.load(Ordering::Relaxed) { Err(Error::from_raw_os_error(BAD_DESCRIPTOR)) } else { Ok(()) }
}
