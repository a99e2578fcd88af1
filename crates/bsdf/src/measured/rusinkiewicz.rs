//! Half–difference angles of a pair of directions (Rusinkiewicz 1998): the half vector's angle from the normal, and the
//! angles of one direction around the half vector. Mirror peaks lie at a half angle of zero for every incidence.

use steradian_math::{Vec3, elementary::atan2};

/// Angles in radians of a pair above an isotropic surface.
#[derive(Clone, Copy, Debug)]
pub struct HalfDifference {
    /// Half vector from the normal, [0, π/2].
    pub theta_h: f32,
    /// Direction from the half vector, [0, π/2].
    pub theta_d: f32,
    /// Azimuth around it, (−π, π]; zero in the plane of half vector and normal.
    pub phi_d: f32,
}

impl HalfDifference {
    /// Angles of two directions above the surface; the azimuth is that of `w`.
    #[inline]
    pub fn new(w: Vec3, other: Vec3) -> Option<Self> {
        let h = (w + other).try_normalize()?;
        // Rotate the half vector onto the normal: by its azimuth, then by its angle.
        let sin_h = (h.x * h.x + h.y * h.y).sqrt();
        let (cos_phi, sin_phi) = if sin_h > 0.0 { (h.x / sin_h, h.y / sin_h) } else { (1.0, 0.0) };
        // Components of w in the frame around the half vector.
        let x = w.dot(Vec3::new(h.z * cos_phi, h.z * sin_phi, -sin_h));
        let y = w.dot(Vec3::new(-sin_phi, cos_phi, 0.0));
        Some(Self { theta_h: atan2(sin_h, h.z), theta_d: atan2((x * x + y * y).sqrt(), w.dot(h)), phi_d: atan2(y, x) })
    }
}
