//! Which vertices form which primitive (M33), by transform feedback.

use steradian_raster::{
    Draw, Fragment, Framebuffer, Pipeline, Program, State, Vertex, VertexInput, fragment,
    glam::Vec4,
    render_target::Extent,
    stages::{Emitter, GeometryInput, GeometryOutput, GeometryShader},
    state::{Provoking, Topology},
    varyings,
};

varyings! {
    struct Number {
        number: u32 => flat,
    }
}

fn target() -> Framebuffer {
    Framebuffer::with_color_and_depth(Extent::new(8, 8), steradian_raster::Format::Rgba32Float).unwrap()
}

fn vertex(input: VertexInput) -> Vertex<Number> {
    Vertex::new(Vec4::W, Number { number: input.vertex })
}

/// The numbers of the vertices of each primitive.
fn primitives(topology: Topology, restart: Option<u32>, draw: &Draw, size: usize) -> Vec<Vec<u32>> {
    let state = State { topology, restart, ..State::default() };
    let program = Program::new(vertex, fragment(|_: &Fragment<Number>| Vec4::ONE));
    let pipeline = Pipeline::new(program, state, target().layout()).unwrap();
    let numbers: Vec<u32> = pipeline.capture(draw).0.iter().map(|v| v.varyings.number).collect();
    numbers.chunks(size).map(<[u32]>::to_vec).collect()
}

#[test]
fn vertices_form_primitives() {
    use Topology::*;
    let all = |topology, n: u32, size| primitives(topology, None, &Draw::vertices(0..n), size);
    assert_eq!(all(Points, 3, 1), [[0], [1], [2]]);
    assert_eq!(all(Lines, 5, 2), [[0, 1], [2, 3]]);
    assert_eq!(all(LineStrip, 4, 2), [[0, 1], [1, 2], [2, 3]]);
    assert_eq!(all(LineLoop, 3, 2), [[0, 1], [1, 2], [2, 0]]);
    assert_eq!(all(Triangles, 8, 3), [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(all(TriangleStrip, 6, 3), [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]]);
    assert_eq!(all(TriangleFan, 5, 3), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    assert_eq!(all(LinesAdjacency, 9, 2), [[1, 2], [5, 6]]);
    assert_eq!(all(LineStripAdjacency, 5, 2), [[1, 2], [2, 3]]);
    assert_eq!(all(TrianglesAdjacency, 12, 3), [[0, 2, 4], [6, 8, 10]]);
    // OpenGL 4.6, table 10.1, with numbers from 0; odd triangles start with another corner.
    assert_eq!(all(TriangleStripAdjacency, 10, 3), [[0, 2, 4], [2, 6, 4], [4, 6, 8]]);
    assert!(all(Triangles, 2, 3).is_empty() && all(LineLoop, 1, 2).is_empty());
}

#[test]
fn restart_and_base_vertex() {
    let indices = [0, 1, 2, 3, u32::MAX, 4, 5, u32::MAX, u32::MAX, 6, 7, 8];
    let strip = primitives(Topology::TriangleStrip, Some(u32::MAX), &Draw::indexed(&indices), 3);
    assert_eq!(strip, [[0, 1, 2], [1, 3, 2], [6, 7, 8]]);
    let short: Vec<u16> = indices.iter().map(|&i| i as u16).collect();
    let strip = primitives(Topology::TriangleStrip, Some(u32::MAX), &Draw::indexed_short(&short).base_vertex(10), 3);
    assert_eq!(strip, [[10, 11, 12], [11, 13, 12], [16, 17, 18]]);
}

/// The vertices that a geometry shader is given, and which one provokes.
struct See;

impl GeometryShader for See {
    type Input = Number;
    type Output = Number;
    const OUTPUT: GeometryOutput = GeometryOutput::Points;
    const MAX_VERTICES: usize = 6;
    fn shade(&self, input: GeometryInput<Number>, out: &mut Emitter<Number>) {
        for v in input.vertices {
            out.vertex(*v);
        }
    }
}

#[test]
fn adjacency_reaches_the_geometry_shader() {
    let given = |topology, n: u32, size| {
        let state = State { topology, ..State::default() };
        let program = Program::new(vertex, fragment(|_: &Fragment<Number>| Vec4::ONE)).geometry(See);
        let pipeline = Pipeline::new(program, state, target().layout()).unwrap();
        let numbers: Vec<u32> = pipeline.capture(&Draw::vertices(0..n)).0.iter().map(|v| v.varyings.number).collect();
        numbers.chunks(size).map(<[u32]>::to_vec).collect::<Vec<_>>()
    };
    assert_eq!(given(Topology::LinesAdjacency, 4, 4), [[0, 1, 2, 3]]);
    assert_eq!(given(Topology::TrianglesAdjacency, 6, 6), [[0, 1, 2, 3, 4, 5]]);
    // Corners and the vertices across the edges that follow them. Table 10.1, odd triangle turned by one corner.
    let strip = given(Topology::TriangleStripAdjacency, 10, 6);
    assert_eq!(strip, [[0, 1, 2, 6, 4, 3], [2, 5, 6, 8, 4, 0], [4, 2, 6, 9, 8, 7]]);
    assert_eq!(given(Topology::TriangleStripAdjacency, 6, 6), [[0, 1, 2, 5, 4, 3]]);
}

/// Flat varyings come from the provoking vertex (OpenGL 4.6, table 13.2).
#[test]
fn provoking_vertices() {
    let first_of = |topology, provoking, n: u32| {
        let mut framebuffer = target();
        let corners = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0], [3.0, 3.0], [5.0, -1.0]];
        let vertex = |input: VertexInput| {
            let [x, y] = corners[input.vertex as usize];
            Vertex::new(Vec4::new(x, y, 0.5, 1.0), Number { number: input.vertex })
        };
        let shader = fragment(|f: &Fragment<Number>| Vec4::splat(f.varyings().number as f32));
        let state = State { topology, provoking, ..State::default() };
        let pipeline = Pipeline::new(Program::new(vertex, shader), state, framebuffer.layout()).unwrap();
        pipeline.draw(&mut framebuffer, &Draw::vertices(0..n)).unwrap();
        framebuffer.color(0).pixel(2, 6).unwrap().x
    };
    assert_eq!(first_of(Topology::Triangles, Provoking::First, 3), 0.0);
    assert_eq!(first_of(Topology::Triangles, Provoking::Last, 3), 2.0);
    assert_eq!(first_of(Topology::TriangleFan, Provoking::First, 3), 1.0);
    assert_eq!(first_of(Topology::TriangleFan, Provoking::Last, 3), 2.0);
    // The second triangle of the strip (1, 3, 2) does not reach that pixel.
    assert_eq!(first_of(Topology::TriangleStrip, Provoking::First, 4), 0.0);
    assert_eq!(first_of(Topology::TriangleStrip, Provoking::Last, 4), 2.0);
}
