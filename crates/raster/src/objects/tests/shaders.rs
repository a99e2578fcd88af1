//! Images, storage, counters and uniform blocks in shaders (M193, M195).

use std::sync::atomic::Ordering::Relaxed;

use super::{assert_refused, context};
use crate::{
    Block, BlockRules, ComputeShader, Extent, Format, Fragment, Framebuffer, Invocation, Pipeline, Program, Result,
    State, Vertex, VertexInput, block, fragment,
    glam::{Vec3, Vec4},
    objects::{
        AttachmentPoint, BufferFlags, BufferTarget, Contents, Context, FramebufferTarget, Image, ImageAccess, Inputs,
        Output, Pixels, PixelsMut, Region, ShareGroup, Usage,
    },
    texture::{TextureKind, TextureSize, TextureView, ViewRange},
};

const OP: &str = "INVALID_OPERATION";
const VALUE: &str = "INVALID_VALUE";
const SIZE: u32 = 64;
const WHOLE: Region = Region { level: 0, origin: [0; 3], size: [SIZE, SIZE, 1] };

fn texture(c: &mut Context, kind: TextureKind, format: Format, size: TextureSize) -> u32 {
    let texture = c.create_textures(kind, 1).unwrap()[0];
    c.texture_storage(texture, 1, format, size).unwrap();
    texture
}

fn buffer(c: &mut Context, target: BufferTarget, index: u32, bytes: &[u8]) -> u32 {
    let buffer = c.create_buffers(1).unwrap()[0];
    c.buffer_data(buffer, Contents::Bytes(bytes), Usage::DynamicCopy).unwrap();
    c.bind_buffer_base(target, index, buffer).unwrap();
    buffer
}

fn words(c: &Context, buffer: u32, count: usize) -> Vec<u32> {
    let bytes = c.get_buffer_sub_data(buffer, 0, 4 * count).unwrap();
    bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// A context with a vertex array and a picture of a format.
fn prepared(format: Format) -> Context {
    let picture = Framebuffer::with_color_and_depth(Extent::new(SIZE, SIZE), format).unwrap();
    let mut c = Context::new(&ShareGroup::new(), picture);
    let array = c.create_vertex_arrays(1).unwrap()[0];
    c.bind_vertex_array(array).unwrap();
    c
}

/// Counts the levels of a picture in an image, and their sums in storage.
struct Histogram<'a> {
    picture: TextureView<'a>,
    counts: Image<'a>,
    sums: &'a [std::sync::atomic::AtomicU32],
}

impl Histogram<'_> {
    fn count(&self, at: [u32; 2]) {
        let level = (self.picture.fetch(0, [at[0], at[1], 0], 0).x * 255.0).round() as u32;
        self.counts.atomic([level / 16, 0, 0]).unwrap().fetch_add(1, Relaxed);
        self.sums[(level / 16) as usize].fetch_add(level, Relaxed);
    }
}

impl ComputeShader for Histogram<'_> {
    type Shared = ();
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [8, 8, 1];
    fn shade(&self, _: u32, at: Invocation, (): &mut (), (): &mut ()) {
        self.count([at.global[0], at.global[1]]);
    }
}

/// Draws triangles of vertices by a closure for each covered pixel.
fn draw_pixels(
    output: &mut Output,
    place: impl Fn(u32) -> Vec4 + Sync,
    shade: impl Fn(&Fragment<()>) -> Vec4 + Sync,
) -> Result<()> {
    let vertex = |v: VertexInput| Vertex::new(place(v.vertex), ());
    let program =
        Program::new(vertex, fragment(move |f: &Fragment<()>| if f.is_helper() { Vec4::ZERO } else { shade(f) }));
    output.draw(&Pipeline::new(program, State::default(), output.layout())?).map(drop)
}

fn cover(vertex: u32) -> Vec4 {
    let [x, y] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]][vertex as usize % 3];
    Vec4::new(x, y, 0.5, 1.0)
}

