//! Bottom-level structures: the geometries of one object.

use crate::error::BuildError;
use crate::flags::GeometryFlags;
use crate::geometry::{BoxGeometry, Geometries, Indices, TriangleGeometry};
use std::ops::Range;
use steradian_accel::{Builder, Bvh, Geometry};
use steradian_math::{Bounds3, Vec3, hash::combine64};

/// Build flags of a structure (DXR, "D3D12_RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildOptions {
    /// Allows updates.
    pub allow_update: bool,
    /// Allows a copy to a compacted structure.
    pub allow_compaction: bool,
    /// Trade-off between trace and build performance.
    pub preference: Preference,
}

/// Trade-off between trace and build performance. Hits are the same for all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preference {
    /// Neither.
    #[default]
    Balanced,
    /// Rays are fast, building is slower.
    FastTrace,
    /// Building is fast where there are many processors, rays are slower.
    FastBuild,
}

impl Preference {
    /// None of these cuts primitives, so that each is met at most once by a ray.
    pub(crate) const fn builder(self) -> Builder {
        match self {
            Self::Balanced => Builder::Sah,
            Self::FastTrace => Builder::Reinsertion,
            Self::FastBuild => Builder::Ploc,
        }
    }
}

/// Most geometries of a bottom-level structure, and most instances of a top-level one.
pub const MAX_GEOMETRIES: u64 = 1 << 24;
/// Most primitives of a bottom-level structure.
pub const MAX_PRIMITIVES: u64 = 1 << 29;

/// A structure over triangles or over procedural primitives. It keeps no reference to what it was built from.
#[derive(Clone, Debug)]
pub struct BottomLevel {
    pub(crate) bvh: Bvh,
    pub(crate) content: Content,
    /// True if all geometries are opaque.
    pub(crate) is_opaque: bool,
    options: BuildOptions,
}

/// The primitives of a structure.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    Triangles(Vec<Triangles>),
    Boxes(Vec<Boxes>),
}

/// The triangles of one geometry.
#[derive(Clone, Debug)]
pub(crate) struct Triangles {
    /// In object space.
    pub corners: Vec<[Vec3; 3]>,
    pub flags: GeometryFlags,
    pub form: Form,
}

/// The boxes of one geometry.
#[derive(Clone, Debug)]
pub(crate) struct Boxes {
    pub boxes: Vec<Bounds3>,
    pub flags: GeometryFlags,
}

/// Properties that an update of triangles may not change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Form {
    pub vertices: usize,
    /// Bytes of an index; zero without.
    pub index_bytes: u8,
    pub index_hash: u64,
    pub is_transformed: bool,
}

impl Form {
    fn of(geometry: &TriangleGeometry) -> Self {
        let hash = |indices: &mut dyn Iterator<Item = u32>| indices.fold(0, |hash, i| combine64(hash, i.into()));
        let (index_bytes, index_hash) = match geometry.indices {
            Indices::None => (0, 0),
            Indices::U16(indices) => (2, hash(&mut indices.iter().map(|&i| i.into()))),
            Indices::U32(indices) => (4, hash(&mut indices.iter().copied())),
        };
        let is_transformed = geometry.transform.is_some();
        Self { vertices: geometry.vertices.len(), index_bytes, index_hash, is_transformed }
    }

    /// The first property that has changed.
    fn change(&self, now: &Self) -> Option<&'static str> {
        let changes = [
            (self.vertices != now.vertices, "the number of vertices"),
            (self.index_bytes != now.index_bytes, "the format of the indices"),
            (self.index_hash != now.index_hash, "the indices"),
            (self.is_transformed != now.is_transformed, "whether there is a transform"),
        ];
        changes.into_iter().find(|(changed, _)| *changed).map(|(_, what)| what)
    }
}

impl Content {
    fn of(geometries: &Geometries) -> Result<Self, BuildError> {
        Self::of_some(geometries, 0..usize::MAX)
    }

