//! A picture in several sizes: mip-maps (each level half as wide and half as high, Williams 1983) and ripmaps (halved
//! in each direction on its own). Levels are kept in the picture's own precision and encoding, and are averaged in
//! linear values.

use super::{
    kernel::MipKernel,
    sample::Kind,
    store::{Level, Pages},
    wrap::Wrap,
};
use half::f16;
use rayon::prelude::*;
use std::sync::Arc;
use steradian_image::{Encoding, TexelData, Texels};

/// Which levels there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// The picture alone.
    Flat,
    /// Halved in both directions at once, down to one texel.
    Mip,
    /// Halved in each direction on its own.
    Rip,
}

/// Construction of the levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Which levels.
    pub shape: Shape,
    /// By which kernel.
    pub kernel: MipKernel,
    /// Wrap modes, horizontally and vertically.
    pub wrap: [Wrap; 2],
    /// Opacity at which the picture is cut, if it holds opacity (its alpha, or its only channel): each level then lets
    /// through as much as the picture does (Castaño, "Computing Alpha Mipmaps", 2010; M212). Colours are weighted by
    /// alpha then.
    pub keep_coverage: Option<f32>,
    /// True for pictures whose alpha is opacity: texels that are not seen take the colour of their neighbours, so that
    /// no filter mixes the colour of nothing into edges.
    pub bleed: bool,
}

/// A picture in several sizes.
#[derive(Clone, Debug)]
pub struct Levels {
    levels: Vec<Level>,
    /// Number of sizes in x; for mip-maps all are in one row.
    columns: usize,
    rows: usize,
}

impl Levels {
    /// The level `i` halvings in x and `j` in y away from the picture; mip-maps have `j` = 0 and count both in `i`.
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> &Level {
        &self.levels[j * self.columns + i]
    }

    /// A level of a mip-map, as for [`Self::at`], and the next smaller one; `None` for the last.
    #[inline(always)]
    pub fn pair(&self, i: usize) -> Option<&[Level; 2]> {
        self.levels.get(i..)?.first_chunk()
    }

    /// The level of a mip-map at which a length is one to two texels, given its square in texels of the picture; the
    /// first or last for those that are shorter or longer.
    #[inline(always)]
    pub fn of_square(&self, square: f32) -> &Level {
        let i = ((square.to_bits() >> 23) as i32 - 127).max(0) as usize >> 1;
        &self.levels[i.min(self.columns - 1)]
    }

    /// The smallest level of a mip-map.
    #[inline]
    pub fn last(&self) -> &Level {
        &self.levels[self.columns - 1]
    }

    /// The picture itself.
    #[inline]
    pub fn base(&self) -> &Level {
        &self.levels[0]
    }

    /// Number of sizes in x and in y; (n, 1) for mip-maps.
    #[inline]
    pub fn counts(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }

    /// Bytes of all levels, wherever they are kept.
    pub fn byte_size(&self) -> usize {
        self.levels.iter().map(Level::byte_size).sum()
    }

    /// Bytes of those that are in memory always.
    pub fn resident_bytes(&self) -> usize {
        self.levels.iter().map(Level::resident_bytes).sum()
    }

    /// The picture alone.
    pub fn flat(base: Level) -> Self {
        Self { levels: vec![base], columns: 1, rows: 1 }
    }

