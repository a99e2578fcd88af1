//! Bounding spheres: Ritter's quick one, and the smallest one.

use super::{ROUNDING, Volume, line};
use steradian_math::{DVec3, Vec3};

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: DVec3,
    /// Its radius.
    pub radius: f64,
}

impl Sphere {
    /// Ritter's sphere ("An Efficient Bounding Sphere", Graphics Gems 1990): around two points that are far apart, and
    /// grown where points stick out. Usually 5 to 20 % too large. `None` without points, or where one is not finite.
    pub fn ritter(points: &[Vec3]) -> Option<Self> {
        let first = finite(points)?;
        let farthest = |from: DVec3| {
            let distance = |p: &Vec3| p.as_dvec3().distance_squared(from);
            points
                .iter()
                .fold(first, |far, p| if distance(p) > far.distance_squared(from) { p.as_dvec3() } else { far })
        };
        // The point farthest from any point, and the one farthest from that, span an initial diameter.
        let a = farthest(first);
        let b = farthest(a);
        let mut sphere = Self { center: (a + b) * 0.5, radius: a.distance(b) * 0.5 };
        // Grow the sphere towards points outside just so far that it still holds the old sphere.
        for p in points.iter().map(|p| p.as_dvec3()) {
            let distance = p.distance(sphere.center);
            if distance > sphere.radius {
                let radius = (sphere.radius + distance) * 0.5;
                sphere.center += (p - sphere.center) * ((distance - radius) / distance);
                sphere.radius = radius;
            }
        }
        Some(sphere.around(points))
    }

    /// The smallest sphere: Welzl's algorithm with the pivoting of Gärtner ("Fast and Robust Smallest Enclosing Balls",
    /// ESA 1999). `None` without points, or where one is not finite.
    pub fn smallest(points: &[Vec3]) -> Option<Self> {
        let first = finite(points)?;
        // Relative to a point among them, so that no digits are lost far from the origin. The list begins with those
        // that matter.
        let mut near: Vec<DVec3> = vec![DVec3::ZERO];
        let mut ball = Self { center: DVec3::ZERO, radius: 0.0 };
        // Each round takes in the point that sticks out most. The radius grows each time, until rounding is all there
        // is.
        loop {
            let distance = |p: &Vec3| (p.as_dvec3() - first).distance(ball.center);
            let out = points.iter().map(|p| (distance(p), p)).max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, p)) = out.filter(|(d, _)| *d > ball.radius * (1.0 + ROUNDING)) else { break };
            let p = p.as_dvec3() - first;
            let end = near.len();
            let larger = move_to_front(&mut near, end, &mut vec![p]);
            if larger.radius <= ball.radius {
                break;
            }
            ball = larger;
            near.insert(0, p);
        }
        ball.center += first;
        Some(ball.around(points))
    }

    /// With the radius that contains all points, whatever rounding did.
    fn around(self, points: &[Vec3]) -> Self {
        let radius = points.iter().map(|p| p.as_dvec3().distance(self.center)).fold(0.0, f64::max);
        Self { radius, ..self }
    }
}

/// The first point, if all are finite.
fn finite(points: &[Vec3]) -> Option<DVec3> {
    points.iter().all(|p| p.is_finite()).then_some(points.first()?.as_dvec3())
}

/// The smallest ball around the first points with all of `support` on its surface; points that support it move to the
/// front.
fn move_to_front(points: &mut [DVec3], end: usize, support: &mut Vec<DVec3>) -> Sphere {
    // Start with the ball through the support; four points determine it.
    let mut ball = through(support);
    if support.len() == 4 {
        return ball;
    }
    for i in 0..end {
        // A point outside the ball of its predecessors lies on the boundary of the smallest ball: recurse with it as
        // support.
        if points[i].distance(ball.center) > ball.radius * (1.0 + ROUNDING) {
            support.push(points[i]);
            ball = move_to_front(points, i, support);
            support.pop();
            points[..=i].rotate_right(1);
        }
    }
    ball
}