/// Atomics of a compute shader, and of a fragment shader, count as a loop does, in whatever order they come.
#[test]
fn a_histogram_by_atomics_is_that_of_a_loop() {
    let mut c = prepared(Format::Rgba8Unorm);
    let levels: Vec<u8> =
        (0..SIZE * SIZE).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8 / (1 + i as u8 % 3)).collect();
    let (mut counts, mut sums) = ([0u32; 16], [0u32; 16]);
    for level in &levels {
        counts[usize::from(*level / 16)] += 1;
        sums[usize::from(*level / 16)] += u32::from(*level);
    }
    let picture = texture(&mut c, TextureKind::D2, Format::R8Unorm, TextureSize::d2(SIZE, SIZE));
    c.texture_sub_image(picture, WHOLE, Format::R8Unorm, Pixels::Bytes(&levels)).unwrap();
    c.bind_texture(0, TextureKind::D2, picture).unwrap();
    for times in 1..3 {
        let image = texture(&mut c, TextureKind::D1, Format::R32Uint, TextureSize::d2(16, 1));
        c.bind_image_texture(2, image, (0, None), ImageAccess::ReadWrite, Format::R32Uint).unwrap();
        let storage = buffer(&mut c, BufferTarget::ShaderStorage, 3, &[0; 64]);
        let histogram = |inputs: &Inputs, run: &mut dyn FnMut(&Histogram) -> Result<()>| {
            let picture = inputs.texture(0, TextureKind::D2)?;
            run(&Histogram { picture, counts: inputs.image(2, ImageAccess::ReadWrite)?, sums: inputs.storage(3)? })
        };
        c.dispatch_compute([8, 8, 1], |inputs, groups| histogram(inputs, &mut |kernel| groups.dispatch(kernel)))
            .unwrap();
        if times == 2 {
            // Once more, by fragments.
            c.draw_arrays(0..3, 0..1, |inputs, output| {
                histogram(inputs, &mut |kernel| {
                    draw_pixels(output, cover, |f| {
                        kernel.count(f.pixel());
                        Vec4::ONE
                    })
                })
            })
            .unwrap();
        }
        let mut bytes = [0; 64];
        let region = Region { size: [16, 1, 1], ..WHOLE };
        c.get_texture_sub_image(image, region, Format::R32Uint, PixelsMut::Bytes(&mut bytes)).unwrap();
        assert_eq!(bytes, counts.map(|count| (times * count).to_le_bytes()).as_flattened());
        assert_eq!(words(&c, storage, 16), sums.map(|sum| times * sum));
    }
}

/// Triangle of a vertex: overlapping, each at slopes of its own.
fn corner(vertex: u32) -> Vec4 {
    let random = |salt: u32| ((vertex * 3 + salt + 1).wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 24) as f32;
    Vec4::new(3.0 * random(0) - 1.5, 3.0 * random(1) - 1.5, random(2), 1.0)
}

/// Colours of fragments, nearest last, one over the other.
fn blended(mut fragments: Vec<(f32, u32)>) -> Vec4 {
    fragments.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let color = |id: u32| Vec4::new((id % 3) as f32, (id % 5) as f32, (id % 7) as f32, 2.0) * 0.25;
    fragments.into_iter().fold(Vec4::ZERO, |below, (_, id)| below * 0.5 + color(id) * 0.5)
}

/// Lists of fragments by pixel: the number of the first in an image, and in storage for each fragment, from number 1
/// on, that of the next, depth and triangle.
struct Resolve<'a> {
    heads: Image<'a>,
    nodes: &'a [std::sync::atomic::AtomicU32],
    result: Image<'a>,
}

