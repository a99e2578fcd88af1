//! Depth, stencil, blending, logic operations, masks, culling (M38–M44).

use crate::stage::{Color, Random, draw, draw_white, fingerprint, framebuffer};
use steradian_raster::{
    ColorTarget, DepthFormat, DepthTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, State,
    Vertex, VertexInput, fragment,
    glam::{UVec4, Vec4},
    output::{DEPTH_GREATER, DualSource, FragmentOutput, WithDepth},
    state::{
        BlendEquation, BlendFactor, BlendState, ColorState, Compare, Cull, DepthBias, DepthState, FrontFace, LogicOp,
        PolygonMode, RasterState, StencilFace, StencilOp, StencilState,
    },
};

fn whole(z: f32) -> [Vec4; 3] {
    [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].map(|[x, y]| Vec4::new(x, y, z, 1.0))
}

#[test]
fn depth_functions() {
    for compare in Compare::ALL {
        for (new, old) in [(0.25, 0.5), (0.5, 0.5), (0.75, 0.5)] {
            let mut target = framebuffer(8, 1);
            target.clear_depth(old);
            let state = State { depth: Some(DepthState { compare, write: true }), ..State::default() };
            let counters = draw_white(&mut target, state, &whole(new));
            let passes = match compare {
                Compare::Never => false,
                Compare::Less => new < old,
                Compare::Equal => new == old,
                Compare::LessEqual => new <= old,
                Compare::Greater => new > old,
                Compare::NotEqual => new != old,
                Compare::GreaterEqual => new >= old,
                Compare::Always => true,
            };
            assert_eq!(counters.samples_passed, if passes { 64 } else { 0 }, "{compare:?} {new} {old}");
            assert_eq!(target.depth().unwrap().sample([4, 4], 0, 0), Some(if passes { new } else { old }));
        }
    }
}

/// All 8 × 8 × 8 operations by what happened, on both sides, with masks (M44).
#[test]
fn stencil_operations() {
    let expected = |op: StencilOp, old: u8, reference: u8| match op {
        StencilOp::Keep => old,
        StencilOp::Zero => 0,
        StencilOp::Replace => reference,
        StencilOp::IncrementClamp => {
            if old == 255 {
                255
            } else {
                old + 1
            }
        }
        StencilOp::DecrementClamp => {
            if old == 0 {
                0
            } else {
                old - 1
            }
        }
        StencilOp::IncrementWrap => {
            if old == 255 {
                0
            } else {
                old + 1
            }
        }
        StencilOp::DecrementWrap => {
            if old == 0 {
                255
            } else {
                old - 1
            }
        }
        StencilOp::Invert => 255 - old,
    };
    for (k, op) in StencilOp::ALL.into_iter().enumerate() {
        let other = StencilOp::ALL[(k + 3) % 8];
        for old in [0u8, 1, 7, 254, 255] {
            for (z, passes_stencil) in [(0.25, true), (0.75, true), (0.25, false)] {
                for back in [false, true] {
                    let mut target = framebuffer(8, 1);
                    target.clear(Vec4::ZERO, 0.5, old);
                    let face = StencilFace {
                        compare: if passes_stencil { Compare::Always } else { Compare::Never },
                        reference: 0x5a,
                        write_mask: 0x7f,
                        fail: op,
                        depth_fail: other,
                        pass: op,
                        ..StencilFace::default()
                    };
                    let unused = StencilFace {
                        pass: StencilOp::Zero,
                        fail: StencilOp::Zero,
                        depth_fail: StencilOp::Zero,
                        ..face
                    };
                    let stencil = if back {
                        StencilState { front: unused, back: face }
                    } else {
                        StencilState { front: face, back: unused }
                    };
                    let state = State { depth: Some(DepthState::LESS), stencil: Some(stencil), ..State::default() };
                    let mut corners = whole(z);
                    if back {
                        corners.swap(1, 2);
                    }
                    draw_white(&mut target, state, &corners);
                    let happened = if passes_stencil && z > 0.5 { other } else { op };
                    let new = old & 0x80 | expected(happened, old, 0x5a) & 0x7f;
                    assert_eq!(target.stencil().unwrap().sample([1, 1], 0, 0), Some(new), "{happened:?} {old}");
                }
            }
        }
    }
    // The comparison has the reference on the left and masks both.
    let mut target = framebuffer(8, 1);
    target.clear_stencil(0b1100);
    let face = StencilFace { compare: Compare::Less, reference: 0b0101, read_mask: 0b0110, ..StencilFace::default() };
    let state = State { stencil: Some(StencilState { front: face, back: face }), ..State::default() };
    // 0100 < 0100 fails; with another mask 0001 < 1000 passes.
    assert_eq!(draw_white(&mut target, state.clone(), &whole(0.5)).samples_passed, 0);
    let face = StencilFace { read_mask: 0b1011, ..face };
    let state = State { stencil: Some(StencilState { front: face, back: face }), ..state };
    assert_eq!(draw_white(&mut target, state, &whole(0.5)).samples_passed, 64);
}

