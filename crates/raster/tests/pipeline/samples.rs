//! Several samples per pixel (M45).

use crate::stage::{Random, at_pixel, draw, draw_white, framebuffer};
use steradian_raster::{
    SAMPLE_COUNTS, State,
    glam::Vec4,
    sample_position,
    state::{Conservative, Multisample, RasterState},
};

fn state(samples: u32) -> State {
    State { multisample: Multisample::samples(samples), ..State::default() }
}

/// Coverage comes closer to the exact area with each doubling of samples.
#[test]
fn coverage_converges_to_the_area() {
    let size = 32;
    let errors = SAMPLE_COUNTS.map(|samples| {
        let mut random = Random(45);
        let mut error = 0.0;
        for _ in 0..400 {
            let corners = [(); 3].map(|()| [(); 2].map(|()| random.between(0.0, 32.0)));
            let [a, b, c] = corners;
            let exact = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() / 2.0;
            let mut target = framebuffer(size, samples);
            let counters = draw_white(&mut target, state(samples), &corners.map(|[x, y]| at_pixel(x, y, size)));
            error += (f64::from(exact) - counters.samples_passed as f64 / f64::from(samples)).abs();
        }
        error / 400.0
    });
    assert!(errors.windows(2).all(|pair| pair[1] < 0.85 * pair[0]), "{errors:?}");
    assert!(errors[4] < 0.2 * errors[0], "{errors:?}");
}

/// Each sample is covered by its place, and the resolved colour is the mean.
#[test]
fn samples_lie_where_the_pattern_says() {
    for samples in SAMPLE_COUNTS {
        let mut target = framebuffer(8, samples);
        // All that lies left of a slanted line through pixel 3, 3.
        let corners = [[-20.0, -20.0], [2.7 + 10.0, -20.0], [-20.0, 25.0]];
        draw_white(&mut target, state(samples), &corners.map(|[x, y]| at_pixel(x, y, 8)));
        let line = |x: f32, y: f32| (x + 20.0) / 32.7 + (y + 20.0) / 45.0 < 1.0;
        for y in 0..8 {
            for x in 0..8 {
                let mut covered = 0;
                for s in 0..samples {
                    let [dx, dy] = sample_position(samples, s);
                    let inside = line(x as f32 + dx, y as f32 + dy);
                    covered += u32::from(inside);
                    let value = target.color(0).sample([x, y], 0, s).unwrap().x;
                    assert_eq!(value, f32::from(u8::from(inside)), "{samples} samples: pixel {x} {y}, sample {s}");
                }
                let resolved = target.color(0).resolve().pixel(x, y).unwrap().x;
                assert_eq!(resolved, covered as f32 / samples as f32);
            }
        }
    }
}

#[test]
fn masks_and_alpha_to_coverage() {
    let whole = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].map(|[x, y]| Vec4::new(x, y, 0.5, 1.0));
    let mut target = framebuffer(8, 8);
    let masked =
        State { multisample: Multisample { mask: 0b1010_0110, ..Multisample::samples(8) }, ..State::default() };
    assert_eq!(draw_white(&mut target, masked, &whole).samples_passed, 64 * 4);
    for eighths in 0..=8 {
        let mut target = framebuffer(8, 8);
        let state = State {
            multisample: Multisample { alpha_to_coverage: true, alpha_to_one: true, ..Multisample::samples(8) },
            ..State::default()
        };
        let vertices = whole.map(|p| (p, Vec4::new(1.0, 1.0, 1.0, eighths as f32 / 8.0)));
        assert_eq!(draw(&mut target, state, &vertices).samples_passed, 64 * eighths);
        let alpha = target.color(0).resolve().pixel(3, 3).unwrap().w;
        assert_eq!(alpha, eighths as f32 / 8.0);
    }
}

/// Pixels that a triangle touches, and pixels that it covers wholly, against clipping each pixel's square exactly.
#[test]
fn conservative_rasterisation() {
    let mut random = Random(99);
    let size = 24;
    for _ in 0..60 {
        // Corners on the sub-pixel grid, so that rounding moves nothing.
        let mut corners = [(); 3].map(|()| [(); 2].map(|()| (random.between(1.0, 23.0) * 64.0).round() / 64.0));
        let cross = |a: [f32; 2], b: [f32; 2], q: [f32; 2]| {
            let f = |v: f32| f64::from(v);
            (f(b[0]) - f(a[0])) * (f(q[1]) - f(a[1])) - (f(b[1]) - f(a[1])) * (f(q[0]) - f(a[0]))
        };
        if cross(corners[0], corners[1], corners[2]) < 0.0 {
            corners.swap(1, 2);
        }
        if cross(corners[0], corners[1], corners[2]) < 1.0 {
            continue;
        }
        for conservative in [Conservative::Overestimate, Conservative::Underestimate] {
            let mut target = framebuffer(size, 1);
            let state = State { raster: RasterState { conservative, ..RasterState::default() }, ..State::default() };
            draw_white(&mut target, state, &corners.map(|[x, y]| at_pixel(x, y, size)));
            for y in 0..size {
                for x in 0..size {
                    let drawn = target.color(0).pixel(x, y).unwrap().x != 0.0;
                    let square = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(dx, dy)| [(x + dx) as f32, (y + dy) as f32]);
                    let edges = || (0..3).map(|e| (corners[e], corners[(e + 1) % 3]));
                    let wholly = square.iter().all(|q| edges().all(|(a, b)| cross(a, b, *q) >= 0.0));
                    // Convex sets are apart where an edge of one of them has the other outside.
                    let bound = |axis: usize| {
                        corners
                            .map(|c| c[axis])
                            .into_iter()
                            .fold((f32::MAX, f32::MIN), |(l, h), v| (l.min(v), h.max(v)))
                    };
                    let ((x0, x1), (y0, y1)) = (bound(0), bound(1));
                    let apart = x1 < x as f32
                        || y1 < y as f32
                        || x0 > (x + 1) as f32
                        || y0 > (y + 1) as f32
                        || edges().any(|(a, b)| square.iter().all(|q| cross(a, b, *q) < 0.0));
                    match conservative {
                        Conservative::Overestimate => {
                            assert!(
                                drawn
                                    || apart
                                    || (x1 <= x as f32)
                                    || (y1 <= y as f32)
                                    || x0 >= (x + 1) as f32
                                    || y0 >= (y + 1) as f32,
                                "{corners:?} {x} {y}"
                            );
                            assert!(!drawn || !apart, "{corners:?} {x} {y}");
                        }
                        _ => assert_eq!(drawn, wholly, "{corners:?} {x} {y}"),
                    }
                }
            }
        }
    }
}