impl ComputeShader for Resolve<'_> {
    type Shared = ();
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [16, 4, 1];
    fn shade(&self, _: u32, at: Invocation, (): &mut (), (): &mut ()) {
        let mut node = self.heads.load(at.global).x.to_bits();
        let mut fragments = Vec::new();
        while node != 0 {
            let word = |i: u32| self.nodes[(3 * node + i) as usize].load(Relaxed);
            fragments.push((f32::from_bits(word(1)), word(2)));
            node = word(0);
        }
        self.result.store(at.global, blended(fragments));
    }
}

#[test]
fn lists_of_fragments_by_atomic_exchange_are_those_sorted_in_software() {
    const TRIANGLES: u32 = 24;
    let mut c = prepared(Format::Rgba32Float);
    let size = TextureSize::d2(SIZE, SIZE);
    let heads = texture(&mut c, TextureKind::D2, Format::R32Uint, size);
    let result = texture(&mut c, TextureKind::D2, Format::Rgba32Float, size);
    c.bind_image_texture(0, heads, (0, None), ImageAccess::ReadWrite, Format::R32Uint).unwrap();
    c.bind_image_texture(1, result, (0, None), ImageAccess::WriteOnly, Format::Rgba32Float).unwrap();
    let nodes = buffer(&mut c, BufferTarget::ShaderStorage, 0, &vec![0; 12 * (1 + TRIANGLES * SIZE * SIZE) as usize]);
    let counter = buffer(&mut c, BufferTarget::AtomicCounter, 0, &[9, 9, 9, 9, 0, 0, 0, 0]);
    c.draw_arrays(0..3 * TRIANGLES, 0..1, |inputs, output| {
        let (heads, nodes, counter) =
            (inputs.image(0, ImageAccess::ReadWrite)?, inputs.storage(0)?, inputs.counter(0, 4)?);
        draw_pixels(output, corner, |f| {
            let node = counter.fetch_add(1, Relaxed) + 1;
            let [x, y] = f.pixel();
            let next = heads.atomic([x, y, 0]).unwrap().swap(node, Relaxed);
            for (i, word) in [next, f.position().z.to_bits(), f.primitive_id()].into_iter().enumerate() {
                nodes[3 * node as usize + i].store(word, Relaxed);
            }
            Vec4::ONE
        })
    })
    .unwrap();
    c.dispatch_compute([SIZE / 16, SIZE / 4, 1], |inputs, groups| {
        let (heads, result) = (inputs.image(0, ImageAccess::ReadOnly)?, inputs.image(1, ImageAccess::WriteOnly)?);
        groups.dispatch(&Resolve { heads, nodes: inputs.storage(0)?, result })
    })
    .unwrap();
    // In software: depths of each triangle by itself, from the picture.
    let mut lists = vec![Vec::new(); (SIZE * SIZE) as usize];
    for id in 0..TRIANGLES {
        c.clear(Vec4::ZERO, 1.0, 0).unwrap();
        c.draw_arrays(3 * id..3 * id + 3, 0..1, |_, output| {
            draw_pixels(output, corner, |f| Vec4::new(f.position().z, 1.0, 0.0, 0.0))
        })
        .unwrap();
        for (pixel, list) in (0..).zip(&mut lists) {
            let color = c.default_framebuffer().color(0).pixel(pixel % SIZE, pixel / SIZE).unwrap();
            if color.y > 0.0 {
                list.push((color.x, id));
            }
        }
    }
    let fragments: usize = lists.iter().map(Vec::len).sum();
    assert!(lists.iter().any(|list| list.len() > 4) && fragments > 5000, "{fragments}");
    assert_eq!(words(&c, counter, 2), [0x0909_0909, fragments as u32]);
    assert_eq!(words(&c, nodes, 3), [0; 3]);
    let mut bytes = vec![0; 16 * lists.len()];
    c.get_texture_sub_image(result, WHOLE, Format::Rgba32Float, PixelsMut::Bytes(&mut bytes)).unwrap();
    let expected = lists.into_iter().flat_map(|list| blended(list).to_array()).flat_map(f32::to_le_bytes);
    assert!(expected.eq(bytes));
}

