//! Lookups of pictures against values worked out by hand, polynomials, and brute force.

use super::{
    Filter, ImageTexture, Mapping, TextureContext, Wrap,
    filter::{FILTERS, Source, level_of},
    kernel::{Cubic, MipKernel},
    levels::{Levels, Recipe, Shape},
    mapping::Coordinates2,
    pages::Pages,
    store::Level,
    summed::SummedArea,
    wrap::BLACK,
};
use std::sync::Arc;
use steradian_image::{Encoding, TexelData, Texels};
use steradian_math::{Vec2, Vec3};

const WRAPS: [Wrap; 5] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Border, Wrap::Octahedral];

fn picture(width: usize, height: usize, channels: usize, data: TexelData, encoding: Encoding) -> Level {
    let texels = Texels { width, height, channels, data, encoding, metadata: Default::default() };
    Level::new(Arc::new(texels), None).unwrap()
}

fn grey(width: usize, height: usize, value: impl Fn(f32, f32) -> f32) -> Level {
    let at = |i: usize| value((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
    picture(width, height, 1, TexelData::F32((0..width * height).map(at).collect()), Encoding::Linear)
}

fn recipe(filter: Filter, wrap: Wrap) -> Recipe {
    let shape = match filter {
        Filter::Trilinear | Filter::Ewa(_) => Shape::Mip,
        Filter::Ripmap => Shape::Rip,
        _ => Shape::Flat,
    };
    Recipe { shape, kernel: MipKernel::Box, wrap: [wrap; 2], keep_coverage: None, bleed: false }
}

fn texture(base: Level, filter: Filter, wrap: Wrap) -> ImageTexture {
    let levels = Levels::new(base, &recipe(filter, wrap), None).unwrap();
    ImageTexture {
        sums: Some(Arc::new(SummedArea::new(levels.base()))),
        levels: Arc::new(levels),
        filter,
        stochastic: false,
        wrap: [wrap; 2],
        borders: BLACK,
        channel: None,
        origin_bottom: false,
        scale: 1.0,
        invert: false,
        mapping: Mapping::default(),
    }
}

fn at(u: f32, v: f32) -> TextureContext<'static> {
    TextureContext::new(Vec3::ZERO, Vec2::new(u, v))
}

fn over(u: f32, v: f32, dx: Vec2, dy: Vec2) -> TextureContext<'static> {
    let mut at = at(u, v);
    (at.footprint.duvdx, at.footprint.duvdy) = (dx, dy);
    at
}

/// Beyond a border each filter sees its colour, that of the sides before that of top and bottom, and mixes it with the
/// picture at the edge.
#[test]
fn borders_have_their_colours() {
    // The periodic sinc is for pictures that repeat.
    for (name, filter) in FILTERS.into_iter().filter(|f| f.1 != Filter::Sinc) {
        for stochastic in [false, true] {
            let mut t = texture(grey(64, 64, |_, _| 0.25), filter, Wrap::Border);
            (t.borders, t.stochastic) = ([[0.5, 0.0, 0.0, 0.0], [0.75, 0.0, 0.0, 0.0]], stochastic);
            let d = Vec2::splat(0.01);
            let seen = |u, v| t.float(&over(u, v, d, Vec2::new(d.x, -d.y)));
            // Weights are of no more than rounding, or of equal magnitude for negative lobes.
            let close = |u, v, wanted: f32| {
                let negative = stochastic && matches!(filter, Filter::Bicubic(_) | Filter::Lanczos | Filter::Spline);
                let seen = seen(u, v);
                assert!(negative || (seen - wanted).abs() < 1e-4, "{name} {stochastic} at {u} {v}: {seen}");
            };
            close(-3.0, 0.5, 0.5);
            close(0.5, 4.0, 0.75);
            close(-3.0, 4.0, 0.5);
            close(0.5, 0.5, 0.25);
        }
        let mut t = texture(grey(64, 64, |_, _| 0.25), filter, Wrap::Border);
        t.borders = [[0.75, 0.0, 0.0, 0.0]; 2];
        let middle = t.float(&over(0.0, 0.5, Vec2::new(0.2, 0.0), Vec2::new(0.0, 0.2)));
        let wanted = if filter == Filter::Nearest { 0.25 } else { 0.5 };
        assert!((middle - wanted).abs() < 1e-3, "{name}: {middle}");
    }
}

