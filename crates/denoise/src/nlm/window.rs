//! A window of pixels, and the line that is fitted to their colours.

/// Columns and rows of a window: its centre, [`REACH`] before it, the rest behind.
pub(super) const SIDE: usize = 24;
/// Columns and rows before the centre.
pub(super) const REACH: usize = 11;
const PIXELS: usize = SIDE * SIDE;
/// Numbers that a line has factors for: one, column, row, normal, albedo.
const TERMS: usize = 9;
/// Those, and three channels.
const COLUMNS: usize = TERMS + 3;
/// By how much a term is to spread for its factor to be known well.
const SCALES: [f64; TERMS] = [1.0, 0.2, 0.2, 0.2, 0.2, 0.2, 0.5, 0.5, 0.5];
/// The part of the square of that which is added to the variance of the term (ridge regression): always, and for a
/// window of one pixel; of more it is so much less.
const RIDGE: f64 = 0.003;
const RIDGE_OF_ONE: f64 = 1.0;
/// Numbers that are summed side by side.
const LANES: usize = 16;

/// Terms and colours of pixels, one after the other.
type Column = [f32; PIXELS];

/// Pixels about a centre.
pub(super) struct Window {
    /// Weights by place: 1 in the middle, 0 at the rim.
    taper: Column,
    weights: Column,
    /// Weights, times how much pixels count.
    counts: Column,
    /// Terms but for one, which is 1, then channels.
    columns: [Column; COLUMNS],
    /// Terms by weights and counts.
    weighted: [Column; TERMS],
    variances: [Column; 3],
    told: [Column; 3],
}

impl Window {
    /// Window whose weights end a radius from the centre.
    pub fn new(radius: u32) -> Box<Self> {
        let none = [0.0; PIXELS];
        let end = radius as f32 + 1.0;
        let place = |k: usize| [(k % SIDE) as f32 - REACH as f32, (k / SIDE) as f32 - REACH as f32].map(|x| x / end);
        let taper = std::array::from_fn(|k| {
            let [x, y] = place(k);
            (1.0 - x * x - y * y).max(0.0)
        });
        let mut columns = [none; COLUMNS];
        columns[0] = [1.0; PIXELS];
        columns[1] = std::array::from_fn(|k| place(k)[0]);
        columns[2] = std::array::from_fn(|k| place(k)[1]);
        let [weights, counts] = [none; 2];
        Box::new(Self {
            taper,
            weights,
            counts,
            columns,
            weighted: [none; TERMS],
            variances: [none; 3],
            told: [none; 3],
        })
    }

    /// A row that lies outside the picture.
    #[inline(always)]
    pub fn skip_row(&mut self, j: usize) {
        let (weights, counts) = (&mut self.weights, &mut self.counts);
        weights[j * SIDE..][..SIDE].fill(0.0);
        counts[j * SIDE..][..SIDE].fill(0.0);
    }

    /// Sets a row: how alike its pixels are to the centre, and how much they count, differences of normals and albedo,
    /// colours and variances.
    #[inline(always)]
    pub fn set_row(
        &mut self,
        j: usize,
        alike: &[f32; SIDE],
        counts: &[f32; SIDE],
        apart: &[[[f32; SIDE]; 3]; 2],
        colors: &[[&[f32; SIDE]; 2]; 3],
    ) {
        let taper = &self.taper[j * SIDE..][..SIDE];
        let weights = &mut self.weights[j * SIDE..][..SIDE];
        for k in 0..SIDE {
            weights[k] = alike[k] * taper[k];
        }
        let counted = &mut self.counts[j * SIDE..][..SIDE];
        for k in 0..SIDE {
            counted[k] = weights[k] * counts[k];
        }
        for c in 0..3 {
            self.columns[3 + c][j * SIDE..][..SIDE].copy_from_slice(&apart[1][c]);
            self.columns[6 + c][j * SIDE..][..SIDE].copy_from_slice(&apart[0][c]);
            self.columns[TERMS + c][j * SIDE..][..SIDE].copy_from_slice(colors[c][0]);
            self.variances[c][j * SIDE..][..SIDE].copy_from_slice(colors[c][1]);
        }
    }

    /// Weights of a row.
    #[inline(always)]
    pub fn weights(&self, j: usize) -> &[f32; SIDE] {
        self.weights[j * SIDE..].first_chunk().expect("a row lies in the window")
    }

    /// Values that the line has in a row.
    #[inline(always)]
    pub fn told(&self, channel: usize, j: usize) -> &[f32; SIDE] {
        self.told[channel][j * SIDE..].first_chunk().expect("a row lies in the window")
    }

