//! Errors above the readers.

/// Errors of the façade.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A slip in the name or the options of an integrator.
    #[error(transparent)]
    Request(#[from] steradian_request::Error),
    /// No sampler of that name.
    #[error("unknown sampler '{name}'{}; known are {known}", .hint.as_ref().map(|h| format!(" ({h})")).unwrap_or_default())]
    UnknownSampler {
        /// Requested name.
        name: String,
        /// "did you mean …?"
        hint: Option<String>,
        /// All names.
        known: String,
    },
    /// More threads, or samples per pixel, than there may be.
    #[error("{what} are whole numbers from {least} to {most}, not {asked}")]
    OutOfRange {
        /// Quantity that is out of range.
        what: &'static str,
        /// The least number.
        least: usize,
        /// The largest.
        most: usize,
        /// Requested number.
        asked: usize,
    },
    /// A picture to denoise has no pixel that is finite, from which others are filled.
    #[error("{0}: a denoiser fills pixels from finite ones around them")]
    NothingFinite(String),
    /// An integrator cannot do what is in the scene.
    #[error("integrator '{integrator}' cannot do {what}")]
    CannotRender {
        /// Its name.
        integrator: String,
        /// Unsupported feature of the scene.
        what: String,
    },
    /// A method that has no samples for single pixels.
    #[error(
        "integrator '{0}' makes whole pictures pass by pass and cannot sample parts of one more than others: leave out --adaptive, or use 'path' or 'volpath'"
    )]
    NotAdaptive(String),
    /// Options that do not go together, or a scene that the method cannot begin with.
    #[error(transparent)]
    Refused(#[from] steradian_engine::Refusal),
    /// A scene with errors, by all that is said of it.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Scene(steradian_scene::Diagnostics),
    /// A render that could not go on.
    #[error("{0}")]
    Failed(String),
    /// Meshes of which no normal map can be baked, by the reason.
    #[error("{0}")]
    CannotBake(String),
    /// Meshes that have no texture atlas, by the reason.
    #[error("{0}")]
    CannotUnwrap(String),
    /// A picture that could not be written or read.
    #[error(transparent)]
    Image(#[from] steradian_image::Error),
    /// A picture that cannot be denoised.
    #[error(transparent)]
    Denoise(#[from] steradian_denoise::Error),
    /// A library of others that does not serve, or did not.
    #[error(transparent)]
    Oidn(#[from] steradian_denoise::oidn::Error),
}
