//! Random geometry for tests.

use super::Point3;
use crate::hash::HashRng;
use glam::{DMat4, DVec2, DVec3};

pub struct Random(HashRng);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(HashRng::new(seed))
    }

    /// A number in [−1, 1).
    pub fn number(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector2(&mut self) -> DVec2 {
        DVec2::new(self.number(), self.number())
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    pub fn point(&mut self) -> Point3 {
        Point3::from_vector(self.vector())
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// An affine map that is far from singular.
    pub fn affine(&mut self) -> DMat4 {
        loop {
            let columns = [self.vector(), self.vector(), self.vector()];
            let m = DMat4::from_cols(
                columns[0].extend(0.0),
                columns[1].extend(0.0),
                columns[2].extend(0.0),
                self.vector().extend(1.0),
            );
            if m.determinant().abs() > 0.1 {
                return m;
            }
        }
    }
}