/// Images show the layers and the format that they are bound with, and two of one texture share its texels.
#[test]
fn images_are_parts_of_textures_in_their_format() {
    let mut c = prepared(Format::Rgba8Unorm);
    let array =
        texture(&mut c, TextureKind::D2Array, Format::Rgba8Unorm, TextureSize { layers: 4, ..TextureSize::d2(3, 2) });
    let view = c.gen_textures(1).unwrap()[0];
    let range = ViewRange { kind: TextureKind::D2Array, format: Format::Rgba8Unorm, levels: 0..1, layers: 1..4 };
    c.texture_view(view, array, range).unwrap();
    c.bind_image_texture(0, array, (0, None), ImageAccess::ReadWrite, Format::Rgba8Unorm).unwrap();
    c.bind_image_texture(1, view, (0, Some(1)), ImageAccess::ReadWrite, Format::R32Uint).unwrap();
    c.dispatch_compute([1, 1, 1], |inputs, _| {
        let (whole, layer) = (inputs.image(0, ImageAccess::ReadWrite)?, inputs.image(1, ImageAccess::ReadWrite)?);
        assert_eq!((whole.size(), layer.size()), ([3, 2, 4], [3, 2, 1]));
        whole.store([2, 1, 2], Vec4::new(0.2, 0.4, 0.6, 1.0));
        let word = layer.atomic([2, 1, 0]).unwrap();
        assert_eq!(word.swap(0x0403_0201, Relaxed), 0xff99_6633);
        assert_eq!(whole.load([2, 1, 2]) * 255.0, Vec4::new(1.0, 2.0, 3.0, 4.0));
        // Outside.
        layer.store([3, 0, 0], Vec4::ONE);
        assert!(layer.atomic([0, 0, 1]).is_none() && whole.atomic([0; 3]).is_none());
        assert_eq!((whole.load([0, 2, 0]), whole.load([0, 0, u32::MAX])), (Vec4::ZERO, Vec4::ZERO));
        Ok(())
    })
    .unwrap();
    let mut bytes = [0; 4 * 24];
    let region = Region { size: [3, 2, 4], ..WHOLE };
    c.get_texture_sub_image(array, region, Format::Rgba8Unorm, PixelsMut::Bytes(&mut bytes)).unwrap();
    assert_eq!(bytes[4 * 17..][..4], [1, 2, 3, 4]);
    assert_eq!(bytes.iter().filter(|byte| **byte != 0).count(), 4);
}

block! { struct Material { color: Vec3, power: f32, weights: [f32; 2], } }
block! { struct Huge { floats: [Vec4; 5000], } }

#[test]
fn uniform_blocks_reach_shaders_by_std140() {
    let mut c = prepared(Format::Rgba8Unorm);
    let material = Material { color: Vec3::new(0.2, 0.4, 0.6), power: 2.0, weights: [0.5, 0.25] };
    let bytes = [vec![0xee; 32], material.to_bytes(BlockRules::Std140)].concat();
    let name = buffer(&mut c, BufferTarget::Uniform, 1, &bytes);
    c.bind_buffer_range(BufferTarget::Uniform, 5, name, (32, 48)).unwrap();
    c.bind_buffer_range(BufferTarget::Uniform, 6, name, (32, 40)).unwrap();
    c.draw_arrays(0..3, 0..1, |inputs, output| {
        let found: Material = inputs.uniform(5)?;
        assert_eq!(found, material);
        let call = "Inputs::uniform";
        assert_refused(inputs.uniform::<Material>(6), call, ["40 bytes for a block of 48", OP]);
        assert_refused(inputs.uniform::<Material>(7), call, ["no buffer is bound to index 7", OP]);
        assert_refused(inputs.uniform::<Huge>(5), call, ["more than 65536 bytes", OP]);
        draw_pixels(output, cover, |_| found.color.extend(found.weights[0] * found.power))
    })
    .unwrap();
    assert_eq!(c.default_framebuffer().color(0).to_bytes(0)[..4], [51, 102, 153, 255]);
    // A deleted buffer leaves the indices.
    c.delete_buffers(&[name]);
    let gone = c.dispatch_compute([1, 1, 1], |inputs, _| inputs.uniform::<Material>(5).map(drop));
    assert_refused(gone, "Inputs::uniform", ["no buffer is bound", OP]);
}

