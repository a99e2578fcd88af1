//! Triangles along a curve through space, of which those that are taken drop out.

use glam::DVec3;

/// Cells along an axis are 2 to this power; three axes fit 64 bits.
const BITS: u32 = 16;

/// A list in two directions, in Morton order of centroids.
pub(super) struct SpatialOrder {
    /// The place of each triangle along the curve.
    pub rank: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
    first: u32,
}

const NONE: u32 = u32::MAX;

impl SpatialOrder {
    pub fn new(centroids: &[DVec3]) -> Self {
        let least = centroids.iter().fold(DVec3::INFINITY, |a, &c| a.min(c));
        let largest = centroids.iter().fold(DVec3::NEG_INFINITY, |a, &c| a.max(c));
        // Quantise with one scale for all axes, so that cells are cubes.
        let size = (largest - least).max_element();
        let scale = if size > 0.0 { f64::from((1 << BITS) - 1) / size } else { 0.0 };
        let mut order: Vec<u32> = (0..centroids.len() as u32).collect();
        let keys: Vec<u64> = centroids.iter().map(|&c| morton((c - least) * scale)).collect();
        order.sort_unstable_by_key(|&t| (keys[t as usize], t));
        let mut list = Self {
            rank: vec![0; order.len()],
            next: vec![NONE; order.len()],
            previous: vec![NONE; order.len()],
            first: order.first().copied().unwrap_or(NONE),
        };
        // The rank along the curve breaks ties between candidates.
        for (rank, &t) in order.iter().enumerate() {
            list.rank[t as usize] = rank as u32;
        }
        // Doubly linked in curve order: taking a triangle out leaves its neighbours adjacent.
        for pair in order.windows(2) {
            list.next[pair[0] as usize] = pair[1];
            list.previous[pair[1] as usize] = pair[0];
        }
        list
    }

    /// The first of those that are left.
    pub fn first(&self) -> Option<u32> {
        (self.first != NONE).then_some(self.first)
    }

    /// Takes a triangle out, and gives those that were beside it.
    pub fn remove(&mut self, triangle: u32) -> [Option<u32>; 2] {
        let (previous, next) = (self.previous[triangle as usize], self.next[triangle as usize]);
        match self.next.get_mut(previous as usize) {
            Some(of_previous) => *of_previous = next,
            None => self.first = next,
        }
        if let Some(of_next) = self.previous.get_mut(next as usize) {
            *of_next = previous;
        }
        [previous, next].map(|t| (t != NONE).then_some(t))
    }
}

fn morton(cell: DVec3) -> u64 {
    let [x, y, z] = cell.to_array().map(|c| c as u64);
    (0..BITS).fold(0, |key, bit| {
        let at = |c: u64, axis: u32| (c >> bit & 1) << (3 * bit + axis);
        key | at(x, 0) | at(y, 1) | at(z, 2)
    })
}
