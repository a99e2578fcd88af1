//! Compaction (DXR, "CopyRaytracingAccelerationStructure" with `COMPACT`; Vulkan,
//! `VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR`).
//!
//! While a structure is built the arrays of what it holds grow, and have room for up to twice as much in the end. A
//! compacted copy has no such room; the hierarchy, which never has any, is the same bit for bit.

use crate::bottom_level::{BottomLevel, Boxes, BuildOptions, Content, Triangles};
use crate::error::BuildError;
use crate::top_level::{Placed, TopLevel};

/// Bytes of an array: of what it holds, or of what it has room for.
fn held<T>(array: &Vec<T>, is_compacted: bool) -> usize {
    size_of::<T>() * if is_compacted { array.len() } else { array.capacity() }
}

/// Checks that compaction is allowed.
fn allowed(options: BuildOptions) -> Result<(), BuildError> {
    if options.allow_compaction { Ok(()) } else { Err(BuildError::CompactionNotAllowed) }
}

impl Content {
    /// Memory that it takes, as it is or compacted.
    pub fn bytes(&self, is_compacted: bool) -> usize {
        let triangles = |g: &Triangles| held(&g.corners, is_compacted);
        let boxes = |g: &Boxes| held(&g.boxes, is_compacted);
        match self {
            Self::Triangles(all) => held(all, is_compacted) + all.iter().map(triangles).sum::<usize>(),
            Self::Boxes(all) => held(all, is_compacted) + all.iter().map(boxes).sum::<usize>(),
        }
    }

    fn compact(&mut self) {
        match self {
            Self::Triangles(all) => {
                all.shrink_to_fit();
                all.iter_mut().for_each(|g| g.corners.shrink_to_fit());
            }
            Self::Boxes(all) => {
                all.shrink_to_fit();
                all.iter_mut().for_each(|g| g.boxes.shrink_to_fit());
            }
        }
    }
}

impl BottomLevel {
    /// Memory that a compacted copy takes, in bytes; never more than the structure itself.
    ///
    /// # Errors
    /// A structure that was built without [`BuildOptions::allow_compaction`].
    pub fn compacted_bytes(&self) -> Result<usize, BuildError> {
        allowed(self.options())?;
        Ok(self.bvh.bytes() + self.content.bytes(true))
    }

    /// A compacted copy. It is the same bit for bit; an update makes new arrays, which may have room again.
    ///
    /// # Errors
    /// As [`BottomLevel::compacted_bytes`].
    pub fn compacted(&self) -> Result<Self, BuildError> {
        allowed(self.options())?;
        let mut copy = self.clone();
        copy.content.compact();
        Ok(copy)
    }
}

impl TopLevel {
    /// Memory that a compacted copy takes without its bottom levels, in bytes; never more than the structure itself.
    ///
    /// # Errors
    /// A structure that was built without [`BuildOptions::allow_compaction`].
    pub fn compacted_bytes(&self) -> Result<usize, BuildError> {
        allowed(self.options())?;
        Ok(self.bvh.bytes() + size_of::<Placed>() * self.instances.len())
    }

    /// A compacted copy, over the same bottom levels.
    ///
    /// # Errors
    /// As [`TopLevel::compacted_bytes`].
    pub fn compacted(&self) -> Result<Self, BuildError> {
        allowed(self.options())?;
        let mut copy = self.clone();
        copy.instances.shrink_to_fit();
        Ok(copy)
    }
}
