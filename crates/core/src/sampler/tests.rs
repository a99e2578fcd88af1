//! Laws that hold for every sampler, and tests of the claims about each.

use super::*;
use steradian_testkit::{chi2_test, sidak};

/// All kinds whose pixels are independent of each other.
fn kinds() -> impl Iterator<Item = SamplerKind> {
    SAMPLERS.iter().map(|s| s.1).filter(|kind| *kind != SamplerKind::Fixed)
}

/// Samplers whose first 2^k points are a (0,2)-net.
const NETS: [SamplerKind; 3] = [SamplerKind::Sobol, SamplerKind::ZSobol, SamplerKind::Pmj02];

fn points(sampler: Sampler, x: u32, y: u32, dimension: u32) -> Vec<Vec2> {
    (0..sampler.spp).map(|i| sampler.pixel(x, y, i).get_2d(dimension)).collect()
}

/// Each single number of each sampler is uniform, whatever the number of samples and the index: that is all that lack
/// of bias takes. χ² at 0.01 over all, of 64 boxes and 20 000 pixels or seeds.
#[test]
fn every_sample_is_uniform() {
    const PIXELS: u32 = 20_000;
    let cases: Vec<_> = kinds().flat_map(|k| [(k, 5, 3), (k, 16, 0), (k, 1 << 24, 70_000)]).collect();
    for &(kind, spp, index) in &cases {
        let (mut square, mut line) = (vec![0_u64; 64], vec![0_u64; 64]);
        for n in 0..PIXELS {
            // Single pixels far apart: those of a block are made to be uniform together, which is more than at random.
            let sampler = Sampler { kind, spp, seed: u64::from(n) };
            let s = sampler.pixel(n * 7, n * 13, index);
            let p = s.get_2d(7);
            assert!(p.min_element() >= 0.0 && p.max_element() < 1.0, "{kind:?}: {p}");
            square[(p.y * 8.0) as usize * 8 + (p.x * 8.0) as usize] += 1;
            line[(s.get_1d(8) * 64.0) as usize] += 1;
        }
        let expected = vec![f64::from(PIXELS) / 64.0; 64];
        for observed in [square, line] {
            let test = chi2_test(&observed, &expected, PIXELS.into());
            assert!(test.p_value > sidak(0.01, 2 * cases.len()), "{kind:?}, {spp} samples: p = {}", test.p_value);
        }
    }
}

#[test]
fn numbers_integrate() {
    // ∫ x² y dx dy = 1/6; the standard error of 4096 independent samples is 0.0034.
    for kind in kinds() {
        for n in [4096, 4000] {
            let mean = points(Sampler { kind, spp: n, seed: 7 }, 3, 5, 9).iter().map(|p| p.x * p.x * p.y).sum::<f32>();
            let mean = mean / n as f32;
            assert!((mean - 1.0 / 6.0).abs() < 0.014, "{kind:?}: {mean}");
        }
    }
}

/// Tests that each of `columns` × `rows` boxes has at most one point.
fn one_per_box(points: &[Vec2], columns: u32, rows: u32) -> bool {
    let mut seen = vec![false; (columns * rows) as usize];
    points.iter().all(|p| {
        let at = (p.y * rows as f32) as usize * columns as usize + (p.x * columns as f32) as usize;
        !std::mem::replace(&mut seen[at], true)
    })
}

