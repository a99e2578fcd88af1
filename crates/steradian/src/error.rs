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
    /// More threads, or samples per pixel, than there may be.
    #[error("{what} are whole numbers from {least} to {most}, not {asked}")]
    OutOfRange {
        /// Of what.
        what: &'static str,
        /// The least number.
        least: usize,
        /// The largest.
        most: usize,
        /// What was asked for.
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
        /// What of the scene.
        what: String,
    },
    /// An integrator option that does not exist or has no such value.
    #[error(
        "option '{option}' of integrator '{integrator}' is not understood{hint}; options are written \
         NAME:key=value,key=value, and its keys are {keys}"
    )]
    IntegratorOption {
        /// What was asked for.
        option: String,
        /// The integrator.
        integrator: String,
        /// The nearest of its keys, if one is near.
        hint: String,
        /// The options that it has, with their defaults.
        keys: String,
    },
    /// A method that has no samples for single pixels.
    #[error(
        "integrator '{0}' makes whole pictures pass by pass and cannot sample parts of one more than others: leave out --adaptive, or use 'path' or 'volpath'"
    )]
    NotAdaptive(String),
    /// What the graphics pipeline refused.
    #[error(transparent)]
    Raster(#[from] steradian_realtime::Error),
    /// A scene with errors, by all that is said of it.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Scene(steradian_scene::Diagnostics),
    /// A render that could not go on.
    #[error("{0}")]
    Failed(String),
    /// An option of radiosity that does not exist or has no such value.
    #[error(
        "option '{0}' of radiosity is not understood; keys are method ({methods}), factors (analytic, montecarlo, hemicube), resolution (rays of a patch, or pixels of a hemicube's edge; 2 to 4096), patches (1 to 2000000), adaptive (0 to 8), tolerance (above 0, below 1), rays (1 to 1000000), wavelengths (4 to 256), ambient, gather (0 to 4096), smooth, solution (a file), max_depth, hide_emitters",
        methods = steradian_integrators::radiosity::METHODS.iter().map(|m| m.0).collect::<Vec<_>>().join(", ")
    )]
    RadiosityOption(String),
    /// An option of ambient occlusion that does not exist or has no such value.
    #[error("option '{0}' of ao is not understood; it knows distance, a length above 0")]
    AmbientOcclusionOption(String),
    /// A picture that could not be written or read.
    #[error(transparent)]
    Image(#[from] steradian_image::Error),
    /// A picture that cannot be denoised.
    #[error(transparent)]
    Denoise(#[from] steradian_denoise::Error),
    /// A library of others that does not serve, or did not.
    #[error(transparent)]
    Oidn(#[from] steradian_denoise::oidn::Error),
    /// A scene that radiosity cannot do.
    #[error("{0}")]
    Radiosity(#[from] steradian_integrators::radiosity::Refusal),
}
