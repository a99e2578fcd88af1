//! Laws of every atlas.

use crate::shapes::Shape;
use steradian_unwrap::{Atlas, NO_CHART, Options, unwrap};

/// Coordinates in steps of 2⁻²³, of which they are multiples.
type Point = [i64; 2];

const STEPS: f64 = (1 << 23) as f64;

fn twice_area(a: Point, b: Point, c: Point) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The atlas of a mesh by default options, held against all laws.
pub fn checked(shape: &Shape) -> Atlas {
    checked_with(shape, &Options::default())
}

/// The atlas of a mesh, held against all laws.
pub fn checked_with(shape: &Shape, options: &Options) -> Atlas {
    let atlas = unwrap(&shape.mesh(), options).unwrap();
    assert_eq!(atlas, unwrap(&shape.mesh(), options).unwrap(), "the same bits in every run");
    assert_eq!(atlas.uvs.len(), atlas.sources.len());
    for (new, old) in atlas.triangles.iter().zip(&shape.triangles) {
        assert_eq!(new.map(|i| atlas.sources[i as usize]), *old, "the same triangles");
    }
    let exact = |uv: [f32; 2]| {
        uv.map(|x| {
            let steps = f64::from(x) * STEPS;
            assert!(steps == steps.round() && (0.0..=1.0).contains(&x), "{x}");
            steps as i64
        })
    };
    let points: Vec<Point> = atlas.uvs.iter().map(|uv| exact(*uv)).collect();
    let corners: Vec<[Point; 3]> = atlas.triangles.iter().map(|t| t.map(|i| points[i as usize])).collect();
    let areas: Vec<i64> = corners.iter().map(|[a, b, c]| twice_area(*a, *b, *c)).collect();
    assert!(areas.iter().all(|area| *area >= 0));
    assert_eq!(areas.iter().filter(|area| **area == 0).count(), atlas.metrics.degenerate);
    let m = &atlas.metrics;
    assert!(m.stretch_l2 > 0.999_999 && m.stretch_max >= m.stretch_l2 - 1e-9 && m.conformal > 0.999_999, "{m:?}");
    assert!(m.utilisation > 0.0 && m.utilisation <= 1.0 && m.seam_length.is_finite(), "{m:?}");
    assert_eq!(atlas.charts.iter().filter(|c| **c != NO_CHART).max().map(|c| *c as usize + 1), Some(m.charts));
    nothing_overlaps(&corners, &areas);
    padding_is_held(&atlas, &corners, options);
    atlas
}

/// No two triangles with areas have more in common than edges: of any two, a side of one separates them.
fn nothing_overlaps(corners: &[[Point; 3]], areas: &[i64]) {
    const CELLS: i64 = 128;
    let cell = |x: i64| ((x * CELLS) >> 23).min(CELLS - 1);
    let mut entries = Vec::new();
    for (t, [a, b, c]) in corners.iter().enumerate().filter(|(t, _)| areas[*t] > 0) {
        let range = |k: usize| cell(a[k].min(b[k]).min(c[k]))..=cell(a[k].max(b[k]).max(c[k]));
        entries.extend(range(1).flat_map(|y| range(0).map(move |x| (y * CELLS + x, t))));
    }
    entries.sort_unstable();
    let separates =
        |a: &[Point; 3], b: &[Point; 3]| (0..3).any(|i| b.iter().all(|p| twice_area(a[i], a[(i + 1) % 3], *p) <= 0));
    for group in entries.chunk_by(|a, b| a.0 == b.0) {
        for (k, (_, i)) in group.iter().enumerate() {
            for (_, j) in &group[..k] {
                let (a, b) = (&corners[*i], &corners[*j]);
                assert!(separates(a, b) || separates(b, a), "triangles {i} and {j}: {a:?} {b:?}");
            }
        }
    }
}

/// Corners of charts are as far from the sides of others as the padding, but for the rounding of coordinates. Triangles
/// of one chart are not compared, nor those without area.
fn padding_is_held(atlas: &Atlas, corners: &[[Point; 3]], options: &Options) {
    let texels = f64::from(options.resolution);
    let padding = f64::from(options.padding);
    let at = |p: Point| p.map(|x| x as f64 / STEPS * texels);
    let is_near = |a: &[Point; 3], b: &[Point; 3]| {
        let reach = (padding / texels * STEPS) as i64 + 1;
        (0..2).all(|k| {
            let ends = |t: &[Point; 3]| (t.iter().map(|p| p[k]).min().unwrap(), t.iter().map(|p| p[k]).max().unwrap());
            let ((low, high), (from, to)) = (ends(a), ends(b));
            low <= to + reach && from <= high + reach
        })
    };
    let charted: Vec<usize> = (0..corners.len()).filter(|t| atlas.charts[*t] != NO_CHART).collect();
    let mut sorted = charted;
    sorted.sort_by_key(|t| corners[*t].iter().map(|p| p[0]).min());
    let reach = ((padding + 1.0) / texels * STEPS) as i64;
    for (k, &i) in sorted.iter().enumerate() {
        let end = corners[i].iter().map(|p| p[0]).max().unwrap() + reach;
        let others = sorted[k + 1..].iter().take_while(|j| corners[**j].iter().any(|p| p[0] <= end));
        for &j in others.filter(|j| atlas.charts[i] != atlas.charts[**j] && is_near(&corners[i], &corners[**j])) {
            for (a, b) in [(i, j), (j, i)] {
                for p in corners[a] {
                    for side in 0..3 {
                        let ends = [corners[b][side], corners[b][(side + 1) % 3]].map(at);
                        let d = distance(at(p), ends);
                        assert!(d > padding - 0.01, "triangles {a} and {b} are {d} texels apart");
                    }
                }
            }
        }
    }
}

/// Distance of a point from a segment.
fn distance(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = u[0] * u[0] + u[1] * u[1];
    let t = if length > 0.0 { ((u[0] * v[0] + u[1] * v[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    (v[0] - t * u[0]).hypot(v[1] - t * u[1])
}
