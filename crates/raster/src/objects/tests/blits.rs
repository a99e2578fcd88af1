//! Blits, and bindings of the framebuffers that are read from and drawn to.

use super::{assert_refused, context};
use crate::{
    Format, Fragment, Pipeline, Program, State, Vertex, VertexInput, fragment,
    glam::Vec4,
    objects::{
        AttachmentPoint::{self, Color, Depth, DepthStencil},
        BlitMask, ConditionalMode, Context, FramebufferTarget, Pixels, PixelsMut, QueryTarget, Region,
    },
    state::Multisample,
    texture::{Filter, TextureKind, TextureSize},
};

const CALL: &str = "blit_framebuffer";
const OP: &str = "INVALID_OPERATION";
const COLOR: BlitMask = BlitMask { color: true, depth: false, stencil: false };

/// A framebuffer with a texture of one level at a point.
fn framebuffer(c: &mut Context, point: AttachmentPoint, format: Format, [width, height]: [u32; 2]) -> [u32; 2] {
    let (framebuffer, image) =
        (c.create_framebuffers(1).unwrap()[0], c.create_textures(TextureKind::D2, 1).unwrap()[0]);
    c.texture_storage(image, 1, format, TextureSize::d2(width, height)).unwrap();
    c.named_framebuffer_texture(framebuffer, point, image, 0).unwrap();
    if point != Color(0) {
        c.named_framebuffer_draw_buffers(framebuffer, &[]).unwrap();
        c.named_framebuffer_read_buffer(framebuffer, None).unwrap();
    }
    [framebuffer, image]
}

/// A framebuffer with a renderbuffer of 2 × 2 pixels at a point.
fn samples(c: &mut Context, samples: u32, point: AttachmentPoint, format: Format) -> u32 {
    let (framebuffer, image) = (c.create_framebuffers(1).unwrap()[0], c.create_renderbuffers(1).unwrap()[0]);
    c.named_renderbuffer_storage(image, samples, format, [2, 2]).unwrap();
    c.named_framebuffer_renderbuffer(framebuffer, point, image).unwrap();
    framebuffer
}

fn bind(c: &mut Context, read: u32, draw: u32) {
    c.bind_framebuffer(FramebufferTarget::Read, read).unwrap();
    c.bind_framebuffer(FramebufferTarget::Draw, draw).unwrap();
}

fn write(c: &Context, image: u32, [width, height]: [u32; 2], bytes: &[u8]) {
    let region = Region { level: 0, origin: [0; 3], size: [width, height, 1] };
    let rows: Vec<u8> =
        bytes.chunks(width as usize).flat_map(|row| [row, &[0; 4][..(4 - row.len() % 4) % 4]].concat()).collect();
    c.texture_sub_image(image, region, Format::R8Unorm, Pixels::Bytes(&rows)).unwrap();
}

/// Texels of an image of 4 × 4 bytes.
fn texels(c: &Context, image: u32, format: Format) -> [u8; 16] {
    let mut bytes = [0; 16];
    let region = Region { level: 0, origin: [0; 3], size: [4, 4, 1] };
    c.get_texture_sub_image(image, region, format, PixelsMut::Bytes(&mut bytes)).unwrap();
    bytes
}

/// The texels 0, 80, 160, 240 of 2 × 2, blitted to 4 × 4 texels of 9.
fn blitted(source: [i32; 4], target: [i32; 4], filter: Filter) -> [u8; 16] {
    let mut c = context();
    let [read, from] = framebuffer(&mut c, Color(0), Format::R8Unorm, [2, 2]);
    let [draw, to] = framebuffer(&mut c, Color(0), Format::R8Unorm, [4, 4]);
    write(&c, from, [2, 2], &[0, 80, 160, 240]);
    write(&c, to, [4, 4], &[9; 16]);
    bind(&mut c, read, draw);
    c.blit_framebuffer(source, target, COLOR, filter).unwrap();
    texels(&c, to, Format::R8Unorm)
}

