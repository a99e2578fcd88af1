//! Memory sizes of structures, known before they are built (DXR, "GetRaytracingAccelerationStructurePrebuildInfo";
//! Vulkan, `vkGetAccelerationStructureBuildSizesKHR`).

use crate::bottom_level::{BottomLevel, Boxes, BuildOptions, MAX_GEOMETRIES, MAX_PRIMITIVES, Triangles, within};
use crate::error::BuildError;
use crate::top_level::{Placed, TopLevel};
use steradian_accel::{Bvh, Geometry};
use steradian_math::{Bounds3, Vec3};

/// Input of a bottom level without its data: the number of primitives of each geometry.
#[derive(Clone, Copy, Debug)]
pub enum PrimitiveCounts<'a> {
    /// Numbers of triangles.
    Triangles(&'a [u64]),
    /// Numbers of procedural primitives.
    Boxes(&'a [u64]),
}

/// Bounds, in bytes. They hold for all structures of so many primitives at most, whatever their geometry is; most
/// structures take much less.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildSizes {
    /// Size of the structure.
    pub structure: u64,
    /// Scratch memory of the build.
    pub build_scratch: u64,
    /// Scratch memory of an update: it may have to build the hierarchy anew, while the former one is still there. Zero
    /// where updates are not allowed.
    pub update_scratch: u64,
}

impl BuildSizes {
    fn new(structure: u64, build_scratch: u64, options: BuildOptions) -> Self {
        let update_scratch = if options.allow_update { structure + build_scratch } else { 0 };
        Self { structure, build_scratch, update_scratch }
    }
}

/// Most elements that an array has room for which has grown to some: it doubles, from four.
const fn grown(len: u64) -> u64 {
    if len < 2 { 4 } else { 2 * len }
}

impl BottomLevel {
    /// Upper bounds of a structure's size and of the memory to build it.
    ///
    /// # Errors
    /// More than [`MAX_GEOMETRIES`] or [`MAX_PRIMITIVES`].
    pub fn sizes(counts: PrimitiveCounts, options: BuildOptions) -> Result<BuildSizes, BuildError> {
        let (PrimitiveCounts::Triangles(counts_of_all) | PrimitiveCounts::Boxes(counts_of_all)) = counts;
        let geometries = counts_of_all.len() as u64;
        within("geometries", geometries, MAX_GEOMETRIES)?;
        let primitives = counts_of_all.iter().fold(0_u64, |sum, count| sum.saturating_add(*count));
        within("primitives", primitives, MAX_PRIMITIVES)?;
        let rooms: u64 = counts_of_all.iter().map(|count| grown(*count)).sum();
        // What is held, what the hierarchy takes, and, of each primitive, what else is made to build it.
        let (content, tree, made) = match counts {
            PrimitiveCounts::Triangles(_) => (
                rooms * size_of::<[Vec3; 3]>() as u64 + grown(geometries) * size_of::<Triangles>() as u64,
                Bvh::most_bytes(primitives, 0, geometries),
                size_of::<[u32; 3]>() as u64,
            ),
            PrimitiveCounts::Boxes(_) => (
                rooms * size_of::<Bounds3>() as u64 + grown(geometries) * size_of::<Boxes>() as u64,
                Bvh::most_bytes(0, primitives, geometries),
                0,
            ),
        };
        let lists = geometries * (size_of::<Geometry>() + size_of::<Vec<[u32; 3]>>()) as u64;
        let tree_scratch = Bvh::most_scratch_bytes(options.preference.builder(), primitives, geometries);
        // Arrays that grow are copied from one to another of twice the size.
        let scratch = tree_scratch + primitives * made + lists + content / 2;
        Ok(BuildSizes::new(content + tree, scratch, options))
    }

    /// Memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + self.content.bytes(false)
    }
}

impl TopLevel {
    /// Upper bounds of the size of a structure of so many instances, and of the memory to build it. Both are without
    /// its bottom levels.
    ///
    /// # Errors
    /// More than [`MAX_GEOMETRIES`] instances.
    pub fn sizes(instances: u64, options: BuildOptions) -> Result<BuildSizes, BuildError> {
        within("instances", instances, MAX_GEOMETRIES)?;
        let content = grown(instances) * size_of::<Placed>() as u64;
        let tree_scratch = Bvh::most_scratch_bytes(options.preference.builder(), instances, 1);
        let scratch = tree_scratch + instances * size_of::<Bounds3>() as u64 + content / 2;
        Ok(BuildSizes::new(content + Bvh::most_bytes(0, instances, 1), scratch, options))
    }

    /// Memory that it takes without its bottom levels, in bytes.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + size_of::<Placed>() * self.instances.capacity()
    }
}
