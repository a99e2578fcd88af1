//! Errors in numbers that come from outside.

/// Why a value of this crate could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A text file of spectral samples is malformed; `line` counts from 1.
    #[error("line {line}: {reason}")]
    SpectrumFile {
        /// The line at fault, counted from 1.
        line: usize,
        /// Fault in that line.
        reason: String,
    },
    /// Wavelengths and values do not make a curve.
    #[error("spectrum: {0}")]
    Curve(String),
}
