//! Mirrors, shears and changes of basis.

use super::Transform;
use glam::{DMat3, DMat4, DVec3};

impl Transform {
    /// From a linear map.
    pub fn linear(m: DMat3) -> Self {
        Self { matrix: DMat4::from_mat3(m) }
    }

    /// The mirror image in the plane through the origin with the given normal (Householder); `None` for a zero normal.
    /// Turns round the handedness ([`Transform::swaps_handedness`]), and with it the winding of triangles.
    pub fn mirror(normal: DVec3) -> Option<Self> {
        let n = normal.try_normalize()?;
        Some(Self::linear(DMat3::from_cols(
            DVec3::X - 2.0 * n.x * n,
            DVec3::Y - 2.0 * n.y * n,
            DVec3::Z - 2.0 * n.z * n,
        )))
    }

    /// The shear `x' = x + a y + b z`, `y' = y + c z`, `z' = z`: the cards of a deck slide, volumes and each card stay
    /// as they are.
    pub fn shear(a: f64, b: f64, c: f64) -> Self {
        Self::linear(DMat3::from_cols(DVec3::X, DVec3::new(a, 1.0, 0.0), DVec3::new(b, c, 1.0)))
    }

    /// To coordinates in the system with the given origin and basis: `M = B⁻¹ T(−origin)`, where `B⁻¹ = Bᵀ` for
    /// orthonormal vectors. The origin goes to zero and the basis to the unit vectors. `None` where the vectors do not
    /// span space.
    pub fn to_basis(origin: DVec3, basis: [DVec3; 3]) -> Option<Self> {
        let [u, v, w] = basis;
        Self { matrix: DMat4::from_cols(u.extend(0.0), v.extend(0.0), w.extend(0.0), origin.extend(1.0)) }.inverse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;
    use crate::intersect::{ellipsoid, sphere};
    use crate::{Ray, Vec3};

    fn same(a: Transform, b: Transform, tolerance: f64) -> bool {
        a.matrix.abs_diff_eq(b.matrix, tolerance)
    }

    #[test]
    fn transforms_are_a_group_that_does_not_commute() {
        let mut r = Random::new(23);
        for _ in 0..200 {
            let [a, b, c] = std::array::from_fn(|_| Transform { matrix: r.affine() });
            assert!(same((a * b) * c, a * (b * c), 1e-13));
            let inverse = a.inverse().expect("regular");
            assert!(same(a * inverse, Transform::IDENTITY, 1e-12) && same(inverse * a, Transform::IDENTITY, 1e-12));
            let product = (a * b).inverse().expect("regular");
            assert!(same(product, b.inverse().expect("regular") * inverse, 1e-10));
            let p = r.vector();
            assert!(((a * b).point(p) - a.point(b.point(p))).length() < 1e-13, "the right factor comes first");
        }
        let (turn, shift) = (Transform::rotate_z(1.0), Transform::translate(DVec3::X));
        assert!(!same(turn * shift, shift * turn, 0.1));
    }

    #[test]
    fn translations_commute_and_invert_exactly() {
        let mut r = Random::new(24);
        for _ in 0..100 {
            // Numbers with few bits: their sums are exact.
            let mut v = || (r.vector() * 1024.0).round() / 64.0;
            let (d, e, p) = (v(), v(), v());
            let (t, s) = (Transform::translate(d), Transform::translate(e));
            assert_eq!(t * s, s * t);
            assert_eq!(t.inverse(), Some(Transform::translate(-d)));
            assert_eq!(t.point(p), p + d);
            assert_eq!(t.vector(p), p, "directions do not move");
        }
    }

    #[test]
    fn mirrors_turn_the_winding_and_projections_have_no_inverse() {
        for signs in [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, -1.0, -1.0]] {
            let m = Transform::scale(DVec3::from(signs));
            assert_eq!(m.swaps_handedness(), signs.iter().product::<f64>() < 0.0);
            assert!(same(m * m, Transform::IDENTITY, 0.0));
        }
        let n = DVec3::new(1.0, 2.0, -0.5);
        let m = Transform::mirror(n).expect("a plane");
        assert!(m.swaps_handedness() && same(m * m, Transform::IDENTITY, 1e-14));
        assert!((m.vector(n) + n).length() < 1e-14);
        let along = n.cross(DVec3::X);
        assert!((m.vector(along) - along).length() < 1e-14);
        assert_eq!(Transform::mirror(DVec3::X), Some(Transform::scale(DVec3::new(-1.0, 1.0, 1.0))));
        assert_eq!(Transform::mirror(DVec3::ZERO), None);

        for s in [[1.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0], [f64::NAN, 1.0, 1.0]] {
            let projection = Transform::scale(DVec3::from(s));
            assert!(projection.inverse().is_none() && projection.affine().is_none());
        }
        // A projection along a slanted axis, whose determinant is only zero up to rounding.
        let turn = Transform::rotate(DVec3::new(1.0, 2.0, 3.0), 0.7);
        let slanted = turn * Transform::scale(DVec3::new(1.0, 1.0, 0.0)) * turn.inverse().expect("regular");
        assert!(slanted.inverse().is_none());
        // Small and uneven is not singular.
        for s in [[1e-6; 3], [1e6, 1.0, 1e-6], [1e-12, 1e-12, 1e-12]] {
            let m = turn * Transform::scale(DVec3::from(s)) * Transform::translate(DVec3::splat(1e5));
            assert!(m.inverse().is_some(), "{s:?}");
        }
    }

