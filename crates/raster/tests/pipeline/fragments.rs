//! Quads and their derivatives (M200), built-in inputs (M199), interpolation modes.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::stage::{at_pixel, framebuffer};
use steradian_raster::{
    ColorTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, State, Vertex, VertexInput, fragment,
    fragment::Quad,
    glam::{Vec2, Vec4},
    output::WithMask,
    stages::FragmentShader,
    state::{Multisample, Topology},
    varyings,
};

varyings! {
    struct Plane {
        place: Vec2 => linear,
        squared: f32,
    }
}

/// Derivatives of linear functions are exact to rounding, with helpers outside the triangle; coarse ones are one value
/// for a quad.
#[test]
fn derivatives() {
    let size = 32;
    let mut target = framebuffer(size, 1);
    let corners = [[3.25, 2.125], [29.75, 9.25], [8.5, 30.5]];
    let vertex = |input: VertexInput| {
        let [x, y] = corners[input.vertex as usize];
        Vertex::new(at_pixel(x, y, size), Plane { place: Vec2::new(x, y), squared: x })
    };
    let (helpers, coarse_equal) = (AtomicU32::new(0), AtomicU32::new(0));
    let shader = fragment(|f: &Fragment<Plane>| {
        helpers.fetch_add(u32::from(f.is_helper()), Ordering::Relaxed);
        let by_x = f.dx(|v| 2.0 * v.place.x - 3.0 * v.place.y);
        let by_y = f.dy(|v| 2.0 * v.place.x - 3.0 * v.place.y);
        let [x, y] = f.pixel();
        // The square of the column: the difference within the quad, x² − (x − 1)² at its two columns.
        let square = f.dx(|v| v.squared * v.squared);
        let even = (x & !1) as f32 + 0.5;
        assert!((square - ((even + 1.0).powi(2) - even * even)).abs() < 1e-2, "{square} {even}");
        let mixed = |v: &Plane| v.place.x * v.place.y;
        let coarse = (f.dx_coarse(mixed), f.dy_coarse(mixed));
        let row = (y & !1) as f32 + 0.5;
        coarse_equal
            .fetch_add(u32::from((coarse.0 - row).abs() < 1e-2 && (coarse.1 - even).abs() < 1e-2), Ordering::Relaxed);
        Vec4::new(by_x, by_y, f.width(|v| v.place.x), 1.0)
    });
    let pipeline = Pipeline::new(Program::new(vertex, shader), State::default(), target.layout()).unwrap();
    let counters = pipeline.draw(&mut target, &Draw::vertices(0..3)).unwrap();
    assert!(counters.fragments > 200);
    for (x, y) in (0..size).flat_map(|x| (0..size).map(move |y| (x, y))) {
        let [by_x, by_y, width, drawn] = target.color(0).pixel(x, y).unwrap().to_array();
        if drawn != 0.0 {
            assert!((by_x - 2.0).abs() < 1e-4 && (by_y + 3.0).abs() < 1e-4 && (width - 1.0).abs() < 1e-4);
        }
    }
    let (helpers, coarse_equal) = (helpers.into_inner(), coarse_equal.into_inner());
    assert!(helpers > 0 && u64::from(coarse_equal) == counters.fragments + u64::from(helpers));
}

varyings! {
    struct Modes {
        centroid: Vec2 => linear_centroid,
        centre: Vec2 => linear,
        flat: u32 => flat,
    }
}

/// At the centroid of the covered samples attributes stay within the triangle; at the centre they may not.
#[test]
fn centroids_stay_inside() {
    let size = 32;
    let mut target = framebuffer(size, 8);
    let corners = [[3.3, 2.1], [29.7, 9.2], [8.4, 30.6]];
    let weights = [Vec2::ZERO, Vec2::X, Vec2::Y];
    let vertex = |input: VertexInput| {
        let [x, y] = corners[input.vertex as usize];
        let weight = weights[input.vertex as usize];
        Vertex::new(at_pixel(x, y, size), Modes { centroid: weight, centre: weight, flat: input.vertex + 7 })
    };
    let outside = AtomicU32::new(0);
    let shader = fragment(|f: &Fragment<Modes>| {
        let v = f.varyings();
        let inside = |w: Vec2| w.min_element() >= -1e-5 && w.x + w.y <= 1.0 + 1e-5;
        if !f.is_helper() {
            assert!(inside(v.centroid), "{}", v.centroid);
            assert_eq!(v.flat, 7);
            outside.fetch_add(u32::from(!inside(v.centre)), Ordering::Relaxed);
        }
        Vec4::ONE
    });
    let state = State { multisample: Multisample::samples(8), ..State::default() };
    let pipeline = Pipeline::new(Program::new(vertex, shader), state, target.layout()).unwrap();
    pipeline.draw(&mut target, &Draw::vertices(0..3)).unwrap();
    assert!(outside.into_inner() > 5);
}

