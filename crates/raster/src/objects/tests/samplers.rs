//! Sampler objects.

use super::{assert_refused, context, context_of};
use crate::{
    Format, Result,
    glam::Vec4,
    objects::{Context, Pixels, Region, ShareGroup, TextureParameter},
    state::Compare,
    texture::{Filter, Lod, Sampler, TextureKind, TextureSize, TextureView, Wrap},
};

const OP: &str = "INVALID_OPERATION";
const VALUE: &str = "INVALID_VALUE";

/// A texture of the texels 0 and 1 that is bound to units 0 and 1, with filters Nearest.
fn prepare(c: &mut Context) -> u32 {
    let texture = c.create_textures(TextureKind::D2, 1).unwrap()[0];
    c.texture_storage(texture, 1, Format::R8Unorm, TextureSize::d2(2, 1)).unwrap();
    let region = Region { level: 0, origin: [0; 3], size: [2, 1, 1] };
    c.texture_sub_image(texture, region, Format::R8Unorm, Pixels::Bytes(&[0, 255])).unwrap();
    c.texture_parameter(texture, TextureParameter::Magnify(Filter::Nearest)).unwrap();
    for unit in [0, 1] {
        c.bind_texture(unit, TextureKind::D2, texture).unwrap();
    }
    texture
}

/// Runs a lookup in the texture of a kind that is bound to a unit.
fn look(c: &mut Context, unit: u32, kind: TextureKind, look: impl Fn(&TextureView, Sampler) -> f32) -> Result<f32> {
    let mut value = 0.0;
    c.dispatch_compute([1; 3], |inputs, _| {
        let (view, sampler) = inputs.sampler(unit, kind)?;
        value = look(&view, sampler);
        Ok(())
    })?;
    Ok(value)
}

/// The value at a coordinate of the texture of a unit.
fn at(c: &mut Context, unit: u32, s: f32) -> f32 {
    let sample =
        |view: &TextureView, sampler: Sampler| sampler.sample(view, Vec4::new(s, 0.5, 0.0, 0.0), Lod::Level(0.0)).x;
    look(c, unit, TextureKind::D2, sample).unwrap()
}

#[test]
fn a_sampler_overrides_the_texture_while_it_is_bound() {
    let mut c = context();
    prepare(&mut c);
    let name = c.gen_samplers(1).unwrap()[0];
    assert!(!c.is_sampler(name));
    c.bind_sampler(1, name).unwrap();
    assert!(c.is_sampler(name));
    // Magnified linearly at first, and repeated: half-way between the texels, a quarter of the way, and at the seam.
    let places = [0.5, 0.375, 1.0, 0.25];
    assert_eq!(places.map(|s| at(&mut c, 1, s)), [0.5, 0.25, 0.5, 0.0]);
    assert_eq!(places.map(|s| at(&mut c, 0, s)), [1.0, 0.0, 0.0, 0.0]);
    // Later parameters count.
    c.sampler_parameter(name, TextureParameter::Wrap([Wrap::ClampToBorder; 3])).unwrap();
    c.sampler_parameter(name, TextureParameter::Border(Vec4::splat(0.5))).unwrap();
    assert_eq!(places.map(|s| at(&mut c, 1, s)), [0.5, 0.25, 0.75, 0.0]);
    c.sampler_parameter(name, TextureParameter::Magnify(Filter::Nearest)).unwrap();
    assert_eq!([0.25, 0.75, 1.25].map(|s| at(&mut c, 1, s)), [0.0, 1.0, 0.5]);
    c.bind_sampler(1, 0).unwrap();
    assert_eq!([0.25, 0.75, 1.25].map(|s| at(&mut c, 1, s)), [0.0, 1.0, 0.0]);
}

/// Levels 0 and 1 of the values 0 and 1: bias and range of the level of detail, and the filter between levels.
#[test]
fn levels_and_comparisons_are_those_of_the_sampler() {
    let mut c = context();
    let [colors, depths] = [Format::R8Unorm, Format::Depth32Float].map(|format| {
        let texture = c.create_textures(TextureKind::D2, 1).unwrap()[0];
        c.texture_storage(texture, 2, format, TextureSize::d2(2, 2)).unwrap();
        texture
    });
    c.clear_texture_image(colors, 1, Format::R8Unorm, &[255]).unwrap();
    c.clear_texture_image(depths, 0, Format::Depth32Float, &0.5_f32.to_le_bytes()).unwrap();
    c.bind_texture(0, TextureKind::D2, colors).unwrap();
    let name = c.create_samplers(1).unwrap()[0];
    c.bind_sampler(0, name).unwrap();
    let level = |c: &mut Context| {
        let sample = |view: &TextureView, sampler: Sampler| sampler.sample(view, Vec4::splat(0.5), Lod::Level(0.25)).x;
        look(c, 0, TextureKind::D2, sample).unwrap()
    };
    assert_eq!(level(&mut c), 0.25);
    for (parameter, value) in [
        (TextureParameter::LodBias(0.5), 0.75),
        (TextureParameter::LodRange([-1.0, 0.5]), 0.5),
        (TextureParameter::Minify(Filter::Nearest, None), 0.0),
        (TextureParameter::LodRange([1.0, 1.0]), 0.0),
        (TextureParameter::Minify(Filter::Nearest, Some(Filter::Nearest)), 1.0),
    ] {
        c.sampler_parameter(name, parameter).unwrap();
        assert_eq!(level(&mut c), value, "{parameter:?}");
    }
    // Depths of ½ at level 0; a texture has a comparison of its own.
    c.bind_texture(0, TextureKind::D2, depths).unwrap();
    c.sampler_parameter(name, TextureParameter::LodRange([0.0, 0.0])).unwrap();
    c.texture_parameter(depths, TextureParameter::Compare(Compare::Greater)).unwrap();
    let passes = |c: &mut Context| {
        [0.25, 0.5, 0.75].map(|reference| {
            let compare = |view: &TextureView, sampler: Sampler| {
                sampler.compare(view, Vec4::splat(0.5), reference, Lod::Level(0.0))
            };
            look(c, 0, TextureKind::D2, compare).unwrap()
        })
    };
    assert_eq!(passes(&mut c), [1.0, 1.0, 0.0]);
    c.sampler_parameter(name, TextureParameter::Compare(Compare::Less)).unwrap();
    assert_eq!(passes(&mut c), [1.0, 0.0, 0.0]);
    c.bind_sampler(0, 0).unwrap();
    assert_eq!(passes(&mut c), [0.0, 0.0, 1.0]);
}