/// Every pair of factors and every equation against the formula, channel by channel (M43).
#[test]
fn blending() {
    use BlendFactor::*;
    let factors = [
        Zero,
        One,
        Source,
        OneMinusSource,
        SourceAlpha,
        OneMinusSourceAlpha,
        Target,
        OneMinusTarget,
        TargetAlpha,
        OneMinusTargetAlpha,
        Constant,
        OneMinusConstant,
        ConstantAlpha,
        OneMinusConstantAlpha,
        SourceAlphaSaturate,
        Second,
        OneMinusSecond,
        SecondAlpha,
        OneMinusSecondAlpha,
    ];
    let (s, d) = ([0.5f32, 0.25, 0.75, 0.625], [0.125f32, 0.875, 0.5, 0.25]);
    let (c, s2) = ([0.375f32, 0.0625, 1.0, 0.75], [0.25f32, 0.5, 0.125, 0.875]);
    let value = |factor: BlendFactor, i: usize| match factor {
        Zero => 0.0,
        One => 1.0,
        Source => s[i],
        OneMinusSource => 1.0 - s[i],
        SourceAlpha => s[3],
        OneMinusSourceAlpha => 1.0 - s[3],
        Target => d[i],
        OneMinusTarget => 1.0 - d[i],
        TargetAlpha => d[3],
        OneMinusTargetAlpha => 1.0 - d[3],
        Constant => c[i],
        OneMinusConstant => 1.0 - c[i],
        ConstantAlpha => c[3],
        OneMinusConstantAlpha => 1.0 - c[3],
        SourceAlphaSaturate => {
            if i == 3 {
                1.0
            } else {
                s[3].min(1.0 - d[3])
            }
        }
        Second => s2[i],
        OneMinusSecond => 1.0 - s2[i],
        SecondAlpha => s2[3],
        OneMinusSecondAlpha => 1.0 - s2[3],
    };
    let equations = [
        BlendEquation::Add,
        BlendEquation::Subtract,
        BlendEquation::ReverseSubtract,
        BlendEquation::Min,
        BlendEquation::Max,
    ];
    for (k, f) in factors.into_iter().enumerate() {
        for (j, g) in factors.into_iter().enumerate() {
            let (color, alpha) = (equations[(k + j) % 5], equations[(k + 2 * j + 1) % 5]);
            let state = State {
                color: vec![ColorState::blended(BlendState {
                    color,
                    color_factors: [f, g],
                    alpha,
                    alpha_factors: [g, f],
                })],
                blend_constant: c,
                ..State::default()
            };
            let mut target = framebuffer(4, 1);
            target.clear(Vec4::from_array(d), 1.0, 0);
            let corners = whole(0.5);
            let vertex = |input: VertexInput| Vertex::new(corners[input.vertex as usize], ());
            let shader =
                fragment(|_: &Fragment<()>| DualSource { first: Vec4::from_array(s), second: Vec4::from_array(s2) });
            let pipeline = Pipeline::new(Program::new(vertex, shader), state, target.layout()).unwrap();
            pipeline.draw(&mut target, &Draw::vertices(0..3)).unwrap();
            let result = target.color(0).pixel(1, 1).unwrap().to_array();
            for i in 0..4 {
                let (equation, [f, g]) = if i == 3 { (alpha, [g, f]) } else { (color, [f, g]) };
                let expected = match equation {
                    BlendEquation::Add => s[i] * value(f, i) + d[i] * value(g, i),
                    BlendEquation::Subtract => s[i] * value(f, i) - d[i] * value(g, i),
                    BlendEquation::ReverseSubtract => d[i] * value(g, i) - s[i] * value(f, i),
                    BlendEquation::Min => s[i].min(d[i]),
                    BlendEquation::Max => s[i].max(d[i]),
                };
                assert_eq!(result[i], expected, "{equation:?} {f:?} {g:?} channel {i}");
            }
        }
    }
}

