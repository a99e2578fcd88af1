//! Texture filters: what value a footprint gets (M202, M203, M209 to M211).
//!
//! Coordinates of lookups are in periods of the picture, (0, 0) its top left corner; texel centres are at half-integers (E37), and
//! levels of detail follow from derivatives in texels, not in periods (E43).

use super::{
    kernel::{Cubic, lanczos_weights},
    levels::Levels,
    mapping::Coordinates2,
    store::{Level, View, on_level},
    summed::SummedArea,
    wrap::Wrap,
};
use steradian_math::{Vec2, hash::mix32};

/// How a picture is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// Linear between the nearest 2 × 2.
    Bilinear,
    /// A cubic kernel over the nearest 4 × 4.
    Bicubic(Cubic),
    /// Lanczos' kernel over the nearest 6 × 6.
    Lanczos,
    /// Linear between the nearest 2 × 2 of the two levels whose texels are about as large as the footprint is long.
    Trilinear,
    /// Linear between levels of a ripmap whose texels are about as wide and as high as the footprint's box.
    Ripmap,
    /// The mean over the footprint's box, from a summed-area table.
    Box,
    /// An elliptical Gaussian over the footprint (Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989, § 3.5), on the levels at
    /// which its shorter axis is one to two texels long. Footprints that are longer than this many times their width are made wider.
    Ewa(f32),
}

/// The filters by name.
pub const FILTERS: [(&str, Filter); 11] = [
    ("nearest", Filter::Nearest),
    ("bilinear", Filter::Bilinear),
    ("bicubic", Filter::Bicubic(Cubic::Mitchell)),
    ("mitchell", Filter::Bicubic(Cubic::Mitchell)),
    ("bspline", Filter::Bicubic(Cubic::BSpline)),
    ("catmull_rom", Filter::Bicubic(Cubic::CatmullRom)),
    ("lanczos", Filter::Lanczos),
    ("trilinear", Filter::Trilinear),
    ("ripmap", Filter::Ripmap),
    ("box", Filter::Box),
    ("ewa", Filter::Ewa(8.0)),
];

impl Filter {
    /// Whether it averages over footprints.
    pub fn is_prefiltered(self) -> bool {
        matches!(self, Self::Trilinear | Self::Ripmap | Self::Box | Self::Ewa(_))
    }
}

/// What filters look at.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The picture and its smaller sizes.
    pub levels: &'a Levels,
    /// Its sums, for [`Filter::Box`].
    pub sums: Option<&'a SummedArea>,
    /// What lies outside.
    pub wrap: [Wrap; 2],
}