varyings! {
    struct AtSamples {
        place: Vec2 => linear_sample,
    }
}

/// A varying that asks for samples makes the shader run at each; masks of shaders count.
#[test]
fn shading_at_samples() {
    let size = 8;
    let mut target = framebuffer(size, 4);
    let corners = [[-9.0, -9.0], [40.0, -9.0], [-9.0, 40.0]];
    let vertex = |input: VertexInput| {
        let [x, y] = corners[input.vertex as usize];
        Vertex::new(at_pixel(x, y, size), AtSamples { place: Vec2::new(x, y) })
    };
    let shader = fragment(|f: &Fragment<AtSamples>| {
        let output = f.varyings().place.extend(f.quad.sample as f32).extend(1.0);
        WithMask { output, mask: if f.pixel()[0] < 4 { 0b1011 } else { !0 } }
    });
    let state = State { multisample: Multisample::samples(4), ..State::default() };
    let pipeline = Pipeline::new(Program::new(vertex, shader), state, target.layout()).unwrap();
    let counters = pipeline.draw(&mut target, &Draw::vertices(0..3)).unwrap();
    assert_eq!((counters.fragments, counters.samples_passed), (256, 32 * 3 + 32 * 4));
    for (x, y, s) in (0..8).flat_map(|x| (0..8).flat_map(move |y| (0..4).map(move |s| (x, y, s)))) {
        let color = target.color(0).sample([x, y], 0, s).unwrap();
        let [dx, dy] = steradian_raster::sample_position(4, s);
        if x < 4 && s == 2 {
            assert_eq!(color, Vec4::ZERO);
        } else {
            let expected = Vec4::new(x as f32 + dx, y as f32 + dy, s as f32, 1.0);
            assert!((color - expected).abs().max_element() < 1e-4, "{color} {expected}");
        }
    }
}

/// Layers and viewports are chosen by the provoking vertex; those that are not there draw nothing. Primitive ids and
/// sides arrive.
#[test]
fn layers_and_identities() {
    let extent = Extent::new(16, 16).layers(3);
    let mut target =
        Framebuffer::new(vec![ColorTarget::new(extent, Format::Rgba32Float).unwrap()], None, None).unwrap();
    let vertex = |input: VertexInput| {
        let [x, y] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]]
            [(if input.instance == 1 { 5 - input.vertex } else { input.vertex } % 3) as usize];
        Vertex { layer: input.vertex / 3, ..Vertex::new(Vec4::new(x, y, 0.5, 1.0), ()) }
    };
    let shader = fragment(|f: &Fragment<()>| {
        Vec4::new(f.primitive_id() as f32, f.quad.layer as f32, f32::from(u8::from(f.front_facing())), 1.0)
    });
    let pipeline = Pipeline::new(Program::new(vertex, shader), State::default(), target.layout()).unwrap();
    let counters = pipeline.draw(&mut target, &Draw::vertices(0..12)).unwrap();
    assert_eq!((counters.fragments, counters.outside), (3 * 256, 1));
    for layer in 0..3 {
        let color = target.color(0).sample([5, 6], layer, 0).unwrap();
        assert_eq!(color, Vec4::new(layer as f32, layer as f32, 1.0, 1.0));
    }
}

/// A shader in four lanes takes the place of the one for a pixel.
struct InLanes;

impl FragmentShader for InLanes {
    type Varyings = ();
    type Output = Vec4;
    fn shade(&self, _: &Fragment<()>) -> Vec4 {
        Vec4::ZERO
    }
    fn shade_quad(&self, quad: &Quad<()>) -> [Vec4; 4] {
        std::array::from_fn(|lane| Vec4::splat((quad.origin[0] * 4 + lane as u32) as f32))
    }
}

#[test]
fn shaders_may_work_on_quads() {
    let mut target = framebuffer(8, 1);
    let vertex = |_: VertexInput| Vertex { point_size: 40.0, ..Vertex::new(Vec4::new(0.0, 0.0, 0.5, 1.0), ()) };
    let state = State { topology: Topology::Points, ..State::default() };
    let pipeline = Pipeline::new(Program::new(vertex, InLanes), state, target.layout()).unwrap();
    pipeline.draw(&mut target, &Draw::vertices(0..1)).unwrap();
    for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x, y))) {
        let lane = x % 2 + 2 * (y % 2);
        assert_eq!(target.color(0).pixel(x, y).unwrap().x, ((x & !1) * 4 + lane) as f32);
    }
}
