//! Summed-area tables (Crow, "Summed-Area Tables for Texture Mapping", SIGGRAPH 1984; M211): means over any rectangle
//! along the axes, from four sums. Sums are 64-bit floats, and exclude the row and column that they are named by, so
//! that no index is off by one.

use super::{
    store::Level,
    wrap::{Borders, Wrap},
};

/// Sums over all rectangles that begin at the top left.
#[derive(Clone, Debug)]
pub struct SummedArea {
    width: usize,
    height: usize,
    channels: usize,
    /// `(width + 1) × (height + 1)` sums of what lies left of and above a texel's corner.
    sums: Vec<f64>,
}

/// A coordinate as places in the table with factors: the integral from 0 to a point outside is a sum of such inside.
type Places = [(f64, f64); 3];

impl SummedArea {
    /// Sums a picture up.
    pub fn new(level: &Level) -> Self {
        let (width, height, channels) = (level.width(), level.height(), level.channels());
        let stride = (width + 1) * channels;
        let mut sums = vec![0.0; stride * (height + 1)];
        let mut row = vec![0.0; channels];
        for y in 0..height {
            row.fill(0.0);
            let (above, below) = sums.split_at_mut((y + 1) * stride);
            let above = &above[y * stride..];
            level.linear_row(y, |i, v| {
                row[i % channels] += f64::from(v);
                below[i + channels] = above[i + channels] + row[i % channels];
            });
        }
        Self { width, height, channels, sums }
    }

    /// Bytes held.
    pub fn byte_size(&self) -> usize {
        self.sums.len() * size_of::<f64>()
    }

    /// The integral over `[0, x) × [0, y)`, in texels, where each texel is a constant square.
    fn integral<const N: usize>(&self, x: f64, y: f64, first: usize) -> [f64; N] {
        let (x0, y0) = (x.floor().min(self.width as f64 - 1.0), y.floor().min(self.height as f64 - 1.0));
        let (tx, ty) = (x - x0, y - y0);
        let at = |dx: usize, dy: usize, c: usize| {
            self.sums[((y0 as usize + dy) * (self.width + 1) + x0 as usize + dx) * self.channels + first + c]
        };
        std::array::from_fn(|c| {
            (at(0, 0, c) * (1.0 - tx) + at(1, 0, c) * tx) * (1.0 - ty)
                + (at(0, 1, c) * (1.0 - tx) + at(1, 1, c) * tx) * ty
        })
    }

    /// The mean over the rectangle of the given centre and size, in texels. Octahedral maps are taken for mirrored
    /// ones.
    pub fn mean<const N: usize>(
        &self,
        centre: [f64; 2],
        size: [f64; 2],
        wrap: [Wrap; 2],
        borders: &Borders,
        first: usize,
    ) -> [f32; N] {
        if self.width == 0 || self.height == 0 {
            return [0.0; N];
        }
        let ends = |k: usize, n: usize| {
            // From afar a picture that does not repeat looks as from a little less afar, and sums stay exact.
            let far = n as f64 + size[k];
            let centre = match wrap[k] {
                Wrap::Clamp | Wrap::Border => centre[k].clamp(-far, 2.0 * far),
                Wrap::Repeat | Wrap::Mirror | Wrap::Octahedral => centre[k],
            };
            let (a, b) = (centre - 0.5 * size[k], centre + 0.5 * size[k]);
            (places(wrap[k], a, n as f64), places(wrap[k], b, n as f64))
        };
        let ((x0, x1), (y0, y1)) = (ends(0, self.width), ends(1, self.height));
        let mut sum = [0.0; N];
        for (sign, xs, ys) in [(1.0, x1, y1), (-1.0, x0, y1), (-1.0, x1, y0), (1.0, x0, y0)] {
            for (x, fx) in xs.into_iter().filter(|p| p.1 != 0.0) {
                for (y, fy) in ys.into_iter().filter(|p| p.1 != 0.0) {
                    let part = self.integral::<N>(x, y, first);
                    (0..N).for_each(|c| sum[c] += sign * fx * fy * part[c]);
                }
            }
        }
        // How much of the rectangle lies beyond the borders.
        let inside = |k: usize, [a, b]: [Places; 2]| {
            if wrap[k] == Wrap::Border { (b[0].0 - a[0].0) / size[k] } else { 1.0 }
        };
        let (across, down) = (inside(0, [x0, x1]), inside(1, [y0, y1]));
        std::array::from_fn(|c| {
            let border = |axis: usize| f64::from(borders[axis][first + c]);
            let outside = border(0) * (1.0 - across) + border(1) * across * (1.0 - down);
            (sum[c] / (size[0] * size[1]) + outside) as f32
        })
    }
}

