//! Transforms that change with time.

use crate::{Transform, transform::Affine};
use glam::{DMat3, DMat4, DQuat, DVec3};

/// A transform at some moments, and between them: translation, rotation and stretch are interpolated each for itself,
/// linearly and on the shortest arc, after a polar decomposition (Shoemake, Duff 1992, "Matrix Animation and Polar
/// Decomposition"). Before the first moment and after the last nothing moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// By time; at least one.
    keys: Vec<Key>,
}

/// A transform in parts: first `stretch`, then `rotation`, then `translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    time: f32,
    translation: DVec3,
    rotation: DQuat,
    stretch: DMat3,
}

impl Key {
    fn new(time: f32, transform: &Transform) -> Option<Self> {
        let linear =
            DMat3::from_cols(transform.vector(DVec3::X), transform.vector(DVec3::Y), transform.vector(DVec3::Z));
        transform.affine()?;
        // Higham's iteration for the orthogonal factor converges quadratically.
        let mut q = linear;
        for _ in 0..100 {
            let next = (q + q.inverse().transpose()) * 0.5;
            let change = (next - q).abs_diff_eq(DMat3::ZERO, 1e-14);
            q = next;
            if change {
                break;
            }
        }
        // A reflection is left to the stretch.
        if q.determinant() < 0.0 {
            q = -q;
        }
        let stretch = q.transpose() * linear;
        let translation = transform.point(DVec3::ZERO);
        (q.is_finite() && stretch.is_finite()).then(|| Self {
            time,
            translation,
            rotation: DQuat::from_mat3(&q),
            stretch,
        })
    }

    fn matrix(&self) -> DMat4 {
        let linear = DMat3::from_quat(self.rotation) * self.stretch;
        DMat4::from_cols(
            linear.x_axis.extend(0.0),
            linear.y_axis.extend(0.0),
            linear.z_axis.extend(0.0),
            self.translation.extend(1.0),
        )
    }

    /// The angle of the rotation to another one.
    fn angle_to(&self, other: &Self) -> f64 {
        2.0 * self.rotation.dot(other.rotation).abs().min(1.0).acos()
    }
}

impl Motion {
    /// From transforms at moments in rising order; `None` where there is none, or one is singular.
    pub fn new(keys: impl IntoIterator<Item = (f32, Transform)>) -> Option<Self> {
        let mut keys: Vec<Key> = keys.into_iter().map(|(time, t)| Key::new(time, &t)).collect::<Option<_>>()?;
        for k in 1..keys.len() {
            if keys[k].rotation.dot(keys[k - 1].rotation) < 0.0 {
                keys[k].rotation = -keys[k].rotation;
            }
        }
        let is_ordered = keys.windows(2).all(|w| w[0].time <= w[1].time);
        (is_ordered && !keys.is_empty()).then_some(Self { keys })
    }

    /// True if it is the same transform at all moments from zero to one.
    pub fn is_still(&self) -> bool {
        let first = self.key(0.0);
        let is_like =
            |k: &Key| (k.translation, k.rotation, k.stretch) == (first.translation, first.rotation, first.stretch);
        is_like(&self.key(1.0)) && self.keys.iter().filter(|k| (0.0..=1.0).contains(&k.time)).all(is_like)
    }

    /// Stands still where it is at a moment.
    pub fn stopped_at(&self, time: f32) -> Self {
        Self { keys: vec![self.key(time)] }
    }

    /// The transform at a moment; `None` where it is singular, as on the way from a shape to its mirror image.
    pub fn at(&self, time: f32) -> Option<Affine> {
        Transform::from_columns(self.key(time).matrix().to_cols_array()).affine()
    }

    fn key(&self, time: f32) -> Key {
        let next = self.keys.partition_point(|k| k.time <= time);
        let (Some(before), Some(after)) = (next.checked_sub(1).map(|k| &self.keys[k]), self.keys.get(next)) else {
            return self.keys[next.min(self.keys.len() - 1)];
        };
        let u = f64::from(time - before.time) / f64::from(after.time - before.time);
        Key {
            time,
            translation: before.translation.lerp(after.translation, u),
            rotation: if before.rotation == after.rotation {
                before.rotation
            } else {
                before.rotation.slerp(after.rotation, u)
            },
            stretch: before.stretch * (1.0 - u) + after.stretch * u,
        }
    }