#[test]
fn groups_are_those_of_the_buffer() {
    let mut c = prepared(Format::Rgba8Unorm);
    let picture = texture(&mut c, TextureKind::D2, Format::R8Unorm, TextureSize::d2(8, 8));
    let image = texture(&mut c, TextureKind::D1, Format::R32Uint, TextureSize::d2(16, 1));
    c.bind_texture(0, TextureKind::D2, picture).unwrap();
    c.bind_image_texture(0, image, (0, None), ImageAccess::ReadWrite, Format::R32Uint).unwrap();
    buffer(&mut c, BufferTarget::ShaderStorage, 0, &[0; 64]);
    let parameters = buffer(&mut c, BufferTarget::ShaderStorage, 1, &[7u32, 2, 3, 1, 9].map(u32::to_le_bytes).concat());
    c.bind_buffer(BufferTarget::DispatchIndirect, parameters).unwrap();
    let run = |c: &mut Context, offset| {
        c.dispatch_compute_indirect(offset, |inputs, groups| {
            let (picture, counts) = (inputs.texture(0, TextureKind::D2)?, inputs.image(0, ImageAccess::ReadWrite)?);
            groups.dispatch(&Histogram { picture, counts, sums: inputs.storage(0)? })
        })
    };
    run(&mut c, 4).unwrap();
    let mut bytes = [0; 4];
    let region = Region { size: [1, 1, 1], ..WHOLE };
    c.get_texture_sub_image(image, region, Format::R32Uint, PixelsMut::Bytes(&mut bytes)).unwrap();
    assert_eq!(u32::from_le_bytes(bytes), 2 * 3 * 64);
    let call = "dispatch_compute_indirect";
    assert_refused(run(&mut c, 6), call, ["no multiple of 4", VALUE]);
    assert_refused(run(&mut c, 12), call, ["the buffer has 20", OP]);
    c.buffer_sub_data(parameters, 4, &[0xff; 4]).unwrap();
    assert_refused(run(&mut c, 4), "Groups::dispatch", ["at most 65535", VALUE]);
    c.bind_buffer(BufferTarget::DispatchIndirect, 0).unwrap();
    assert_refused(run(&mut c, 4), call, ["no buffer is bound", OP]);
}

