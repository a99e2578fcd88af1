//! The coefficients whose spectrum has a given colour: Gauss–Newton on the CIELAB difference (Jakob and Hanika 2019,
//! section 4).
//!
//! The polynomial's variable is here `t = (λ − 360) / 470` in [0, 1]. The method's choices that decide the outcome
//! where the problem is ill-posed (very dark or saturated colours) are pbrt-v4's: quadrature on the 5-nm tables, at
//! most 15 steps, coefficients bounded by 200, stop at a squared difference of 1e-6. The Jacobian is exact, not by
//! finite differences.

use crate::color::RgbSpace;
use crate::color::lab::{lab_from_xyz, lab_linear, lab_slope};
use crate::spectra::{Dense, cie::matching_linear};
use glam::{DMat3, DVec3};

/// The quadrature's nodes: every 5 nm, padded to whole groups of [`LANES`].
const NODES: usize = 95;
const LANES: usize = 4;
const GROUPS: usize = NODES.div_ceil(LANES);

/// Turns polynomials into colours under the white of a space.
pub(super) struct Solver {
    groups: [Group; GROUPS],
    white: DVec3,
    xyz_from_rgb: DMat3,
}

/// Four neighbouring samples of the quadrature.
#[derive(Clone, Copy, Default)]
struct Group {
    t: [f64; LANES],
    /// White times matching function times quadrature weight, for X, Y and Z.
    weight: [[f64; LANES]; 3],
}

impl Solver {
    /// For the colours of `space` under its `white`, which is read at multiples of 5 nm.
    pub(super) fn new(space: &RgbSpace, white: &Dense) -> Self {
        let weights = weights(white);
        let white: DVec3 = weights.iter().sum();
        let mut groups = [Group::default(); GROUPS];
        for (i, w) in weights.into_iter().enumerate() {
            let (g, lane) = (&mut groups[i / LANES], i % LANES);
            g.t[lane] = i as f64 / (NODES - 1) as f64;
            for c in 0..3 {
                // The perfect reflector has Y = 1.
                g.weight[c][lane] = w[c] / white.y;
            }
        }
        Self { groups, white: white / white.y, xyz_from_rgb: space.xyz_from_rgb() }
    }

    /// Improves the coefficients `(t², t, 1)` of the polynomial until its colour is that of `rgb`.
    pub(super) fn solve(&self, rgb: DVec3, c: &mut DVec3) {
        let target = lab_from_xyz(self.xyz_from_rgb * rgb, self.white);
        for _ in 0..15 {
            let (xyz, d_xyz) = self.color(*c);
            let residual = target - lab_from_xyz(xyz, self.white);
            let slope = lab_slope(xyz, self.white);
            let column = |k: usize| lab_linear(slope * d_xyz.col(k));
            let Some(step) = solve3(DMat3::from_cols(column(0), column(1), column(2)), residual) else {
                return;
            };
            *c += step;
            let max = c.max_element();
            if max > 200.0 {
                *c *= 200.0 / max;
            }
            if residual.length_squared() < 1e-6 {
                return;
            }
        }
    }

    /// ΔE (1976) between `rgb` and the colour of a polynomial; NaN or infinite where that has none.
    pub(super) fn error(&self, rgb: DVec3, c: DVec3) -> f64 {
        (lab_from_xyz(self.xyz_from_rgb * rgb, self.white) - lab_from_xyz(self.color(c).0, self.white)).length()
    }

    /// XYZ of the sigmoid spectrum, and its derivative by each coefficient (columns).
    fn color(&self, c: DVec3) -> (DVec3, DMat3) {
        // Per lane: the integrals of weight × {S, S' t², S' t, S'} for X, Y and Z.
        let mut sum = [[[0.0; LANES]; 4]; 3];
        for g in &self.groups {
            let x = g.t.map(|t| (c.x * t + c.y) * t + c.z);
            let r = x.map(|x| 1.0 / (1.0 + x * x).sqrt());
            let slope = r.map(|r| 0.5 * r * r * r);
            let lanes =
                |f: fn(f64, f64) -> f64, a: [f64; LANES], b: [f64; LANES]| std::array::from_fn(|i| f(a[i], b[i]));
            let slope_t = lanes(|s, t| s * t, slope, g.t);
            let f = [lanes(|x, r| 0.5 + 0.5 * x * r, x, r), lanes(|s, t| s * t, slope_t, g.t), slope_t, slope];
            for (sum, weight) in sum.iter_mut().zip(&g.weight) {
                for (sum, f) in sum.iter_mut().zip(&f) {
                    for i in 0..LANES {
                        sum[i] += weight[i] * f[i];
                    }
                }
            }
        }
        let total = |k: usize| DVec3::from_array(sum.map(|s| s[k].iter().sum()));
        (total(0), DMat3::from_cols(total(1), total(2), total(3)))
    }
}

/// Contribution of a reflectance's value at each node to XYZ. Observer and white are linear over each 5-nm segment and
/// their product is integrated by Simpson's 3/8 rule, at whose inner points the reflectance is interpolated between the
/// nodes by cubics.
fn weights(white: &Dense) -> [DVec3; NODES] {
    let at = |k: usize| {
        let lambda = 360.0 + 5.0 * k as f64;
        (DVec3::from(matching_linear(lambda)), f64::from(white.eval(lambda as f32)))
    };
    let mut weights = [DVec3::ZERO; NODES];
    for k in 0..NODES - 1 {
        let ((c0, w0), (c1, w1)) = (at(k), at(k + 1));
        let first = k.saturating_sub(1).min(NODES - 4);
        for (i, rule) in [1.0, 3.0, 3.0, 1.0].into_iter().enumerate() {
            let f = i as f64 / 3.0;
            let w = c0.lerp(c1, f) * (w0 * (1.0 - f) + w1 * f) * (rule * 5.0 / 8.0);
            for (n, l) in lagrange((k - first) as f64 + f).into_iter().enumerate() {
                weights[first + n] += w * l;
            }
        }
    }
    weights
}

/// The weights of the values at 0, 1, 2 and 3 in the cubic through them at `x`.
fn lagrange(x: f64) -> [f64; 4] {
    std::array::from_fn(|i| (0..4).filter(|&j| j != i).map(|j| (x - j as f64) / (i as f64 - j as f64)).product())
}

/// `m⁻¹ b` by Cramer's rule; `None` where the matrix is singular or anything is not finite.
fn solve3(m: DMat3, b: DVec3) -> Option<DVec3> {
    let [p, q, r] = [m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1))];
    let x = DVec3::new(p.dot(b), q.dot(b), r.dot(b)) / m.col(0).dot(p);
    x.is_finite().then_some(x)
}
