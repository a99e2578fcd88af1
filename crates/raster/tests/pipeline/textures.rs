//! Textures, views and samplers (M189, M191, M192, M202).

use crate::stage::Random;
use steradian_raster::{
    Format,
    glam::{Vec3, Vec4},
    state::Compare,
    texture::{Filter, Lod, Sampler, Texture, TextureBuilder, TextureKind, TextureSize, ViewRange, Wrap},
};

const KINDS: [TextureKind; 9] = [
    TextureKind::D1,
    TextureKind::D1Array,
    TextureKind::D2,
    TextureKind::D2Array,
    TextureKind::D3,
    TextureKind::Cube,
    TextureKind::CubeArray,
    TextureKind::Buffer,
    TextureKind::Rectangle,
];

/// Which sizes which kinds have: width, height, depth, layers.
#[test]
fn kinds_and_sizes() {
    for (size, fit) in [
        ([16, 1, 1, 1], [true, true, true, true, true, false, false, true, true]),
        ([16, 1, 1, 5], [false, true, false, true, false, false, false, false, false]),
        ([16, 8, 1, 1], [false, false, true, true, true, false, false, false, true]),
        ([16, 8, 1, 6], [false, false, false, true, false, false, false, false, false]),
        ([16, 16, 1, 6], [false, false, false, true, false, true, true, false, false]),
        ([16, 16, 1, 12], [false, false, false, true, false, false, true, false, false]),
        ([16, 16, 4, 1], [false, false, false, false, true, false, false, false, false]),
        ([16, 16, 4, 6], [false; 9]),
        ([0, 1, 1, 1], [false; 9]),
        ([17000, 1, 1, 1], [false, false, false, false, false, false, false, true, false]),
    ] {
        let [width, height, depth, layers] = size;
        let size = TextureSize { width, height, depth, layers };
        for (kind, fits) in KINDS.into_iter().zip(fit) {
            assert_eq!(Texture::new(kind, Format::R8Unorm, size, 1).is_ok(), fits, "{kind:?} {size:?}");
        }
    }
    assert!(Texture::new(TextureKind::D2, Format::R8Unorm, TextureSize::d2(16, 5), 5).is_ok());
    assert!(Texture::new(TextureKind::D2, Format::R8Unorm, TextureSize::d2(16, 5), 6).is_err());
    // Rectangles have one level, and samples one.
    assert!(Texture::new(TextureKind::Rectangle, Format::R8Unorm, TextureSize::d2(16, 5), 2).is_err());
    for (kind, layers, samples, fits) in [
        (TextureKind::D2Multisample, 1, 4, true),
        (TextureKind::D2Multisample, 2, 4, false),
        (TextureKind::D2MultisampleArray, 2, 8, true),
        (TextureKind::D2MultisampleArray, 2, 3, false),
        (TextureKind::D2, 1, 4, false),
    ] {
        let texture =
            Texture::multisample(kind, Format::R8Unorm, TextureSize { layers, ..TextureSize::d2(5, 3) }, samples);
        assert_eq!(texture.is_ok(), fits, "{kind:?} {layers} {samples}");
    }
    assert!(Texture::new(TextureKind::D2Multisample, Format::R8Unorm, TextureSize::d2(16, 5), 1).is_err());
}

/// A rectangle at texels has the bits of a picture at their shares of the size, which is a power of two.
#[test]
fn rectangles_are_looked_up_by_texels() {
    let mut random = Random(7);
    let colors: Vec<Vec4> = (0..32 * 16).map(|_| Vec4::splat(random.unit())).collect();
    let picture = Texture::from_colors(Format::Rgba32Float, 32, 16, &colors, false).unwrap();
    let mut rectangle = Texture::new(TextureKind::Rectangle, Format::Rgba32Float, TextureSize::d2(32, 16), 1).unwrap();
    rectangle.level_mut(0).unwrap().copy_from_slice(picture.level(0).unwrap());
    for filter in [Filter::Nearest, Filter::Linear] {
        let sampler = Sampler { magnify: filter, minify: filter, ..Sampler::NEAREST };
        sampler.check(&rectangle.view()).unwrap();
        for _ in 0..500 {
            let at = Vec3::new(40.0 * random.unit() - 4.0, 20.0 * random.unit() - 2.0, 0.0);
            let share = at / Vec3::new(32.0, 16.0, 1.0);
            let (dx, scaled) = (Vec3::X * 3.0, Vec3::X * 3.0 / 32.0);
            let found = sampler.sample(&rectangle.view(), at.extend(0.0), Lod::Gradients(dx, dx));
            let expected = sampler.sample(&picture.view(), share.extend(0.0), Lod::Gradients(scaled, scaled));
            assert_eq!(found, expected, "{at}");
        }
    }
    let refused = |sampler: Sampler| sampler.check(&rectangle.view()).is_err();
    assert!(refused(Sampler { wrap: [Wrap::Repeat; 3], ..Sampler::NEAREST }));
    assert!(refused(Sampler { wrap: [Wrap::ClampToEdge, Wrap::Mirror, Wrap::Repeat], ..Sampler::NEAREST }));
    assert!(refused(Sampler { levels: Some(Filter::Nearest), ..Sampler::NEAREST }));
}

