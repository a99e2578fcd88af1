//! Projections of the mathematics crate through the graphics pipeline.

use steradian::math::hash::HashRng;
use steradian::{
    math::geometry::projection::{Depth, View},
    raster::pipeline::{
        ColorTarget, DepthFormat, DepthTarget, Draw, Extent, Format, Framebuffer, Pipeline, Program, State, Vertex,
        VertexInput, fragment,
        glam::{UVec4, Vec3, Vec4},
        state::{Compare, DepthRange, DepthState},
    },
};

/// Numbers of the triangles that pixels see, by rows.
fn numbers(corners: &[Vec3], view: View, depth: Depth, is_central: bool) -> Vec<u8> {
    let matrix = if is_central { view.perspective(depth) } else { view.orthographic(depth) }.expect("a projection");
    let matrix = matrix.as_mat4();
    let extent = Extent::new(120, 80);
    let colors = vec![ColorTarget::new(extent, Format::R32Uint).unwrap()];
    let depths = DepthTarget::new(extent, DepthFormat::Float32).unwrap();
    let mut target = Framebuffer::new(colors, Some(depths), None).unwrap();
    // What lies nearer wins; the far plane is what is there at first.
    let (compare, far) = if depth == Depth::Reversed { (Compare::Greater, 0.0) } else { (Compare::Less, 1.0) };
    target.clear(Vec4::ZERO, far, 0);
    let mut state = State { depth: Some(DepthState { compare, write: true }), ..State::default() };
    let is_gl = depth == Depth::MinusOneToOne;
    state.raster.depth_range = if is_gl { DepthRange::MinusOneToOne } else { DepthRange::ZeroToOne };
    let vertex = |v: VertexInput| Vertex::new(matrix * corners[v.vertex as usize].extend(1.0), ());
    let shader = fragment(|f: &steradian::raster::pipeline::Fragment<()>| UVec4::splat(f.primitive_id() + 1));
    let pipeline = Pipeline::new(Program::new(vertex, shader), state, target.layout()).unwrap();
    pipeline.draw(&mut target, &Draw::vertices(0..corners.len() as u32)).unwrap();
    target.color(0).to_bytes(0).to_vec()
}

/// M29: the ranges of depth −1 … 1, 0 … 1 and 1 … 0, with a finite and an infinite far plane, draw the same pixels of
/// triangles that pierce each other.
#[test]
fn all_ranges_of_depth_draw_the_same_pixels() {
    let mut rng = HashRng::new(29);
    let mut point =
        || Vec3::from_array([2.0, 1.5, 4.0].map(|size| size * (2.0 * rng.next_f32() - 1.0))) - 6.0 * Vec3::Z;
    let corners: Vec<Vec3> = (0..60).map(|_| point()).collect();
    let window = [-0.75, 0.75, -0.5, 0.5];
    for is_central in [true, false] {
        let window = if is_central { window } else { window.map(|v| 4.0 * v) };
        let view = |far| View::new(window, 1.0, far).expect("a view");
        let right = numbers(&corners, view(50.0), Depth::MinusOneToOne, is_central);
        let seen: std::collections::BTreeSet<_> = right.chunks(4).map(|n| n[0]).collect();
        assert!(seen.len() > 12, "{} triangles are seen", seen.len());
        for depth in [Depth::ZeroToOne, Depth::Reversed] {
            assert_eq!(numbers(&corners, view(50.0), depth, is_central), right, "{depth:?}");
        }
        if is_central {
            for depth in [Depth::MinusOneToOne, Depth::ZeroToOne, Depth::Reversed] {
                assert_eq!(numbers(&corners, view(f64::INFINITY), depth, true), right, "{depth:?}, infinite");
            }
        }
    }
}
