//! Proof that a chart is one-to-one, in integers.
//!
//! A map of a disk, linear on each triangle, is one-to-one if each triangle keeps its orientation and the border does
//! not meet itself: each point then lies in as many triangles as the border winds around it, which is once or not at
//! all. Borders are tested by pairs of sides within the cells of a grid.

/// Point of the grid of coordinates.
pub type Point = [i64; 2];

/// Pairs of sides that are tested for each side of a border, in the mean, until it counts as crossing itself.
const PAIRS: usize = 256;

/// Twice the signed area of a triangle. Exact for coordinates within ±2³⁰.
pub fn twice_area(a: Point, b: Point, c: Point) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// True if all triangles run counter-clockwise and the border meets itself nowhere.
pub fn is_injective(points: &[Point], corners: &[[u32; 3]], border: &[u32]) -> bool {
    let at = |i: u32| points[i as usize];
    corners.iter().all(|[a, b, c]| twice_area(at(*a), at(*b), at(*c)) > 0)
        && is_simple(&border.iter().map(|i| at(*i)).collect::<Vec<_>>())
}

/// True if a closed polygon meets itself nowhere.
fn is_simple(polygon: &[Point]) -> bool {
    let count = polygon.len();
    let side = |i: usize| [polygon[i], polygon[(i + 1) % count]];
    let (mut low, mut high) = ([i64::MAX; 2], [i64::MIN; 2]);
    for p in polygon {
        (low, high) = ([0, 1].map(|k| low[k].min(p[k])), [0, 1].map(|k| high[k].max(p[k])));
    }
    // About as many cells as sides.
    let cells = (count as f64).sqrt().ceil() as i64;
    let size = [0, 1].map(|k| (high[k] - low[k]) / cells + 1);
    let mut entries: Vec<(i64, u32)> = Vec::new();
    for i in 0..count {
        let [a, b] = side(i);
        let cell = |p: Point, k: usize| (p[k] - low[k]) / size[k];
        let (first, last) = (cell(a, 1).min(cell(b, 1)), cell(a, 1).max(cell(b, 1)));
        for row in first..=last {
            // The part of the side in this row, by a cell more than rounding can be wrong.
            let along = |y: i64| {
                let t = (y - a[1]) as f64 / (b[1] - a[1]) as f64;
                ((a[0] - low[0]) as f64 + t.clamp(0.0, 1.0) * (b[0] - a[0]) as f64) / size[0] as f64
            };
            let (from, to) = if first == last {
                (cell(a, 0).min(cell(b, 0)), cell(a, 0).max(cell(b, 0)))
            } else {
                let ends = [along(low[1] + row * size[1]), along(low[1] + (row + 1) * size[1])];
                let (from, to) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                (((from - 1e-3).floor() as i64).max(0), ((to + 1e-3).floor() as i64).min(cells))
            };
            entries.extend((from..=to).map(|column| (row * (cells + 1) + column, i as u32)));
        }
    }
    entries.sort_unstable();
    let groups = || entries.chunk_by(|a, b| a.0 == b.0);
    let pairs: usize = groups().map(|group| group.len() * (group.len() - 1) / 2).sum();
    if pairs > PAIRS * count {
        return false;
    }
    groups().all(|group| {
        let mut pairs = group.iter().enumerate().flat_map(|(k, (_, i))| group[..k].iter().map(move |(_, j)| (*i, *j)));
        pairs.all(|(i, j)| {
            let (i, j) = (i as usize, j as usize);
            if (i + 1) % count == j {
                !folds_back(side(i), side(j)[1])
            } else if (j + 1) % count == i {
                !folds_back(side(j), side(i)[1])
            } else {
                !meet(side(i), side(j))
            }
        })
    })
}

/// True if a side to `c` from the end of another runs back along that.
fn folds_back([a, b]: [Point; 2], c: Point) -> bool {
    twice_area(a, b, c) == 0 && (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]) > 0
}

/// True if two segments have a point in common.
fn meet([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let apart = |k: usize| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]);
    if apart(0) || apart(1) {
        return false;
    }
    let (c_side, d_side) = (twice_area(a, b, c).signum(), twice_area(a, b, d).signum());
    let (a_side, b_side) = (twice_area(c, d, a).signum(), twice_area(c, d, b).signum());
    c_side * d_side <= 0 && a_side * b_side <= 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_that_meet_themselves_are_found() {
        assert!(is_simple(&[[0, 0], [4, 0], [4, 4], [0, 4]]));
        assert!(!is_simple(&[[0, 0], [4, 4], [4, 0], [0, 4]]), "a cross");
        assert!(!is_simple(&[[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]]), "a touch");
        assert!(!is_simple(&[[0, 0], [4, 0], [2, 0], [2, 4]]), "a fold");
        let spiral: Vec<Point> =
            (0..1000).map(|i| [i, i * i]).chain((0..1000).rev().map(|i| [i - 1, i * i + 9])).collect();
        assert!(is_simple(&spiral));
    }

    /// The definition of all pairs of sides agrees on random polygons.
    #[test]
    fn the_grid_misses_no_pair() {
        let mut state = 1_u64;
        let mut random = |n: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((state >> 33) % n) as i64
        };
        let mut simple = 0;
        for _ in 0..2000 {
            let count = 3 + random(5) as usize;
            let polygon: Vec<Point> = (0..count).map(|_| [random(40), random(1000)]).collect();
            let side = |i: usize| [polygon[i], polygon[(i + 1) % count]];
            let expected = (0..count).all(|i| {
                !folds_back(side(i), side((i + 1) % count)[1])
                    && (0..i).all(|j| (j + 1) % count == i || (i + 1) % count == j || !meet(side(i), side(j)))
            });
            assert_eq!(is_simple(&polygon), expected, "{polygon:?}");
            simple += usize::from(expected);
        }
        assert!((200..1800).contains(&simple));
    }
}
