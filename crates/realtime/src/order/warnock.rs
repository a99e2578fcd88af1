//! Warnock's subdivision (1969, "A Hidden Surface Algorithm for Computer Generated Halftone Pictures"): a part of the
//! picture is divided into four until nothing is in it, one polygon covers it before all others, or it is one pixel.

use steradian_raster::glam::DVec2;

use super::Polygon;

/// Size of the picture in pixels, and of the view and its start in it.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub size: [u32; 2],
    pub view: [f64; 2],
    pub start: [f64; 2],
}

impl Frame {
    /// Centre of a pixel: x right and y up from −1 to 1.
    pub fn position(&self, pixel: [u32; 2]) -> DVec2 {
        let share = |axis: usize| (f64::from(pixel[axis]) + 0.5 - self.start[axis]) / self.view[axis];
        DVec2::new(2.0 * share(0) - 1.0, 1.0 - 2.0 * share(1))
    }
}

/// A pixel's primitive, and its z.
#[derive(Clone, Copy, Debug)]
pub struct Painted {
    pub pixel: [u32; 2],
    pub number: u32,
    pub z: f64,
}

/// Steps of positions in a pixel.
const STEPS: f64 = 256.0;

/// A polygon in the window, clockwise with y down.
struct InWindow {
    number: u32,
    /// Edge functions: a·x + b·y + c ≥ 0 inside, and > 0 unless borders count.
    edges: Vec<([f64; 3], bool)>,
    /// z = x·d0 + y·d1 + d2.
    depth: [f64; 3],
    low: [f64; 2],
    high: [f64; 2],
}

impl InWindow {
    fn new(polygon: &Polygon, frame: Frame) -> Option<Self> {
        let at = |x: f64, axis: usize| {
            let share = if axis == 0 { x * 0.5 + 0.5 } else { 0.5 - x * 0.5 };
            // Corners are rounded to 1/256 pixel as the pipeline rounds them, so that both cover the same pixel
            // centres.
            ((share * frame.view[axis] + frame.start[axis]) * STEPS).round_ties_even() / STEPS
        };
        let mut corners: Vec<[f64; 3]> = polygon.corners.iter().map(|c| [at(c.x, 0), at(c.y, 1), c.z]).collect();
        let start = corners[0];
        let cross =
            |a: &[f64; 3], b: &[f64; 3]| (a[0] - start[0]) * (b[1] - start[1]) - (a[1] - start[1]) * (b[0] - start[0]);
        let area: f64 = corners.windows(2).map(|w| cross(&w[0], &w[1])).sum();
        if area == 0.0 {
            return None;
        }
        // Orient the corners clockwise with y down.
        if area < 0.0 {
            corners.reverse();
        }
        // The plane by the largest triangle at the start.
        let start = corners[0];
        let cross =
            |a: &[f64; 3], b: &[f64; 3]| (a[0] - start[0]) * (b[1] - start[1]) - (a[1] - start[1]) * (b[0] - start[0]);
        // Depth is an affine function of the window, solved from three corners.
        let widest = corners.windows(2).max_by(|v, w| cross(&v[0], &v[1]).total_cmp(&cross(&w[0], &w[1])))?;
        let (p, q, d) = (widest[0], widest[1], cross(&widest[0], &widest[1]));
        let (dp, dq) = (p[2] - start[2], q[2] - start[2]);
        // Depth plane by Cramer's rule.
        let dx = (dp * (q[1] - start[1]) - dq * (p[1] - start[1])) / d;
        let dy = (dq * (p[0] - start[0]) - dp * (q[0] - start[0])) / d;
        let edge = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            let (x, y) = (a[1] - b[1], b[0] - a[0]);
            // Top edges run to the right, left edges up.
            let counts = (y > 0.0 && x == 0.0) || x > 0.0;
            ([x, y, -(x * a[0] + y * a[1])], counts)
        };
        let bound = |f: fn(f64, f64) -> f64, start: f64| [0, 1].map(|k| corners.iter().fold(start, |m, c| f(m, c[k])));
        Some(Self {
            number: polygon.number,
            edges: (0..corners.len()).map(edge).collect(),
            depth: [dx, dy, start[2] - dx * start[0] - dy * start[1]],
            low: bound(f64::min, f64::MAX),
            high: bound(f64::max, f64::MIN),
        })
    }

    fn z(&self, [x, y]: [f64; 2]) -> f64 {
        self.depth[0] * x + self.depth[1] * y + self.depth[2]
    }

    fn covers(&self, [x, y]: [f64; 2]) -> bool {
        self.edges.iter().all(|([a, b, c], counts)| {
            let d = a * x + b * y + c;
            d > 0.0 || (*counts && d == 0.0)
        })
    }

    /// True if no pixel centre between these corners can be in it.
    fn misses(&self, low: [f64; 2], high: [f64; 2]) -> bool {
        let apart = (0..2).any(|k| self.high[k] < low[k] || self.low[k] > high[k]);
        let outside = |[a, b, c]: [f64; 3]| {
            // The corner of the area that is farthest inside the edge: if it is outside, all are.
            a * if a > 0.0 { high[0] } else { low[0] } + b * if b > 0.0 { high[1] } else { low[1] } + c < 0.0
        };
        apart || self.edges.iter().any(|(edge, _)| outside(*edge))
    }

    /// True if it hides another at a place.
    fn is_before(&self, other: &Self, at: [f64; 2]) -> bool {
        let (z, other_z) = (self.z(at), other.z(at));
        z > other_z || (z == other_z && self.number <= other.number)
    }
}