/// Samplers are shared; deletion resets the units of the context that deletes.
#[test]
fn a_deleted_sampler_lives_where_another_context_has_it_bound() {
    let group = ShareGroup::new();
    let (mut a, mut b) = (context_of(&group), context_of(&group));
    prepare(&mut a);
    prepare(&mut b);
    let names = a.create_samplers(2).unwrap();
    for context in [&mut a, &mut b] {
        context.bind_sampler(0, names[0]).unwrap();
        context.bind_sampler(1, names[1]).unwrap();
    }
    assert_eq!([at(&mut a, 0, 0.5), at(&mut b, 0, 0.5)], [0.5, 0.5]);
    a.delete_samplers(&[0, names[0], 99]);
    assert!(!b.is_sampler(names[0]));
    assert_eq!([at(&mut a, 0, 0.5), at(&mut b, 0, 0.5), at(&mut a, 1, 0.5)], [1.0, 0.5, 0.5]);
    let call = "bind_sampler";
    assert_refused(a.bind_sampler(0, names[0]), call, ["is not a generated name of a sampler", OP]);
    b.bind_sampler(0, 0).unwrap();
    assert_eq!(at(&mut b, 0, 0.5), 1.0);
}

#[test]
fn each_broken_rule_of_samplers_is_refused() {
    let mut c = context();
    let (name, reserved) = (c.create_samplers(1).unwrap()[0], c.gen_samplers(1).unwrap()[0]);
    assert_refused(c.gen_samplers(usize::MAX), "gen_samplers", ["at most", VALUE]);
    assert_refused(c.create_samplers(usize::MAX), "create_samplers", ["at most", VALUE]);
    assert_refused(c.bind_sampler(80, name), "bind_sampler", ["unit 80", VALUE]);
    assert_refused(c.bind_sampler(0, 7), "bind_sampler", ["7 is not a generated name of a sampler", OP]);
    let magnify = TextureParameter::Magnify(Filter::Nearest);
    let call = "sampler_parameter";
    assert_refused(c.sampler_parameter(7, magnify), call, ["7 is not a name of a sampler", OP]);
    assert_refused(c.sampler_parameter(reserved, magnify), call, ["reserved name without an object", OP]);
    for (parameter, words) in [
        (TextureParameter::BaseLevel(0), ["BaseLevel(0), which a sampler does not have", "INVALID_ENUM"]),
        (TextureParameter::MaxLevel(3), ["MaxLevel(3), which a sampler does not have", "INVALID_ENUM"]),
        (TextureParameter::LodRange([1.0, 0.0]), ["from 1 to 0", VALUE]),
        (TextureParameter::LodRange([0.0, f32::NAN]), ["from 0 to NaN", VALUE]),
        (TextureParameter::LodBias(f32::NAN), ["the bias is no number", VALUE]),
    ] {
        assert_refused(c.sampler_parameter(name, parameter), call, words);
    }
    // Textures are complete or not with the sampler that is bound.
    for (kind, format, words) in [
        (TextureKind::D2, Format::R8Uint, ["the filters must be Nearest", OP]),
        (TextureKind::Rectangle, Format::R8Unorm, ["rectangles have one level", OP]),
    ] {
        let texture = c.create_textures(kind, 1).unwrap()[0];
        c.texture_storage(texture, 1, format, TextureSize::d2(4, 4)).unwrap();
        c.bind_texture(2, kind, texture).unwrap();
        c.bind_sampler(2, name).unwrap();
        assert_refused(look(&mut c, 2, kind, |_, _| 0.0), "Inputs::sampler", words);
        if kind == TextureKind::Rectangle {
            c.bind_sampler(2, 0).unwrap();
            assert_eq!(look(&mut c, 2, kind, |_, _| 1.0).unwrap(), 1.0);
        }
    }
}
