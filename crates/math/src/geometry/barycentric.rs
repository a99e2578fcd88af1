//! Barycentric coordinates and simplex coordinates in any dimension.
//!
//! The coordinate of a vertex is the ratio of two signed contents: of the simplex in which the point takes that
//! vertex's place, and of the whole simplex, both with the vertices in the same order. They add up to one and are kept
//! by affine maps.

use glam::{DVec2, DVec3};

/// Coordinates of a point in a triangle of the plane; `None` for a triangle without area.
pub fn triangle_2d(v: [DVec2; 3], p: DVec2) -> Option<[f64; 3]> {
    let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
    let whole = area(v[0], v[1], v[2]);
    let b = [area(p, v[1], v[2]) / whole, area(v[0], p, v[2]) / whole, area(v[0], v[1], p) / whole];
    b.iter().all(|x| x.is_finite()).then_some(b)
}

/// Coordinates of the projection of a point on the plane of a triangle in space; `None` for a triangle without area.
pub fn triangle_3d(v: [DVec3; 3], p: DVec3) -> Option<[f64; 3]> {
    let normal = (v[1] - v[0]).cross(v[2] - v[0]);
    let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).dot(normal);
    let whole = normal.length_squared();
    let b = [area(p, v[1], v[2]) / whole, area(v[0], p, v[2]) / whole, area(v[0], v[1], p) / whole];
    b.iter().all(|x| x.is_finite()).then_some(b)
}

/// Coordinates of a point in a tetrahedron; `None` for one without volume.
pub fn tetrahedron(v: [DVec3; 4], p: DVec3) -> Option<[f64; 4]> {
    let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
    let whole = volume(v[0], v[1], v[2], v[3]);
    let b = [
        volume(p, v[1], v[2], v[3]) / whole,
        volume(v[0], p, v[2], v[3]) / whole,
        volume(v[0], v[1], p, v[3]) / whole,
        volume(v[0], v[1], v[2], p) / whole,
    ];
    b.iter().all(|x| x.is_finite()).then_some(b)
}