    /// Makes the levels of a picture; into `pages` where they are not to stay in memory.
    pub fn new(base: Level, recipe: &Recipe, pages: Option<&Arc<Pages>>) -> std::io::Result<Self> {
        let halvings = |n: usize| if recipe.shape == Shape::Flat { 1 } else { n.ilog2() as usize + 1 };
        let (w, h) = (base.width(), base.height());
        if w == 0 || h == 0 {
            return Ok(Self::flat(base));
        }
        let bleeds = (recipe.bleed || recipe.keep_coverage.is_some()) && matches!(base.channels(), 2 | 4);
        let base = if bleeds { bled(base, recipe, pages)? } else { base };
        let coverage = recipe.keep_coverage.map(|cut| (cut, coverage(&base, cut, 1.0)));
        let halved = |n: usize| (n / 2).max(1);
        let (columns, rows) = match recipe.shape {
            Shape::Rip => (halvings(w), halvings(h)),
            _ => (halvings(w.max(h)), 1),
        };
        // While levels are made, the first takes most: its linear values, what is stored of them, and the next one's.
        let first = match recipe.shape {
            Shape::Flat => 0,
            Shape::Mip => halved(w) * halved(h),
            Shape::Rip => 2 * halved(w) * h,
        } * base.channels();
        let _room = pages.map(|pages| pages.take_room(first * (5 * size_of::<f32>() / 4 + base.kind().bytes())));
        let mut levels: Vec<Level> = Vec::with_capacity(columns * rows);
        // The values that the next level is made from, before they were rounded: along the row, and of the first
        // column.
        let mut row: Option<Plane> = None;
        let mut column: Option<Plane> = None;
        for j in 0..rows {
            for i in 0..columns {
                if (i, j) == (0, 0) {
                    levels.push(base.clone());
                    continue;
                }
                let (from, last) = if i == 0 { ((0, j - 1), &column) } else { ((i - 1, j), &row) };
                let source = &levels[from.1 * columns + from.0];
                let size = match recipe.shape {
                    Shape::Rip if i == 0 => (source.width(), halved(source.height())),
                    Shape::Rip => (halved(source.width()), source.height()),
                    _ => (halved(source.width()), halved(source.height())),
                };
                let mut plane = match last {
                    Some(plane) => shrink(plane, size, recipe),
                    None => shrink(source, size, recipe),
                };
                if let Some((cut, wanted)) = coverage {
                    keep_coverage(&mut plane, cut, wanted);
                }
                if bleeds {
                    plane.bleed(recipe.wrap);
                }
                levels.push(plane.store(&base, pages)?);
                if i == 0 && recipe.shape == Shape::Rip {
                    column = Some(plane.clone());
                }
                row = Some(plane);
            }
        }
        Ok(Self { levels, columns, rows })
    }
}

/// Linear values of one level while the next is made.
#[derive(Clone)]
struct Plane {
    width: usize,
    height: usize,
    channels: usize,
    data: Vec<f32>,
}

/// Something with rows of linear values.
trait Rows: Sync {
    fn size(&self) -> (usize, usize, usize);
    /// Adds a row, times a weight, to `sum`.
    fn add_row(&self, y: usize, weight: f32, sum: &mut [f32]);
}

impl Rows for Plane {
    fn size(&self) -> (usize, usize, usize) {
        (self.width, self.height, self.channels)
    }

    fn add_row(&self, y: usize, weight: f32, sum: &mut [f32]) {
        let n = self.width * self.channels;
        sum.iter_mut().zip(&self.data[y * n..(y + 1) * n]).for_each(|(s, v)| *s += v * weight);
    }
}

impl Rows for Level {
    fn size(&self) -> (usize, usize, usize) {
        (self.width(), self.height(), self.channels())
    }

    fn add_row(&self, y: usize, weight: f32, sum: &mut [f32]) {
        self.linear_row(y, |i, v| sum[i] += v * weight);
    }
}

