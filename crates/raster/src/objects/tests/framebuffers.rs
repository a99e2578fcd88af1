//! Framebuffers: attachments, completeness, draw buffers, feedback loops (M194).

use super::{assert_refused, context};
use crate::{
    Format, Fragment, Pipeline, Program, Result, State, Vertex, VertexInput, fragment,
    glam::Vec4,
    objects::{
        AttachmentPoint::{Color, Depth, DepthStencil, Stencil},
        Context, FramebufferStatus, FramebufferTarget, Inputs, Output, PixelsMut, Region, TextureParameter,
    },
    state::{DepthState, Multisample},
    texture::{TextureKind, TextureSize},
};

const OP: &str = "INVALID_OPERATION";
const INCOMPLETE: &str = "INVALID_FRAMEBUFFER_OPERATION";

/// A context with a vertex array, and a framebuffer that is bound under the name 1.
fn prepared() -> Context {
    let mut c = context();
    let array = c.create_vertex_arrays(1).unwrap()[0];
    c.bind_vertex_array(array).unwrap();
    c.create_framebuffers(1).unwrap();
    c.bind_framebuffer(FramebufferTarget::Both, 1).unwrap();
    c
}

/// A texture of 8 × 4 texels and two levels, arrays and volumes with three layers.
fn texture(c: &mut Context, kind: TextureKind, format: Format) -> u32 {
    let name = c.create_textures(kind, 1).unwrap()[0];
    let mut size = TextureSize::d2(8, 4);
    match kind {
        TextureKind::D2Array | TextureKind::D2MultisampleArray => size.layers = 3,
        TextureKind::D3 => size.depth = 3,
        _ => {}
    }
    if kind.is_multisample() {
        c.texture_storage_multisample(name, 4, format, size).unwrap();
    } else {
        c.texture_storage(name, if kind.has_levels() { 2 } else { 1 }, format, size).unwrap();
    }
    name
}

fn renderbuffer(c: &mut Context, samples: u32, format: Format, size: [u32; 2]) -> u32 {
    let name = c.create_renderbuffers(1).unwrap()[0];
    c.named_renderbuffer_storage(name, samples, format, size).unwrap();
    name
}

/// Draws a triangle over all of layer `v.instance`, at a depth, by a shader.
fn cover(output: &mut Output, depth: f32, state: State, color: Vec4) -> Result<()> {
    let vertex = |v: VertexInput| {
        let [x, y] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]][v.vertex as usize];
        Vertex { layer: v.instance, ..Vertex::new(Vec4::new(x, y, depth, 1.0), ()) }
    };
    let program = Program::new(vertex, fragment(move |_: &Fragment<()>| color));
    output.draw(&Pipeline::new(program, state, output.layout())?).map(drop)
}

/// Bytes of a level of a texture of one byte for a texel.
fn level(c: &Context, texture: u32, level: u32, size: [u32; 3]) -> Vec<u8> {
    let mut bytes = vec![0; size.iter().product::<u32>() as usize];
    let region = Region { level, origin: [0; 3], size };
    c.get_texture_sub_image(texture, region, Format::R8Unorm, PixelsMut::Bytes(&mut bytes)).unwrap();
    bytes
}

/// Asserts a state, and that draws, clears and copies are refused if it is not complete.
#[track_caller]
fn assert_status(change: impl FnOnce(&mut Context), expected: FramebufferStatus) {
    let mut c = prepared();
    change(&mut c);
    assert_eq!(c.check_named_framebuffer_status(1).unwrap(), expected);
    let draw = c.draw_arrays(0..0, 0..1, |_, _| Ok(()));
    let clear = c.clear(Vec4::ZERO, 1.0, 0);
    if expected == FramebufferStatus::Complete {
        draw.and(clear).unwrap();
    } else {
        let status = format!("{expected:?}");
        assert_refused(draw, "draw_arrays", [&status, INCOMPLETE]);
        assert_refused(clear, "clear", [&status, INCOMPLETE]);
    }
}

