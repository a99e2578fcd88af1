//! Boxes on a floor with shadows by a shadow map: depths seen from the light, then compared; written to
//! `shadow_map.png`.

use steradian_raster::{
    ColorTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, Result, State, Vertex, VertexInput,
    fragment,
    glam::{Vec3, Vec4},
    stages::DepthOnly,
    state::{Compare, DepthBias, DepthState, RasterState},
    texture::{Filter, Lod, Sampler, Texture, TextureKind, Wrap},
    varyings,
};

varyings! {
    struct Surface {
        place: Vec3,
        normal: Vec3 => flat,
        color: Vec3 => flat,
    }
}

/// Direction to the light.
const LIGHT: Vec3 = Vec3::new(3.0 / 7.0, 6.0 / 7.0, 2.0 / 7.0);

/// Boxes: middle and half size. The first is the floor.
const BOXES: [[Vec3; 2]; 4] = [
    [Vec3::new(0.0, -0.1, 0.0), Vec3::new(3.0, 0.1, 3.0)],
    [Vec3::new(-0.8, 0.5, 0.2), Vec3::new(0.3, 0.5, 0.3)],
    [Vec3::new(0.5, 0.3, -0.6), Vec3::new(0.4, 0.3, 0.4)],
    [Vec3::new(0.7, 1.1, 0.8), Vec3::new(0.25, 0.15, 0.25)],
];

/// Place and normal of a corner of a triangle of a box.
fn corner(vertex: u32) -> (Vec3, Vec3) {
    let [middle, half] = BOXES[(vertex / 36) as usize];
    let side = (vertex % 36 / 6) as usize;
    let [s, t] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][(vertex % 6) as usize];
    let mut unit = [0.0; 3];
    unit[side / 2] = if side.is_multiple_of(2) { 1.0 } else { -1.0 };
    let normal = Vec3::from_array(unit);
    unit[(side / 2 + 1) % 3] = s;
    unit[(side / 2 + 2) % 3] = t;
    (middle + half * Vec3::from_array(unit), normal)
}

/// From space to the light's clip space: parallel, with the light's direction as depth.
fn from_light(p: Vec3) -> Vec4 {
    let right = Vec3::new(2.0, 0.0, -3.0) / 3.605_551_2;
    let up = LIGHT.cross(right);
    Vec4::new(p.dot(right) / 4.5, p.dot(up) / 4.5, 0.5 - p.dot(LIGHT) / 10.0, 1.0)
}

/// The picture.
pub fn picture() -> Result<ColorTarget> {
    let draw = Draw::vertices(0..36 * BOXES.len() as u32);
    // Depths from the light, moved away from it by their slope.
    let mut light = Framebuffer::with_depth(Extent::new(512, 512))?;
    let caster = |input: VertexInput| Vertex::new(from_light(corner(input.vertex).0), ());
    let depth_bias = DepthBias { constant: 2.0, slope: 2.0, clamp: 0.0 };
    let state = State {
        depth: Some(DepthState::LESS),
        raster: RasterState { depth_bias, ..RasterState::default() },
        ..State::default()
    };
    Pipeline::new(Program::new(caster, DepthOnly::<()>::new()), state, light.layout())?.draw(&mut light, &draw)?;
    let (_, depth, _) = light.into_parts();
    let map = match depth {
        Some(depth) => Texture::from_depths(TextureKind::D2, &depth)?,
        None => return ColorTarget::new(Extent::new(1, 1), Format::Rgba8Unorm),
    };
    // Lit where the distance to the light is at most the map's, in the mean of four texels.
    let sampler = Sampler {
        wrap: [Wrap::ClampToEdge; 3],
        levels: None,
        magnify: Filter::Linear,
        compare: Compare::LessEqual,
        ..Sampler::default()
    };
    let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(320, 240), Format::Rgba8Unorm)?;
    framebuffer.clear(Vec4::new(0.55, 0.7, 0.9, 1.0), 1.0, 0);
    let vertex = |input: VertexInput| {
        let (place, normal) = corner(input.vertex);
        let color = if input.vertex < 36 { Vec3::new(0.75, 0.7, 0.6) } else { Vec3::new(0.35, 0.5, 0.75) };
        let (x, y, z) = (place.x, 0.8 * place.y - 0.6 * place.z, 0.6 * place.y + 0.8 * place.z - 5.0);
        Vertex::new(Vec4::new(1.8 * x, 2.4 * y, (-z - 1.0) * 10.0 / 9.0, -z), Surface { place, normal, color })
    };
    let shader = fragment(|f: &Fragment<Surface>| {
        let s = f.varyings();
        let at = from_light(s.place);
        let uv = Vec4::new(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, 0.0, 0.0);
        let lit = sampler.compare(&map.view(), uv, at.z, Lod::Level(0.0));
        let light = 0.2 + 0.8 * lit * s.normal.dot(LIGHT).max(0.0);
        (s.color * light).extend(1.0)
    });
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    Pipeline::new(Program::new(vertex, shader), state, framebuffer.layout())?.draw(&mut framebuffer, &draw)?;
    Ok(framebuffer.color(0).clone())
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("shadow_map.png".as_ref(), &picture()?.to_image()?, &Default::default())?)
}
