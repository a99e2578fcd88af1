//! The primitives of all geometries under one index, and references to them that the builder sorts.

use crate::layout::{Block, ChildRef};
use crate::storage;
use crate::triangle::is_hittable;
use crate::{Error, Geometry, Shape};
use glam::{Vec3A, Vec4};
use rayon::prelude::*;
use steradian_math::{Bounds3, Vec3};

/// Fewest primitives that are worth a task of their own.
const PIECE: usize = 1 << 10;

/// A primitive while it is sorted: its box and its index, in half a cache line.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(super) struct PrimRef {
    /// The least corner. The bits of the last coordinate are the index over all geometries with [`PrimRef::NORMAL`],
    /// and [`PrimRef::USER`] for user primitives.
    low: Vec4,
    /// The greatest corner, and nothing.
    high: Vec4,
}

/// Primitive of a reference, without its box: all that is needed of references once they are sorted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tag(u32);

impl Tag {
    /// Index over all geometries.
    pub fn index(self) -> u32 {
        self.0 & (PrimRef::NORMAL - 1)
    }

    /// True for a user primitive.
    pub fn is_user(self) -> bool {
        self.0 & PrimRef::USER != 0
    }
}

/// A box in two registers, whose fourth coordinates mean nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub min: Vec3A,
    pub max: Vec3A,
}

impl Span {
    /// A box without a point.
    pub const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    /// The box of a point.
    #[inline(always)]
    pub fn at(point: Vec3A) -> Self {
        Self { min: point, max: point }
    }

    /// The box around both.
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box as others see it.
    pub fn bounds(self) -> Bounds3 {
        Bounds3 { min: self.min.into(), max: self.max.into() }
    }
}

impl PrimRef {
    const USER: u32 = 1 << 31;
    /// Makes a common number of the index: arithmetic in all four lanes is slow where one of them is subnormal.
    const NORMAL: u32 = 1 << 30;

    fn new(bounds: Bounds3, index: u32, user: bool) -> Self {
        let tag = index | Self::NORMAL | if user { Self::USER } else { 0 };
        Self { low: bounds.min.extend(f32::from_bits(tag)), high: bounds.max.extend(0.0) }
    }

    /// A part of the primitive, within other bounds.
    pub fn part(&self, bounds: Bounds3) -> Self {
        Self { low: bounds.min.extend(self.low.w), high: bounds.max.extend(0.0) }
    }

    /// Primitive that the reference stands for.
    pub fn tag(&self) -> Tag {
        Tag(self.low.w.to_bits())
    }

    /// Index over all geometries.
    pub fn index(&self) -> u32 {
        self.tag().index()
    }

    /// True for a user primitive.
    pub fn is_user(&self) -> bool {
        self.tag().is_user()
    }

    /// The middle of the box, without overflow.
    #[inline]
    pub fn center(&self) -> Vec3A {
        Vec3A::from_vec4(self.low * 0.5 + self.high * 0.5)
    }

    /// Both corners in registers; the last lanes mean nothing.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn lanes(&self) -> [std::arch::x86_64::__m128; 2] {
        [self.low.into(), self.high.into()]
    }

    /// A coordinate of the middle.
    #[inline]
    pub fn center_on(&self, axis: usize) -> f32 {
        self.low[axis] * 0.5 + self.high[axis] * 0.5
    }

    /// The least corner.
    #[inline]
    pub fn min(&self) -> Vec3 {
        self.low.truncate()
    }

    /// The greatest corner.
    #[inline]
    pub fn max(&self) -> Vec3 {
        self.high.truncate()
    }

    /// The box.
    #[inline]
    pub fn bounds(&self) -> Bounds3 {
        Bounds3 { min: self.min(), max: self.max() }
    }

    /// The box in registers.
    #[inline]
    pub fn span(&self) -> Span {
        Span { min: Vec3A::from_vec4(self.low), max: Vec3A::from_vec4(self.high) }
    }
}

/// All geometries, with one index over all their primitives.
pub(crate) struct Primitives<'a> {
    geometries: &'a [Geometry<'a>],
    /// For each geometry the index of its first primitive, and at the end the number of all.
    pub first: Vec<u32>,
}

