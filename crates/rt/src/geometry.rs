//! Geometries, the input of bottom-level structures (DXR, "D3D12_RAYTRACING_GEOMETRY_DESC"; Vulkan,
//! `VkAccelerationStructureGeometryKHR`).

use crate::error::BuildError;
use crate::flags::GeometryFlags;
use crate::transform::Transform3x4;
use steradian_math::{Bounds3, Vec3};

/// Which vertices make triangles, three for each.
#[derive(Clone, Copy, Debug)]
pub enum Indices<'a> {
    /// The vertices in their order.
    None,
    /// Indices of 16 bits.
    U16(&'a [u16]),
    /// Indices of 32 bits.
    U32(&'a [u32]),
}

/// Triangles of one geometry.
#[derive(Clone, Copy, Debug)]
pub struct TriangleGeometry<'a> {
    /// Vertices. A triangle whose first vertex has a NaN as x is inactive: it keeps its number, and no ray hits it.
    /// Other triangles with numbers that are not finite, or without area, are not hit either.
    pub vertices: &'a [Vec3],
    /// Three for each triangle.
    pub indices: Indices<'a>,
    /// Applied to the vertices before the structure is built. It belongs to object space: a mirror here changes which
    /// side of a triangle is its front.
    pub transform: Option<Transform3x4>,
    /// Flags of its triangles.
    pub flags: GeometryFlags,
}

impl<'a> TriangleGeometry<'a> {
    /// Opaque triangles of consecutive vertices.
    pub fn new(vertices: &'a [Vec3]) -> Self {
        Self { vertices, indices: Indices::None, transform: None, flags: GeometryFlags::OPAQUE }
    }

    /// Opaque triangles with indices.
    pub fn indexed(vertices: &'a [Vec3], indices: &'a [u32]) -> Self {
        Self { indices: Indices::U32(indices), ..Self::new(vertices) }
    }

    /// As it is, but with other flags.
    #[must_use]
    pub fn with_flags(self, flags: GeometryFlags) -> Self {
        Self { flags, ..self }
    }

    /// As it is, but with a transform.
    #[must_use]
    pub fn with_transform(self, transform: Transform3x4) -> Self {
        Self { transform: Some(transform), ..self }
    }

    /// Number of triangle corners: of indices, or of vertices where there are no indices.
    fn corner_count(&self) -> usize {
        match self.indices {
            Indices::None => self.vertices.len(),
            Indices::U16(indices) => indices.len(),
            Indices::U32(indices) => indices.len(),
        }
    }

    /// The index of the vertex at a corner.
    pub(crate) fn index(&self, corner: usize) -> u32 {
        match self.indices {
            Indices::None => corner as u32,
            Indices::U16(indices) => indices[corner].into(),
            Indices::U32(indices) => indices[corner],
        }
    }

    /// The vertices of all triangles in object space, when every rule is kept.
    pub(crate) fn triangles(&self, geometry: usize) -> Result<Vec<[Vec3; 3]>, BuildError> {
        let corners = self.corner_count();
        if !corners.is_multiple_of(3) {
            return Err(BuildError::IncompleteTriangle { geometry, corners });
        }
        let place = match self.transform {
            None => None,
            Some(transform) => Some(transform.affine().ok_or(BuildError::GeometryTransform { geometry })?.m),
        };
        let corner = |i: usize| {
            let index = self.index(i);
            let vertex = self.vertices.get(index as usize).ok_or(BuildError::VertexIndex {
                geometry,
                triangle: i / 3,
                index,
                vertices: self.vertices.len(),
            })?;
            Ok(place.map_or(*vertex, |place| place.transform_point3(*vertex)))
        };
        (0..corners / 3).map(|i| Ok([corner(3 * i)?, corner(3 * i + 1)?, corner(3 * i + 2)?])).collect()
    }
}

/// Procedural primitives of one geometry: boxes, which intersection shaders fill.
#[derive(Clone, Copy, Debug)]
pub struct BoxGeometry<'a> {
    /// Boxes. One whose `min.x` is NaN is inactive: it keeps its number, and no ray meets it. One that is inverted on
    /// any axis is the point at its centre.
    pub boxes: &'a [Bounds3],
    /// Flags of its primitives.
    pub flags: GeometryFlags,
}

impl<'a> BoxGeometry<'a> {
    /// Opaque primitives.
    pub fn new(boxes: &'a [Bounds3]) -> Self {
        Self { boxes, flags: GeometryFlags::OPAQUE }
    }

    /// As it is, but with other flags.
    #[must_use]
    pub fn with_flags(self, flags: GeometryFlags) -> Self {
        Self { flags, ..self }
    }

    /// The boxes with those that are inverted made points (DXR, "Degenerate primitives and instances").
    pub(crate) fn upright(&self) -> Vec<Bounds3> {
        let upright = |b: &Bounds3| {
            let inverted = b.min.x > b.max.x || b.min.y > b.max.y || b.min.z > b.max.z;
            if inverted { Bounds3 { min: b.center(), max: b.center() } } else { *b }
        };
        self.boxes.iter().map(upright).collect()
    }
}

/// The geometries of a bottom-level structure: all of one kind (DXR, "Geometry and acceleration structures").
#[derive(Clone, Copy, Debug)]
pub enum Geometries<'a> {
    /// Triangles.
    Triangles(&'a [TriangleGeometry<'a>]),
    /// Procedural primitives.
    Boxes(&'a [BoxGeometry<'a>]),
}