impl Source<'_> {
    /// The filtered linear values of `N` channels from `first` on.
    #[inline]
    pub fn lookup<const N: usize>(&self, filter: Filter, at: &Coordinates2, first: usize) -> [f32; N] {
        let base = self.levels.base();
        match filter {
            Filter::Nearest => self.nearest(base, at.uv, first),
            Filter::Bilinear => self.bilinear(base, at.uv, first),
            Filter::Bicubic(cubic) => self.separable(base, at.uv, first, |t| cubic.weights(t)),
            Filter::Lanczos => self.separable(base, at.uv, first, lanczos_weights),
            Filter::Trilinear => {
                let (i, t) = self.level_of(longest(base, at), self.levels.counts().0);
                let near = self.bilinear(self.levels.at(i, 0), at.uv, first);
                mix(near, t, || self.bilinear(self.levels.at(i + 1, 0), at.uv, first))
            }
            Filter::Ripmap => {
                let (columns, rows) = self.levels.counts();
                let extent = extent(base, at);
                let ((i, s), (j, t)) = (self.level_of(extent.x, columns), self.level_of(extent.y, rows));
                let along = |j: usize| {
                    let near = self.bilinear(self.levels.at(i, j), at.uv, first);
                    mix(near, s, || self.bilinear(self.levels.at(i + 1, j), at.uv, first))
                };
                mix(along(j), t, || along(j + 1))
            }
            Filter::Box => match self.sums {
                Some(sums) => {
                    let size = extent(base, at).max(Vec2::ONE).min(Vec2::splat(1e6));
                    let centre = at.uv * dimensions(base);
                    sums.mean(centre.as_dvec2().into(), size.as_dvec2().into(), self.wrap, first)
                }
                None => self.bilinear(base, at.uv, first),
            },
            Filter::Ewa(anisotropy) => self.ewa(at, anisotropy, first),
        }
    }

    #[inline]
    fn nearest<const N: usize>(&self, level: &Level, uv: Vec2, first: usize) -> [f32; N] {
        let p = uv * dimensions(level);
        let x = self.wrap[0].apply(p.x.floor() as i64, level.width());
        let y = self.wrap[1].apply(p.y.floor() as i64, level.height());
        let (Some(x), Some(y)) = (x, y) else { return [0.0; N] };
        on_level!(level, first, |view| view.texel(x, y))
    }

    #[inline]
    fn bilinear<const N: usize>(&self, level: &Level, uv: Vec2, first: usize) -> [f32; N] {
        self.separable(level, uv, first, |t| [1.0 - t, t])
    }

    /// `K × K` texels with weights that are products; `weights` is for a point that lies `t` beyond the texel before it.
    #[inline]
    fn separable<const N: usize, const K: usize>(
        &self,
        level: &Level,
        uv: Vec2,
        first: usize,
        weights: impl Fn(f32) -> [f32; K],
    ) -> [f32; N] {
        let p = uv * dimensions(level) - 0.5;
        let (columns, across) = self.taps(p.x, level.width(), 0, &weights);
        let (rows, down) = self.taps(p.y, level.height(), 1, &weights);
        on_level!(level, first, |view| {
            let mut sum = [0.0; N];
            for (y, wy) in rows.into_iter().zip(down) {
                let mut row = [0.0; N];
                for (x, wx) in columns.into_iter().zip(across) {
                    let texel: [f32; N] = view.texel(x, y);
                    (0..N).for_each(|c| row[c] += texel[c] * wx);
                }
                (0..N).for_each(|c| sum[c] += row[c] * wy);
            }
            sum
        })
    }

    /// The texels around a coordinate along an axis and their weights; what is black has none.
    #[inline]
    fn taps<const K: usize>(
        &self,
        p: f32,
        n: usize,
        axis: usize,
        weights: impl Fn(f32) -> [f32; K],
    ) -> ([usize; K], [f32; K]) {
        // Beyond a thousand million texels there are no fractions, and infinity has none.
        let p = p.clamp(-1e9, 1e9);
        let floor = p.floor();
        let mut weights = weights(p - floor);
        let first = (floor as i64).saturating_sub(K as i64 / 2 - 1);
        let mut index = [0; K];
        if first >= 0 && first as u64 + K as u64 <= n as u64 {
            (0..K).for_each(|k| index[k] = first as usize + k);
        } else {
            for k in 0..K {
                match self.wrap[axis].apply(first.saturating_add(k as i64), n) {
                    Some(i) => index[k] = i,
                    None => weights[k] = 0.0,
                }
            }
        }
        (index, weights)
    }

    /// The finer of the two levels for a length in texels of the picture, and how far towards the coarser one.
    #[inline]
    fn level_of(&self, length: f32, count: usize) -> (usize, f32) {
        level_of(length, count)
    }

    #[inline]
    fn ewa<const N: usize>(&self, at: &Coordinates2, anisotropy: f32, first: usize) -> [f32; N] {
        let base = self.levels.base();
        let (mut long, mut short) = (at.dx, at.dy);
        let scale = dimensions(base);
        let (mut a, mut b) = ((long * scale).length(), (short * scale).length());
        if a < b {
            (long, short, a, b) = (short, long, b, a);
        }
        if !(b > 0.0 && a.is_finite()) {
            return self.bilinear(base, at.uv, first);
        }
        if b * anisotropy < a {
            short *= a / (b * anisotropy);
            b = a / anisotropy;
        }
        let (i, t) = self.level_of(b, self.levels.counts().0);
        let near = self.ellipse(self.levels.at(i, 0), at.uv, long, short, first);
        mix(near, t, || self.ellipse(self.levels.at(i + 1, 0), at.uv, long, short, first))
    }

    /// The mean over an ellipse with the given half axes (in periods), by a Gaussian that has fallen to e⁻² at its rim.
    #[inline]
    fn ellipse<const N: usize>(&self, level: &Level, uv: Vec2, long: Vec2, short: Vec2, first: usize) -> [f32; N] {
        let scale = dimensions(level);
        let (p, s, t) = (uv * scale - 0.5, long * scale, short * scale);
        // A x² + B x y + C y² < 1 inside, where the width of a texel is added (Heckbert, eq. 3.6 and following).
        let (mut a, mut b, mut c) =
            (s.y * s.y + t.y * t.y + 1.0, -2.0 * (s.x * s.y + t.x * t.y), s.x * s.x + t.x * t.x + 1.0);
        let f = a * c - 0.25 * b * b;
        // The box around the ellipse.
        let (half_x, half_y) = (c.sqrt(), a.sqrt());
        let inverse = 1.0 / f;
        (a, b, c) = (a * inverse, b * inverse, c * inverse);
        let (x0, x1) = ((p.x - half_x).ceil(), (p.x + half_x).floor());
        let (y0, y1) = ((p.y - half_y).ceil(), (p.y + half_y).floor());
        // Vast footprints are seen on the last level, which is small: this is out of reach but for degenerate ones.
        const MOST: f32 = 512.0;
        if !((x1 - x0) <= MOST && (y1 - y0) <= MOST) {
            return self.bilinear(self.levels.at(self.levels.counts().0 - 1, 0), uv, first);
        }
        let (w, h) = (level.width(), level.height());
        let (first_x, last_x) = (x0 as i64, x1 as i64);
        on_level!(level, first, |view| {
            let (mut sum, mut total) = ([0.0; N], 0.0);
            for iy in y0 as i64..=y1 as i64 {
                let y = iy as f32 - p.y;
                // The part of the row inside: roots of a x² + (b y) x + c y² = 1.
                let (middle, rest) = (-0.5 * b * y / a, (1.0 - c * y * y) / a);
                let square = middle * middle + rest;
                if square < 0.0 {
                    continue;
                }
                let half = square.sqrt();
                let from = ((p.x + middle - half).ceil() as i64).max(first_x);
                let to = ((p.x + middle + half).floor() as i64).min(last_x);
                let row = self.wrap[1].apply(iy, h);
                for ix in from..=to {
                    let x = ix as f32 - p.x;
                    let weight = gaussian(a * x * x + b * x * y + c * y * y);
                    total += weight;
                    if let (Some(column), Some(row)) = (self.wrap[0].apply(ix, w), row) {
                        let texel: [f32; N] = view.texel(column, row);
                        (0..N).for_each(|c| sum[c] += texel[c] * weight);
                    }
                }
            }
            if total > 0.0 { sum.map(|s| s / total) } else { self.bilinear(level, uv, first) }
        })
    }

    /// One texel, drawn such that the mean over many draws is the filter's value (Pharr, Wronski, Salvi, Fajardo, "Filtering After
    /// Shading with Stochastic Texture Filtering", 2024). The random numbers are a hash of the place and `salt`.
    pub fn one_tap<const N: usize>(&self, filter: Filter, at: &Coordinates2, salt: u32, first: usize) -> [f32; N] {
        let mut random = Random::new(at.uv, salt);
        let base = self.levels.base();
        let choose_level = |length: f32, count: usize, random: &mut Random| {
            let (i, t) = self.level_of(length, count);
            i + usize::from(random.next() < t)
        };
        match filter {
            Filter::Nearest => self.nearest(base, at.uv, first),
            Filter::Bilinear => self.tap(base, at.uv, first, &mut random, |t| [1.0 - t, t]),
            Filter::Bicubic(cubic) => self.tap(base, at.uv, first, &mut random, |t| cubic.weights(t)),
            Filter::Lanczos => self.tap(base, at.uv, first, &mut random, lanczos_weights),
            Filter::Trilinear => {
                let i = choose_level(longest(base, at), self.levels.counts().0, &mut random);
                self.tap(self.levels.at(i, 0), at.uv, first, &mut random, |t| [1.0 - t, t])
            }
            Filter::Ripmap => {
                let ((columns, rows), extent) = (self.levels.counts(), extent(base, at));
                let i = choose_level(extent.x, columns, &mut random);
                let j = choose_level(extent.y, rows, &mut random);
                self.tap(self.levels.at(i, j), at.uv, first, &mut random, |t| [1.0 - t, t])
            }
            Filter::Box => {
                let size = extent(base, at).max(Vec2::ONE) / dimensions(base);
                let offset = Vec2::new(random.next(), random.next()) - 0.5;
                self.nearest(base, at.uv + size * offset, first)
            }
            Filter::Ewa(anisotropy) => {
                let scale = dimensions(base);
                let (a, b) = ((at.dx * scale).length(), (at.dy * scale).length());
                let i = choose_level(a.min(b).max(a.max(b) / anisotropy), self.levels.counts().0, &mut random);
                // e^(-2r²) cut at r = 1: by the inverse of its radial distribution.
                let r = (-0.5 * (1.0 - random.next() * (1.0 - (-2.0_f32).exp())).ln()).max(0.0).sqrt();
                let (sin, cos) = (random.next() * std::f32::consts::TAU).sin_cos();
                let uv = at.uv + (at.dx * cos + at.dy * sin) * r;
                let uv = if uv.is_finite() { uv } else { at.uv };
                self.tap(self.levels.at(i, 0), uv, first, &mut random, |t| [1.0 - t, t])
            }
        }
    }

    /// One of `K × K` texels by its weight; where weights are negative by their magnitude, times the sign.
    fn tap<const N: usize, const K: usize>(
        &self,
        level: &Level,
        uv: Vec2,
        first: usize,
        random: &mut Random,
        weights: impl Fn(f32) -> [f32; K],
    ) -> [f32; N] {
        let p = uv * dimensions(level) - 0.5;
        let mut choose = |p: f32, n: usize, axis: usize| {
            let (index, weights) = self.taps(p, n, axis, &weights);
            let sum: f32 = weights.iter().map(|w| w.abs()).sum();
            let mut left = random.next() * sum;
            let mut chosen = K - 1;
            for (k, w) in weights.iter().enumerate() {
                left -= w.abs();
                if left < 0.0 {
                    chosen = k;
                    break;
                }
            }
            (index[chosen], sum.copysign(weights[chosen]))
        };
        let ((x, wx), (y, wy)) = (choose(p.x, level.width(), 0), choose(p.y, level.height(), 1));
        let texel: [f32; N] = on_level!(level, first, |view| view.texel(x, y));
        texel.map(|v| v * wx * wy)
    }
}

