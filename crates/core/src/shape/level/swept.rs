//! Points on quadrics of revolution, evenly over their area.
//!
//! A profile turned around z sweeps the area `φ ∫ |∂p/∂φ × ∂p/∂v| dv`. A table has the integral at the ends of equal
//! steps of `v`, by Gauss-Legendre quadrature; within a step it is inverted by bisection.

use super::{Function, LevelSet, Revolution};
use crate::shape::{SurfacePoint, mean_area};
use glam::DMat3;
use std::sync::Arc;
use steradian_math::{Vec2, Vec3, transform::Affine};

const STEPS: usize = 64;
/// Halvings of a step.
const HALVINGS: u32 = 26;

/// A quadric of revolution whose points can be drawn.
#[derive(Clone, Debug)]
pub struct Swept {
    level: LevelSet,
    revolution: Revolution,
    /// Area, over azimuth, below the end of each step, object space.
    below: Arc<[f64]>,
}

impl Swept {
    /// `None` of surfaces that are not of revolution, and of those without area.
    pub fn new(level: &LevelSet) -> Option<Self> {
        let Function::Revolution(revolution) = level.function else { return None };
        let mut below = Vec::with_capacity(STEPS);
        let mut sum = 0.0;
        for k in 0..STEPS {
            let [from, to] = [k, k + 1].map(|k| k as f64 / STEPS as f64);
            sum += swept_between(&revolution, from, to);
            below.push(sum);
        }
        let swept = Self { level: level.clone(), revolution, below: below.into() };
        (swept.object_area() > 0.0 && swept.object_area().is_finite()).then_some(swept)
    }

    /// Copy of this surface, placed once more.
    #[must_use]
    pub fn placed(&self, place: &Affine) -> Self {
        let place = *place * self.level.place;
        let level = LevelSet { place, into: place.inv.as_dmat4(), ..self.level.clone() };
        Self { level, below: self.below.clone(), ..*self }
    }

    /// The surface.
    pub fn level(&self) -> &LevelSet {
        &self.level
    }

    fn object_area(&self) -> f32 {
        (self.below[STEPS - 1] * self.revolution.turn()) as f32
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        match self.level.place.similarity() {
            Some(scale) => scale * scale * self.object_area(),
            None => mean_area(|u| self.area_at(self.sample(u).n)),
        }
    }

    /// The reciprocal of the density of [`Swept::sample`] per area, where the unit normal is `n`.
    pub fn area_at(&self, n: Vec3) -> f32 {
        self.level.place.area(n) * self.object_area()
    }

    /// A point, uniform over the area in object space: `u.x` along the profile, `u.y` around.
    pub fn sample(&self, u: Vec2) -> SurfacePoint {
        let wanted = f64::from(u.x) * self.below[STEPS - 1];
        let step = self.below.partition_point(|below| *below <= wanted).min(STEPS - 1);
        let start = step as f64 / STEPS as f64;
        let before = if step > 0 { self.below[step - 1] } else { 0.0 };
        let (mut low, mut high) = (start, start + 1.0 / STEPS as f64);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let below = before + swept_between(&self.revolution, start, middle);
            if below < wanted { low = middle } else { high = middle }
        }
        let turn = DMat3::from_rotation_z(f64::from(u.y) * self.revolution.turn());
        self.level.at(turn * self.revolution.profile_at(0.5 * (low + high)))
    }

    /// The oriented unit normal at a point of the surface.
    pub fn normal_at(&self, p: Vec3) -> Vec3 {
        self.level.at(self.level.into.transform_point3(p.as_dvec3())).n
    }
}

/// The area that a part of the profile sweeps in a turn by one radian, by Gauss-Legendre quadrature of three points.
fn swept_between(revolution: &Revolution, from: f64, to: f64) -> f64 {
    const ASIDE: f64 = 0.774_596_669_241_483_4;
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let [a, b, c] = [-ASIDE, 0.0, ASIDE].map(|x| revolution.speed(middle + half * x));
    (5.0 * (a + c) + 8.0 * b) * half / 9.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::f64::consts::{PI, TAU};
    use steradian_math::Transform;

    fn swept(revolution: Revolution, place: Transform) -> Swept {
        let level =
            LevelSet::new(Function::Revolution(revolution), revolution.corners(), place.affine().unwrap(), false);
        Swept::new(&level.unwrap()).unwrap()
    }

    /// Areas of a cone, `π r √(r² + h²)`, half a paraboloid, `π r / (6 h²) ((r² + 4 h²)^1.5 − r³)` for the whole, and
    /// of the cone squeezed to half its height.
    #[test]
    fn areas() {
        let cone = |turn| Revolution::line(DVec3::X * 0.7, DVec3::Z * 1.3, turn).unwrap();
        let lateral = |r: f64, h: f64| PI * r * r.hypot(h);
        let bowl = Revolution::parabola(0.8, [0.0, 1.5], PI).unwrap();
        let of_bowl = PI * 0.8 / (12.0 * 2.25) * ((0.64_f64 + 9.0).powf(1.5) - 0.512);
        for (surface, place, expected) in [
            (cone(TAU), Transform::IDENTITY, lateral(0.7, 1.3)),
            (cone(0.5 * TAU), Transform::scale(DVec3::splat(-2.0)), 2.0 * lateral(0.7, 1.3)),
            (cone(TAU), Transform::scale(DVec3::new(1.0, 1.0, 0.5)), lateral(0.7, 0.65)),
            (bowl, Transform::rotate(DVec3::X, 1.0), of_bowl),
        ] {
            let area = f64::from(swept(surface, place).area());
            assert!((area / expected - 1.0).abs() < 1e-5, "{area} for {expected}");
        }
    }

    /// Below a part of the height of a cone lies `1 − (1 − z/h)²` of its area; points lie on it, with its normal.
    #[test]
    fn points_are_even() {
        let cone = swept(Revolution::line(DVec3::X * 0.7, DVec3::Z * 1.3, TAU).unwrap(), Transform::IDENTITY);
        for k in 0..100 {
            let u = Vec2::new((k as f32 + 0.5) / 100.0, 0.3);
            let s = cone.sample(u);
            let part = 1.0 - (1.0 - s.p.z / 1.3).powi(2);
            assert!((part - u.x).abs() < 1e-5, "{part} for {}", u.x);
            assert!((s.p.truncate().length() - 0.7 * (1.0 - s.p.z / 1.3)).abs() < 1e-6);
            assert!((s.n - cone.normal_at(s.p)).length() < 1e-4);
            assert!((s.n.z - 0.7 / 0.7_f32.hypot(1.3)).abs() < 1e-5 && s.n.truncate().dot(s.p.truncate()) > 0.0);
        }
    }
}
