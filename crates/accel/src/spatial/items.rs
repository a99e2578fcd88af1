//! The primitives of one space as the structures of this module hold them.

use crate::triangle::is_hittable;
use crate::{Error, Geometry, PrimId, Shape};
use steradian_math::{Bounds3, DVec3, Vec3};

/// A primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// The vertices of a triangle. For user primitives the corners of the box, and the first one again.
    pub corners: [Vec3; 3],
    /// Index over all geometries, and flags.
    tag: u32,
}

impl Item {
    const USER: u32 = 1 << 31;
    const FILTERED: u32 = 1 << 30;

    /// Index over all geometries.
    #[inline]
    pub fn index(&self) -> u32 {
        self.tag & (Self::FILTERED - 1)
    }

    /// True for a user primitive.
    #[inline]
    pub fn is_user(&self) -> bool {
        self.tag & Self::USER != 0
    }

    /// True if its hits must be accepted.
    #[inline]
    pub fn is_filtered(&self) -> bool {
        self.tag & Self::FILTERED != 0
    }

    /// Its box.
    #[inline]
    pub fn bounds(&self) -> Bounds3 {
        Bounds3::from_points(self.corners)
    }
}

/// The primitives that a ray can hit, in the order of their indices. Their numbers in this order are called *slots*.
#[derive(Clone, Debug)]
pub(super) struct Items {
    pub list: Vec<Item>,
    pub bounds: Bounds3,
    /// For each geometry the index of its first primitive over all geometries, and at the end the number of primitives.
    pub first: Vec<u32>,
}

impl Items {
    /// Copies what can be hit of the geometries.
    pub fn new(geometries: &[Geometry]) -> Result<Self, Error> {
        let limit = u64::from(Item::FILTERED);
        let count = geometries.iter().map(|g| g.len() as u64).sum();
        if count >= limit {
            return Err(Error::TooManyPrimitives { count, limit });
        }
        let mut items = Self { list: Vec::new(), bounds: Bounds3::EMPTY, first: vec![0] };
        for geometry in geometries {
            let first = items.first[items.first.len() - 1];
            for prim in 0..geometry.len() {
                // Copy primitives and skip what no ray can hit: degenerate triangles, empty boxes, vertices out of
                // range.
                let flag = if geometry.filtered { Item::FILTERED } else { 0 };
                let item = match geometry.shape {
                    Shape::Triangles { positions, indices } => {
                        let [a, b, c] = indices[prim].map(|i| positions.get(i as usize).copied());
                        let (Some(a), Some(b), Some(c)) = (a, b, c) else { continue };
                        if !is_hittable([a, b, c]) {
                            continue;
                        }
                        Item { corners: [a, b, c], tag: (first + prim as u32) | flag }
                    }
                    Shape::Boxes(boxes) => {
                        let Bounds3 { min, max } = boxes[prim];
                        if boxes[prim].is_empty() || !min.is_finite() || !max.is_finite() {
                            continue;
                        }
                        Item { corners: [min, max, min], tag: (first + prim as u32) | Item::USER }
                    }
                };
                items.bounds = items.bounds.union(item.bounds());
                items.list.push(item);
            }
            items.first.push(first + geometry.len() as u32);
        }
        items.list.shrink_to_fit();
        Ok(items)
    }

    /// The name of the primitive with an index over all geometries, in the instance with a number.
    pub fn id(&self, instance: u32, index: u32) -> PrimId {
        let geom = self.first.partition_point(|&first| first <= index) - 1;
        PrimId { instance, geom: geom as u32, prim: index - self.first[geom] }
    }

    /// Padding of primitives when the structures sort them into cells: a lower bound on the distance at which a ray may
    /// pass a primitive and yet be listed with it. See [`super::line::Line`].
    pub fn padding(&self) -> f64 {
        if self.list.is_empty() {
            return 0.0;
        }
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        let rounding = min.abs().max(max.abs()).max_element() * super::line::ROUNDING;
        // Never nothing, so that no cell is flat.
        (max - min).max_element() * PADDING + rounding + f64::from(f32::MIN_POSITIVE)
    }

    /// The box around everything with the padding, in `f64`.
    pub fn padded_bounds(&self) -> [DVec3; 2] {
        let padding = self.padding();
        [self.bounds.min.as_dvec3() - padding, self.bounds.max.as_dvec3() + padding]
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.list[..]) + size_of_val(&self.first[..])
    }
}

/// Padding in units of the greatest extent: enough for rays that begin up to sixteen extents away.
const PADDING: f64 = 1.0 / 65_536.0;

/// Half of the distance by which the structures of this module pad primitives within bounds: no rounding of a point
/// takes it farther from its leaf, and all points of a face that two leaves share are in the same one.
pub(super) fn slack(bounds: &Bounds3) -> f32 {
    let greatest = bounds.min.abs().max(bounds.max.abs()).max_element();
    0.5 * (bounds.diagonal().max_element() * PADDING as f32 + greatest * super::line::ROUNDING as f32)
}
