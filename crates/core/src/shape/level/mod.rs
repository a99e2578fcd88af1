//! Surfaces where a function of the point is zero, within a box: quadrics by their coefficients, lines and parabolas
//! turned around z, and expressions.
//!
//! Rays and functions are `f64` in object space: a ray is first cut by the box, and roots are sought from where it
//! enters, so that nothing cancels however far away it begins. A hit is put back onto the surface along the gradient,
//! and what distance is left is part of its error. Normals point to where the function grows.

mod cells;
mod own;
mod revolution;
mod search;
mod swept;
#[cfg(test)]
mod tests;

pub use own::OwnShape;
pub use revolution::Revolution;
pub use swept::Swept;

use super::SurfacePoint;
use cells::Cells;
use glam::{DMat4, DVec3};
use std::sync::Arc;
use steradian_accel::UserHit;
use steradian_math::{
    Bounds3, Ray, Vec2, Vec3, expression::Expression, intersect::Quadric, ray::gamma, transform::Affine,
};

/// Tolerance of hits outside the box, as a part of the distance and of the length inside: it covers the rounding of
/// `f64`, so that surfaces in the faces of the box are met.
const EDGE: f64 = 1e-9;

/// Implicit function whose zeros are the surface.
#[derive(Clone, Debug)]
pub enum Function {
    /// A polynomial of second degree.
    Quadric(Quadric),
    /// A quadric of revolution, with parameters around and along the axis.
    Revolution(Revolution),
    /// Any expression.
    Expression(Expression<3>),
    /// A shape of a program's own.
    Own(Arc<dyn OwnShape>),
}

/// A surface in a box, placed in the space it is traced in.
#[derive(Clone, Debug)]
pub struct LevelSet {
    function: Function,
    /// Cells in which it may be zero, for an expression.
    cells: Option<Cells>,
    low: DVec3,
    high: DVec3,
    place: Affine,
    into: DMat4,
    flip: bool,
}

impl LevelSet {
    /// The part in the box between two corners, object space; `flip` turns the normals over. `None` where the box is
    /// empty or not finite.
    pub fn new(function: Function, [low, high]: [DVec3; 2], place: Affine, flip: bool) -> Option<Self> {
        let is_box = low.is_finite() && high.is_finite() && low.cmple(high).all() && low != high;
        is_box.then(|| {
            let cells = match &function {
                Function::Expression(e) => Some(Cells::new(e, [low, high])),
                Function::Quadric(_) | Function::Revolution(_) | Function::Own(_) => None,
            };
            Self { function, cells, low, high, place, into: place.inv.as_dmat4(), flip }
        })
    }

    /// The box around it, where it is placed.
    pub fn bounds(&self) -> Bounds3 {
        let placed = self.place.bounds(&Bounds3::new(self.low.as_vec3(), self.high.as_vec3()));
        let most = self.low.abs().max(self.high.abs()).as_vec3();
        let error = self.place.point_error(most, most * gamma(2));
        Bounds3::new(placed.min - error, placed.max + error)
    }

    /// Origin and direction of a ray in object space.
    fn local(&self, ray: &Ray) -> (DVec3, DVec3) {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        (self.into.transform_point3(o), self.into.transform_vector3(d))
    }