#[test]
fn attachments_are_complete_if_their_point_takes_their_format() {
    use FramebufferStatus::{Complete, IncompleteAttachment};
    // Formats, and the points that take them: colour, depth, stencil, both.
    for (format, taken) in [
        (Format::Rgba8Unorm, [true, false, false, false]),
        (Format::R32Uint, [true, false, false, false]),
        (Format::Rgb9E5, [false; 4]),
        (Format::Depth24, [false, true, false, false]),
        (Format::Stencil8, [false, false, true, false]),
        (Format::Depth24Stencil8, [false, true, true, true]),
        (Format::Depth32FloatStencil8, [false, true, true, true]),
    ] {
        for (point, taken) in [Color(0), Depth, Stencil, DepthStencil].into_iter().zip(taken) {
            assert_status(
                |c| {
                    let image = texture(c, TextureKind::D2, format);
                    if point != Color(0) {
                        c.named_framebuffer_draw_buffers(1, &[]).unwrap();
                        c.named_framebuffer_read_buffer(1, None).unwrap();
                    }
                    c.named_framebuffer_texture(1, point, image, 1).unwrap();
                },
                if taken { Complete } else { IncompleteAttachment },
            );
        }
    }
    // Without storage.
    assert_status(
        |c| {
            let image = c.create_textures(TextureKind::D2, 1).unwrap()[0];
            c.named_framebuffer_texture(1, Color(0), image, 0).unwrap();
        },
        IncompleteAttachment,
    );
    // With storage that came later and lacks the level.
    for level in [2, u32::MAX] {
        assert_status(
            |c| {
                let image = c.create_textures(TextureKind::D2, 1).unwrap()[0];
                c.named_framebuffer_texture(1, Color(0), image, level).unwrap();
                c.texture_storage(image, 2, Format::R8Unorm, TextureSize::d2(8, 4)).unwrap();
                c.bind_texture(0, TextureKind::D2, image).unwrap();
                c.dispatch_compute([1; 3], |inputs, _| inputs.texture(0, TextureKind::D2).map(drop)).unwrap();
            },
            IncompleteAttachment,
        );
    }
    assert_status(
        |c| {
            let image = c.create_renderbuffers(1).unwrap()[0];
            c.named_framebuffer_renderbuffer(1, Color(0), image).unwrap();
        },
        IncompleteAttachment,
    );
}

#[test]
fn nothing_attached_is_missing() {
    assert_status(|_| {}, FramebufferStatus::MissingAttachment);
    assert_status(
        |c| {
            let image = texture(c, TextureKind::D2, Format::R8Unorm);
            c.named_framebuffer_texture(1, Color(0), image, 0).unwrap();
            c.delete_textures(&[image]);
        },
        FramebufferStatus::MissingAttachment,
    );
    assert_eq!(context().check_named_framebuffer_status(0).unwrap(), FramebufferStatus::Complete);
}

#[test]
fn draw_and_read_buffers_have_images() {
    let attach = |c: &mut Context| {
        let image = texture(c, TextureKind::D2, Format::R8Unorm);
        c.named_framebuffer_texture(1, Color(1), image, 0).unwrap();
    };
    assert_status(attach, FramebufferStatus::IncompleteDrawBuffer);
    let drawn = |c: &mut Context| {
        attach(c);
        c.named_framebuffer_draw_buffers(1, &[None, Some(1)]).unwrap();
    };
    assert_status(drawn, FramebufferStatus::IncompleteReadBuffer);
    assert_status(
        |c| {
            drawn(c);
            c.named_framebuffer_read_buffer(1, Some(1)).unwrap();
        },
        FramebufferStatus::Complete,
    );
}

#[test]
fn depths_and_stencil_values_are_of_one_image() {
    for (same, status) in [(true, FramebufferStatus::Complete), (false, FramebufferStatus::Unsupported)] {
        assert_status(
            |c| {
                let color = texture(c, TextureKind::D2, Format::R8Unorm);
                let [a, b] = [0; 2].map(|_| renderbuffer(c, 1, Format::Depth24Stencil8, [8, 4]));
                c.named_framebuffer_texture(1, Color(0), color, 0).unwrap();
                c.named_framebuffer_renderbuffer(1, Depth, a).unwrap();
                c.named_framebuffer_renderbuffer(1, Stencil, if same { a } else { b }).unwrap();
            },
            status,
        );
    }
}

#[test]
fn samples_are_as_many() {
    for (samples, status) in [(4, FramebufferStatus::Complete), (2, FramebufferStatus::IncompleteMultisample)] {
        assert_status(
            |c| {
                let color = texture(c, TextureKind::D2Multisample, Format::R8Unorm);
                let depth = renderbuffer(c, samples, Format::Depth16, [8, 4]);
                c.named_framebuffer_texture(1, Color(0), color, 0).unwrap();
                c.named_framebuffer_renderbuffer(1, Depth, depth).unwrap();
            },
            status,
        );
    }
}

