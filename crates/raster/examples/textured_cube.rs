//! A cube with a filtered texture and four samples per pixel, written to `textured_cube.png`.

use steradian_raster::{
    ColorTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, Result, State, Vertex, VertexInput,
    fragment,
    glam::{Mat3, Vec2, Vec3, Vec4},
    state::{Cull, DepthState, Multisample, RasterState},
    texture::{Lod, Sampler, Texture},
    varyings,
};

varyings! {
    struct Surface {
        uv: Vec2,
        normal: Vec3 => flat,
    }
}

/// The sides: right, up and outward axis.
const SIDES: [[Vec3; 3]; 6] = [
    [Vec3::NEG_Z, Vec3::Y, Vec3::X],
    [Vec3::Z, Vec3::Y, Vec3::NEG_X],
    [Vec3::X, Vec3::NEG_Z, Vec3::Y],
    [Vec3::X, Vec3::Z, Vec3::NEG_Y],
    [Vec3::X, Vec3::Y, Vec3::Z],
    [Vec3::NEG_X, Vec3::Y, Vec3::NEG_Z],
];

/// A board of 8 × 8 fields with all its levels.
fn board() -> Result<Texture> {
    let color = |i: u32| {
        let (x, y) = (i % 64 / 8, i / 64 / 8);
        if (x + y).is_multiple_of(2) { Vec4::new(0.95, 0.85, 0.6, 1.0) } else { Vec4::new(0.25, 0.1, 0.05, 1.0) }
    };
    let colors: Vec<Vec4> = (0..64 * 64).map(color).collect();
    Texture::from_colors(Format::Rgba8Unorm, 64, 64, &colors, true)
}

/// The picture.
pub fn picture() -> Result<ColorTarget> {
    let extent = Extent::new(320, 240).samples(4);
    let mut framebuffer = Framebuffer::with_color_and_depth(extent, Format::Rgba8Unorm)?;
    framebuffer.clear(Vec4::new(0.6, 0.75, 0.9, 1.0), 1.0, 0);
    // Turned about y, then about x, by angles with sines 3/5 and 5/13.
    let turn_y = Mat3::from_cols(Vec3::new(0.8, 0.0, -0.6), Vec3::Y, Vec3::new(0.6, 0.0, 0.8));
    let turn_x = Mat3::from_cols(Vec3::X, Vec3::new(0.0, 12.0, 5.0) / 13.0, Vec3::new(0.0, -5.0, 12.0) / 13.0);
    let turn = turn_x * turn_y;
    let vertex = move |input: VertexInput| {
        let [right, up, out] = SIDES[(input.vertex / 6) as usize];
        let corner =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]][(input.vertex % 6) as usize];
        let uv = Vec2::from_array(corner);
        let p = turn * (right * (2.0 * uv.x - 1.0) + up * (2.0 * uv.y - 1.0) + out) - 4.5 * Vec3::Z;
        // A perspective projection with depths from 0 at distance 1 to 1 at 10.
        let position = Vec4::new(1.8 * p.x, 2.4 * p.y, (-p.z - 1.0) * 10.0 / 9.0, -p.z);
        Vertex::new(position, Surface { uv, normal: turn * out })
    };
    let texture = board()?;
    let sampler = Sampler { anisotropy: 8, ..Sampler::default() };
    let shader = fragment(|f: &Fragment<Surface>| {
        let s = f.varyings();
        let lod = Lod::Gradients(f.dx(|s| s.uv).extend(0.0), f.dy(|s| s.uv).extend(0.0));
        let color = sampler.sample(&texture.view(), s.uv.extend(0.0).extend(0.0), lod);
        let light = 0.25 + 0.75 * s.normal.dot(Vec3::new(2.0, 3.0, 6.0) / 7.0).max(0.0);
        (color.truncate() * light).extend(1.0)
    });
    let state = State {
        depth: Some(DepthState::LESS),
        raster: RasterState { cull: Cull::Back, ..RasterState::default() },
        multisample: Multisample::samples(4),
        ..State::default()
    };
    let pipeline = Pipeline::new(Program::new(vertex, shader), state, framebuffer.layout())?;
    pipeline.draw(&mut framebuffer, &Draw::vertices(0..36))?;
    Ok(framebuffer.color(0).resolve())
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("textured_cube.png".as_ref(), &picture()?.to_image()?, &Default::default())?)
}