    /// The content of some of the geometries.
    pub fn of_some(geometries: &Geometries, range: Range<usize>) -> Result<Self, BuildError> {
        let triangles = |(i, geometry): (usize, &TriangleGeometry)| {
            Ok(Triangles { corners: geometry.triangles(i)?, flags: geometry.flags, form: Form::of(geometry) })
        };
        let boxes = |geometry: &BoxGeometry| Boxes { boxes: geometry.upright(), flags: geometry.flags };
        let content = match geometries {
            Geometries::Triangles(all) => {
                within("geometries", all.len() as u64, MAX_GEOMETRIES)?;
                let some = all.iter().enumerate().take(range.end).skip(range.start);
                Self::Triangles(some.map(triangles).collect::<Result<_, _>>()?)
            }
            Geometries::Boxes(all) => {
                within("geometries", all.len() as u64, MAX_GEOMETRIES)?;
                Self::Boxes(all.iter().take(range.end).skip(range.start).map(boxes).collect())
            }
        };
        content.check_limits()?;
        Ok(content)
    }

    /// Adds geometries of the same kind.
    pub fn append(&mut self, more: Self) {
        match (self, more) {
            (Self::Triangles(all), Self::Triangles(more)) => all.extend(more),
            (Self::Boxes(all), Self::Boxes(more)) => all.extend(more),
            _ => {}
        }
    }

    fn is_opaque(&self) -> bool {
        match self {
            Self::Triangles(all) => all.iter().all(|g| g.flags.contains(GeometryFlags::OPAQUE)),
            Self::Boxes(all) => all.iter().all(|g| g.flags.contains(GeometryFlags::OPAQUE)),
        }
    }

    fn check_limits(&self) -> Result<(), BuildError> {
        let geometries = match self {
            Self::Triangles(all) => all.len(),
            Self::Boxes(all) => all.len(),
        };
        within("geometries", geometries as u64, MAX_GEOMETRIES)?;
        within("primitives", self.primitive_count() as u64, MAX_PRIMITIVES)
    }

    fn primitive_count(&self) -> usize {
        match self {
            Self::Triangles(all) => all.iter().map(|g| g.corners.len()).sum(),
            Self::Boxes(all) => all.iter().map(|g| g.boxes.len()).sum(),
        }
    }

    /// Calls `use_it` with the geometries as the hierarchy takes them. Hits on all triangles can be filtered; queries
    /// that filter none pay nothing for it.
    fn with_geometries<T>(&self, use_it: impl FnOnce(&[Geometry]) -> T) -> T {
        match self {
            Self::Triangles(all) => {
                let corners = |n: usize| (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect::<Vec<_>>();
                let indices: Vec<_> = all.iter().map(|g| corners(g.corners.len())).collect();
                let geometries: Vec<_> = all
                    .iter()
                    .zip(&indices)
                    .map(|(g, indices)| Geometry::triangles(g.corners.as_flattened(), indices).filtered(true))
                    .collect();
                use_it(&geometries)
            }
            Self::Boxes(all) => use_it(&all.iter().map(|g| Geometry::boxes(&g.boxes)).collect::<Vec<_>>()),
        }
    }

    /// Checks that this is a valid update of `before`.
    fn check_update_of(&self, before: &Self) -> Result<(), BuildError> {
        match (before, self) {
            (Self::Triangles(before), Self::Triangles(now)) => {
                same_count("geometries", before.len(), now.len())?;
                let pairs = before.iter().zip(now).enumerate();
                { pairs }.try_for_each(|(i, (before, now))| now.check_update_of(before, i))
            }
            (Self::Boxes(before), Self::Boxes(now)) => {
                same_count("geometries", before.len(), now.len())?;
                let pairs = before.iter().zip(now).enumerate();
                { pairs }.try_for_each(|(i, (before, now))| now.check_update_of(before, i))
            }
            _ => Err(BuildError::UpdateChanges { what: "the kind", geometry: 0 }),
        }
    }
}

impl Triangles {
    fn check_update_of(&self, before: &Self, geometry: usize) -> Result<(), BuildError> {
        let change = before.form.change(&self.form).or((before.flags != self.flags).then_some("the flags"));
        if let Some(what) = change {
            return Err(BuildError::UpdateChanges { what, geometry });
        }
        let is_active = |corners: &[Vec3; 3]| !corners[0].x.is_nan();
        let changed = before.corners.iter().zip(&self.corners).position(|(a, b)| is_active(a) != is_active(b));
        changed.map_or(Ok(()), |primitive| Err(BuildError::UpdateActivity { geometry, primitive }))
    }
}

impl Boxes {
    fn check_update_of(&self, before: &Self, geometry: usize) -> Result<(), BuildError> {
        same_count("boxes", before.boxes.len(), self.boxes.len())?;
        if before.flags != self.flags {
            return Err(BuildError::UpdateChanges { what: "the flags", geometry });
        }
        let is_active = |b: &Bounds3| !b.min.x.is_nan();
        let changed = before.boxes.iter().zip(&self.boxes).position(|(a, b)| is_active(a) != is_active(b));
        changed.map_or(Ok(()), |primitive| Err(BuildError::UpdateActivity { geometry, primitive }))
    }
}

/// Checks that a number is within a limit.
pub(crate) fn within(what: &'static str, count: u64, limit: u64) -> Result<(), BuildError> {
    if count <= limit { Ok(()) } else { Err(BuildError::TooMany { what, count, limit }) }
}

/// Checks that an update keeps a number.
pub(crate) fn same_count(what: &'static str, before: usize, now: usize) -> Result<(), BuildError> {
    if before == now { Ok(()) } else { Err(BuildError::UpdateCount { what, before, now }) }
}

/// Converts the error of a hierarchy with too many primitives.
pub(crate) fn too_many(error: steradian_accel::Error) -> BuildError {
    match error {
        steradian_accel::Error::TooManyPrimitives { count, limit } => {
            BuildError::TooMany { what: "primitives", count, limit }
        }
        // Structures here have no objects of the hierarchy's own.
        _ => BuildError::TooMany { what: "primitives", count: 0, limit: MAX_PRIMITIVES },
    }
}

impl BottomLevel {
    /// Builds a structure, on all threads of rayon's current pool; the result does not depend on their number.
    ///
    /// # Errors
    /// A rule on geometries that is broken: a number of corners that is no multiple of three, an index without a
    /// vertex, a singular transform, more than [`MAX_GEOMETRIES`] or [`MAX_PRIMITIVES`].
    pub fn build(geometries: Geometries, options: BuildOptions) -> Result<Self, BuildError> {
        Self::from_content(Content::of(&geometries)?, options)
    }

