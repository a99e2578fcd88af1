//! Kinds, parameters, clears, copies and views of textures (M189, M191).

use super::{assert_refused, context};
use crate::{
    Format, Result,
    glam::Vec4,
    objects::{AttachmentPoint, Context, FramebufferTarget, Pixels, PixelsMut, Region, TextureParameter},
    texture::{Filter, TextureKind, TextureSize, ViewRange, Wrap},
};

const OP: &str = "INVALID_OPERATION";
const ENUM: &str = "INVALID_ENUM";
const VALUE: &str = "INVALID_VALUE";

const KINDS: [TextureKind; 11] = [
    TextureKind::D1,
    TextureKind::D1Array,
    TextureKind::D2,
    TextureKind::D2Array,
    TextureKind::D3,
    TextureKind::Cube,
    TextureKind::CubeArray,
    TextureKind::Rectangle,
    TextureKind::D2Multisample,
    TextureKind::D2MultisampleArray,
    TextureKind::Buffer,
];

/// A size that the kind has, four texels wide.
fn size(kind: TextureKind) -> TextureSize {
    let height = if matches!(kind, TextureKind::D1 | TextureKind::D1Array | TextureKind::Buffer) { 1 } else { 4 };
    let depth = if kind == TextureKind::D3 { 4 } else { 1 };
    let layers = match kind {
        TextureKind::D1Array | TextureKind::D2Array | TextureKind::D2MultisampleArray => 3,
        TextureKind::Cube => 6,
        TextureKind::CubeArray => 12,
        _ => 1,
    };
    TextureSize { width: 4, height, depth, layers }
}

/// A texture of a kind with storage, bound to unit 0.
fn stored(c: &mut Context, kind: TextureKind, format: Format) -> u32 {
    let texture = c.create_textures(kind, 1).unwrap()[0];
    if kind.is_multisample() {
        c.texture_storage_multisample(texture, 4, format, size(kind)).unwrap();
    } else if kind != TextureKind::Buffer {
        c.texture_storage(texture, 1, format, size(kind)).unwrap();
    }
    c.bind_texture(0, kind, texture).unwrap();
    texture
}

/// The code of a refusal; none if the call is taken.
fn code<T>(result: &Result<T>) -> Option<&'static str> {
    let rule = &result.as_ref().err()?.rule;
    [OP, ENUM, VALUE].into_iter().find(|code| rule.ends_with(&format!("({code})")))
}

/// Each kind with each parameter (section 8.10).
#[test]
fn kinds_take_the_parameters_that_they_have() {
    use TextureParameter::*;
    let wrap = |wrap: crate::texture::Wrap| Wrap([wrap; 3]);
    // The parameter, then the codes for rectangles and for multisample textures; other kinds take them all.
    let (repeat, mirror, once) = (wrap(self::Wrap::Repeat), wrap(self::Wrap::Mirror), wrap(self::Wrap::MirrorOnce));
    for (parameter, rectangle, multisample) in [
        (BaseLevel(0), None, None),
        (BaseLevel(1), Some(OP), Some(OP)),
        (MaxLevel(3), None, None),
        (Magnify(Filter::Nearest), None, Some(ENUM)),
        (Minify(Filter::Linear, None), None, Some(ENUM)),
        (Minify(Filter::Nearest, Some(Filter::Nearest)), Some(ENUM), Some(ENUM)),
        (repeat, Some(ENUM), Some(ENUM)),
        (mirror, Some(ENUM), Some(ENUM)),
        (once, Some(ENUM), Some(ENUM)),
        (wrap(self::Wrap::ClampToEdge), None, Some(ENUM)),
        (wrap(self::Wrap::ClampToBorder), None, Some(ENUM)),
        (LodRange([0.0, 2.0]), None, Some(ENUM)),
        (LodBias(0.5), None, Some(ENUM)),
        (Border(Vec4::ONE), None, Some(ENUM)),
    ] {
        for kind in KINDS {
            let mut c = context();
            let texture = stored(&mut c, kind, Format::R8Unorm);
            let expected = match kind {
                TextureKind::Rectangle => rectangle,
                TextureKind::D2Multisample | TextureKind::D2MultisampleArray => multisample,
                TextureKind::Buffer => Some(ENUM),
                _ => None,
            };
            let result = c.texture_parameter(texture, parameter);
            assert_eq!(code(&result), expected, "{kind:?} {parameter:?} {result:?}");
        }
    }
    let mut c = context();
    let texture = stored(&mut c, TextureKind::D2, Format::R8Unorm);
    assert_refused(c.texture_parameter(texture, LodRange([1.0, 0.0])), "texture_parameter", ["from 1 to 0", VALUE]);
    assert_refused(c.texture_parameter(texture, LodBias(f32::NAN)), "texture_parameter", ["no number", VALUE]);
}

