//! Transfers of pixels between textures, the client and buffers (M186).

use super::{assert_refused, context};
use crate::{
    Format,
    glam::Vec4,
    objects::{
        AttachmentPoint, BufferFlags, BufferTarget, Contents, Context, FramebufferTarget, PixelStore, Pixels,
        PixelsMut, Region, Usage,
    },
    texture::{TextureKind, TextureSize},
};

const OP: &str = "INVALID_OPERATION";
const REGION: Region = Region { level: 0, origin: [1, 0, 0], size: [3, 2, 1] };

/// A texture of 4 × 2 texels and a buffer of 64 bytes, whose bytes are their numbers.
fn prepared() -> (Context, u32, u32) {
    let mut c = context();
    let (texture, buffer) = (c.create_textures(TextureKind::D2, 1).unwrap()[0], c.create_buffers(1).unwrap()[0]);
    c.texture_storage(texture, 1, Format::R8Unorm, TextureSize::d2(4, 2)).unwrap();
    let bytes: Vec<u8> = (0..64).collect();
    c.buffer_data(buffer, Contents::Bytes(&bytes), Usage::StreamDraw).unwrap();
    (c, texture, buffer)
}

fn whole(c: &Context, texture: u32) -> [u8; 8] {
    let mut bytes = [0; 8];
    let region = Region { level: 0, origin: [0; 3], size: [4, 2, 1] };
    c.get_texture_sub_image(texture, region, Format::R8Unorm, PixelsMut::Bytes(&mut bytes)).unwrap();
    bytes
}

#[test]
fn rows_lie_as_the_pixel_store_says() {
    let (mut c, texture, buffer) = prepared();
    c.bind_buffer(BufferTarget::PixelUnpack, buffer).unwrap();
    // Rows of three bytes begin at multiples of four.
    c.texture_sub_image(texture, REGION, Format::R8Unorm, Pixels::Offset(10)).unwrap();
    assert_eq!(whole(&c, texture), [0, 10, 11, 12, 0, 14, 15, 16]);
    c.pixel_store(false, PixelStore { alignment: 1, ..PixelStore::default() }).unwrap();
    c.texture_sub_image(texture, REGION, Format::R8Unorm, Pixels::Offset(10)).unwrap();
    assert_eq!(whole(&c, texture), [0, 10, 11, 12, 0, 13, 14, 15]);
    c.pixel_store(false, PixelStore { alignment: 2, row_length: 5, image_height: 0 }).unwrap();
    c.texture_sub_image(texture, REGION, Format::R8Unorm, Pixels::Offset(10)).unwrap();
    assert_eq!(whole(&c, texture), [0, 10, 11, 12, 0, 16, 17, 18]);
    // And back, other bytes of the buffer stay.
    c.bind_buffer(BufferTarget::PixelPack, buffer).unwrap();
    c.get_texture_sub_image(texture, REGION, Format::R8Unorm, PixelsMut::Offset(40)).unwrap();
    assert_eq!(c.get_buffer_sub_data(buffer, 39, 9).unwrap(), [39, 10, 11, 12, 43, 16, 17, 18, 47]);
}

#[test]
fn pixels_are_converted_and_layers_count_in_z() {
    let mut c = context();
    let texture = c.create_textures(TextureKind::D2Array, 1).unwrap()[0];
    c.texture_storage(texture, 1, Format::Rgba8Unorm, TextureSize { layers: 3, ..TextureSize::d2(1, 1) }).unwrap();
    let floats = [0.0f32, 0.2, 1.0, 2.0, 0.4, 0.6, -1.0, 1.0].map(f32::to_le_bytes).concat();
    let region = Region { level: 0, origin: [0, 0, 1], size: [1, 1, 2] };
    c.texture_sub_image(texture, region, Format::Rgba32Float, Pixels::Bytes(&floats)).unwrap();
    let mut bytes = [9; 12];
    let region = Region { origin: [0; 3], size: [1, 1, 3], ..region };
    c.get_texture_sub_image(texture, region, Format::Rgba8Unorm, PixelsMut::Bytes(&mut bytes)).unwrap();
    assert_eq!(bytes, [0, 0, 0, 0, 0, 51, 255, 255, 102, 153, 0, 255]);
}