fn draw_output<O: FragmentOutput + Sync>(target: &mut Framebuffer, state: State, z: f32, output: O) -> u64 {
    let corners = whole(z);
    let vertex = |input: VertexInput| Vertex::new(corners[input.vertex as usize], ());
    let program = Program::new(vertex, fragment(move |_: &Fragment<()>| output));
    let pipeline = Pipeline::new(program, state, target.layout()).unwrap();
    pipeline.draw(target, &Draw::vertices(0..3)).unwrap().samples_passed
}

#[test]
fn logic_operations_and_masks() {
    use LogicOp::*;
    let all = [
        Clear,
        And,
        AndReverse,
        Copy,
        AndInverted,
        NoOp,
        Xor,
        Or,
        Nor,
        Equivalent,
        Invert,
        OrReverse,
        CopyInverted,
        OrInverted,
        Nand,
        Set,
    ];
    let (s, t) = (0b1100_1010u32, 0b1010_0110u32);
    // The value of each operation on (s, t) = (1, 1), (1, 0), (0, 1), (0, 0), from OpenGL 4.6, table 17.3.
    let tables = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];
    for (op, table) in all.into_iter().zip(tables) {
        let extent = Extent::new(8, 8);
        let mut target =
            Framebuffer::new(vec![ColorTarget::new(extent, Format::Rgba8Uint).unwrap()], None, None).unwrap();
        let bits = |x: u32| f32::from_bits(x);
        target.clear(Vec4::splat(bits(t)), 1.0, 0);
        let write = [true, true, false, true];
        let state = State { logic_op: Some(op), color: vec![ColorState { blend: None, write }], ..State::default() };
        draw_output(&mut target, state, 0.5, UVec4::splat(s));
        let expected = (0..8).fold(0, |sum, bit| {
            let place = 3 - (2 * (1 - (s >> bit & 1)) + (1 - (t >> bit & 1)));
            sum | (table >> place & 1) << bit
        });
        let result = target.color(0).pixel(2, 2).unwrap().to_array().map(f32::to_bits);
        assert_eq!(result, [expected, expected, t, expected], "{op:?}");
    }
}

#[test]
fn several_targets_have_their_own_state() {
    let extent = Extent::new(8, 8);
    let colors = [Format::Rgba32Float, Format::Rgba8Unorm, Format::R16Float];
    let colors = colors.map(|format| ColorTarget::new(extent, format).unwrap()).to_vec();
    let mut target = Framebuffer::new(colors, None, None).unwrap();
    target.clear(Vec4::splat(0.5), 1.0, 0);
    let state = State {
        color: vec![
            ColorState::blended(BlendState::ADD),
            ColorState { write: [false, true, false, false], ..Default::default() },
        ],
        ..State::default()
    };
    draw_output(&mut target, state, 0.5, [Vec4::ONE, Vec4::splat(0.2), Vec4::splat(7.0)]);
    assert_eq!(target.color(0).pixel(0, 0).unwrap(), Vec4::splat(1.5));
    let expected = [128.0, 51.0, 128.0, 128.0].map(|x: f32| x / 255.0);
    assert_eq!(target.color(1).pixel(0, 0).unwrap().to_array(), expected);
    assert_eq!(target.color(2).pixel(7, 7).unwrap().x, 7.0);
}

