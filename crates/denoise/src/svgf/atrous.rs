//! The edge-avoiding à-trous wavelet filter.

use steradian_accel::{Lanes, kernel};
use steradian_math::Vec3;

use super::{
    estimates::{BLUE, Estimates, GREEN, LUMINANCE, PLANES, RED, VARIANCE},
    geometry::{Geometry, Likeness},
    settings::Settings,
};
use crate::{
    falloff::falloff,
    kernel::{B3_SPLINE, GAUSSIAN},
    rows::{Column, Row, Rows, WIDTH},
};

/// Keeps the exponent of luminance finite where there is no variance.
const LEAST_DEVIATION: f32 = 1e-10;

/// Goes over all terms once, with gaps of 2^`iteration` pixels: equations 1, 2 and 5.
pub(super) fn filter(
    from: &Estimates,
    to: &mut Estimates,
    geometry: &Geometry,
    iteration: u32,
    (lanes, settings): (Lanes, &Settings),
) {
    use rayon::prelude::*;
    let pass = Pass { from: &from.rows, geometry, step: 1 << iteration, settings, luminance: from.luminance };
    to.rows.par_rows().for_each(|(y, mut row)| filter_row(lanes, &pass, y, &mut row));
}

/// A passage over the picture.
struct Pass<'a> {
    from: &'a Rows,
    geometry: &'a Geometry,
    step: i64,
    settings: &'a Settings,
    /// The weights of colours in luminance.
    luminance: Vec3,
}

kernel! {
    /// Filters a row: what surfaces say is the same for all terms.
    fn filter_row(pass: &'a Pass<'a>, y: usize, row: &'a mut Row<'a>) {
        // What depends on surfaces alone is computed once per block and shared by all terms.
        let (mut taps, mut near) = ([[Likeness::WHOLE; 5]; 5], [[[0.0; WIDTH]; 3]; 3]);
        for x in (0..pass.from.width()).step_by(WIDTH) {
            pass.compare([x, y], &mut taps);
            pass.find_near([x, y], &mut near);
            for term in 0..pass.from.planes() / PLANES {
                pass.filter_block(term * PLANES, [x, y], (&taps, &near), row);
            }
        }
    }
}