/// The pixels that polygons are seen in.
pub fn paint(polygons: &[Polygon], frame: Frame) -> Vec<Painted> {
    let polygons: Vec<InWindow> = polygons.iter().filter_map(|p| InWindow::new(p, frame)).collect();
    let mut painted = Vec::new();
    let all: Vec<u32> = (0..polygons.len() as u32).collect();
    let mut areas = vec![([0, 0], frame.size, all)];
    while let Some((start, size, among)) = areas.pop() {
        // The area is spanned by its outermost pixel centres. Polygons that miss it are dropped, for its quarters as
        // well.
        let low = [0, 1].map(|k| f64::from(start[k]) + 0.5);
        let high = [0, 1].map(|k| f64::from(start[k] + size[k]) - 0.5);
        let here: Vec<u32> = among.into_iter().filter(|&i| !polygons[i as usize].misses(low, high)).collect();
        if here.is_empty() || size[0] == 0 || size[1] == 0 {
            continue;
        }
        let corners = [low, [high[0], low[1]], [low[0], high[1]], high];
        // A polygon surrounds and hides the area if it covers all corner samples and is nearest at all of them: depth
        // is linear.
        let hides_all = |i: &&u32| {
            let one = &polygons[**i as usize];
            let others = || here.iter().map(|&j| &polygons[j as usize]);
            corners.iter().all(|&at| one.covers(at)) && others().all(|o| corners.iter().all(|&at| one.is_before(o, at)))
        };
        let pixels = || (0..size[1]).flat_map(move |y| (0..size[0]).map(move |x| [start[0] + x, start[1] + y]));
        let mut put = |pixel: [u32; 2], one: &InWindow| {
            let at = pixel.map(|i| f64::from(i) + 0.5);
            painted.push(Painted { pixel, number: one.number, z: one.z(at) });
        };
        // Warnock's cases. A polygon that covers all corners, and is nearest at all of them, is nearest everywhere,
        // since depths are affine.
        if let Some(&i) = here.iter().find(hides_all) {
            pixels().for_each(|pixel| put(pixel, &polygons[i as usize]));
        } else if here.len() == 1 || size == [1, 1] {
            // One polygon, or one pixel: decided pixel by pixel.
            for pixel in pixels() {
                let at = pixel.map(|i| f64::from(i) + 0.5);
                let covering = here.iter().map(|&i| &polygons[i as usize]).filter(|one| one.covers(at));
                let seen = covering.reduce(|a, b| if a.is_before(b, at) { a } else { b });
                if let Some(one) = seen {
                    put(pixel, one);
                }
            }
        } else {
            // Otherwise the area is divided into four.
            let first = size.map(|n| n.div_ceil(2));
            for (right, down) in [(false, false), (true, false), (false, true), (true, true)] {
                let part = |k: usize, second: bool| {
                    if second { (start[k] + first[k], size[k] - first[k]) } else { (start[k], first[k]) }
                };
                let ((x, width), (y, height)) = (part(0, right), part(1, down));
                areas.push(([x, y], [width, height], here.clone()));
            }
        }
    }
    painted
}