    #[test]
    fn sheared_cards_keep_their_area() {
        let mut r = Random::new(25);
        for _ in 0..100 {
            let m = Transform::shear(r.number() * 3.0, r.number() * 3.0, r.number() * 3.0);
            assert!((m.matrix.determinant() - 1.0).abs() < 1e-13);
        }
        // The deck: cards parallel to xy slide with z and stay congruent.
        let m = Transform::shear(0.0, 0.7, -0.4);
        let card = |z: f64| [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]].map(|[x, y]| DVec3::new(x, y, z));
        for z in [0.0, 1.0, 5.0] {
            let image = card(z).map(|p| m.point(p));
            assert!(((image[1] - image[0]).cross(image[3] - image[0]) - DVec3::Z * 6.0).length() < 1e-13);
            assert!((image[0] - DVec3::new(0.7 * z, -0.4 * z, z)).length() < 1e-15);
        }
        assert_eq!(Transform::shear(2.0, 3.0, 5.0).point(DVec3::ONE), DVec3::new(6.0, 6.0, 1.0));
    }

    #[test]
    fn a_change_of_basis_takes_the_basis_to_the_axes() {
        let mut r = Random::new(26);
        for _ in 0..200 {
            let turn = Transform::rotate(r.direction(), r.number() * 3.0);
            let basis = [DVec3::X, DVec3::Y, DVec3::Z].map(|e| turn.vector(e));
            let origin = r.vector() * 5.0;
            let m = Transform::to_basis(origin, basis).expect("a basis");
            assert!(m.point(origin).length() < 1e-14);
            for (b, e) in basis.into_iter().zip([DVec3::X, DVec3::Y, DVec3::Z]) {
                assert!((m.vector(b) - e).length() < 1e-14);
            }
            // Orthonormal: the inverse is the transpose.
            let transpose = Transform::linear(DMat3::from_cols(basis[0], basis[1], basis[2]).transpose());
            assert!(same(m, transpose * Transform::translate(-origin), 1e-13));
            let skew = Transform::to_basis(origin, [basis[0], basis[0] + basis[1], basis[2] * 2.0]).expect("a basis");
            assert!((skew.vector(basis[0] + basis[1]) - DVec3::Y).length() < 1e-13);
        }
        assert!(Transform::to_basis(DVec3::ZERO, [DVec3::X, DVec3::X, DVec3::Z]).is_none());
    }

    #[test]
    fn normals_stay_normal_under_any_map() {
        let mut r = Random::new(27);
        for _ in 0..500 {
            let m = Transform { matrix: r.affine() }.affine().expect("regular");
            let n = r.direction();
            let t = n.any_orthonormal_vector() + n.cross(n.any_orthonormal_vector()) * r.number();
            let (n, t) = (m.normal(n.as_vec3()), m.vector(t.as_vec3()));
            assert!(n.dot(t).abs() < 1e-5 * n.length() * t.length());
        }
        // The normals of an ellipsoid are those of the sphere it is the image of.
        let radii = DVec3::new(0.5, 2.0, 1.0);
        let e = crate::geometry::surface::Ellipsoid::new(Default::default(), radii).expect("an ellipsoid");
        let m = Transform::scale(radii).affine().expect("regular");
        for (u, v) in [(0.3, 0.4), (2.0, 1.5), (5.0, 2.9)] {
            use crate::geometry::surface::{Implicit, Parametric};
            let on_sphere = (e.point(u, v) - e.center()) / radii;
            let exact = e.normal(e.point(u, v)).expect("regular").as_vec3();
            assert!((m.normal(on_sphere.as_vec3()).normalize() - exact).length() < 1e-6);
        }
    }

    #[test]
    fn rays_in_object_space_keep_their_parameter() {
        let (center, radii) = (DVec3::new(1.0, -2.0, 0.5), DVec3::new(0.5, 2.0, 1.0));
        let m = (Transform::translate(center) * Transform::scale(radii)).affine().expect("regular");
        let mut r = Random::new(28);
        let mut hits = 0;
        for _ in 0..2000 {
            let origin = r.vector() * 6.0;
            let ray = Ray::new(origin.as_vec3(), (center + r.vector() * 2.0 - origin).as_vec3());
            let local = sphere(Vec3::ZERO, 1.0, &m.inverse().ray(&ray));
            let world = ellipsoid(center.as_vec3(), radii.as_vec3(), &ray);
            if let (Some(a), Some(b)) = (local, world) {
                if a[1] - a[0] > 1e-2 {
                    assert!((a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4, "{a:?} {b:?}");
                    let p = m.point(m.inverse().ray(&ray).at(a[0]));
                    assert!((p - ray.at(a[0])).length() < 1e-4);
                    hits += 1;
                }
            } else {
                let near = local.or(world);
                assert!(near.is_none_or(|t| t[1] - t[0] < 1e-2));
            }
        }
        assert!(hits > 500);
    }
}
