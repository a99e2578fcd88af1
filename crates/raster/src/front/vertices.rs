//! Which vertices a draw names, and the vertex shader's results, reused where indices repeat.

use std::ops::Range;

use crate::{
    counters::Counters,
    stages::{Vertex, VertexInput, VertexShader},
    state::Topology,
};

/// The vertices of a draw, in order.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stream<'a> {
    /// So many from the first on.
    Range { first: u32, count: u32 },
    /// 16-bit indices and what is added to them.
    Short(&'a [u16], i32),
    /// 32-bit indices and what is added to them.
    Long(&'a [u32], i32),
}

impl Stream<'_> {
    pub fn len(&self) -> u32 {
        match self {
            Self::Range { count, .. } => *count,
            Self::Short(indices, _) => indices.len() as u32,
            Self::Long(indices, _) => indices.len() as u32,
        }
    }

    #[inline(always)]
    fn vertex(&self, place: u32) -> u32 {
        match self {
            Self::Range { first, .. } => first.wrapping_add(place),
            Self::Short(indices, base) => u32::from(indices[place as usize]).wrapping_add_signed(*base),
            Self::Long(indices, base) => indices[place as usize].wrapping_add_signed(*base),
        }
    }

    fn is_restart(&self, place: u32, restart: u32) -> bool {
        match self {
            Self::Range { .. } => false,
            // Of a 16-bit stream the index of all ones also counts as the 32-bit one of all ones.
            Self::Short(indices, _) => {
                let index = u32::from(indices[place as usize]);
                index == restart || (index == 0xffff && restart == u32::MAX)
            }
            Self::Long(indices, _) => indices[place as usize] == restart,
        }
    }
}

/// A run of vertices without restart.
#[derive(Clone, Debug)]
struct Segment {
    start: u32,
    length: u32,
    /// Primitives of the runs before.
    primitives_before: u64,
}

/// The primitives of a draw by number: runs between restarts, for each instance again.
#[derive(Clone, Debug)]
pub(crate) struct Source<'a> {
    stream: Stream<'a>,
    segments: Vec<Segment>,
    pub per_instance: u64,
    pub instances: Range<u32>,
    pub draw: u32,
    pub topology: Topology,
}

impl<'a> Source<'a> {
    pub fn new(stream: Stream<'a>, topology: Topology, restart: Option<u32>, instances: Range<u32>, draw: u32) -> Self {
        let mut segments = Vec::new();
        let mut primitives = 0;
        // A run between restarts starts a strip anew; its primitives are numbered behind those of earlier runs.
        let mut add = |range: Range<u32>| {
            let length = range.end - range.start;
            let count = topology.primitives(u64::from(length));
            if count > 0 {
                segments.push(Segment { start: range.start, length, primitives_before: primitives });
                primitives += count;
            }
        };
        // Split the stream at restart indices into runs with primitives.
        let mut start = 0;
        if let (Some(restart), false) = (restart, matches!(stream, Stream::Range { .. })) {
            for place in 0..stream.len() {
                if stream.is_restart(place, restart) {
                    add(start..place);
                    start = place + 1;
                }
            }
        }
        add(start..stream.len());
        Self { stream, segments, per_instance: primitives, instances, draw, topology }
    }

    /// Primitives of all instances.
    pub fn primitives(&self) -> u64 {
        self.per_instance * u64::from(self.instances.end.saturating_sub(self.instances.start))
    }

    /// Instance, number in the instance, start and length of the run, and number in the run of primitive `number`.
    #[inline]
    pub fn locate(&self, number: u64) -> Located {
        let instance = self.instances.start + (number / self.per_instance) as u32;
        // Find instance and run of a primitive by division and binary search.
        let in_instance = number % self.per_instance;
        let segment = if self.segments.len() == 1 {
            &self.segments[0]
        } else {
            &self.segments[self.segments.partition_point(|s| s.primitives_before <= in_instance) - 1]
        };
        Located {
            instance,
            id: in_instance as u32,
            start: segment.start,
            length: segment.length,
            in_run: (in_instance - segment.primitives_before) as u32,
        }
    }
}

/// Location of a primitive in the vertex stream.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Located {
    pub instance: u32,
    pub id: u32,
    pub start: u32,
    pub length: u32,
    pub in_run: u32,
}

/// Entries of the table of vertices that were shaded last.
const TABLE: usize = 4096;

/// Shaded vertices of a job.
pub(crate) struct Vertices<'a, V: VertexShader> {
    shader: &'a V,
    source: &'a Source<'a>,
    instance: u32,
    pub shaded: Vec<Vertex<V::Varyings>>,
    /// For each slot the vertex, and its place in `shaded`; a place that is not there is free.
    table: Vec<(u32, u32)>,
}

impl<'a, V: VertexShader> Vertices<'a, V> {
    pub fn new(shader: &'a V, source: &'a Source<'a>) -> Self {
        // Lists without indices name each vertex once.
        let reuse = !matches!(
            (source.stream, source.topology),
            (
                Stream::Range { .. },
                Topology::Points
                    | Topology::Lines
                    | Topology::Triangles
                    | Topology::LinesAdjacency
                    | Topology::TrianglesAdjacency
                    | Topology::Patches(_)
            )
        );
        let table = if reuse { vec![(0, u32::MAX); TABLE] } else { Vec::new() };
        Self { shader, source, instance: source.instances.start, shaded: Vec::new(), table }
    }

    /// Vertices of another instance are not those of the last one. What is shaded stays valid only until then.
    pub fn begin_instance(&mut self, instance: u32) {
        if instance != self.instance {
            // The table holds vertices of one instance only.
            self.instance = instance;
            self.table.fill((0, u32::MAX));
        }
    }

    /// The place in [`shaded`](Self::shaded) of the vertex at this place of the stream.
    #[inline]
    pub fn place(&mut self, place: u32, counters: &mut Counters) -> usize {
        // Direct-mapped post-transform cache: a collision shades the vertex again.
        let vertex = self.source.stream.vertex(place);
        counters.vertices += 1;
        let slot = vertex as usize % TABLE;
        if let Some((of, at)) = self.table.get(slot)
            && *of == vertex
            && *at != u32::MAX
        {
            return *at as usize;
        }
        counters.vertex_shader += 1;
        // Shade, keep the result, and enter it in the table.
        let at = self.shaded.len();
        self.shaded.push(self.shader.shade(VertexInput { vertex, instance: self.instance, draw: self.source.draw }));
        if let Some(entry) = self.table.get_mut(slot) {
            *entry = (vertex, at as u32);
        }
        at
    }
}
