//! Convex polygons in space, and their parts before a plane.

use glam::DVec3;

/// Most corners: four of a patch, or those of an infinite plane cut by others.
pub const MOST_CORNERS: usize = 16;

/// A convex polygon, counterclockwise as seen from the side that its normal points to.
#[derive(Clone, Copy, Debug)]
pub struct Polygon {
    corners: [DVec3; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    /// Polygon from its corners; those beyond [`MOST_CORNERS`] are left out.
    pub fn new(corners: &[DVec3]) -> Self {
        let mut polygon = Self { corners: [DVec3::ZERO; MOST_CORNERS], count: 0 };
        corners.iter().for_each(|c| polygon.push(*c));
        polygon
    }

    /// A regular polygon around a centre, in the plane that two orthogonal vectors of the circumscribed circle's radius
    /// span.
    #[cfg(test)]
    pub fn corners_of_regular(count: usize, center: DVec3, x: DVec3, y: DVec3) -> Vec<DVec3> {
        (0..count)
            .map(|k| {
                let (sin, cos) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
                center + x * cos + y * sin
            })
            .collect()
    }

    fn push(&mut self, corner: DVec3) {
        if self.count < MOST_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    /// The corners.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// The polygon seen from its other side: its corners in reverse order.
    pub fn reversed(&self) -> Self {
        let mut polygon = *self;
        polygon.corners[..self.count].reverse();
        polygon
    }

    /// Twice the area along the normal: the sum of the edges' moments.
    fn moment(&self) -> DVec3 {
        let corners = self.corners();
        let Some(origin) = corners.first() else { return DVec3::ZERO };
        corners.windows(2).skip(1).map(|e| (e[0] - *origin).cross(e[1] - *origin)).sum()
    }

    /// Unit normal; zero for a polygon without area.
    pub fn normal(&self) -> DVec3 {
        self.moment().normalize_or_zero()
    }

    /// Area.
    pub fn area(&self) -> f64 {
        0.5 * self.moment().length()
    }

    /// Mean of the corners.
    pub fn center(&self) -> DVec3 {
        self.corners().iter().sum::<DVec3>() / self.count.max(1) as f64
    }

    /// Largest distance of a corner from a point.
    pub fn reach(&self, from: DVec3) -> f64 {
        self.corners().iter().map(|c| c.distance_squared(from)).fold(0.0, f64::max).sqrt()
    }

    /// The part on the side of a plane through `origin` that `normal` points to (Sutherland, Hodgman 1974); `None`
    /// where there is none.
    pub fn before(&self, origin: DVec3, normal: DVec3) -> Option<Self> {
        let height = |c: DVec3| normal.dot(c - origin);
        let corners = self.corners();
        if corners.iter().all(|c| height(*c) >= 0.0) {
            return Some(*self);
        }
        let mut part = Self { corners: self.corners, count: 0 };
        // Edge by edge: a crossing adds the point on the plane, an end in front adds itself.
        for (k, &to) in corners.iter().enumerate() {
            let from = corners[(k + corners.len() - 1) % corners.len()];
            let (a, b) = (height(from), height(to));
            if (a < 0.0) != (b < 0.0) {
                part.push(from.lerp(to, a / (a - b)));
            }
            if b >= 0.0 {
                part.push(to);
            }
        }
        (part.count >= 3).then_some(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_cut() {
        let square = Polygon::new(&[DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y]);
        assert_eq!((square.area(), square.normal()), (1.0, DVec3::Z));
        assert_eq!(square.reversed().normal(), -DVec3::Z);
        let part = square.before(DVec3::new(0.25, 0.0, 0.0), DVec3::new(1.0, 1.0, 0.0).normalize()).unwrap();
        assert!((part.area() - (1.0 - 0.25 * 0.25 / 2.0)).abs() < 1e-15);
        assert_eq!(part.corners().len(), 5);
        assert!(square.before(DVec3::new(0.0, 2.0, 0.0), DVec3::Y).is_none());
    }
}
