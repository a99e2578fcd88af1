//! SIGINT and SIGTERM: the first asks for an orderly end, the second does not ask. SIGUSR1 asks for the picture as it is.

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};
use std::sync::{
    Arc,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};

/// Which signals came, if any.
#[derive(Clone, Debug)]
pub struct Signals {
    end: Arc<AtomicUsize>,
    picture: Arc<AtomicBool>,
}

impl Signals {
    /// Takes over the signals. Until then they end the process as usual.
    ///
    /// # Errors
    /// When the system does not allow it.
    pub fn watch() -> std::io::Result<Self> {
        let came = Arc::new(AtomicUsize::new(0));
        let again = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // Handlers run in this order: the first signal arms what the second one meets.
            flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&again))?;
            flag::register(signal, Arc::clone(&again))?;
            flag::register_usize(signal, Arc::clone(&came), signal as usize)?;
        }
        let picture = Arc::default();
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&picture))?;
        Ok(Self { end: came, picture })
    }

    /// Whether SIGUSR1 came since this was last asked.
    pub fn wants_picture(&self) -> bool {
        self.picture.swap(false, Ordering::Relaxed)
    }

    /// The number of the signal that asks for the end.
    pub fn came(&self) -> Option<u8> {
        match self.end.load(Ordering::Relaxed) {
            0 => None,
            signal => Some(signal as u8),
        }
    }
}

/// Lets writing fail, and be answered for, where a file is larger than allowed (`ulimit -f`), rather than end the
/// process.
pub fn answer_limits() {
    #[cfg(unix)]
    let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// The name of a signal that [`Signals`] watches.
pub fn name(signal: u8) -> &'static str {
    match i32::from(signal) {
        SIGINT => "SIGINT",
        _ => "SIGTERM",
    }
}
