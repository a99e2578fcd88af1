//! Cells seen through portals (Luebke, Georges 1995, "Portals and Mirrors: Simple, Fast Evaluation of Potentially
//! Visible Sets"), with windows that are cut by the polygons of portals.

use super::{
    cells::Cells,
    footprint::{BORDER, Screen},
    walls::Block,
};
use steradian_math::DVec3;
use steradian_raster::glam::{DVec2, DVec4};

/// Most windows of a cell; more are joined to their convex hull.
const MAX_WINDOWS: usize = 16;

/// Convex part of the picture in which a cell may be seen.
#[derive(Clone, Debug)]
pub struct Window {
    /// Corners in pixels, with the inside to one side.
    corners: Vec<DVec2>,
    /// Planes in the world through the eye and the edges; points in the window have no negative distance.
    planes: Vec<DVec4>,
}

impl Window {
    fn new(screen: &Screen, corners: Vec<DVec2>) -> Self {
        let [x, y, w] = screen.pixel_from_world();
        let edge = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            let normal = (b - a).perp();
            x * normal.x + y * normal.y - w * normal.dot(a)
        };
        let planes = (0..corners.len()).map(edge).collect();
        Self { corners, planes }
    }

    /// True if the convex hull of spheres lies outside one edge.
    pub fn misses(&self, corners: &[DVec3], radius: f64) -> bool {
        let outside = |plane: &DVec4| {
            let reach = radius * plane.truncate().length();
            corners.iter().all(|p| plane.dot(p.extend(1.0)) + reach < 0.0)
        };
        self.planes.iter().any(outside)
    }
}

/// Windows of all cells: those of the cells where the view starts are the picture.
pub fn windows(cells: &Cells, screen: &Screen, start: &[usize], eye: DVec4) -> Vec<Vec<Window>> {
    let mut found: Vec<Vec<Window>> = vec![Vec::new(); cells.cells.len()];
    let order = cells.order(eye);
    let mut rank = vec![0; order.len()];
    (0..).zip(&order).for_each(|(place, cell)| rank[*cell] = place);
    start.iter().for_each(|cell| found[*cell] = vec![Window::new(screen, screen.frame())]);
    // Each cell after all through which it is seen.
    for cell in order {
        if found[cell].len() > MAX_WINDOWS {
            let all = found[cell].iter().flat_map(|window| window.corners.iter().copied()).collect();
            found[cell] = vec![Window::new(screen, hull(all))];
        }
        for portal in cells.of_cell[cell].iter().map(|number| &cells.portals[*number]) {
            let next = portal.cells[usize::from(portal.cells[0] == cell)];
            if found[cell].is_empty() || rank[next] < rank[cell] || start.contains(&next) {
                continue;
            }
            let Some(outline) = outline(screen, &portal.block, portal.axis) else { continue };
            let through = |window: &Window| {
                let common = clipped(&outline, &window.corners);
                (common.len() > 2).then(|| Window::new(screen, common))
            };
            let more: Vec<Window> = found[cell].iter().filter_map(through).collect();
            found[next].extend(more);
        }
    }
    found
}

/// Convex polygon of a portal in the picture, with the border around it that rounding needs; `None` behind the eye.
fn outline(screen: &Screen, block: &Block, axis: usize) -> Option<Vec<DVec2>> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |[right, up]: [bool; 2]| {
        let mut p = block.min;
        (p[u], p[v]) = (if right { block.max[u] } else { p[u] }, if up { block.max[v] } else { p[v] });
        p
    };
    let around = [[false, false], [true, false], [true, true], [false, true]].map(corner);
    let before = |p: DVec3| screen.near_plane().dot(p.extend(1.0));
    let mut points = Vec::new();
    for i in 0..4 {
        let (a, b) = (around[i], around[(i + 1) % 4]);
        let (da, db) = (before(a), before(b));
        points.extend((da >= 0.0).then_some(a));
        points.extend(((da >= 0.0) != (db >= 0.0)).then(|| a.lerp(b, da / (da - db))));
    }
    let [x, y, w] = screen.pixel_from_world();
    let place = |p: &DVec3| {
        let p = p.extend(1.0);
        DVec2::new(x.dot(p), y.dot(p)) / w.dot(p)
    };
    let places: Vec<DVec2> = points.iter().map(place).collect();
    if places.iter().any(|p| !p.is_finite()) {
        return Some(screen.frame());
    }
    let around = |p: &DVec2| [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|d| *p + DVec2::from(d) * BORDER);
    (!places.is_empty()).then(|| hull(places.iter().flat_map(around).collect()))
}

/// Convex hull, to the left of its edges (Andrew's monotone chain).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut found: Vec<DVec2> = Vec::new();
    let mut chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let start = found.len();
        for p in points {
            while let [.., a, b] = found[start..] {
                if (b - a).perp_dot(p - b) > 0.0 {
                    break;
                }
                found.pop();
            }
            found.push(p);
        }
        // The last point begins the other chain.
        found.pop();
    };
    chain(&mut points.iter().copied());
    chain(&mut points.iter().rev().copied());
    found
}

/// Part of a convex polygon in another one (Sutherland, Hodgman 1974).
fn clipped(polygon: &[DVec2], by: &[DVec2]) -> Vec<DVec2> {
    let mut rest = polygon.to_vec();
    for (i, &a) in by.iter().enumerate() {
        let edge = by[(i + 1) % by.len()] - a;
        let inside = |p: DVec2| edge.perp_dot(p - a);
        let polygon = std::mem::take(&mut rest);
        for (k, &p) in polygon.iter().enumerate() {
            let q = polygon[(k + 1) % polygon.len()];
            let (dp, dq) = (inside(p), inside(q));
            rest.extend((dp >= 0.0).then_some(p));
            rest.extend(((dp >= 0.0) != (dq >= 0.0)).then(|| p.lerp(q, dp / (dp - dq))));
        }
    }
    rest
}