/// Each kind with each kind of storage, and each call on its texels.
#[test]
fn kinds_take_the_calls_that_they_have() {
    for kind in KINDS {
        let samples = kind.is_multisample();
        let is_buffer = kind == TextureKind::Buffer;
        let mut c = context();
        let bare = c.create_textures(kind, 3).unwrap();
        let size = size(kind);
        let levels = code(&c.texture_storage(bare[0], 2, Format::R8Unorm, size));
        let expected = match kind {
            TextureKind::Rectangle => Some(VALUE),
            _ if samples || is_buffer => Some(OP),
            _ => None,
        };
        assert_eq!(levels, expected, "{kind:?}");
        let multisample = code(&c.texture_storage_multisample(bare[1], 4, Format::R8Unorm, size));
        assert_eq!(multisample, (!samples).then_some(OP), "{kind:?}");
        let three = code(&c.texture_storage_multisample(bare[2], 3, Format::R8Unorm, size));
        assert_eq!(three, Some(if samples { VALUE } else { OP }), "{kind:?}");
        let texture = stored(&mut c, kind, Format::R8Unorm);
        let region = Region { level: 0, origin: [0; 3], size: [4, 1, 1] };
        let pixels = c.texture_sub_image(texture, region, Format::R8Unorm, Pixels::Bytes(&[1, 2, 3, 4]));
        assert_eq!(code(&pixels), (samples || is_buffer).then_some(OP), "{kind:?}");
        let read = c.get_texture_sub_image(texture, region, Format::R8Unorm, PixelsMut::Bytes(&mut [0; 4]));
        assert_eq!(code(&read), (samples || is_buffer).then_some(OP), "{kind:?}");
        let clear = c.clear_texture_sub_image(texture, region, Format::R8Unorm, &[7]);
        assert_eq!(code(&clear), is_buffer.then_some(OP), "{kind:?}");
        let levels = code(&c.generate_texture_mipmap(texture));
        assert_eq!(levels, (!kind.has_levels()).then_some(OP), "{kind:?}");
    }
}

/// Each kind with formats and filters: lookups are refused where the texture is not complete (section 8.17).
#[test]
fn integers_are_complete_without_filters() {
    for kind in KINDS {
        for (format, filter, levels) in [
            (Format::R8Unorm, Filter::Linear, None),
            (Format::R32Uint, Filter::Nearest, None),
            (Format::R32Uint, Filter::Linear, None),
            (Format::R32Sint, Filter::Nearest, Some(Filter::Linear)),
            (Format::Stencil8, Filter::Linear, None),
            (Format::Depth24, Filter::Linear, None),
        ] {
            let mut c = context();
            let texture = stored(&mut c, kind, format);
            let array = c.create_vertex_arrays(1).unwrap()[0];
            c.bind_vertex_array(array).unwrap();
            let has_filters = !kind.is_multisample() && kind != TextureKind::Buffer;
            let levels = levels.filter(|_| kind != TextureKind::Rectangle);
            if has_filters {
                c.texture_parameter(texture, TextureParameter::Magnify(filter)).unwrap();
                c.texture_parameter(texture, TextureParameter::Minify(filter, levels)).unwrap();
            }
            let averages = filter == Filter::Linear || levels == Some(Filter::Linear);
            let complete = has_filters && (!averages || matches!(format, Format::R8Unorm | Format::Depth24));
            c.draw_arrays(0..0, 0..1, |inputs, _| {
                let sampler = inputs.sampler(0, kind);
                assert_eq!(code(&sampler), (!complete).then_some(OP), "{kind:?} {format:?} {sampler:?}");
                assert_eq!(inputs.texture(0, kind).is_ok(), kind != TextureKind::Buffer);
                Ok(())
            })
            .unwrap();
        }
    }
}