#[test]
fn completeness() {
    let size = TextureSize::d2(5, 2);
    let level = |b: TextureBuilder, n: u32, w: u32, h: u32| {
        b.level(n, Format::R8Unorm, TextureSize::d2(w, h), &vec![0; (w * h) as usize])
    };
    let new = || TextureBuilder::new(TextureKind::D2);
    let whole = level(level(level(new(), 0, 5, 2), 1, 2, 1), 2, 1, 1);
    assert_eq!(whole.clone().finish(true).unwrap().level_count(), 3);
    let rule = |b: TextureBuilder, mipmapped| b.finish(mipmapped).err().map_or(String::new(), |e| e.rule);
    assert!(rule(new(), false).contains("level 0, the base, is not there"));
    assert!(rule(level(new(), 0, 5, 2), true).contains("level 1 is not there"));
    assert_eq!(rule(level(new(), 0, 5, 2), false), "");
    assert!(rule(level(whole.clone(), 1, 3, 1), true).contains("level 1 is"));
    let other = whole.clone().level(2, Format::R8Uint, TextureSize::d2(1, 1), &[0]);
    assert!(rule(other.clone(), true).contains("R8Uint, the base R8Unorm"));
    // A level beyond the range does not count; a base other than 0 does.
    assert_eq!(rule(other.range(0, 1), true), "");
    assert_eq!(whole.clone().range(1, 9).finish(true).unwrap().size(), TextureSize::d2(2, 1));
    assert!(rule(new().level(0, Format::R8Unorm, size, &[0; 9]), false).contains("9 bytes, not 10"));
    let cube =
        TextureBuilder::new(TextureKind::Cube).level(0, Format::R8Unorm, TextureSize { layers: 6, ..size }, &[0; 60]);
    assert!(rule(cube, false).contains("no size of a Cube"));
}

#[test]
fn views_reinterpret() {
    let size = TextureSize { width: 4, height: 4, depth: 1, layers: 12 };
    let mut texture = Texture::new(TextureKind::D2Array, Format::R32Float, size, 3).unwrap();
    texture.set(1, [1, 0, 0], 7, Vec4::splat(1.0));
    let view = |kind, format, levels, layers| texture.view_of(ViewRange { kind, format, levels, layers });
    let bits = view(TextureKind::D2, Format::R32Uint, 1..3, 7..8).unwrap();
    assert_eq!(bits.fetch(0, [1, 0, 0], 0).x.to_bits(), 0x3f80_0000);
    assert_eq!(bits.fetch(0, [2, 0, 0], 0), Vec4::ZERO);
    let bytes = view(TextureKind::Cube, Format::Rgba8Uint, 1..2, 6..12).unwrap();
    assert_eq!(bytes.fetch(0, [1, 0, 0], 1).to_array().map(f32::to_bits), [0, 0, 0x80, 0x3f]);
    for (kind, format, levels, layers) in [
        (TextureKind::D2, Format::R32Float, 0..4, 0..1),
        (TextureKind::D2, Format::R32Float, 0..1, 12..13),
        (TextureKind::D2, Format::R32Float, 0..1, 0..2),
        (TextureKind::Cube, Format::R32Float, 0..1, 0..5),
        (TextureKind::D3, Format::R32Float, 0..1, 0..1),
        (TextureKind::D2, Format::Rg32Float, 0..1, 0..1),
        (TextureKind::D2, Format::Depth32Float, 0..1, 0..1),
    ] {
        assert!(
            view(kind, format, levels.clone(), layers.clone()).is_err(),
            "{kind:?} {format:?} {levels:?} {layers:?}"
        );
    }
}

fn ramp() -> Texture {
    let colors: Vec<Vec4> = (0..4).map(|i| Vec4::splat(i as f32)).collect();
    Texture::from_colors(Format::R32Float, 4, 1, &colors, false).unwrap()
}

