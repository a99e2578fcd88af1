//! Patterns against their definitions, their averages against sampling, and their bits against those of every other
//! machine.

use super::*;
use crate::{
    Footprint,
    noise::{Basis, Metric},
};
use steradian_math::hash::HashRng;

fn cells(metric: Metric) -> Cellular {
    Cellular { metric, jitter: 1.0, seed: 3, flat: false }
}

const RUNNING: Bricks = Bricks { size: Vec2::new(0.5, 0.25), mortar: Vec2::splat(0.03), shift: 0.5 };

fn all() -> Vec<(&'static str, Pattern)> {
    let f = Fractal::new(8, 0.5);
    vec![
        ("checker2", Pattern::Checker2),
        ("checker3", Pattern::Checker3),
        ("bricks", Pattern::Bricks(RUNNING)),
        ("brick_shade", Pattern::BrickShade(RUNNING, 5)),
        ("stripes", Pattern::Stripes(0.3)),
        ("dots", Pattern::Dots),
        ("coordinate", Pattern::Coordinate(true)),
        ("radial", Pattern::Radial),
        ("angular", Pattern::Angular),
        ("fbm", Pattern::Fbm(f)),
        ("fbm seeded", Pattern::Fbm(Fractal { seed: 9, ..f })),
        ("value fbm", Pattern::Fbm(Fractal { basis: Basis::Value, ..f })),
        ("turbulence", Pattern::Turbulence(f)),
        ("ridged", Pattern::Ridged(f)),
        ("windy", Pattern::Windy),
        ("f1", Pattern::WorleyF1(cells(Metric::Euclidean))),
        ("f2", Pattern::WorleyF2(cells(Metric::Manhattan))),
        ("border", Pattern::WorleyBorder(cells(Metric::Chebyshev))),
        ("voronoi", Pattern::Voronoi(cells(Metric::Euclidean))),
        ("wood", Pattern::Wood(Wood { grain: 0.2, ..Wood::default() })),
        ("marble", Pattern::Marble(f, 2.0)),
        ("facing", Pattern::Facing(Vec3::new(0.6, 0.0, 0.8))),
    ]
}

fn place(i: u32) -> TextureContext<'static> {
    let mut rng = HashRng::new(i.into());
    let mut next = || rng.next_f32() * 8.0 - 4.0;
    let at = TextureContext::new(Vec3::new(next(), next(), next()), Vec2::new(next(), next()));
    let footprint = Footprint {
        dpdx: Vec3::new(next(), next(), next()) * 0.01,
        dpdy: Vec3::new(next(), next(), next()) * 0.01,
        duvdx: Vec2::new(next(), next()) * 0.01,
        duvdy: Vec2::new(next(), next()) * 0.01,
    };
    let n = Vec3::new(next(), 1.0, next()).normalize();
    TextureContext { n, footprint: if i.is_multiple_of(2) { footprint } else { Footprint::default() }, ..at }
}

/// The sum over places of the hashes of the bits. A change here changes pictures.
fn golden(pattern: Pattern) -> u32 {
    let t = PatternTexture::new(pattern, Mapping::default());
    (0..256).fold(0_u32, |h, i| steradian_math::hash::combine32(h, t.value(&place(i)).to_bits()))
}

#[test]
fn bits_are_the_same_everywhere() {
    let found: Vec<(&str, u32)> = all().into_iter().map(|(name, p)| (name, golden(p))).collect();
    let known: &[(&str, u32)] = &GOLDEN;
    assert_eq!(found, known, "a pattern has changed");
}

