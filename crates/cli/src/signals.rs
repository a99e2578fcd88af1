//! SIGINT and SIGTERM end every command, with a message and the code 128 + signal: at once, or in order where
//! the command [watches](Signals::watch) for them, as a render does that saves what it has. The second one ends it at
//! once in any case, and so does the first one where a pipe that nobody reads holds the command. SIGUSR1 asks for the
//! picture as it is, and ends nothing.

use crate::terminal::{Event, Talk, Terminal};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::sync::{
    Arc, LazyLock, OnceLock,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};

static END: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);
static PICTURE: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// Number of [`Signals`].
static WATCHERS: AtomicUsize = AtomicUsize::new(0);

/// For how long writing to a pipe may stand still once a signal came.
#[cfg(unix)]
const STUCK: std::time::Duration = std::time::Duration::from_millis(400);

/// Takes over the signals of the process. What it is not allowed to take over acts as usual.
pub fn take_over() {
    #[cfg(unix)]
    let _ = unix::take_over();
}

#[cfg(unix)]
mod unix {
    use super::*;
    use signal_hook::{consts::SIGUSR1, flag, iterator};

    pub fn take_over() -> std::io::Result<()> {
        // Lets writing fail, and be answered for, where a file is larger than allowed (`ulimit -f`), rather than end
        // the process.
        flag::register(signal_hook::consts::SIGXFSZ, Arc::default())?;
        flag::register(SIGUSR1, Arc::clone(&PICTURE))?;
        let again = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // Handlers run in this order: the first signal arms what the second one meets.
            flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&again))?;
            flag::register(signal, Arc::clone(&again))?;
            flag::register_usize(signal, Arc::clone(&END), signal as usize)?;
        }
        let mut signals = iterator::Signals::new([SIGINT, SIGTERM])?;
        std::thread::Builder::new().name("signals".into()).spawn(move || {
            for signal in signals.forever() {
                if WATCHERS.load(Ordering::SeqCst) == 0 {
                    end(signal as u8);
                }
                std::thread::spawn(move || {
                    end_where_stuck(signal as u8);
                });
            }
        })?;
        Ok(())
    }
}

/// Ends the process where its command writes into a pipe that nobody reads, or a device that takes nothing: it answers
/// no signal there.
#[cfg(unix)]
fn end_where_stuck(signal: u8) -> ! {
    let mut before = None;
    loop {
        let now = steradian::image::stream_progress();
        if now.is_some() && now == before {
            end(signal);
        }
        before = now;
        std::thread::sleep(STUCK);
    }
}

/// Ends the process between two writings of files, and leaves no temporary ones.
fn end(signal: u8) -> ! {
    let _writing = steradian::image::discard_drafts();
    let terminal = TERMINAL.get().copied().unwrap_or_else(|| Terminal::new(Talk::default()));
    let code = 128 + signal;
    terminal.error(&format!("stopped by {}", name(signal)));
    terminal.event(&Event::End { code });
    std::process::exit(code.into())
}

/// The terminal on which ends by signals are told.
static TERMINAL: OnceLock<Terminal> = OnceLock::new();

/// Tells ends by signals on a terminal from now on.
pub fn tell_on(terminal: Terminal) {
    let _ = TERMINAL.set(terminal);
}

/// As long as this is there, SIGINT and SIGTERM are for the command to answer.
#[derive(Debug)]
pub struct Signals(());

impl Signals {
    /// Watches for signals.
    pub fn watch() -> Self {
        WATCHERS.fetch_add(1, Ordering::SeqCst);
        Self(())
    }

    /// True if SIGUSR1 came since this was last asked.
    pub fn wants_picture(&self) -> bool {
        PICTURE.swap(false, Ordering::Relaxed)
    }

    /// The number of the signal that asks for the end.
    pub fn came(&self) -> Option<u8> {
        match END.load(Ordering::Relaxed) {
            0 => None,
            signal => Some(signal as u8),
        }
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        WATCHERS.fetch_sub(1, Ordering::SeqCst);
    }
}

/// The name of a signal that ends commands.
pub fn name(signal: u8) -> &'static str {
    match i32::from(signal) {
        SIGINT => "SIGINT",
        _ => "SIGTERM",
    }
}
