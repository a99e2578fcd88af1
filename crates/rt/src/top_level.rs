//! Top-level structures: where objects are.

use crate::bottom_level::{BottomLevel, BuildOptions, Content, MAX_GEOMETRIES, same_count, too_many, within};
use crate::error::BuildError;
use crate::flags::InstanceFlags;
use crate::transform::Transform3x4;
use std::sync::Arc;
use steradian_accel::{Bvh, Geometry};
use steradian_math::{Bounds3, Vec3, transform::Affine};

/// A placement of a bottom-level structure (DXR, "D3D12_RAYTRACING_INSTANCE_DESC"; Vulkan,
/// `VkAccelerationStructureInstanceKHR`).
#[derive(Clone, Debug)]
pub struct Instance {
    /// The structure placed in the world.
    pub bottom_level: Arc<BottomLevel>,
    /// World space from object space.
    pub transform: Transform3x4,
    /// A number of the caller's with 24 bits, which shaders can read (`InstanceID`, `gl_InstanceCustomIndexEXT`).
    pub custom_index: u32,
    /// Rays meet it only where their mask has a bit in common with this one.
    pub mask: u8,
    /// Contribution to the index of hit-group records; 24 bits.
    pub hit_group_offset: u32,
    /// Flags that override properties of its geometries.
    pub flags: InstanceFlags,
}

impl Instance {
    /// One that all rays meet, in world space as in object space.
    pub fn new(bottom_level: Arc<BottomLevel>) -> Self {
        Self {
            bottom_level,
            transform: Transform3x4::IDENTITY,
            custom_index: 0,
            mask: 0xff,
            hit_group_offset: 0,
            flags: InstanceFlags::NONE,
        }
    }

    /// As it is, but in another place.
    #[must_use]
    pub fn with_transform(self, transform: Transform3x4) -> Self {
        Self { transform, ..self }
    }

    /// As it is, but with another custom index.
    #[must_use]
    pub fn with_custom_index(self, custom_index: u32) -> Self {
        Self { custom_index, ..self }
    }

    /// As it is, but with another mask.
    #[must_use]
    pub fn with_mask(self, mask: u8) -> Self {
        Self { mask, ..self }
    }

    /// As it is, but with another offset into the table of hit groups.
    #[must_use]
    pub fn with_hit_group_offset(self, hit_group_offset: u32) -> Self {
        Self { hit_group_offset, ..self }
    }

    /// As it is, but with other flags.
    #[must_use]
    pub fn with_flags(self, flags: InstanceFlags) -> Self {
        Self { flags, ..self }
    }

    /// Instance as traversal needs it; an error where a rule is broken.
    fn placed(&self, instance: usize) -> Result<Placed, BuildError> {
        for (field, value) in [("custom index", self.custom_index), ("hit-group offset", self.hit_group_offset)] {
            if value >> 24 != 0 {
                return Err(BuildError::InstanceBits { instance, field, value });
            }
        }
        if self.flags.contains(InstanceFlags::FORCE_OPAQUE | InstanceFlags::FORCE_NON_OPAQUE) {
            return Err(BuildError::ExclusiveInstanceFlags { instance, flags: self.flags });
        }
        let place = self.transform.affine().ok_or(BuildError::InstanceTransform { instance })?;
        Ok(Placed {
            place,
            is_in_place: self.transform == Transform3x4::IDENTITY,
            bottom_level: self.bottom_level.clone(),
            custom_index: self.custom_index,
            mask: self.mask,
            hit_group_offset: self.hit_group_offset,
            flags: self.flags,
        })
    }
}

/// An instance in a structure.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub place: Affine,
    /// True if object space is world space.
    pub is_in_place: bool,
    pub bottom_level: Arc<BottomLevel>,
    pub custom_index: u32,
    pub mask: u8,
    pub hit_group_offset: u32,
    pub flags: InstanceFlags,
}