/// Across the edge of an octahedral map all filters see the other half of the edge, as pbrt-v4's `octahedralsphere` has
/// it.
#[test]
fn octahedral_edges_are_joined() {
    // A function of the direction: no filter may see a step at the edge.
    let n = 64;
    let value = |x: f32, y: f32| {
        let d = steradian_math::warp::equal_area_square_to_sphere(Vec2::new(x, y) / n as f32);
        0.5 + 0.3 * d.x + 0.2 * d.y
    };
    for (name, filter) in FILTERS.into_iter().filter(|f| !matches!(f.1, Filter::Box | Filter::Sinc)) {
        let t = texture(grey(n, n, value), filter, Wrap::Octahedral);
        let seen = |u, v| t.float(&over(u, v, Vec2::new(0.01, 0.0), Vec2::new(0.0, 0.01)));
        for k in 1..30 {
            let (v, e) = (k as f32 / 30.0 + 0.003, 0.004);
            for (a, b) in [((-e, v), (e, 1.0 - v)), ((1.0 + e, v), (1.0 - e, 1.0 - v)), ((v, -e), (1.0 - v, e))] {
                let (a, b) = (seen(a.0, a.1), seen(b.0, b.1));
                assert!((a - b).abs() < 1e-5, "{name} {k}: {a} {b}");
            }
            let (here, there) = (seen(e, v), seen(-e, v));
            assert!((here - there).abs() < 0.03, "{name} {k}: {here} {there}");
        }
    }
}

/// M202, E37: texel centres are at halves; the weight of a texel is what is left to the other one; at u = 1 the nearest
/// is the last.
#[test]
fn half_texel_conventions() {
    let two_by_two = |filter, wrap| {
        texture(picture(2, 2, 1, TexelData::F32(vec![0.0, 1.0, 2.0, 4.0]), Encoding::Linear), filter, wrap)
    };
    let t = two_by_two(Filter::Bilinear, Wrap::Clamp);
    for ((u, v), value) in
        [((0.25, 0.25), 0.0), ((0.75, 0.25), 1.0), ((0.5, 0.5), 1.75), ((0.5, 0.25), 0.5), ((1.0, 1.0), 4.0)]
    {
        assert_eq!(t.float(&at(u, v)), value, "{u} {v}");
    }
    // A quarter of the way from the first to the second: t = frac(0.375·2 − ½) = ¼ of the second, not of the first.
    assert_eq!(t.float(&at(0.375, 0.25)), 0.25);
    let r = two_by_two(Filter::Bilinear, Wrap::Repeat);
    assert_eq!(r.float(&at(0.0, 0.25)), 0.5);
    assert_eq!(r.float(&at(1.25, 0.25)), 0.0);
    assert_eq!(r.float(&at(1.0, 1.0)), 1.75);
    assert_eq!(two_by_two(Filter::Bilinear, Wrap::Border).float(&at(1.0, 1.0)), 1.0);
    assert_eq!(two_by_two(Filter::Bilinear, Wrap::Mirror).float(&at(1.25, 0.25)), 1.0);
    assert_eq!(two_by_two(Filter::Nearest, Wrap::Clamp).float(&at(1.0, 1.0)), 4.0);
    assert_eq!(two_by_two(Filter::Nearest, Wrap::Border).float(&at(1.0, 1.0)), 0.0);
    assert_eq!(two_by_two(Filter::Nearest, Wrap::Repeat).float(&at(1.0, 0.0)), 0.0);
    let mut bottom = two_by_two(Filter::Nearest, Wrap::Clamp);
    bottom.origin_bottom = true;
    assert_eq!(bottom.float(&at(0.1, 0.1)), 2.0);

    // Three by three: the centre of the middle texel, and a corner between four.
    let nine = picture(3, 3, 1, TexelData::F32((0..9).map(|i| (i * i) as f32).collect()), Encoding::Linear);
    let t = texture(nine, Filter::Bilinear, Wrap::Clamp);
    assert!((t.float(&at(0.5, 0.5)) - 16.0).abs() < 1e-5);
    assert!((t.float(&at(1.0 / 3.0, 2.0 / 3.0)) - (9.0 + 16.0 + 36.0 + 49.0) / 4.0).abs() < 1e-4);
}

