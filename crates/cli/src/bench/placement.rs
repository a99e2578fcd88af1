//! Placement of the instances of the measurement: a cubic lattice with random rotations and sizes. Only `+ − × ÷ √` in
//! `f64` in a fixed order and an integer generator decide them, so that other programs can be measured with the very
//! same scene.

use steradian::math::{DMat4, DVec3, Transform, transform::Affine};

/// SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `[0, 1)`.
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// Uniform in `[-1, 1)`.
    fn signed(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }
}

/// The places of the first `count` instances in the smallest cubic lattice that holds them.
pub fn lattice(count: u32) -> Vec<Affine> {
    let side = (1..).find(|&side: &u32| u64::from(side).pow(3) >= u64::from(count)).unwrap_or(1);
    let mut rng = SplitMix(77);
    let mut place = |i: u32| {
        let (q, length2) = loop {
            let q = [rng.signed(), rng.signed(), rng.signed(), rng.signed()];
            let length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
            if (0.01..=1.0).contains(&length2) {
                break (q, length2);
            }
        };
        let [a, b, c, d] = q.map(|x| x * (1.0 / length2.sqrt()));
        let size = 0.7 + 0.6 * rng.uniform();
        let at = |i: u32| (f64::from(i) - f64::from(side - 1) / 2.0) * 2.6;
        let column = |x: f64, y: f64, z: f64| (DVec3::new(x, y, z) * size).extend(0.0);
        Transform {
            matrix: DMat4::from_cols(
                column(1.0 - 2.0 * (c * c + d * d), 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)),
                column(2.0 * (b * c - a * d), 1.0 - 2.0 * (b * b + d * d), 2.0 * (c * d + a * b)),
                column(2.0 * (b * d + a * c), 2.0 * (c * d - a * b), 1.0 - 2.0 * (b * b + c * c)),
                DVec3::new(at(i % side), at(i / side % side), at(i / side / side)).extend(1.0),
            ),
        }
        .affine()
    };
    (0..count).filter_map(&mut place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::math::Vec3;

    #[test]
    fn instances_stand_in_a_lattice() {
        let places = lattice(1000);
        assert_eq!(places.len(), 1000);
        for (i, m) in places.iter().enumerate() {
            let i = i as f32;
            let at = Vec3::new(i % 10.0, (i / 10.0).floor() % 10.0, (i / 100.0).floor());
            assert!(m.point(Vec3::ZERO).distance((at - 4.5) * 2.6) < 1e-4);
            let sizes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| m.m.transform_vector3(axis).length());
            assert!(sizes.iter().all(|&s| (0.7..1.3).contains(&s) && (s - sizes[0]).abs() < 1e-5), "{sizes:?}");
        }
        assert_eq!([lattice(0).len(), lattice(1).len(), lattice(9).len()], [0, 1, 9]);
    }
}
