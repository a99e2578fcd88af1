//! Emitting surfaces that are placed once more than their shape is, and those that move while the shutter is open.

use super::{AreaShape, tree::LightBounds};
use crate::shape::{Quadric, QuadricKind};
use std::{f32::consts::TAU, sync::Arc};
use steradian_math::{Motion, Vec3, transform::Affine};

/// A part of a surface that moves.
#[derive(Clone, Debug)]
pub struct Moving {
    /// The part, in the space of the group that moves.
    pub shape: AreaShape,
    /// Transform of the group as the shutter opens.
    pub start: Affine,
    /// Motion of the group.
    pub motion: Arc<Motion>,
}

impl Moving {
    /// The part at a moment of the exposure.
    pub fn at(&self, time: f32) -> AreaShape {
        self.shape.placed(&self.motion.at(time).unwrap_or(self.start))
    }

    /// Light bounds that hold at all moments of the exposure, from the bounds of single shapes.
    pub(super) fn bounds(&self, of: impl Fn(AreaShape) -> LightBounds) -> LightBounds {
        let reach = of(self.shape.clone()).bounds;
        let reach = reach.min.abs().max(reach.max.abs()).length();
        // Sample the motion in steps small enough that points move a known distance between them.
        let (times, beyond) = self.motion.steps(reach);
        let mut all = of(self.at(0.0));
        for time in times {
            let now = of(self.at(time));
            all = LightBounds { intensity: all.intensity.max(now.intensity), ..all.union(&now) };
        }
        all.bounds.min -= beyond;
        all.bounds.max += beyond;
        // Between the steps normals turn on: those of a shape that turns may be any.
        LightBounds { cos_o: if all.cos_o < 1.0 - 1e-6 { -1.0 } else { all.cos_o }, ..all }
    }
}

impl AreaShape {
    /// Copy of this part, placed once more. Rectangles are to stay rectangles.
    pub fn placed(&self, place: &Affine) -> Self {
        let normal = |n: Vec3| place.normal(n).normalize_or_zero();
        match self {
            Self::Triangle(v, n, _) => {
                let v = v.map(|v| place.point(v));
                Self::Triangle(v, normal(*n), 0.5 * (v[1] - v[0]).cross(v[2] - v[0]).length())
            }
            Self::Rectangle { corner, ex, ey, n, .. } => {
                let [ex, ey] = [*ex, *ey].map(|e| place.vector(e));
                let area = ex.cross(ey).length();
                Self::Rectangle { corner: place.point(*corner), ex, ey, n: normal(*n), area }
            }
            // A sphere stays one under similarities; otherwise it becomes a quadric.
            Self::Sphere(c, r, inward) => match place.similarity() {
                Some(scale) => Self::Sphere(place.point(*c), r * scale, *inward),
                None => {
                    let moved = Affine {
                        m: steradian_math::Mat4::from_translation(*c),
                        inv: steradian_math::Mat4::from_translation(-*c),
                    };
                    let kind = QuadricKind::Sphere { radius: *r, z_min: -r, z_max: *r };
                    Self::Quadric(Arc::new(Quadric { kind, phi_max: TAU, place: *place * moved, flip: *inward }))
                }
            },
            Self::Quadric(q) => Self::Quadric(Arc::new(Quadric { place: *place * q.place, ..**q })),
            Self::Swept(swept) => Self::Swept(Arc::new(swept.placed(place))),
            Self::Moving(moving) => moving.at(0.0).placed(place),
        }
    }
}