/// Computed on x86-64.
const GOLDEN: [(&str, u32); 22] = [
    ("checker2", 3_199_865_601),
    ("checker3", 2_566_918_697),
    ("bricks", 1_532_111_140),
    ("brick_shade", 2_989_120_451),
    ("stripes", 3_887_477_718),
    ("dots", 465_892_835),
    ("coordinate", 436_665_529),
    ("radial", 1_606_612_441),
    ("angular", 1_219_866_105),
    ("fbm", 2_961_802_476),
    ("fbm seeded", 3_344_727_544),
    ("value fbm", 476_058_792),
    ("turbulence", 2_194_079_676),
    ("ridged", 3_739_509_630),
    ("windy", 1_047_164_688),
    ("f1", 3_695_827_848),
    ("f2", 3_913_147_398),
    ("border", 992_235_564),
    ("voronoi", 2_593_953_661),
    ("wood", 2_758_911_805),
    ("marble", 3_397_612_360),
    ("facing", 1_319_927_638),
];

#[test]
fn averages_of_tilings_are_integrals() {
    // Against the midpoint rule over the filter.
    let mut rng = HashRng::new(2);
    for _ in 0..60 {
        let uv = Vec2::new(rng.next_f32(), rng.next_f32()) * 6.0 - 3.0;
        let w = Vec2::new(rng.next_f32() + 0.05, rng.next_f32() + 0.05);
        let c = Coordinates2 { uv, dx: Vec2::new(w.x, 0.0), dy: Vec2::new(0.0, -w.y) };
        let n = 200;
        let mean = |half: Vec2, tent: bool, f: &dyn Fn(Vec2) -> f32| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for i in 0..n * n {
                let s = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32 * 2.0 - 1.0;
                let k = if tent { (1.0 - s.x.abs()) * (1.0 - s.y.abs()) } else { 1.0 };
                sum += f64::from(k * f(uv + s * half));
                weights += f64::from(k);
            }
            (sum / weights) as f32
        };
        let odd = |p: Vec2| (p.x.floor() + p.y.floor()).rem_euclid(2.0);
        let point = |uv| Coordinates2 { uv, ..Coordinates2::default() };
        // The midpoint rule is off by a cell at each edge.
        let expected = mean(w * 1.5, true, &odd);
        assert!((tiling::checker2(&c) - expected).abs() < 0.02, "{} {expected}", tiling::checker2(&c));
        let expected = mean(w * 0.5, false, &|p| RUNNING.value(&point(p)));
        assert!((RUNNING.value(&c) - expected).abs() < 0.03, "{} {expected}", RUNNING.value(&c));
        let expected = mean(w * 0.5, false, &|p| tiling::pulse(p.x, 0.0, 0.3));
        assert!((tiling::pulse(uv.x, w.x, 0.3) - expected).abs() < 0.02);
    }
}

#[test]
fn tilings_by_hand() {
    let at = |u: f32, v: f32| Coordinates2 { uv: Vec2::new(u, v), ..Coordinates2::default() };
    assert_eq!(tiling::checker2(&at(0.5, 0.5)), 0.0);
    assert_eq!(tiling::checker2(&at(1.5, 0.5)), 1.0);
    assert_eq!(tiling::checker2(&at(-0.5, -0.5)), 0.0);
    assert_eq!(tiling::checker2(&at(-0.5, 0.5)), 1.0);
    let cube = |p: Vec3| tiling::checker3(&Coordinates3 { p, ..Coordinates3::default() });
    assert_eq!((cube(Vec3::splat(0.5)), cube(Vec3::new(1.5, 0.5, 0.5)), cube(Vec3::splat(1.5))), (0.0, 1.0, 1.0));
    // Mortar lies around the corners of bricks, and the second row is moved by half a brick.
    let wall = Bricks { size: Vec2::new(2.0, 1.0), mortar: Vec2::splat(0.2), shift: 0.5 };
    let v = |u, v| wall.value(&at(u, v));
    assert_eq!((v(1.0, 0.5), v(0.05, 0.5), v(1.95, 0.5), v(1.0, 0.05)), (1.0, 0.0, 0.0, 0.0));
    assert_eq!((v(0.05, 1.5), v(1.0, 1.5), v(0.15, 0.5)), (1.0, 0.0, 1.0));
    // Wide footprints see the share of brick.
    let wide = |w: f32| Coordinates2 { uv: Vec2::new(0.3, 0.8), dx: Vec2::splat(w), dy: Vec2::ZERO };
    for w in [64.0, 8.0] {
        assert!((wall.value(&wide(w)) - 0.9 * 0.8).abs() < 1e-4);
    }
    assert_eq!(wall.shade(Vec2::new(0.5, 0.5), 1), wall.shade(Vec2::new(1.5, 0.7), 1));
    assert_ne!(wall.shade(Vec2::new(0.5, 0.5), 1), wall.shade(Vec2::new(2.5, 0.7), 1));
    // Rings of the lecture: 40 of 60 are light.
    let wood = Wood { wobble: 0.0, ..Wood::default() };
    let ring = |r: f32| wood.value(&Coordinates3 { p: Vec3::new(0.0, r, 5.0), ..Coordinates3::default() });
    assert_eq!((ring(0.1), ring(0.6), ring(0.7), ring(0.9), ring(1.1)), (1.0, 1.0, 0.0, 0.0, 1.0));
}