    /// Builds the hierarchy.
    pub(crate) fn from_content(content: Content, options: BuildOptions) -> Result<Self, BuildError> {
        content.check_limits()?;
        let builder = options.preference.builder();
        let bvh = content.with_geometries(|geometries| Bvh::build_by(builder, geometries)).map_err(too_many)?;
        let is_opaque = content.is_opaque();
        Ok(Self { bvh, content, is_opaque, options })
    }

    /// Follows geometry that has moved: vertices, transforms and boxes may change, nothing else (DXR, "Bottom-level
    /// acceleration structure updates"). Gives whether the shape of the hierarchy could be kept; where primitives have
    /// become degenerate or stopped being so, it is built anew.
    ///
    /// Top-level structures that were built before hold the former state.
    ///
    /// # Errors
    /// What has changed that may not; a rule of [`BottomLevel::build`]. The structure is unchanged then.
    pub fn update(&mut self, geometries: Geometries) -> Result<bool, BuildError> {
        if !self.options.allow_update {
            return Err(BuildError::UpdateNotAllowed);
        }
        let content = Content::of(&geometries)?;
        content.check_update_of(&self.content)?;
        let bvh = &mut self.bvh;
        let kept = content.with_geometries(|geometries| bvh.update(geometries)).map_err(too_many)?;
        self.content = content;
        Ok(kept)
    }

    /// Options of its build.
    pub fn options(&self) -> BuildOptions {
        self.options
    }

    /// The box around all active primitives, in object space; empty when there are none.
    pub fn bounds(&self) -> Bounds3 {
        self.bvh.bounds()
    }

    /// Number of geometries.
    pub fn geometry_count(&self) -> usize {
        match &self.content {
            Content::Triangles(all) => all.len(),
            Content::Boxes(all) => all.len(),
        }
    }

    /// Number of primitives, inactive ones included.
    pub fn primitive_count(&self) -> usize {
        self.content.primitive_count()
    }

    /// The vertices of a triangle in object space, as the structure has them; `None` for procedural primitives and for
    /// indices out of range (Vulkan, "Ray Tracing Position Fetch").
    pub fn triangle(&self, geometry: u32, primitive: u32) -> Option<[Vec3; 3]> {
        match &self.content {
            Content::Triangles(all) => all.get(geometry as usize)?.corners.get(primitive as usize).copied(),
            Content::Boxes(_) => None,
        }
    }
}