#[test]
fn points_are_stratified() {
    for (x, y, dimension) in [(0, 0, 0), (17, 300, 5), (4000, 9, 123)] {
        for kind in NETS {
            for k in [0, 1, 2, 5, 8] {
                let set = points(Sampler { kind, spp: 1 << k, seed: 3 }, x, y, dimension);
                for a in 0..=k {
                    assert!(one_per_box(&set, 1 << a, 1 << (k - a)), "{kind:?}, 2^{k} points, 2^{a} columns");
                }
            }
        }
        for n in [1_u32, 7, 16, 35, 256] {
            let columns = n.isqrt();
            let rows = n.div_ceil(columns);
            for kind in [SamplerKind::Stratified, SamplerKind::MultiJitter] {
                let set = points(Sampler { kind, spp: n, seed: 3 }, x, y, dimension);
                assert!(one_per_box(&set, columns, rows), "{kind:?}, {n} points");
                if kind == SamplerKind::MultiJitter {
                    let fine = columns * rows;
                    assert!(one_per_box(&set, fine, 1) && one_per_box(&set, 1, fine), "{kind:?}, {n} points");
                }
            }
        }
        // One dimension.
        for kind in kinds().filter(|k| !matches!(k, SamplerKind::Independent | SamplerKind::Halton)) {
            let s = Sampler { kind, spp: 64, seed: 3 };
            let line: Vec<Vec2> = (0..64).map(|i| Vec2::new(s.pixel(x, y, i).get_1d(dimension), 0.0)).collect();
            // A shifted lattice has one point in each stratum but for the rounding of the shift's ends.
            assert!(one_per_box(&line, 64, 1), "{kind:?}");
        }
    }
}

/// The squared error of the mean of a function over the unit hypercube of two pairs of dimensions, over pixels.
fn mean_square_error(kind: SamplerKind, n: u32, f: impl Fn(Vec2, Vec2) -> f64, exact: f64) -> f64 {
    const PIXELS: u32 = 64;
    let sampler = |seed| Sampler { kind, spp: n, seed };
    (0..PIXELS)
        .map(|k| {
            let s = sampler(k.into());
            let mean =
                (0..n).map(|i| s.pixel(5, 6, i)).map(|s| f(s.get_2d(4), s.get_2d(7))).sum::<f64>() / f64::from(n);
            (mean - exact).powi(2) / f64::from(PIXELS)
        })
        .sum()
}

/// M153: how fast the error falls from 16 to 1024 samples: half a power for independent samples; faster for a smooth
/// function, and one with an edge, of a pair of dimensions; and, where parts that depend on one pair prevail, of two
/// pairs. Exponents of the error; those of theory are in brackets.
#[test]
fn errors_fall_as_theory_has_it() {
    use SamplerKind as K;
    let smooth = |p: Vec2, _: Vec2| f64::from(p.x * p.y);
    let edge = |p: Vec2, _: Vec2| f64::from(u8::from(p.length_squared() < 1.0));
    let sum = |p: Vec2, q: Vec2| f64::from((p.x * p.y + q.x * q.y).exp());
    // Σ over n of the moments: ∫∫ e^(xy) = Σ 1/(n! (n+1)²).
    let (mut one, mut factorial) = (0.0, 1.0);
    for n in 0..20 {
        factorial *= f64::from(n.max(1));
        one += 1.0 / (factorial * f64::from(n + 1).powi(2));
    }
    let slope = |kind, f: &dyn Fn(Vec2, Vec2) -> f64, exact| {
        (mean_square_error(kind, 16, f, exact) / mean_square_error(kind, 1024, f, exact)).log2() / 12.0
    };
    // Smooth in two dimensions, with an edge, smooth in four.
    let least: [(K, [f64; 3]); 8] = [
        (K::Independent, [0.4; 3]),         // ½
        (K::Stratified, [0.85, 0.6, 0.4]),  // 1, ¾
        (K::MultiJitter, [0.65, 0.6, 0.4]), // ¾: cells of a row and of a column share their orders; ¾
        (K::Sobol, [1.2, 0.6, 0.55]),       // 3/2 but for logarithms, ¾
        (K::ZSobol, [1.2, 0.6, 0.45]),
        (K::Pmj02, [1.2, 0.6, 0.45]),
        (K::Halton, [0.7, 0.6, 0.5]), // 1 but for logarithms; counts that are no powers of the bases fall behind
        (K::Lattice, [0.7, 0.6, 0.6]), // 1 but for logarithms
    ];
    assert_eq!(least.len(), kinds().count());
    for (kind, least) in least {
        let found =
            [slope(kind, &smooth, 0.25), slope(kind, &edge, std::f64::consts::FRAC_PI_4), slope(kind, &sum, one * one)];
        for (found, least) in found.iter().zip(least) {
            assert!(*found > least, "{kind:?}: {found:.2} instead of {least}");
        }
        assert!(kind != K::Independent || found.iter().all(|f| (f - 0.5).abs() < 0.1), "{found:?}");
    }
}