/// M202: linear functions under bilinear lookup, quadratics under Catmull and Rom's kernel, cubics under the spline
/// through the texels; B-splines blur a cubic as theory has it.
#[test]
fn polynomials_are_reproduced() {
    let plane = |x: f32, y: f32| 0.25 * x - 0.5 * y + 3.0;
    let quadratic = |x: f32, y: f32| 0.1 * x * x - 0.05 * x * y + 0.2 * y + 1.0;
    for i in 0..40 {
        let (x, y) = (4.0 + i as f32 * 0.2, 5.0 + i as f32 * 0.13);
        let uv = at(x / 16.0, y / 16.0);
        for filter in [Filter::Bilinear, Filter::Bicubic(Cubic::CatmullRom), Filter::Bicubic(Cubic::Mitchell)] {
            let seen = texture(grey(16, 16, plane), filter, Wrap::Clamp).float(&uv);
            assert!((seen - plane(x, y)).abs() < 1e-5, "{filter:?} {x} {y}: {seen}");
        }
        let spline = texture(grey(16, 16, plane), Filter::Bicubic(Cubic::BSpline), Wrap::Clamp).float(&uv);
        assert!((spline - plane(x, y)).abs() < 1e-5);
        let seen = texture(grey(16, 16, quadratic), Filter::Bicubic(Cubic::CatmullRom), Wrap::Clamp).float(&uv);
        assert!((seen - quadratic(x, y)).abs() < 1e-4, "{x} {y}: {seen} {}", quadratic(x, y));
    }
    // The spline through the texels of any cubic of two variables is that cubic, away from the picture's sides.
    let cubic = |x: f32, y: f32| {
        let (x, y) = (x / 16.0 - 1.0, y / 16.0 - 1.0);
        x * x * x - 2.0 * x * x * y + 0.5 * x * y * y + 3.0 * y * y * y - x * y + 0.25
    };
    for (filter, error) in [(Filter::Spline, 1e-5), (Filter::Bicubic(Cubic::CatmullRom), f32::INFINITY)] {
        let t = texture(grey(32, 32, cubic), filter, Wrap::Clamp);
        let places = (0..40).map(|i| (12.5 + i as f32 * 0.17, 19.5 - i as f32 * 0.13));
        let worst = places.map(|(x, y)| (t.float(&at(x / 32.0, y / 32.0)) - cubic(x, y)).abs()).fold(0.0, f32::max);
        // Catmull and Rom's is not.
        assert!(worst < error && (filter == Filter::Spline || worst > 2e-5), "{filter:?}: {worst}");
    }
    // B-splines through samples of a cubic: the spline of x³ is x³ + x (de Boor), exactly.
    let cubic = grey(16, 4, |x, _| (x - 8.0).powi(3));
    let t = texture(cubic, Filter::Bicubic(Cubic::BSpline), Wrap::Clamp);
    for i in 0..20 {
        let x = 5.0 + 0.3 * i as f32 - 8.0;
        let seen = t.float(&at((x + 8.0) / 16.0, 0.5));
        assert!((seen - (x.powi(3) + x)).abs() < 1e-3, "{x}: {seen}");
    }
}

