//! Bilinear interpolants over the unit square that themselves depend linearly on further parameters, with exact
//! sampling and its inverse (Dupuy and Jakob 2018, supplement; the same object is pbrt-v4's `PiecewiseLinear2D`).
//!
//! A slice is a grid of `ny × nx` values (x fastest) at the corners of patches. Within a slice x and y are sampled by
//! inverting the integral of the linear interpolant; between slices values and integrals are interpolated, which
//! commutes with integration.

use super::MeasuredError;

/// A family of bilinear functions over `[0, 1]²` with up to `N` parameters.
#[derive(Clone, Debug)]
pub struct Interpolant<const N: usize> {
    nx: usize,
    ny: usize,
    /// The parameter values along each axis.
    axes: [Vec<f32>; N],
    /// Distance of neighbouring slices along each axis, in slices.
    strides: [usize; N],
    data: Vec<f32>,
    /// Integrals along x up to each grid point, in units of patches; empty where nothing is sampled.
    rows: Vec<f32>,
    /// Integrals over all x up to each row.
    columns: Vec<f32>,
}

/// Slices that a lookup mixes, with their weights.
#[derive(Clone, Copy, Debug)]
pub struct Mixture {
    slices: [(usize, f32); 8],
    count: usize,
}

impl<const N: usize> Interpolant<N> {
    /// From values in `[parameters…][y][x]`. Where it is to be `sampled`, each slice is scaled to integrate to one.
    ///
    /// # Errors
    /// Where the sizes do not fit, the grid is less than 2 × 2, or a slice to be sampled has negative values or none
    /// above zero.
    pub fn new(
        name: &str,
        mut data: Vec<f32>,
        [ny, nx]: [usize; 2],
        axes: [Vec<f32>; N],
        sampled: bool,
    ) -> Result<Self, MeasuredError> {
        assert!(N <= 3);
        let slices: usize = axes.iter().map(Vec::len).product();
        let size = nx.checked_mul(ny).and_then(|n| n.checked_mul(slices));
        if nx < 2 || ny < 2 || size != Some(data.len()) {
            return Err(MeasuredError::Fault(format!("the sizes of '{name}' do not fit together")));
        }
        // Strides of the slices along each parameter, the last fastest.
        let mut strides = [0; N];
        let mut stride = 1;
        for i in (0..N).rev() {
            strides[i] = stride;
            stride *= axes[i].len();
        }
        let (mut rows, mut columns) = (Vec::new(), Vec::new());
        for slice in data.chunks_exact_mut(nx * ny).filter(|_| sampled) {
            if slice.iter().any(|v| *v < 0.0) {
                return Err(MeasuredError::Fault(format!("'{name}' has negative values")));
            }
            let mut total = 0.0;
            let mut above = 0.0;
            // Integrate each row along x by trapezoids, which is exact for linear interpolants.
            let integrals: Vec<Vec<f64>> = slice
                .chunks_exact(nx)
                .map(|row| {
                    let mut sum = 0.0;
                    let steps = row.windows(2).map(|w| 0.5 * (f64::from(w[0]) + f64::from(w[1])));
                    std::iter::once(0.0)
                        .chain(steps.map(|s| {
                            sum += s;
                            sum
                        }))
                        .collect()
                })
                .collect();
            // Integrate the rows' totals along y to the marginal distribution.
            let mut marginal = vec![0.0];
            for (y, row) in integrals.iter().enumerate() {
                let end = row[nx - 1];
                if y > 0 {
                    total += 0.5 * (above + end);
                    marginal.push(total);
                }
                above = end;
            }
            if total <= 0.0 {
                return Err(MeasuredError::Fault(format!("a part of '{name}' is zero everywhere")));
            }
            // Scale values and integrals so that the slice integrates to one.
            slice.iter_mut().for_each(|v| *v = (f64::from(*v) / total) as f32);
            rows.extend(integrals.iter().flatten().map(|v| (v / total) as f32));
            columns.extend(marginal.iter().map(|v| (v / total) as f32));
        }
        Ok(Self { nx, ny, axes, strides, data, rows, columns })
    }

