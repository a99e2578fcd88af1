//! Limits on the contents of files.

/// Resource limits of a reader.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Largest file read, in bytes (after gzip too).
    pub file_bytes: u64,
    /// Tells how many bytes of memory can be had; files for which there is no room are not read.
    pub memory: Option<fn() -> Option<u64>>,
    /// Most files a scene may include, nested or in sequence.
    pub includes: usize,
    /// Deepest nesting of includes.
    pub include_depth: usize,
    /// Deepest nesting of attribute blocks or XML elements.
    pub nesting: usize,
    /// Most instances.
    pub instances: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 8 << 30,
            memory: None,
            includes: 10_000,
            include_depth: 15,
            nesting: 10_000,
            instances: 50_000_000,
        }
    }
}

/// Bytes that need no room made: asking for the memory there is costs more.
const SMALL: u64 = 16 << 20;

impl Limits {
    /// The bytes of memory that there are, where they are known and fewer than these.
    pub(crate) fn shortage(&self, needed: u64) -> Option<u64> {
        self.memory.filter(|_| needed > SMALL)?().filter(|&there_is| needed > there_is)
    }
}

/// Most bytes that a byte of a compressed scene file may stand for. Scenes reach ten.
pub(crate) const MOST_OF_TEXT: u64 = 200;
/// Most bytes that a byte of a compressed mesh may stand for. Meshes reach five.
pub(crate) const MOST_OF_MESHES: u64 = 32;
/// Bytes that any compressed file may unpack to.
const ALWAYS: u64 = 16 << 20;

/// Most bytes that so many packed ones may unpack to, where a byte may stand for `most`.
pub(crate) fn unpacked(packed: usize, most: u64) -> u64 {
    ALWAYS.max((packed as u64).saturating_mul(most))
}
