//! Clipping before the division (M32), depth ranges (M29), viewports (M31).

use crate::stage::{Random, draw_white, framebuffer, perspective, reds};
use steradian_raster::{
    Draw, Fragment, Pipeline, Program, State, Vertex, VertexInput, fragment,
    glam::{DVec4, Vec3, Vec4},
    state::{Compare, DepthRange, DepthState, Multisample, RasterState, Rect, Viewport},
    varyings,
};

/// Area and length of the border, in pixels, of what is in the view, by cutting in f64 at the six planes.
fn exact_area(corners: [Vec4; 3], size: f64) -> (f64, f64) {
    let mut polygon: Vec<DVec4> = corners.iter().map(|c| c.as_dvec4()).collect();
    let planes: [fn(DVec4) -> f64; 7] =
        [|p| p.w - 1e-9, |p| p.w - p.x, |p| p.w + p.x, |p| p.w - p.y, |p| p.w + p.y, |p| p.z, |p| p.w - p.z];
    for plane in planes {
        let mut next = Vec::new();
        for i in 0..polygon.len() {
            let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let (da, db) = (plane(a), plane(b));
            if da >= 0.0 {
                next.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                next.push(a.lerp(b, da / (da - db)));
            }
        }
        polygon = next;
    }
    let p: Vec<_> = polygon.iter().map(|p| (p.x / p.w * size / 2.0, p.y / p.w * size / 2.0)).collect();
    let edges = || (0..p.len()).map(|i| (p[i], p[(i + 1) % p.len()]));
    let twice: f64 = edges().map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum();
    (twice.abs() / 2.0, edges().map(|(a, b)| (a.0 - b.0).hypot(a.1 - b.1)).sum())
}

fn random_point(random: &mut Random) -> Vec4 {
    let point = Vec3::new(random.between(-4.0, 4.0), random.between(-4.0, 4.0), random.between(-6.0, 3.0));
    perspective(point, 0.5, 5.0)
}

/// Areas of triangles that cross near, far, sides and the eye's plane equal the exact ones as far as samples can tell.
#[test]
fn clipping_keeps_the_area() {
    let mut random = Random(32);
    let (size, samples) = (128, 16);
    let mut sum = 0.0;
    let mut crossing = 0;
    for _ in 0..300 {
        let corners = [(); 3].map(|()| random_point(&mut random));
        let mut target = framebuffer(size, samples);
        let state = State { multisample: Multisample::samples(samples), ..State::default() };
        let counters = draw_white(&mut target, state, &corners);
        crossing += counters.clipped;
        let area = counters.samples_passed as f64 / f64::from(samples);
        let (exact, border) = exact_area(corners, f64::from(size));
        sum += area - exact;
        // 16 samples, no two in one row or column, place an edge along the axes to 1/16 pixel, others better.
        assert!((area - exact).abs() < border / 16.0 + 0.5, "{corners:?}: {area} against {exact}");
    }
    // Errors are of either sign.
    assert!(crossing > 100 && (sum / 300.0).abs() < 0.2, "{crossing} {sum}");
}

varyings! {
    struct Cut {
        distance: f32 => clip,
        value: f32,
    }
}

#[test]
fn clip_distances_cut() {
    let size = 64;
    let mut target = framebuffer(size, 1);
    // One triangle over the whole picture, cut at x = 20 pixels; the value is the column.
    let corners = [Vec4::new(-1.0, -1.0, 0.5, 1.0), Vec4::new(3.0, -1.0, 0.5, 1.0), Vec4::new(-1.0, 3.0, 0.5, 1.0)];
    let vertex = |input: VertexInput| {
        let position = corners[input.vertex as usize];
        let column = (position.x + 1.0) * 32.0;
        Vertex::new(position, Cut { distance: column - 20.0, value: column })
    };
    let program = Program::new(vertex, fragment(|f: &Fragment<Cut>| Vec4::splat(f.varyings().value)));
    let pipeline = Pipeline::new(program, State::default(), target.layout()).unwrap();
    pipeline.draw(&mut target, &Draw::vertices(0..3)).unwrap();
    for (i, red) in reds(&target).into_iter().enumerate() {
        let x = (i % 64) as f32 + 0.5;
        let expected = if x > 20.0 { x } else { 0.0 };
        assert!((red - expected).abs() < 1e-4, "{x} {red}");
    }
}

varyings! {
    struct Culled {
        distance: f32 => cull,
    }
}

#[test]
fn cull_distances_drop_whole_primitives() {
    for (distances, drawn) in [([-1.0, -2.0, -0.1], false), ([-1.0, -2.0, 0.0], true), ([f32::NAN, -1.0, -1.0], false)]
    {
        let mut target = framebuffer(16, 1);
        let corners = [Vec4::new(-1.0, -1.0, 0.5, 1.0), Vec4::new(3.0, -1.0, 0.5, 1.0), Vec4::new(-1.0, 3.0, 0.5, 1.0)];
        let vertex = |input: VertexInput| {
            let i = input.vertex as usize;
            Vertex::new(corners[i], Culled { distance: distances[i] })
        };
        let program = Program::new(vertex, fragment(|_: &Fragment<Culled>| Vec4::ONE));
        let pipeline = Pipeline::new(program, State::default(), target.layout()).unwrap();
        let counters = pipeline.draw(&mut target, &Draw::vertices(0..3)).unwrap();
        assert_eq!(counters.fragments > 0, drawn, "{distances:?}");
    }
}