/// Coordinates of a point of n-space in the simplex of `n + 1` affinely independent vertices. `None` where the vertices
/// are dependent or the numbers of coordinates do not match.
///
/// Solves `Σ λᵢ (Vᵢ − V₀) = P − V₀` by Gaussian elimination with partial pivoting, O(n³).
pub fn simplex(vertices: &[&[f64]], point: &[f64]) -> Option<Vec<f64>> {
    let n = point.len();
    if vertices.len() != n + 1 || vertices.iter().any(|v| v.len() != n) {
        return None;
    }
    // Row k holds coordinate k of the edges, then of the point.
    let origin = vertices[0];
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|k| {
            let edges = vertices[1..].iter().map(|v| v[k] - origin[k]);
            edges.chain(std::iter::once(point[k] - origin[k])).collect()
        })
        .collect();
    let size = rows.iter().flat_map(|r| &r[..n]).fold(0.0, |m: f64, x| m.max(x.abs()));
    for column in 0..n {
        let pivot = (column..n).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))?;
        let pivot_size = rows[pivot][column].abs();
        if pivot_size <= 1e-14 * size || pivot_size.is_nan() {
            return None;
        }
        rows.swap(column, pivot);
        let (done, below) = rows.split_at_mut(column + 1);
        let pivot_row = &done[column];
        for row in below {
            let factor = row[column] / pivot_row[column];
            for (x, p) in row[column..].iter_mut().zip(&pivot_row[column..]) {
                *x -= factor * p;
            }
        }
    }
    let mut weights = vec![0.0; n + 1];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * weights[j + 1]).sum();
        weights[k + 1] = (rows[k][n] - known) / rows[k][k];
    }
    weights[0] = 1.0 - weights[1..].iter().sum::<f64>();
    weights.iter().all(|w| w.is_finite()).then_some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;

    #[test]
    fn coordinates_reconstruct_the_point() {
        let mut r = Random::new(6);
        for _ in 0..1000 {
            let v = [r.vector2(), r.vector2(), r.vector2()];
            let p = r.vector2();
            if (v[1] - v[0]).perp_dot(v[2] - v[0]).abs() > 0.05 {
                let b = triangle_2d(v, p).expect("a triangle");
                assert!((b.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                assert!((v[0] * b[0] + v[1] * b[1] + v[2] * b[2] - p).length() < 1e-12);
            }
            let v = [r.vector(), r.vector(), r.vector(), r.vector()];
            let p = r.vector();
            if (v[1] - v[0]).cross(v[2] - v[0]).dot(v[3] - v[0]).abs() > 0.05 {
                let b = tetrahedron(v, p).expect("a tetrahedron");
                assert!((b.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                let back: DVec3 = v.iter().zip(b).map(|(v, b)| *v * b).sum();
                assert!((back - p).length() < 1e-12);
                // In space the triangle's coordinates are those of the foot of the perpendicular.
                let t = [v[0], v[1], v[2]];
                let b = triangle_3d(t, p).expect("a triangle");
                let foot: DVec3 = t.iter().zip(b).map(|(v, b)| *v * b).sum();
                assert!((p - foot).dot(t[1] - t[0]).abs() < 1e-12 && (p - foot).dot(t[2] - t[0]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn affine_maps_keep_them() {
        let mut r = Random::new(7);
        for _ in 0..200 {
            let m = r.affine();
            let v = [r.vector(), r.vector(), r.vector(), r.vector()];
            let p = r.vector();
            if (v[1] - v[0]).cross(v[2] - v[0]).dot(v[3] - v[0]).abs() < 0.1 {
                continue;
            }
            let before = tetrahedron(v, p).expect("a tetrahedron");
            let after = tetrahedron(v.map(|x| m.transform_point3(x)), m.transform_point3(p)).expect("still one");
            for (a, b) in before.into_iter().zip(after) {
                assert!((a - b).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn a_known_tetrahedron() {
        // λ = (0.4, 0.3, 0.2, 0.1): the order of the vertices in the determinants decides about the sign.
        let v = [
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(0.0, 2.0, 0.0),
            DVec3::new(0.0, 0.0, 3.0),
            DVec3::new(1.0, 1.0, 1.0),
        ];
        let p = v[0] * 0.4 + v[1] * 0.3 + v[2] * 0.2 + v[3] * 0.1;
        let b = tetrahedron(v, p).expect("a tetrahedron");
        let s = simplex(&v.each_ref().map(|v| v.as_ref() as &[f64]), p.as_ref()).expect("a simplex");
        for (i, exact) in [0.4, 0.3, 0.2, 0.1].into_iter().enumerate() {
            assert!((b[i] - exact).abs() < 1e-14 && (s[i] - exact).abs() < 1e-14);
        }
    }

    #[test]
    fn simplices_of_any_dimension() {
        let mut r = Random::new(8);
        for n in [0, 1, 2, 5, 12] {
            let vertices: Vec<Vec<f64>> = (0..=n).map(|_| (0..n).map(|_| r.number()).collect()).collect();
            let point: Vec<f64> = (0..n).map(|_| r.number()).collect();
            let v: Vec<&[f64]> = vertices.iter().map(Vec::as_slice).collect();
            let b = simplex(&v, &point).expect("independent vertices");
            assert!((b.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            for k in 0..n {
                let x: f64 = b.iter().zip(&v).map(|(b, v)| b * v[k]).sum();
                assert!((x - point[k]).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn degenerate_simplices_are_refused() {
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        assert_eq!(triangle_3d(line, DVec3::Y), None);
        assert_eq!(triangle_2d([DVec2::ZERO, DVec2::X, DVec2::X * 3.0], DVec2::Y), None);
        assert_eq!(tetrahedron([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE.with_z(0.0)], DVec3::Z), None);
        assert_eq!(simplex(&[&[0.0, 0.0], &[1.0, 1.0], &[2.0, 2.0]], &[0.0, 1.0]), None);
        assert_eq!(simplex(&[&[0.0, 0.0], &[1.0]], &[0.0, 1.0]), None);
        assert_eq!(simplex(&[&[0.0], &[f64::NAN]], &[0.5]), None);
    }
}
