//! A window of pixels, and the line that is fitted to their colours.

/// Columns and rows of a window: its centre, [`REACH`] before it, the rest behind.
pub(super) const SIDE: usize = 24;
/// Columns and rows before the centre.
pub(super) const REACH: usize = 11;
const PIXELS: usize = SIDE * SIDE;
/// Numbers that a line has factors for: one, column, row, normal, albedo.
const TERMS: usize = 9;
/// Terms, and three channels.
const COLUMNS: usize = TERMS + 3;
/// By how much a term is to spread for its factor to be known well.
const SCALES: [f64; TERMS] = [1.0, 0.2, 0.2, 0.2, 0.2, 0.2, 0.5, 0.5, 0.5];
/// The part of the square of that which is added to the variance of the term (ridge regression): always, and for a
/// window of one pixel; of more it is so much less.
const RIDGE: f64 = 0.003;
const RIDGE_OF_ONE: f64 = 1.0;
/// The mean square of a term that spreads too little, over that of its scale.
const LEAST_SPREAD: f32 = 1e-4;
/// Numbers that are summed side by side.
const LANES: usize = 64;

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
        // Moments of terms with terms and channels, of all that is not symmetric. Terms that spread too little to tell
        // anything are left out.
        let mut moments = [[0.0; COLUMNS]; TERMS];
        let mut is_used = [true; COLUMNS];
        for i in 0..TERMS {
            let (weighted, column) = (&mut self.weighted[i], &self.columns[i]);
            for k in 0..PIXELS {
                weighted[k] = self.counts[k] * column[k];
            }
            moments[i][i] = dot(weighted, column);
            is_used[i] = moments[i][i] > LEAST_SPREAD * (SCALES[i] * SCALES[i]) as f32 * moments[0][0];
        }
        for i in (0..TERMS).filter(|i| is_used[*i]) {
            for j in (i + 1..COLUMNS).filter(|j| is_used[*j]) {
                moments[i][j] = dot(&self.weighted[i], &self.columns[j]);
            }
        }
        let whole = moments[0][0];
        if whole.is_nan() || whole <= 0.0 {
            return None;
        }
        let mut squares = [0.0; PIXELS];
        squares.iter_mut().zip(&self.counts).for_each(|(square, count)| *square = count * count);
        let all = dot(&squares, &self.columns[0]);
        let variances = self.variances.each_ref().map(|variances| dot(&squares, variances) / (whole * whole));
        let factors = line(&moments, f64::from(all / (whole * whole)));
        // A line knows nothing of what is beyond the colours that it was fitted to.
        for (c, factors) in factors.iter().enumerate() {
            let told = &mut self.told[c];
            told.fill(factors[0]);
            for i in (1..TERMS).filter(|i| is_used[*i]) {
                let (factor, column) = (factors[i], &self.columns[i]);
                for k in 0..PIXELS {
                    told[k] += factor * column[k];
                }
            }
            let [least, most] = bounds(&self.columns[TERMS + c], &self.counts);
            for told in told {
                *told = told.max(least).min(most);
            }
        }
        Some(variances)
    }
}

/// The dot product of two columns.
#[inline(always)]
fn dot(a: &Column, b: &Column) -> f32 {
    let mut sums = [0.0; LANES];
    for (a, b) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    folded(sums, |a, b| a + b)
}

/// The least and the greatest value of what counts.
#[inline(always)]
fn bounds(values: &Column, counts: &Column) -> [f32; 2] {
    let least = |a: f32, b: f32| if b < a { b } else { a };
    let most = |a: f32, b: f32| if b > a { b } else { a };
    let (mut low, mut high) = ([f32::MAX; LANES], [f32::MIN; LANES]);
    for (values, counts) in values.as_chunks::<LANES>().0.iter().zip(counts.as_chunks::<LANES>().0) {
        for k in 0..LANES {
            low[k] = least(low[k], if counts[k] > 0.0 { values[k] } else { f32::MAX });
            high[k] = most(high[k], if counts[k] > 0.0 { values[k] } else { f32::MIN });
        }
    }
    [folded(low, least), folded(high, most)]
}

/// All lanes in one: halves onto halves.
#[inline(always)]
fn folded(mut lanes: [f32; LANES], both: impl Fn(f32, f32) -> f32) -> f32 {
    let mut half = LANES / 2;
    while half > 0 {
        for k in 0..half {
            lanes[k] = both(lanes[k], lanes[k + half]);
        }
        half /= 2;
    }
    lanes[0]
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
            let [of_i, of_j] = [root[i], root[j]];
            of_i[1..j].iter().zip(&of_j[1..j]).for_each(|(a, b)| rest -= a * b);
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