#[test]
fn patterns_fade_to_their_mean() {
    for (name, pattern) in all() {
        let t = PatternTexture::new(pattern, Mapping::default());
        if !t.is_filtered() || matches!(pattern, Pattern::Turbulence(_)) {
            continue;
        }
        let mut rng = HashRng::new(77);
        let (mut sum, mut squares, n) = (0.0_f64, 0.0_f64, 20_000);
        for _ in 0..n {
            let mut next = || rng.next_f32() * 60.0 - 30.0;
            let v = t.value(&TextureContext::new(Vec3::new(next(), next(), next()), Vec2::new(next(), next())));
            sum += f64::from(v);
            squares += f64::from(v * v);
        }
        let mean = sum / f64::from(n);
        let error = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
        let footprint = Footprint {
            dpdx: Vec3::new(333.0, 777.0, 0.0),
            dpdy: Vec3::new(0.0, 100.0, 555.0),
            duvdx: Vec2::new(500.0, 3.0),
            duvdy: Vec2::new(0.0, 700.0),
        };
        let wide = t.value(&TextureContext { footprint, ..place(1) });
        // The stored means come from 4096 points; those of noise are zero by symmetry, and of Perlin's own over its
        // period nearly so.
        assert!((f64::from(wide) - mean).abs() < 4.0 * error + 0.012, "{name}: {wide} {mean} ± {error}");
    }
}

#[test]
fn nothing_gives_nan() {
    for (name, pattern) in all() {
        let t = PatternTexture::new(pattern, Mapping::default());
        for v in [f32::NAN, f32::INFINITY, -f32::MAX, 1e20, 1e-40] {
            let footprint =
                Footprint { dpdx: Vec3::splat(v), dpdy: Vec3::X, duvdx: Vec2::splat(v), duvdy: Vec2::splat(-v) };
            for at in [place(3), TextureContext::new(Vec3::splat(v), Vec2::splat(v))] {
                assert!(t.value(&TextureContext { footprint, ..at }).is_finite(), "{name} {v}");
            }
        }
    }
}

#[test]
fn pbrts_dots_are_where_pbrt_has_them() {
    // From the definition, for a cell with a dot and one without.
    let noise = |x: f32, y: f32| crate::noise::gradient_noise(Vec3::new(x, y, 0.5), 0);
    let (mut with, mut without) = (0, 0);
    for i in 0..100 {
        let (s, t) = ((i % 10) as f32, (i / 10) as f32);
        let centre = Vec2::new(s + 0.15 * noise(s + 1.5, t + 2.8), t + 0.15 * noise(s + 4.5, t + 9.8));
        if noise(s + 0.5, t + 0.5) > 0.0 {
            assert_eq!(tiling::polka_dot(centre), 1.0);
            assert_eq!(tiling::polka_dot(centre + Vec2::new(0.34, 0.0)), 1.0);
            assert_eq!(tiling::polka_dot(centre + Vec2::new(0.0, 0.351)), 0.0);
            with += 1;
        } else {
            assert_eq!(tiling::polka_dot(centre), 0.0);
            without += 1;
        }
    }
    assert!(with > 30 && without > 30);
}
