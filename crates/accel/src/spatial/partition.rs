//! A structure over the primitives of one space.

use super::accel::Accelerator;
use super::bsp::Bsp;
#[cfg(test)]
use super::cells_tests::holders;
use super::grid::Grid;
use super::items::{Items, slack};
use super::kdtree::{KdTree, Planes};
use super::line::{Line, is_askable};
use super::octree::Octree;
use super::search::{AnySearch, NearestSearch, Tally, Visitor};
use super::wide::{Kind, Wide};
use crate::leaves::UserLeaves;
use crate::levels;
use crate::nearest::Nearest;
use crate::{Error, Geometry};
use steradian_math::{Bounds3, DVec3, Ray, Vec3};

/// Subdivision of space.
#[derive(Clone, Debug)]
enum Cells {
    Grid(Grid),
    Octree(Octree),
    KdTree(KdTree),
    Bsp(Bsp),
    Wide(Wide),
    /// Not at all: every ray tests every primitive.
    None(Vec<u32>),
}

/// Primitives sorted into cells.
#[derive(Clone, Debug)]
pub struct Partition {
    items: Items,
    cells: Cells,
}

impl Partition {
    /// Builds the structure; the tuned hierarchies, which are none of these, count as none.
    pub(super) fn build(accelerator: Accelerator, geometries: &[Geometry]) -> Result<Self, Error> {
        let items = Items::new(geometries)?;
        let cells = match accelerator {
            Accelerator::Grid => Cells::Grid(Grid::build(&items)),
            Accelerator::Octree => Cells::Octree(Octree::build(&items)),
            Accelerator::KdTree => Cells::KdTree(KdTree::build(&items, Planes::Sah, false)),
            Accelerator::KdTreeRopes => Cells::KdTree(KdTree::build(&items, Planes::Sah, true)),
            Accelerator::KdTreeMedian => Cells::KdTree(KdTree::build(&items, Planes::Median, false)),
            Accelerator::Bsp => Cells::Bsp(Bsp::build(&items)),
            Accelerator::Bvh2 => Cells::Wide(Wide::build(Kind::Two, &items, geometries)?),
            Accelerator::Bvh4 => Cells::Wide(Wide::build(Kind::Four, &items, geometries)?),
            Accelerator::Bvh16 => Cells::Wide(Wide::build(Kind::Sixteen, &items, geometries)?),
            Accelerator::BvhQuantised => Cells::Wide(Wide::build(Kind::Quantised, &items, geometries)?),
            _ => Cells::None((0..items.list.len() as u32).collect()),
        };
        Ok(Self { items, cells })
    }

    pub(super) fn items(&self) -> &Items {
        &self.items
    }

    /// The box around all primitives; empty when there are none.
    pub fn bounds(&self) -> Bounds3 {
        self.items.bounds
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.items.bytes()
            + match &self.cells {
                Cells::Grid(grid) => grid.bytes(),
                Cells::Octree(tree) => tree.bytes(),
                Cells::KdTree(tree) => tree.bytes(),
                Cells::Bsp(tree) => tree.bytes(),
                Cells::Wide(tree) => tree.bytes(),
                Cells::None(slots) => size_of_val(&slots[..]),
            }
    }

    /// Boxes at a level, with those of leaves above it; `None` where cells are no boxes.
    pub(super) fn boxes(&self, level: u32) -> Option<Vec<Bounds3>> {
        let bounds = &self.items.bounds;
        if bounds.is_empty() {
            return Some(Vec::new());
        }
        Some(match &self.cells {
            Cells::Grid(grid) => {
                let single = |[min, max]: [DVec3; 2]| Bounds3 { min: min.as_vec3(), max: max.as_vec3() };
                grid.boxes(level).into_iter().map(single).collect()
            }
            Cells::Octree(tree) => levels::boxes(tree, level),
            Cells::KdTree(tree) => levels::boxes(tree, level),
            Cells::Bsp(_) => return None,
            Cells::Wide(tree) => tree.boxes(bounds, level),
            Cells::None(_) => vec![*bounds],
        })
    }

