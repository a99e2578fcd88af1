//! Kinds of draws give the same fragments (M187), stages can be put together (M197, M198).

use crate::stage::{Color, Random, fingerprint, framebuffer};
use steradian_raster::{
    Draw, Fragment, Pipeline, Program, State, Vertex, VertexInput, fragment,
    glam::{Vec3, Vec4},
    stages::{Domain, Emitter, GeometryInput, GeometryOutput, GeometryShader, Levels, Spacing, Tessellation},
    state::{BlendState, ColorState, Topology},
};

fn positions(count: usize) -> Vec<Vec4> {
    let mut random = Random(187);
    (0..count).map(|_| Vec4::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), 0.5, 1.0)).collect()
}

/// Indexed, repeated, instanced and split draws of the same triangles give the same picture.
#[test]
fn draws_are_equal() {
    let points = positions(300);
    let mut random = Random(1);
    let indices: Vec<u32> = (0..9000).map(|_| random.below(300) as u32).collect();
    let color = |i: u32| Vec4::splat(i as f32 / 300.0);
    let state = State { color: vec![ColorState::blended(BlendState::ADD)], ..State::default() };
    let by_index =
        |input: VertexInput| Vertex::new(points[input.vertex as usize], Color { color: color(input.vertex) });
    let by_place = |input: VertexInput| {
        let vertex = indices[(input.instance * 900 + input.vertex) as usize];
        Vertex::new(points[vertex as usize], Color { color: color(vertex) })
    };
    let shader = || fragment(|f: &Fragment<Color>| f.varyings().color);
    let indexed = |draws: &[Draw]| {
        let mut target = framebuffer(100, 1);
        let pipeline = Pipeline::new(Program::new(by_index, shader()), state.clone(), target.layout()).unwrap();
        let counters = pipeline.draw_many(&mut target, draws).unwrap();
        (fingerprint(target.color(0)), counters)
    };
    let placed = |draw: Draw| {
        let mut target = framebuffer(100, 1);
        let pipeline = Pipeline::new(Program::new(by_place, shader()), state.clone(), target.layout()).unwrap();
        pipeline.draw(&mut target, &draw).unwrap();
        fingerprint(target.color(0))
    };
    let (first, counters) = indexed(&[Draw::indexed(&indices)]);
    // Each job of 1024 triangles shades each of the 300 vertices once: 4096 slots hold them all.
    assert_eq!((counters.vertices, counters.vertex_shader), (9000, 3 * 300));
    let short: Vec<u16> = indices.iter().map(|&i| i as u16).collect();
    assert_eq!(indexed(&[Draw::indexed_short(&short)]).0, first);
    let moved: Vec<u32> = indices.iter().map(|i| i + 17).collect();
    assert_eq!(indexed(&[Draw::indexed(&moved[..6000]).base_vertex(-17), Draw::indexed(&indices[6000..])]).0, first);
    assert_eq!(placed(Draw::vertices(0..9000)), first);
    assert_eq!(placed(Draw::vertices(0..900).instances(0..10)), first);
}

/// Bends a flat patch into a quarter of a cylinder.
struct Cylinder(f32);

impl Tessellation for Cylinder {
    type Input = Color;
    type Patch = Vec4;
    type Output = Color;
    const DOMAIN: Domain = Domain::Quads;
    const SPACING: Spacing = Spacing::Equal;
    fn control(&self, vertices: &[Vertex<Color>], patch: u32) -> (Levels, Vec4) {
        assert_eq!((vertices.len(), patch), (4, 0));
        (Levels::uniform(self.0), vertices[0].varyings.color)
    }
    fn evaluate(&self, color: &Vec4, levels: &Levels, at: Vec3) -> Vertex<Color> {
        assert_eq!(levels.inner[0], self.0);
        let angle = at.x * std::f32::consts::FRAC_PI_2;
        Vertex::new(Vec4::new(angle.cos(), at.y * angle.sin(), 0.5, 1.0), Color { color: *color })
    }
}

