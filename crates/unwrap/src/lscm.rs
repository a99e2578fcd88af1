//! Least-squares conformal maps (Lévy, Petitjean, Ray and Maillot, "Least Squares Conformal Maps for Automatic Texture
//! Atlas Generation", 2002).
//!
//! Points of the plane are complex numbers. A map of a triangle with corners z₁ z₂ z₃ in its own plane to U₁ U₂ U₃ is
//! conformal if (z₃ − z₂) U₁ + (z₁ − z₃) U₂ + (z₂ − z₁) U₃ = 0. The sum over the triangles of the squares of these, each
//! divided by twice the area, is to be least, with two vertices held in place. The normal equations are Hermitian and
//! positive definite; conjugate gradients with their diagonal as preconditioner solve them without a matrix.

use crate::chart::Chart;
use steradian_math::DVec2;

/// Gradient, in its preconditioned norm relative to the area, at which a solution is taken.
const TOLERANCE: f64 = 1e-13;

fn product(a: DVec2, b: DVec2) -> DVec2 {
    DVec2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

fn conjugate(a: DVec2) -> DVec2 {
    DVec2::new(a.x, -a.y)
}

/// Coefficients of a chart's equations, three for each triangle.
struct Equations<'a> {
    chart: &'a Chart,
    weights: Vec<[DVec2; 3]>,
    held: [u32; 2],
}

impl<'a> Equations<'a> {
    fn new(chart: &'a Chart, held: [u32; 2]) -> Self {
        let weights = chart.corners.iter().map(|corners| {
            let [a, b, c] = corners.map(|i| chart.positions[i as usize]);
            let (ab, ac) = (b - a, c - a);
            let base = ab.length();
            let height = ab.cross(ac).length() / base;
            let (second, third) = (DVec2::new(base, 0.0), DVec2::new(ab.dot(ac) / base, height));
            [third - second, -third, second].map(|w| w / (base * height).sqrt())
        });
        Self { chart, weights: weights.collect(), held }
    }

    /// The matrix of the normal equations times a vector, without the rows of the vertices that are held.
    fn times(&self, x: &[DVec2], out: &mut [DVec2]) {
        out.fill(DVec2::ZERO);
        for (corners, weights) in self.chart.corners.iter().zip(&self.weights) {
            let at = corners.map(|i| i as usize);
            let residual =
                product(weights[0], x[at[0]]) + product(weights[1], x[at[1]]) + product(weights[2], x[at[2]]);
            for (i, w) in at.into_iter().zip(weights) {
                out[i] += product(conjugate(*w), residual);
            }
        }
        self.held.iter().for_each(|i| out[*i as usize] = DVec2::ZERO);
    }

    /// Inverse of the matrix's diagonal.
    fn preconditioner(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.chart.positions.len()];
        for (corners, weights) in self.chart.corners.iter().zip(&self.weights) {
            for (i, w) in corners.iter().zip(weights) {
                diagonal[*i as usize] += w.length_squared();
            }
        }
        diagonal.iter().map(|d| if *d > 0.0 { 1.0 / d } else { 0.0 }).collect()
    }
}

/// Improves a map of a chart's vertices until it is as conformal as can be; two vertices stay.
pub fn solve(chart: &Chart, held: [u32; 2], mut x: Vec<DVec2>) -> Vec<DVec2> {
    let equations = Equations::new(chart, held);
    let inverse = equations.preconditioner();
    let (mut image, mut step) = (vec![DVec2::ZERO; x.len()], vec![DVec2::ZERO; x.len()]);
    equations.times(&x, &mut image);
    let mut gradient: Vec<DVec2> = image.iter().map(|v| -*v).collect();
    let norm = |g: &[DVec2]| g.iter().zip(&inverse).map(|(g, d)| g.length_squared() * d).sum::<f64>();
    let mut size = norm(&gradient);
    let enough = TOLERANCE * chart.area;
    let most = 100 + 20 * (x.len() as f64).sqrt() as usize;
    let mut turn = 0.0;
    for _ in 0..most {
        if size <= enough || !size.is_finite() {
            break;
        }
        for ((s, g), d) in step.iter_mut().zip(&gradient).zip(&inverse) {
            *s = *g * *d + *s * turn;
        }
        equations.times(&step, &mut image);
        let curvature: f64 = step.iter().zip(&image).map(|(s, i)| s.dot(*i)).sum();
        let length = size / curvature;
        for ((x, g), (s, i)) in x.iter_mut().zip(&mut gradient).zip(step.iter().zip(&image)) {
            *x += *s * length;
            *g -= *i * length;
        }
        let before = size;
        size = norm(&gradient);
        turn = size / before;
    }
    x
}