impl<'a> Primitives<'a> {
    /// Counts the primitives.
    pub fn new(geometries: &'a [Geometry<'a>]) -> Result<Self, Error> {
        let limit = u64::from(ChildRef::LIMIT);
        let count = geometries.iter().map(|g| g.len() as u64).sum();
        if count >= limit {
            return Err(Error::TooManyPrimitives { count, limit });
        }
        let mut first = vec![0];
        for geometry in geometries {
            first.push(first[first.len() - 1] + geometry.len() as u32);
        }
        Ok(Self { geometries, first })
    }

    /// References to all primitives that a ray can hit, in the order of their indices.
    pub(super) fn refs(&self) -> Vec<PrimRef> {
        let mut refs = storage::vec_with_capacity(self.first[self.geometries.len()] as usize);
        // Make references in parallel, then drop those of primitives that no ray can hit.
        for (geometry, &first) in self.geometries.iter().zip(&self.first) {
            let reference = |prim: usize| {
                let (bounds, user) = usable(geometry, prim)?;
                Some(PrimRef::new(bounds, first + prim as u32, user))
            };
            let unusable = PrimRef::new(Bounds3::EMPTY, 0, false);
            let all = (0..geometry.len()).into_par_iter().with_min_len(PIECE);
            let start = refs.len();
            refs.par_extend(all.map(|prim| reference(prim).unwrap_or(unusable)));
            if refs[start..].par_iter().with_min_len(PIECE).any(|r| r.bounds().is_empty()) {
                refs.retain(|r| !r.bounds().is_empty());
            }
        }
        refs
    }

    /// Number of primitives that a ray can hit.
    pub fn count(&self) -> usize {
        let of_geometry = |geometry: &'a Geometry<'a>| {
            (0..geometry.len()).into_par_iter().filter(move |&prim| usable(geometry, prim).is_some())
        };
        self.geometries.par_iter().flat_map(of_geometry).count()
    }

    /// The box of the primitive with an index, if a ray can hit it.
    pub fn bounds(&self, index: u32) -> Option<Bounds3> {
        let geom = self.geometry(index);
        usable(&self.geometries[geom], (index - self.first[geom]) as usize).map(|(bounds, _)| bounds)
    }

    /// Which geometry the primitive with an index belongs to.
    #[inline]
    fn geometry(&self, index: u32) -> usize {
        if index < self.first[1] { 0 } else { self.first.partition_point(|&first| first <= index) - 1 }
    }

    /// The vertices of the triangle with an index, and what goes into [`Block::ids`]; `None` for what is not a
    /// triangle.
    pub fn triangle(&self, index: u32) -> Option<([Vec3; 3], u32)> {
        self.indices(index).and_then(Indices::corners)
    }

    /// Location of the vertices of the triangle with an index; `None` for other primitives. Looking up several of these
    /// first is faster than following each at once.
    #[inline]
    pub(super) fn indices(&self, index: u32) -> Option<Indices<'a>> {
        let geom = self.geometry(index);
        let geometry = self.geometries[geom];
        let Shape::Triangles { positions, indices } = geometry.shape else { return None };
        let id = index | if geometry.filtered { Block::FILTERED } else { 0 };
        Some(Indices { positions, indices: indices[(index - self.first[geom]) as usize], id })
    }
}

/// The vertices of a triangle by their indices.
#[derive(Clone, Copy)]
pub(super) struct Indices<'a> {
    positions: &'a [Vec3],
    indices: [u32; 3],
    id: u32,
}

impl Indices<'_> {
    /// See [`Primitives::triangle`].
    #[inline]
    pub fn corners(self) -> Option<([Vec3; 3], u32)> {
        Some((corners(self.positions, self.indices)?, self.id))
    }
}

/// The box of a primitive that a ray can hit, and whether it is a user primitive.
fn usable(geometry: &Geometry, prim: usize) -> Option<(Bounds3, bool)> {
    let (bounds, user) = match geometry.shape {
        Shape::Triangles { positions, indices } => {
            let corners = corners(positions, indices[prim]).filter(|corners| is_hittable(*corners))?;
            (Bounds3::from_points(corners), false)
        }
        Shape::Boxes(boxes) => (boxes[prim], true),
    };
    let usable = bounds.min.is_finite() && bounds.max.is_finite() && !bounds.is_empty();
    usable.then_some((bounds, user))
}

/// The vertices of a triangle, if they exist.
fn corners(positions: &[Vec3], indices: [u32; 3]) -> Option<[Vec3; 3]> {
    let [a, b, c] = indices.map(|i| positions.get(i as usize).copied());
    Some([a?, b?, c?])
}