#[test]
fn each_broken_rule_of_images_and_blocks_is_refused() {
    let mut c = context();
    let flat = texture(&mut c, TextureKind::D2, Format::Rgba8Unorm, TextureSize::d2(4, 4));
    let bare = c.create_textures(TextureKind::D2, 1).unwrap()[0];
    let samples = c.create_textures(TextureKind::D2Multisample, 1).unwrap()[0];
    let call = "bind_image_texture";
    for (unit, texture, level, layer, format, words) in [
        (8, flat, 0, None, Format::R32Uint, ["image unit 8", VALUE]),
        (0, 99, 0, None, Format::R32Uint, ["99 is not a name", OP]),
        (0, bare, 0, None, Format::R32Uint, ["no storage", OP]),
        (0, samples, 0, None, Format::R32Uint, ["is no image", OP]),
        (0, flat, 1, None, Format::R32Uint, ["level 1", VALUE]),
        (0, flat, 0, Some(1), Format::R32Uint, ["layer Some(1)", VALUE]),
        (0, flat, 0, None, Format::Rgb8Unorm, ["no format of images", "INVALID_ENUM"]),
        (0, flat, 0, None, Format::Rgba8Srgb, ["no format of images", "INVALID_ENUM"]),
        (0, flat, 0, None, Format::Rgba16Float, ["cannot be accessed as Rgba16Float", OP]),
    ] {
        let bound = c.bind_image_texture(unit, texture, (level, layer), ImageAccess::ReadOnly, format);
        assert_refused(bound, call, words);
    }
    let (range, base) = ("bind_buffer_range", "bind_buffer_base");
    let name = buffer(&mut c, BufferTarget::AtomicCounter, 0, &[0; 7]);
    assert_refused(c.bind_buffer_base(BufferTarget::Array, 0, name), base, ["has no indices", "INVALID_ENUM"]);
    assert_refused(c.bind_buffer_base(BufferTarget::Uniform, 84, name), base, ["index 84", VALUE]);
    assert_refused(c.bind_buffer_base(BufferTarget::Uniform, 0, 77), base, ["77 is not a generated name", OP]);
    let bytes = |c: &mut Context, target, range| c.bind_buffer_range(target, 0, name, range);
    assert_refused(bytes(&mut c, BufferTarget::ShaderStorage, (8, 4)), range, ["no multiple of 16", VALUE]);
    assert_refused(bytes(&mut c, BufferTarget::AtomicCounter, (2, 4)), range, ["no multiple of 4", VALUE]);
    assert_refused(bytes(&mut c, BufferTarget::AtomicCounter, (0, 0)), range, ["must be positive", VALUE]);
    // In shaders.
    c.bind_image_texture(0, flat, (0, None), ImageAccess::ReadOnly, Format::R32Uint).unwrap();
    c.dispatch_compute([1, 1, 1], |inputs, _| {
        let image = "Inputs::image";
        assert_refused(inputs.image(0, ImageAccess::ReadWrite), image, ["unit 0 is bound for ReadOnly", OP]);
        assert_refused(inputs.image(1, ImageAccess::ReadOnly), image, ["no image is bound to unit 1", OP]);
        assert!(inputs.image(0, ImageAccess::ReadOnly)?.atomic([0; 3]).is_none());
        assert_refused(inputs.storage(0), "Inputs::storage", ["no buffer is bound to index 0", OP]);
        assert_refused(inputs.counter(1, 0), "Inputs::counter", ["no buffer is bound to index 1", OP]);
        assert_refused(inputs.counter(0, 2), "Inputs::counter", ["no counter is at byte 2", OP]);
        // The second counter would end beyond the seven bytes.
        assert_refused(inputs.counter(0, 4), "Inputs::counter", ["no counter is at byte 4", OP]);
        inputs.counter(0, 0)?.fetch_add(3, Relaxed);
        Ok(())
    })
    .unwrap();
    assert_eq!(words(&c, name, 1), [3]);
    // An image that is drawn to.
    let framebuffer = c.create_framebuffers(1).unwrap()[0];
    let array = c.create_vertex_arrays(1).unwrap()[0];
    c.named_framebuffer_texture(framebuffer, AttachmentPoint::Color(0), flat, 0).unwrap();
    c.bind_framebuffer(FramebufferTarget::Both, framebuffer).unwrap();
    c.bind_vertex_array(array).unwrap();
    let drawn = c.draw_arrays(0..3, 0..1, |inputs, _| inputs.image(0, ImageAccess::ReadOnly).map(drop));
    assert_refused(drawn, "Inputs::image", ["image unit 0 are texture 1, Color(0) of framebuffer 1", OP]);
    // A buffer that is mapped.
    c.map_buffer_range(name, 0, 4, BufferFlags::MAP_READ).unwrap();
    assert_refused(c.dispatch_compute([1, 1, 1], |_, _| Ok(())), "dispatch_compute", ["mapped", OP]);
    c.delete_textures(&[flat]);
    c.delete_buffers(&[name]);
    c.dispatch_compute([1, 1, 1], |inputs, _| {
        assert!(inputs.image(0, ImageAccess::ReadOnly).is_err() && inputs.counter(0, 0).is_err());
        Ok(())
    })
    .unwrap();
}