/// M203: what is band-limited comes back from Lanczos' kernel, to the ripple of the window.
#[test]
fn lanczos_reconstructs_slow_waves() {
    let wave = |x: f32| (x * std::f32::consts::TAU / 16.0).cos();
    let t = texture(grey(32, 1, |x, _| wave(x)), Filter::Lanczos, Wrap::Repeat);
    let worst = (0..300).map(|i| i as f32 * 32.0 / 300.0).map(|x| (t.float(&at(x / 32.0, 0.5)) - wave(x)).abs());
    assert!(worst.fold(0.0, f32::max) < 0.01);
}

/// M203: the periodic sinc brings back what is band-limited up to just below half the rate, for even and odd numbers of
/// texels, where Lanczos' kernel has long failed.
#[test]
fn the_periodic_sinc_is_exact_near_half_the_rate() {
    for n in [16_u32, 15] {
        // The highest frequency below half the rate, with a phase, and a lower one.
        let k = ((n - 1) / 2) as f32;
        let wave = |x: f32| {
            let turn = std::f32::consts::TAU * x / n as f32;
            0.5 + (k * turn + 0.7).cos() + 0.3 * (2.0 * turn).sin()
        };
        let worst = |filter| {
            let t = texture(grey(n as usize, 3, |x, _| wave(x)), filter, Wrap::Repeat);
            let places = (0..200).map(|i| i as f32 * n as f32 / 200.0);
            places.map(|x| (t.float(&at(x / n as f32, 0.4)) - wave(x)).abs()).fold(0.0, f32::max)
        };
        assert!(worst(Filter::Sinc) < 2e-5, "{n}: {}", worst(Filter::Sinc));
        assert!(worst(Filter::Lanczos) > 0.1, "{n}: {}", worst(Filter::Lanczos));
    }
}

/// Cut-outs have no dark fringes: lookups between leaves and nothing, whose texels are black, have the colour of
/// leaves.
#[test]
fn the_colour_of_nothing_does_not_bleed_in() {
    let texels = |i: usize| if (i % 8) < 4 { [255, 255, 255, 255] } else { [0, 0, 0, 0] };
    for (filter, name) in
        [(Filter::Bilinear, "bilinear"), (Filter::Trilinear, "trilinear"), (Filter::Lanczos, "lanczos")]
    {
        let base = picture(8, 8, 4, TexelData::U8((0..64).flat_map(texels).collect()), Encoding::Linear);
        let of = |bleed| {
            let recipe = Recipe { bleed, ..recipe(filter, Wrap::Clamp) };
            ImageTexture {
                levels: Arc::new(Levels::new(base.clone(), &recipe, None).unwrap()),
                ..texture(base.clone(), filter, Wrap::Clamp)
            }
        };
        let seen =
            |t: &ImageTexture, i: u32| t.rgb(&over(0.45 + 0.01 * i as f32, 0.5, Vec2::X * 0.2, Vec2::Y * 0.2)).unwrap();
        let (plain, bled) = (of(false), of(true));
        for i in 0..10 {
            assert!((seen(&bled, i) - Vec3::ONE).abs().max_element() < 1e-5, "{name}: {}", seen(&bled, i));
        }
        assert!((0..10).any(|i| seen(&plain, i).x < 0.7), "{name}");
        // Opacity is as it was.
        let opacity = |t: &ImageTexture| t.channels::<1>(&over(0.5, 0.5, Vec2::X * 0.01, Vec2::Y * 0.01), 3)[0];
        assert_eq!(opacity(&plain), opacity(&bled), "{name}");
    }
}

