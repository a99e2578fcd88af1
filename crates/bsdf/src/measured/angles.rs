//! Tables of angles: text with one measured pair of directions per line, as goniophotometers write them.
//!
//! Columns are `theta_i phi_i theta_o phi_o` in degrees, then `f` in sr⁻¹: one number, or three for red, green and
//! blue; separated by blanks, commas or semicolons. Lines that begin with `#` or a letter are passed over (the header
//! of ASTM E2387 files is such). The rows must fill a grid: every incident angle with every azimuth and every outgoing
//! pair, in any order. With one incident azimuth the material is isotropic and only the difference of azimuths counts;
//! differences within [0°, 180°] are mirrored.

use super::{MeasuredError, polarimetric::neighbours};
use std::{f32::consts::PI, fmt::Write};
use steradian_math::{Vec3, elementary::atan2};

/// Most rows that are read.
const MAX_ROWS: usize = 1 << 22;

/// A table.
#[derive(Clone, Debug)]
pub struct AngleTable {
    /// Incident angle, incident azimuth, outgoing angle, outgoing azimuth (or the difference of azimuths), degrees,
    /// increasing.
    axes: [Vec<f32>; 4],
    isotropic: bool,
    /// True if only half of the circle of differences was measured.
    mirrored: bool,
    values: Vec<Vec3>,
}

/// A value as a key that sorts; angles closer than a thousandth of a degree are one.
fn key(angle: f32) -> i64 {
    (f64::from(angle) * 1e3).round() as i64
}

impl AngleTable {
    /// From the text of a file.
    ///
    /// # Errors
    /// The first line that cannot be understood, or what the grid lacks.
    pub fn read(text: &str) -> Result<Self, MeasuredError> {
        let mut rows: Vec<([f32; 4], Vec3)> = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with(|c: char| c == '#' || c.is_alphabetic()) {
                continue;
            }
            let fault = |what: &str| MeasuredError::Fault(format!("line {}: {what}", number + 1));
            // Cut the row at blanks, commas and semicolons; anything but numbers is an error.
            let cells = line.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|c| !c.is_empty());
            let numbers: Result<Vec<f32>, _> = cells.take(8).map(str::parse).collect();
            let numbers = numbers.map_err(|_| fault("not a row of numbers"))?;
            if numbers.iter().any(|v| !v.is_finite()) {
                return Err(fault("a number is not finite"));
            }
            // Four angles, then one value or a colour.
            let (angles, value) = match numbers[..] {
                [a, b, c, d, v] => ([a, b, c, d], Vec3::splat(v)),
                [a, b, c, d, red, green, blue] => ([a, b, c, d], Vec3::new(red, green, blue)),
                _ => return Err(fault("a row has four angles, then one value or three")),
            };
            if !(0.0..=90.0).contains(&angles[0]) || !(0.0..=90.0).contains(&angles[2]) {
                return Err(fault("angles from the normal lie within 0 and 90 degrees"));
            }
            if rows.len() >= MAX_ROWS {
                return Err(fault("too many rows"));
            }
            rows.push((angles, value.clamp(Vec3::ZERO, Vec3::splat(1e30))));
        }
        Self::new(rows)
    }

    fn new(mut rows: Vec<([f32; 4], Vec3)>) -> Result<Self, MeasuredError> {
        let Some(first) = rows.first() else { return Err(MeasuredError::Fault("it has no rows".into())) };
        let first_azimuth = key(first.0[1]);
        // One incident azimuth means an isotropic material: only the difference of azimuths counts.
        let isotropic = rows.iter().all(|r| key(r.0[1]) == first_azimuth);
        for (angles, _) in &mut rows {
            let phi = if isotropic { angles[3] - angles[1] } else { angles[3] };
            angles[3] = phi.rem_euclid(360.0);
            angles[1] = if isotropic { 0.0 } else { angles[1].rem_euclid(360.0) };
        }
        // Collect the distinct angles along each axis of the grid.
        let axes: [Vec<f32>; 4] = std::array::from_fn(|i| {
            let mut axis: Vec<f32> = rows.iter().map(|r| r.0[i]).collect();
            axis.sort_by(f32::total_cmp);
            axis.dedup_by_key(|a| key(*a));
            axis
        });
        // The rows must fill the grid, each place once.
        let cells = axes.iter().try_fold(1usize, |n, a| n.checked_mul(a.len()));
        if cells != Some(rows.len()) {
            let sizes = axes.iter().map(|a| a.len().to_string()).collect::<Vec<_>>().join(" × ");
            return Err(MeasuredError::Fault(format!(
                "its {} rows do not fill the grid of {sizes} angles",
                rows.len()
            )));
        }
        let mut values = vec![None; rows.len()];
        for (angles, value) in rows {
            // Flat index of the row, with the last axis fastest.
            let index = (0..4).fold(0, |n, i| {
                n * axes[i].len() + axes[i].partition_point(|a| key(*a) < key(angles[i])).min(axes[i].len() - 1)
            });
            if values[index].replace(value).is_some() {
                return Err(MeasuredError::Fault(format!("the angles {angles:?} occur twice")));
            }
        }
        // Differences up to half a circle are completed by mirror symmetry.
        let mirrored = isotropic && axes[3].last().is_some_and(|a| *a <= 180.0);
        Ok(Self { axes, isotropic, mirrored, values: values.into_iter().map(Option::unwrap_or_default).collect() })
    }

    /// `f` (sr⁻¹) in linear RGB for light from `wi` seen from `wo`, both above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        // Spherical angles of both directions, by the arc tangent that keeps digits near the normal.
        let theta = |w: Vec3| atan2((w.x * w.x + w.y * w.y).sqrt(), w.z).to_degrees();
        let phi = |w: Vec3| atan2(w.y, w.x);
        let mut azimuth = phi(wo) - if self.isotropic { phi(wi) } else { 0.0 };
        // Fold the difference into [0, π].
        if self.mirrored {
            azimuth = (azimuth + PI).rem_euclid(2.0 * PI) - PI;
            azimuth = azimuth.abs();
        }
        // Neighbours along each of the four axes; azimuths wrap around where the circle is whole.
        let places = [
            neighbours(&self.axes[0], theta(wi)),
            around(&self.axes[1], phi(wi).to_degrees()),
            neighbours(&self.axes[2], theta(wo)),
            if self.mirrored {
                neighbours(&self.axes[3], azimuth.to_degrees())
            } else {
                around(&self.axes[3], azimuth.to_degrees())
            },
        ];
        // Quadrilinear interpolation over the 16 corners of the cell.
        let mut value = Vec3::ZERO;
        for corner in 0..16 {
            let (mut weight, mut index) = (1.0, 0);
            for (i, (low, high, f)) in places.iter().enumerate() {
                let upper = corner >> i & 1 == 1;
                weight *= if upper { *f } else { 1.0 - f };
                index = index * self.axes[i].len() + if upper { *high } else { *low };
            }
            if weight > 0.0 {
                value += weight * self.values[index];
            }
        }
        value
    }
}

