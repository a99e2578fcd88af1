//! Coefficients at the nodes of a grid over the RGB cube, interpolated between.
//!
//! The layout is Jakob and Hanika's: one cube per largest component, coordinates `z` = that component and `x`, `y` =
//! the other two over it, with the nodes of `z` crowded at both ends. The nodes of one `(x, y)` are solved as one
//! column, each starting from its neighbour's solution, when the column is first needed: nothing is spent on colours
//! that a scene does not have.

use super::RgbSigmoid;
use super::solve::Solver;
use crate::color::RgbSpace;
use crate::color::space::ACES2065_1;
use crate::spectra::{d65, named::aces_d60};
use glam::DVec3;
use std::sync::OnceLock;

/// Nodes per axis.
pub(super) const RES: usize = 64;
/// The node of a column at which its solving starts, from the grey of the polynomial zero.
const START: usize = RES / 5;

/// The coefficients of one `(x, y)` at all nodes of `z`.
type Column = [[f32; 3]; RES];

/// The coefficients of all colours of a space.
pub(super) struct Table {
    solver: Solver,
    z: [f32; RES],
    /// By largest component, `y`, `x`.
    columns: Box<[OnceLock<Box<Column>>]>,
}

impl Table {
    pub(super) fn new(space: &RgbSpace) -> Self {
        let white = if *space == ACES2065_1 { aces_d60() } else { d65() };
        let smooth = |x: f64| x * x * (3.0 - 2.0 * x);
        Self {
            solver: Solver::new(space, white),
            z: std::array::from_fn(|i| smooth(smooth(i as f64 / (RES - 1) as f64)) as f32),
            columns: std::iter::repeat_with(OnceLock::new).take(3 * RES * RES).collect(),
        }
    }

    /// The spectrum of `rgb`, in [0, 1] and not all equal.
    pub(super) fn lookup(&self, rgb: [f32; 3]) -> RgbSigmoid {
        let [r, g, b] = rgb;
        let largest = match (r > g, r > b, g > b) {
            (true, true, _) => 0,
            (false, _, true) => 1,
            _ => 2,
        };
        let z = rgb[largest];
        let scaled = |k: usize| rgb[(largest + k) % 3] * (RES - 1) as f32 / z;
        let (x, y) = (scaled(1), scaled(2));
        let (xi, yi) = ((x as usize).min(RES - 2), (y as usize).min(RES - 2));
        let zi = self.z.partition_point(|&n| n < z).saturating_sub(1).min(RES - 2);
        let (dx, dy) = (x - xi as f32, y - yi as f32);
        let dz = (z - self.z[zi]) / (self.z[zi + 1] - self.z[zi]);

        // Bilinear in (x, y) of the values that are linear in z.
        let mut c = [0.0; 3];
        for (oy, wy) in [(0, 1.0 - dy), (1, dy)] {
            for (ox, wx) in [(0, 1.0 - dx), (1, dx)] {
                let column = self.column(largest, yi + oy, xi + ox);
                for (k, c) in c.iter_mut().enumerate() {
                    *c += wx * wy * (column[zi][k] * (1.0 - dz) + column[zi + 1][k] * dz);
                }
            }
        }
        RgbSigmoid { c }
    }

    /// The spectrum of `rgb`, in [0, 1] and not all equal, solved for by itself from the grey of its mean; `None` where
    /// that does not come within ΔE 0.01, as of the very dark and saturated, whose columns have to be followed.
    pub(super) fn solve(&self, rgb: [f32; 3]) -> Option<RgbSigmoid> {
        let grey = RgbSigmoid::constant((rgb[0] + rgb[1] + rgb[2]) / 3.0);
        let mut c = DVec3::new(0.0, 0.0, f64::from(grey.c[2]));
        let rgb = glam::Vec3::from(rgb).as_dvec3();
        self.solver.solve(rgb, &mut c);
        (self.solver.error(rgb, c) < 0.01).then(|| RgbSigmoid { c: in_nanometres(c) })
    }

    fn column(&self, largest: usize, y: usize, x: usize) -> &Column {
        self.columns[(largest * RES + y) * RES + x].get_or_init(|| Box::new(self.solve_column(largest, y, x)))
    }

    /// Solves upwards from the start, then downwards from it.
    fn solve_column(&self, largest: usize, y: usize, x: usize) -> Column {
        let mut column = [[0.0; 3]; RES];
        let ratio = |i: usize| i as f64 / (RES - 1) as f64;
        let mut solve = |c: &mut DVec3, k: usize| {
            let z = f64::from(self.z[k]);
            let mut rgb = [z; 3];
            rgb[(largest + 1) % 3] = ratio(x) * z;
            rgb[(largest + 2) % 3] = ratio(y) * z;
            self.solver.solve(rgb.into(), c);
            column[k] = in_nanometres(*c);
        };
        let mut c = DVec3::ZERO;
        (START..RES).for_each(|k| solve(&mut c, k));
        c = DVec3::ZERO;
        (0..=START).rev().for_each(|k| solve(&mut c, k));
        column
    }
}

/// The polynomial of `t = (λ − 360) / 470` as one of λ in nm.
fn in_nanometres(c: DVec3) -> [f32; 3] {
    let (l0, s) = (360.0, 1.0 / 470.0);
    let (a, b) = (c.x * s * s, c.y * s);
    [a as f32, (b - 2.0 * a * l0) as f32, (c.z - b * l0 + a * l0 * l0) as f32]
}
