//! Encodings of normals in textures.

use steradian_math::Vec3;

/// Encoding of the values of a normal map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalCode {
    /// `(n + 1)/2`, each component.
    #[default]
    Xyz,
    /// x and y of these; `z = √(1 − x² − y²)` (the lecture's formula lacks the one and a sign: E18).
    Xy,
    /// The octahedron |x| + |y| + |z| = 1 seen from above, its lower half folded out into the corners (Meyer et al.,
    /// "On Floating-Point Normal Vectors", EGSR 2010).
    Octahedral,
}

/// The codes by name.
pub const NORMAL_CODES: [(&str, NormalCode); 3] =
    [("xyz", NormalCode::Xyz), ("xy", NormalCode::Xy), ("octahedral", NormalCode::Octahedral)];

impl NormalCode {
    /// The normal of stored numbers, in `[0, 1]`; not of unit length.
    #[inline]
    pub fn decode(self, value: Vec3) -> Vec3 {
        let m = value * 2.0 - 1.0;
        match self {
            Self::Xyz => m,
            Self::Xy => m.with_z((1.0 - m.x * m.x - m.y * m.y).max(0.0).sqrt()),
            Self::Octahedral => {
                let z = 1.0 - m.x.abs() - m.y.abs();
                let (x, y) = if z < 0.0 { folded(m.x, m.y) } else { (m.x, m.y) };
                Vec3::new(x, y, z)
            }
        }
    }

    /// The numbers to store for a unit normal; one that points down has none in [`Self::Xy`], and counts as one that
    /// points up.
    pub fn encode(self, n: Vec3) -> Vec3 {
        let m = match self {
            Self::Xyz => n,
            Self::Xy => n.with_z(0.0),
            Self::Octahedral => {
                let p = n / (n.x.abs() + n.y.abs() + n.z.abs());
                let (x, y) = if p.z < 0.0 { folded(p.x, p.y) } else { (p.x, p.y) };
                Vec3::new(x, y, 0.0)
            }
        };
        (m + 1.0) * 0.5
    }
}

/// The point mirrored in the edge of the diamond |x| + |y| = 1 of its quadrant.
#[inline]
fn folded(x: f32, y: f32) -> (f32, f32) {
    ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{Vec2, warp};

    /// E18: z = √(max(0, 1 − x² − y²)), not √(x² + y²).
    #[test]
    fn two_numbers_give_the_third() {
        let n = NormalCode::Xy.decode(Vec3::new(0.8, 0.5, 0.3));
        assert!((n - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-6, "{n}");
        assert_eq!(NormalCode::Xy.decode(Vec3::splat(0.5)), Vec3::Z);
        // Beyond the disk there is no normal; z stays a number.
        assert_eq!(NormalCode::Xy.decode(Vec3::ONE), Vec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn codes_come_back() {
        for (name, code) in NORMAL_CODES {
            for i in 0..40 * 40 {
                let u = Vec2::new((i % 40) as f32 + 0.5, (i / 40) as f32 + 0.5) / 40.0;
                let n = warp::uniform_sphere(u);
                let n = if code == NormalCode::Xy { n.with_z(n.z.abs()) } else { n };
                let (stored, seen) = (code.encode(n), code.decode(code.encode(n)).normalize());
                assert!(stored.min_element() >= 0.0 && stored.max_element() <= 1.0);
                assert!((seen - n).length() < 1e-3, "{name} {n} {seen}");
            }
        }
    }

    /// The largest angle, in degrees, between a normal of the upper half and what is left of it: what a bit is worth in
    /// each code.
    #[test]
    fn largest_angles_by_bits() {
        let worst = |code: NormalCode, bits: u32, above: f32| {
            let most = ((1_u32 << bits) - 1) as f32;
            let n = 400;
            let mut worst = 0.0_f64;
            for i in 0..n * n {
                let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let d = warp::uniform_sphere(Vec2::new(0.5 * u.x, u.y));
                let d = d.with_z(d.z.abs());
                if d.z < above {
                    continue;
                }
                let stored = (code.encode(d) * most).round() / most;
                let seen = code.decode(stored).normalize().as_dvec3();
                worst = worst.max(seen.cross(d.as_dvec3()).length().atan2(seen.dot(d.as_dvec3())).to_degrees());
            }
            worst
        };
        // Bits of each number, how high the normal stands at least, and the angles of the three codes. Two numbers lose
        // the horizon.
        for (bits, above, angles) in [
            (8, 0.0, [0.3715, 4.953, 0.9168]),
            (8, 0.5, [0.3715, 0.5947, 0.9168]),
            (16, 0.0, [0.001_49, 0.2614, 0.003_52]),
        ] {
            for ((name, code), wanted) in NORMAL_CODES.into_iter().zip(angles) {
                let seen = worst(code, bits, above);
                assert!((seen / wanted - 1.0).abs() < 0.02, "{name}, {bits} bits, z > {above}: {seen}");
            }
        }
    }
}