#[test]
fn layers_are_of_all_images_and_one_kind() {
    use FramebufferStatus::{Complete, IncompleteLayerTargets};
    use TextureKind::{D2, D2Array, D3};
    for (kinds, layer, status) in [
        ([D2Array, D2Array], None, Complete),
        ([D2Array, D2Array], Some(2), IncompleteLayerTargets),
        ([D2Array, D3], None, IncompleteLayerTargets),
        ([D2, D2Array], None, IncompleteLayerTargets),
        ([D2, D2Array], Some(2), Complete),
        ([D3, D3], None, Complete),
    ] {
        assert_status(
            |c| {
                let [first, second] = kinds.map(|kind| texture(c, kind, Format::R8Unorm));
                c.named_framebuffer_texture(1, Color(0), first, 0).unwrap();
                match layer {
                    Some(layer) => c.named_framebuffer_texture_layer(1, Color(1), second, (0, layer)).unwrap(),
                    None => c.named_framebuffer_texture(1, Color(1), second, 0).unwrap(),
                }
            },
            status,
        );
    }
}

#[test]
fn outputs_reach_their_draw_buffers() {
    let mut c = prepared();
    let images = [0; 3].map(|_| texture(&mut c, TextureKind::D2, Format::R8Unorm));
    for (number, image) in (0..).zip(images) {
        c.named_framebuffer_texture(1, Color(number), image, 0).unwrap();
    }
    // Location 0 to attachment 2, 1 to none, 2 to attachment 0.
    c.named_framebuffer_draw_buffers(1, &[Some(2), None, Some(0)]).unwrap();
    c.draw_arrays(0..3, 0..1, |_, output| {
        let vertex = |v: VertexInput| {
            let [x, y] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]][v.vertex as usize];
            Vertex::new(Vec4::new(x, y, 0.5, 1.0), ())
        };
        let shader = fragment(|_: &Fragment<()>| [0.2, 0.4, 0.6].map(Vec4::splat));
        output.draw(&Pipeline::new(Program::new(vertex, shader), State::default(), output.layout())?).map(drop)
    })
    .unwrap();
    assert_eq!(images.map(|image| level(&c, image, 0, [8, 4, 1])), [[153; 32], [0; 32], [51; 32]]);
}

/// Drawing reaches the texels that all images have; others of their texels stay.
#[test]
fn the_smallest_image_bounds_what_is_drawn() {
    let mut c = prepared();
    let color = texture(&mut c, TextureKind::D2, Format::R8Unorm);
    let depth = renderbuffer(&mut c, 1, Format::Depth16, [3, 16]);
    c.named_framebuffer_texture(1, Color(0), color, 0).unwrap();
    c.named_framebuffer_renderbuffer(1, Depth, depth).unwrap();
    c.clear(Vec4::ONE, 1.0, 0).unwrap();
    assert_eq!(level(&c, color, 0, [8, 4, 1]), [255, 255, 255, 0, 0, 0, 0, 0].repeat(4));
}

/// Depths of a renderbuffer last from draw to draw, in each of their formats, and reach a texture by a copy.
#[test]
fn depths_last_and_are_copied() {
    for format in [Format::Depth16, Format::Depth24, Format::Depth32Float, Format::Depth24Stencil8] {
        let mut c = prepared();
        let color = texture(&mut c, TextureKind::D2, Format::R8Unorm);
        let depth = renderbuffer(&mut c, 1, format, [8, 4]);
        c.named_framebuffer_texture(1, Color(0), color, 0).unwrap();
        c.named_framebuffer_renderbuffer(1, Depth, depth).unwrap();
        c.clear(Vec4::ZERO, 1.0, 0).unwrap();
        let state = || State { depth: Some(DepthState::LESS), ..State::default() };
        for (depth, value, seen) in [(0.5, 0.2, 51), (0.75, 0.4, 51), (0.25, 0.6, 153)] {
            c.draw_arrays(0..3, 0..1, |_, output| cover(output, depth, state(), Vec4::splat(value))).unwrap();
            assert_eq!(level(&c, color, 0, [8, 4, 1]), [seen; 32], "{format:?}");
        }
        let copy = texture(&mut c, TextureKind::D2, Format::Depth32Float);
        let region = Region { level: 0, origin: [1, 1, 0], size: [2, 2, 1] };
        c.copy_texture_sub_image(copy, region, [5, 1]).unwrap();
        c.bind_texture(0, TextureKind::D2, copy).unwrap();
        c.draw_arrays(0..0, 0..1, |inputs, _| {
            let copy = inputs.texture(0, TextureKind::D2)?;
            let row = [0, 1, 2, 3].map(|x| copy.fetch(0, [x, 2, 0], 0).x);
            assert!((row[1] - 0.25).abs() < 1e-5 && row[1] == row[2] && row[0] == 0.0 && row[3] == 0.0, "{row:?}");
            Ok(())
        })
        .unwrap();
    }
}

