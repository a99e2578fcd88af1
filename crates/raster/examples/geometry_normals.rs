//! A sphere with an arrow along the normal of each triangle, which a geometry shader makes; written to
//! `geometry_normals.png`.

use steradian_raster::{
    ColorTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, Result, State, Vertex, VertexInput,
    fragment,
    glam::{Vec3, Vec4},
    stages::{Emitter, GeometryInput, GeometryOutput, GeometryShader},
    state::DepthState,
    varyings,
};

varyings! {
    struct Point {
        place: Vec3,
        color: Vec3,
    }
}

/// Makes a line of each triangle.
struct Normals;

impl GeometryShader for Normals {
    type Input = Point;
    type Output = Point;
    const OUTPUT: GeometryOutput = GeometryOutput::LineStrip;
    const MAX_VERTICES: usize = 2;

    fn shade(&self, input: GeometryInput<Point>, out: &mut Emitter<Point>) {
        let [a, b, c] = [0, 1, 2].map(|i: usize| input.vertices[i].varyings.place);
        let middle = (a + b + c) / 3.0;
        let normal = (b - a).cross(c - a).normalize();
        for (along, color) in [(0.0, Vec3::new(0.9, 0.2, 0.1)), (0.25, Vec3::new(1.0, 0.9, 0.3))] {
            let place = middle + normal * along;
            out.vertex(Vertex::new(view(place), Point { place, color }));
        }
    }
}

/// From space to clip space.
fn view(p: Vec3) -> Vec4 {
    let z = p.z - 3.5;
    Vec4::new(1.8 * p.x, 2.4 * p.y, (-z - 1.0) * 10.0 / 9.0, -z)
}

/// The vertices of an octahedron, each face divided into 64 triangles, and moved to the sphere.
fn sphere() -> Vec<Vec3> {
    let mut triangles = Vec::new();
    for octant in 0..8 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let corners = [Vec3::X * sign(0), Vec3::Y * sign(1), Vec3::Z * sign(2)];
        let point = |i: u32, j: u32| {
            ((corners[0] * i as f32 + corners[1] * j as f32 + corners[2] * (8 - i - j) as f32) / 8.0).normalize()
        };
        for (i, j) in (0..8).flat_map(|i| (0..8 - i).map(move |j| (i, j))) {
            let mut add = |mut t: [Vec3; 3]| {
                if (t[1] - t[0]).cross(t[2] - t[0]).dot(t[0]) < 0.0 {
                    t.swap(1, 2);
                }
                triangles.extend(t);
            };
            add([point(i, j), point(i + 1, j), point(i, j + 1)]);
            if i + j < 7 {
                add([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
            }
        }
    }
    triangles
}

/// The picture.
pub fn picture() -> Result<ColorTarget> {
    let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(320, 240), Format::Rgba8Unorm)?;
    framebuffer.clear(Vec4::new(0.08, 0.09, 0.12, 1.0), 1.0, 0);
    let points = sphere();
    let vertex = |input: VertexInput| {
        let place = points[input.vertex as usize];
        let light = 0.15 + 0.85 * place.dot(Vec3::new(2.0, 6.0, 3.0) / 7.0).max(0.0);
        Vertex::new(view(place), Point { place, color: Vec3::new(0.3, 0.5, 0.8) * light })
    };
    let shader = || fragment(|f: &Fragment<Point>| f.varyings().color.extend(1.0));
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    let draw = Draw::vertices(0..points.len() as u32);
    let solid = Pipeline::new(Program::new(vertex, shader()), state.clone(), framebuffer.layout())?;
    solid.draw(&mut framebuffer, &draw)?;
    let normals = Pipeline::new(Program::new(vertex, shader()).geometry(Normals), state, framebuffer.layout())?;
    normals.draw(&mut framebuffer, &draw)?;
    Ok(framebuffer.color(0).clone())
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("geometry_normals.png".as_ref(), &picture()?.to_image()?, &Default::default())?)
}