/// Constants survive every filter, wrap, kernel and precision.
#[test]
fn constants_are_kept() {
    let n = 13 * 7;
    let kinds = [
        TexelData::U8(vec![188; n]),
        TexelData::U16(vec![12345; n]),
        TexelData::F16(vec![half::f16::from_f32(0.625); n]),
        TexelData::F32(vec![0.3; n]),
    ];
    for data in kinds {
        let base = picture(13, 7, 1, data, Encoding::Srgb);
        let mut wanted = 0.0;
        base.linear_row(0, |_, v| wanted = v);
        for (_, filter) in FILTERS {
            for wrap in WRAPS {
                for kernel in [MipKernel::Box, MipKernel::Gaussian, MipKernel::Lanczos, MipKernel::Kaiser] {
                    let mut t = texture(base.clone(), filter, wrap);
                    let recipe = Recipe { kernel, ..recipe(filter, wrap) };
                    t.levels = Arc::new(Levels::new(base.clone(), &recipe, None).unwrap());
                    // The spline sees borders from everywhere in so small a picture.
                    let sees_border = filter == Filter::Spline && wrap == Wrap::Border;
                    for stochastic in [false, true].into_iter().filter(|_| !sees_border) {
                        t.stochastic =
                            stochastic && !matches!(filter, Filter::Bicubic(_) | Filter::Lanczos | Filter::Spline);
                        for k in 0..12 {
                            let s = 0.02 * (1.7_f32).powi(k);
                            // Black borders are seen from afar.
                            let s = if wrap == Wrap::Border { s.min(0.05) } else { s };
                            let p = over(0.5, 0.47, Vec2::new(s, 0.3 * s), Vec2::new(-0.1 * s, 0.2 * s));
                            let seen = t.float(&p);
                            assert!(
                                (seen - wanted).abs() < 4e-4 * wanted,
                                "{filter:?} {wrap:?} {kernel:?} {seen} {wanted}"
                            );
                        }
                    }
                }
            }
        }
    }
}

/// M124, E45: averages are taken of linear values. The mean of black and white is code 188 of sRGB.
#[test]
fn levels_are_averaged_in_linear_values() {
    let codes = (0..64).map(|i| if (i % 8 + i / 8) % 2 == 0 { 0 } else { 255 }).collect();
    let base = picture(8, 8, 1, TexelData::U8(codes), Encoding::Srgb);
    let levels = Levels::new(base, &recipe(Filter::Trilinear, Wrap::Repeat), None).unwrap();
    assert_eq!(levels.counts(), (4, 1));
    for i in 1..4 {
        levels.at(i, 0).linear_row(0, |_, v| assert_eq!(v, steradian_image::encoding::srgb8_decode(188)));
    }
}

/// E39: a mip-map takes a third more than its picture.
#[test]
fn a_mip_map_takes_a_third_more() {
    let base = picture(256, 256, 4, TexelData::U8(vec![7; 256 * 256 * 4]), Encoding::Srgb);
    let bytes = base.byte_size() as f64;
    let of = |filter| {
        let levels = Levels::new(base.clone(), &recipe(filter, Wrap::Repeat), None).unwrap();
        levels.byte_size() as f64 / bytes
    };
    assert!((of(Filter::Trilinear) - 4.0 / 3.0).abs() < 1e-4);
    assert!((of(Filter::Ripmap) - 4.0).abs() < 0.1);
}

/// E43: level of detail is the logarithm of the footprint in texels, whatever the picture's shape.
#[test]
fn levels_follow_from_texels() {
    assert_eq!(level_of(0.5, 9), (0, 0.0));
    assert_eq!(level_of(8.0, 9), (3, 0.0));
    assert_eq!(level_of(1e30, 9), (8, 0.0));
    let (i, t) = level_of(4.0 * 1.25, 9);
    assert!(i == 2 && (t - 1.25_f32.log2()).abs() < 1e-6);
    // Each level of this picture is its number: black is replaced after the levels are made.
    let size = 64;
    let checks = grey(size, size, |x, y| if (x.floor() + y.floor()) % 2.0 == 0.0 { 0.0 } else { 1.0 });
    let t = texture(checks, Filter::Trilinear, Wrap::Repeat);
    // Between level 0 and level 1, at the centre of a white texel whose mean with its neighbours is 1/2.
    let p = |texels: f32| over(0.5 / 64.0, 1.5 / 64.0, Vec2::new(texels / 64.0, 0.0), Vec2::ZERO);
    assert_eq!(t.float(&p(1.0)), 1.0);
    assert!((t.float(&p(2.0_f32.sqrt())) - 0.75).abs() < 1e-6);
    assert_eq!(t.float(&p(2.0)), 0.5);
    // 64 × 16: the same footprint in periods is four times as long in texels across.
    let wide = texture(grey(64, 16, |x, _| x), Filter::Trilinear, Wrap::Clamp);
    assert_eq!(wide.levels.counts(), (7, 1));
    assert_eq!((wide.levels.at(5, 0).width(), wide.levels.at(5, 0).height()), (2, 1));
}