/// A smaller picture: rows first, then columns.
fn shrink(source: &dyn Rows, (width, height): (usize, usize), recipe: &Recipe) -> Plane {
    let (w, h, channels) = source.size();
    // Borders are no part of the picture: its levels are made as if it went on. So are those of octahedral maps, which
    // box filters do not look beyond.
    let wrap = recipe.wrap.map(|wrap| match wrap {
        Wrap::Border | Wrap::Octahedral => Wrap::Clamp,
        wrap => wrap,
    });
    let (across, down) = (recipe.kernel.taps(w, width), recipe.kernel.taps(h, height));
    let alpha = (recipe.keep_coverage.is_some() && matches!(channels, 2 | 4)).then(|| channels - 1);
    let mut data = vec![0.0; width * height * channels];
    data.par_chunks_mut(width * channels).zip(&down).for_each(|(out, (first, weights))| {
        let mut sum = vec![0.0; w * channels];
        let mut part = vec![0.0; if alpha.is_some() { w * channels } else { 0 }];
        for (y, weight) in (*first..).zip(weights) {
            let Some(y) = wrap[1].apply(y, h) else { continue };
            if let Some(alpha) = alpha {
                part.fill(0.0);
                source.add_row(y, *weight, &mut part);
                // The row carries the weight already; its alpha must not count it twice.
                for (s, p) in sum.chunks_exact_mut(channels).zip(part.chunks_exact(channels)) {
                    let a = p[alpha] / weight;
                    (0..alpha).for_each(|c| s[c] += p[c] * a);
                    s[alpha] += p[alpha];
                }
            } else {
                source.add_row(y, *weight, &mut sum);
            }
        }
        for (texel, (first, weights)) in out.chunks_exact_mut(channels).zip(&across) {
            for (x, weight) in (*first..).zip(weights) {
                let Some(x) = wrap[0].apply(x, w) else { continue };
                let from = &sum[x * channels..(x + 1) * channels];
                texel.iter_mut().zip(from).for_each(|(t, v)| *t += v * weight);
            }
            if let Some(alpha) = alpha
                && texel[alpha] > 0.0
            {
                (0..alpha).for_each(|c| texel[c] /= texel[alpha]);
            }
        }
    });
    Plane { width, height, channels, data }
}

/// A picture whose unseen texels have the colour of their neighbours.
fn bled(base: Level, recipe: &Recipe, pages: Option<&Arc<Pages>>) -> std::io::Result<Level> {
    let (width, height, channels) = base.size();
    let mut data = vec![0.0; width * height * channels];
    data.par_chunks_mut(width * channels).enumerate().for_each(|(y, row)| base.linear_row(y, |i, v| row[i] = v));
    let mut plane = Plane { width, height, channels, data };
    if plane.bleed(recipe.wrap) { plane.store(&base, pages) } else { Ok(base) }
}

/// Distance in texels to which colours bleed: as far as kernels reach that anyone uses with cut-outs.
const BLEED: usize = 4;

impl Plane {
    /// Gives texels of no opacity the mean colour of their neighbours that have a colour, ring by ring; false where
    /// nothing changed.
    fn bleed(&mut self, wrap: [Wrap; 2]) -> bool {
        let Self { width, height, channels, data } = self;
        let (width, height, channels, alpha) = (*width, *height, *channels, *channels - 1);
        let mut has_color: Vec<bool> = data.chunks_exact(channels).map(|texel| texel[alpha] > 0.0).collect();
        if has_color.iter().all(|has| *has) || !has_color.iter().any(|has| *has) {
            return false;
        }
        for _ in 0..BLEED {
            // The ring around what has a colour, from the state before it.
            let mean = |at: usize| {
                let (x, y) = ((at % width) as i32, (at / width) as i32);
                let around =
                    (0..9).filter_map(|k| Wrap::place(wrap, [x + k % 3 - 1, y + k / 3 - 1], [width, height]).ok());
                let around = around.map(|[x, y]| y * width + x).filter(|k| has_color[*k]);
                let (mut sum, mut count) = ([0.0; 4], 0.0);
                for k in around {
                    (0..alpha).for_each(|c| sum[c] += data[k * channels + c]);
                    count += 1.0;
                }
                (count > 0.0).then(|| (at, sum.map(|v| v / count)))
            };
            let ring: Vec<_> =
                (0..has_color.len()).into_par_iter().filter(|k| !has_color[*k]).filter_map(mean).collect();
            for (at, color) in ring {
                data[at * channels..at * channels + alpha].copy_from_slice(&color[..alpha]);
                has_color[at] = true;
            }
        }
        true
    }

