//! Who is right where we and Embree find different hits: the claims of both are held against doubles.

use super::case::Case;
use steradian_accel::{TopLevel, WORLD};
use steradian_math::{DVec3, Ray};

/// A nearest hit that a program has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claim {
    /// Number of the instance; 0 where there are none.
    pub instance: usize,
    /// Number of the triangle.
    pub triangle: usize,
}

/// Verdict in double precision on the rays for which both name different triangles.
#[derive(Clone, Copy, Debug, Default)]
pub struct Verdict {
    pub differ: usize,
    /// Number of rays for which ours, or Embree's, is the nearer of those triangles that the ray truly meets, or none.
    pub ours: usize,
    pub theirs: usize,
    /// Number of rays for which both were wrong: they name different triangles, and the ray meets neither.
    pub neither: usize,
}

/// Judges all rays.
pub fn judge(case: &Case, top: &TopLevel, rays: &[Ray], theirs: &[Option<Claim>]) -> Verdict {
    let mut verdict = Verdict::default();
    for (ray, theirs) in rays.iter().zip(theirs) {
        let ours = top.intersect(ray, &()).map(|hit| Claim {
            instance: if hit.id.instance == WORLD { 0 } else { hit.id.instance as usize },
            triangle: hit.id.prim as usize,
        });
        if ours == *theirs {
            continue;
        }
        verdict.differ += 1;
        let distance = |claim: &Option<Claim>| claim.and_then(|claim| meets(case, ray, claim));
        let truth = match (distance(&ours), distance(theirs)) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        let is_right = |claim: &Option<Claim>| distance(claim) == truth && (claim.is_none() == truth.is_none());
        match (is_right(&ours), is_right(theirs)) {
            (false, false) => verdict.neither += 1,
            (is_ours, is_theirs) => {
                verdict.ours += usize::from(is_ours);
                verdict.theirs += usize::from(is_theirs);
            }
        }
    }
    verdict
}

/// Intersection of a ray with a triangle, computed in doubles from the very numbers that both programs are given
/// (Möller, Trumbore 1997).
fn meets(case: &Case, ray: &Ray, claim: Claim) -> Option<f64> {
    let place = case.places.get(claim.instance).map(|place| place.m.as_dmat4());
    let corner = |i: u32| {
        let p = case.mesh.0[i as usize].as_dvec3();
        place.map_or(p, |m| m.transform_point3(p))
    };
    let [a, b, c] = case.mesh.1[claim.triangle].map(corner);
    let (origin, direction): (DVec3, DVec3) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (ab, ac, from) = (b - a, c - a, origin - a);
    let (p, q) = (direction.cross(ac), from.cross(ab));
    let determinant = ab.dot(p);
    let (u, v, t) = (from.dot(p) / determinant, direction.dot(q) / determinant, ac.dot(q) / determinant);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t <= f64::from(ray.t_max)).then_some(t)
}