/// Texel by number beyond both ends, from the specification's formulas.
#[test]
fn wrapping() {
    let texture = ramp();
    for (wrap, expected) in [
        (Wrap::Repeat, [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0]),
        (Wrap::Mirror, [3.0, 2.0, 1.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 2.0, 1.0, 0.0]),
        (Wrap::MirrorOnce, [3.0, 2.0, 1.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0]),
        (Wrap::ClampToEdge, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0]),
        (Wrap::ClampToBorder, [7.0, 7.0, 7.0, 7.0, 0.0, 1.0, 2.0, 3.0, 7.0, 7.0, 7.0, 7.0]),
    ] {
        let sampler = Sampler { wrap: [wrap; 3], border: Vec4::splat(7.0), ..Sampler::NEAREST };
        for (i, expected) in expected.into_iter().enumerate() {
            let s = (i as f32 - 4.0 + 0.5) / 4.0;
            assert_eq!(
                sampler.sample(&texture.view(), Vec4::new(s, 0.5, 0.0, 0.0), Lod::Level(0.0)).x,
                expected,
                "{wrap:?} {s}"
            );
        }
    }
    // Coordinates of any kind.
    for s in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30] {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::MirrorOnce, Wrap::ClampToEdge, Wrap::ClampToBorder] {
            for magnify in [Filter::Nearest, Filter::Linear] {
                let sampler = Sampler { wrap: [wrap; 3], magnify, ..Sampler::default() };
                let lod = Lod::Gradients(Vec3::splat(s), Vec3::ZERO);
                assert!(sampler.sample(&texture.view(), Vec4::splat(s), lod).is_finite());
            }
        }
    }
}

/// A ramp is a ramp between the centres of texels: the weights belong to the far end, texel centres are at halves
/// (E37).
#[test]
fn linear_filters_keep_ramps() {
    let texture = ramp();
    let sampler = Sampler { wrap: [Wrap::ClampToEdge; 3], ..Sampler::default() };
    for i in 0..=300 {
        let u = 0.5 + 3.0 * i as f32 / 300.0;
        let found = sampler.sample(&texture.view(), Vec4::new(u / 4.0, 0.5, 0.0, 0.0), Lod::Level(0.0)).x;
        assert!((found - (u - 0.5)).abs() < 1e-6);
    }
    // In a volume: three ramps at once.
    let size = TextureSize { width: 3, height: 4, depth: 5, layers: 1 };
    let mut volume = Texture::new(TextureKind::D3, Format::R32Float, size, 1).unwrap();
    for (x, y, z) in (0..3).flat_map(|x| (0..4).flat_map(move |y| (0..5).map(move |z| (x, y, z)))) {
        volume.set(0, [x, y, z], 0, Vec4::splat((x + 10 * y + 100 * z) as f32));
    }
    let at = Vec4::new(1.75 / 3.0, 2.25 / 4.0, 3.5 / 5.0, 0.0);
    let found = sampler.sample(&volume.view(), at, Lod::Level(0.0)).x;
    assert!((found - (1.25 + 17.5 + 300.0)).abs() < 1e-3, "{found}");
}

/// Levels: λ is the logarithm of the larger change in texels; between levels colours are linear; each level is a mean.
#[test]
fn levels_of_detail() {
    // Levels with their number as colour.
    let mut texture = Texture::new(TextureKind::D2, Format::R32Float, TextureSize::d2(64, 32), 7).unwrap();
    for level in 0..7 {
        let size = texture.size().level(level);
        for (x, y) in (0..size.width).flat_map(|x| (0..size.height).map(move |y| (x, y))) {
            texture.set(level, [x, y, 0], 0, Vec4::splat(level as f32));
        }
    }
    let view = texture.view();
    let sampler = Sampler::default();
    let at = Vec4::new(0.3, 0.7, 0.0, 0.0);
    let gradients = |x: f32, y: f32| Lod::Gradients(Vec3::new(x / 64.0, 0.0, 0.0), Vec3::new(0.0, y / 32.0, 0.0));
    for (lod, expected) in [
        (Lod::Level(2.25), 2.25),
        (Lod::Level(-3.0), 0.0),
        (Lod::Level(99.0), 6.0),
        (Lod::Level(f32::NAN), 0.0),
        (gradients(4.0, 2.0), 2.0),
        (gradients(1.0, 8.0), 3.0),
        (gradients(3.0, 0.0), 3f32.log2()),
        (gradients(0.1, 0.2), 0.0),
        (gradients(0.0, 0.0), 0.0),
    ] {
        assert!((sampler.sample(&view, at, lod).x - expected).abs() < 1e-5, "{lod:?}");
    }
    let nearest = Sampler { levels: Some(Filter::Nearest), ..sampler };
    assert_eq!(
        [0.4, 0.5, 0.6, 1.5, 1.6, 9.0].map(|l| nearest.sample(&view, at, Lod::Level(l)).x),
        [0.0, 0.0, 1.0, 1.0, 2.0, 6.0]
    );
    let limited = Sampler { lod_range: [1.5, 2.5], lod_bias: 1.0, ..sampler };
    assert_eq!([0.0, 1.0, 5.0].map(|l| limited.sample(&view, at, Lod::Level(l)).x), [1.5, 2.0, 2.5]);
    // A footprint 8 times as long as wide: with 4 samples along it level 1, with 16 level 0.
    let anisotropic = |anisotropy| Sampler { anisotropy, ..sampler }.sample(&view, at, gradients(8.0, 1.0)).x;
    assert!((anisotropic(4) - 1.0).abs() < 1e-5 && anisotropic(16).abs() < 1e-5);
    // Means, also of odd sizes: what is there in all is kept.
    let mut random = Random(8);
    let colors: Vec<Vec4> = (0..13 * 7).map(|_| Vec4::splat(random.unit())).collect();
    let mean = colors.iter().map(|c| c.x).sum::<f32>() / 91.0;
    let texture = Texture::from_colors(Format::R32Float, 13, 7, &colors, true).unwrap();
    assert_eq!(texture.level_count(), 4);
    assert!((texture.view().fetch(3, [0; 3], 0).x - mean).abs() < 1e-5);
}

