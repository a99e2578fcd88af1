//! The fixed part of tessellation: points, lines and triangles of a domain for given levels (OpenGL 4.6, section
//! 11.2.2).

use glam::Vec3;

use crate::stages::{Domain, Levels, Spacing};

/// The largest level.
const LARGEST: f32 = 64.0;

/// A domain taken apart.
#[derive(Clone, Debug, Default)]
pub struct TessellatedDomain {
    /// The points: (u, v, w) of triangles, else (u, v, 0).
    pub points: Vec<Vec3>,
    /// Counter-clockwise triangles, u to the right and v up.
    pub triangles: Vec<[u32; 3]>,
    /// Segments of isolines.
    pub lines: Vec<[u32; 2]>,
}

impl TessellatedDomain {
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.triangles.clear();
        self.lines.clear();
    }

    fn point(&mut self, point: Vec3) -> u32 {
        self.points.push(point);
        self.points.len() as u32 - 1
    }
}

/// A side of a ring: points and how far along the domain's edge they are.
type Side = Vec<(u32, f32)>;

/// Takes a domain apart; adds nothing if an outer level that the domain uses is not positive.
pub fn tessellate(domain: Domain, spacing: Spacing, levels: &Levels, out: &mut TessellatedDomain) {
    let used = match domain {
        Domain::Triangles => 3,
        Domain::Quads => 4,
        Domain::Isolines => 2,
    };
    if levels.outer[..used].iter().all(|&level| level > 0.0) {
        match domain {
            Domain::Triangles => triangles(spacing, levels, out),
            Domain::Quads => quads(spacing, levels, out),
            Domain::Isolines => isolines(spacing, levels, out),
        }
    }
}

/// Cuts of an edge into segments: n + 1 places from 0 to 1, symmetric bit for bit, so that patches on both sides agree.
fn cuts(spacing: Spacing, level: f32) -> Vec<f32> {
    let (least, most) = match spacing {
        Spacing::Equal => (1.0, LARGEST),
        Spacing::FractionalEven => (2.0, LARGEST),
        Spacing::FractionalOdd => (1.0, LARGEST - 1.0),
    };
    // Clamp the level, then round up to a whole, even or odd number of segments.
    let level = if level >= least { level.min(most) } else { least };
    let whole = level.ceil() as usize;
    let (n, level) = match spacing {
        Spacing::Equal => (whole, whole as f32),
        Spacing::FractionalEven => (whole + whole % 2, level),
        Spacing::FractionalOdd => (whole + 1 - whole % 2, level),
    };
    // n − 2 segments of length 1/level, and a shorter one at each end.
    let short = (level - (n as f32 - 2.0)) / 2.0 / level;
    let mut cuts = vec![0.0; n + 1];
    for k in 1..=n / 2 {
        let place = if 2 * k == n { 0.5 } else { short + (k - 1) as f32 / level };
        cuts[n - k] = 1.0 - place;
        // So that 1 − (1 − x) = x.
        cuts[k] = 1.0 - cuts[n - k];
    }
    cuts[n] = 1.0;
    cuts
}

/// The cuts of the inside: a single segment becomes more where the border has more.
fn inner_cuts(spacing: Spacing, level: f32, alone: bool) -> Vec<f32> {
    let cuts_of = cuts(spacing, level);
    if cuts_of.len() == 2 && !alone { cuts(spacing, 1.0 + f32::EPSILON) } else { cuts_of }
}

/// Fills the strip between a side of a ring and the same side of the next ring inwards.
fn stitch(triangles: &mut Vec<[u32; 3]>, outer: &[(u32, f32)], inner: &[(u32, f32)]) {
    let (mut i, mut j) = (0, 0);
    while i + 1 < outer.len() || j + 1 < inner.len() {
        // Advance on the side whose next segment has the nearer midpoint: the strip stays balanced.
        let outer_next =
            i + 1 < outer.len() && (j + 1 == inner.len() || outer[i].1 + outer[i + 1].1 <= inner[j].1 + inner[j + 1].1);
        if outer_next {
            triangles.push([outer[i].0, outer[i + 1].0, inner[j].0]);
            i += 1;
        } else {
            triangles.push([outer[i].0, inner[j + 1].0, inner[j].0]);
            j += 1;
        }
    }
}

/// Closes a ring: the sides' points, where each side ends with the first point of the next. `place(side, k)` is point k
/// of a side.
fn ring(out: &mut TessellatedDomain, sides: &[&[f32]], place: impl Fn(usize, f32) -> Vec3) -> Vec<Side> {
    let mut ring: Vec<Side> = Vec::with_capacity(sides.len());
    // Each side contributes all but its last point, which is the first of the next side.
    for (side, cuts) in sides.iter().enumerate() {
        let points = cuts[..cuts.len() - 1].iter().map(|&at| (out.point(place(side, at)), at)).collect();
        ring.push(points);
    }
    // Share the corner between one side and the next.
    for side in 0..ring.len() {
        let first = ring[(side + 1) % ring.len()].first().map(|p| p.0);
        if let (Some(first), Some(end)) = (first, sides[side].last()) {
            ring[side].push((first, *end));
        }
    }
    ring
}