/// Numbers in `[0, 1)` that are a function of a place.
struct Random(u32);

impl Random {
    fn new(uv: Vec2, salt: u32) -> Self {
        Self(mix32(mix32(salt ^ uv.x.to_bits()).wrapping_add(uv.y.to_bits())))
    }

    fn next(&mut self) -> f32 {
        self.0 = mix32(self.0.wrapping_add(0x9e37_79b9));
        steradian_math::hash::unit_f32(self.0)
    }
}

#[inline]
fn dimensions(level: &Level) -> Vec2 {
    Vec2::new(level.width() as f32, level.height() as f32)
}

/// Length of the longer side of the footprint, in texels.
#[inline]
fn longest(base: &Level, at: &Coordinates2) -> f32 {
    let scale = dimensions(base);
    (at.dx * scale).length_squared().max((at.dy * scale).length_squared()).sqrt()
}

/// Size of the box around the footprint, a parallelogram with these sides, in texels.
#[inline]
fn extent(base: &Level, at: &Coordinates2) -> Vec2 {
    (at.dx.abs() + at.dy.abs()) * dimensions(base)
}

/// The finer of the two levels for a length in texels of the picture, and how far towards the coarser one: log₂ of the length.
#[inline]
pub fn level_of(length: f32, count: usize) -> (usize, f32) {
    if length.is_nan() || length <= 1.0 {
        return (0, 0.0);
    }
    let level = length.log2().min(64.0);
    let i = level as usize;
    if i + 1 >= count { (count - 1, 0.0) } else { (i, level - i as f32) }
}

#[inline]
fn mix<const N: usize>(near: [f32; N], t: f32, far: impl FnOnce() -> [f32; N]) -> [f32; N] {
    if t == 0.0 {
        return near;
    }
    let far = far();
    std::array::from_fn(|c| near[c] * (1.0 - t) + far[c] * t)
}

/// `e^(-2 r²) − e^(-2)` of r², from a table with linear interpolation (to about 10⁻⁵).
#[inline]
fn gaussian(r2: f32) -> f32 {
    const STEPS: usize = 256;
    static TABLE: std::sync::LazyLock<[f32; STEPS + 2]> = std::sync::LazyLock::new(|| {
        std::array::from_fn(|i| ((-2.0 * i as f32 / STEPS as f32).exp() - (-2.0_f32).exp()).max(0.0))
    });
    let x = r2.clamp(0.0, 1.0) * STEPS as f32;
    let i = x as usize;
    let t = x - i as f32;
    TABLE[i] * (1.0 - t) + TABLE[i + 1] * t
}