/// M210, item 1: EWA against the mean of 1024 points over the same Gaussian, on a plane seen at a slant.
#[test]
fn ewa_agrees_with_a_supersampled_plane() {
    let size = 128;
    let value = |x: f32, y: f32| {
        let cell = (x / 8.0).floor() as i32 + (y / 8.0).floor() as i32;
        if cell % 2 == 0 { 0.1 } else { 0.5 + 0.4 * (x * 0.31).sin() * (y * 0.17).cos() }
    };
    let base = grey(size, size, value);
    let mut ewa = texture(base.clone(), Filter::Ewa(16.0), Wrap::Repeat);
    let points = texture(base, Filter::Bilinear, Wrap::Repeat);
    for stochastic in [false, true] {
        ewa.stochastic = stochastic;
        let (mut error, mut count) = (0.0, 0);
        for k in 0..120 {
            // Pixels towards the horizon: ever longer and wider footprints, turned by degrees.
            let depth = 1.0 + 0.35 * (k % 30) as f32;
            let (sin, cos) = (0.6 * (k / 30) as f32).sin_cos();
            let turn = |v: Vec2| Vec2::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos);
            let (dx, dy) = (turn(Vec2::X * depth / 128.0), turn(Vec2::Y * depth * depth / 128.0));
            let uv = Vec2::new(0.137 * k as f32, 0.719 * k as f32);
            let mut sum = 0.0;
            for i in 0..32 {
                for j in 0..32 {
                    // The disk, by radius and angle, with the Gaussian's density.
                    let u = (i as f32 + 0.5) / 32.0;
                    let r = (-0.5 * (1.0 - u * (1.0 - (-2.0_f32).exp())).ln()).sqrt();
                    let (s, c) = ((j as f32 + 0.5 * (i % 2) as f32) / 32.0 * std::f32::consts::TAU).sin_cos();
                    let p = uv + (dx * c + dy * s) * r;
                    sum += points.float(&at(p.x, p.y));
                }
            }
            let seen = if stochastic {
                // The mean over many draws, which differ by the place in the world.
                let draw = |i: i32| ewa.float(&TextureContext { p: Vec3::X * i as f32, ..over(uv.x, uv.y, dx, dy) });
                (0..1024).map(draw).sum::<f32>() / 1024.0
            } else {
                ewa.float(&over(uv.x, uv.y, dx, dy))
            };
            error += (seen - sum / 1024.0).abs();
            count += 1;
        }
        let mean = error / count as f32;
        assert!(mean < 0.01, "stochastic {stochastic}: {mean}");
    }
}

/// One-tap lookups have the filter's value as their mean: z-test at four standard errors.
#[test]
fn one_tap_lookups_are_unbiased() {
    let base = grey(32, 32, |x, y| 0.5 + 0.4 * (x * 0.9).sin() * (y * 0.7).cos());
    for (name, filter) in FILTERS.into_iter().filter(|f| f.1 != Filter::Nearest) {
        if matches!(filter, Filter::Ewa(_)) {
            // Its draws are of the continuous Gaussian, compared above.
            continue;
        }
        let mut t = texture(base.clone(), filter, Wrap::Repeat);
        let place = over(0.4321, 0.777, Vec2::new(0.09, 0.01), Vec2::new(-0.02, 0.05));
        let wanted = f64::from(t.float(&place));
        t.stochastic = true;
        let (mut sum, mut squares, n) = (0.0, 0.0, 20_000);
        for i in 0..n {
            let seen = f64::from(t.float(&TextureContext { p: Vec3::Y * i as f32, ..place }));
            sum += seen;
            squares += seen * seen;
        }
        let mean = sum / f64::from(n);
        let error = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
        assert!((mean - wanted).abs() < 4.0 * error + 1e-5, "{name}: {mean} {wanted} ± {error}");
    }
}

