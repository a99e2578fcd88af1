//! Elliptical weighted averages (Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989, § 3.5; M210).

#![expect(clippy::needless_range_loop, reason = "loops over lanes are unrolled for certain this way")]

use super::{
    filter::Source,
    integers::{FAR, ceil, floor, nearest},
    mapping::Coordinates2,
    store::{Level, View, on_level},
};
use steradian_math::{Mat4, Vec2, Vec4};

/// An ellipse in texels of a level: `a x² + b x y + c y² < 1` about its centre.
struct Ellipse {
    centre: Vec2,
    a: f32,
    b: f32,
    c: f32,
    /// Half of the extent in x and y.
    half: Vec2,
    /// Length of the longest cut along x, which is that through the centre.
    cut: f32,
    /// Shift of the midpoints of cuts along x for each step in y.
    slope: f32,
}

/// Largest extent that is filtered, in texels. Vast footprints are seen on the last level, which is small: this is out
/// of reach but for degenerate ones.
const MOST: f32 = 512.0;

impl Ellipse {
    /// With the given half axes in texels, the squares of which are made longer by `blur`; `None` if it is vast.
    #[inline(always)]
    fn new(centre: Vec2, s: Vec2, t: Vec2, blur: f32) -> Option<Self> {
        // Heckbert, eq. 3.6 and following, times f.
        let a = s.y * s.y + t.y * t.y + blur;
        let b = -2.0 * (s.x * s.y + t.x * t.y);
        let c = s.x * s.x + t.x * t.x + blur;
        let most = 0.25 * MOST * MOST;
        (a <= most && c <= most).then(|| {
            let f = a * c - 0.25 * b * b;
            let [by_f, by_a, ..] = (Vec4::ONE / Vec4::new(f, a, 1.0, 1.0)).to_array();
            let [x, y, cut, _] = Vec4::new(c, a, 4.0 * f * by_a, 1.0).map(f32::sqrt).to_array();
            Self {
                centre: centre.clamp(Vec2::splat(-FAR), Vec2::splat(FAR)),
                a: a * by_f,
                b: b * by_f,
                c: c * by_f,
                half: Vec2::new(x, y),
                cut,
                slope: -0.5 * b * by_a,
            }
        })
    }
}

impl Source<'_> {
    /// The mean over the footprint, an ellipse with half axes dx and dy, by a Gaussian that has fallen to e⁻² at its
    /// rim. It is taken on the level at which the shorter half axis is one to two texels long. Squares of the half axes
    /// are made longer by that of the shorter one, and by one texel at least: so that texels are joined to a continuous
    /// picture, and so that one level becomes the next without a step.
    #[inline(never)]
    pub(super) fn ewa<const N: usize>(&self, at: &Coordinates2, anisotropy: f32, first: usize) -> Vec4 {
        let base = self.levels.base();
        let scale = base.scale();
        let (x2, y2) = ((at.dx * scale).length_squared(), (at.dy * scale).length_squared());
        let (long, mut short, a2, mut b2) = if x2 < y2 { (at.dy, at.dx, y2, x2) } else { (at.dx, at.dy, x2, y2) };
        if !(b2 > 0.0 && a2.is_finite()) {
            return self.bilinear::<N>(base, at.uv, first);
        }
        // Ellipses that are too long are made wider.
        let least = a2 / (anisotropy * anisotropy);
        if b2 < least {
            short *= least.sqrt() / b2.sqrt();
            b2 = least;
        }
        let level = self.levels.of_square(b2);
        let scale = level.scale();
        let short = short * scale;
        let blur = short.length_squared().max(1.0);
        let Some(ellipse) = Ellipse::new(at.uv * scale - 0.5, long * scale, short, blur) else {
            return self.bilinear::<N>(self.levels.last(), at.uv, first);
        };
        if !ellipse.is_inside(level) {
            return self.mean_across_edges::<N>(&ellipse, level, first);
        }
        on_level!(level, first, |view| {
            let texels = &mut Inside(&mut view);
            if ellipse.cut <= 4.0 {
                ellipse.mean::<N, 4, 0>(1, texels)
            } else if ellipse.cut <= 6.0 {
                ellipse.mean::<N, 4, 2>(1, texels)
            } else {
                ellipse.mean::<N, 4, 4>(ellipse.strips(8.0), texels)
            }
        })
    }

    /// [`Ellipse::mean`] where texels may be outside of the picture.
    #[cold]
    #[inline(never)]
    fn mean_across_edges<const N: usize>(&self, ellipse: &Ellipse, level: &Level, first: usize) -> Vec4 {
        on_level!(level, first, |view| {
            ellipse.mean::<N, 4, 0>(ellipse.strips(4.0), &mut Across { view: &mut view, source: self, level, first })
        })
    }
}

/// Texels of a row, one in each lane, for each channel.
trait Row {
    /// `K` texels from `x`, `y` on to the right.
    fn lanes<const N: usize, const K: usize>(&mut self, x: i32, y: i32) -> [Vec4; N];
}

