//! State that breaks a rule is refused when the pipeline is made, with the rule.

use crate::stage::framebuffer;
use steradian_raster::{
    ColorTarget, DepthFormat, DepthTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, State,
    Vertex, VertexInput, fragment,
    glam::{UVec4, Vec4},
    output::FragmentOutput,
    state::{
        BlendEquation, BlendFactor, BlendState, ColorState, DepthState, LogicOp, Multisample, RasterState,
        StencilState, Topology, Viewport,
    },
};

fn refusal<O: FragmentOutput + Sync>(state: State, target: &Framebuffer, output: O) -> String {
    let vertex = |_: VertexInput| Vertex::new(Vec4::W, ());
    let program = Program::new(vertex, fragment(move |_: &Fragment<()>| output));
    Pipeline::new(program, state, target.layout()).err().map_or_else(String::new, |error| error.to_string())
}

#[test]
fn broken_rules_are_named() {
    let full = framebuffer(8, 1);
    let bare =
        Framebuffer::new(vec![ColorTarget::new(Extent::new(8, 8), Format::R8Uint).unwrap()], None, None).unwrap();
    let default = State::default;
    let viewport = |v: Viewport| State { viewports: vec![v], ..default() };
    let blended = |b: BlendState| State { color: vec![ColorState::blended(b)], ..default() };
    let dual = BlendState::new(BlendEquation::Add, BlendFactor::Second, BlendFactor::One);
    for (message, expected) in [
        (refusal(default(), &full, UVec4::ONE), "the fragment shader writes Uint, target 0 is Rgba32Float"),
        (refusal(default(), &full, [Vec4::ONE; 2]), "writes 2 colours, the framebuffer has 1"),
        (
            refusal(State { depth: Some(DepthState::LESS), ..default() }, &bare, UVec4::ONE),
            "depth test needs a depth target",
        ),
        (
            refusal(State { stencil: Some(StencilState::default()), ..default() }, &bare, ()),
            "stencil test needs a stencil",
        ),
        (refusal(blended(BlendState::ADD), &bare, UVec4::ONE), "R8Uint, which cannot be blended"),
        (refusal(blended(dual), &full, Vec4::ONE), "ask for a second colour"),
        (
            refusal(State { multisample: Multisample::samples(4), ..default() }, &full, Vec4::ONE),
            "4 samples in the state, 1",
        ),
        (refusal(State { topology: Topology::Patches(3), ..default() }, &full, Vec4::ONE), "patches need tessellation"),
        (refusal(State { topology: Topology::Patches(33), ..default() }, &full, Vec4::ONE), "at most 32"),
        (
            refusal(State { logic_op: Some(LogicOp::And), ..blended(BlendState::ADD) }, &full, Vec4::ONE),
            "takes the place of blending",
        ),
        (refusal(viewport(Viewport::new(0.0, 5.0)), &full, Vec4::ONE), "must have a size"),
        (refusal(viewport(Viewport::new(f32::NAN, 5.0)), &full, Vec4::ONE), "must have a size"),
        (refusal(viewport(Viewport { far: 1.5, ..Viewport::new(5.0, 5.0) }), &full, Vec4::ONE), "must be in [0, 1]"),
        (refusal(State { blend_constant: [f32::INFINITY; 4], ..default() }, &full, Vec4::ONE), "must be finite"),
        (
            refusal(
                State { raster: RasterState { line_width: 0.0, ..RasterState::default() }, ..default() },
                &full,
                Vec4::ONE,
            ),
            "line width 0",
        ),
        (
            refusal(
                State { multisample: Multisample { alpha_to_coverage: true, ..Multisample::default() }, ..default() },
                &full,
                (),
            ),
            "alpha to coverage needs",
        ),
    ] {
        assert!(message.starts_with("Pipeline::new: ") && message.contains(expected), "{message:?} lacks {expected:?}");
    }
    assert_eq!(refusal(default(), &full, Vec4::ONE), "");
}

#[test]
fn targets_must_fit() {
    let color = |extent| ColorTarget::new(extent, Format::Rgba8Unorm);
    let depth = DepthTarget::new(Extent::new(9, 8), DepthFormat::Float32).unwrap();
    let error = Framebuffer::new(vec![color(Extent::new(8, 8)).unwrap()], Some(depth), None).unwrap_err();
    assert!(error.to_string().contains("different size"));
    assert!(Framebuffer::new(Vec::new(), None, None).unwrap_err().to_string().contains("no target"));
    for extent in [Extent::new(0, 8), Extent::new(8, 20000), Extent::new(8, 8).samples(3), Extent::new(8, 8).layers(0)]
    {
        assert!(color(extent).is_err(), "{extent:?}");
    }
    assert!(color(Extent::new(16384, 16384).samples(16)).unwrap_err().to_string().contains("2³⁰"));
    assert!(ColorTarget::new(Extent::new(8, 8), Format::Depth16).is_err());
    // A pipeline does not draw to another layout.
    let mut other = framebuffer(8, 1);
    let vertex = |_: VertexInput| Vertex::new(Vec4::W, ());
    let program = Program::new(vertex, fragment(|_: &Fragment<()>| Vec4::ONE));
    let pipeline = Pipeline::new(program, State::default(), framebuffer(8, 2).layout());
    assert!(pipeline.is_err());
    let state = State { multisample: Multisample::samples(2), ..State::default() };
    let program = Program::new(vertex, fragment(|_: &Fragment<()>| Vec4::ONE));
    let pipeline = Pipeline::new(program, state, framebuffer(8, 2).layout()).unwrap();
    let error = pipeline.draw(&mut other, &Draw::vertices(0..3)).unwrap_err();
    assert!(error.to_string().starts_with("Pipeline::draw: the framebuffer has"));
}