/// The picture of a tessellated quarter disc has its area, with an error that falls with the square of the level.
#[test]
fn tessellated_patches_have_the_area_of_their_surface() {
    let area = |level: f32| {
        let mut target = framebuffer(256, 1);
        let vertex = |_: VertexInput| Vertex::new(Vec4::W, Color { color: Vec4::ONE });
        let program =
            Program::new(vertex, fragment(|f: &Fragment<Color>| f.varyings().color)).tessellation(Cylinder(level));
        let state = State { topology: Topology::Patches(4), ..State::default() };
        let pipeline = Pipeline::new(program, state, target.layout()).unwrap();
        let counters = pipeline.draw(&mut target, &Draw::vertices(0..4)).unwrap();
        assert_eq!((counters.patches, counters.primitives), (1, 2 * (level as u64).pow(2)));
        counters.samples_passed as f64 / (128.0 * 128.0)
    };
    // A polygon with n sides in the quarter circle: n/2 · sin(π/2n).
    for level in [2.0f64, 4.0, 8.0, 16.0] {
        let exact = level / 2.0 * (std::f64::consts::FRAC_PI_2 / level).sin();
        assert!((area(level as f32) - exact).abs() < 2e-3, "{level}");
    }
    // A patch with a level of zero is dropped.
    let vertex = |_: VertexInput| Vertex::new(Vec4::W, Color { color: Vec4::ONE });
    let program = Program::new(vertex, fragment(|f: &Fragment<Color>| f.varyings().color)).tessellation(Cylinder(0.0));
    let mut target = framebuffer(8, 1);
    let state = State { topology: Topology::Patches(4), ..State::default() };
    let pipeline = Pipeline::new(program, state, target.layout()).unwrap();
    assert_eq!(pipeline.draw(&mut target, &Draw::vertices(0..4)).unwrap().primitives, 0);
}

/// A square for each point, in two invocations: left and right half.
struct Squares;

impl GeometryShader for Squares {
    type Input = Color;
    type Output = Color;
    const OUTPUT: GeometryOutput = GeometryOutput::TriangleStrip;
    const MAX_VERTICES: usize = 4;
    const INVOCATIONS: u32 = 2;
    fn shade(&self, input: GeometryInput<Color>, out: &mut Emitter<Color>) {
        let v = input.vertices[0];
        out.primitive_id = 10 * input.primitive + input.invocation;
        let half = 0.125;
        let left = input.invocation as f32 * half - half;
        for (x, y) in [(left, -half), (left + half, -half), (left, half), (left + half, half), (9.0, 9.0)] {
            out.vertex(Vertex { position: v.position + Vec4::new(x, y, 0.0, 0.0), ..v });
        }
    }
}

#[test]
fn geometry_shaders_replace_primitives() {
    let mut target = framebuffer(64, 1);
    let places = [[-0.5, -0.5], [0.5, 0.25]];
    let vertex = |input: VertexInput| {
        let [x, y] = places[input.vertex as usize];
        Vertex::new(Vec4::new(x, y, 0.5, 1.0), Color { color: Vec4::ONE })
    };
    let shader = fragment(|f: &Fragment<Color>| Vec4::splat(f.primitive_id() as f32 + 1.0));
    let state = State { topology: Topology::Points, ..State::default() };
    let pipeline = Pipeline::new(Program::new(vertex, shader).geometry(Squares), state, target.layout()).unwrap();
    let counters = pipeline.draw(&mut target, &Draw::vertices(0..2)).unwrap();
    // The fifth vertex is beyond MAX_VERTICES.
    assert_eq!((counters.geometry_shader, counters.primitives, counters.fragments), (4, 8, 2 * 64));
    // Columns 12…15 are the left half of the first point's square, 16…19 the right; rows from the top.
    for (x, y, id) in [(13, 48, 1.0), (17, 48, 2.0), (45, 24, 11.0), (50, 24, 12.0), (30, 30, 0.0)] {
        assert_eq!(target.color(0).pixel(x, y).unwrap().x, id, "{x} {y}");
    }
    let (captured, _) = pipeline.capture(&Draw::vertices(0..2));
    assert_eq!(captured.len(), 8 * 3);
}
