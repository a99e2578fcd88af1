//! Transform feedback: the vertices that would reach the rasteriser.

use super::Sink;
use crate::stages::Vertex;

/// Collects the vertices of primitives, strips taken apart.
#[derive(Debug)]
pub(crate) struct Capture<V> {
    pub vertices: Vec<Vertex<V>>,
    pub primitives: u64,
}

impl<V> Default for Capture<V> {
    fn default() -> Self {
        Self { vertices: Vec::new(), primitives: 0 }
    }
}

impl<V: Copy> Capture<V> {
    fn add<const N: usize>(&mut self, vertices: [&Vertex<V>; N]) {
        self.vertices.extend(vertices.map(|v| *v));
        self.primitives += 1;
    }
}

impl<V: Copy> Sink<V> for Capture<V> {
    fn point(&mut self, vertex: &Vertex<V>, _: u32) {
        self.add([vertex]);
    }
    fn line(&mut self, ends: [&Vertex<V>; 2], _: usize, _: u32) {
        self.add(ends);
    }
    fn triangle(&mut self, corners: [&Vertex<V>; 3], _: usize, _: u32) {
        self.add(corners);
    }
}
