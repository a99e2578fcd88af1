//! Reasons why there is no volume.

/// Names of grids that an error lists.
pub(crate) const LISTED: usize = 16;

/// Reason why a volume cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The bytes are of another kind of file.
    #[error("it is neither a NanoVDB nor an OpenVDB file, by its first bytes")]
    Unknown,
    /// The file ends before what it says that it has.
    #[error("it ends within {0}")]
    Short(&'static str),
    /// The file contradicts itself.
    #[error("{0}")]
    Malformed(String),
    /// A part of a kind that is not read.
    #[error("{0}")]
    Unsupported(String),
    /// There is no grid of this name.
    #[error("it has no grid '{name}' ({})", there_is(.there))]
    NoGrid {
        /// The name asked for.
        name: String,
        /// Names of the grids that there are, at most 16.
        there: Vec<String>,
    },
    /// The grid has no active voxels.
    #[error("its grid '{0}' has no active voxels")]
    Empty(String),
    /// There is more than the limits allow.
    #[error("{0}")]
    Limit(String),
}

fn there_is(names: &[String]) -> String {
    if names.is_empty() { "it has none".into() } else { format!("it has: {}", names.join(", ")) }
}