/// Depths of shaders with their layouts; what would break the layout is limited.
#[test]
fn shader_depths() {
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    let depth_after = |output: &dyn Fn(&mut Framebuffer) -> u64| {
        let mut target = framebuffer(8, 1);
        target.clear_depth(0.7);
        let passed = output(&mut target);
        (passed, target.depth().unwrap().sample([3, 3], 0, 0).unwrap())
    };
    let any = |depth: f32| WithDepth::<Vec4> { output: Vec4::ONE, depth };
    assert_eq!(depth_after(&|t| draw_output(t, state.clone(), 0.9, any(0.25))), (64, 0.25));
    assert_eq!(depth_after(&|t| draw_output(t, state.clone(), 0.5, any(0.8))), (0, 0.7));
    assert_eq!(depth_after(&|t| draw_output(t, state.clone(), 0.5, any(f32::NAN))), (0, 0.7));
    let greater = |depth: f32| WithDepth::<Vec4, DEPTH_GREATER> { output: Vec4::ONE, depth };
    assert_eq!(depth_after(&|t| draw_output(t, state.clone(), 0.5, greater(0.25))), (64, 0.5));
    assert_eq!(depth_after(&|t| draw_output(t, state.clone(), 0.5, greater(0.6))), (64, 0.6));
    assert_eq!(depth_after(&|t| draw_output(t, state.clone(), 0.5, Some(any(0.1)))), (64, 0.1));
    assert_eq!(depth_after(&|t| draw_output(t, state.clone(), 0.5, None::<Vec4>)), (0, 0.7));
}

fn opposite(front: FrontFace) -> FrontFace {
    if front == FrontFace::Clockwise { FrontFace::CounterClockwise } else { FrontFace::Clockwise }
}