fn triangles(spacing: Spacing, levels: &Levels, out: &mut TessellatedDomain) {
    let corners = [Vec3::X, Vec3::Y, Vec3::Z];
    // Side i runs from corner i to the next; the outer level of the edge opposite corner i has number i.
    let outer = [2, 0, 1].map(|edge: usize| cuts(spacing, levels.outer[edge]));
    let alone = outer.iter().all(|cuts| cuts.len() == 2);
    let inner = inner_cuts(spacing, levels.inner[0], alone);
    let n = inner.len() - 1;
    let edge = |side: usize, at: f32| corners[side] * (1.0 - at) + corners[(side + 1) % 3] * at;
    // Outermost ring from the outer levels, then rings inwards from the inner level.
    let mut around = ring(out, &[&outer[0], &outer[1], &outer[2]], edge);
    if n == 1 {
        out.triangles.push([0, 1, 2].map(|side: usize| around[side][0].0));
        return;
    }
    for k in 1..=n / 2 {
        // Corners of the ring: where the perpendiculars at the k-th cuts of two edges meet.
        let far = 2.0 / 3.0 * inner[k];
        let corner = |i: usize| corners[i] * (1.0 - 2.0 * far) + (Vec3::ONE - corners[i]) * far;
        let cuts = &inner[k..=n - k];
        // The innermost ring is a point or a triangle, by the parity of the level.
        let next = if cuts.len() == 1 {
            let centre = out.point(Vec3::splat(1.0 / 3.0));
            vec![vec![(centre, 0.5)]; 3]
        } else {
            let (start, length) = (inner[k], inner[n - k] - inner[k]);
            // Interpolate along the straight side between two corners of the ring.
            let place = |side: usize, at: f32| corner(side).lerp(corner((side + 1) % 3), (at - start) / length);
            ring(out, &[cuts, cuts, cuts], place)
        };
        for side in 0..3 {
            stitch(&mut out.triangles, &around[side], &next[side]);
        }
        if cuts.len() == 2 {
            out.triangles.push([0, 1, 2].map(|side: usize| next[side][0].0));
        }
        around = next;
    }
}