/// The mean square of the difference between the part of the points in a box at the origin and its area, over all boxes
/// (Warnock 1972): for 256 independent points (1/2^2 − 1/3^2)/256. Spread points have less than a tenth of it.
#[test]
fn discrepancies_are_small() {
    let n = 256;
    for kind in kinds() {
        let mut mean = 0.0;
        for seed in 0..16 {
            let set = points(Sampler { kind, spp: n, seed }, 1, 2, 3);
            let side = |v: f32| f64::from(1.0 - v);
            let count = f64::from(n);
            let mut square = 1.0 / 9.0;
            for p in &set {
                let (a, b) = (f64::from(p.x), f64::from(p.y));
                square -= 2.0 / count * (1.0 - a * a) * (1.0 - b * b) / 4.0;
                square += set.iter().map(|q| side(p.x.max(q.x)) * side(p.y.max(q.y))).sum::<f64>() / (count * count);
            }
            mean += square / 16.0;
        }
        let independent = (1.0 / 4.0 - 1.0 / 9.0) / f64::from(n);
        match kind {
            SamplerKind::Independent => assert!((mean / independent - 1.0).abs() < 0.5, "{}", mean / independent),
            SamplerKind::Stratified => assert!(mean < 0.2 * independent, "{kind:?}: {}", mean / independent),
            _ => assert!(mean < 0.1 * independent, "{kind:?}: {}", mean / independent),
        }
    }
}

/// Numbers of different dimensions, and of pixels that share no sequence, are uncorrelated: sums of 64 squares of
/// normal variables, χ² at 0.01 over all.
#[test]
fn dimensions_and_pixels_are_independent() {
    let n = 64;
    for kind in kinds() {
        let s = Sampler { kind, spp: n, seed: 9 };
        let correlation = |a: &dyn Fn(u32, u32) -> f32, b: &dyn Fn(u32, u32) -> f32| -> f64 {
            // Each sum over samples has a variance of n/144.
            (0..64)
                .map(|k| {
                    let sum: f64 = (0..n).map(|i| f64::from(a(k, i) - 0.5) * f64::from(b(k, i) - 0.5)).sum();
                    (sum * 12.0).powi(2) / f64::from(n)
                })
                .sum()
        };
        let far = 1 << BLOCK;
        let found = [
            correlation(&|k, i| s.pixel(1, 1, i).get_2d(2 * k).x, &|k, i| s.pixel(1, 1, i).get_2d(2 * k + 1).y),
            correlation(&|k, i| s.pixel(k, 1, i).get_1d(3), &|k, i| s.pixel(k, 1, i).get_2d(13).x),
            correlation(&|k, i| s.pixel(k, 1, i).get_2d(6).x, &|k, i| s.pixel(k + far, 1, i).get_2d(6).x),
            correlation(&|k, i| s.pixel(k, 1, i).get_2d(6).x, &|k, i| {
                Sampler { seed: 10, ..s }.pixel(k, 1, i).get_2d(6).x
            }),
        ];
        for (what, chi2) in found.into_iter().enumerate() {
            // 64 degrees of freedom: 64 ± 11.3; 0.01 over 32 comparisons on both sides. Halton points with a large base
            // are a few sets in one order, the same for all pixels, which gives correlations of either sign twice the
            // variance. Pixels of a lattice are one sequence with independent shifts, so that sample by sample they do
            // go together, though their means do not; within a pixel its coordinates are made to go together well.
            let (least, most) = match kind {
                SamplerKind::Halton => (34.0, 220.0),
                SamplerKind::Lattice => (0.0, if what < 2 { 110.0 } else { f64::INFINITY }),
                _ => (34.0, 110.0),
            };
            assert!((least..most).contains(&chi2), "{kind:?}, {what}: {chi2}");
        }
    }
}