/// The smallest sphere through up to four points. Points that add nothing are left out.
fn through(support: &[DVec3]) -> Sphere {
    let Some((&first, others)) = support.split_first() else {
        return Sphere { center: DVec3::ZERO, radius: -1.0 };
    };
    // The centre is `first + Σ λᵢ qᵢ` and as far from each: 2 qᵢ·(Σ λⱼ qⱼ) = qᵢ·qᵢ, by elimination in an orthogonal
    // basis.
    let mut center = DVec3::ZERO;
    let mut basis: Vec<DVec3> = Vec::new();
    for &point in others {
        let q = point - first;
        let mut z = q;
        // Gram–Schmidt: the part of q orthogonal to the directions so far.
        for e in &basis {
            z -= *e * e.dot(z);
        }
        let height = z.length();
        if height.is_nan() || height <= 1e-10 * q.length() {
            continue;
        }
        let e = z / height;
        // Along the new direction the centre moves until it is as far from the point as from the first.
        let c = (q.length_squared() * 0.5 - q.dot(center)) / q.dot(e);
        center += e * c;
        basis.push(e);
    }
    Sphere { center: first + center, radius: center.length() }
}

impl Volume for Sphere {
    fn contains(&self, p: DVec3) -> bool {
        p.distance(self.center) <= self.radius + ROUNDING * (self.center.abs().max_element() + self.radius)
    }

    fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        line(origin, direction)?;
        // From the point of the line that is nearest to the centre.
        let scale = direction.length();
        // Distance along the line to the point nearest to the centre, and half the chord by Pythagoras.
        let d = direction / scale;
        let nearest = (self.center - origin).dot(d);
        let gap = (self.center - origin - d * nearest).length();
        let radius = self.radius + ROUNDING * (self.center - origin).abs().max_element();
        let half = (radius * radius - gap * gap).max(0.0).sqrt();
        (gap <= radius).then_some([(nearest - half) / scale, (nearest + half) / scale])
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.center.distance(other.center) <= self.radius + other.radius
    }

    fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{in_cube, soup};
    use steradian_math::hash::HashRng;

    #[test]
    fn the_smallest_sphere_is_that_of_its_support() {
        // Brute force over all pairs, triples and quadruples of few points.
        let mut rng = HashRng::new(101);
        for _ in 0..60 {
            let points: Vec<Vec3> = (0..9).map(|_| in_cube(&mut rng)).collect();
            let p: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
            let mut best = f64::INFINITY;
            for mask in 1_u32..1 << 9 {
                if (2..=4).contains(&mask.count_ones()) {
                    let support: Vec<DVec3> = (0..9).filter(|i| mask >> i & 1 == 1).map(|i| p[i]).collect();
                    let ball = through(&support);
                    if p.iter().all(|p| p.distance(ball.center) <= ball.radius * (1.0 + 1e-9)) {
                        best = best.min(ball.radius);
                    }
                }
            }
            let ball = Sphere::smallest(&points).expect("finite");
            assert!((ball.radius - best).abs() < 1e-9 * best, "{} {best}", ball.radius);
        }
    }

    #[test]
    fn known_spheres_are_found() {
        // Points on a sphere, far away; a segment; one point many times.
        let center = DVec3::new(1000.0, -2000.0, 500.0);
        let on = soup(500, 1.0, 102).0;
        let points: Vec<Vec3> = on.iter().map(|p| (p.as_dvec3().normalize() * 3.0 + center).as_vec3()).collect();
        let ball = Sphere::smallest(&points).expect("finite");
        assert!((ball.radius - 3.0).abs() < 3e-4 && ball.center.distance(center) < 3e-4, "{ball:?}");
        let segment = [Vec3::ZERO, Vec3::X * 0.5, Vec3::X * 2.0, Vec3::X];
        let ball = Sphere::smallest(&segment).expect("finite");
        assert!((ball.radius - 1.0).abs() < 1e-12 && ball.center.distance(DVec3::X) < 1e-12, "{ball:?}");
        assert_eq!(Sphere::smallest(&[Vec3::ONE; 7]).map(|b| (b.center, b.radius)), Some((DVec3::ONE, 0.0)));
        assert_eq!(Sphere::smallest(&[]), None);
        assert_eq!(Sphere::ritter(&[Vec3::ONE, Vec3::NAN]), None);
    }
}
