//! What can go wrong above the readers.

/// Errors of the façade.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No integrator of that name.
    #[error("unknown integrator '{name}'{}; known are {known}", .hint.as_ref().map(|h| format!(" ({h})")).unwrap_or_default())]
    UnknownIntegrator {
        /// What was asked for.
        name: String,
        /// "did you mean …?"
        hint: Option<String>,
        /// All names.
        known: String,
    },
    /// No sampler of that name.
    #[error("unknown sampler '{name}'{}; known are {known}", .hint.as_ref().map(|h| format!(" ({h})")).unwrap_or_default())]
    UnknownSampler {
        /// What was asked for.
        name: String,
        /// "did you mean …?"
        hint: Option<String>,
        /// All names.
        known: String,
    },
    /// An integrator option that does not exist or has no such value.
    #[error(
        "integrator option '{0}' is not understood; options are written NAME:key=value,key=value with keys max_depth, rr_depth, hide_emitters, reuse (1, 4, 16), caustics (auto, true, false), effort (auto, even, vertex)"
    )]
    IntegratorOption(String),
    /// What the graphics pipeline refused.
    #[error(transparent)]
    Raster(#[from] steradian_realtime::Error),
}
