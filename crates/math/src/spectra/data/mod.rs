//! Tables of measured and standard spectra.
#![expect(clippy::approx_constant, reason = "measured values that happen to be near π")]

pub(crate) mod cameras;
pub(crate) mod cie1931;
pub(crate) mod color_checker;
pub(crate) mod conductors;
pub(crate) mod daylight;
pub(crate) mod glasses;
pub(crate) mod illuminants;
pub(crate) mod lamps;
pub(crate) mod metals;
