//! Planar polygons of several outlines as triangles.
//!
//! The plane is cut into strips at the heights of all corners and crossings. In a strip edges do not cross, so that
//! they have an order, and by the rule of filling each gap between two is inside or not. An edge is in the strips
//! between its ends: horizontal ones are in none, and a corner counts once however edges meet in it. What is inside
//! becomes trapezoids, and these triangles that share all vertices between strips, so that no gap opens between them.

use crate::intersect::FillRule;
use glam::DVec2;

/// Most corners; the time is their square.
const MOST_CORNERS: usize = 1 << 13;
/// Most trapezoids.
const MOST_PARTS: usize = 1 << 20;
/// Distance below which points count as one, as a part of the extent.
const NEAR: f64 = 1e-12;

/// The triangles that fill a polygon.
#[derive(Clone, Debug, Default)]
pub struct Filled {
    /// Their vertices: corners, crossings, and places on edges.
    pub points: Vec<DVec2>,
    /// Counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

struct Edge {
    low: DVec2,
    high: DVec2,
    /// Numbers of the heights of its ends.
    levels: [usize; 2],
    winding: i32,
}

impl Edge {
    fn x(&self, level: usize, y: f64) -> f64 {
        match level {
            l if l <= self.levels[0] => self.low.x,
            l if l >= self.levels[1] => self.high.x,
            _ => self.low.x + (self.high.x - self.low.x) * ((y - self.low.y) / (self.high.y - self.low.y)),
        }
    }
}

/// A part of a strip, by its sides at the lower and the upper height.
struct Part {
    strip: usize,
    left: [f64; 2],
    right: [f64; 2],
}

/// Fills closed outlines; `None` where they are too many or not finite. Cost: the square of the number of corners, and
/// for each strip the edges in it.
pub fn fill(outlines: &[Vec<DVec2>], rule: FillRule) -> Option<Filled> {
    let corners: Vec<DVec2> = outlines.iter().flatten().copied().collect();
    if corners.len() > MOST_CORNERS || !corners.iter().all(|p| p.is_finite()) {
        return None;
    }
    let extent = corners.iter().fold(0.0, |m: f64, p| m.max((*p - corners[0]).abs().max_element()));
    let near = NEAR * extent;
    let mut edges: Vec<Edge> = outlines.iter().flat_map(|outline| outline_edges(outline)).collect();
    let mut heights: Vec<f64> = corners.iter().map(|p| p.y).chain(crossings(&edges)).collect();
    merge(&mut heights, near);
    for e in &mut edges {
        e.levels = [e.low.y, e.high.y].map(|y| nearest(&heights, y));
    }
    edges.sort_by_key(|e| e.levels[0]);
    let parts = parts(&edges, &heights, rule)?;

    // The vertices at each height, from the strips on both sides.
    let mut rows = vec![Vec::new(); heights.len()];
    for part in &parts {
        for side in 0..2 {
            rows[part.strip + side].extend([part.left[side], part.right[side]]);
        }
    }
    rows.iter_mut().for_each(|row| merge(row, near));
    let mut filled = Filled::default();
    let mut firsts = Vec::with_capacity(rows.len());
    for (row, y) in rows.iter().zip(&heights) {
        firsts.push(filled.points.len());
        filled.points.extend(row.iter().map(|x| DVec2::new(*x, *y)));
    }
    for part in &parts {
        let [low, high] = [0, 1].map(|side| {
            let (row, first) = (&rows[part.strip + side], firsts[part.strip + side]);
            first + nearest(row, part.left[side])..=first + nearest(row, part.right[side])
        });
        zip(&mut filled, low, high);
    }
    Some(filled)
}

fn outline_edges(outline: &[DVec2]) -> impl Iterator<Item = Edge> {
    let ends = outline.iter().zip(outline.iter().cycle().skip(1));
    ends.filter(|(a, b)| a.y != b.y).map(|(a, b)| {
        let (low, high, winding) = if a.y < b.y { (*a, *b, 1) } else { (*b, *a, -1) };
        Edge { low, high, levels: [0; 2], winding }
    })
}

/// The heights at which edges cross each other.
fn crossings(edges: &[Edge]) -> Vec<f64> {
    let mut heights = Vec::new();
    for (k, a) in edges.iter().enumerate() {
        for b in &edges[k + 1..] {
            let (low, high) = (a.low.y.max(b.low.y), a.high.y.min(b.high.y));
            let (da, db) = (a.high - a.low, b.high - b.low);
            let across = da.perp_dot(db);
            if low >= high || across == 0.0 {
                continue;
            }
            let y = a.low.y + da.y * ((b.low - a.low).perp_dot(db) / across);
            if y > low && y < high {
                heights.push(y);
            }
        }
    }
    heights
}

/// Sorts numbers, and leaves out those near the one before.
fn merge(numbers: &mut Vec<f64>, near: f64) {
    numbers.sort_by(f64::total_cmp);
    numbers.dedup_by(|b, a| *b - *a <= near);
}

/// The number of the nearest.
fn nearest(sorted: &[f64], v: f64) -> usize {
    let k = sorted.partition_point(|s| *s < v);
    if k > 0 && (k == sorted.len() || v - sorted[k - 1] <= sorted[k] - v) { k - 1 } else { k }
}

/// Interior of the polygon, strip by strip.
fn parts(edges: &[Edge], heights: &[f64], rule: FillRule) -> Option<Vec<Part>> {
    let mut parts = Vec::new();
    let (mut active, mut next) = (Vec::<&Edge>::new(), 0);
    for strip in 0..heights.len().saturating_sub(1) {
        active.retain(|e| e.levels[1] > strip);
        while next < edges.len() && edges[next].levels[0] <= strip {
            active.extend(Some(&edges[next]).filter(|e| e.levels[1] > strip));
            next += 1;
        }
        let x = |e: &Edge| [e.x(strip, heights[strip]), e.x(strip + 1, heights[strip + 1])];
        active.sort_by(|a, b| (x(a)[0] + x(a)[1]).total_cmp(&(x(b)[0] + x(b)[1])));
        let (mut winding, mut count, mut left) = (0, 0_u32, None);
        for e in &active {
            (winding, count) = (winding + e.winding, count + 1);
            let is_inside = match rule {
                FillRule::EvenOdd => count % 2 == 1,
                FillRule::NonZero => winding != 0,
            };
            match left {
                None if is_inside => left = Some(x(e)),
                Some(from) if !is_inside => {
                    parts.push(Part { strip, left: from, right: x(e) });
                    left = None;
                }
                _ => {}
            }
        }
        if parts.len() > MOST_PARTS {
            return None;
        }
    }
    Some(parts)
}

/// Triangles between two rows of vertices.
fn zip(filled: &mut Filled, low: std::ops::RangeInclusive<usize>, high: std::ops::RangeInclusive<usize>) {
    let (mut a, mut b) = (*low.start(), *high.start());
    let (last_a, last_b) = (*low.end(), *high.end());
    let along = |k: usize, [first, last]: [usize; 2]| {
        let x = |k: usize| filled.points[k].x;
        (x(k) - x(first)) / (x(last) - x(first))
    };
    let mut triangles = Vec::new();
    while a < last_a || b < last_b {
        let is_low_next = b >= last_b
            || (a < last_a && along(a + 1, [*low.start(), last_a]) <= along(b + 1, [*high.start(), last_b]));
        if is_low_next {
            triangles.push([a, a + 1, b]);
            a += 1;
        } else {
            triangles.push([a, b + 1, b]);
            b += 1;
        }
    }
    filled.triangles.extend(triangles.into_iter().map(|t| t.map(|k| k as u32)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Vec2, hash::HashRng, intersect::winding_number};
    use std::collections::HashSet;

    fn loops(list: &[&[[f64; 2]]]) -> Vec<Vec<DVec2>> {
        list.iter().map(|l| l.iter().map(|p| DVec2::from(*p)).collect()).collect()
    }

    fn area(f: &Filled) -> f64 {
        let corner = |k: u32| f.points[k as usize];
        f.triangles.iter().map(|&[a, b, c]| 0.5 * (corner(b) - corner(a)).perp_dot(corner(c) - corner(a))).sum()
    }

    /// No triangle is turned over, no edge is on one side of two, and no vertex lies within an edge of another.
    fn check_conforming(f: &Filled) {
        let mut edges = HashSet::new();
        for t in &f.triangles {
            let [a, b, c] = t.map(|k| f.points[k as usize]);
            assert!((b - a).perp_dot(c - a) > 0.0, "{a} {b} {c}");
            (0..3).for_each(|k| assert!(edges.insert([t[k], t[(k + 1) % 3]])));
        }
        for &[a, b] in edges.iter().filter(|e| !edges.contains(&[e[1], e[0]])) {
            let (p, q) = (f.points[a as usize], f.points[b as usize]);
            for r in &f.points {
                let s = (*r - p).dot(q - p) / (q - p).length_squared();
                let is_within = s > 1e-9 && s < 1.0 - 1e-9 && (q - p).perp_dot(*r - p).abs() < 1e-9;
                // Two outlines may touch there, but only strips of one row would make a gap.
                assert!(!is_within || r.y != p.y || p.y != q.y, "{r} in {p} {q}");
            }
        }
    }

    /// Points inside, by the triangles and by counting the crossings of a half-line in another way.
    fn check_points(outlines: &[Vec<DVec2>], rule: FillRule, seed: u64) {
        let f = fill(outlines, rule).unwrap();
        check_conforming(&f);
        let mut rng = HashRng::new(seed);
        for _ in 0..2000 {
            let p = DVec2::new(f64::from(rng.next_f32()), f64::from(rng.next_f32())) * 2.4 - 1.2;
            let winding: Vec<i32> = outlines
                .iter()
                .map(|l| winding_number(p.as_vec2(), &l.iter().map(|q| q.as_vec2()).collect::<Vec<Vec2>>()))
                .collect();
            let expected = match rule {
                FillRule::NonZero => winding.iter().sum::<i32>() != 0,
                FillRule::EvenOdd => winding.iter().sum::<i32>() % 2 != 0,
            };
            let holders = f.triangles.iter().filter(|t| {
                let [a, b, c] = t.map(|k| f.points[k as usize]);
                let side = |a: DVec2, b: DVec2| (b - a).perp_dot(p - a);
                side(a, b) > 0.0 && side(b, c) > 0.0 && side(c, a) > 0.0
            });
            assert_eq!(holders.count(), usize::from(expected), "{p}");
        }
    }

    #[test]
    fn known_areas() {
        let square: &[[f64; 2]] = &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let hole: &[[f64; 2]] = &[[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0]];
        let same_way: Vec<_> = hole.iter().rev().copied().collect();
        let whole = fill(&loops(&[square]), FillRule::EvenOdd).unwrap();
        assert_eq!((whole.triangles.len(), area(&whole)), (2, 16.0));
        for rule in [FillRule::EvenOdd, FillRule::NonZero] {
            let ring = fill(&loops(&[square, hole]), rule).unwrap();
            check_conforming(&ring);
            assert_eq!(area(&ring), 12.0);
        }
        assert_eq!(area(&fill(&loops(&[square, &same_way]), FillRule::NonZero).unwrap()), 16.0);
        assert_eq!(area(&fill(&loops(&[square, &same_way]), FillRule::EvenOdd).unwrap()), 12.0);
        // A pentagram of radius 1: its arms are 5 sin 72° / (2 + φ)... by the pentagon in it, of radius φ⁻².
        let star: Vec<DVec2> = (0..5).map(|k| DVec2::from_angle(std::f64::consts::TAU * 0.4 * f64::from(k))).collect();
        let phi = 0.5 * (1.0 + 5.0_f64.sqrt());
        let pentagon = 2.5 * (72.0_f64.to_radians()).sin() * phi.powi(-4);
        // Each arm is a triangle on a side s of the pentagon with the height (s/2) tan 72°.
        let side = 2.0 * phi.powi(-2) * (36.0_f64.to_radians()).sin();
        let arms = 5.0 * 0.25 * side * side * (72.0_f64.to_radians()).tan();
        let outlines = [star];
        assert!((area(&fill(&outlines, FillRule::EvenOdd).unwrap()) - arms).abs() < 1e-12);
        assert!((area(&fill(&outlines, FillRule::NonZero).unwrap()) - arms - pentagon).abs() < 1e-12);
    }

    /// M56 with erratum E27: horizontal edges, corners at the height of others, concave and star-shaped outlines.
    #[test]
    fn points_are_inside_as_crossings_tell() {
        let comb: &[[f64; 2]] =
            &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.5, 0.0], [0.0, 1.0], [-0.5, 0.0], [-1.0, 1.0]];
        let steps: &[[f64; 2]] =
            &[[-1.0, -1.0], [1.0, -1.0], [1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0]];
        let eight: &[[f64; 2]] = &[[-1.0, -1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0]];
        let hole: &[[f64; 2]] = &[[-0.5, -0.5], [0.5, -0.5], [0.0, 0.75]];
        let star: Vec<[f64; 2]> =
            (0..7).map(|k| DVec2::from_angle(std::f64::consts::TAU * 3.0 / 7.0 * f64::from(k)).to_array()).collect();
        let mut rng = HashRng::new(4);
        let mut tangle = || -> Vec<[f64; 2]> {
            (0..24).map(|_| [rng.next_f32(), rng.next_f32()].map(|v| f64::from(v) * 2.0 - 1.0)).collect()
        };
        let (t0, t1) = (tangle(), tangle());
        for (k, list) in
            [vec![comb], vec![steps], vec![eight], vec![comb, hole], vec![&star, hole], vec![&t0], vec![&t0, &t1]]
                .iter()
                .enumerate()
        {
            for rule in [FillRule::EvenOdd, FillRule::NonZero] {
                check_points(&loops(list), rule, k as u64);
            }
        }
    }

    #[test]
    fn what_has_no_area_gives_nothing() {
        for list in [loops(&[]), loops(&[&[]]), loops(&[&[[1.0, 1.0]]]), loops(&[&[[0.0, 0.0], [1.0, 1.0]]])] {
            assert!(fill(&list, FillRule::EvenOdd).unwrap().triangles.is_empty());
        }
        let line = loops(&[&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]]);
        assert!(area(&fill(&line, FillRule::EvenOdd).unwrap()).abs() < 1e-12);
        assert!(fill(&loops(&[&[[0.0, f64::NAN]]]), FillRule::EvenOdd).is_none());
        assert!(fill(&[vec![DVec2::ZERO; MOST_CORNERS + 1]], FillRule::EvenOdd).is_none());
    }
}