    /// The slices for values of the parameters, which are held inside the axes.
    #[inline]
    pub fn at(&self, parameters: [f32; N]) -> Mixture {
        let mut m = Mixture { slices: [(0, 1.0); 8], count: 1 };
        for ((axis, stride), x) in self.axes.iter().zip(self.strides).zip(parameters) {
            if axis.len() < 2 {
                continue;
            }
            // The interval of the parameter, and the place within it.
            let j = axis.partition_point(|a| *a <= x).clamp(1, axis.len() - 1) - 1;
            let w = ((x - axis[j]) / (axis[j + 1] - axis[j])).clamp(0.0, 1.0);
            // Each parameter doubles the slices that are mixed.
            for k in 0..m.count {
                let (slice, weight) = m.slices[k];
                let low = slice + j * stride;
                m.slices[k] = (low, weight * (1.0 - w));
                m.slices[m.count + k] = (low + stride, weight * w);
            }
            m.count *= 2;
        }
        m
    }

    #[inline]
    fn mix(&self, m: &Mixture, table: &[f32], size: usize, offset: usize) -> f32 {
        // Values and integrals mix by the same weights, since integration is linear.
        m.slices[..m.count].iter().map(|(s, w)| w * table[s * size + offset]).sum()
    }

    #[inline]
    fn value(&self, m: &Mixture, x: usize, y: usize) -> f32 {
        self.mix(m, &self.data, self.nx * self.ny, y * self.nx + x)
    }

    #[inline]
    fn row(&self, m: &Mixture, x: usize, y: usize) -> f32 {
        self.mix(m, &self.rows, self.nx * self.ny, y * self.nx + x)
    }

    #[inline]
    fn column(&self, m: &Mixture, y: usize) -> f32 {
        self.mix(m, &self.columns, self.ny, y)
    }

    /// The patch of a point and the place in it.
    #[inline]
    fn patch(&self, [u, v]: [f32; 2]) -> (usize, usize, f32, f32) {
        // Grid points lie at the corners of patches.
        let (sx, sy) = (u.clamp(0.0, 1.0) * (self.nx - 1) as f32, v.clamp(0.0, 1.0) * (self.ny - 1) as f32);
        let (x, y) = ((sx as usize).min(self.nx - 2), (sy as usize).min(self.ny - 2));
        (x, y, sx - x as f32, sy - y as f32)
    }

    #[inline]
    fn patches(&self) -> f32 {
        ((self.nx - 1) * (self.ny - 1)) as f32
    }

    /// The function as it was given: not for what is sampled.
    #[inline]
    pub fn eval(&self, p: [f32; 2], m: &Mixture) -> f32 {
        // Bilinear interpolation in the mixed slice.
        let (x, y, fx, fy) = self.patch(p);
        let below = lerp(fx, self.value(m, x, y), self.value(m, x + 1, y));
        let above = lerp(fx, self.value(m, x, y + 1), self.value(m, x + 1, y + 1));
        lerp(fy, below, above)
    }

    /// The density of [`Interpolant::sample`].
    #[inline]
    pub fn pdf(&self, p: [f32; 2], m: &Mixture) -> f32 {
        self.eval(p, m) * self.patches()
    }

    /// A point distributed as the function, and its density.
    pub fn sample(&self, [u, v]: [f32; 2], m: &Mixture) -> ([f32; 2], f32) {
        // Sample y by the marginal: find the row whose integral passes v, then invert the linear density within.
        let v = v.clamp(0.0, 1.0 - f32::EPSILON) * self.column(m, self.ny - 1);
        let y = last_not_above(self.ny - 1, |y| self.column(m, y) <= v);
        let (r0, r1) = (self.row(m, self.nx - 1, y), self.row(m, self.nx - 1, y + 1));
        let fy = inverse_linear(v - self.column(m, y), r0, r1);
        // Sample x by the conditional distribution at that height, likewise.
        let u = u.clamp(0.0, 1.0 - f32::EPSILON) * lerp(fy, r0, r1);
        let along = |x| lerp(fy, self.row(m, x, y), self.row(m, x, y + 1));
        let x = last_not_above(self.nx - 1, |x| along(x) <= u);
        let [c0, c1] = [x, x + 1].map(|x| lerp(fy, self.value(m, x, y), self.value(m, x, y + 1)));
        let fx = inverse_linear(u - along(x), c0, c1);
        let p = [(x as f32 + fx) / (self.nx - 1) as f32, (y as f32 + fy) / (self.ny - 1) as f32];
        (p, lerp(fx, c0, c1) * self.patches())
    }

