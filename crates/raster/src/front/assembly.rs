//! Runs the stages of a job in order and hands the primitives to a sink.

use std::ops::Range;

use super::{
    TessellatedDomain, tessellate,
    vertices::{Located, Source, Vertices},
};
use crate::{
    counters::Counters,
    stages::{Emitter, GeometryInput, GeometryOutput, GeometryShader, Tessellation, Vertex, VertexShader},
    state::{MAX_PATCH_VERTICES, Provoking, Shape, Topology},
};

/// Takes primitives in order.
pub(crate) trait Sink<V> {
    fn point(&mut self, vertex: &Vertex<V>, id: u32);
    fn line(&mut self, ends: [&Vertex<V>; 2], provoking: usize, id: u32);
    fn triangle(&mut self, corners: [&Vertex<V>; 3], provoking: usize, id: u32);
}

/// The stages before the rasteriser.
pub(crate) struct Front<'a, V, T, G> {
    pub vertex: &'a V,
    pub tessellation: &'a T,
    pub geometry: &'a G,
    pub topology: Topology,
    pub provoking: Provoking,
}

impl<V, T, G> Front<'_, V, T, G>
where
    V: VertexShader,
    T: Tessellation<Input = V::Varyings>,
    G: GeometryShader<Input = T::Output>,
{
    /// Runs the primitives of these numbers.
    pub fn run(&self, source: &Source, numbers: Range<u64>, counters: &mut Counters, sink: &mut impl Sink<G::Output>) {
        let mut vertices = Vertices::new(self.vertex, source);
        let mut emitter = Emitter::new(if G::ACTIVE { G::MAX_VERTICES } else { 0 });
        let mut domain = TessellatedDomain::default();
        let mut evaluated = Vec::new();
        // Locate each primitive by its number, so that jobs can begin anywhere in the draw.
        for number in numbers {
            let located = source.locate(number);
            vertices.begin_instance(located.instance);
            if T::ACTIVE {
                self.patch(located, &mut vertices, counters, &mut domain, &mut evaluated);
                self.domain(&domain, &evaluated, located.id, counters, &mut emitter, sink);
            } else {
                self.primitive(located, &mut vertices, counters, &mut emitter, sink);
            }
        }
    }

    /// A primitive without tessellation.
    #[inline]
    fn primitive(
        &self,
        located: Located,
        vertices: &mut Vertices<V>,
        counters: &mut Counters,
        emitter: &mut Emitter<G::Output>,
        sink: &mut impl Sink<G::Output>,
    ) {
        let Some(shape) = self.topology.shape() else { return };
        let corners = self.topology.corners(located.in_run, located.length, self.provoking);
        // Shade the vertices of the primitive, or reuse what the table still holds.
        let mut at = [0; 6];
        for (at, place) in at.iter_mut().zip(&corners.places[..corners.count]) {
            *at = vertices.place(located.start + place, counters);
        }
        let shaded = |i: usize| T::pass(&vertices.shaded[at[i]]);
        // The geometry shader sees all corners, adjacent vertices included.
        if G::ACTIVE {
            let input: [Vertex<G::Input>; 6] = std::array::from_fn(|i| shaded(if i < corners.count { i } else { 0 }));
            return self.shade_geometry(&input[..corners.count], located.id, counters, emitter, sink);
        }
        let last = |i: usize| G::pass(&shaded(i));
        // Without a geometry shader adjacent vertices are dropped: lines keep the middle two of four, triangles every
        // second of six.
        match (shape, corners.count) {
            (Shape::Point, _) => sink.point(&last(0), located.id),
            (Shape::Line, 4) => sink.line([&last(1), &last(2)], corners.provoking - 1, located.id),
            (Shape::Line, _) => sink.line([&last(0), &last(1)], corners.provoking, located.id),
            (Shape::Triangle, 6) => sink.triangle([&last(0), &last(2), &last(4)], corners.provoking / 2, located.id),
            (Shape::Triangle, _) => sink.triangle([&last(0), &last(1), &last(2)], corners.provoking, located.id),
        }
    }

    /// Control and evaluation of a patch.
    fn patch(
        &self,
        located: Located,
        vertices: &mut Vertices<V>,
        counters: &mut Counters,
        domain: &mut TessellatedDomain,
        evaluated: &mut Vec<Vertex<G::Input>>,
    ) {
        evaluated.clear();
        domain.clear();
        let Topology::Patches(size) = self.topology else { return };
        let size = size.min(MAX_PATCH_VERTICES);
        let first = located.start + located.in_run * size;
        let mut corners = Vec::with_capacity(size as usize);
        // Gather the control points of the patch.
        for i in 0..size {
            let at = vertices.place(first + i, counters);
            corners.push(vertices.shaded[at]);
        }
        // Control gives levels, the fixed function the points of the domain, and evaluation a vertex for each of them.
        let (levels, patch) = self.tessellation.control(&corners, located.id);
        counters.patches += 1;
        tessellate(T::DOMAIN, T::SPACING, &levels, domain);
        counters.evaluation_shader += domain.points.len() as u64;
        evaluated.extend(domain.points.iter().map(|p| self.tessellation.evaluate(&patch, &levels, *p)));
    }

    fn domain(
        &self,
        domain: &TessellatedDomain,
        evaluated: &[Vertex<G::Input>],
        id: u32,
        counters: &mut Counters,
        emitter: &mut Emitter<G::Output>,
        sink: &mut impl Sink<G::Output>,
    ) {
        // Point mode draws the vertices of the domain and no connectivity.
        if T::POINT_MODE {
            for vertex in evaluated {
                if G::ACTIVE {
                    self.shade_geometry(&[*vertex], id, counters, emitter, sink);
                } else {
                    sink.point(&G::pass(vertex), id);
                }
            }
            return;
        }
        // The provoking vertex of generated primitives is their first or last.
        let end = |last: usize| if self.provoking == Provoking::First { 0 } else { last };
        for [a, b] in &domain.lines {
            let ends = [evaluated[*a as usize], evaluated[*b as usize]];
            if G::ACTIVE {
                self.shade_geometry(&ends, id, counters, emitter, sink);
            } else {
                sink.line([&G::pass(&ends[0]), &G::pass(&ends[1])], end(1), id);
            }
        }
        // Orientation follows the domain's or its mirror image.
        for corners in &domain.triangles {
            let [a, b, c] = corners.map(|i| evaluated[i as usize]);
            let corners = if T::CLOCKWISE { [a, c, b] } else { [a, b, c] };
            if G::ACTIVE {
                self.shade_geometry(&corners, id, counters, emitter, sink);
            } else {
                let [a, b, c] = corners.map(|v| G::pass(&v));
                sink.triangle([&a, &b, &c], end(2), id);
            }
        }
    }

    /// Calls the geometry shader and takes its strips apart.
    fn shade_geometry(
        &self,
        vertices: &[Vertex<G::Input>],
        id: u32,
        counters: &mut Counters,
        emitter: &mut Emitter<G::Output>,
        sink: &mut impl Sink<G::Output>,
    ) {
        // Every invocation sees the same input; its strips are taken apart at once.
        for invocation in 0..G::INVOCATIONS {
            emitter.begin(id);
            counters.geometry_shader += 1;
            self.geometry.shade(GeometryInput { vertices, primitive: id, invocation }, emitter);
            emitter.end_primitive();
            let mut start = 0;
            for &end in &emitter.ends {
                self.strip(&emitter.vertices[start..end], &emitter.ids[start..end], sink);
                start = end;
            }
        }
    }

    fn strip(&self, strip: &[Vertex<G::Output>], ids: &[u32], sink: &mut impl Sink<G::Output>) {
        let n = strip.len() as u32;
        let (topology, last) = match G::OUTPUT {
            GeometryOutput::Points => (Topology::Points, 0),
            GeometryOutput::LineStrip => (Topology::LineStrip, 1),
            GeometryOutput::TriangleStrip => (Topology::TriangleStrip, 2),
        };
        // Decompose the strip by the rules of its topology, which keep windings consistent.
        for k in 0..topology.primitives(u64::from(n)) as u32 {
            let corners = topology.corners(k, n, self.provoking);
            let v = |i: usize| &strip[corners.places[i] as usize];
            let id = ids[k as usize + if self.provoking == Provoking::First { 0 } else { last }];
            match G::OUTPUT {
                GeometryOutput::Points => sink.point(v(0), id),
                GeometryOutput::LineStrip => sink.line([v(0), v(1)], corners.provoking, id),
                GeometryOutput::TriangleStrip => sink.triangle([v(0), v(1), v(2)], corners.provoking, id),
            }
        }
    }
}