fn quads(spacing: Spacing, levels: &Levels, out: &mut TessellatedDomain) {
    // Sides counter-clockwise from the origin: v = 0, u = 1, v = 1, u = 0. Outer levels are of u = 0, v = 0, u = 1, v =
    // 1.
    let outer = [1, 2, 3, 0].map(|edge: usize| cuts(spacing, levels.outer[edge]));
    let alone =
        outer.iter().all(|cuts| cuts.len() == 2) && levels.inner.iter().all(|&level| cuts(spacing, level).len() == 2);
    let edge = |side: usize, at: f32| match side {
        0 => Vec3::new(at, 0.0, 0.0),
        1 => Vec3::new(1.0, at, 0.0),
        2 => Vec3::new(1.0 - at, 1.0, 0.0),
        _ => Vec3::new(0.0, 1.0 - at, 0.0),
    };
    let around = ring(out, &[&outer[0], &outer[1], &outer[2], &outer[3]], edge);
    // The patch is a single quad: two triangles.
    if alone {
        let [a, b, c, d] = [0, 1, 2, 3].map(|side: usize| around[side][0].0);
        out.triangles.extend([[a, b, c], [a, c, d]]);
        return;
    }
    let [us, vs] = [0, 1].map(|axis: usize| inner_cuts(spacing, levels.inner[axis], false));
    // The grid inside, of which the border may fall together to a line or a point.
    let (columns, rows) = (us.len() - 2, vs.len() - 2);
    let first = out.points.len() as u32;
    // A regular grid inside, joined to the four sides by stitched strips.
    for v in &vs[1..=rows] {
        out.points.extend(us[1..=columns].iter().map(|&u| Vec3::new(u, *v, 0.0)));
    }
    let at = |column: usize, row: usize| first + (row * columns + column) as u32;
    for row in 1..rows {
        for column in 1..columns {
            let [a, b] = [at(column - 1, row - 1), at(column, row - 1)];
            let [d, c] = [at(column - 1, row), at(column, row)];
            out.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    // The border of the grid, as four sides in the order of the outer ring.
    let inner: [Side; 4] = [
        (0..columns).map(|i| (at(i, 0), us[i + 1])).collect(),
        (0..rows).map(|i| (at(columns - 1, i), vs[i + 1])).collect(),
        (0..columns).rev().map(|i| (at(i, rows - 1), 1.0 - us[i + 1])).collect(),
        (0..rows).rev().map(|i| (at(0, i), 1.0 - vs[i + 1])).collect(),
    ];
    for side in 0..4 {
        stitch(&mut out.triangles, &around[side], &inner[side]);
    }
}

fn isolines(spacing: Spacing, levels: &Levels, out: &mut TessellatedDomain) {
    let count = cuts(Spacing::Equal, levels.outer[0]);
    let along = cuts(spacing, levels.outer[1]);
    // A line for each cut but the last, as the specification asks.
    for v in &count[..count.len() - 1] {
        let first = out.points.len() as u32;
        out.points.extend(along.iter().map(|&u| Vec3::new(u, *v, 0.0)));
        out.lines.extend((0..along.len() as u32 - 1).map(|i| [first + i, first + i + 1]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn domain(kind: Domain, spacing: Spacing, levels: Levels) -> TessellatedDomain {
        let mut out = TessellatedDomain::default();
        tessellate(kind, spacing, &levels, &mut out);
        out
    }

    /// Area of the domain and whether all triangles are counter-clockwise; edges that are not shared by two.
    fn check(out: &TessellatedDomain) -> (f64, usize) {
        let mut edges = std::collections::HashMap::new();
        let mut area = 0.0;
        for &[a, b, c] in &out.triangles {
            let [p, q, r] = [a, b, c].map(|i| out.points[i as usize].truncate().as_dvec2());
            let twice = (q - p).perp_dot(r - p);
            assert!(twice >= -1e-7, "clockwise: {p} {q} {r}");
            area += twice / 2.0;
            for (i, j) in [(a, b), (b, c), (c, a)] {
                *edges.entry((i.min(j), i.max(j))).or_insert(0) += if i < j { 1 } else { -1 };
            }
        }
        (area, edges.values().filter(|&&n| n != 0).count())
    }

    /// The domain is covered once, without gaps, and the border has as many edges as the levels say (M197).
    #[test]
    fn triangles_cover_the_domain_once() {
        for spacing in [Spacing::Equal, Spacing::FractionalEven, Spacing::FractionalOdd] {
            for outer in [[1.0, 1.0, 1.0, 1.0], [2.5, 3.0, 7.9, 4.0], [64.0, 1.0, 5.5, 13.0]] {
                for inner in [[1.0, 1.0], [1.0, 4.0], [2.0, 3.0], [3.5, 9.2], [6.0, 1.0], [17.0, 64.0]] {
                    let levels = Levels { outer, inner };
                    let segments =
                        |count: usize| outer[..count].iter().map(|&l| cuts(spacing, l).len() - 1).sum::<usize>();
                    let (area, border) = check(&domain(Domain::Triangles, spacing, levels));
                    assert!(
                        (area - 0.5).abs() < 1e-6 && border == segments(3),
                        "{spacing:?} {levels:?} {area} {border}"
                    );
                    let (area, border) = check(&domain(Domain::Quads, spacing, levels));
                    assert!(
                        (area - 1.0).abs() < 1e-6 && border == segments(4),
                        "{spacing:?} {levels:?} {area} {border}"
                    );
                }
            }
        }
    }

    /// n² triangles for level n of both kinds with equal spacing, as the rings of the specification give for odd and
    /// even n.
    #[test]
    fn uniform_levels_have_known_counts() {
        for n in 2..20usize {
            let levels = Levels::uniform(n as f32);
            let out = domain(Domain::Quads, Spacing::Equal, levels);
            assert_eq!((out.points.len(), out.triangles.len()), ((n + 1) * (n + 1), 2 * n * n), "quad {n}");
            // Rings of 3·(n − 2k) points; the last is a point or a triangle.
            let out = domain(Domain::Triangles, Spacing::Equal, levels);
            let rings = (0..).map(|k| n as i64 - 2 * k).take_while(|&m| m >= 0);
            let points: i64 = rings.map(|m| if m == 0 { 1 } else { 3 * m }).sum();
            assert_eq!(out.points.len() as i64, points, "triangle {n}");
            // Euler: triangles = 2·points − 2 − border.
            assert_eq!(out.triangles.len() as i64, 2 * points - 2 - 3 * n as i64);
        }
    }

    #[test]
    fn isolines_and_dropped_patches() {
        let levels = Levels { outer: [3.0, 5.0, 0.0, 0.0], inner: [0.0; 2] };
        let out = domain(Domain::Isolines, Spacing::Equal, levels);
        assert_eq!((out.points.len(), out.lines.len()), (18, 15));
        assert!(out.points.iter().all(|p| p.y < 1.0));
        for level in [0.0, -1.0, f32::NAN] {
            let levels = Levels { outer: [1.0, level, 1.0, 1.0], inner: [4.0; 2] };
            assert!(domain(Domain::Triangles, Spacing::Equal, levels).points.is_empty());
        }
    }

    /// Cuts are symmetric bit for bit, and change continuously with the level.
    #[test]
    fn cuts_are_symmetric_and_continuous() {
        for spacing in [Spacing::Equal, Spacing::FractionalEven, Spacing::FractionalOdd] {
            for i in 0..660 {
                let places = cuts(spacing, i as f32 * 0.1);
                let n = places.len() - 1;
                assert!((0..=n).all(|k| places[n - k] == 1.0 - places[k]), "{spacing:?} {places:?}");
                assert!(places.windows(2).all(|pair| pair[0] <= pair[1]));
            }
        }
        let (below, above) = (cuts(Spacing::FractionalEven, 4.0), cuts(Spacing::FractionalEven, 4.0001));
        assert_eq!((below.len(), above.len()), (5, 7));
        assert!((above[1]).abs() < 1e-4 && (above[2] - below[1]).abs() < 1e-4);
    }
}