#[test]
fn rectangles_are_scaled_and_mirrored() {
    use Filter::{Linear, Nearest};
    let (all, twice) = ([0, 0, 2, 2], [0, 0, 4, 4]);
    let nearest = [0, 0, 80, 80, 0, 0, 80, 80, 160, 160, 240, 240, 160, 160, 240, 240];
    assert_eq!(blitted(all, twice, Nearest), nearest);
    // Weights 0, ¼, ¾, 1 on each axis.
    let linear = [0, 20, 60, 80, 40, 60, 100, 120, 120, 140, 180, 200, 160, 180, 220, 240];
    assert_eq!(blitted(all, twice, Linear), linear);
    let reversed = |texels: &[u8; 16]| std::array::from_fn::<u8, 16, _>(|i| texels[15 - i]);
    for (filter, texels) in [(Nearest, nearest), (Linear, linear)] {
        // Both axes mirrored, by the source or the target; twice is not at all.
        assert_eq!(blitted([2, 2, 0, 0], twice, filter), reversed(&texels));
        assert_eq!(blitted(all, [4, 4, 0, 0], filter), reversed(&texels));
        assert_eq!(blitted([2, 2, 0, 0], [4, 4, 0, 0], filter), texels);
    }
    // One axis.
    assert_eq!(blitted([0, 2, 2, 0], [1, 1, 3, 3], Nearest), [9, 9, 9, 9, 9, 160, 240, 9, 9, 0, 80, 9, 9, 9, 9, 9]);
    // The scale is that of the whole rectangles, of which the parts within both framebuffers are copied.
    assert_eq!(blitted([-1, 0, 1, 1], [0, 0, 4, 1], Nearest)[..5], [9, 9, 0, 0, 9]);
    assert_eq!(blitted([0, 0, 2, 1], [-2, 3, 6, 9], Nearest)[11..], [9, 0, 0, 80, 80]);
    // A linear filter reads texels beyond its rectangle, but not beyond the framebuffer.
    assert_eq!(blitted([1, 0, 2, 1], [0, 0, 4, 1], Linear)[..4], [50, 70, 80, 80]);
    for (source, target) in [([1, 1, 1, 2], twice), (all, [3, 0, 3, 4]), (all, [i32::MAX, 0, i32::MIN, 0])] {
        assert_eq!(blitted(source, target, Nearest), [9; 16]);
    }
    assert_eq!(blitted([0, 0, i32::MAX, i32::MAX], [i32::MIN, i32::MIN, i32::MAX, i32::MAX], Nearest), [9; 16]);
}

#[test]
fn colors_reach_all_draw_buffers_and_their_formats() {
    let mut c = context();
    let [draw, to] = framebuffer(&mut c, Color(0), Format::R8Unorm, [4, 4]);
    let second = c.create_textures(TextureKind::D2, 1).unwrap()[0];
    c.texture_storage(second, 1, Format::R8Unorm, TextureSize::d2(4, 4)).unwrap();
    c.named_framebuffer_texture(draw, Color(3), second, 0).unwrap();
    c.named_framebuffer_draw_buffers(draw, &[Some(3), None, Some(0)]).unwrap();
    c.clear(Vec4::new(0.2, 0.5, 0.0, 1.0), 1.0, 0).unwrap();
    bind(&mut c, 0, draw);
    c.blit_framebuffer([60, 60, 64, 64], [0, 0, 4, 4], COLOR, Filter::Nearest).unwrap();
    assert_eq!([to, second].map(|image| texels(&c, image, Format::R8Unorm)), [[51; 16]; 2]);
    // And the other way, from the read buffer.
    write(&c, second, [4, 4], &[255; 16]);
    c.named_framebuffer_read_buffer(draw, Some(3)).unwrap();
    bind(&mut c, draw, 0);
    c.blit_framebuffer([0, 0, 4, 4], [0, 0, 4, 4], COLOR, Filter::Nearest).unwrap();
    assert_eq!([3, 4].map(|x| c.default_framebuffer().color(0).pixel(x, 3).unwrap().x), [1.0, 0.2]);
    // Buffers that one of the framebuffers lacks are left out.
    c.named_framebuffer_read_buffer(draw, None).unwrap();
    let all = BlitMask { color: true, depth: true, stencil: true };
    c.blit_framebuffer([0, 0, 4, 4], [8, 0, 12, 4], all, Filter::Nearest).unwrap();
    assert_eq!(c.default_framebuffer().color(0).pixel(8, 0).unwrap().x, 0.2);
}

/// Overlapping rectangles of one framebuffer: pixels are read before any is written.
#[test]
fn a_framebuffer_is_blitted_to_itself() {
    let mut c = context();
    let [framebuffer, image] = framebuffer(&mut c, Color(0), Format::R8Unorm, [4, 4]);
    write(&c, image, [4, 4], &(0..16).collect::<Vec<u8>>());
    bind(&mut c, framebuffer, framebuffer);
    c.blit_framebuffer([0, 0, 3, 4], [1, 0, 4, 4], COLOR, Filter::Nearest).unwrap();
    assert_eq!(texels(&c, image, Format::R8Unorm), [0, 0, 1, 2, 4, 4, 5, 6, 8, 8, 9, 10, 12, 12, 13, 14]);
}

