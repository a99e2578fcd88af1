//! Exit codes and failures of commands.

/// Exit code: done.
pub const DONE: u8 = 0;
/// Exit code: the work failed.
pub const FAILED: u8 = 1;
/// Exit code: bad command line, scene or picture.
pub const BAD_INPUT: u8 = 2;
/// Exit code: pictures differ by more than was allowed.
pub const DIFFERENT: u8 = 4;

/// Exit code: nothing differs, but not everything could be decided.
pub const UNDECIDED: u8 = 5;
/// Exit code: not done for a reason that may be gone at the next try, `EX_TEMPFAIL` of sysexits.h.
pub const TRY_AGAIN: u8 = 75;

/// The exit code of a command that ran to its end, or why it did not.
pub type Outcome = Result<u8, Failure>;

/// Why a command ends early, and its exit code.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub code: u8,
    /// Message on stderr.
    pub message: String,
}

impl Failure {
    /// The work could not be done.
    pub fn failed(message: impl Into<String>) -> Self {
        Self { code: FAILED, message: message.into() }
    }

    /// Failure by wrong input.
    pub fn bad_input(message: impl Into<String>) -> Self {
        Self { code: BAD_INPUT, message: message.into() }
    }
}

impl From<std::io::Error> for Failure {
    /// Standard output that cannot be written.
    fn from(error: std::io::Error) -> Self {
        Self::failed(format!("cannot write to standard output: {error}"))
    }
}