    /// Number of the leaf that holds a point of a primitive, by the index of that over all geometries. Of a point in a
    /// plane of the BSP it is the leaf on the side towards a direction.
    pub(super) fn cell(&self, index: u32, p: Vec3, towards: Vec3) -> Option<u32> {
        let slot = self.items.list.partition_point(|item| item.index() < index) as u32;
        let slack = slack(&self.items.bounds);
        match &self.cells {
            // Slightly aside, so that all points of a face between cells are in the same one.
            Cells::Grid(grid) => Some(grid.leaf((p - slack).as_dvec3())),
            Cells::Octree(tree) => levels::leaf(tree, slot, p, slack),
            Cells::KdTree(tree) => levels::leaf(tree, slot, p, slack),
            Cells::Bsp(tree) => Some(tree.leaf(p.as_dvec3(), towards.as_dvec3())),
            Cells::Wide(tree) => tree.leaf(&self.items.bounds, slot, p),
            Cells::None(_) => Some(0),
        }
    }

    /// Shows a visitor what is along a ray.
    #[inline]
    fn walk(&self, ray: &Ray, visitor: &mut impl Visitor) {
        if let Cells::None(slots) = &self.cells {
            visitor.step();
            visitor.visit(slots);
            return;
        }
        if let Cells::Wide(tree) = &self.cells {
            tree.walk(ray, &self.items.bounds, visitor);
            return;
        }
        // Clip the ray to the padded bounds, in `f64`, before it walks the cells.
        let Some(line) = Line::new(ray, self.items.padded_bounds(), self.items.padding()) else { return };
        match &self.cells {
            Cells::Grid(grid) => grid.walk(&line, visitor),
            Cells::Octree(tree) => tree.walk(&line, visitor),
            Cells::KdTree(tree) => tree.walk(&line, visitor),
            Cells::Bsp(tree) => tree.walk(&line, visitor),
            Cells::Wide(_) | Cells::None(_) => {}
        }
    }

    /// The nearest hit in `(0, ray.t_max)`.
    pub(super) fn nearest<U: UserLeaves, T: Tally>(
        &self,
        ray: &Ray,
        users: &U,
        tally: T,
    ) -> (Option<Nearest<U::Extra>>, T) {
        if !is_askable(ray) {
            return (None, tally);
        }
        // The visitor shortens its interval with every hit; the walk stops behind it.
        let mut search = NearestSearch::new(&self.items, users, ray, tally);
        self.walk(ray, &mut search);
        (search.best, search.tally)
    }

    /// True if there is any hit in `(0, ray.t_max)`.
    pub(super) fn any<U: UserLeaves, T: Tally>(&self, ray: &Ray, users: &U, tally: T) -> (bool, T) {
        if !is_askable(ray) {
            return (false, tally);
        }
        let mut search = AnySearch::new(&self.items, users, ray, tally);
        self.walk(ray, &mut search);
        (search.found, search.tally)
    }
}

#[cfg(test)]
impl Partition {
    /// True if the leaf of a number lists a primitive, in a box with a property.
    pub(super) fn holds(&self, index: u32, cell: u32, is_in: impl Fn(Bounds3) -> bool) -> bool {
        let slot = self.items.list.partition_point(|item| item.index() < index) as u32;
        let holders = match &self.cells {
            Cells::Grid(grid) => return grid.holds(slot, cell, is_in),
            Cells::Bsp(tree) => return tree.holds(slot, cell),
            Cells::None(slots) => return cell == 0 && slots.contains(&slot),
            Cells::Octree(tree) => holders(tree, slot),
            Cells::KdTree(tree) => holders(tree, slot),
            Cells::Wide(tree) => tree.holders(&self.items.bounds, slot),
        };
        holders.into_iter().any(|(number, bounds)| number == cell && is_in(bounds))
    }
}