#[test]
fn layers_and_samples_are_drawn_and_copied() {
    let mut c = prepared();
    let array = texture(&mut c, TextureKind::D2MultisampleArray, Format::R8Unorm);
    c.named_framebuffer_texture(1, Color(0), array, 0).unwrap();
    let state = State { multisample: Multisample::samples(4), ..State::default() };
    // Instances 1 and 2 draw to layers of their numbers.
    c.draw_arrays(0..3, 1..3, |_, output| cover(output, 0.5, state, Vec4::splat(0.2))).unwrap();
    c.bind_texture(0, TextureKind::D2MultisampleArray, array).unwrap();
    c.bind_framebuffer(FramebufferTarget::Both, 0).unwrap();
    c.draw_arrays(0..0, 0..1, |inputs, _| {
        let texture = inputs.texture(0, TextureKind::D2MultisampleArray)?;
        for sample in 0..4 {
            assert_eq!([0, 1, 2].map(|layer| texture.fetch_sample([7, 3], layer, sample).x), [0.0, 0.2, 0.2]);
        }
        Ok(())
    })
    .unwrap();
    // Colours of the default framebuffer, converted.
    c.clear(Vec4::new(0.4, 0.0, 0.0, 1.0), 1.0, 0).unwrap();
    let flat = texture(&mut c, TextureKind::D2, Format::R8Unorm);
    let region = Region { level: 1, origin: [1, 1, 0], size: [3, 1, 1] };
    c.copy_texture_sub_image(flat, region, [60, 63]).unwrap();
    assert_eq!(level(&c, flat, 1, [4, 2, 1]), [0, 0, 0, 0, 0, 102, 102, 102]);
    let call = "copy_texture_sub_image";
    assert_refused(c.copy_texture_sub_image(flat, region, [62, 0]), call, ["not all within", "INVALID_VALUE"]);
    let integers = texture(&mut c, TextureKind::D2, Format::R8Uint);
    assert_refused(c.copy_texture_sub_image(integers, region, [0, 0]), call, ["does not take", OP]);
    assert_refused(c.copy_texture_sub_image(array, region, [0, 0]), call, ["with samples", OP]);
    c.bind_framebuffer(FramebufferTarget::Both, 1).unwrap();
    assert_refused(c.copy_texture_sub_image(flat, region, [0, 0]), call, ["the framebuffer has samples", OP]);
    c.named_framebuffer_read_buffer(1, None).unwrap();
    assert_refused(c.copy_texture_sub_image(flat, region, [0, 0]), call, ["nothing to read", OP]);
}