/// M212: at every level as much passes the alpha test as in the picture.
#[test]
fn coverage_is_kept() {
    let codes = (0..128 * 128).flat_map(|i| {
        // Leaves here and there: a quarter is opaque; the rest is red, which nobody sees.
        if steradian_math::hash::mix32(i).is_multiple_of(4) { [90, 200, 40, 255] } else { [255, 0, 0, 0] }
    });
    let base = picture(128, 128, 4, TexelData::U8(codes.collect()), Encoding::Srgb);
    let passing = |levels: &Levels, i: usize| {
        let (mut n, level) = (0, levels.at(i, 0));
        (0..level.height()).for_each(|y| level.linear_row(y, |i, v| n += usize::from(i % 4 == 3 && v >= 0.5)));
        n as f32 / (level.width() * level.height()) as f32
    };
    let plain = Recipe { ..recipe(Filter::Trilinear, Wrap::Repeat) };
    let kept = Recipe { keep_coverage: Some(0.5), ..plain };
    let (plain, kept) = (Levels::new(base.clone(), &plain, None).unwrap(), Levels::new(base, &kept, None).unwrap());
    let mut lost = false;
    let wanted = passing(&plain, 0);
    for i in 1..4 {
        lost |= (passing(&plain, i) - wanted).abs() > 0.2;
        // Texels of a level have one of 4ⁱ + 1 opacities; those of the same one pass together.
        let error = (passing(&kept, i) - wanted).abs();
        assert!(error < 0.13, "level {i}: {error}");
    }
    assert!(lost, "without it coverage is lost");
    // Colours that nobody sees do not bleed in: texels of levels that are seen at all have the colour of the leaves.
    let leaf = [90, 200, 40].map(steradian_image::encoding::srgb8_decode);
    for i in 1..4 {
        let (level, mut seen) = (kept.at(i, 0), 0);
        for y in 0..level.height() {
            let mut row = vec![0.0; 4 * level.width()];
            level.linear_row(y, |i, v| row[i] = v);
            for texel in row.chunks(4).filter(|t| t[3] > 0.0) {
                seen += 1;
                assert!((0..3).all(|c| (texel[c] - leaf[c]).abs() < 5e-3), "level {i}: {texel:?}");
            }
        }
        assert!(seen > 100 >> i, "level {i}: {seen} texels are seen");
    }
}

/// Lookups in pages have the bits of lookups in memory.
#[test]
fn pages_change_nothing() {
    let (w, h) = (150, 90);
    let code = |i: usize| ((i as u32).wrapping_mul(2_654_435_761) >> 13) as u8;
    let texels = Texels {
        width: w,
        height: h,
        channels: 3,
        data: TexelData::U8((0..w * h * 3).map(code).collect()),
        encoding: Encoding::Srgb,
        metadata: Default::default(),
    };
    let texels = Arc::new(texels);
    let pages = Pages::new(1 << 15).unwrap();
    for (name, filter) in FILTERS {
        let recipe = recipe(filter, Wrap::Mirror);
        let memory = Levels::new(Level::new(texels.clone(), None).unwrap(), &recipe, None).unwrap();
        let paged = Levels::new(Level::new(texels.clone(), Some(&pages)).unwrap(), &recipe, Some(&pages)).unwrap();
        let sums = [SummedArea::new(memory.base()), SummedArea::new(paged.base())];
        let wrap = [Wrap::Mirror; 2];
        let a = Source { levels: &memory, sums: Some(&sums[0]), wrap, borders: &BLACK };
        let b = Source { levels: &paged, sums: Some(&sums[1]), wrap, borders: &BLACK };
        for i in 0..200 {
            let s = 0.001 * 1.03_f32.powi(i);
            let at = Coordinates2 {
                uv: Vec2::new(0.37 * i as f32, 0.91 * i as f32),
                dx: Vec2::new(s, 0.2 * s),
                dy: Vec2::new(0.1 * s, -0.4 * s),
            };
            let (a, b): ([f32; 3], [f32; 3]) = (a.lookup(filter, &at, 0), b.lookup(filter, &at, 0));
            assert_eq!(a.map(f32::to_bits), b.map(f32::to_bits), "{name} {i}");
        }
    }
}