    /// The way of a ray through the box, a little longer.
    fn way(&self, o: DVec3, d: DVec3, t_max: f64) -> Option<[f64; 2]> {
        let (mut near, mut far) = (0.0_f64, t_max);
        for axis in 0..3 {
            if d[axis] == 0.0 {
                let slack = EDGE * (self.high[axis] - self.low[axis]);
                if !(self.low[axis] - slack..=self.high[axis] + slack).contains(&o[axis]) {
                    return None;
                }
                continue;
            }
            let (a, b) = ((self.low[axis] - o[axis]) / d[axis], (self.high[axis] - o[axis]) / d[axis]);
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
        let slack = EDGE * (near.abs() + (far - near).abs());
        (near.is_finite() && far.is_finite() && near <= far + slack).then_some([near - slack, far + slack])
    }

    /// The nearest hit in `(0, t_max)` that counts, from either side.
    pub fn intersect(&self, ray: &Ray, counts: impl Fn(&UserHit) -> bool) -> Option<UserHit> {
        let (o, d) = self.local(ray);
        let [near, far] = self.way(o, d, f64::from(ray.t_max))?;
        let hit = |t: f64| {
            let hit = UserHit { t: t as f32, u: 0.0, v: 0.0 };
            (hit.t > 0.0 && hit.t < ray.t_max && counts(&hit)).then_some(hit)
        };
        let start = o + d * near;
        let within = |s: &f64| *s >= 0.0 && *s <= far - near;
        match &self.function {
            Function::Quadric(q) => q.roots(start, d)?.into_iter().filter(within).find_map(|s| hit(near + s)),
            Function::Revolution(r) => {
                let roots = r.quadric().roots(start, d)?.into_iter().filter(within);
                roots.filter(|s| r.keeps(start + d * *s)).find_map(|s| hit(near + s))
            }
            Function::Own(own) => own::roots(&**own, start, d, far - near).find_map(|s| hit(near + s)),
            Function::Expression(e) => {
                let mut search = search::Search::new(e, [start, d], near);
                let take = |s: f64| hit(near + s);
                match &self.cells {
                    Some(cells) => cells.walk([start, d], far - near, |part| search.first(part, take)),
                    None => search.first([0.0, far - near], take),
                }
            }
        }
    }

    /// The function's value and gradient.
    fn sample(&self, p: DVec3) -> (f64, DVec3) {
        match &self.function {
            Function::Quadric(q) => (q.value(p), q.gradient(p)),
            Function::Revolution(r) => (r.quadric().value(p), r.quadric().gradient(p)),
            Function::Expression(e) => {
                let (value, gradient) = e.sample(p.to_array());
                (value, DVec3::from_array(gradient))
            }
            Function::Own(own) => own.sample(p),
        }
    }

    /// The surface where a ray meets it at `t`. Where the gradient is zero its normal is against the ray.
    pub fn surface(&self, ray: &Ray, t: f32) -> SurfacePoint {
        let (o, d) = self.local(ray);
        let mut p = o + d * f64::from(t);
        // By how much the rounding of t may have moved the point.
        let reach = 4.0 * f64::from(f32::EPSILON) * f64::from(t) * d.length();
        for _ in 0..2 {
            let (value, gradient) = self.sample(p);
            let step = gradient * (value / gradient.length_squared());
            if step.length_squared() <= reach * reach {
                p -= step;
            }
        }
        self.point(p, reach, ray.direction)
    }

    /// The surface at a point of it, object space.
    fn at(&self, p: DVec3) -> SurfacePoint {
        self.point(p, 0.0, Vec3::ZERO)
    }

    /// The surface at a point, object space, that is on it but for a distance; `against` is where its normal points
    /// away from where there is none.
    fn point(&self, p: DVec3, reach: f64, against: Vec3) -> SurfacePoint {
        let (value, gradient) = self.sample(p);
        let left = (value.abs() / gradient.length()).min(reach);
        let left = if left.is_nan() { reach } else { left } as f32;
        let n = self.place.normal(gradient.normalize_or_zero().as_vec3()).normalize_or_zero();
        let n = if n == Vec3::ZERO { -against.normalize_or_zero() } else { n * self.sign() };
        let at = p.as_vec3();
        let error = self.place.point_error(at, at.abs() * gamma(2) + Vec3::splat(left));
        let bare = SurfacePoint::bare(self.place.point(at), error, n);
        match &self.function {
            Function::Revolution(r) => {
                SurfacePoint { uv: r.parameters(p), dpdu: self.place.vector(r.dpdu(p).as_vec3()), ..bare }
            }
            Function::Own(own) => {
                let uv = own.uv(p).as_vec2();
                let dpdu = self.place.vector(own.derivatives(p)[0].as_vec3());
                let is_sound = uv.is_finite() && dpdu.is_finite();
                if is_sound { SurfacePoint { uv, dpdu, ..bare } } else { bare }
            }
            Function::Quadric(_) | Function::Expression(_) => SurfacePoint { uv: Vec2::ZERO, ..bare },
        }
    }

    fn sign(&self) -> f32 {
        if self.flip { -1.0 } else { 1.0 }
    }

    /// ∂p/∂v at a point of the surface, in the space it is placed in; zero where there are no parameters.
    pub fn dpdv(&self, p: Vec3) -> Vec3 {
        match &self.function {
            Function::Revolution(r) => self.place.vector(r.dpdv(self.into.transform_point3(p.as_dvec3())).as_vec3()),
            Function::Own(own) => {
                let dpdv = own.derivatives(self.into.transform_point3(p.as_dvec3()))[1];
                self.place.vector(dpdv.as_vec3())
            }
            Function::Quadric(_) | Function::Expression(_) => Vec3::ZERO,
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let more = if let Function::Expression(e) = &self.function { e.bytes() } else { 0 };
        size_of::<Self>() + more + self.cells.as_ref().map_or(0, Cells::bytes)
    }
}
