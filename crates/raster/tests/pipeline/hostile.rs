//! Any input, and the same bits for any number of threads.

use crate::stage::{Color, Random, fingerprint, framebuffer};
use steradian_raster::{
    Counters, Draw, Fragment, Framebuffer, Pipeline, Program, State, Vertex, VertexInput, fragment,
    glam::Vec4,
    state::{
        BlendState, ColorState, Conservative, Cull, DepthState, LineMode, Multisample, PolygonMode, RasterState,
        StencilFace, StencilOp, StencilState, Topology,
    },
};

/// A coordinate of any kind.
fn coordinate(random: &mut Random) -> f32 {
    match random.below(20) {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => f32::NEG_INFINITY,
        3 => 0.0,
        4 => f32::MAX,
        5 => f32::MIN_POSITIVE,
        6 => -f32::MIN_POSITIVE,
        7 => f32::from_bits(random.bits() as u32),
        // ±10⁶ pixels of a picture of 128.
        8 => random.between(-15_000.0, 15_000.0),
        9 => random.between(-1e-6, 1e-6),
        10 => 1e30,
        _ => random.between(-2.0, 2.0),
    }
}

/// Slivers, tiny and huge triangles, w near 0 and negative, bits at random.
fn triangles(count: usize, seed: u64) -> Vec<Vec4> {
    let mut random = Random(seed);
    let mut vertices = Vec::with_capacity(3 * count);
    for _ in 0..count {
        let wild = random.below(3) == 0;
        let first = Vec4::new(random.between(-1.5, 1.5), random.between(-1.5, 1.5), random.between(-0.2, 1.2), 1.0);
        for corner in 0..3 {
            vertices.push(if wild {
                Vec4::from_array([(); 4].map(|()| coordinate(&mut random)))
            } else {
                let size = [1e-3, 0.05, 2.0][random.below(3)];
                let w = if random.below(8) == 0 { random.between(-1e-3, 1e-3) } else { random.between(0.2, 2.0) };
                let moved = first + Vec4::new(random.between(-size, size), random.between(-size, size), 0.0, 0.0);
                if corner == 2 && random.below(4) == 0 { vertices[vertices.len() - 1] } else { moved.with_w(w) }
            });
        }
    }
    vertices
}

fn draw(target: &mut Framebuffer, state: State, vertices: &[Vec4]) -> Counters {
    let vertex = |input: VertexInput| {
        let position = vertices[input.vertex as usize];
        let value = (input.vertex % 17) as f32 / 17.0;
        Vertex {
            point_size: value * 9.0,
            ..Vertex::new(position, Color { color: Vec4::new(value, 1.0 - value, 0.5, 0.5) })
        }
    };
    let program = Program::new(vertex, fragment(|f: &Fragment<Color>| f.varyings().color));
    let pipeline = Pipeline::new(program, state, target.layout()).unwrap();
    pipeline.draw(target, &Draw::vertices(0..vertices.len() as u32)).unwrap()
}

fn state_of(kind: usize) -> State {
    let count = |face: StencilOp| StencilFace { pass: face, depth_fail: StencilOp::Invert, ..StencilFace::default() };
    let mut state = State {
        depth: Some(DepthState::LESS),
        stencil: Some(StencilState { front: count(StencilOp::IncrementWrap), back: count(StencilOp::DecrementWrap) }),
        color: vec![ColorState::blended(BlendState::OVER)],
        ..State::default()
    };
    match kind {
        1 => state.multisample = Multisample { alpha_to_coverage: true, ..Multisample::samples(4) },
        2 => state.raster = RasterState { polygon_mode: PolygonMode::Line, cull: Cull::Back, ..state.raster },
        3 => state.raster = RasterState { polygon_mode: PolygonMode::Point, depth_clip: false, ..state.raster },
        4 => {
            state.topology = Topology::Lines;
            state.raster = RasterState { line_mode: LineMode::Smooth, line_width: 3.0, ..state.raster };
        }
        5 => state.raster = RasterState { conservative: Conservative::Overestimate, ..state.raster },
        6 => state.topology = Topology::Points,
        7 => (state.topology, state.stencil) = (Topology::TriangleStrip, None),
        _ => {}
    }
    state
}

/// A million hostile triangles neither panic (with overflow checks on) nor leave anything but finite colours in the
/// picture.
#[test]
fn a_million_triangles_of_any_kind() {
    let vertices = triangles(1 << 17, 5);
    let mut drawn = 0;
    for kind in 0..8 {
        let state = state_of(kind);
        let mut target = framebuffer(128, state.multisample.count);
        let counters = draw(&mut target, state, &vertices);
        drawn += counters.samples_passed;
        assert!(counters.not_finite > 0 && counters.samples_passed > 0, "kind {kind}: {counters:?}");
        for y in 0..128 {
            for x in 0..128 {
                let color = target.color(0).pixel(x, y).unwrap();
                assert!(color.is_finite(), "kind {kind}: {x} {y} {color}");
                let depth = target.depth().unwrap().sample([x, y], 0, 0).unwrap();
                assert!((0.0..=1.0).contains(&depth));
            }
        }
    }
    assert!(drawn > 50_000, "{drawn}");
}

/// Colours, depths, stencil and counters are the same for 1, 2, 3 and 4 threads (M47).
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let vertices = triangles(20_000, 7);
    for kind in 0..8 {
        let results = [1, 2, 3, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let state = state_of(kind);
                let mut target = framebuffer(100, state.multisample.count);
                let counters = draw(&mut target, state, &vertices);
                let depths: Vec<u32> = target.depth().unwrap().to_rows(0).into_iter().map(f32::to_bits).collect();
                let stencil: Vec<_> = (0..100).map(|i| target.stencil().unwrap().sample([i, i], 0, 0)).collect();
                (fingerprint(target.color(0)), depths, stencil, counters)
            })
        });
        assert!(results.iter().all(|r| *r == results[0]), "kind {kind}");
    }
}

/// Sizes that are no multiple of blocks or tiles; a vertex range and indices at the end of their type.
#[test]
fn odd_sizes_and_numbers() {
    let corners = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].map(|[x, y]| Vec4::new(x, y, 0.5, 1.0));
    for size in [1, 2, 7, 8, 9, 63, 64, 65, 129] {
        let mut target = framebuffer(size, 1);
        let counters = draw(&mut target, State::default(), &corners);
        assert_eq!(counters.samples_passed, u64::from(size * size));
    }
    let mut target = framebuffer(8, 1);
    let vertex = |input: VertexInput| Vertex::new(corners[(input.vertex % 3) as usize], Color { color: Vec4::ONE });
    let program = Program::new(vertex, fragment(|f: &Fragment<Color>| f.varyings().color));
    let pipeline = Pipeline::new(program, State::default(), target.layout()).unwrap();
    for draw in [
        Draw::vertices(u32::MAX - 3..u32::MAX),
        Draw::indexed(&[u32::MAX, 0, 1]),
        Draw::indexed(&[5, 6, 7]).base_vertex(i32::MIN),
        Draw::indexed_short(&[0xffff, 0, 1]).base_vertex(-9),
        Draw::vertices(0..0),
        Draw::vertices(0..2),
        Draw::indexed(&[]),
        Draw::vertices(0..3).instances(5..5),
        Draw::vertices(0..3).instances(u32::MAX - 1..u32::MAX),
    ] {
        pipeline.draw(&mut target, &draw).unwrap();
    }
}