/// Comparisons are made before they are averaged.
#[test]
fn comparisons() {
    let texture = ramp();
    let sampler = Sampler { wrap: [Wrap::ClampToEdge; 3], ..Sampler::default() };
    let compare = |compare, reference, u: f32| {
        Sampler { compare, ..sampler }.compare(
            &texture.view(),
            Vec4::new(u / 4.0, 0.5, 0.0, 0.0),
            reference,
            Lod::Level(0.0),
        )
    };
    // Between texels 1 and 2, a quarter of the way.
    assert_eq!(compare(Compare::LessEqual, 1.5, 1.75), 0.25);
    assert_eq!(compare(Compare::LessEqual, 1.0, 1.75), 1.0);
    assert_eq!(compare(Compare::Greater, 1.5, 1.75), 0.75);
    assert_eq!(compare(Compare::Never, 1.5, 1.75), 0.0);
}

/// Cubes: a function of direction is found again, without seams at edges and corners.
#[test]
fn cubes_have_no_seams() {
    let n = 32;
    let size = TextureSize { width: n, height: n, depth: 1, layers: 6 };
    let mut cube = Texture::new(TextureKind::Cube, Format::Rgba32Float, size, 1).unwrap();
    let direction = |face: u32, s: f32, t: f32| match face {
        0 => Vec3::new(1.0, -t, -s),
        1 => Vec3::new(-1.0, -t, s),
        2 => Vec3::new(s, 1.0, t),
        3 => Vec3::new(s, -1.0, -t),
        4 => Vec3::new(s, -t, 1.0),
        _ => Vec3::new(-s, -t, -1.0),
    };
    for (face, x, y) in (0..6).flat_map(|f| (0..n).flat_map(move |x| (0..n).map(move |y| (f, x, y)))) {
        let at = |i: u32| (i as f32 + 0.5) / n as f32 * 2.0 - 1.0;
        cube.set(0, [x, y, 0], face, direction(face, at(x), at(y)).normalize().extend(1.0));
    }
    let sampler = Sampler::default();
    sampler.check(&cube.view()).unwrap();
    let mut random = Random(6);
    for i in 0..5000 {
        let mut d = Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        if i % 2 == 0 {
            // Near an edge.
            d.x = d.y.signum() * d.y.abs() * random.between(0.99, 1.01);
        }
        if d.length() < 0.1 {
            continue;
        }
        let found = sampler.sample(&cube.view(), d.extend(0.0), Lod::Level(0.0)).truncate();
        // Half a texel of the middle of a face is 1/32 of its half; at borders a neighbour's nearest texel stands in.
        assert!((found - d.normalize()).length() < 0.05, "{d} {found}");
    }
}

#[test]
fn samplers_are_checked() {
    let texture = Texture::new(TextureKind::D2, Format::R8Uint, TextureSize::d2(4, 4), 1).unwrap();
    assert!(Sampler::default().check(&texture.view()).unwrap_err().rule.contains("R8Uint cannot be averaged"));
    assert!(Sampler::NEAREST.check(&texture.view()).is_ok());
    let bad = Sampler { lod_range: [2.0, 1.0], ..Sampler::NEAREST };
    assert!(bad.check(&texture.view()).is_err());
    assert!(Sampler { anisotropy: 0, ..Sampler::NEAREST }.check(&texture.view()).is_err());
    let buffer = Texture::new(TextureKind::Buffer, Format::R8Unorm, TextureSize::d2(4, 1), 1).unwrap();
    assert!(Sampler::NEAREST.check(&buffer.view()).is_err());
    assert!(Texture::from_colors(Format::R8Uint, 2, 2, &[Vec4::ZERO; 4], true).is_err());
    assert!(Texture::from_colors(Format::R8Unorm, 2, 2, &[Vec4::ZERO; 3], false).is_err());
}
