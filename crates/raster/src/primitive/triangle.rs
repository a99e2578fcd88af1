//! Triangles.

use super::{
    Edge, Primitive, Setup,
    clip::{Corner, Polygon},
    setup::{corner, relative},
    window::{self, Port},
};
use crate::{
    samples::SUBPIXELS,
    stages::Vertex,
    state::{Conservative, Cull, FrontFace, PolygonMode},
    varyings::Varyings,
};

/// Data shared by the parts of a clipped triangle.
struct Whole<'a, V: Varyings> {
    port: &'a Port,
    provoking: V::Floats,
    layer: u32,
    viewport: u32,
    id: u32,
}

impl<V: Varyings> Setup<'_, V> {
    /// Takes a triangle.
    pub fn triangle(&mut self, vertices: [&Vertex<V>; 3], provoking: usize, id: u32) {
        let first = vertices[provoking];
        let Some((port, code)) = self.admit(first, vertices.into_iter()) else { return };
        // Clip only what crosses the near or far plane, w = 0 or the guard band: the tiles scissor the rest.
        let corners = vertices.map(corner);
        let outside = if code != 0 || Self::HAS_CLIP {
            let (planes, count) = self.planes(port);
            corners.iter().fold(0, |bits, c| bits | planes.outside(c, count))
        } else {
            0
        };
        let whole =
            Whole { port, provoking: first.varyings.to_floats(), layer: first.layer, viewport: first.viewport, id };
        if self.window.raster.polygon_mode != PolygonMode::Fill {
            return self.outline(vertices, outside, provoking, &whole);
        }
        if outside == 0 {
            let projected = corners.map(|c| port.project(c.position));
            return self.fill(&whole, [&corners[0], &corners[1], &corners[2]], projected);
        }
        self.chunk.counters.clipped += 1;
        let polygon = self.clipped(port, corners, outside);
        let (corners, count) = (&polygon.corners, polygon.count);
        if count < 3 {
            return;
        }
        let project = |i: usize| port.project(corners[i].position);
        // A clipped triangle is a convex polygon: draw it as a fan.
        let start = project(0);
        for i in 1..count - 1 {
            self.fill(&whole, [&corners[0], &corners[i], &corners[i + 1]], [start, project(i), project(i + 1)]);
        }
    }

    fn clipped(&self, port: &Port, corners: [Corner<V::Floats>; 3], outside: u64) -> Polygon<V::Floats> {
        let mut polygon = Polygon::triangle(corners);
        let (planes, count) = self.planes(port);
        planes.clip(&mut polygon, outside, count);
        polygon
    }

    /// Twice the area in sub-pixel units, positive where corners run clockwise on the screen.
    fn area(at: [[i32; 2]; 3]) -> i64 {
        // Twice the signed area from exact integer coordinates.
        let d = |i: usize, axis: usize| i64::from(at[i][axis]) - i64::from(at[0][axis]);
        d(1, 0) * d(2, 1) - d(1, 1) * d(2, 0)
    }

    /// True if it shows its front, `None` if that side is not drawn.
    fn facing(&mut self, area: i64) -> Option<bool> {
        let raster = &self.window.raster;
        let front = match raster.front_face {
            FrontFace::CounterClockwise => area < 0,
            FrontFace::Clockwise => area > 0,
        };
        let dropped = match raster.cull {
            Cull::None => false,
            Cull::Front => front,
            Cull::Back => !front,
            Cull::Both => true,
        };
        if dropped {
            self.chunk.counters.culled += 1;
            return None;
        }
        Some(front)
    }

    /// A part of a triangle that needs no clipping.
    #[inline]
    fn fill(&mut self, whole: &Whole<V>, mut corners: [&Corner<V::Floats>; 3], mut p: [window::Corner; 3]) {
        // Reject degenerate triangles, cull by facing, and turn the rest clockwise.
        let mut area = Self::area([p[0].at, p[1].at, p[2].at]);
        if area == 0 {
            self.chunk.counters.empty += 1;
            return;
        }
        let Some(front) = self.facing(area) else { return };
        if area < 0 {
            corners.swap(1, 2);
            p.swap(1, 2);
            area = -area;
        }
        // Bounding box in sub-pixels, then in pixels.
        let bound = |axis: usize| {
            let [a, b, c] = p.map(|corner| corner.at[axis]);
            (a.min(b).min(c), a.max(b).max(c))
        };
        let ((x0, x1), (y0, y1)) = (bound(0), bound(1));
        let limits = (whole.port.min, whole.port.max);
        let conservative = self.window.raster.conservative;
        // Pixels whose centre or samples the box may hold; overestimation takes every pixel it touches.
        let (min, max) = if conservative == Conservative::Overestimate {
            let first = |x: i32| (x - 1).div_euclid(SUBPIXELS);
            let last = |x: i32| x.div_euclid(SUBPIXELS) + 1;
            (
                [first(x0 + 1).max(limits.0[0]), first(y0 + 1).max(limits.0[1])],
                [last(x1).min(limits.1[0]), last(y1).min(limits.1[1])],
            )
        } else {
            self.pixels([x0, y0], [x1, y1], limits)
        };
        if min[0] >= max[0] || min[1] >= max[1] {
            self.chunk.counters.empty += 1;
            return;
        }
        // Edge i lies opposite corner i and excludes what the top-left rule gives to the neighbour.
        let mut edges = [
            Edge::between(p[1].at, p[2].at),
            Edge::between(p[2].at, p[0].at),
            Edge::between(p[0].at, p[1].at),
            Edge::default(),
        ];
        // Gradients of the weights per pixel; edges 1 and 2 are opposite of corners 1 and 2.
        let per_pixel = f64::from(SUBPIXELS) / area as f64;
        let weights = [1, 2].map(|i: usize| [f64::from(edges[i].a) * per_pixel, f64::from(edges[i].b) * per_pixel]);
        if conservative != Conservative::Off {
            for (i, edge) in edges[..3].iter_mut().enumerate() {
                *edge = Edge::through(p[(i + 1) % 3].at, p[(i + 2) % 3].at);
                // Move the edges by half a pixel's extent along their normals: outwards for over-, inwards for
                // underestimation (Hasselgren, Akenine-Möller, Ohlsson, GPU Gems 2, ch. 42).
                let half = i64::from(SUBPIXELS / 2) * (i64::from(edge.a.abs()) + i64::from(edge.b.abs()));
                edge.c += if conservative == Conservative::Overestimate { half } else { -half };
            }
        }
        // Depth is linear in the window after the division by w: gradients from the differences of the corners.
        let rise = [p[1].depth - p[0].depth, p[2].depth - p[0].depth];
        let slope = [0, 1].map(|axis| weights[0][axis] * rise[0] + weights[1][axis] * rise[1]);
        let depths = p.map(|corner| corner.depth);
        let depth = [depths[0] + self.bias(depths, slope), slope[0], slope[1]];
        let attributes = self.store_attributes(corners.map(|c| &c.floats), &whole.provoking);
        let (inv_w, inv_w_scale) = relative(p.map(|corner| corner.inv_w));
        self.bin(Primitive {
            edges,
            edge_count: 3,
            front,
            smooth: false,
            viewport: whole.viewport as u8,
            layer: whole.layer as u16,
            min,
            max,
            id: whole.id,
            attributes,
            origin: p[0].at.map(|x| f64::from(x) / f64::from(SUBPIXELS)),
            weights,
            depth,
            depth_range: whole.port.depth_range,
            inv_w,
            inv_w_scale,
            line: [0.0; 2],
        });
    }

    /// The depth bias of a triangle with these corners and this slope per pixel.
    pub(super) fn bias(&self, depths: [f64; 3], slope: [f64; 2]) -> f64 {
        let bias = self.window.raster.depth_bias;
        if bias.constant == 0.0 && bias.slope == 0.0 {
            return 0.0;
        }
        // Bias = constant·r + slope·max(|∂z/∂x|, |∂z/∂y|), with r the smallest step of the format at the largest depth.
        let largest = depths[0].abs().max(depths[1].abs()).max(depths[2].abs());
        let step = self.window.depth_format.smallest_step(largest as f32);
        let steepest = slope[0].abs().max(slope[1].abs());
        let sum = f64::from(bias.constant) * step + f64::from(bias.slope) * steepest;
        let clamp = f64::from(bias.clamp);
        if clamp > 0.0 {
            sum.min(clamp)
        } else if clamp < 0.0 {
            sum.max(clamp)
        } else {
            sum
        }
    }

    /// Edges or corners of a triangle; the side that it shows is that of the part in view.
    fn outline(&mut self, vertices: [&Vertex<V>; 3], outside: u64, provoking: usize, whole: &Whole<V>) {
        let corners = vertices.map(corner);
        let polygon = self.clipped(whole.port, corners, outside);
        if polygon.count < 3 {
            self.chunk.counters.outside += 1;
            return;
        }
        // Facing of the visible part: the sum of the fan's signed areas.
        let at = |i: usize| whole.port.project(polygon.corners[i].position).at;
        let area = (1..polygon.count - 1).map(|i| Self::area([at(0), at(i), at(i + 1)])).sum();
        let Some(front) = self.facing(area) else { return };
        let bias = self.outline_bias(&polygon, whole.port);
        for i in 0..3 {
            if self.window.raster.polygon_mode == PolygonMode::Line {
                let ends = [vertices[i], vertices[(i + 1) % 3]];
                self.line_part(ends, vertices[provoking], whole.id, Some((front, bias)));
            } else {
                self.point_part(vertices[i], vertices[provoking], whole.id, Some((front, bias)));
            }
        }
    }

    fn outline_bias(&self, polygon: &Polygon<V::Floats>, port: &Port) -> f64 {
        let p = [0, 1, 2].map(|i| port.project(polygon.corners[i].position));
        let area = Self::area(p.map(|c| c.at));
        if area == 0 {
            return 0.0;
        }
        let edges = [Edge::through(p[2].at, p[0].at), Edge::through(p[0].at, p[1].at)];
        let rise = [p[1].depth - p[0].depth, p[2].depth - p[0].depth];
        let per_pixel = f64::from(SUBPIXELS) / area as f64;
        let along = |gradients: [i32; 2]| (0..2).map(|i| f64::from(gradients[i]) * per_pixel * rise[i]).sum::<f64>();
        self.bias(p.map(|c| c.depth), [along(edges.map(|e| e.a)), along(edges.map(|e| e.b))])
    }
}