/// Neighbours on a circle of 360 degrees.
fn around(axis: &[f32], x: f32) -> (usize, usize, f32) {
    let n = axis.len();
    if n < 2 {
        return (0, 0, 0.0);
    }
    let x = x.rem_euclid(360.0);
    if x >= axis[0] && x < axis[n - 1] {
        return neighbours(axis, x);
    }
    // Beyond the last angle interpolate across the gap to the first of the next turn.
    let gap = axis[0] + 360.0 - axis[n - 1];
    let past = if x < axis[0] { x + 360.0 } else { x } - axis[n - 1];
    (n - 1, 0, (past / gap).clamp(0.0, 1.0))
}

/// The text of a table of `f(theta_i, phi_i, theta_o, phi_o)`, in steps of angle and azimuth, for some incident
/// azimuths; degrees.
pub fn write(steps: [f64; 2], azimuths: &[f64], f: impl Fn(f64, f64, f64, f64) -> f64) -> String {
    let mut out = String::from("# f in 1/sr, angles in degrees\nVARS theta_i,phi_i,theta_s,phi_s,BRDF\n");
    let angles = || (0..).map(|i| f64::from(i) * steps[0]).take_while(|a| *a <= 90.0);
    for ti in angles() {
        for pi in azimuths {
            for to in angles() {
                for po in (0..).map(|i| f64::from(i) * steps[1]).take_while(|a| *a < 360.0) {
                    let _ = writeln!(out, "{ti}, {pi}, {to}, {po}, {}", f(ti, *pi, to, po));
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tabulated_model_comes_back() {
        let f = |ti: f64, _: f64, to: f64, po: f64| 0.1 + 0.001 * ti + 0.0005 * to + 0.05 * po.to_radians().cos();
        let t = AngleTable::read(&write([10.0, 15.0], &[0.0], f)).expect("sound");
        for (ti, to, po) in [(12.0, 35.0, 20.0), (60.0, 5.0, 200.0), (88.0, 89.0, 352.0), (0.0, 0.0, 0.0f64)] {
            let w = |theta: f64, phi: f64| {
                let ((s, c), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
                Vec3::new((s * x) as f32, (s * y) as f32, c as f32)
            };
            // Any common rotation: the table is isotropic.
            let found = t.eval(w(to, po + 77.0), w(ti, 77.0)).x;
            let expected = f(ti, 0.0, to, po);
            let azimuth_matters = ti * to > 0.0;
            assert!(
                !azimuth_matters || (f64::from(found) - expected).abs() < 1e-3,
                "{ti} {to} {po}: {found} {expected}"
            );
        }
    }

    #[test]
    fn hostile_tables_are_refused() {
        for (bad, said) in [
            ("", "no rows"),
            ("0 0 0", "line 1: a row has four angles"),
            ("0 0 0 0 0.1 0.2", "four angles"),
            ("0 0 95 0 0.1", "within 0 and 90"),
            ("0 0 0 0 nan", "not finite"),
            ("0 0 0 0 0.1\n0 0 10 0 zero", "line 2: not a row"),
            ("0 0 0 0 0.1\n0 0 0 0 0.2", "do not fill"),
            ("0 0 0 0 0.1\n10 0 10 0 0.2", "do not fill"),
            ("0 0 0 0 0.1\n0 0 10 0 0.1\n10 0 0 0 0.1\n0 0 0.0001 0 0.2", "occur twice"),
        ] {
            let e = AngleTable::read(bad).err().map(|e| e.to_string()).unwrap_or_default();
            assert!(e.contains(said), "{bad:?}: {e:?}");
        }
    }
}