/// All are within the picture.
struct Inside<'v, V>(&'v mut V);

impl<'a, V: View<'a>> Row for Inside<'_, V> {
    #[inline(always)]
    fn lanes<const N: usize, const K: usize>(&mut self, x: i32, y: i32) -> [Vec4; N] {
        self.0.lanes::<N, K>(x as usize, y as usize)
    }
}

/// Some may be outside.
struct Across<'v, V> {
    view: &'v mut V,
    source: &'v Source<'v>,
    level: &'v Level,
    first: usize,
}

impl<'a, V: View<'a>> Row for Across<'_, V> {
    #[inline]
    fn lanes<const N: usize, const K: usize>(&mut self, x: i32, y: i32) -> [Vec4; N] {
        let mut strip = [Vec4::ZERO; 4];
        for k in 0..K {
            strip[k] = self.source.texel::<N, V>(self.view, self.level, [x + k as i32, y], self.first);
        }
        let strip = Mat4::from_cols(strip[0], strip[1], strip[2], strip[3]).transpose();
        std::array::from_fn(|c| strip.col(c))
    }
}

impl Ellipse {
    /// Number of strips of `length` texels that together are as long as the longest cut.
    fn strips(&self, length: f32) -> i32 {
        ceil(self.cut / length)
    }

    /// True if all texels that [`Self::mean`] looks at are within the picture.
    #[inline(always)]
    fn is_inside(&self, level: &Level) -> bool {
        // Strips are longer than the cut by less than eight texels, half of which are on either side, and begin at the
        // nearest texel.
        let reach = Vec2::new(self.half.x + 5.0, self.half.y) + 1.0;
        (self.centre - reach).cmpge(Vec2::ZERO).all() && (self.centre + reach).cmplt(level.scale()).all()
    }

    /// The weighted mean of the texels inside, row by row in strips of `K + L` texels, of which there are as many as
    /// the longest cut takes: some texels have no weight, but processors need not guess where rows end.
    #[inline(always)]
    fn mean<const N: usize, const K: usize, const L: usize>(&self, strips: i32, texels: &mut impl Row) -> Vec4 {
        let &Self { centre, a, b, c, half, slope, .. } = self;
        let to_start = centre.x - 0.5 * (((K + L) as i32 * strips) as f32 - 1.0);
        let (mut sum, mut total) = ([Vec4::ZERO; N], Vec4::ZERO);
        for row in ceil(centre.y - half.y)..=floor(centre.y + half.y) {
            let y = row as f32 - centre.y;
            let mut start = nearest(to_start + slope * y);
            let (by, cyy) = (Vec4::splat(b * y), Vec4::splat(c * y * y));
            for _ in 0..strips {
                let x = Vec4::splat(start as f32 - centre.x) + Vec4::new(0.0, 1.0, 2.0, 3.0);
                let weight = |x: Vec4| gaussian((x * a + by) * x + cyy);
                let low = weight(x);
                total += low;
                let strip = texels.lanes::<N, K>(start, row);
                for c in 0..N {
                    sum[c] += strip[c] * low;
                }
                if L > 0 {
                    let high = weight(x + 4.0);
                    total += high;
                    let strip = texels.lanes::<N, L>(start + 4, row);
                    for c in 0..N {
                        sum[c] += strip[c] * high;
                    }
                }
                start += (K + L) as i32;
            }
        }
        // Sums over lanes: the columns are channels, and the weights where there is room.
        let mut columns = [total; 4];
        columns[..N].copy_from_slice(&sum);
        let rows = Mat4::from_cols(columns[0], columns[1], columns[2], columns[3]).transpose();
        let sums = (rows.x_axis + rows.y_axis) + (rows.z_axis + rows.w_axis);
        // A texel's centre is always near, so there is some weight.
        sums * (1.0 / if N < 4 { sums.w } else { total.element_sum() })
    }
}

/// `e^(-2 r²) − e^(-2)` of r² to 2·10⁻⁵ (a minimax polynomial), zero from r = 1 on.
#[inline(always)]
fn gaussian(r2: Vec4) -> Vec4 {
    const Q: [f32; 5] = [0.864_646_5, -1.133_998_9, 0.849_601_5, -0.409_975_97, 0.101_190_335];
    let x = r2.min(Vec4::ONE);
    (Vec4::ONE - x) * ((((x * Q[4] + Q[3]) * x + Q[2]) * x + Q[1]) * x + Q[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaussians_are_near_the_exact_ones() {
        for i in 0..=4000 {
            let r2 = i as f32 / 3000.0;
            let wanted = ((-2.0 * f64::from(r2)).exp() - (-2.0_f64).exp()).max(0.0);
            let seen = gaussian(Vec4::splat(r2)).x;
            assert!((f64::from(seen) - wanted).abs() < 2e-5 && seen >= 0.0, "{r2}: {seen} {wanted}");
        }
        assert_eq!(gaussian(Vec4::splat(f32::INFINITY)), Vec4::ZERO);
    }
}
