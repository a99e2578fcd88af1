//! Which planes divide space: those of a few of the polygons, and those through the middle across each axis.

use super::polygon::{Fragment, Side};
use super::{Bsp, Child, DEPTH, FRAGMENTS_PER_ITEM, Node, Plane};
use crate::spatial::budget::Budget;
use crate::spatial::items::Items;
use crate::spatial::lists::Lists;
use steradian_math::DVec3;

/// Leaves with no more fragments are not divided.
const LEAF: usize = 6;
/// Planes of polygons that are tried at a node.
const TRIED: usize = 4;
/// Fragments that a plane is judged by.
const JUDGES: usize = 64;

/// Divides space around primitives.
pub(super) fn partition(items: &Items) -> Bsp {
    let fragments = (0..items.list.len() as u32).map(|slot| Fragment::new(items, slot)).collect();
    let builder = Builder { nodes: Vec::new(), lists: Lists::default(), padding: items.padding() };
    builder.build(fragments, Budget::new(items.list.len(), FRAGMENTS_PER_ITEM), DEPTH)
}

struct Builder {
    nodes: Vec<Node>,
    lists: Lists,
    padding: f64,
}

/// A part of space that is to be divided, and who holds it: a node and a side.
struct Pending {
    holder: Option<(usize, usize)>,
    fragments: Vec<Fragment>,
    budget: Budget,
    depth: u32,
}

impl Builder {
    fn build(mut self, fragments: Vec<Fragment>, budget: Budget, depth: u32) -> Bsp {
        let mut root = Child::List(0);
        // Divide depth-first with an explicit stack: trees of polygons may be deep.
        let mut pending = vec![Pending { holder: None, fragments, budget, depth }];
        while let Some(Pending { holder, fragments, budget, depth }) = pending.pop() {
            let child = match self.divide(fragments, budget, depth) {
                Err(fragments) => Child::List(self.list(fragments)),
                // Primitives in the plane are stored at the node itself, between its half-spaces.
                Ok((plane, coplanar, sides, budget)) => {
                    let coplanar = self.list(coplanar);
                    self.nodes.push(Node { plane, coplanar, children: [Child::List(coplanar); 2] });
                    let node = self.nodes.len() - 1;
                    // The sides share the budget in proportion to their fragments.
                    let below = sides[0].len() + sides[1].len();
                    for (side, fragments) in sides.into_iter().enumerate() {
                        let budget = budget.share(fragments.len(), below);
                        pending.push(Pending { holder: Some((node, side)), fragments, budget, depth: depth - 1 });
                    }
                    Child::Node(node as u32)
                }
            };
            match holder {
                None => root = child,
                Some((node, side)) => self.nodes[node].children[side] = child,
            }
        }
        Bsp { root, nodes: self.nodes, lists: self.lists, padding: self.padding }
    }

    /// A list of the slots of fragments.
    fn list(&mut self, fragments: Vec<Fragment>) -> u32 {
        let mut slots: Vec<u32> = fragments.iter().map(|f| f.slot).collect();
        slots.sort_unstable();
        slots.dedup();
        self.lists.push(&slots)
    }

    /// Plane, what lies in it, what behind and in front, and the budget that remains; or the fragments again.
    #[expect(clippy::type_complexity, reason = "used once")]
    fn divide(
        &self,
        fragments: Vec<Fragment>,
        budget: Budget,
        depth: u32,
    ) -> Result<(Plane, Vec<Fragment>, [Vec<Fragment>; 2], Budget), Vec<Fragment>> {
        if depth == 0 || fragments.len() <= LEAF {
            return Err(fragments);
        }
        // Choose a plane, classify every fragment, and split those on both sides.
        let Some(plane) = self.choose(&fragments) else { return Err(fragments) };
        let sides: Vec<Side> = fragments.iter().map(|f| f.side(&plane, self.tolerance())).collect();
        let count = |side: Side| sides.iter().filter(|s| **s == side).count();
        let (behind, front, both) = (count(Side::Behind), count(Side::Front), count(Side::Both));
        let n = fragments.len();
        // Each side must have less than all.
        if behind + both == n || front + both == n {
            return Err(fragments);
        }
        let Some(budget) = budget.spend(n, n + both) else { return Err(fragments) };
        let mut coplanar = Vec::new();
        let (mut back, mut ahead) = (Vec::with_capacity(behind + both), Vec::with_capacity(front + both));
        for (fragment, side) in fragments.into_iter().zip(sides) {
            match side {
                Side::On => coplanar.push(fragment),
                Side::Behind => back.push(fragment),
                Side::Front => ahead.push(fragment),
                Side::Both => {
                    let [a, b] = fragment.split(&plane, self.tolerance());
                    back.push(a);
                    ahead.push(b);
                }
            }
        }
        Ok((plane, coplanar, [back, ahead], budget))
    }

    /// Distance from a plane within which a point counts as in it.
    fn tolerance(&self) -> f64 {
        self.padding * 0.25
    }

    /// The plane that balances best for the polygons it splits.
    fn choose(&self, fragments: &[Fragment]) -> Option<Plane> {
        let n = fragments.len();
        // Evenly spread, without pattern: multiples of a number that has no factor in common with most.
        let sample = |i: usize, of: usize| (i * n / of + i * 7) % n;
        // Candidates: planes of a few polygons, and medians across the axes for scenes whose polygons separate badly.
        let polygons = (0..TRIED.min(n)).filter_map(|i| fragments[sample(i, TRIED.min(n))].plane());
        let axes = DVec3::AXES.into_iter().filter_map(|normal| {
            // The median of one vertex of each polygon stands for the median of the polygons.
            let mut middles: Vec<f64> = fragments.iter().map(|f| normal.dot(f.points[0])).collect();
            let (_, offset, _) = middles.select_nth_unstable_by(n / 2, f64::total_cmp);
            offset.is_finite().then_some(Plane { normal, offset: *offset })
        });
        let judges = JUDGES.min(n);
        let cost = |plane: &Plane| {
            let (mut behind, mut front, mut both) = (0_i64, 0_i64, 0_i64);
            for i in 0..judges {
                match fragments[sample(i, judges)].side(plane, self.tolerance()) {
                    Side::On => {}
                    Side::Behind => behind += 1,
                    Side::Front => front += 1,
                    Side::Both => both += 1,
                }
            }
            // Nothing is worse than a plane with everything on one side and nothing in it.
            let is_useless = behind + both == judges as i64 || front + both == judges as i64;
            // Score a plane by its imbalance and, four times as heavily, by the fragments that it splits.
            (is_useless, (behind - front).abs() + 4 * both)
        };
        polygons.chain(axes).map(|plane| (cost(&plane), plane)).min_by_key(|(cost, _)| *cost).map(|(_, plane)| plane)
    }
}
