//! A triangle with shaders of its own, written to `triangle.png`.

use steradian_raster::{
    ColorTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, Result, State, Vertex, VertexInput,
    fragment,
    glam::{Vec3, Vec4},
    varyings,
};

varyings! {
    struct Shaded {
        color: Vec3,
    }
}

/// The picture.
pub fn picture() -> Result<ColorTarget> {
    let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(320, 240), Format::Rgba8Unorm)?;
    framebuffer.clear(Vec4::new(0.1, 0.1, 0.12, 1.0), 1.0, 0);
    let corners = [Vec3::new(-0.8, -0.7, 0.5), Vec3::new(0.8, -0.7, 0.5), Vec3::new(0.0, 0.8, 0.5)];
    let vertex = |input: VertexInput| {
        let corner = input.vertex as usize;
        Vertex::new(corners[corner].extend(1.0), Shaded { color: [Vec3::X, Vec3::Y, Vec3::Z][corner] })
    };
    let shader = fragment(|f: &Fragment<Shaded>| f.varyings().color.extend(1.0));
    let pipeline = Pipeline::new(Program::new(vertex, shader), State::default(), framebuffer.layout())?;
    pipeline.draw(&mut framebuffer, &Draw::vertices(0..3))?;
    Ok(framebuffer.color(0).clone())
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("triangle.png".as_ref(), &picture()?.to_image()?, &Default::default())?)
}
