//! The nodes of a binary tree in depth-first order, while several threads make them.

use super::binary::{BinaryNode, Costs};
use crate::storage;

/// Nodes in pieces: what another thread has made is appended without being copied.
pub(super) struct Nodes<const WIDTH: usize> {
    pieces: Vec<Vec<BinaryNode<WIDTH>>>,
    len: usize,
}

impl<const WIDTH: usize> Nodes<WIDTH> {
    /// None.
    pub fn new() -> Self {
        Self { pieces: vec![Vec::new()], len: 0 }
    }

    /// Adds a node.
    pub fn push(&mut self, node: BinaryNode<WIDTH>) {
        if let Some(piece) = self.pieces.last_mut() {
            piece.push(node);
            self.len += 1;
        }
    }

    /// Adds a node over two subtrees, which are made by functions, by two threads if that is worth it: where the node is, for it to be
    /// finished, and the costs of both.
    pub fn join(
        &mut self,
        node: BinaryNode<WIDTH>,
        is_large: bool,
        left: impl FnOnce(&mut Self) -> Costs<WIDTH> + Send,
        right: impl FnOnce(&mut Self) -> Costs<WIDTH> + Send,
    ) -> (&mut BinaryNode<WIDTH>, [Costs<WIDTH>; 2]) {
        let first = self.len;
        self.push(node);
        let piece = self.pieces.len() - 1;
        let place = self.pieces[piece].len() - 1;
        let (second, costs) = if is_large {
            let mut of_right = Self::new();
            let (left, right) = rayon::join(|| left(self), || right(&mut of_right));
            let second = self.len;
            self.pieces.append(&mut of_right.pieces);
            self.len += of_right.len;
            (second, [left, right])
        } else {
            let left = left(self);
            (self.len, [left, right(self)])
        };
        let node = &mut self.pieces[piece][place];
        node.second = (second - first) as u32;
        (node, costs)
    }

    /// All of them.
    pub fn into_vec(self) -> Vec<BinaryNode<WIDTH>> {
        let mut all = storage::vec_with_capacity(self.len);
        self.pieces.iter().for_each(|piece| all.extend_from_slice(piece));
        all
    }
}