    /// Rounds to the precision of `like`.
    fn store(&self, like: &Level, pages: Option<&Arc<Pages>>) -> std::io::Result<Level> {
        let encoding = like.encoding();
        let alpha = matches!(self.channels, 2 | 4).then(|| self.channels - 1);
        let stored = |i: usize, v: f32| if alpha == Some(i % self.channels) { v } else { encoding.encode(v) };
        let data = match like.kind() {
            Kind::U8 => {
                let encoder = Encoder8::new(encoding);
                let code = |(i, &v): (usize, &f32)| {
                    if alpha == Some(i % self.channels) {
                        steradian_image::encoding::quantize8(v)
                    } else {
                        encoder.code(v)
                    }
                };
                TexelData::U8(self.data.par_iter().enumerate().map(code).collect())
            }
            Kind::U16 => TexelData::U16(
                self.data
                    .par_iter()
                    .enumerate()
                    .map(|(i, &v)| steradian_image::encoding::quantize16(stored(i, v)))
                    .collect(),
            ),
            Kind::F16 => {
                // Means of halves are in their range.
                TexelData::F16(self.data.iter().enumerate().map(|(i, &v)| f16::from_f32(stored(i, v))).collect())
            }
            Kind::F32 => TexelData::F32(self.data.iter().enumerate().map(|(i, &v)| stored(i, v)).collect()),
        };
        let texels = Texels {
            width: self.width,
            height: self.height,
            channels: self.channels,
            data,
            encoding,
            metadata: Default::default(),
        };
        Level::new(Arc::new(texels), pages)
    }
}

/// From linear values to the nearest 8-bit code of an encoding.
struct Encoder8 {
    /// Below `ends[c]` lies code `c` or a lower one.
    ends: [f32; 255],
    /// The lowest code that values with this square root (in steps of 1/1024) have.
    lowest: Vec<u8>,
}

impl Encoder8 {
    fn new(encoding: Encoding) -> Self {
        let ends = std::array::from_fn(|c| encoding.decode((c as f32 + 0.5) / 255.0));
        let lowest = (0..=1024)
            .map(|i| {
                let x = (i as f32 / 1024.0).powi(2) * (1.0 - 1e-6);
                ends.partition_point(|&end| end <= x) as u8
            })
            .collect();
        Self { ends, lowest }
    }

    fn code(&self, linear: f32) -> u8 {
        let mut code = self.lowest[(linear.clamp(0.0, 1.0).sqrt() * 1024.0) as usize];
        while code < 255 && self.ends[code as usize] <= linear {
            code += 1;
        }
        code
    }
}

/// The share of texels whose opacity, times a factor, is at least `cut`.
fn coverage(level: &Level, cut: f32, factor: f32) -> f32 {
    let channels = level.channels();
    let opacity = opacity_channel(channels);
    let through = (0..level.height()).into_par_iter().map(|y| {
        let mut n = 0_u64;
        level.linear_row(y, |i, v| n += u64::from(i % channels == opacity && v * factor >= cut));
        n
    });
    through.sum::<u64>() as f32 / (level.width() * level.height()) as f32
}

fn opacity_channel(channels: usize) -> usize {
    if matches!(channels, 2 | 4) { channels - 1 } else { 0 }
}

/// Scales opacities such that the wanted share of them is at least `cut`: the factor brings the right quantile there.
fn keep_coverage(plane: &mut Plane, cut: f32, wanted: f32) {
    let opacity = opacity_channel(plane.channels);
    let mut all: Vec<f32> = plane.data.iter().skip(opacity).step_by(plane.channels).copied().collect();
    let n = all.len();
    let through = (wanted * n as f32).round() as usize;
    if through == 0 || through >= n {
        return;
    }
    all.sort_by(|a, b| b.total_cmp(a));
    // Between the last that is to pass and the first that is not.
    let at = 0.5 * (all[through - 1] + all[through]);
    if at > 0.0 {
        let factor = cut / at;
        plane.data.iter_mut().skip(opacity).step_by(plane.channels).for_each(|v| *v = (*v * factor).min(1.0));
    }
}
