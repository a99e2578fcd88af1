//! Oriented boxes: along the principal axes of the points, and the smallest of those that lie flush with a face of the
//! convex hull.

use super::{Hull, ROUNDING, Volume, line, slab};
use glam::DMat3;
use glam::DVec2;
use steradian_math::{DVec3, Vec3};

/// Faces of a hull that are tried at most; of larger hulls they are taken evenly.
const FACES: usize = 512;

/// A box in any direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Orthonormal axes.
    pub axes: [DVec3; 3],
    /// Along each axis from where to where.
    pub extent: [[f64; 2]; 3],
}

impl OrientedBox {
    /// Along the principal axes: the directions in which the points vary most and least (Gottschalk 2000). `None`
    /// without points, or where one is not finite.
    pub fn principal(points: &[Vec3]) -> Option<Self> {
        if points.is_empty() || points.iter().any(|p| !p.is_finite()) {
            return None;
        }
        // Mean and covariance matrix, scaled so that squares do not overflow.
        let n = points.len() as f64;
        let mean = points.iter().map(|p| p.as_dvec3() / n).sum::<DVec3>();
        let scale = points.iter().map(|p| (p.as_dvec3() - mean).abs().max_element()).fold(0.0, f64::max);
        let mut covariance = DMat3::ZERO;
        if scale > 0.0 {
            for p in points {
                let d = (p.as_dvec3() - mean) / scale;
                covariance += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            }
        }
        // The eigenvectors of the covariance matrix are the principal axes.
        Some(Self::along(eigenvectors(covariance), points.iter().map(|p| p.as_dvec3())))
    }

    /// The smallest of the boxes with a face in the plane of a face of the hull, each turned to the smallest rectangle
    /// about it. The smallest box of all need not be among them, but is rarely much smaller (O'Rourke 1985 finds it in
    /// cubic time).
    pub fn flush(hull: &Hull) -> Self {
        // For each face normal project the hull onto the face's plane and take the smallest rectangle there.
        let boxes = std::iter::once(DVec3::AXES).chain(hull.normals(FACES).map(|normal| {
            let u = normal.any_orthonormal_vector();
            let v = normal.cross(u);
            let shadow: Vec<DVec2> = hull.vertices().iter().map(|p| DVec2::new(u.dot(*p), v.dot(*p))).collect();
            let along = smallest_rectangle(shadow);
            let x = u * along.x + v * along.y;
            [x, normal.cross(x), normal]
        }));
        // Hull vertices lie on a lattice: grow the box by the lattice's error.
        let around = |axes| {
            let tight = Self::along(axes, hull.vertices().iter().copied());
            Self { extent: tight.extent.map(|[low, high]| [low - hull.error(), high + hull.error()]), ..tight }
        };
        let boxes = boxes.map(around);
        let smallest = boxes.min_by(|a, b| a.measure().total_cmp(&b.measure()));
        smallest.unwrap_or(Self { axes: DVec3::AXES, extent: [[0.0; 2]; 3] })
    }

    /// The volume; of flat boxes far less than that of any other, and less for smaller ones.
    fn measure(&self) -> f64 {
        let [a, b, c] = self.extent.map(|[low, high]| high - low);
        a * b * c + 1e-30 * (a * b + b * c + c * a)
    }

    /// Around points, along given axes.
    fn along(axes: [DVec3; 3], points: impl Iterator<Item = DVec3>) -> Self {
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for p in points {
            for (axis, [low, high]) in axes.iter().zip(&mut extent) {
                let x = axis.dot(p);
                (*low, *high) = (low.min(x), high.max(x));
            }
        }
        Self { axes, extent }
    }

    /// Half of the extents.
    fn half(&self) -> [f64; 3] {
        self.extent.map(|[low, high]| (high - low) * 0.5)
    }

    /// The middle.
    pub fn center(&self) -> DVec3 {
        let [x, y, z] = self.extent.map(|[low, high]| (high + low) * 0.5);
        self.axes[0] * x + self.axes[1] * y + self.axes[2] * z
    }
}

impl Volume for OrientedBox {
    fn contains(&self, p: DVec3) -> bool {
        let slack = 4.0 * ROUNDING * self.extent.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        self.axes
            .iter()
            .zip(&self.extent)
            .all(|(axis, [low, high])| (low - slack..=high + slack).contains(&axis.dot(p)))
    }

    fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let whole = line(origin, direction)?;
        let sides = self.axes.iter().zip(self.extent);
        sides.clone().try_fold(whole, |t, (axis, s)| slab(t, axis.dot(origin), axis.dot(direction), s))
    }

    /// By the fifteen axes that may separate two boxes (Gottschalk, Lin, Manocha 1996).
    fn overlaps(&self, other: &Self) -> bool {
        let (a, b) = (self.half(), other.half());
        let between = other.center() - self.center();
        let products = self.axes.iter().flat_map(|x| other.axes.iter().map(move |y| x.cross(*y)));
        let slack = ROUNDING * (self.center().abs().max(other.center().abs())).max_element();
        // Disjoint on an axis where the distance of the centres exceeds the sum of both projected radii.
        !self.axes.iter().chain(&other.axes).copied().chain(products).any(|axis| {
            let reach = |axes: &[DVec3; 3], half: [f64; 3]| -> f64 {
                axes.iter().zip(half).map(|(x, h)| axis.dot(*x).abs() * h).sum()
            };
            axis.dot(between).abs() > reach(&self.axes, a) + reach(&other.axes, b) + slack
        })
    }

    fn volume(&self) -> f64 {
        self.extent.iter().map(|[low, high]| high - low).product()
    }
}

/// Orthonormal eigenvectors of a symmetric matrix by Jacobi's rotations.
fn eigenvectors(matrix: DMat3) -> [DVec3; 3] {
    let (mut a, mut vectors) = (matrix, DMat3::IDENTITY);
    for _ in 0..32 {
        // Cyclic sweeps: each rotation annihilates one off-diagonal element.
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a.col(q)[p];
            if off.abs() <= 1e-300 {
                continue;
            }
            // cot 2φ = (a_qq − a_pp)/(2 a_pq); take the smaller root t = tan φ for stability (Numerical Recipes, 11.1).
            let theta = (a.col(q)[q] - a.col(p)[p]) / (2.0 * off);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = c;
            turn.col_mut(q)[q] = c;
            turn.col_mut(q)[p] = s;
            turn.col_mut(p)[q] = -s;
            a = turn.transpose() * a * turn;
            vectors *= turn;
        }
    }
    // Orthonormalise against the accumulated rounding.
    let x = vectors.x_axis.normalize_or(DVec3::X);
    let y = (vectors.y_axis - x * x.dot(vectors.y_axis)).normalize_or(x.any_orthonormal_vector());
    [x, y, x.cross(y)]
}

/// The direction of a side of the rectangle of least area around points: one of its sides lies along the hull.
fn smallest_rectangle(mut points: Vec<DVec2>) -> DVec2 {
    let hull = polygon(&mut points);
    let mut best = (f64::INFINITY, DVec2::X);
    // Rotating calipers by enumeration: one side of the optimal rectangle is collinear with a hull edge (Freeman and
    // Shapira 1975).
    for i in 0..hull.len() {
        let Some(x) = (hull[(i + 1) % hull.len()] - hull[i]).try_normalize() else { continue };
        let extent = |d: DVec2| {
            let heights = hull.iter().map(|p| d.dot(*p));
            let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], h| [a.min(h), b.max(h)]);
            high - low
        };
        let area = extent(x) * extent(x.perp());
        if area < best.0 {
            best = (area, x);
        }
    }
    best.1
}

/// The convex hull in the plane, counter-clockwise (Andrew's monotone chain, 1979).
pub(super) fn polygon(points: &mut Vec<DVec2>) -> Vec<DVec2> {
    // Sort lexicographically, build the lower chain from the left and the upper one from the right.
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points.clone();
    }
    let mut hull: Vec<DVec2> = Vec::new();
    for pass in 0..2 {
        let start = hull.len();
        // Pop while the last turn is not to the left.
        let mut add = |p: DVec2| {
            while hull.len() >= start + 2
                && (hull[hull.len() - 1] - hull[hull.len() - 2]).perp_dot(p - hull[hull.len() - 2]) <= 0.0
            {
                hull.pop();
            }
            hull.push(p);
        };
        if pass == 0 {
            points.iter().copied().for_each(&mut add);
        } else {
            points.iter().rev().copied().for_each(&mut add);
        }
        // The last point of a chain begins the next one.
        hull.pop();
    }
    hull
}