impl Pass<'_> {
    /// Likeness to the pixels beneath the filter, but for the middle, whose weight is whole.
    #[inline(always)]
    fn compare(&self, at: [usize; 2], taps: &mut [[Likeness; 5]; 5]) {
        for (j, taps) in taps.iter_mut().enumerate() {
            // Taps stand apart by the step: à-trous, with holes between them.
            let rows = (j as i64 - 2) * self.step;
            let Some(y) = self.from.row_at(at[1], rows) else { continue };
            for (i, tap) in taps.iter_mut().enumerate().filter(|(i, _)| [*i, j] != [2, 2]) {
                self.geometry.compare(at, y, [(i as i64 - 2) * self.step, rows], self.settings, tap);
            }
        }
    }

    /// The weights of the 3×3 pixels that variance is smoothed over, those of the object.
    #[inline(always)]
    fn find_near(&self, at: [usize; 2], near: &mut [[Column; 3]; 3]) {
        for (j, near) in near.iter_mut().enumerate() {
            let Some(y) = self.from.row_at(at[1], j as i64 - 1) else { continue };
            for (i, weights) in near.iter_mut().enumerate() {
                // 3×3 Gaussian within the object.
                self.geometry.is_same(at, y, i as i64 - 1, weights);
                weights.iter_mut().for_each(|weight| *weight *= GAUSSIAN[i] * GAUSSIAN[j]);
            }
        }
    }

    /// The planes of a term.
    #[inline(always)]
    fn planes(&self, term: usize, at: [usize; 2], columns: i64) -> [&Column; PLANES] {
        let plane = |plane| self.from.block(term + plane, at, columns);
        [plane(0), plane(1), plane(2), plane(3), plane(4)]
    }

    /// The inverse of by how much luminance may differ: of σ_l times the standard deviation. 0 where it has no say.
    #[inline(always)]
    fn sharpness(&self, term: usize, at: [usize; 2], near: &[[Column; 3]; 3]) -> Column {
        let sigma = self.settings.sigma_luminance;
        let (mut variance, mut weights, mut sharpness) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
        // An infinite σ_l leaves luminance without a say.
        if sigma == f32::INFINITY {
            return sharpness;
        }
        // Prefilter the variance, so that its own noise does not open the edge-stopping function.
        for (j, near) in near.iter().enumerate() {
            let Some(y) = self.from.row_at(at[1], j as i64 - 1) else { continue };
            let tap = |plane, i: usize| self.from.block(term + plane, [at[0], y], i as i64 - 1);
            let luminance = [tap(LUMINANCE, 0), tap(LUMINANCE, 1), tap(LUMINANCE, 2)];
            let variances = [tap(VARIANCE, 0), tap(VARIANCE, 1), tap(VARIANCE, 2)];
            for k in 0..WIDTH {
                for i in 0..3 {
                    let weight = if luminance[i][k].is_nan() { 0.0 } else { near[i][k] };
                    variance[k] += weight * variances[i][k];
                    weights[k] += weight;
                }
            }
        }
        let luminance = self.from.block(term + LUMINANCE, at, 0);
        // The denominator of w_l: σ_l √(g₃ₓ₃(Var)) + ε (equation 5).
        for k in 0..WIDTH {
            let deviation = sigma * (variance[k] / weights[k]).sqrt() + LEAST_DEVIATION;
            sharpness[k] = if luminance[k].is_nan() { 0.0 } else { 1.0 / deviation };
        }
        sharpness
    }

    /// Filters a block of a term.
    #[inline(always)]
    fn filter_block(
        &self,
        term: usize,
        at: [usize; 2],
        (taps, near): (&[[Likeness; 5]; 5], &[[Column; 3]; 3]),
        row: &mut Row<'_>,
    ) {
        // Pixels without a value take those of their neighbours whatever their luminance.
        let sharpness = self.sharpness(term, at, near);
        let middle = self.planes(term, at, 0);
        let mut luminance = [0.0; WIDTH];
        for k in 0..WIDTH {
            luminance[k] = if middle[LUMINANCE][k].is_nan() { 0.0 } else { middle[LUMINANCE][k] };
        }
        // Of colours and variance; that of weights stands where luminance will.
        let mut sums = [[0.0; WIDTH]; PLANES];
        for j in 0..5 {
            let Some(y) = self.from.row_at(at[1], (j as i64 - 2) * self.step) else { continue };
            let others = |i: i64| self.planes(term, [at[0], y], (i - 2) * self.step);
            let others = [others(0), others(1), others(2), others(3), others(4)];
            for k in 0..WIDTH {
                for i in 0..5 {
                    let (other, tap) = (&others[i], &taps[j][i]);
                    // w_l: the difference of luminance in units of the tolerance, added to the exponent of w_z.
                    let apart = (luminance[k] - other[LUMINANCE][k]).abs() * sharpness[k];
                    let weight = B3_SPLINE[i] * B3_SPLINE[j] * tap.factor[k] * falloff(tap.depth[k] + apart);
                    sums[RED][k] += weight * other[RED][k];
                    sums[GREEN][k] += weight * other[GREEN][k];
                    sums[BLUE][k] += weight * other[BLUE][k];
                    // Var' = Σ h² w² Var/(Σ h w)² (equation 2).
                    sums[VARIANCE][k] += weight * weight * other[VARIANCE][k];
                    sums[LUMINANCE][k] += weight;
                }
            }
        }
        // Normalise; what found no weight stays as it is.
        for k in 0..WIDTH {
            let weights = sums[LUMINANCE][k];
            let is_known = weights > 0.0;
            let mean = |plane: usize| if is_known { sums[plane][k] / weights } else { middle[plane][k] };
            let (red, green, blue, variance) = (mean(RED), mean(GREEN), mean(BLUE), mean(VARIANCE));
            let luminance = self.luminance.x * red + self.luminance.y * green + self.luminance.z * blue;
            (sums[RED][k], sums[GREEN][k], sums[BLUE][k]) = (red, green, blue);
            sums[LUMINANCE][k] = if is_known { luminance } else { f32::NAN };
            sums[VARIANCE][k] = if is_known { variance / weights } else { variance };
        }
        for (plane, values) in sums.iter().enumerate() {
            row.set_block(term + plane, at[0], values);
        }
    }
}
