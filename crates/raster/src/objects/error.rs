//! Refusals by the error codes of OpenGL (OpenGL 4.6 core, section 2.3.1).
//!
//! Errors are values, not flags to be polled: a call that breaks a rule changes nothing and returns its own name, the
//! rule, and in brackets the code that `glGetError` would give.

use crate::error::{Result, refuse};

/// Refuses a number that is out of its range.
pub(super) fn invalid_value<T>(call: &'static str, rule: impl std::fmt::Display) -> Result<T> {
    refuse(call, format!("{rule} (INVALID_VALUE)"))
}

/// Refuses a constant that the call does not take.
pub(super) fn invalid_enum<T>(call: &'static str, rule: impl std::fmt::Display) -> Result<T> {
    refuse(call, format!("{rule} (INVALID_ENUM)"))
}

/// Refuses a call that the state of an object or of the context does not allow.
pub(super) fn invalid_operation<T>(call: &'static str, rule: impl std::fmt::Display) -> Result<T> {
    refuse(call, format!("{rule} (INVALID_OPERATION)"))
}

/// Refuses an allocation.
pub(super) fn out_of_memory<T>(call: &'static str, rule: impl std::fmt::Display) -> Result<T> {
    refuse(call, format!("{rule} (OUT_OF_MEMORY)"))
}

/// The result of a call in which a range beyond a buffer's end is an invalid operation (sections 8.4.4 and 10.4).
pub(super) fn as_operation<T>(result: Result<T>) -> Result<T> {
    result.map_err(|mut error| {
        error.rule = error.rule.replace("INVALID_VALUE", "INVALID_OPERATION");
        error
    })
}