    /// The random numbers that [`Interpolant::sample`] maps to a point, and the density there.
    pub fn invert(&self, p: [f32; 2], m: &Mixture) -> ([f32; 2], f32) {
        let (x, y, fx, fy) = self.patch(p);
        // Integrate the linear densities from the patch's corner to the point: the inverse of sampling.
        let [c0, c1] = [x, x + 1].map(|x| lerp(fy, self.value(m, x, y), self.value(m, x, y + 1)));
        let (r0, r1) = (self.row(m, self.nx - 1, y), self.row(m, self.nx - 1, y + 1));
        let before = lerp(fy, self.row(m, x, y), self.row(m, x, y + 1));
        let total = lerp(fy, r0, r1);
        let u = if total > 0.0 { (before + fx * (c0 + 0.5 * fx * (c1 - c0))) / total } else { fx };
        let v = (self.column(m, y) + fy * (r0 + 0.5 * fy * (r1 - r0))) / self.column(m, self.ny - 1);
        ([u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)], lerp(fx, c0, c1) * self.patches())
    }
}

#[inline]
fn lerp(t: f32, a: f32, b: f32) -> f32 {
    (1.0 - t) * a + t * b
}

/// The largest index below `n` for which a condition that holds from zero on still holds.
#[inline]
fn last_not_above(n: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, n);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// The `t` in [0, 1] at which the integral of the line from `a` to `b` is `area`.
#[inline]
fn inverse_linear(area: f32, a: f32, b: f32) -> f32 {
    // The stable root: never a difference of nearly equal numbers in the denominator.
    let root = (a * a + 2.0 * area * (b - a)).max(0.0).sqrt();
    let sum = a + root;
    if sum > 0.0 { (2.0 * area / sum).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn bumpy() -> Interpolant<2> {
        let mut rng = HashRng::new(3);
        let data = (0..2 * 3 * 4 * 5).map(|i| if i % 7 == 0 { 0.0 } else { rng.next_f32() }).collect();
        Interpolant::new("x", data, [4, 5], [vec![0.0, 1.0], vec![0.0, 0.5, 2.0]], true).expect("sound")
    }

    #[test]
    fn sampling_and_its_inverse_agree() {
        let f = bumpy();
        let mut rng = HashRng::new(5);
        for _ in 0..2000 {
            let m = f.at([rng.next_f32() * 1.4 - 0.2, rng.next_f32() * 2.4 - 0.2]);
            let u = [rng.next_f32(), rng.next_f32()];
            let (p, pdf) = f.sample(u, &m);
            let (back, pdf_back) = f.invert(p, &m);
            assert!((pdf - pdf_back).abs() < 1e-3 * pdf.max(1.0) && (pdf - f.pdf(p, &m)).abs() < 1e-3 * pdf.max(1.0));
            // Where the density is small, points are far apart for their numbers.
            assert!((0..2).all(|i| (back[i] - u[i]).abs() < 1e-4), "{u:?} → {p:?} → {back:?}");
        }
    }

    #[test]
    fn the_density_integrates_to_one_for_every_parameter() {
        let f = bumpy();
        for parameters in [[0.0, 0.0], [0.3, 0.2], [1.0, 2.0], [0.5, 5.0]] {
            let m = f.at(parameters);
            let n = 400;
            let sum: f64 = (0..n * n)
                .map(|i| [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32))
                .map(|p| f64::from(f.pdf(p, &m)))
                .sum();
            assert!((sum / (n * n) as f64 - 1.0).abs() < 1e-4, "{parameters:?}: {sum}");
        }
    }

    #[test]
    fn what_cannot_be_sampled_is_refused() {
        let new = |data: Vec<f32>, size, axis| Interpolant::new("x", data, size, [axis], true);
        assert!(new(vec![1.0; 4], [2, 2], vec![0.0]).is_ok());
        assert!(new(vec![0.0; 4], [2, 2], vec![0.0]).is_err(), "nothing to sample");
        assert!(new(vec![1.0, 1.0, -1.0, 1.0], [2, 2], vec![0.0]).is_err(), "negative");
        assert!(new(vec![1.0; 4], [2, 2], vec![0.0, 1.0]).is_err(), "too few");
        assert!(new(vec![1.0; 2], [1, 2], vec![0.0]).is_err(), "no patch");
        assert!(new(vec![1.0; 4], [usize::MAX, 2], vec![0.0]).is_err(), "no such size");
    }
}