#[test]
fn each_broken_rule_of_transfers_is_refused() {
    const CALL: &str = "texture_sub_image";
    let (mut c, texture, buffer) = prepared();
    let write = |c: &Context, pixels| c.texture_sub_image(texture, REGION, Format::R8Unorm, pixels);
    assert_refused(write(&c, Pixels::Bytes(&[0; 6])), CALL, ["6 bytes for pixels of 7", OP]);
    assert_refused(write(&c, Pixels::Offset(0)), CALL, ["no buffer is bound", OP]);
    let integers = c.texture_sub_image(texture, REGION, Format::R8Uint, Pixels::Bytes(&[0; 8]));
    assert_refused(integers, CALL, ["does not take pixels of R8Uint", OP]);
    let depths = c.texture_sub_image(texture, REGION, Format::Depth16, Pixels::Bytes(&[0; 16]));
    assert_refused(depths, CALL, ["does not take pixels of Depth16", OP]);
    for region in [
        Region { origin: [2, 0, 0], ..REGION },
        Region { origin: [u32::MAX, 0, 0], ..REGION },
        Region { size: [1, 1, 2], ..REGION },
        Region { level: 1, size: [0; 3], ..REGION },
    ] {
        let outside = c.texture_sub_image(texture, region, Format::R8Unorm, Pixels::Bytes(&[0; 8]));
        assert_refused(outside, CALL, ["is not all within", "INVALID_VALUE"]);
    }
    c.bind_buffer(BufferTarget::PixelUnpack, buffer).unwrap();
    assert_refused(write(&c, Pixels::Bytes(&[0; 8])), CALL, ["a buffer is bound", OP]);
    assert_refused(write(&c, Pixels::Offset(58)), CALL, ["the buffer has 64", OP]);
    write(&c, Pixels::Offset(57)).unwrap();
    let odd = c.texture_sub_image(texture, REGION, Format::R32Float, Pixels::Offset(2));
    assert_refused(odd, CALL, ["no multiple of 4", OP]);
    c.map_buffer_range(buffer, 0, 1, BufferFlags::MAP_READ).unwrap();
    assert_refused(write(&c, Pixels::Offset(0)), CALL, ["mapped", OP]);
    c.bind_buffer(BufferTarget::PixelPack, buffer).unwrap();
    let read = c.get_texture_sub_image(texture, REGION, Format::R8Unorm, PixelsMut::Offset(0));
    assert_refused(read, "get_texture_sub_image", ["mapped", OP]);
    let odd = c.pixel_store(true, PixelStore { alignment: 3, ..PixelStore::default() });
    assert_refused(odd, "pixel_store", ["alignment 3", "INVALID_VALUE"]);
    let long = PixelStore { row_length: usize::MAX, ..PixelStore::default() };
    c.pixel_store(false, long).unwrap();
    assert_refused(write(&c, Pixels::Offset(0)), CALL, ["too long", "INVALID_VALUE"]);
    let again = c.texture_storage(texture, 1, Format::R8Unorm, TextureSize::d2(4, 2));
    assert_refused(again, "texture_storage", ["immutable", OP]);
    let bare = c.create_textures(TextureKind::Cube, 1).unwrap()[0];
    let flat = c.texture_storage(bare, 1, Format::R8Unorm, TextureSize::d2(4, 2));
    assert_refused(flat, "texture_storage", ["no size of a Cube", "INVALID_VALUE"]);
    assert_refused(c.generate_texture_mipmap(bare), "generate_texture_mipmap", ["no storage", OP]);
}

#[test]
fn what_is_drawn_to_a_texture_is_in_its_level_and_layer() {
    let mut c = context();
    let texture = c.create_textures(TextureKind::D2Array, 1).unwrap()[0];
    c.texture_storage(texture, 2, Format::Rgba8Unorm, TextureSize { layers: 2, ..TextureSize::d2(80, 8) }).unwrap();
    let framebuffer = c.create_framebuffers(1).unwrap()[0];
    c.named_framebuffer_texture_layer(framebuffer, AttachmentPoint::Color(0), texture, (1, 1)).unwrap();
    c.bind_framebuffer(FramebufferTarget::Both, framebuffer).unwrap();
    c.clear(Vec4::new(1.0, 0.0, 0.0, 1.0), 1.0, 0).unwrap();
    let read = |level: u32, width: u32, height: u32| {
        let region = Region { level, origin: [0; 3], size: [width, height, 2] };
        let mut bytes = vec![0; (width * height * 2 * 4) as usize];
        c.get_texture_sub_image(texture, region, Format::Rgba8Unorm, PixelsMut::Bytes(&mut bytes)).unwrap();
        bytes
    };
    assert!(read(0, 80, 8).iter().all(|byte| *byte == 0));
    let (first, second) = (vec![0; 40 * 4 * 4], [255, 0, 0, 255].repeat(40 * 4));
    assert_eq!(read(1, 40, 4), [first, second].concat());
}
