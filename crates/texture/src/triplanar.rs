//! Three projections along the axes, blended by how much the surface faces each: textures without coordinates and
//! without seams.

use super::TextureContext;
use steradian_math::{Vec3, transform::Affine};

/// Blending of the three projections.
#[derive(Clone, Copy, Debug)]
pub struct Triplanar {
    /// From the world to the space whose axes are projected along.
    pub local: Affine,
    /// Weights are |n|ˢ: 1 blends widely, large values leave narrow borders.
    pub sharpness: u32,
}

impl Triplanar {
    /// Weights of the projections along x, y and z; they add up to one.
    pub fn weights(&self, at: &TextureContext) -> [f32; 3] {
        let n = self.local.normal(at.n).abs();
        let n = n / n.max_element();
        if !n.is_finite() {
            return [0.0, 0.0, 1.0];
        }
        let power = |v: f32| (0..self.sharpness.clamp(1, 64)).fold(1.0, |p, _| p * v);
        let w = Vec3::new(power(n.x), power(n.y), power(n.z));
        (w / w.element_sum()).to_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::Vec2;

    #[test]
    fn weights_add_up_and_faces_stand_alone() {
        let t = Triplanar { local: Affine::IDENTITY, sharpness: 4 };
        let at = |n: Vec3| TextureContext { n, ..TextureContext::new(Vec3::ZERO, Vec2::ZERO) };
        assert_eq!(t.weights(&at(-Vec3::Y)), [0.0, 1.0, 0.0]);
        assert_eq!(t.weights(&at(Vec3::ZERO)), [0.0, 0.0, 1.0]);
        let w = t.weights(&at(Vec3::new(1.0, -2.0, 0.0).normalize()));
        assert!((w[0] - 1.0 / 17.0).abs() < 1e-6 && (w.iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }
}
