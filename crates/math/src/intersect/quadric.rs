//! Ray and surface of second order: `⟨x, Q x⟩ = 0` in homogeneous coordinates, with sphere, ellipsoid, paraboloid,
//! cylinder, cone and pairs of planes as special cases.

use super::{roots, sphere};
use crate::{Ray, Vec3};
use glam::{DMat4, DVec3};

/// A surface of second order, `f(x) = ⟨(x,1), Q (x,1)⟩ = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric {
    /// The symmetric matrix `Q`; `f` is negative inside by convention.
    pub matrix: DMat4,
}

impl Quadric {
    /// From `f = xx·x² + yy·y² + zz·z² + 2(xy·xy + xz·xz + yz·yz) + 2(x·x + y·y + z·z) + w`, in the order
    /// `[xx, yy, zz, xy, xz, yz, x, y, z, w]`.
    pub fn new(c: [f64; 10]) -> Self {
        let [xx, yy, zz, xy, xz, yz, x, y, z, w] = c;
        Self {
            matrix: DMat4::from_cols_array(&[
                xx, xy, xz, x, //
                xy, yy, yz, y, //
                xz, yz, zz, z, //
                x, y, z, w,
            ]),
        }
    }

    /// The ellipsoid with semi-axes `radii` along the coordinate axes.
    pub fn ellipsoid(center: DVec3, radii: DVec3) -> Self {
        let k = 1.0 / (radii * radii);
        let l = -k * center;
        Self::new([k.x, k.y, k.z, 0.0, 0.0, 0.0, l.x, l.y, l.z, -l.dot(center) - 1.0])
    }

    /// The paraboloid `z = a x² + b y²` moved to `apex`; inside is above.
    pub fn paraboloid(apex: DVec3, a: f64, b: f64) -> Self {
        let c = apex;
        Self::new([a, b, 0.0, 0.0, 0.0, 0.0, -a * c.x, -b * c.y, -0.5, a * c.x * c.x + b * c.y * c.y + c.z])
    }

    /// The infinite cylinder of the given radius around the z axis.
    pub fn cylinder(radius: f64) -> Self {
        Self::new([1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -radius * radius])
    }