/// Culling by either side, for either order of corners, in every polygon mode; a closed surface without its back looks
/// the same and takes fewer fragments (M40).
#[test]
fn culling() {
    for (cull, front_face, clockwise, drawn) in [
        (Cull::None, FrontFace::CounterClockwise, true, true),
        (Cull::Back, FrontFace::CounterClockwise, true, false),
        (Cull::Back, FrontFace::Clockwise, true, true),
        (Cull::Front, FrontFace::CounterClockwise, false, false),
        (Cull::Front, FrontFace::CounterClockwise, true, true),
        (Cull::Both, FrontFace::CounterClockwise, false, false),
    ] {
        for polygon_mode in [PolygonMode::Fill, PolygonMode::Line, PolygonMode::Point] {
            let mut corners = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5]].map(|[x, y]| Vec4::new(x, y, 0.5, 1.0));
            if clockwise {
                corners.swap(1, 2);
            }
            let state = State {
                raster: RasterState { cull, front_face, polygon_mode, ..RasterState::default() },
                ..State::default()
            };
            let counters = draw_white(&mut framebuffer(16, 1), state, &corners);
            assert_eq!(counters.fragments > 0, drawn, "{cull:?} {front_face:?} {polygon_mode:?}");
        }
    }
    // A sphere of triangles: culling its back, whichever winding is the front, leaves the picture, and half of the
    // triangles.
    let at = |i: u32, j: u32| {
        let (theta, phi) = (i as f32 * std::f32::consts::PI / 24.0, j as f32 * std::f32::consts::TAU / 48.0);
        Vec4::new(0.8 * theta.sin() * phi.cos(), 0.8 * theta.cos(), 0.5 + 0.4 * theta.sin() * phi.sin(), 1.0)
    };
    let quads = (0..24).flat_map(|i| (0..48).map(move |j| [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]));
    let ball: Vec<Vec4> = quads.flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let turned: Vec<Vec4> = ball.chunks(3).flat_map(|t| [t[0], t[2], t[1]]).collect();
    let (mut pictures, mut shares) = (Vec::new(), Vec::new());
    for (corners, front) in [(&ball, FrontFace::Clockwise), (&turned, FrontFace::CounterClockwise)] {
        for (cull, front_face) in [(Cull::None, front), (Cull::Back, front), (Cull::Front, opposite(front))] {
            let raster = RasterState { cull, front_face, ..RasterState::default() };
            let state = State { raster, depth: Some(DepthState::LESS), ..State::default() };
            let colored: Vec<_> =
                corners.iter().enumerate().map(|(k, p)| (*p, Vec4::splat((k / 3 % 97) as f32 + 1.0))).collect();
            let mut target = framebuffer(96, 1);
            let counters = draw(&mut target, state, &colored);
            pictures.push(fingerprint(target.color(0)));
            if cull != Cull::None {
                shares.push(counters.culled as f64 / (corners.len() / 3) as f64);
            }
        }
    }
    assert!(pictures.iter().all(|picture| *picture == pictures[0]));
    assert!(shares.iter().all(|share| (0.4..0.6).contains(share)), "{shares:?}");
    // A tetrahedron, each face of its own colour, counterclockwise from outside; less depth is nearer.
    let [a, b, c, d] = [[-0.7, -0.6, 0.6], [0.8, -0.5, 0.5], [0.0, 0.8, 0.7], [0.1, 0.0, 0.1]]
        .map(|[x, y, z]: [f32; 3]| Vec4::new(x, y, z, 1.0));
    let faces = [[a, b, d], [b, c, d], [c, a, d], [a, c, b]];
    let vertices: Vec<_> =
        faces.iter().enumerate().flat_map(|(k, face)| face.map(|p| (p, Vec4::splat(k as f32 + 1.0)))).collect();
    let drawn = |cull| {
        let raster = RasterState { cull, front_face: FrontFace::CounterClockwise, ..RasterState::default() };
        let mut target = framebuffer(64, 1);
        // The back comes first, so that it is shaded before anything hides it.
        let order: Vec<_> = vertices.chunks(3).rev().flatten().copied().collect();
        let counters = draw(&mut target, State { raster, depth: Some(DepthState::LESS), ..State::default() }, &order);
        (fingerprint(target.color(0)), counters)
    };
    let ((whole, all), (culled, front)) = (drawn(Cull::None), drawn(Cull::Back));
    assert_eq!(whole, culled);
    assert_eq!((all.culled, front.culled), (0, 1));
    assert!(front.fragments < all.fragments, "{} {}", front.fragments, all.fragments);
    assert!(drawn(Cull::Front).0 != whole);
}

/// Bias: constant in steps of the format, slope times the steepest change, clamped.
#[test]
fn depth_bias() {
    for (format, step) in [(DepthFormat::Unorm16, 1.0 / 65535.0), (DepthFormat::Unorm24, 1.0 / 16_777_215.0)] {
        let extent = Extent::new(16, 16);
        let biased = |depth_bias: DepthBias, slope: f32| {
            let depth = DepthTarget::new(extent, format).unwrap();
            let mut target = Framebuffer::new(Vec::new(), Some(depth), None).unwrap();
            let raster = RasterState { depth_bias, ..RasterState::default() };
            let state =
                State { raster, depth: Some(DepthState { compare: Compare::Always, write: true }), ..State::default() };
            // Not near the middle between two steps.
            let corners = whole(0.5).map(|p| p.with_z(0.4002 + slope * p.x * 8.0));
            let vertex = |input: VertexInput| Vertex::new(corners[input.vertex as usize], ());
            let program = Program::new(vertex, steradian_raster::stages::DepthOnly::<()>::new());
            let pipeline = Pipeline::new(program, state, target.layout()).unwrap();
            pipeline.draw(&mut target, &Draw::vertices(0..3)).unwrap();
            f64::from(target.depth().unwrap().sample([8, 8], 0, 0).unwrap())
        };
        let bias = |constant, slope, clamp| DepthBias { constant, slope, clamp };
        let none = biased(bias(0.0, 0.0, 0.0), 0.0);
        assert!((biased(bias(10.0, 0.0, 0.0), 0.0) - none - 10.0 * step).abs() < 0.6 * step);
        let slope = 0.01;
        let none = biased(bias(0.0, 0.0, 0.0), slope);
        assert!((biased(bias(0.0, 2.0, 0.0), slope) - none - 0.02).abs() < 2.0 * step + 1e-6);
        assert!((biased(bias(0.0, 2.0, 0.005), slope) - none - 0.005).abs() < 2.0 * step + 1e-6);
        assert!((biased(bias(0.0, -2.0, -0.005), slope) - none + 0.005).abs() < 2.0 * step + 1e-6);
    }
}

