//! Clipping in homogeneous coordinates, before the division: what is behind the eye never gets to it.

use glam::Vec4;

use super::window::Port;
use crate::{
    state::{DepthRange, RasterState},
    varyings::{Floats, Mode},
};

/// The smallest w that is divided by.
const LEAST_W: f64 = 1e-20;
/// The most planes: near, far, w, four of the guard band, and distances of varyings.
const MAX_DISTANCES: usize = 8;
/// A triangle gains at most a corner from each plane.
pub(super) const MAX_CORNERS: usize = 3 + 7 + MAX_DISTANCES;

/// True if a corner at this distance of a plane is on its inner side. NaN is outside.
pub(super) fn is_inside(distance: f64) -> bool {
    distance >= 0.0
}

/// A corner in clip space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner<F> {
    pub position: Vec4,
    pub floats: F,
}

/// Planes that limit the view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes<'a> {
    pub modes: &'static [Mode],
    pub raster: &'a RasterState,
    pub port: &'a Port,
}

impl Planes<'_> {
    /// Signed distance of a corner to plane `plane`; inside where ≥ 0. Planes beyond 6 are those of varyings.
    #[inline(always)]
    fn distance<F: Floats>(&self, plane: usize, corner: &Corner<F>) -> f64 {
        let [x, y, z, w] = corner.position.to_array().map(f64::from);
        match plane {
            0 => w - LEAST_W,
            1 => match self.raster.depth_range {
                DepthRange::ZeroToOne => z,
                DepthRange::MinusOneToOne => z + w,
            },
            2 => w - z,
            3 => self.port.guard[0] * w + x,
            4 => self.port.guard[0] * w - x,
            5 => self.port.guard[1] * w + y,
            6 => self.port.guard[1] * w - y,
            _ => f64::from(corner.floats.as_ref()[plane - 7]),
        }
    }

    /// True if this plane limits the view.
    #[inline(always)]
    fn counts(&self, plane: usize) -> bool {
        match plane {
            1 | 2 => self.raster.depth_clip,
            0 | 3..=6 => true,
            _ => self.modes[plane - 7] == Mode::Clip,
        }
    }

    /// Number of planes to clip against.
    #[inline(always)]
    pub fn count(&self, has_distances: bool) -> usize {
        if has_distances { 7 + self.modes.len() } else { 7 }
    }

    /// Which planes the corner is outside of, one bit each (of 64; further distances count as outside).
    #[inline]
    pub fn outside<F: Floats>(&self, corner: &Corner<F>, count: usize) -> u64 {
        let mut bits = 0;
        for plane in 0..count {
            if self.counts(plane) && !is_inside(self.distance(plane, corner)) {
                bits |= 1 << plane.min(63);
            }
        }
        bits
    }

    /// The corners of the polygon inside all planes that `outside` names.
    pub fn clip<F: Floats>(&self, polygon: &mut Polygon<F>, outside: u64, count: usize) {
        // Clip against one plane after the other (Sutherland and Hodgman, "Reentrant Polygon Clipping", 1974).
        for plane in 0..count {
            if outside & 1 << plane.min(63) != 0 && self.counts(plane) {
                let source = *polygon;
                polygon.count = 0;
                for i in 0..source.count {
                    let (a, b) = (&source.corners[i], &source.corners[(i + 1) % source.count]);
                    let (da, db) = (self.distance(plane, a), self.distance(plane, b));
                    if is_inside(da) {
                        polygon.push(*a);
                    }
                    // The cut is computed from the inside outwards, so that both triangles of an edge find the same
                    // point.
                    if is_inside(da) && !is_inside(db) {
                        polygon.push(self.cut(a, b, da, db));
                    } else if !is_inside(da) && is_inside(db) {
                        polygon.push(self.cut(b, a, db, da));
                    }
                }
            }
            if polygon.count == 0 {
                return;
            }
        }
    }

    /// The part of a line inside all planes.
    pub fn clip_line<F: Floats>(&self, mut ends: [Corner<F>; 2], count: usize) -> Option<[Corner<F>; 2]> {
        // Parametric clipping: each plane moves the end that lies outside of it.
        for plane in (0..count).filter(|&plane| self.counts(plane)) {
            let [da, db] = [0, 1].map(|i| self.distance(plane, &ends[i]));
            match (is_inside(da), is_inside(db)) {
                (true, true) => {}
                (true, false) => ends[1] = self.cut(&ends[0], &ends[1], da, db),
                (false, true) => ends[0] = self.cut(&ends[1], &ends[0], db, da),
                (false, false) => return None,
            }
        }
        Some(ends)
    }

    fn cut<F: Floats>(&self, inside: &Corner<F>, outside: &Corner<F>, d_in: f64, d_out: f64) -> Corner<F> {
        // Distances are linear along the edge: t = d_in/(d_in − d_out).
        let t = d_in / (d_in - d_out);
        let lerp = |a: f32, b: f32, t: f64| (f64::from(a) + t * (f64::from(b) - f64::from(a))) as f32;
        let (p, q) = (inside.position.to_array(), outside.position.to_array());
        let mut position = Vec4::from_array(std::array::from_fn(|i| lerp(p[i], q[i], t)));
        // Of a w that is far smaller than those of the ends rounding may leave nothing.
        position.w = position.w.max(LEAST_W as f32);
        // Where along the way in the window; behind the eye there is none.
        let (wp, wq) = (f64::from(p[3]), f64::from(q[3]));
        // t in clip space corresponds to t·w_q/((1 − t)·w_p + t·w_q) in the window.
        let in_window = if wq > 0.0 { t * wq / (wp + t * (wq - wp)) } else { t };
        let mut floats = F::ZERO;
        for (i, float) in floats.as_mut().iter_mut().enumerate() {
            let (a, b) = (inside.floats.as_ref()[i], outside.floats.as_ref()[i]);
            *float = match self.modes[i] {
                Mode::Flat => a,
                Mode::Linear | Mode::LinearCentroid | Mode::LinearSample => lerp(a, b, in_window),
                _ => lerp(a, b, t),
            };
        }
        Corner { position, floats }
    }
}

/// A convex polygon on the stack.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon<F> {
    pub corners: [Corner<F>; MAX_CORNERS],
    pub count: usize,
}

impl<F: Floats> Polygon<F> {
    pub fn triangle(corners: [Corner<F>; 3]) -> Self {
        let mut polygon = Self { corners: [corners[0]; MAX_CORNERS], count: 3 };
        polygon.corners[..3].copy_from_slice(&corners);
        polygon
    }

    fn push(&mut self, corner: Corner<F>) {
        if self.count < MAX_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }
}