    /// Fits a line, and gives the variances of its middle; none where no pixel counts.
    #[inline(always)]
    pub fn fit(&mut self) -> Option<[f32; 3]> {
        for (weighted, column) in self.weighted.iter_mut().zip(&self.columns) {
            for k in 0..PIXELS {
                weighted[k] = self.counts[k] * column[k];
            }
        }
        // Moments of terms with terms and channels, of all that is not symmetric.
        let mut moments = [[0.0; COLUMNS]; TERMS];
        for (i, moments) in moments.iter_mut().enumerate() {
            for j in (i / 4 * 4..COLUMNS).step_by(4) {
                let of = [0, 1, 2, 3].map(|k| &self.columns[j + k]);
                moments[j..j + 4].copy_from_slice(&products(&self.weighted[i], of));
            }
        }
        let whole = moments[0][0];
        if !(whole > 0.0) {
            return None;
        }
        let mut squares = [0.0; PIXELS];
        for k in 0..PIXELS {
            squares[k] = self.counts[k] * self.counts[k];
        }
        let [r, g, b] = &self.variances;
        let [r, g, b, all] = products(&squares, [r, g, b, &self.columns[0]]);
        let variances = [r, g, b].map(|sum| sum / (whole * whole));
        let factors = line(&moments, f64::from(all / (whole * whole)));
        // A line knows nothing of what is beyond the colours that it was fitted to.
        for (c, factors) in factors.iter().enumerate() {
            let (mut least, mut most) = ([f32::MAX; LANES], [f32::MIN; LANES]);
            let channel = self.columns[TERMS + c].chunks_exact(LANES).zip(self.counts.chunks_exact(LANES));
            for (values, counts) in channel {
                for k in 0..LANES {
                    least[k] = least[k].min(if counts[k] > 0.0 { values[k] } else { f32::MAX });
                    most[k] = most[k].max(if counts[k] > 0.0 { values[k] } else { f32::MIN });
                }
            }
            let (least, most) = (least.into_iter().fold(f32::MAX, f32::min), most.into_iter().fold(f32::MIN, f32::max));
            for from in (0..PIXELS).step_by(LANES) {
                let mut told = [factors[0]; LANES];
                for (column, factor) in self.columns[1..TERMS].iter().zip(&factors[1..]) {
                    let column = &column[from..from + LANES];
                    for k in 0..LANES {
                        told[k] += factor * column[k];
                    }
                }
                for (k, told) in told.into_iter().enumerate() {
                    self.told[c][from + k] = told.max(least).min(most);
                }
            }
        }
        Some(variances)
    }
}

/// Dot products of a column with four others.
#[inline(always)]
fn products(a: &Column, of: [&Column; 4]) -> [f32; 4] {
    let mut sums = [[0.0; LANES]; 4];
    for from in (0..PIXELS).step_by(LANES) {
        let a: &[f32; LANES] = a[from..].first_chunk().expect("lanes fill columns");
        for (sums, b) in sums.iter_mut().zip(of) {
            let b: &[f32; LANES] = b[from..].first_chunk().expect("lanes fill columns");
            for k in 0..LANES {
                sums[k] += a[k] * b[k];
            }
        }
    }
    sums.map(|sums| sums.into_iter().sum())
}

/// Factors of terms for each channel: least squares about the means, by Cholesky's method, held back where the terms
/// spread little. `one` is how much the window is as one pixel is: Σ w²/(Σ w)².
#[inline(always)]
fn line(moments: &[[f32; COLUMNS]; TERMS], one: f64) -> [[f32; TERMS]; 3] {
    let whole = f64::from(moments[0][0]);
    let means: [f64; COLUMNS] = std::array::from_fn(|i| f64::from(moments[0][i]) / whole);
    let ridge = RIDGE + RIDGE_OF_ONE * one;
    // Covariances below the diagonal, and then their root.
    let mut root = [[0.0; TERMS]; TERMS];
    for i in 1..TERMS {
        for j in 1..=i {
            let mut rest = f64::from(moments[j][i]) / whole - means[i] * means[j];
            if i == j {
                rest = rest.max(0.0) + ridge * SCALES[i] * SCALES[i];
            }
            for k in 1..j {
                rest -= root[i][k] * root[j][k];
            }
            // Rounding may leave nothing of what terms that follow each other have by themselves.
            root[i][j] = if i == j { rest.max(0.5 * ridge * SCALES[i] * SCALES[i]).sqrt() } else { rest / root[j][j] };
        }
    }
    std::array::from_fn(|c| {
        let mut factors = [0.0; TERMS];
        for i in 1..TERMS {
            factors[i] = f64::from(moments[i][TERMS + c]) / whole - means[i] * means[TERMS + c];
            for k in 1..i {
                factors[i] -= root[i][k] * factors[k];
            }
            factors[i] /= root[i][i];
        }
        for i in (1..TERMS).rev() {
            for k in i + 1..TERMS {
                factors[i] -= root[k][i] * factors[k];
            }
            factors[i] /= root[i][i];
        }
        factors[0] = means[TERMS + c];
        for i in 1..TERMS {
            factors[0] -= factors[i] * means[i];
        }
        factors.map(|factor| factor as f32)
    })
}