/// Lookups in texels that are drawn to are refused with both names; other levels and layers are not.
#[test]
fn feedback_loops_are_refused() {
    let mut c = prepared();
    let image = texture(&mut c, TextureKind::D2Array, Format::R8Unorm);
    c.bind_texture(3, TextureKind::D2Array, image).unwrap();
    c.named_framebuffer_texture_layer(1, Color(0), image, (1, 2)).unwrap();
    let sample = |c: &mut Context| {
        c.draw_arrays(0..3, 0..1, |inputs: &Inputs, output: &mut Output| {
            let (view, _) = inputs.sampler(3, TextureKind::D2Array)?;
            cover(output, 0.5, State::default(), view.fetch(0, [0; 3], 0))
        })
    };
    let words = ["unit 3 are texture 1, Color(0) of framebuffer 1: a feedback loop", OP];
    assert_refused(sample(&mut c), "Inputs::sampler", words);
    // With the other level alone.
    c.texture_parameter(image, TextureParameter::MaxLevel(0)).unwrap();
    sample(&mut c).unwrap();
    c.texture_parameter(image, TextureParameter::MaxLevel(9)).unwrap();
    assert_refused(sample(&mut c), "Inputs::sampler", words);
    // A view of another layer; and one of the layer, whose texels are those that are attached.
    let range = |layers| crate::texture::ViewRange {
        kind: TextureKind::D2Array,
        format: Format::R8Unorm,
        levels: 0..2,
        layers,
    };
    let views = c.gen_textures(2).unwrap();
    c.texture_view(views[0], image, range(0..2)).unwrap();
    c.texture_view(views[1], image, range(2..3)).unwrap();
    c.bind_texture(3, TextureKind::D2Array, views[0]).unwrap();
    sample(&mut c).unwrap();
    c.bind_texture(3, TextureKind::D2Array, views[1]).unwrap();
    assert_refused(sample(&mut c), "Inputs::sampler", words);
    // Bound, but not looked up.
    c.draw_arrays(0..3, 0..1, |_, output| cover(output, 0.5, State::default(), Vec4::ONE)).unwrap();
    c.bind_framebuffer(FramebufferTarget::Both, 0).unwrap();
    sample(&mut c).unwrap();
}

#[test]
fn each_broken_rule_of_framebuffers_is_refused() {
    let mut c = prepared();
    let flat = texture(&mut c, TextureKind::D2, Format::R8Unorm);
    let buffer = c.create_textures(TextureKind::Buffer, 1).unwrap()[0];
    let image = c.create_renderbuffers(1).unwrap()[0];
    let value = "INVALID_VALUE";
    let call = "named_framebuffer_texture";
    assert_refused(c.named_framebuffer_texture(1, Color(8), flat, 0), call, ["attachment 8", OP]);
    assert_refused(c.named_framebuffer_texture(1, Color(0), flat, 2), call, ["level 2", value]);
    assert_refused(c.named_framebuffer_texture(1, Color(0), buffer, 0), call, ["buffer texture", OP]);
    assert_refused(c.named_framebuffer_texture(7, Color(0), flat, 0), call, ["7 is not a name", OP]);
    let layer = c.named_framebuffer_texture_layer(1, Color(0), flat, (0, 0));
    assert_refused(layer, "named_framebuffer_texture_layer", ["D2 texture has no layers", OP]);
    let call = "named_framebuffer_renderbuffer";
    assert_refused(c.named_framebuffer_renderbuffer(1, Color(0), 9), call, ["9 is not a name of a renderbuffer", OP]);
    let call = "named_renderbuffer_storage";
    for (samples, format, size, words) in [
        (3, Format::R8Unorm, [4, 4], ["3 samples", value]),
        (1, Format::R8Unorm, [0, 4], ["sides are from 1", value]),
        (1, Format::Rgb9E5, [4, 4], ["cannot be drawn to", "INVALID_ENUM"]),
    ] {
        assert_refused(c.named_renderbuffer_storage(image, samples, format, size), call, words);
    }
    let call = "named_framebuffer_draw_buffers";
    assert_refused(c.named_framebuffer_draw_buffers(1, &[None; 9]), call, ["9 locations", value]);
    assert_refused(c.named_framebuffer_draw_buffers(1, &[Some(8)]), call, ["attachment 8", OP]);
    assert_refused(c.named_framebuffer_draw_buffers(1, &[Some(1), Some(1)]), call, ["two locations", OP]);
    let read = c.named_framebuffer_read_buffer(1, Some(8));
    assert_refused(read, "named_framebuffer_read_buffer", ["attachment 8", OP]);
    // A deleted renderbuffer leaves the framebuffer that is bound.
    c.named_renderbuffer_storage(image, 0, Format::R8Unorm, [4, 4]).unwrap();
    c.named_framebuffer_renderbuffer(1, Color(0), image).unwrap();
    assert_eq!(c.check_named_framebuffer_status(1).unwrap(), FramebufferStatus::Complete);
    assert!(c.is_renderbuffer(image));
    c.delete_renderbuffers(&[image]);
    assert!(!c.is_renderbuffer(image));
    assert_eq!(c.check_named_framebuffer_status(1).unwrap(), FramebufferStatus::MissingAttachment);
}