fn many(random: &mut Random, count: usize) -> Vec<(Vec4, Vec4)> {
    let mut vertices = Vec::new();
    for i in 0..count {
        let (z, size) = (random.unit(), [0.1, 0.5, 3.0][random.below(3)]);
        let middle = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        for _ in 0..3 {
            let p = middle.map(|m| m + random.between(-size, size));
            vertices.push((Vec4::new(p[0], p[1], z + random.between(-0.1, 0.1), 1.0), Vec4::splat(i as f32)));
        }
    }
    vertices
}

/// A picture with tests before the shader and with bounds of blocks is that of tests after it without them, of colours
/// and depths; with them there are blocks that nothing is shaded in, and less than half of the fragments (M39, M246).
#[test]
fn early_tests_change_no_picture() {
    let mut random = Random(39);
    for (compare, format) in [
        (Compare::Less, DepthFormat::Float32),
        (Compare::LessEqual, DepthFormat::Unorm16),
        (Compare::Greater, DepthFormat::Unorm24),
        (Compare::GreaterEqual, DepthFormat::Float32),
    ] {
        let vertices = many(&mut random, 500);
        let render = |late: bool| {
            let extent = Extent::new(150, 90);
            let color = ColorTarget::new(extent, Format::R32Float).unwrap();
            let depth = DepthTarget::new(extent, format).unwrap();
            let mut target = Framebuffer::new(vec![color], Some(depth), None).unwrap();
            target.clear(Vec4::ZERO, compare.far(), 0);
            let vertex = |input: VertexInput| {
                let (position, color) = vertices[input.vertex as usize];
                Vertex::new(position, Color { color })
            };
            let state = State { depth: Some(DepthState { compare, write: true }), ..State::default() };
            let draw = Draw::vertices(0..vertices.len() as u32);
            let counters = if late {
                // A depth that the pipeline knows nothing of, though it is the primitive's.
                let shader = fragment(|f: &Fragment<Color>| WithDepth::<Vec4> {
                    output: f.varyings().color,
                    depth: f.position().z,
                });
                Pipeline::new(Program::new(vertex, shader), state, target.layout()).unwrap().draw(&mut target, &draw)
            } else {
                let shader = fragment(|f: &Fragment<Color>| f.varyings().color);
                Pipeline::new(Program::new(vertex, shader), state, target.layout()).unwrap().draw(&mut target, &draw)
            };
            let depths: Vec<u32> = target.depth().unwrap().to_rows(0).into_iter().map(f32::to_bits).collect();
            (fingerprint(target.color(0)), depths, counters.unwrap())
        };
        let (early, late) = (render(false), render(true));
        assert!(early.0 == late.0 && early.1 == late.1, "{compare:?} {format:?}");
        assert!(early.2.fragments * 2 < late.2.fragments, "{} {}", early.2.fragments, late.2.fragments);
        assert!(
            early.2.hidden_blocks > 0 && late.2.hidden_blocks == 0 && early.2.samples_passed == late.2.samples_passed
        );
    }
}

/// Which triangle wins does not depend on the order of drawing, where depths differ (M38).
#[test]
fn order_does_not_matter_to_the_depth_test() {
    let vertices = many(&mut Random(38), 200);
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    let mut first = framebuffer(90, 1);
    draw(&mut first, state.clone(), &vertices);
    let turned: Vec<_> = vertices.chunks(3).rev().flatten().copied().collect();
    let mut second = framebuffer(90, 1);
    draw(&mut second, state, &turned);
    assert_eq!(first.depth().unwrap().to_rows(0), second.depth().unwrap().to_rows(0));
    assert_eq!(fingerprint(first.color(0)), fingerprint(second.color(0)));
}
