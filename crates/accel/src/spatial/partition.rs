//! A structure over the primitives of one space.

use super::accel::Accelerator;
use super::bsp::Bsp;
use super::grid::Grid;
use super::items::Items;
use super::kdtree::{KdTree, Planes};
use super::line::{Line, is_askable};
use super::octree::Octree;
use super::search::{AnySearch, NearestSearch, Tally, Visitor};
use super::wide::{Kind, Wide};
use crate::leaves::UserLeaves;
use crate::nearest::Nearest;
use crate::{Error, Geometry};
use steradian_math::{Bounds3, Ray};

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