/// Many textures that are made and looked up in turn never take more than the limit, but for a tile that comes in
/// before others go.
#[test]
fn many_textures_stay_within_their_limit() {
    let (size, count, limit) = (512, 16, 2 << 20);
    let pages = Pages::new(limit).unwrap();
    let recipe = recipe(Filter::Trilinear, Wrap::Repeat);
    let pictures: Vec<[Levels; 2]> = (0..count)
        .map(|n| {
            let code = |i: usize| ((i as u32 ^ n << 20).wrapping_mul(2_654_435_761) >> 24) as u8;
            let data = TexelData::U8((0..size * size * 4).map(code).collect());
            let texels = Texels {
                width: size,
                height: size,
                channels: 4,
                data,
                encoding: Encoding::Srgb,
                metadata: Default::default(),
            };
            let texels = Arc::new(texels);
            [None, Some(&pages)]
                .map(|pages| Levels::new(Level::new(texels.clone(), pages).unwrap(), &recipe, pages).unwrap())
        })
        .collect();
    for i in 0..4000_u32 {
        let random = |salt: u32| steradian_math::hash::unit_f32(steradian_math::hash::mix32(4 * i + salt));
        let s = random(3) * 16.0 / size as f32;
        let at = Coordinates2 { uv: Vec2::new(random(0), random(1)), dx: Vec2::new(s, 0.0), dy: Vec2::new(0.0, s) };
        let [seen, wanted] = pictures[(i % count) as usize].each_ref().map(|levels| {
            let source = Source { levels, sums: None, wrap: [Wrap::Repeat; 2], borders: &BLACK };
            source.lookup::<3>(Filter::Trilinear, &at, 0).map(f32::to_bits)
        });
        assert_eq!(seen, wanted, "{i}");
    }
    let (on_disk, used, loads) = pages.usage();
    let tile = 64 * 64 * 4;
    let threads = rayon::current_num_threads() + 1;
    assert!(on_disk > 8 * limit as u64 && loads > 2000 && !pages.has_failed(), "{on_disk} {loads}");
    assert!(used <= pages.peak() && pages.peak() <= limit + threads * tile, "{used} {}", pages.peak());
    assert!(pages.peak() > limit - limit / 4, "the room is used: {}", pages.peak());
}

/// Strange footprints and places give numbers.
#[test]
fn lookups_of_strange_places_are_finite() {
    let base = grey(5, 3, |x, y| x + y);
    for (name, filter) in FILTERS {
        for wrap in WRAPS {
            let mut t = texture(base.clone(), filter, wrap);
            for stochastic in [false, true] {
                t.stochastic = stochastic;
                for d in [0.0, 1e-30, 1e-3, 1.0, 1e6, 1e20, f32::INFINITY, f32::NAN] {
                    for uv in [0.0, 1.0, -1e-9, 1e30, -3e38, f32::NAN, f32::INFINITY] {
                        let p = over(uv, 0.3, Vec2::new(d, 0.0), Vec2::new(0.0, 1e-3));
                        assert!(t.float(&p).is_finite(), "{name} {wrap:?} {d} {uv}");
                    }
                }
            }
        }
    }
}