impl Placed {
    /// A box in world space that contains every point where a ray that was moved to object space may meet it.
    fn bounds(&self) -> Bounds3 {
        let bounds = self.bottom_level.bounds();
        if bounds.is_empty() {
            return Bounds3::EMPTY;
        }
        let greatest = |b: &Bounds3| b.min.abs().max(b.max.abs());
        let world = self.place.bounds(&bounds);
        // Rounding: of these numbers, and of the ray on its way to object space, seen from the world.
        let error = self.place.inverse().point_error(greatest(&world), Vec3::ZERO);
        let error = self.place.point_error(greatest(&bounds), error) * 2.0;
        Bounds3 { min: world.min - error, max: world.max + error }
    }
}

/// A structure over instances of bottom-level structures: what rays are traced in. It holds the bottom levels as they
/// were when it was built.
#[derive(Clone, Debug)]
pub struct TopLevel {
    pub(crate) bvh: Bvh,
    pub(crate) instances: Vec<Placed>,
    /// True if there are only triangles,
    pub(crate) only_triangles: bool,
    /// and if all of them are opaque where the ray does not say otherwise.
    pub(crate) only_opaque: bool,
    pub(crate) options: BuildOptions,
}

impl TopLevel {
    /// Builds a structure.
    ///
    /// # Errors
    /// A rule on instances that is broken: a number with more than 24 bits, flags that exclude each other, a singular
    /// transform, more than [`MAX_GEOMETRIES`] instances.
    pub fn build(instances: &[Instance], options: BuildOptions) -> Result<Self, BuildError> {
        let instances = placed(instances)?;
        let boxes: Vec<Bounds3> = instances.iter().map(Placed::bounds).collect();
        let bvh = Bvh::build_by(options.preference.builder(), &[Geometry::boxes(&boxes)]).map_err(too_many)?;
        let (only_triangles, only_opaque) = (only_triangles(&instances), only_opaque(&instances));
        Ok(Self { bvh, instances, only_triangles, only_opaque, options })
    }

    /// Follows instances that have changed: everything about them may change but their number (DXR, "Top-level
    /// acceleration structure updates"). Gives whether the shape of the hierarchy could be kept.
    ///
    /// # Errors
    /// A change of their number; a rule of [`TopLevel::build`]. The structure is unchanged then.
    pub fn update(&mut self, instances: &[Instance]) -> Result<bool, BuildError> {
        if !self.options.allow_update {
            return Err(BuildError::UpdateNotAllowed);
        }
        same_count("instances", self.instances.len(), instances.len())?;
        let instances = placed(instances)?;
        let boxes: Vec<Bounds3> = instances.iter().map(Placed::bounds).collect();
        let kept = self.bvh.update(&[Geometry::boxes(&boxes)]).map_err(too_many)?;
        (self.only_triangles, self.only_opaque) = (only_triangles(&instances), only_opaque(&instances));
        self.instances = instances;
        Ok(kept)
    }

    /// Options of its build.
    pub fn options(&self) -> BuildOptions {
        self.options
    }

    /// The box around all instances, in world space; empty when there are none.
    pub fn bounds(&self) -> Bounds3 {
        self.bvh.bounds()
    }

    /// Number of instances.
    pub fn instance_count(&self) -> usize {
        self.instances.len()
    }
}

fn only_triangles(instances: &[Placed]) -> bool {
    instances.iter().all(|placed| matches!(placed.bottom_level.content, Content::Triangles(_)))
}

fn only_opaque(instances: &[Placed]) -> bool {
    let is_opaque = |placed: &Placed| match placed.flags {
        f if f.contains(InstanceFlags::FORCE_OPAQUE) => true,
        f if f.contains(InstanceFlags::FORCE_NON_OPAQUE) => false,
        _ => placed.bottom_level.is_opaque,
    };
    instances.iter().all(is_opaque)
}

fn placed(instances: &[Instance]) -> Result<Vec<Placed>, BuildError> {
    within("instances", instances.len() as u64, MAX_GEOMETRIES)?;
    instances.iter().enumerate().map(|(i, instance)| instance.placed(i)).collect()
}
