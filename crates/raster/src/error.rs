//! Errors of the pipeline.

/// A refused call: which one, and the rule that it breaks. State is checked when a pipeline or an object is made, so
/// that drawing has nothing left to check but that the framebuffer fits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{call}: {rule}")]
pub struct Error {
    /// The call, as a user writes it: `Pipeline::new`.
    pub call: &'static str,
    /// The rule, with the value that breaks it.
    pub rule: String,
}

/// The result of a call that can be refused.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of `call`.
pub(crate) fn refuse<T>(call: &'static str, rule: impl Into<String>) -> Result<T> {
    Err(Error { call, rule: rule.into() })
}