/// Bytes of a region, of a format of one byte.
fn bytes(c: &Context, texture: u32, level: u32, origin: [u32; 3], size: [u32; 3]) -> Vec<u8> {
    let mut bytes = vec![0; size.iter().product::<u32>() as usize];
    let region = Region { level, origin, size };
    c.get_texture_sub_image(texture, region, Format::R8Unorm, PixelsMut::Bytes(&mut bytes)).unwrap();
    bytes
}

#[test]
fn base_and_last_level_bound_what_lookups_see() {
    let mut c = context();
    let (texture, array) = (c.create_textures(TextureKind::D2, 1).unwrap()[0], c.create_vertex_arrays(1).unwrap()[0]);
    c.texture_storage(texture, 3, Format::R8Unorm, TextureSize::d2(4, 4)).unwrap();
    for level in 0..3 {
        c.clear_texture_image(texture, level, Format::R8Unorm, &[51 * (level as u8 + 1)]).unwrap();
    }
    c.bind_texture(5, TextureKind::D2, texture).unwrap();
    c.bind_vertex_array(array).unwrap();
    for (base, max, first, count) in [(0, 1000, 0.2, 3), (1, 1, 0.4, 1), (2, 1, 0.6, 1), (7, 9, 0.6, 1)] {
        c.texture_parameter(texture, TextureParameter::BaseLevel(base)).unwrap();
        c.texture_parameter(texture, TextureParameter::MaxLevel(max)).unwrap();
        c.draw_arrays(0..0, 0..1, |inputs, _| {
            let view = inputs.texture(5, TextureKind::D2)?;
            assert_eq!((view.fetch(0, [0; 3], 0).x, view.level_count()), (first, count), "{base} {max}");
            Ok(())
        })
        .unwrap();
    }
}

#[test]
fn clears_and_copies_give_these_bytes() {
    let mut c = context();
    let a = stored(&mut c, TextureKind::D2, Format::R8Unorm);
    let b = stored(&mut c, TextureKind::D3, Format::R8Unorm);
    let numbers: Vec<u8> = (0..16).collect();
    let whole = Region { level: 0, origin: [0; 3], size: [4, 4, 1] };
    c.texture_sub_image(a, whole, Format::R8Unorm, Pixels::Bytes(&numbers)).unwrap();
    // A clear of two by two, in another format; and zeros for no pixel.
    let part = Region { level: 0, origin: [1, 1, 0], size: [2, 2, 1] };
    c.clear_texture_sub_image(a, part, Format::R32Float, &0.2f32.to_le_bytes()).unwrap();
    let cleared = [0, 1, 2, 3, 4, 51, 51, 7, 8, 51, 51, 11, 12, 13, 14, 15];
    assert_eq!(bytes(&c, a, 0, [0; 3], [4, 4, 1]), cleared);
    // From the picture to the third slice of the volume.
    c.copy_image_sub_data((a, Region { origin: [0, 1, 0], ..part }), (b, 0, [2, 2, 2])).unwrap();
    assert_eq!(bytes(&c, b, 0, [0, 2, 2], [4, 2, 1]), [0, 0, 4, 51, 0, 0, 8, 51]);
    assert_eq!(bytes(&c, b, 0, [0; 3], [4, 4, 2]), [0; 32]);
    // Within one texture, over itself.
    c.copy_image_sub_data((a, Region { size: [3, 4, 1], ..whole }), (a, 0, [1, 0, 0])).unwrap();
    assert_eq!(bytes(&c, a, 0, [0; 3], [4, 4, 1]), [0, 0, 1, 2, 4, 4, 51, 51, 8, 8, 51, 51, 12, 12, 13, 14]);
    c.clear_texture_image(a, 0, Format::R8Unorm, &[]).unwrap();
    assert_eq!(bytes(&c, a, 0, [0; 3], [4, 4, 1]), [0; 16]);
}

