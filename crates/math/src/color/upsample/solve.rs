//! The coefficients whose spectrum has a given colour: Gauss–Newton on the CIELAB difference (Jakob and Hanika 2019, section 4).
//!
//! The polynomial's variable is here `t = (λ − 360) / 470` in [0, 1]. The method's choices that decide the outcome where the problem
//! is ill-posed (very dark or saturated colours) are pbrt-v4's: quadrature on the 5-nm tables, at most 15 steps, coefficients
//! bounded by 200, stop at a squared difference of 1e-6. The Jacobian is exact, not by finite differences.

use crate::color::RgbSpace;
use crate::color::lab::{lab_from_xyz, lab_linear, lab_slope};
use crate::spectra::{Dense, cie::matching_linear};
use glam::{DMat3, DVec3};

/// Segments of 5 nm, each integrated by Simpson's 3/8 rule; sample count padded to whole groups of [`LANES`].
const SEGMENTS: usize = 94;
const SAMPLES: usize = 3 * SEGMENTS + 1;
const LANES: usize = 4;
const GROUPS: usize = SAMPLES.div_ceil(LANES);

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
        let mut groups = [Group::default(); GROUPS];
        let mut sum = DVec3::ZERO;
        for i in 0..SAMPLES {
            // Observer and white are linear over each segment.
            let at = |k: usize| {
                let lambda = 360.0 + 5.0 * k as f64;
                (DVec3::from(matching_linear(lambda)), f64::from(white.eval(lambda as f32)))
            };
            let (k, u) = ((i / 3).min(SEGMENTS - 1), i as f64 / 3.0);
            let ((c0, w0), (c1, w1)) = (at(k), at(k + 1));
            let f = u - k as f64;
            let rule = match i {
                0 => 1.0,
                _ if i == SAMPLES - 1 => 1.0,
                _ if i % 3 == 0 => 2.0,
                _ => 3.0,
            };
            let w = c0.lerp(c1, f) * (w0 * (1.0 - f) + w1 * f) * (rule * 3.0 / 8.0 * 5.0 / 3.0);
            sum += w;
            let g = &mut groups[i / LANES];
            g.t[i % LANES] = u / SEGMENTS as f64;
            for c in 0..3 {
                g.weight[c][i % LANES] = w[c];
            }
        }
        // Normalise: the perfect reflector has Y = 1.
        for g in &mut groups {
            g.weight.as_flattened_mut().iter_mut().for_each(|w| *w /= sum.y);
        }
        Self { groups, white: sum / sum.y, xyz_from_rgb: space.xyz_from_rgb() }
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

/// `m⁻¹ b` by Cramer's rule; `None` where the matrix is singular or anything is not finite.
fn solve3(m: DMat3, b: DVec3) -> Option<DVec3> {
    let [p, q, r] = [m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1))];
    let x = DVec3::new(p.dot(b), q.dot(b), r.dot(b)) / m.col(0).dot(p);
    x.is_finite().then_some(x)
}
