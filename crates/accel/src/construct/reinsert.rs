//! Optimisation of a binary tree: subtrees are taken out and put back where the areas of all boxes grow least (Bittner,
//! Hapala, Havran, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies", CGF 32(1), 2013; in batches
//! after Meister, Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF 37(2), 2018).
//!
//! The best place of every subtree is looked for in parallel; then those moves are made that gain most and do not touch
//! each other.

use super::binary::scale;
use super::explicit::{Explicit, NodeContent};
use super::split::half_area;
use rayon::prelude::*;
use steradian_math::Bounds3;

/// Most nodes that are looked at for one subtree.
const LOOKS: usize = 400;
/// Another round must gain this share of the area at least.
const WORTH: f64 = 0.002;

/// A subtree that is better elsewhere.
struct Move {
    gain: f32,
    node: u32,
    target: u32,
}

/// Optimises a tree in at most so many rounds.
pub(super) fn optimize(tree: &mut Explicit, rounds: usize) {
    let mut work = Work::new(tree);
    for _ in 0..rounds {
        let before = work.area();
        if before <= 0.0 || work.round() == 0 {
            break;
        }
        if work.area() > before * (1.0 - WORTH) {
            break;
        }
    }
}

/// The tree with what the search needs.
struct Work<'a> {
    tree: &'a mut Explicit,
    parents: Vec<u32>,
    areas: Vec<f32>,
    scale: f32,
}

impl<'a> Work<'a> {
    fn new(tree: &'a mut Explicit) -> Self {
        let scale = scale(&tree.nodes[tree.root as usize].bounds);
        let mut parents = vec![tree.root; tree.nodes.len()];
        for (i, node) in tree.nodes.iter().enumerate() {
            if let NodeContent::Children(children) = node.below {
                children.into_iter().for_each(|child| parents[child as usize] = i as u32);
            }
        }
        let areas = tree.nodes.iter().map(|node| half_area(&node.bounds, scale)).collect();
        Self { tree, parents, areas, scale }
    }

    /// The areas of all inner nodes together.
    fn area(&self) -> f64 {
        let inner =
            self.tree.nodes.iter().zip(&self.areas).filter(|(n, _)| matches!(n.below, NodeContent::Children(_)));
        inner.map(|(_, &area)| f64::from(area)).sum()
    }

    fn bounds(&self, node: u32) -> &Bounds3 {
        &self.tree.nodes[node as usize].bounds
    }

    /// The other child of a node's parent.
    fn sibling(&self, node: u32) -> u32 {
        match self.tree.nodes[self.parents[node as usize] as usize].below {
            NodeContent::Children([a, b]) => a ^ b ^ node,
            NodeContent::Refs { .. } => node,
        }
    }

    /// Looks for moves and makes them: how many.
    fn round(&mut self) -> usize {
        let nodes = 0..self.tree.nodes.len() as u32;
        // Find the best move of each subtree in parallel, and apply the most profitable ones first.
        let mut moves: Vec<Move> = nodes.into_par_iter().filter_map(|node| self.best_move(node)).collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        let mut touched = vec![false; self.tree.nodes.len()];
        let mut made = 0;
        for Move { node, target, .. } in moves {
            let parent = self.parents[node as usize];
            // A move changes the links of six nodes: skip it when an earlier one of this round has touched any of them.
            let grandparent = self.parents[parent as usize];
            let all = [node, parent, grandparent, self.sibling(node), target, self.parents[target as usize]];
            if all.iter().any(|&n| touched[n as usize]) || self.is_below(target, node) {
                continue;
            }
            all.into_iter().for_each(|n| touched[n as usize] = true);
            self.make(node, target);
            made += 1;
        }
        // Refit boxes and areas from the leaves up.
        for &node in self.tree.downwards().iter().rev() {
            if let NodeContent::Children([a, b]) = self.tree.nodes[node as usize].below {
                let bounds = self.bounds(a).union(*self.bounds(b));
                self.tree.nodes[node as usize].bounds = bounds;
                self.areas[node as usize] = half_area(&bounds, self.scale);
            }
        }
        made
    }

    /// The best other place of a subtree, if there is a better one.
    fn best_move(&self, node: u32) -> Option<Move> {
        let root = self.tree.root;
        let parent = self.parents[node as usize];
        if node == root || parent == root {
            return None;
        }
        let (bounds, area) = (*self.bounds(node), self.areas[node as usize]);
        let mut best = Move { gain: self.areas[parent as usize] * 1e-4, node, target: node };
        // What is gained when the subtree is taken out: its parent goes, and the boxes above become smaller up to the
        // highest node that both places are below.
        let mut gained = self.areas[parent as usize];
        let mut other = self.sibling(node);
        let mut shrunk = *self.bounds(other);
        let mut pivot = parent;
        let mut pending: Vec<(u32, f32)> = Vec::with_capacity(64);
        let mut looks = 0;
        loop {
            // Places below the other child, with what boxes on the way down to them grow.
            pending.push((other, 0.0));
            while let Some((target, grown)) = pending.pop() {
                looks += 1;
                // Branch and bound: the union is at least as large as the subtree, so `gained − grown − area` bounds
                // what is left.
                if gained - grown - area <= best.gain || looks > LOOKS {
                    continue;
                }
                let merged = half_area(&self.bounds(target).union(bounds), self.scale);
                let gain = gained - grown - merged;
                if gain > best.gain && self.parents[target as usize] != parent {
                    best = Move { gain, node, target };
                }
                if let NodeContent::Children(children) = self.tree.nodes[target as usize].below {
                    let grown = grown + merged - self.areas[target as usize];
                    pending.extend(children.map(|child| (child, grown)));
                }
            }
            if pivot == root || looks > LOOKS {
                break;
            }
            // Climb one level: the ancestor's box shrinks to what remains without the subtree.
            if pivot != parent {
                gained += self.areas[pivot as usize] - half_area(&shrunk, self.scale);
            }
            other = self.sibling(pivot);
            shrunk = shrunk.union(*self.bounds(other));
            pivot = self.parents[pivot as usize];
        }
        (best.target != node).then_some(best)
    }

    /// True if a node is `above` or below it.
    fn is_below(&self, mut node: u32, above: u32) -> bool {
        while node != above && node != self.tree.root {
            node = self.parents[node as usize];
        }
        node == above
    }

    /// Takes a subtree out and puts it beside the target. Its parent goes along.
    fn make(&mut self, node: u32, target: u32) {
        let parent = self.parents[node as usize];
        let (sibling, grandparent) = (self.sibling(node), self.parents[parent as usize]);
        // Unlink: the sibling takes the parent's place.
        self.replace(grandparent, parent, sibling);
        let above = self.parents[target as usize];
        // Relink: the parent becomes the node over the target and the subtree.
        self.replace(above, target, parent);
        self.tree.nodes[parent as usize].below = NodeContent::Children([target, node]);
        self.parents[target as usize] = parent;
    }

    /// Gives a node another child instead of one that it has.
    fn replace(&mut self, node: u32, child: u32, by: u32) {
        if let NodeContent::Children(children) = &mut self.tree.nodes[node as usize].below {
            children.iter_mut().filter(|c| **c == child).for_each(|c| *c = by);
        }
        self.parents[by as usize] = node;
    }
}
