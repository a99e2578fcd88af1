//! Cube maps: six square faces around a point, in one picture below each other in the order +x, −x, +y, −y, +z, −z.
//!
//! Each face is as OpenGL and Direct3D store it, whose space of cube maps is left-handed: +x is mirrored, so that in a
//! right-handed world with +y up nothing is mirrored that is seen from inside.

use steradian_math::{Vec2, Vec3};

/// The direction of a place on a face: `s` to the right and `t` down, from −1 to 1; not of unit length.
fn on_face(face: usize, s: f32, t: f32) -> Vec3 {
    let d = match face {
        0 => Vec3::new(1.0, -t, -s),
        1 => Vec3::new(-1.0, -t, s),
        2 => Vec3::new(s, 1.0, t),
        3 => Vec3::new(s, -1.0, -t),
        4 => Vec3::new(s, -t, 1.0),
        _ => Vec3::new(-s, -t, -1.0),
    };
    Vec3::new(-d.x, d.y, d.z)
}

/// Face and place on it of a direction.
fn face_of(d: Vec3) -> (usize, f32, f32) {
    let d = Vec3::new(-d.x, d.y, d.z);
    let a = d.abs();
    // The axis of the largest component; of equal ones the last.
    let (face, s, t, m) = if a.x > a.y && a.x > a.z {
        if d.x > 0.0 { (0, -d.z, -d.y, a.x) } else { (1, d.z, -d.y, a.x) }
    } else if a.y > a.z {
        if d.y > 0.0 { (2, d.x, d.z, a.y) } else { (3, d.x, -d.z, a.y) }
    } else if d.z > 0.0 {
        (4, d.x, -d.y, a.z)
    } else {
        (5, -d.x, -d.y, a.z)
    };
    (face, s / m, t / m)
}

/// Coordinates in the picture of a direction.
pub fn uv(d: Vec3) -> Vec2 {
    let (face, s, t) = face_of(d);
    // Not beyond the face by rounding.
    let half = |v: f32| (0.5 * v + 0.5).clamp(0.0, 1.0 - f32::EPSILON);
    Vec2::new(half(s), (face as f32 + half(t)) / 6.0)
}

/// Direction of coordinates in the picture, of unit length, and the solid angle for each unit of its area: 24/r³ for a
/// place on the cube of edge 2 at the distance r.
pub fn direction(uv: Vec2) -> (Vec3, f32) {
    let v = (6.0 * uv.y).clamp(0.0, 6.0 - 6.0 * f32::EPSILON);
    let face = v as usize;
    let d = on_face(face, 2.0 * uv.x - 1.0, 2.0 * (v - face as f32) - 1.0);
    let r = d.length();
    (d / r, 24.0 / (r * r * r))
}

/// The four texels around a place with their weights, in a picture of faces `n` texels wide; beyond an edge those of
/// the face that is joined to it.
pub fn around(uv: Vec2, n: usize) -> [([usize; 2], f32); 4] {
    let v = (6.0 * uv.y).clamp(0.0, 6.0 - 6.0 * f32::EPSILON);
    let face = v as usize;
    let place = Vec2::new(uv.x, v - face as f32) * n as f32 - 0.5;
    let (first, t) = (place.floor(), place - place.floor());
    let texel = |dx: f32, dy: f32| {
        let at = first + Vec2::new(dx, dy);
        let is_inside = at.min_element() >= 0.0 && at.max_element() < n as f32;
        let (face, at) = if is_inside {
            (face, at)
        } else {
            let [s, t] = [at.x, at.y].map(|i| (i + 0.5) / n as f32 * 2.0 - 1.0);
            let (other, s, t) = face_of(on_face(face, s, t));
            (other, Vec2::new(0.5 * s + 0.5, 0.5 * t + 0.5) * n as f32)
        };
        let [x, y] = [at.x, at.y].map(|i| (i.max(0.0) as usize).min(n - 1));
        [x, face * n + y]
    };
    [
        (texel(0.0, 0.0), (1.0 - t.x) * (1.0 - t.y)),
        (texel(1.0, 0.0), t.x * (1.0 - t.y)),
        (texel(0.0, 1.0), (1.0 - t.x) * t.y),
        (texel(1.0, 1.0), t.x * t.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{hash::HashRng, warp};

    /// M217: coordinates and directions are inverse to each other, the faces lie where they should, and solid angles
    /// add up to the sphere.
    #[test]
    fn faces_surround_the_point() {
        for (d, face) in [(-Vec3::X, 0), (Vec3::X, 1), (Vec3::Y, 2), (-Vec3::Y, 3), (Vec3::Z, 4), (-Vec3::Z, 5)] {
            assert_eq!((uv(d).y * 6.0) as usize, face, "{d}");
        }
        // Seen from inside, to the right of +z is −x in a right-handed world; above is +y.
        assert!(direction(Vec2::new(0.9, 4.5 / 6.0)).0.x < -0.5 && direction(Vec2::new(0.5, 4.1 / 6.0)).0.y > 0.5);
        let mut rng = HashRng::new(217);
        let (mut sum, n) = (0.0, 100_000);
        for _ in 0..n {
            let d = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()));
            assert!((direction(uv(d)).0 - d).length() < 1e-5, "{d}");
            sum += f64::from(direction(Vec2::new(rng.next_f32(), rng.next_f32())).1);
        }
        assert!((sum / f64::from(n) - 4.0 * std::f64::consts::PI).abs() < 0.05);
    }

    /// Interpolation has no step across edges: of a linear function of the direction it is the function, nearly.
    #[test]
    fn edges_have_no_seams() {
        let n = 32;
        let value = |[x, y]: [usize; 2]| {
            let uv = Vec2::new((x as f32 + 0.5) / n as f32, (y as f32 + 0.5) / (6 * n) as f32);
            direction(uv).0.dot(Vec3::new(0.3, -0.5, 0.8))
        };
        let mut rng = HashRng::new(218);
        for _ in 0..20_000 {
            let d = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()));
            let found: f32 = around(uv(d), n).iter().map(|(at, weight)| value(*at) * weight).sum();
            assert!((found - d.dot(Vec3::new(0.3, -0.5, 0.8))).abs() < 0.03, "{d}: {found}");
        }
    }
}
