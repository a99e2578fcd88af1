//! The nodes of a binary tree in depth-first order, while several threads make them.

use super::binary::{BinaryNode, Costs};

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

    /// Adds a node over two subtrees, which are made by functions, by two threads if that is worth it: where the node
    /// is, for it to be finished, and the costs of both.
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
        // Build the right subtree into pieces of its own while another thread builds the left one, then append them.
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

    /// The whole tree.
    pub fn finish(self) -> BinaryTree<WIDTH> {
        let mut starts = Vec::with_capacity(self.pieces.len());
        let mut len = 0;
        for piece in &self.pieces {
            starts.push(len);
            len += piece.len();
        }
        BinaryTree { pieces: self.pieces, starts }
    }
}

/// A binary tree, as it was made: in pieces, none of which ends within a subtree that one thread has made.
pub(super) struct BinaryTree<const WIDTH: usize> {
    pieces: Vec<Vec<BinaryNode<WIDTH>>>,
    /// The index of the first node of each piece.
    starts: Vec<usize>,
}

impl<const WIDTH: usize> BinaryTree<WIDTH> {
    /// The root, unless the tree is empty.
    pub fn root(&self) -> Option<&BinaryNode<WIDTH>> {
        self.pieces.first().and_then(|piece| piece.first())
    }

    /// The node with an index.
    pub fn node(&self, index: usize) -> &BinaryNode<WIDTH> {
        &self.from(index)[0]
    }

    /// The nodes from one on, at least as many as are below it where one thread has made them.
    pub fn from(&self, index: usize) -> &[BinaryNode<WIDTH>] {
        let piece = self.starts.partition_point(|&start| start <= index) - 1;
        &self.pieces[piece][index - self.starts[piece]..]
    }

    /// All nodes in one piece.
    pub fn into_vec(self) -> Vec<BinaryNode<WIDTH>> {
        self.pieces.concat()
    }
}