/// Projections give one picture with depths 0…1, −1…1, reversed, and reversed with the far plane at infinity (M29).
#[test]
fn projections_agree() {
    let mut random = Random(29);
    let points: Vec<Vec3> = (0..60)
        .map(|_| Vec3::new(random.between(-3.0, 3.0), random.between(-3.0, 3.0), random.between(-8.0, -1.0)))
        .collect();
    let (near, far) = (0.5f32, 20.0f32);
    let depth = |kind: usize, d: f32| match kind {
        0 => far * (d - near) / (far - near),
        1 => ((far + near) * d - 2.0 * far * near) / (far - near),
        2 => near * (far - d) / (far - near),
        _ => near,
    };
    let render = |kind: usize| {
        let mut target = framebuffer(96, 1);
        let reversed = kind >= 2;
        target.clear(Vec4::ZERO, if reversed { 0.0 } else { 1.0 }, 0);
        let state = State {
            depth: Some(if reversed { DepthState::GREATER } else { DepthState::LESS }),
            raster: RasterState {
                depth_range: if kind == 1 { DepthRange::MinusOneToOne } else { DepthRange::ZeroToOne },
                ..RasterState::default()
            },
            ..State::default()
        };
        let clip = |p: Vec3| Vec4::new(p.x, p.y, depth(kind, -p.z), -p.z);
        let vertices: Vec<_> =
            points.iter().enumerate().map(|(i, p)| (clip(*p), Vec4::splat((i / 3 + 1) as f32))).collect();
        crate::stage::draw(&mut target, state, &vertices);
        reds(&target)
    };
    let first = render(0);
    assert!(first.iter().filter(|&&x| x > 0.0).count() > 1000);
    for kind in 1..4 {
        let other = render(kind);
        let differing = first.iter().zip(&other).filter(|(a, b)| a != b).count();
        // Where two triangles cross, depths that are rounded otherwise may choose the other one.
        assert!(differing <= 4, "kind {kind}: {differing} pixels");
    }
}

/// Corners of the view land on corners of the viewport, rows from the top; scissor and viewport limit what is drawn
/// (M31).
#[test]
fn viewports_and_scissors() {
    let whole = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].map(|[x, y]| Vec4::new(x, y, 0.25, 1.0));
    let mut target = framebuffer(32, 1);
    let state = State {
        viewports: vec![Viewport { x: 4.0, y: 8.0, width: 16.0, height: 10.0, near: 0.5, far: 1.0 }],
        scissors: vec![Rect { x: 0, y: 0, width: 12, height: 100 }],
        depth: Some(DepthState { compare: Compare::Always, write: true }),
        ..State::default()
    };
    draw_white(&mut target, state, &whole);
    for (i, red) in reds(&target).into_iter().enumerate() {
        let (x, y) = (i as u32 % 32, i as u32 / 32);
        let inside = (4..12).contains(&x) && (8..18).contains(&y);
        assert_eq!(red != 0.0, inside, "{x} {y}");
        let depth = target.depth().unwrap().sample([x, y], 0, 0).unwrap();
        assert_eq!(depth, if inside { 0.625 } else { 1.0 });
    }
    // Clip y up: a point near the top of the view is near the top row.
    let mut target = framebuffer(32, 1);
    let near_top = [[-1.0, 1.0], [1.0, 1.0], [0.0, 0.9]].map(|[x, y]| Vec4::new(x, y, 0.5, 1.0));
    draw_white(&mut target, State::default(), &near_top);
    let reds = reds(&target);
    assert!(reds[..32].iter().any(|&x| x > 0.0) && reds[64..].iter().all(|&x| x == 0.0));
}

/// Without depth clipping what is before the near or behind the far plane is drawn with clamped depth.
#[test]
fn depth_clamp() {
    for (z, expected) in [(-0.5, 0.0), (1.5, 1.0), (0.25, 0.25)] {
        let corners = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].map(|[x, y]| Vec4::new(x, y, z, 1.0));
        let state = |depth_clip: bool| State {
            depth: Some(DepthState { compare: Compare::Always, write: true }),
            raster: RasterState { depth_clip, ..RasterState::default() },
            ..State::default()
        };
        let mut target = framebuffer(8, 1);
        target.clear_depth(0.75);
        draw_white(&mut target, state(false), &corners);
        assert_eq!(target.depth().unwrap().sample([3, 3], 0, 0), Some(expected));
        let mut target = framebuffer(8, 1);
        let counters = draw_white(&mut target, state(true), &corners);
        assert_eq!(counters.fragments > 0, z == expected, "{z}");
    }
}
