//! Faces of cubes (OpenGL 4.6, table 8.19).

use glam::Vec3;

/// The face that a direction meets, and where on it, from (0, 0) to (1, 1). The zero vector meets face 0 in its middle.
pub(super) fn face(direction: Vec3) -> (u32, [f32; 2]) {
    let Vec3 { x, y, z } = direction;
    let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
    // The axis of greatest magnitude selects the face; the other two coordinates, divided by it, are the place there.
    let (face, s, t, major) = if ax >= ay && ax >= az {
        if x >= 0.0 { (0, -z, -y, ax) } else { (1, z, -y, ax) }
    } else if ay >= az {
        if y >= 0.0 { (2, x, z, ay) } else { (3, x, -z, ay) }
    } else if z >= 0.0 {
        (4, x, -y, az)
    } else {
        (5, -x, -y, az)
    };
    let major = if major > 0.0 { major } else { 1.0 };
    (face, [0.5 * (s / major + 1.0), 0.5 * (t / major + 1.0)])
}

/// The direction of a place on a face; places beyond its border lead to the neighbours.
pub(super) fn direction(face: u32, [s, t]: [f32; 2]) -> Vec3 {
    let (s, t) = (2.0 * s - 1.0, 2.0 * t - 1.0);
    match face {
        0 => Vec3::new(1.0, -t, -s),
        1 => Vec3::new(-1.0, -t, s),
        2 => Vec3::new(s, 1.0, t),
        3 => Vec3::new(s, -1.0, -t),
        4 => Vec3::new(s, -t, 1.0),
        _ => Vec3::new(-s, -t, -1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_and_faces_are_inverse() {
        for number in 0..6 {
            for (i, j) in (0..9).flat_map(|i| (0..9).map(move |j| (i, j))) {
                let at = [(i as f32 + 0.5) / 9.0, (j as f32 + 0.5) / 9.0];
                let (found, back) = face(direction(number, at));
                assert_eq!(found, number);
                assert!((back[0] - at[0]).abs() < 1e-6 && (back[1] - at[1]).abs() < 1e-6);
            }
        }
        assert_eq!(face(Vec3::Y), (2, [0.5, 0.5]));
        assert_eq!(face(Vec3::ZERO).0, 0);
    }
}
