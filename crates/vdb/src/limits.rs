//! Bounds, within which files take memory.

/// Bounds on what a file may ask for.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Voxels of a dense grid.
    pub voxels: u64,
    /// Bytes of an unpacked grid.
    pub bytes: u64,
}