/// Blue noise reduces the error of block averages: the mean over 4 × 4 pixels of the default sampler errs far less than
/// with independent pixels, for one sample and for four, while each pixel errs as much: within 15 %, since the pixels
/// of a block share a scramble, of which there are 64.
#[test]
fn neighbours_err_in_opposite_directions() {
    const SIZE: u32 = 16;
    let f = |p: Vec2| f64::from(u8::from(p.length_squared() < 1.0)) - std::f64::consts::FRAC_PI_4;
    for spp in [1, 4, 16] {
        let error = |kind: SamplerKind| -> [f64; 2] {
            let (mut single, mut block) = (0.0, 0.0);
            for seed in 0..64 {
                let s = Sampler { kind, spp, seed };
                for by in 0..SIZE / 4 {
                    for bx in 0..SIZE / 4 {
                        let mut sum = 0.0;
                        for p in 0..16 {
                            let set = points(s, 4 * bx + p % 4, 4 * by + p / 4, 6);
                            let e = set.into_iter().map(f).sum::<f64>() / f64::from(spp);
                            single += e * e;
                            sum += e / 16.0;
                        }
                        block += sum * sum;
                    }
                }
            }
            let pixels = f64::from(64 * SIZE * SIZE);
            [single / pixels, block / pixels * 16.0]
        };
        let (independent, blue) = (error(SamplerKind::Sobol), error(SamplerKind::ZSobol));
        assert!((blue[0] / independent[0] - 1.0).abs() < 0.15, "{spp}: {blue:?}, {independent:?}");
        assert!(blue[1] < 0.4 * independent[1], "{spp}: {blue:?}, {independent:?}");
    }
}

/// M153: all pixels and groups have one list of independent numbers, which seed, sample and dimension alone decide.
#[test]
fn fixed_lists_are_those_of_all_pixels() {
    let s = Sampler { kind: SamplerKind::Fixed, spp: 64, seed: 9 };
    let (one, other) = (points(s, 3, 5, 2), points(s, 700, 1, 2));
    assert_eq!(one, other);
    assert_eq!(s.group(1, 2, 3, 4, 16).member(0).get_2d(1), s.group(5, 6, 7, 4, 16).member(0).get_2d(1));
    let sequences = [points(s, 0, 0, 3), points(Sampler { seed: 10, ..s }, 0, 0, 2)];
    assert!(sequences.iter().all(|points| *points != one));
    let mean = one.iter().copied().sum::<Vec2>() / 64.0;
    // The standard error of each is 0.036.
    assert!((mean - 0.5).abs().max_element() < 0.12, "{mean}");
}

#[test]
fn every_argument_matters() {
    for kind in kinds() {
        let s = Sampler { kind, spp: 16, seed: 1 };
        let base = s.pixel(1, 2, 3).get_1d(4);
        assert_eq!(base, s.pixel(1, 2, 3).get_1d(4));
        for other in [
            s.pixel(2, 2, 3).get_1d(4),
            s.pixel(1, 3, 3).get_1d(4),
            s.pixel(1 + (1 << BLOCK), 2, 3).get_1d(4),
            s.pixel(1, 2, 4).get_1d(4),
            s.pixel(1, 2, 3 + (1 << LONGEST)).get_1d(4),
            s.pixel(1, 2, 3).get_1d(5),
            Sampler { seed: 2, ..s }.pixel(1, 2, 3).get_1d(4),
        ] {
            assert_ne!(base, other, "{kind:?}");
        }
    }
}

#[test]
fn names_are_those_of_the_kinds() {
    for kind in kinds() {
        assert_eq!(SamplerKind::named(kind.name()), Some(kind));
    }
    assert_eq!(SamplerKind::default().name(), SAMPLERS[0].0);
}
