//! Elliptical weighted averages (Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989, § 3.5; M210).

#![allow(clippy::needless_range_loop, reason = "loops over lanes are unrolled for certain this way")]

use super::{
    detail::level_of_square,
    filter::{Source, mix},
    mapping::Coordinates2,
    store::{Level, View, on_level},
    whole::{FAR, ceil, floor, nearest},
};
use glam::Vec4;
use steradian_math::Vec2;

/// An ellipse in texels of a level: `a x² + b x y + c y² < 1` about its centre.
struct Ellipse {
    centre: Vec2,
    a: f32,
    b: f32,
    c: f32,
    /// Half of the extent in x and y.
    half: Vec2,
    /// Length of the longest cut along x.
    cut: f32,
}

/// Largest extent that is filtered, in texels. Vast footprints are seen on the last level, which is small: this is out
/// of reach but for degenerate ones.
const MOST: f32 = 512.0;

impl Ellipse {
    /// With the given half axes in texels, made wider by a texel, in which texels are joined to a continuous picture;
    /// `None` if it is vast.
    #[inline(always)]
    fn new(centre: Vec2, s: Vec2, t: Vec2) -> Option<Self> {
        // Heckbert, eq. 3.6 and following, times f.
        let a = s.y * s.y + t.y * t.y + 1.0;
        let b = -2.0 * (s.x * s.y + t.x * t.y);
        let c = s.x * s.x + t.x * t.x + 1.0;
        let most = 0.25 * MOST * MOST;
        (a <= most && c <= most).then(|| {
            let f = a * c - 0.25 * b * b;
            let inverse = 1.0 / f;
            Self {
                centre: centre.clamp(Vec2::splat(-FAR), Vec2::splat(FAR)),
                a: a * inverse,
                b: b * inverse,
                c: c * inverse,
                half: Vec2::new(c.sqrt(), a.sqrt()),
                cut: 2.0 * (f / a).sqrt(),
            }
        })
    }
}

impl Source<'_> {
    /// The mean over the footprint, an ellipse with half axes dx and dy, by a Gaussian that has fallen to e⁻² at its
    /// rim.
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
        let (i, t) = level_of_square(b2, self.levels.counts().0);
        let near = self.ellipse::<N>(i, at.uv, long, short, first);
        mix(near, t, || self.ellipse::<N>(i + 1, at.uv, long, short, first))
    }

    /// The mean over an ellipse with the given half axes (in periods) on one level.
    #[inline(never)]
    fn ellipse<const N: usize>(&self, i: usize, uv: Vec2, long: Vec2, short: Vec2, first: usize) -> Vec4 {
        let level = self.levels.at(i, 0);
        let scale = level.scale();
        let Some(ellipse) = Ellipse::new(uv * scale - 0.5, long * scale, short * scale) else {
            return self.bilinear::<N>(self.levels.at(self.levels.counts().0 - 1, 0), uv, first);
        };
        on_level!(level, first, |view| {
            if ellipse.cut <= 4.0 {
                self.strips::<N, 4, _>(&mut view, &ellipse, level)
            } else if ellipse.cut <= 6.0 {
                self.strips::<N, 6, _>(&mut view, &ellipse, level)
            } else {
                self.strips::<N, 8, _>(&mut view, &ellipse, level)
            }
        })
    }

    /// The weighted mean of the texels inside, row by row in strips of `K` texels, which are as long as the longest
    /// cut: some texels have no weight, but processors need not guess where rows end.
    #[inline(always)]
    fn strips<const N: usize, const K: usize, V: View>(&self, view: &mut V, ellipse: &Ellipse, level: &Level) -> Vec4 {
        let &Ellipse { centre, a, b, c, half, cut } = ellipse;
        let strips = if K == 8 { ceil(cut / 8.0) } else { 1 };
        let length = (K as i32 * strips) as f32;
        let reach = Vec2::new(half.x + 0.5 * length, half.y) + 1.0;
        let is_inside = (centre - reach).cmpge(Vec2::ZERO).all() && (centre + reach).cmplt(level.scale()).all();
        let slope = -0.5 * b / a;
        let to_start = centre.x - 0.5 * (length - 1.0);
        let mut sum = Vec4::ZERO;
        let mut total = Vec4::ZERO;
        for row in ceil(centre.y - half.y)..=floor(centre.y + half.y) {
            let y = row as f32 - centre.y;
            let mut start = nearest(to_start + slope * y);
            for _ in 0..strips {
                let x = Vec4::splat(start as f32 - centre.x) + Vec4::new(0.0, 1.0, 2.0, 3.0);
                let weight = |x: Vec4| gaussian((x * a + b * y) * x + c * y * y);
                let (low, mut high) = (weight(x), Vec4::ZERO);
                if K > 4 {
                    high = weight(x + 4.0);
                }
                total += low + high;
                let (low, high) = (low.to_array(), high.to_array());
                let strip = if is_inside {
                    view.strip::<N, K>(start as usize, row as usize)
                } else {
                    self.across::<N, K, V>(view, level, start, row)
                };
                let mut parts = [Vec4::ZERO; 2];
                for k in 0..K {
                    parts[k % 2] += strip[k] * if k < 4 { low[k % 4] } else { high[k % 4] };
                }
                sum += parts[0] + parts[1];
                start += K as i32;
            }
        }
        // A texel's centre is always near, so there is some weight.
        sum * (1.0 / total.element_sum())
    }

    /// A strip of texels some of which may be outside of the picture.
    #[cold]
    #[inline(never)]
    fn across<const N: usize, const K: usize, V: View>(
        &self,
        view: &mut V,
        level: &Level,
        start: i32,
        row: i32,
    ) -> [Vec4; K] {
        let mut strip = [Vec4::ZERO; K];
        if let Some(row) = self.wrap[1].apply(row, level.height()) {
            for k in 0..K {
                if let Some(column) = self.wrap[0].apply(start + k as i32, level.width()) {
                    strip[k] = view.texel::<N>(column, row);
                }
            }
        }
        strip
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