    /// Moments from zero to one, and how far a point within `reach` of the origin leaves the straight line between its
    /// places at neighbouring ones, at most: a box around its places at all of them, enlarged so much, contains it at
    /// any moment.
    pub fn steps(&self, reach: f32) -> (Vec<f32>, f32) {
        const STEPS: u32 = 32;
        let mut times: Vec<f32> = (0..=STEPS).map(|i| i as f32 / STEPS as f32).collect();
        times.extend(self.keys.iter().map(|k| k.time).filter(|t| (0.0..1.0).contains(t)));
        times.sort_unstable_by(f32::total_cmp);
        let norm = |m: DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut beyond: f64 = 0.0;
        for [a, b] in self.keys.windows(2).filter_map(|w| <&[Key; 2]>::try_from(w).ok()) {
            // Of p(u) = R(u) S(u) x + T(u), u in [0, 1] between the keys: |p''| ≤ θ² |S x| + 2 θ |S' x|. A chord over h
            // is left by at most h²/8 of that.
            let (angle, change) = (a.angle_to(b), norm(b.stretch - a.stretch));
            let stretch = norm(a.stretch).max(norm(b.stretch));
            let h = (1.0 / f64::from(STEPS) / f64::from(b.time - a.time)).min(1.0);
            beyond = beyond.max((angle * angle * stretch + 2.0 * angle * change) * f64::from(reach) * h * h / 8.0);
        }
        (times, beyond as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Vec3, hash::HashRng};

    fn close(a: &Affine, b: &Transform) -> bool {
        let b = b.affine().unwrap();
        (0..4).all(|c| (a.m.col(c) - b.m.col(c)).abs().max_element() < 1e-5)
    }

    /// The transforms at the keys come back, reflections and shears too.
    #[test]
    fn keys_come_back() {
        let shear = Transform::from_rows([1., 0.4, 0., 3., 0., 1., 0., 0., 0., 0.2, 1., 0., 0., 0., 0., 1.]);
        let mirror = Transform::scale(DVec3::new(-2.0, 1.0, 0.5)) * Transform::rotate(DVec3::Y, 2.0);
        for (a, b) in
            [(Transform::IDENTITY, shear), (mirror, mirror * shear), (shear, Transform::rotate(DVec3::Z, 3.0))]
        {
            let motion = Motion::new([(0.0, a), (1.0, b)]).unwrap();
            assert!(close(&motion.at(0.0).unwrap(), &a) && close(&motion.at(1.0).unwrap(), &b), "{a:?}");
            assert!(close(&motion.at(-3.0).unwrap(), &a) && close(&motion.at(9.0).unwrap(), &b));
            assert!(!motion.is_still());
        }
        assert!(Motion::new([(0.0, shear), (1.0, shear)]).unwrap().is_still());
        assert!(Motion::new([(0.0, Transform::scale(DVec3::new(1.0, 0.0, 1.0)))]).is_none());
    }

    /// A quarter of a turn in three quarters of the time, about an axis that moves.
    #[test]
    fn rotations_are_even() {
        let end = Transform::translate(DVec3::new(4.0, 0.0, 0.0)) * Transform::rotate(DVec3::Z, 1.2);
        let motion = Motion::new([(0.25, Transform::IDENTITY), (1.0, end)]).unwrap();
        let at = motion.at(0.5).unwrap();
        let expected = Transform::translate(DVec3::new(4.0 / 3.0, 0.0, 0.0)) * Transform::rotate(DVec3::Z, 0.4);
        assert!(close(&at, &expected), "{at:?}");
    }

    /// Boxes of the steps contain all places.
    #[test]
    fn steps_bound_the_way() {
        let mut rng = HashRng::new(4);
        for _ in 0..50 {
            let mut random = || -> Transform {
                let mut v = || DVec3::new(rng.next_f32().into(), rng.next_f32().into(), rng.next_f32().into());
                let (t, axis, s) = (v() * 4.0, v() - 0.5, v() + 0.2);
                Transform::translate(t) * Transform::rotate(axis, 6.0 * axis.x) * Transform::scale(s)
            };
            let motion = Motion::new([(-0.5, random()), (0.3, random()), (0.9, random())]).unwrap();
            let p = Vec3::new(0.3, -0.7, 0.5);
            let (times, beyond) = motion.steps(p.length());
            let places: Vec<Vec3> = times.iter().map(|t| motion.at(*t).unwrap().point(p)).collect();
            let low = places.iter().fold(Vec3::INFINITY, |a, b| a.min(*b)) - beyond - 1e-5;
            let high = places.iter().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b)) + beyond + 1e-5;
            for i in 0..=1000 {
                let q = motion.at(i as f32 / 1000.0).unwrap().point(p);
                assert!(q.cmpge(low).all() && q.cmple(high).all());
            }
        }
    }
}