#[test]
fn depths_and_stencil_values_move_by_their_masks() {
    let mut c = context();
    let format = Format::Depth24Stencil8;
    let draws = [0; 2].map(|_| framebuffer(&mut c, DepthStencil, format, [4, 4]));
    c.bind_framebuffer(FramebufferTarget::Draw, draws[0][0]).unwrap();
    c.clear(Vec4::ZERO, 1.0, 7).unwrap();
    bind(&mut c, draws[0][0], draws[1][0]);
    let read = |c: &Context| {
        let mut bytes = [0; 64];
        let region = Region { level: 0, origin: [0; 3], size: [4, 4, 1] };
        c.get_texture_sub_image(draws[1][1], region, format, PixelsMut::Bytes(&mut bytes)).unwrap();
        bytes
    };
    // Depths in the lowest 24 bits, then stencil values.
    c.blit_framebuffer([0, 0, 4, 4], [4, 2, 2, 0], BlitMask { depth: true, ..BlitMask::default() }, Filter::Nearest)
        .unwrap();
    let (none, depth) = ([0; 8], [255, 255, 255, 0].repeat(2));
    let half = [&none[..], &depth].concat();
    assert_eq!(read(&c).to_vec(), [half.repeat(2), vec![0; 32]].concat());
    c.blit_framebuffer([0, 0, 4, 4], [2, 0, 4, 2], BlitMask { stencil: true, ..BlitMask::default() }, Filter::Nearest)
        .unwrap();
    let half = [&none[..], &[255, 255, 255, 7].repeat(2)].concat();
    assert_eq!(read(&c).to_vec(), [half.repeat(2), vec![0; 32]].concat());
}

/// Two of four samples lie left of the middle of a pixel.
#[test]
fn samples_resolve_to_their_mean_and_single_ones_fill_all() {
    let mut c = context();
    let array = c.create_vertex_arrays(1).unwrap()[0];
    c.bind_vertex_array(array).unwrap();
    let multisampled = [0; 2].map(|_| samples(&mut c, 4, Color(0), Format::R8Unorm));
    let [flat, image] = framebuffer(&mut c, Color(0), Format::R8Unorm, [4, 4]);
    bind(&mut c, 0, multisampled[0]);
    // The left half of the second pixel of each row, and all of the first.
    c.draw_arrays(0..3, 0..1, |_, output| {
        let vertex = |v: VertexInput| {
            let [x, y] = [[0.5, -9.0], [0.5, 9.0], [-20.0, 0.0]][v.vertex as usize];
            Vertex::new(Vec4::new(x, y, 0.5, 1.0), ())
        };
        let program = Program::new(vertex, fragment(|_: &Fragment<()>| Vec4::splat(0.8)));
        let state = State { multisample: Multisample::samples(4), ..State::default() };
        output.draw(&Pipeline::new(program, state, output.layout())?).map(drop)
    })
    .unwrap();
    // Samples are copied, then averaged: 204, and 204 / 2.
    bind(&mut c, multisampled[0], multisampled[1]);
    c.blit_framebuffer([0, 0, 2, 2], [2, 0, 0, 2], COLOR, Filter::Nearest).unwrap();
    bind(&mut c, multisampled[1], flat);
    c.blit_framebuffer([0, 0, 2, 2], [1, 1, 3, 3], COLOR, Filter::Linear).unwrap();
    assert_eq!(texels(&c, image, Format::R8Unorm), [0, 0, 0, 0, 0, 102, 204, 0, 0, 102, 204, 0, 0, 0, 0, 0]);
    // Pixels without samples fill all four.
    bind(&mut c, flat, multisampled[0]);
    c.blit_framebuffer([1, 1, 3, 3], [0, 0, 2, 2], COLOR, Filter::Nearest).unwrap();
    bind(&mut c, multisampled[0], flat);
    c.blit_framebuffer([0, 0, 2, 2], [0, 2, 2, 4], COLOR, Filter::Nearest).unwrap();
    assert_eq!(texels(&c, image, Format::R8Unorm)[8..], [102, 204, 204, 0, 102, 204, 0, 0]);
    // Of integers the first sample.
    let integers = samples(&mut c, 4, Color(0), Format::R8Uint);
    let [flat, image] = framebuffer(&mut c, Color(0), Format::R8Uint, [4, 4]);
    bind(&mut c, 0, integers);
    c.clear(Vec4::splat(f32::from_bits(200)), 1.0, 0).unwrap();
    bind(&mut c, integers, flat);
    c.blit_framebuffer([0, 0, 2, 2], [0, 0, 2, 2], COLOR, Filter::Nearest).unwrap();
    assert_eq!(texels(&c, image, Format::R8Uint)[..4], [200, 200, 0, 0]);
}

