//! Unit vectors in less room: the octahedral map of the sphere (Meyer et al. 2010, "On Floating-Point Normal Vectors")
//! to 16 bits.

use steradian_math::Vec3;

/// A unit vector to 16 bits for each coordinate of its place on the octahedron, about 6e-5 radians.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unit3([i16; 2]);

const STEPS: f32 = 32767.0;

impl Unit3 {
    /// The z axis, which comes back as it is.
    pub(crate) const Z: Self = Self([0; 2]);

    /// The vector nearest to the direction of `n`; the z axis for none.
    pub(crate) fn new(n: Vec3) -> Self {
        let p = n / (n.x.abs() + n.y.abs() + n.z.abs());
        let [x, y] = if p.z < 0.0 { folded(p.x, p.y) } else { [p.x, p.y] };
        // A NaN becomes zero.
        Self([x, y].map(|v| (v * STEPS).round() as i16))
    }

    #[inline]
    pub(crate) fn get(self) -> Vec3 {
        let [x, y] = self.0.map(|v| f32::from(v) / STEPS);
        let z = 1.0 - x.abs() - y.abs();
        let [x, y] = if z < 0.0 { folded(x, y) } else { [x, y] };
        Vec3::new(x, y, z).normalize()
    }
}

/// The lower half of the octahedron, in the corners of the square; its own inverse.
fn folded(x: f32, y: f32) -> [f32; 2] {
    [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    #[test]
    fn directions_come_back() {
        let mut rng = HashRng::new(3);
        for _ in 0..10_000 {
            let n = Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5).normalize();
            let back = Unit3::new(n).get();
            assert!((back - n).length() < 8e-5 && back.is_normalized(), "{n} {back}");
        }
        assert_eq!(Unit3::new(Vec3::Z), Unit3::Z);
        assert_eq!(Unit3::Z.get(), Vec3::Z);
        assert_eq!(Unit3::new(Vec3::ZERO), Unit3::Z);
        assert!((Unit3::new(-Vec3::Z).get() + Vec3::Z).length() < 8e-5);
    }
}
