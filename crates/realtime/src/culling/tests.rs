//! Cells, portals and sets of a floor plan that is made by hand.

use super::{
    cells::{Cells, MAX_CELLS},
    pvs::visible_sets,
    walls::{Block, Wall},
};
use steradian_math::DVec3;

const ROOT: Block = Block { min: DVec3::ZERO, max: DVec3::new(12.0, 10.0, 3.0) };

fn wall(axis: usize, min: [f64; 3], max: [f64; 3]) -> Wall {
    Wall { axis, block: Block { min: min.into(), max: max.into() } }
}

/// Walls across y with doors.
fn row(y: f64, doors: &[f64]) -> Vec<Wall> {
    let (mut walls, mut start) = (Vec::new(), 0.0);
    for &door in doors {
        walls.push(wall(1, [start, y, 0.0], [door, y, 3.0]));
        walls.push(wall(1, [door, y, 2.0], [door + 1.0, y, 3.0]));
        start = door + 1.0;
    }
    walls.push(wall(1, [start, y, 0.0], [12.0, y, 3.0]));
    walls
}

/// Three rooms on each side of a corridor; the middle one of the north has no door.
fn plan() -> Vec<Wall> {
    let mut walls = row(4.0, &[1.5, 5.5, 9.5]);
    walls.extend(row(6.0, &[1.5, 9.5]));
    for x in [4.0, 8.0] {
        walls.push(wall(0, [x, 0.0, 0.0], [x, 4.0, 3.0]));
        walls.push(wall(0, [x, 6.0, 0.0], [x, 10.0, 3.0]));
    }
    walls
}

fn cell_at(cells: &Cells, p: [f64; 3]) -> usize {
    let p = DVec3::from(p);
    let found = cells.touched(&Block { min: p, max: p });
    assert_eq!(found.len(), 1, "{p}");
    found[0]
}

/// Seven cells, each door a portal; rooms see each other only through doors that a line passes.
#[test]
fn rooms_see_each_other_through_doors() {
    let cells = Cells::new(ROOT, &plan());
    assert_eq!((cells.cells.len(), cells.portals.len()), (7, 5), "{:?}", cells.portals);
    let sets = visible_sets(&cells);
    let [south, north] = [2.0, 8.0].map(|y| [2.0, 6.0, 10.0].map(|x| cell_at(&cells, [x, y, 1.0])));
    let corridor = cell_at(&cells, [6.0, 5.0, 1.0]);
    for room in [south[0], south[1], south[2], north[0], north[2]] {
        assert!(sets[room][room] && sets[room][corridor] && sets[corridor][room] && !sets[room][north[1]]);
    }
    // Doors in one wall face the same way.
    let hidden = [(south[0], south[1]), (south[0], south[2]), (south[1], south[2]), (north[0], north[2])];
    assert!(hidden.iter().all(|(a, b)| !sets[*a][*b] && !sets[*b][*a]));
    assert!(south.iter().all(|room| sets[*room][north[0]] && sets[*room][north[2]]));
    assert_eq!(sets[north[1]].iter().filter(|seen| **seen).count(), 1);
}

/// Numbers of 0…1 in a fixed order.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, block: &Block) -> DVec3 {
        block.min + DVec3::new(self.next(), self.next(), self.next()) * (block.max - block.min)
    }
}

/// Distances between which a ray is in a box.
fn inside(block: &Block, origin: DVec3, direction: DVec3) -> [f64; 2] {
    let (a, b) = ((block.min - origin) / direction, (block.max - origin) / direction);
    [a.min(b).max_element().max(0.0), a.max(b).min_element()]
}

/// Sets hold every cell that a ray from a cell meets before a wall, and hardly any others: of plans with doors, and of
/// thousands of walls at random, where sequences are joined and cells run out.
#[test]
fn sets_hold_what_rays_see() {
    let mut numbers = Numbers(7);
    let mut scattered = |count: usize| -> Vec<Wall> {
        let one = |i: usize| {
            let (axis, center) = (i % 3, numbers.within(&ROOT));
            let half = 0.5 + 2.0 * numbers.next();
            let (mut min, mut max) = ((center - half).max(ROOT.min), (center + half).min(ROOT.max));
            (min[axis], max[axis]) = (center[axis], center[axis]);
            wall(axis, min.to_array(), max.to_array())
        };
        (0..count).map(one).collect()
    };
    // Walls with a thickness, a corridor with a bend, and openings at several heights.
    let mut thick = row(4.0, &[1.5, 5.5, 9.5]);
    thick.extend(row(4.25, &[1.5, 5.5, 9.5]));
    for x in [1.5, 2.5, 5.5, 6.5, 9.5, 10.5] {
        thick.push(wall(0, [x, 4.0, 0.0], [x, 4.25, 2.0]));
    }
    thick.extend([wall(0, [7.0, 4.25, 0.0], [7.0, 8.0, 3.0]), wall(0, [3.0, 6.0, 0.5], [3.0, 10.0, 3.0])]);
    thick.push(wall(2, [0.0, 0.0, 1.5], [4.0, 4.0, 1.5]));
    let mut ratios = Vec::new();
    for walls in [plan(), thick, scattered(40), scattered(300)] {
        let cells = Cells::new(ROOT, &walls);
        let sets = visible_sets(&cells);
        let count = cells.cells.len();
        assert!(count > 6 && count <= MAX_CELLS);
        let mut met = vec![vec![false; count]; count];
        for from in 0..count {
            for _ in 0..200_000 / count {
                let origin = numbers.within(&cells.cells[from]);
                let to = numbers.within(&ROOT);
                let direction = to - origin;
                let hit = |wall: &Wall| {
                    let [t, leave] = inside(&wall.block, origin, direction);
                    if t > 0.0 && t <= leave { t } else { f64::INFINITY }
                };
                let end = walls.iter().map(hit).fold(f64::INFINITY, f64::min);
                for (to, block) in cells.cells.iter().enumerate() {
                    let [start, leave] = inside(block, origin, direction);
                    if start.max(1e-9) + 1e-9 < leave.min(end) {
                        met[from][to] = true;
                        assert!(sets[from][to], "{:?} sees {block:?}", cells.cells[from]);
                    }
                }
            }
        }
        let pairs = |of: &[Vec<bool>]| of.iter().flatten().filter(|seen| **seen).count() as f64;
        ratios.push(pairs(&met) / pairs(&sets));
    }
    assert!(ratios[0] > 0.99 && ratios[1] > 0.9 && ratios[2] > 0.7, "{ratios:?}");
}
