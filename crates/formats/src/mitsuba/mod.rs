//! Mitsuba XML scene files.
