//! A bicubic Bézier patch, divided more finely towards the right, with its wireframe; written to
//! `tessellated_patch.png`.

use steradian_raster::{
    ColorTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, Result, State, Vertex, VertexInput,
    fragment,
    glam::{Vec3, Vec4},
    stages::{Domain, Levels, Spacing, Tessellation},
    state::{DepthBias, DepthState, PolygonMode, RasterState, Topology},
    varyings,
};

varyings! {
    struct Point {
        place: Vec3,
        normal: Vec3,
    }
}

/// Heights of the 4 × 4 control points.
const HEIGHTS: [f32; 16] = [0.0, 0.2, 0.1, 0.0, 0.3, 2.2, -1.6, 0.2, 0.1, -1.4, 2.6, 0.3, 0.0, 0.2, 0.1, 0.4];

struct Bezier;

impl Tessellation for Bezier {
    type Input = Point;
    type Patch = [Vec3; 16];
    type Output = Point;
    const DOMAIN: Domain = Domain::Quads;
    const SPACING: Spacing = Spacing::FractionalOdd;

    fn control(&self, vertices: &[Vertex<Point>], _: u32) -> (Levels, [Vec3; 16]) {
        let points = std::array::from_fn(|i| vertices[i].varyings.place);
        // Edges u = 0, v = 0, u = 1, v = 1; inside along u and v.
        (Levels { outer: [5.0, 11.0, 21.0, 11.0], inner: [11.5, 11.5] }, points)
    }

    fn evaluate(&self, points: &[Vec3; 16], _: &Levels, at: Vec3) -> Vertex<Point> {
        let weights = |t: f32| {
            let s = 1.0 - t;
            [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
        };
        let slopes = |t: f32| {
            let s = 1.0 - t;
            [-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t]
        };
        let sum = |u: [f32; 4], v: [f32; 4]| (0..16).fold(Vec3::ZERO, |sum, i| sum + points[i] * (u[i % 4] * v[i / 4]));
        let place = sum(weights(at.x), weights(at.y));
        let normal = sum(weights(at.x), slopes(at.y)).cross(sum(slopes(at.x), weights(at.y)));
        Vertex::new(view(place), Point { place, normal })
    }
}

/// From space to clip space: seen from above at a slant.
fn view(p: Vec3) -> Vec4 {
    let (x, y, z) = (p.x, 0.8 * p.y - 0.6 * p.z, 0.6 * p.y + 0.8 * p.z - 2.7);
    Vec4::new(1.5 * x, 2.0 * (y + 0.1), (-z - 1.0) * 10.0 / 9.0, -z)
}

/// The picture.
pub fn picture() -> Result<ColorTarget> {
    let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(320, 240), Format::Rgba8Unorm)?;
    framebuffer.clear(Vec4::new(0.08, 0.09, 0.12, 1.0), 1.0, 0);
    let vertex = |input: VertexInput| {
        let i = input.vertex as usize;
        let place = Vec3::new((i % 4) as f32 / 1.5 - 1.0, 0.6 * HEIGHTS[i], 1.0 - (i / 4) as f32 / 1.5);
        Vertex::new(Vec4::W, Point { place, normal: Vec3::Y })
    };
    let draw = Draw::vertices(0..16);
    for polygon_mode in [PolygonMode::Fill, PolygonMode::Line] {
        let shader = fragment(move |f: &Fragment<Point>| {
            if polygon_mode == PolygonMode::Line {
                return Vec4::new(0.02, 0.02, 0.02, 1.0);
            }
            let light = f.varyings().normal.normalize().dot(Vec3::new(-3.0, 6.0, 2.0) / 7.0).abs();
            (Vec3::new(0.8, 0.35, 0.1) * (0.05 + 0.95 * light * light)).extend(1.0)
        });
        // The inside is moved back a little, so that lines on it are seen.
        let depth_bias = match polygon_mode {
            PolygonMode::Fill => DepthBias { constant: 1.0, slope: 1.5, clamp: 0.0 },
            _ => DepthBias::default(),
        };
        let state = State {
            topology: Topology::Patches(16),
            depth: Some(DepthState::LESS),
            raster: RasterState { polygon_mode, depth_bias, ..RasterState::default() },
            ..State::default()
        };
        let program = Program::new(vertex, shader).tessellation(Bezier);
        Pipeline::new(program, state, framebuffer.layout())?.draw(&mut framebuffer, &draw)?;
    }
    Ok(framebuffer.color(0).clone())
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("tessellated_patch.png".as_ref(), &picture()?.to_image()?, &Default::default())?)
}
