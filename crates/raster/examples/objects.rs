//! A ring of lit, textured cubes, one draw of twelve instances, through the objects of a context: buffers, a vertex
//! array, a uniform block, a texture from pixels, queries. Written to `objects.png`.

use steradian_raster::{
    glam::{Mat3, Vec2, Vec3, Vec4},
    objects::*,
    state::DepthState,
    texture::{Filter, Lod, TextureKind, TextureSize},
    *,
};

varyings! { struct Surface { uv: Vec2, normal: Vec3, } }
block! { struct Light { direction: Vec3, ambient: f32, } }

fn bytes(floats: impl IntoIterator<Item = f32>) -> Vec<u8> {
    floats.into_iter().flat_map(f32::to_le_bytes).collect()
}

/// Vertices of a cube, 24 of position, normal and texture coordinates, and 36 indices.
fn cube() -> (Vec<u8>, Vec<u8>) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    for side in 0..6u16 {
        let (axis, out) = (usize::from(side / 2), if side % 2 == 0 { 1.0 } else { -1.0 });
        let [u, v, w] = [(axis + 1) % 3, (axis + 2) % 3, axis].map(|i| Vec3::AXES[i]);
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0f32]] {
            let corner = (w + u * (2.0 * x - 1.0)) * out + v * (2.0 * y - 1.0);
            vertices.extend(corner.to_array().into_iter().chain((w * out).to_array()).chain([x, y]));
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|i| i + 4 * side));
    }
    (bytes(vertices), indices.into_iter().flat_map(u16::to_le_bytes).collect())
}

/// Binds a vertex array: positions, normals and texture coordinates by vertex, the place by instance.
fn bind_vertices(c: &mut Context) -> Result<()> {
    let (array, names, (vertices, indices)) = (c.create_vertex_arrays(1)?[0], c.create_buffers(3)?, cube());
    c.buffer_storage(names[0], Contents::Bytes(&vertices), BufferFlags::NONE)?;
    c.buffer_data(names[1], Contents::Bytes(&indices), Usage::StaticDraw)?;
    // Places are twelve points of a circle, of Pythagorean triples. They are written through a mapping.
    let circle = [[5.0, 0.0], [4.0, 3.0], [3.0, 4.0f32]].into_iter().flat_map(|[x, y]| [x, y, -y, x, -x, -y, y, -x]);
    c.buffer_storage(names[2], Contents::Size(12 * 8), BufferFlags::MAP_WRITE)?;
    c.map_buffer_range(names[2], 0, 12 * 8, BufferFlags::MAP_WRITE)?.write(0, &bytes(circle))?;
    c.unmap_buffer(names[2])?;
    for (binding, stride) in [(0, 32), (2, 8)] {
        c.vertex_array_vertex_buffer(array, binding, VertexBuffer { buffer: names[binding], offset: 0, stride })?;
    }
    c.vertex_array_binding_divisor(array, 2, 1)?;
    c.vertex_array_element_buffer(array, names[1])?;
    let (three, two) = (Components::Three, Components::Two);
    for (number, binding, count, offset) in [(0, 0, three, 0), (1, 0, three, 12), (2, 0, two, 24), (3, 2, two, 0)] {
        c.vertex_array_attrib_format(array, number, AttributeFormat::floats(count), offset)?;
        c.vertex_array_attrib_binding(array, number, binding)?;
        c.enable_vertex_array_attrib(array, number)?;
    }
    // The names are free again; the vertex array keeps the buffers.
    c.delete_buffers(&names);
    c.bind_vertex_array(array)
}