#[test]
fn samples_are_cleared_and_copied_together() {
    let mut c = context();
    let a = stored(&mut c, TextureKind::D2Multisample, Format::R8Unorm);
    let b = stored(&mut c, TextureKind::D2MultisampleArray, Format::R8Uint);
    let array = c.create_vertex_arrays(1).unwrap()[0];
    c.bind_vertex_array(array).unwrap();
    let part = Region { level: 0, origin: [1, 1, 0], size: [2, 2, 1] };
    c.clear_texture_sub_image(a, part, Format::R8Unorm, &[255]).unwrap();
    c.copy_image_sub_data((a, part), (b, 0, [0, 0, 2])).unwrap();
    c.draw_arrays(0..0, 0..1, |inputs, _| {
        let (a, b) =
            (inputs.texture(0, TextureKind::D2Multisample)?, inputs.texture(0, TextureKind::D2MultisampleArray)?);
        for sample in 0..4 {
            assert_eq!([0, 1, 2, 3].map(|x| a.fetch_sample([x, 1], 0, sample).x), [0.0, 1.0, 1.0, 0.0]);
            assert_eq!([0, 1, 2, 3].map(|x| b.fetch_sample([x, 1], 2, sample).x.to_bits()), [255, 255, 0, 0]);
        }
        assert_eq!(a.fetch_sample([1, 1], 0, 4), Vec4::ZERO);
        Ok(())
    })
    .unwrap();
    let single = stored(&mut c, TextureKind::D2, Format::R8Unorm);
    assert_refused(
        c.copy_image_sub_data((a, part), (single, 0, [0; 3])),
        "copy_image_sub_data",
        ["4 samples to 1", OP],
    );
}

#[test]
fn each_broken_rule_of_clears_and_copies_is_refused() {
    const CLEAR: &str = "clear_texture_sub_image";
    const COPY: &str = "copy_image_sub_data";
    let mut c = context();
    let a = stored(&mut c, TextureKind::D2, Format::R8Unorm);
    let wide = stored(&mut c, TextureKind::D2, Format::R16Unorm);
    let small = stored(&mut c, TextureKind::D2, Format::Rgb332Unorm);
    let buffer = stored(&mut c, TextureKind::Buffer, Format::R8Unorm);
    let part = Region { level: 0, origin: [1, 1, 0], size: [2, 2, 1] };
    let clear = |region, format, pixel: &[u8]| c.clear_texture_sub_image(a, region, format, pixel);
    assert_refused(clear(part, Format::R8Uint, &[0]), CLEAR, ["does not take pixels", OP]);
    assert_refused(clear(part, Format::R8Unorm, &[0, 0]), CLEAR, ["a pixel of 2 bytes", VALUE]);
    assert_refused(clear(Region { origin: [3, 0, 0], ..part }, Format::R8Unorm, &[]), CLEAR, ["not all within", VALUE]);
    let level = c.clear_texture_image(a, 1, Format::R8Unorm, &[]);
    assert_refused(level, "clear_texture_image", ["not all within", VALUE]);
    assert_refused(c.copy_image_sub_data((a, part), (99, 0, [0; 3])), COPY, ["99 is not a name", OP]);
    assert_refused(c.copy_image_sub_data((a, part), (buffer, 0, [0; 3])), COPY, ["is a Buffer", ENUM]);
    assert_refused(c.copy_image_sub_data((a, part), (wide, 0, [0; 3])), COPY, ["bits of R8Unorm", OP]);
    assert_refused(c.copy_image_sub_data((a, part), (small, 0, [0; 3])), COPY, ["bits of R8Unorm", OP]);
    assert_refused(c.copy_image_sub_data((a, part), (a, 0, [3, 0, 0])), COPY, ["not all within", VALUE]);
    assert_refused(c.copy_image_sub_data((a, part), (a, 1, [0; 3])), COPY, ["not all within", VALUE]);
}