/// Positions in the table that make up `∫₀ˣ` of a row of `n` texels continued by `wrap`: pairs of position and factor.
fn places(wrap: Wrap, x: f64, n: f64) -> Places {
    const NONE: (f64, f64) = (0.0, 0.0);
    match wrap {
        Wrap::Border => [(x.clamp(0.0, n), 1.0), NONE, NONE],
        Wrap::Clamp if x < 0.0 => [(1.0, x), NONE, NONE],
        Wrap::Clamp if x > n => [(n, 1.0 + (x - n)), (n - 1.0, -(x - n)), NONE],
        Wrap::Clamp => [(x, 1.0), NONE, NONE],
        Wrap::Repeat => {
            let periods = (x / n).floor();
            [(x - periods * n, 1.0), (n, periods), NONE]
        }
        Wrap::Mirror | Wrap::Octahedral => {
            let periods = (x / (2.0 * n)).floor();
            let r = x - periods * 2.0 * n;
            // The way back: what is left of the second half is missing from it.
            if r <= n {
                [(r, 1.0), (n, 2.0 * periods), NONE]
            } else {
                [(n, 2.0 * periods + 2.0), (2.0 * n - r, -1.0), NONE]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use steradian_image::{Encoding, TexelData, Texels};

    /// E44: with sums that include what they are named by, rectangles lose their first row and column; here a rectangle
    /// of one texel has that texel's value, also after sums of 2²⁴ and more, where 32-bit floats no longer count by
    /// one.
    #[test]
    fn single_texels_come_back() {
        let (width, height) = (64, 48);
        let value = |i: usize| if i.is_multiple_of(7) { 1.0 } else { 1e6 };
        let texels = Texels {
            width,
            height,
            channels: 1,
            data: TexelData::F32((0..width * height).map(value).collect()),
            encoding: Encoding::Linear,
            metadata: Default::default(),
        };
        let table = SummedArea::new(&Level::new(Arc::new(texels), None).unwrap());
        for i in 0..width * height {
            let centre = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
            let [seen]: [f32; 1] = table.mean(centre, [1.0; 2], [Wrap::Clamp; 2], &crate::wrap::BLACK, 0);
            assert_eq!(seen, value(i), "{i}");
        }
    }

    /// M211: means are exact against brute force, for every wrap and rectangles at quarters of texels.
    #[test]
    fn means_agree_with_brute_force() {
        let (width, height) = (7, 5);
        let value = |x: usize, y: usize, c: usize| ((x * 31 + y * 17 + c * 7) % 23) as f32;
        let data = (0..width * height * 2).map(|i| value(i / 2 % width, i / 2 / width, i % 2)).collect();
        let texels = Texels {
            width,
            height,
            channels: 2,
            data: TexelData::F32(data),
            encoding: Encoding::Linear,
            metadata: Default::default(),
        };
        let table = SummedArea::new(&Level::new(Arc::new(texels), None).unwrap());
        let borders = [[0.25, 0.5, 0.0, 0.0], [8.0, 9.0, 0.0, 0.0]];
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Border] {
            for k in 0..60_i64 {
                // Corners in quarters of texels.
                let (x0, y0) = (k * 13 % 90 - 45, k * 29 % 70 - 35);
                let (w, h) = (1 + k * 7 % 50, 1 + k * 11 % 60);
                let mut sum = [0.0_f64; 2];
                for y in y0..y0 + h {
                    for x in x0..x0 + w {
                        let at = [x.div_euclid(4) as i32, y.div_euclid(4) as i32];
                        let place = Wrap::place([wrap; 2], at, [width, height]);
                        let of = |c: usize| place.map_or_else(|axis| borders[axis][c], |[x, y]| value(x, y, c));
                        (0..2).for_each(|c| sum[c] += f64::from(of(c)));
                    }
                }
                let at = |a: i64, n: i64| (a as f64 + n as f64 * 0.5) / 4.0;
                let size = [w as f64 / 4.0, h as f64 / 4.0];
                let seen: [f32; 2] = table.mean([at(x0, w), at(y0, h)], size, [wrap; 2], &borders, 0);
                for c in 0..2 {
                    let wanted = sum[c] / (w * h) as f64;
                    assert!((f64::from(seen[c]) - wanted).abs() < 1e-5, "{wrap:?} {k}: {seen:?} {wanted}");
                }
            }
        }
    }
}
