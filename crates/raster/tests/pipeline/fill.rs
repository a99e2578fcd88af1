//! The fill rule: of triangles that share an edge, exactly one covers each sample on it (M34).

use crate::stage::{Random, at_pixel, draw_white, framebuffer, reds};
use steradian_raster::{
    State,
    glam::Vec4,
    state::{BlendState, ColorState, Multisample},
};

/// A grid of corners that is larger than the picture; inner corners move at random, cells are split one way or the
/// other.
fn mesh(random: &mut Random, cells: usize, size: f32) -> Vec<[[f32; 2]; 3]> {
    let step = (size + 8.0) / cells as f32;
    let mut corners = vec![[0.0; 2]; (cells + 1) * (cells + 1)];
    for row in 0..=cells {
        for column in 0..=cells {
            // Some corners stay on whole and half pixels, where rules for edges matter most.
            let snap = |x: f32, random: &mut Random| if random.below(2) == 0 { (x * 2.0).round() / 2.0 } else { x };
            let amount = if row.is_multiple_of(cells) || column.is_multiple_of(cells) { 0.0 } else { 0.45 * step };
            let x = column as f32 * step - 4.0 + random.between(-amount, amount);
            let y = row as f32 * step - 4.0 + random.between(-amount, amount);
            corners[row * (cells + 1) + column] = [snap(x, random), snap(y, random)];
        }
    }
    let mut triangles = Vec::new();
    for row in 0..cells {
        for column in 0..cells {
            let at = |dx: usize, dy: usize| corners[(row + dy) * (cells + 1) + column + dx];
            let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            // The diagonal that leaves both triangles turned the same way.
            let turn =
                |p: [f32; 2], q: [f32; 2], r: [f32; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
            if turn(a, b, c) > 0.0 && turn(a, c, d) > 0.0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    triangles
}

#[test]
fn each_sample_belongs_to_one_triangle_of_a_mesh() {
    let mut random = Random(34);
    for samples in [1, 4, 16] {
        for cells in [1, 3, 16, 90] {
            let size = 96;
            // Snapped corners may turn a tiny triangle over; then two cover each other's samples, and the sum is still
            // one with its sign.
            let state = State {
                color: vec![ColorState::blended(BlendState::ADD)],
                multisample: Multisample::samples(samples),
                ..State::default()
            };
            let mut target = framebuffer(size, samples);
            let triangles = mesh(&mut random, cells, size as f32);
            let turned = |t: &[[f32; 2]; 3]| {
                let p = t.map(|p| p.map(|x| (x * 256.0).round_ties_even()));
                (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) < (p[1][1] - p[0][1]) * (p[2][0] - p[0][0])
            };
            let vertices: Vec<_> = triangles
                .iter()
                .flat_map(|t| {
                    let value = if turned(t) { -1.0 } else { 1.0 };
                    t.map(|[x, y]| (at_pixel(x, y, size), Vec4::splat(value)))
                })
                .collect();
            crate::stage::draw(&mut target, state, &vertices);
            for sample in 0..samples {
                for y in 0..size {
                    for x in 0..size {
                        let value = target.color(0).sample([x, y], 0, sample).unwrap().x;
                        assert_eq!(value, 1.0, "{samples} samples, {cells} cells, pixel {x} {y}");
                    }
                }
            }
        }
    }
}

/// Pixels on the border: those on left and top edges belong to a rectangle, those on right and bottom ones do not.
#[test]
fn left_and_top_edges_belong_to_a_triangle() {
    let size = 16;
    let mut target = framebuffer(size, 1);
    let corner = |x: f32, y: f32| at_pixel(x, y, size);
    // From pixel centre (2.5, 3.5) to (6.5, 9.5).
    let [a, b, c, d] = [corner(2.5, 3.5), corner(6.5, 3.5), corner(6.5, 9.5), corner(2.5, 9.5)];
    draw_white(&mut target, State::default(), &[a, b, c, a, c, d]);
    for (i, red) in reds(&target).into_iter().enumerate() {
        let (x, y) = (i % 16, i / 16);
        let inside = (2..6).contains(&x) && (3..9).contains(&y);
        assert_eq!(red, f32::from(u8::from(inside)), "{x} {y}");
    }
}

/// The values of edge functions by addition equal direct ones (M37): coverage is the same when computed sample by
/// sample in exact arithmetic.
#[test]
fn coverage_is_exact() {
    let mut random = Random(37);
    let size = 128;
    for _ in 0..200 {
        let reach = [20.0, 200.0, 5000.0][random.below(3)];
        let corners =
            [(); 3].map(|()| [(); 2].map(|()| (random.between(64.0 - reach, 64.0 + reach) * 256.0).round() / 256.0));
        let mut target = framebuffer(size, 1);
        draw_white(&mut target, State::default(), &corners.map(|[x, y]| at_pixel(x, y, size)));
        // Positions are rounded to 1/256 pixel once more on their way through clip space.
        let p = corners.map(|[x, y]| {
            let clip = at_pixel(x, y, size);
            let window = |v: f64| ((64.0 + v * 64.0) * 256.0).round_ties_even() as i64;
            [window(f64::from(clip.x)), window(-f64::from(clip.y))]
        });
        let cross =
            |a: [i64; 2], b: [i64; 2], q: [i64; 2]| (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]);
        let area = cross(p[0], p[1], p[2]);
        let p = if area < 0 { [p[0], p[2], p[1]] } else { p };
        for (i, red) in reds(&target).into_iter().enumerate() {
            let q = [(i % 128) as i64 * 256 + 128, (i / 128) as i64 * 256 + 128];
            let inside = area != 0
                && (0..3).all(|e| {
                    let (a, b) = (p[e], p[(e + 1) % 3]);
                    let value = cross(a, b, q);
                    let top_left = b[1] < a[1] || (b[1] == a[1] && b[0] > a[0]);
                    value > 0 || (value == 0 && top_left)
                });
            assert_eq!(red != 0.0, inside, "{corners:?} pixel {} {}", i % 128, i / 128);
        }
    }
}
