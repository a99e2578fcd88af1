//! Handling of a ray's hits in an instance: the flags of both, put together once.

use crate::flags::{GeometryFlags, InstanceFlags, RayFlags};
use crate::top_level::Placed;
use steradian_math::Vec3;

/// Treatment of a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// It is none.
    Skipped,
    /// It counts without being asked about.
    Opaque,
    /// Its any-hit shader, or whoever runs the query, says whether it counts.
    NonOpaque,
}

/// Handling of a ray's hits in an instance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    opaque: Class,
    non_opaque: Class,
    /// Culling of front-facing and of back-facing triangles.
    culls_front: bool,
    culls_back: bool,
    counterclockwise: bool,
}

impl Plan {
    /// `None` where the ray does not meet the instance at all.
    #[inline]
    pub fn new(flags: RayFlags, mask: u8, placed: &Placed, is_triangles: bool) -> Option<Self> {
        let skipped = if is_triangles { RayFlags::SKIP_TRIANGLES } else { RayFlags::SKIP_PROCEDURAL_PRIMITIVES };
        if placed.mask & mask == 0 || flags.contains(skipped) {
            return None;
        }
        let class = |is_opaque: bool| {
            // The ray's flags win over the instance's, which win over the geometry's.
            let is_opaque = match placed.flags {
                f if f.contains(InstanceFlags::FORCE_OPAQUE) => true,
                f if f.contains(InstanceFlags::FORCE_NON_OPAQUE) => false,
                _ => is_opaque,
            };
            let is_opaque = match flags {
                f if f.contains(RayFlags::FORCE_OPAQUE) => true,
                f if f.contains(RayFlags::FORCE_NON_OPAQUE) => false,
                _ => is_opaque,
            };
            match is_opaque {
                true if flags.contains(RayFlags::CULL_OPAQUE) => Class::Skipped,
                false if flags.contains(RayFlags::CULL_NON_OPAQUE) => Class::Skipped,
                true => Class::Opaque,
                false => Class::NonOpaque,
            }
        };
        let culls = !placed.flags.contains(InstanceFlags::TRIANGLE_CULL_DISABLE);
        Some(Self {
            opaque: class(true),
            non_opaque: class(false),
            culls_front: culls && flags.contains(RayFlags::CULL_FRONT_FACING_TRIANGLES),
            culls_back: culls && flags.contains(RayFlags::CULL_BACK_FACING_TRIANGLES),
            counterclockwise: placed.flags.contains(InstanceFlags::TRIANGLE_FRONT_COUNTERCLOCKWISE),
        })
    }

    /// Treatment of hits on a geometry.
    pub fn class(&self, flags: GeometryFlags) -> Class {
        if flags.contains(GeometryFlags::OPAQUE) { self.opaque } else { self.non_opaque }
    }

    /// True if all hits on triangles are opaque, but for those culled by their face; `is_opaque` is true if all
    /// geometries are opaque.
    #[inline]
    pub fn is_certain(&self, is_opaque: bool) -> bool {
        self.opaque == Class::Opaque && (is_opaque || self.non_opaque == Class::Opaque)
    }

    /// True if hits on any geometry can be opaque.
    pub fn has_opaque(&self) -> bool {
        self.opaque == Class::Opaque || self.non_opaque == Class::Opaque
    }

    /// True if a triangle is front-facing to a ray; both are in object space.
    fn is_front(&self, corners: &[Vec3; 3], direction: Vec3) -> bool {
        is_clockwise(corners, direction) != self.counterclockwise
    }

    /// True if triangles are culled by their face.
    pub fn culls(&self) -> bool {
        self.culls_front || self.culls_back
    }

    /// True if a triangle is culled by its face.
    pub fn is_culled(&self, corners: &[Vec3; 3], direction: Vec3) -> bool {
        if self.is_front(corners, direction) { self.culls_front } else { self.culls_back }
    }
}

/// Tests for vertices in clockwise order as seen from the ray's origin, in a left-handed system of coordinates; seen so
/// in a right-handed one they are counter-clockwise (DXR, "D3D12_RAYTRACING_INSTANCE_FLAGS").
pub(crate) fn is_clockwise(corners: &[Vec3; 3], direction: Vec3) -> bool {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    (b - a).cross(c - a).dot(direction.as_dvec3()) < 0.0
}