/// A view and its original have one store: what is written to either is read from the other, in the view's format.
#[test]
fn views_share_texels() {
    let mut c = context();
    let original = c.create_textures(TextureKind::D2Array, 1).unwrap()[0];
    let size = TextureSize { layers: 4, ..TextureSize::d2(4, 4) };
    c.texture_storage(original, 3, Format::Rgba8Unorm, size).unwrap();
    let names = c.gen_textures(3).unwrap();
    let range = |kind, format, levels, layers| ViewRange { kind, format, levels, layers };
    let part = range(TextureKind::D2Array, Format::R32Uint, 1..9, 1..4);
    c.texture_view(names[0], original, part).unwrap();
    // A view of the view: levels and layers count from its first.
    let part = range(TextureKind::D2, Format::Rgba8Unorm, 1..2, 2..3);
    c.texture_view(names[1], names[0], part).unwrap();
    let texel = |level, z| Region { level, origin: [0, 0, z], size: [1, 1, 1] };
    let write = |c: &Context, name, level, z, format, bytes: &[u8]| {
        c.texture_sub_image(name, texel(level, z), format, Pixels::Bytes(bytes)).unwrap();
    };
    let read = |c: &Context, name, level, z, format| {
        let mut bytes = [0; 4];
        c.get_texture_sub_image(name, texel(level, z), format, PixelsMut::Bytes(&mut bytes)).unwrap();
        bytes
    };
    write(&c, original, 1, 2, Format::Rgba8Unorm, &[1, 2, 3, 4]);
    assert_eq!(read(&c, names[0], 0, 1, Format::R32Uint), [1, 2, 3, 4]);
    write(&c, names[1], 0, 0, Format::Rgba8Unorm, &[5, 6, 7, 8]);
    assert_eq!(read(&c, original, 2, 3, Format::Rgba8Unorm), [5, 6, 7, 8]);
    assert_eq!(read(&c, names[0], 1, 2, Format::R32Uint), [5, 6, 7, 8]);
    // Drawn through a view, seen in the original; the texels outlive the original's name.
    let framebuffer = c.create_framebuffers(1).unwrap()[0];
    c.named_framebuffer_texture(framebuffer, AttachmentPoint::Color(0), names[1], 0).unwrap();
    c.bind_framebuffer(FramebufferTarget::Both, framebuffer).unwrap();
    c.clear(Vec4::new(1.0, 0.0, 1.0, 0.0), 1.0, 0).unwrap();
    assert_eq!(read(&c, original, 2, 3, Format::Rgba8Unorm), [255, 0, 255, 0]);
    c.delete_textures(&[original]);
    assert_eq!(read(&c, names[0], 1, 2, Format::R32Uint), [255, 0, 255, 0]);
    assert_eq!(read(&c, names[0], 0, 1, Format::R32Uint), [1, 2, 3, 4]);
}

#[test]
fn each_broken_rule_of_views_is_refused() {
    const CALL: &str = "texture_view";
    let mut c = context();
    let original = stored(&mut c, TextureKind::D2Array, Format::Rgba8Unorm);
    let bare = c.create_textures(TextureKind::D2, 1).unwrap()[0];
    let name = c.gen_textures(1).unwrap()[0];
    let good = ViewRange { kind: TextureKind::D2, format: Format::R32Uint, levels: 0..1, layers: 2..3 };
    let with = |change: &dyn Fn(&mut ViewRange)| {
        let mut range = good.clone();
        change(&mut range);
        c.texture_view(name, original, range)
    };
    assert_refused(with(&|range| range.format = Format::R16Uint), CALL, ["cannot be seen as R16Uint", OP]);
    assert_refused(with(&|range| range.format = Format::Depth32Float), CALL, ["seen as Depth32Float", OP]);
    for kind in [TextureKind::D3, TextureKind::D1, TextureKind::Rectangle, TextureKind::D2Multisample] {
        assert_refused(with(&|range| range.kind = kind), CALL, ["texture cannot be seen as", OP]);
    }
    assert_refused(with(&|range| range.kind = TextureKind::Buffer), CALL, ["no views", OP]);
    assert_refused(with(&|range| range.kind = TextureKind::Cube), CALL, ["no size of a Cube", VALUE]);
    assert_refused(with(&|range| range.levels = 1..2), CALL, ["not all there", VALUE]);
    assert_refused(with(&|range| range.layers = 2..4), CALL, ["not all there", VALUE]);
    assert_refused(with(&|range| range.layers = 1..3), CALL, ["no size of a D2 ", VALUE]);
    assert_refused(c.texture_view(bare, original, good.clone()), CALL, ["has its object already", OP]);
    assert_refused(c.texture_view(name, bare, good.clone()), CALL, ["no storage", OP]);
    assert_refused(c.texture_view(77, original, good.clone()), CALL, ["not a generated name", OP]);
    assert!(!c.is_texture(name));
    c.texture_view(name, original, good).unwrap();
    assert_refused(c.generate_texture_mipmap(name), "generate_texture_mipmap", ["a view of a part", OP]);
}
