use super::*;
use crate::color::lab::delta_e;
use crate::spectra::cie::{lambdas, to_xyz};
use glam::DVec3;

/// ΔE between an RGB reflectance and its spectrum, both under the white of the space.
fn error(space: &RgbSpace, rgb: Vec3) -> f64 {
    let white = if *space == ACES2065_1 { aces_d60() } else { d65() };
    let s = RgbSigmoid::new(space, rgb);
    let seen = to_xyz(|l| s.eval(l) * white.eval(l));
    delta_e(seen, space.xyz_from_rgb() * rgb.as_dvec3(), space.white())
}

/// The worst error over a grid of `n³` colours between `lo` and `hi`.
fn worst(space: &RgbSpace, n: u32, lo: f32, hi: f32) -> (f64, Vec3) {
    let at = |i: u32| lo + (hi - lo) * i as f32 / (n - 1) as f32;
    let grid = (0..n * n * n).map(|i| Vec3::new(at(i % n), at(i / n % n), at(i / n / n)));
    grid.map(|c| (error(space, c), c)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

#[test]
fn colours_come_back_over_the_whole_cube() {
    let (e, c) = worst(&REC709, 9, 0.0, 1.0);
    assert!(e < 1.0, "ΔE {e} at {c}");
    // Dark colours, where the nodes crowd.
    let (e, c) = worst(&REC709, 6, 0.002, 0.006);
    assert!(e < 1.0, "ΔE {e} at {c}");
}

/// Dark saturated colours need steeper polynomials than the bound on coefficients allows. This holds the error at what
/// it is, which is pbrt-v4's too.
#[test]
fn dark_saturated_colours_come_out_too_bright() {
    let e = error(&REC709, Vec3::new(0.0, 0.004, 0.0));
    assert!((10.0..16.0).contains(&e), "ΔE {e}");
    let rgb = REC709.rgb_from_xyz() * {
        let s = RgbSigmoid::new(&REC709, Vec3::new(0.0, 0.004, 0.0));
        to_xyz(|l| s.eval(l) * d65().eval(l))
    };
    assert!((rgb - DVec3::new(0.0, 0.004, 0.0)).abs().max_element() < 0.01, "{rgb}");
    let e = error(&REC709, Vec3::new(0.0, 0.05, 0.0));
    assert!(e < 0.5, "ΔE {e}");
}

/// Colours well inside the wider spaces; at their corners no reflectance exists.
#[test]
fn colours_of_wider_spaces_come_back_where_reflectances_exist() {
    for space in [&DCI_P3, &REC2020, &ACES2065_1] {
        let (e, c) = worst(space, 5, 0.35, 0.65);
        assert!(e < 1.0, "{}: ΔE {e} at {c}", space.name());
    }
}

#[test]
fn greys_are_constant_to_the_bit() {
    for v in [0.0, 1.0] {
        let s = RgbSigmoid::new(&REC709, Vec3::splat(v));
        assert!(lambdas().all(|l| s.eval(l) == v));
    }
    for v in [1e-6, 0.1, 0.18, 0.5, 0.73, 0.999] {
        let s = RgbSigmoid::new(&REC709, Vec3::splat(v));
        assert!(lambdas().all(|l| s.eval(l) == s.eval(500.0)));
        assert!((s.eval(500.0) - v).abs() < 1e-6, "{v}: {}", s.eval(500.0));
    }
}

/// Five nodes of pbrt-v4's table for sRGB: it minimises the same difference, so that only the digits of its RGB matrix
/// differ.
#[test]
fn smooth_reflectances_are_those_of_pbrt() {
    for (rgb, pbrt) in PBRT_NODES {
        let (ours, theirs) = (RgbSigmoid::new(&REC709, rgb.into()), RgbSigmoid { c: pbrt });
        for l in lambdas() {
            assert!(
                (ours.eval(l) - theirs.eval(l)).abs() < 1e-3,
                "{rgb:?} at {l} nm: {} {}",
                ours.eval(l),
                theirs.eval(l)
            );
        }
    }
}

#[rustfmt::skip]
const PBRT_NODES: [([f32; 3], [f32; 3]); 5] = [
    ([0.78080314, 0.43377954, 0.37181103], [3.8700506e-05, -0.037140187, 8.631645]),
    ([0.14176507, 0.44655997, 0.3189714], [-6.738404e-05, 0.06982452, -18.166597]),
    ([0.35621977, 0.71243954, 0.8976738], [-3.4532488e-06, -0.003937817, 3.6208591]),
    ([0.2782543, 0.05300082, 0.04416735], [6.895659e-05, -0.065385774, 13.353044]),
    ([0.6135007, 0.96626365, 0.12270015], [-0.00026522856, 0.29444402, -80.169075]),
];

#[test]
fn neighbouring_colours_have_neighbouring_spectra() {
    // Across the planes where the largest component changes, and across nodes.
    let at = |t: f32| RgbSigmoid::new(&REC709, Vec3::new(0.6, 0.2 + 0.7 * t, 0.5));
    for i in 0..2000 {
        let (a, b) = (at(i as f32 / 2000.0), at((i + 1) as f32 / 2000.0));
        for l in [400.0, 480.0, 550.0, 620.0, 700.0] {
            assert!((a.eval(l) - b.eval(l)).abs() < 4e-3, "{i} at {l} nm: {} {}", a.eval(l), b.eval(l));
        }
    }
}

#[test]
fn unbounded_values_scale_and_hold_their_colour() {
    let one = RgbUnbounded::new(&REC709, Vec3::new(0.2, 0.5, 0.1));
    let many = RgbUnbounded::new(&REC709, Vec3::new(0.2, 0.5, 0.1) * 64.0);
    for l in [380.0, 450.0, 550.0, 650.0] {
        assert!((many.eval(l) / one.eval(l) - 64.0).abs() < 1e-3);
    }
    let grey = RgbUnbounded::new(&REC709, Vec3::splat(7.0));
    assert!(lambdas().all(|l| grey.eval(l) == 7.0));
    assert_eq!(RgbUnbounded::new(&REC709, Vec3::ZERO).eval(550.0), 0.0);
    assert!(many.max() >= lambdas().map(|l| many.eval(l)).fold(0.0, f32::max) * (1.0 - 1e-6));
}

#[test]
fn lights_have_the_colour_they_were_given() {
    for rgb in [Vec3::new(17.0, 12.0, 4.0), Vec3::ONE, Vec3::new(0.1, 0.2, 3.0), Vec3::new(5.0, 0.0, 0.0)] {
        for space in RgbSpace::all() {
            // The corners of the wider spaces are no colours of lights.
            if rgb.min_element() < 1.0 && *space != REC709 {
                continue;
            }
            let s = RgbIlluminant::new(space, rgb);
            let back = space.rgb_from_xyz() * to_xyz(|l| s.eval(l));
            let e = (back - rgb.as_dvec3()).abs().max_element() / f64::from(rgb.max_element());
            assert!(e < 6e-3, "{} {rgb}: {back}", space.name());
        }
    }
    let white = RgbIlluminant::new(&REC709, Vec3::ONE);
    assert!(lambdas().all(|l| white.eval(l) == d65().eval(l)));
}

#[test]
fn values_out_of_range_are_clamped() {
    for bad in [f32::NAN, f32::NEG_INFINITY, -1.0] {
        assert_eq!(
            RgbSigmoid::new(&REC709, Vec3::new(bad, 0.3, 0.2)),
            RgbSigmoid::new(&REC709, Vec3::new(0.0, 0.3, 0.2))
        );
    }
    assert_eq!(RgbSigmoid::new(&REC709, Vec3::new(9.0, 0.3, 0.2)), RgbSigmoid::new(&REC709, Vec3::new(1.0, 0.3, 0.2)));
    for v in [f32::NAN, f32::INFINITY, f32::MAX, -1.0, 1e-45, 1e-39, 1e-38] {
        for rgb in [Vec3::splat(v), Vec3::new(v, 0.0, 1.0), Vec3::new(0.0, v, 0.0), Vec3::new(v, v / 2.0, v / 3.0)] {
            let (u, i) = (RgbUnbounded::new(&REC709, rgb), RgbIlluminant::new(&REC709, rgb));
            assert!(lambdas().all(|l| u.eval(l).is_finite() && u.eval(l) >= 0.0 && !i.eval(l).is_nan()), "{rgb}");
        }
    }
}

#[test]
fn the_maximum_is_where_the_spectrum_is_largest() {
    for rgb in [Vec3::new(0.1, 0.8, 0.2), Vec3::new(0.9, 0.1, 0.6), Vec3::new(0.9, 0.3, 0.1), DVec3::ZERO.as_vec3()] {
        let s = RgbSigmoid::new(&REC709, rgb);
        let dense = lambdas().map(|l| s.eval(l)).fold(0.0, f32::max);
        assert!(s.max() >= dense - 1e-6 && s.max() <= dense + 1e-3, "{rgb}: {} {dense}", s.max());
    }
}

/// Spectra that are solved for by themselves have the colour, and are those of the table but for its interpolation.
#[test]
fn solved_spectra_are_those_of_the_table() {
    let space = &REC709;
    let (mut worst, mut farthest) = (0.0_f64, 0.0_f64);
    for i in 0..6 * 6 * 6 {
        let rgb = Vec3::new((i % 6) as f32, (i / 6 % 6) as f32, (i / 36) as f32) / 5.0 * 0.94 + 0.03;
        let (solved, looked_up) = (RgbSigmoid::solved(space, rgb), RgbSigmoid::new(space, rgb));
        let seen = |s: &RgbSigmoid| to_xyz(|l| s.eval(l) * d65().eval(l));
        worst = worst.max(delta_e(seen(&solved), space.xyz_from_rgb() * rgb.as_dvec3(), space.white()));
        farthest = farthest.max(delta_e(seen(&solved), seen(&looked_up), space.white()));
    }
    // The table's own colours are within ΔE 1.
    assert!(worst < 0.3 && farthest < 1.0, "ΔE {worst}, {farthest} apart");
    for rgb in [Vec3::splat(0.3), Vec3::ZERO, Vec3::ONE, Vec3::new(0.0, 0.004, 0.0), Vec3::new(f32::NAN, 2.0, -1.0)] {
        let (solved, looked_up) = (RgbSigmoid::solved(space, rgb), RgbSigmoid::new(space, rgb));
        assert!(solved == looked_up || error(space, rgb) < 1.0, "{rgb}");
    }
}