    /// The double cone around the z axis with its apex at the origin, whose radius grows by `slope` per unit of z.
    pub fn cone(slope: f64) -> Self {
        Self::new([1.0, 1.0, -slope * slope, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// The image under a map whose inverse is given: `Q' = M⁻ᵀ Q M⁻¹`.
    pub fn transformed(&self, inverse: &DMat4) -> Self {
        Self { matrix: inverse.transpose() * self.matrix * *inverse }
    }

    /// `f(p)`.
    pub fn value(&self, p: DVec3) -> f64 {
        let x = p.extend(1.0);
        x.dot(self.matrix * x)
    }

    /// The gradient of `f`, which points outwards; not normalised.
    pub fn gradient(&self, p: DVec3) -> DVec3 {
        2.0 * (self.matrix * p.extend(1.0)).truncate()
    }

    /// The ordered roots at which the line of the ray meets the surface; one root twice where it is met once only.
    /// `None` where it is missed, or where the line lies in it.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<[f32; 2]> {
        let [t0, t1] = self.roots(ray.origin.as_dvec3(), ray.direction.as_dvec3())?;
        Some([t0 as f32, t1 as f32])
    }

    /// [`Quadric::intersect`] for a line from `o` along `d`.
    #[inline]
    pub fn roots(&self, o: DVec3, d: DVec3) -> Option<[f64; 2]> {
        let (o, d) = (o.extend(1.0), d.extend(0.0));
        let qd = self.matrix * d;
        roots(d.dot(qd), o.dot(qd), o.dot(self.matrix * o))
    }
}

/// The ordered roots for the axis-aligned ellipsoid: the ray is scaled to the unit sphere, where `t` means the same.
#[inline]
pub fn ellipsoid(center: Vec3, radii: Vec3, ray: &Ray) -> Option<[f32; 2]> {
    let scaled = Ray { t_max: ray.t_max, ..Ray::new((ray.origin - center) / radii, ray.direction / radii) };
    sphere(Vec3::ZERO, 1.0, &scaled)
}

/// The ordered roots for the paraboloid `z = a x² + b y²` moved to `apex`.
#[inline]
pub fn paraboloid(apex: Vec3, a: f32, b: f32, ray: &Ray) -> Option<[f32; 2]> {
    let (o, d) = (ray.origin.as_dvec3() - apex.as_dvec3(), ray.direction.as_dvec3());
    let (a, b) = (f64::from(a), f64::from(b));
    let [t0, t1] = roots(
        a * d.x * d.x + b * d.y * d.y,
        a * o.x * d.x + b * o.y * d.y - 0.5 * d.z,
        a * o.x * o.x + b * o.y * o.y - o.z,
    )?;
    Some([t0 as f32, t1 as f32])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Transform;
    use crate::hash::HashRng;

    fn random(rng: &mut HashRng) -> Vec3 {
        Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5) * 4.0
    }

    #[test]
    fn closed_forms_and_the_general_quadric_agree() {
        let mut rng = HashRng::new(7);
        let mut hits = [0; 2];
        for _ in 0..10_000 {
            let (c, radii) = (random(&mut rng), random(&mut rng).abs() + 0.3);
            let origin = random(&mut rng) * 2.0;
            let ray = Ray::new(origin, random(&mut rng) * 0.5 + c - origin);
            let (a, b) = (rng.next_f32() + 0.1, rng.next_f32() - 0.5);
            let pairs = [
                (ellipsoid(c, radii, &ray), Quadric::ellipsoid(c.as_dvec3(), radii.as_dvec3())),
                (paraboloid(c, a, b, &ray), Quadric::paraboloid(c.as_dvec3(), f64::from(a), f64::from(b))),
            ];
            for (i, (closed, quadric)) in pairs.into_iter().enumerate() {
                match (closed, quadric.intersect(&ray)) {
                    (Some(s), Some(q)) => {
                        for (s, q) in s.into_iter().zip(q) {
                            if q.abs() < 1e3 {
                                assert!((s - q).abs() < 1e-3 * (1.0 + q.abs()), "{s} {q}");
                                let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(q);
                                let slope = quadric.gradient(p).length() * ray.direction.as_dvec3().length();
                                assert!(quadric.value(p).abs() < 1e-6 * (1.0 + slope) * (1.0 + f64::from(q.abs())));
                            }
                        }
                        hits[i] += 1;
                    }
                    (None, None) => {}
                    (s, q) => {
                        // Tangent to within rounding: the two roots coincide.
                        let [t0, t1] = s.or(q).expect("one of them");
                        assert!((t1 - t0).abs() < 1e-2, "{t0} {t1}");
                    }
                }
            }
        }
        assert!(hits[0] > 1000 && hits[1] > 1000);
    }

    #[test]
    fn a_ray_along_the_axis_meets_the_paraboloid_once() {
        let ray = Ray::new(Vec3::new(1.0, 0.5, 9.0), -Vec3::Z);
        assert_eq!(paraboloid(Vec3::ZERO, 1.0, 2.0, &ray), Some([7.5, 7.5]));
        assert_eq!(Quadric::paraboloid(DVec3::ZERO, 1.0, 2.0).intersect(&ray), Some([7.5, 7.5]));
        assert!(Quadric::paraboloid(DVec3::ZERO, 1.0, 2.0).gradient(DVec3::ZERO).z < 0.0, "outside is below");
    }

    #[test]
    fn cylinders_cones_and_transformed_quadrics() {
        let ray = Ray::new(Vec3::new(-3.0, 0.0, 1.0), Vec3::X);
        assert_eq!(Quadric::cylinder(2.0).intersect(&ray), Some([1.0, 5.0]));
        assert_eq!(Quadric::cone(0.5).intersect(&ray), Some([2.5, 3.5]));
        // A line in the surface has no roots of its own.
        assert_eq!(Quadric::cylinder(1.0).intersect(&Ray::new(Vec3::X, Vec3::Z)), None);
        // A sphere stretched and moved is the ellipsoid.
        let m = Transform::translate(DVec3::new(1.0, 2.0, 3.0)) * Transform::scale(DVec3::new(1.0, 2.0, 0.5));
        let image = Quadric::ellipsoid(DVec3::ZERO, DVec3::ONE).transformed(&m.inverse().expect("regular").matrix);
        let direct = Quadric::ellipsoid(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 0.5));
        assert!(image.matrix.abs_diff_eq(direct.matrix, 1e-12));
    }

    #[test]
    fn closed_roots_are_those_of_a_dense_mesh() {
        use crate::geometry::{Point3, surface};
        let (center, radii) = (DVec3::new(0.5, -0.25, 1.0), DVec3::new(1.0, 0.5, 0.75));
        let anchor = Point3::from_vector(center);
        let meshes = [
            surface::tessellate(&surface::Ellipsoid::new(anchor, radii).expect("an ellipsoid"), 64, 32),
            surface::tessellate(&surface::Paraboloid::new(anchor, 1.0, 0.5, 2.0).expect("a paraboloid"), 48, 48),
        ]
        .map(|m| m.expect("a mesh"));
        let mut rng = HashRng::new(8);
        let mut hits = [0; 2];
        for _ in 0..150 {
            // From above, into the bowl or on the ellipsoid.
            let origin = center.as_vec3() + Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, 4.0);
            let target = center.as_vec3() + random(&mut rng) * 0.2;
            let ray = Ray::new(origin, (target - origin).normalize());
            let closed =
                [ellipsoid(center.as_vec3(), radii.as_vec3(), &ray), paraboloid(center.as_vec3(), 1.0, 0.5, &ray)];
            for (i, (mesh, closed)) in meshes.iter().zip(closed).enumerate() {
                let nearest_facet = mesh
                    .triangles
                    .iter()
                    .filter_map(|t| {
                        let v = t.map(|k| mesh.positions[k as usize].to_vector().as_vec3());
                        crate::intersect::triangle(v, &ray).map(|h| h.t)
                    })
                    .min_by(f32::total_cmp);
                let Some(t) = nearest_facet else { continue };
                let exact = closed.and_then(|c| crate::intersect::nearest(c, ray.t_max)).expect("facets lie inside");
                // Facets lie within h²/8 of the surface, and are met at an angle.
                assert!((t - exact).abs() < 0.03, "{i}: {t} {exact}");
                hits[i] += 1;
            }
        }
        assert!(hits[0] > 75 && hits[1] > 75, "{hits:?}");
    }
}