/// Binds a board of 8 × 8 fields to unit 0, with its levels, from pixels in a buffer.
fn bind_texture(c: &mut Context) -> Result<()> {
    let (texture, pixels) = (c.create_textures(TextureKind::D2, 1)?[0], c.create_buffers(1)?[0]);
    let board: [_; 64] = std::array::from_fn(|i| if (i / 8 + i) % 2 == 0 { [240u8, 220, 160] } else { [90, 40, 20] });
    c.buffer_data(pixels, Contents::Bytes(board.as_flattened()), Usage::StreamDraw)?;
    c.bind_buffer(BufferTarget::PixelUnpack, pixels)?;
    c.texture_storage(texture, 4, Format::Rgba8Unorm, TextureSize::d2(8, 8))?;
    let region = Region { level: 0, origin: [0; 3], size: [8, 8, 1] };
    c.texture_sub_image(texture, region, Format::Rgb8Unorm, Pixels::Offset(0))?;
    c.generate_texture_mipmap(texture)?;
    c.texture_parameter(texture, TextureParameter::Minify(Filter::Linear, Some(Filter::Linear)))?;
    c.bind_texture(0, TextureKind::D2, texture)
}

/// Draws what is bound, lit from one side.
fn draw_lit(inputs: &Inputs, output: &mut Output) -> Result<()> {
    let tilt = Mat3::from_cols(Vec3::X, Vec3::new(0.0, 0.8, 0.6), Vec3::new(0.0, -0.6, 0.8));
    let vertex = |v: VertexInput| {
        let [position, normal, uv, place] = [0, 1, 2, 3].map(|number| inputs.attribute(number, v));
        let p = tilt * (position.truncate() * 0.7 + Vec3::new(place.x, 0.0, place.y)) - 14.0 * Vec3::Z;
        let clip = Vec4::new(1.8 * p.x, 2.4 * p.y, (-p.z - 1.0) * 30.0 / 29.0, -p.z);
        Vertex::new(clip, Surface { uv: uv.truncate().truncate(), normal: tilt * normal.truncate() })
    };
    let (light, (texture, sampler)) = (inputs.uniform::<Light>(0)?, inputs.sampler(0, TextureKind::D2)?);
    let shader = fragment(|f: &Fragment<Surface>| {
        let s = f.varyings();
        let lod = Lod::Gradients(f.dx(|s| s.uv).extend(0.0), f.dy(|s| s.uv).extend(0.0));
        let color = sampler.sample(&texture, s.uv.extend(0.0).extend(0.0), lod);
        let share = light.ambient + (1.0 - light.ambient) * s.normal.dot(light.direction).max(0.0);
        (color.truncate() * share).extend(1.0)
    });
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    output.draw(&Pipeline::new(Program::new(vertex, shader), state, output.layout())?).map(drop)
}

/// The picture, and the number of samples that passed.
pub fn draw() -> Result<(ColorTarget, u64)> {
    let picture = Framebuffer::with_color_and_depth(Extent::new(320, 240), Format::Rgba8Unorm)?;
    let mut c = Context::new(&ShareGroup::new(), picture);
    c.clear(Vec4::new(0.6, 0.75, 0.9, 1.0), 1.0, 0)?;
    bind_vertices(&mut c)?;
    bind_texture(&mut c)?;
    let (query, uniforms) = (c.gen_queries(1)?[0], c.create_buffers(1)?[0]);
    let light = Light { direction: Vec3::new(2.0, 6.0, 3.0) / 7.0, ambient: 0.25 }.to_bytes(BlockRules::Std140);
    c.buffer_data(uniforms, Contents::Bytes(&light), Usage::StaticDraw)?;
    c.bind_buffer_base(BufferTarget::Uniform, 0, uniforms)?;
    let cubes = Elements { count: 36, index: IndexType::U16, offset: 0, base_vertex: 0 };
    c.begin_query(QueryTarget::SamplesPassed, query)?;
    c.draw_elements(cubes, 0..11, draw_lit)?;
    c.end_query(QueryTarget::SamplesPassed)?;
    // The last cube is drawn only if anything was seen of the others.
    c.begin_conditional_render(query, ConditionalMode::Wait)?;
    c.draw_elements(cubes, 11..12, draw_lit)?;
    c.end_conditional_render()?;
    Ok((c.default_framebuffer().color(0).clone(), c.get_query_object(query)?))
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("objects.png".as_ref(), &draw()?.0.to_image()?, &Default::default())?)
}