#[test]
fn each_broken_rule_of_blits_is_refused() {
    let mut c = context();
    let [flat, image] = framebuffer(&mut c, Color(0), Format::R8Unorm, [4, 4]);
    let [unsigned, _] = framebuffer(&mut c, Color(0), Format::R8Uint, [4, 4]);
    let [signed, _] = framebuffer(&mut c, Color(0), Format::R8Sint, [4, 4]);
    let [depth, _] = framebuffer(&mut c, Depth, Format::Depth16, [4, 4]);
    let [two, four] = [2, 4].map(|number| samples(&mut c, number, Color(0), Format::R8Unorm));
    let missing = c.create_framebuffers(1).unwrap()[0];
    let depths = BlitMask { depth: true, ..BlitMask::default() };
    let stencil = BlitMask { stencil: true, ..BlitMask::default() };
    let (all, less) = ([0, 0, 2, 2], [0, 0, 2, 1]);
    let incomplete = "INVALID_FRAMEBUFFER_OPERATION";
    for (read, draw, target, mask, filter, words) in [
        (missing, flat, all, COLOR, Filter::Nearest, ["MissingAttachment", incomplete]),
        (flat, missing, all, COLOR, Filter::Nearest, ["MissingAttachment", incomplete]),
        (0, 0, all, depths, Filter::Linear, ["the filter Nearest", OP]),
        (0, 0, all, stencil, Filter::Linear, ["the filter Nearest", OP]),
        (flat, unsigned, all, COLOR, Filter::Nearest, ["R8Uint does not take colours of R8Unorm", OP]),
        (unsigned, signed, all, COLOR, Filter::Nearest, ["R8Sint does not take colours of R8Uint", OP]),
        (signed, flat, all, COLOR, Filter::Nearest, ["R8Unorm does not take colours of R8Sint", OP]),
        (unsigned, unsigned, all, COLOR, Filter::Linear, ["R8Uint cannot be averaged", OP]),
        (0, depth, all, depths, Filter::Nearest, ["depths of Float32 to Unorm16", OP]),
        (two, four, all, COLOR, Filter::Nearest, ["2 samples to 4", OP]),
        (four, flat, less, COLOR, Filter::Nearest, ["[2, 2] pixels with samples to [2, 1]", OP]),
        (flat, four, less, COLOR, Filter::Nearest, ["[2, 2] pixels with samples to [2, 1]", OP]),
    ] {
        bind(&mut c, read, draw);
        assert_refused(c.blit_framebuffer(all, target, mask, filter), CALL, words);
    }
    assert_eq!(texels(&c, image, Format::R8Unorm), [0; 16]);
}

/// Copies read from one binding, clears write to the other, and deletion resets both.
#[test]
fn read_and_draw_framebuffers_are_bound_and_deleted_on_their_own() {
    let mut c = context();
    let [read, from] = framebuffer(&mut c, Color(0), Format::R8Unorm, [4, 4]);
    let [draw, to] = framebuffer(&mut c, Color(0), Format::R8Unorm, [4, 4]);
    write(&c, from, [4, 4], &[50; 16]);
    bind(&mut c, read, draw);
    c.clear(Vec4::ONE, 1.0, 0).unwrap();
    assert_eq!([from, to].map(|image| texels(&c, image, Format::R8Unorm)[0]), [50, 255]);
    let region = Region { level: 0, origin: [0; 3], size: [4, 1, 1] };
    c.copy_texture_sub_image(to, region, [0, 0]).unwrap();
    assert_eq!(texels(&c, to, Format::R8Unorm)[..5], [50, 50, 50, 50, 255]);
    // Conditional rendering drops blits.
    let query = c.create_queries(QueryTarget::SamplesPassed, 1).unwrap()[0];
    c.begin_conditional_render(query, ConditionalMode::Wait).unwrap();
    c.blit_framebuffer([0, 0, 4, 4], [0, 0, 4, 4], COLOR, Filter::Nearest).unwrap();
    c.end_conditional_render().unwrap();
    assert_eq!(texels(&c, to, Format::R8Unorm)[4], 255);
    // A deleted texture leaves the framebuffer that is read from; what is drawn to stays complete.
    c.delete_textures(&[from]);
    let blit = c.blit_framebuffer([0, 0, 4, 4], [0, 0, 4, 4], COLOR, Filter::Nearest);
    assert_refused(blit, CALL, ["MissingAttachment", "INVALID_FRAMEBUFFER_OPERATION"]);
    c.clear(Vec4::ZERO, 1.0, 0).unwrap();
    // A deleted framebuffer makes way for the default one in its own binding alone.
    c.clear(Vec4::splat(0.6), 1.0, 0).unwrap();
    bind(&mut c, draw, read);
    c.delete_framebuffers(&[read]);
    c.blit_framebuffer([0, 0, 4, 4], [0, 0, 4, 4], COLOR, Filter::Nearest).unwrap();
    assert_eq!([3, 4].map(|x| c.default_framebuffer().color(0).pixel(x, 0).unwrap().x), [0.6, 0.0]);
    c.delete_framebuffers(&[draw]);
    c.copy_texture_sub_image(to, region, [4, 0]).unwrap();
    assert_eq!(texels(&c, to, Format::R8Unorm)[..4], [0; 4]);
}
