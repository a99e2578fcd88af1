//! Texture filters: what value a footprint gets (M202, M203, M209 to M211).
//!
//! Coordinates of lookups are in periods of the picture, (0, 0) its top left corner; texel centres are at half-integers
//!, and levels of detail follow from derivatives in texels, not in periods.
//!
//! Filters that average have smaller levels of the picture in the same precision, averaged in linear values, and ask
//! for a *footprint*: the change of point and parameters from sample to sample. Ray differentials give it through
//! mirrors and glass, and through lobes within about 10° of a mirror's. After the first event with more blur, as in
//! pbrt, it is that of the camera seeing the point directly. Scenes without filtered textures carry no footprints, and
//! pay one branch.

#![expect(clippy::needless_range_loop, reason = "loops over lanes are unrolled for certain this way")]

pub use super::detail::level_of;
use super::{
    detail::level_of_square,
    integers::{before, split},
    kernel::{Cubic, SPLINE_TAPS, lanczos_weights, periodic_sinc_weights, spline_weights},
    levels::Levels,
    mapping::Coordinates2,
    store::{Level, View, on_level},
    summed::SummedArea,
    wrap::{Borders, Wrap},
};
use steradian_math::{Vec2, Vec4};

/// Filter of a picture lookup.
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
    /// The cubic spline through the texels, which is exact for cubics.
    Spline,
    /// The periodic sinc over all texels, which is exact for what is band-limited (Whittaker, Shannon).
    Sinc,
    /// Linear between the nearest 2 × 2 of the two levels whose texels are about as large as the footprint is long.
    Trilinear,
    /// Linear between levels of a ripmap whose texels are about as wide and as high as the footprint's box.
    Ripmap,
    /// The mean over the footprint's box, from a summed-area table.
    Box,
    /// An elliptical Gaussian over the footprint (Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989,
    /// § 3.5), on the level at which its shorter half axis is one to two texels long. Footprints that are longer than
    /// this many times their width are made wider.
    Ewa(f32),
}

/// The filters by name.
pub const FILTERS: [(&str, Filter); 13] = [
    ("nearest", Filter::Nearest),
    ("bilinear", Filter::Bilinear),
    ("bicubic", Filter::Bicubic(Cubic::Mitchell)),
    ("mitchell", Filter::Bicubic(Cubic::Mitchell)),
    ("bspline", Filter::Bicubic(Cubic::BSpline)),
    ("catmull_rom", Filter::Bicubic(Cubic::CatmullRom)),
    ("lanczos", Filter::Lanczos),
    ("spline", Filter::Spline),
    ("sinc", Filter::Sinc),
    ("trilinear", Filter::Trilinear),
    ("ripmap", Filter::Ripmap),
    ("box", Filter::Box),
    ("ewa", Filter::Ewa(8.0)),
];

impl Filter {
    /// True if the filter averages over footprints.
    pub fn is_prefiltered(self) -> bool {
        matches!(self, Self::Trilinear | Self::Ripmap | Self::Box | Self::Ewa(_))
    }
}

/// Data that filters read.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The picture and its smaller sizes.
    pub levels: &'a Levels,
    /// Its sums, for [`Filter::Box`].
    pub sums: Option<&'a SummedArea>,
    /// Wrap mode on each axis.
    pub wrap: [Wrap; 2],
    /// The colours of borders.
    pub borders: &'a Borders,
}

impl Source<'_> {
    /// The filtered linear values of `N` channels from `first` on; at most four.
    #[inline]
    pub fn lookup<const N: usize>(&self, filter: Filter, at: &Coordinates2, first: usize) -> [f32; N] {
        let base = self.levels.base();
        let values = match filter {
            Filter::Nearest => self.nearest::<N>(base, at.uv, first),
            Filter::Bilinear => self.bilinear::<N>(base, at.uv, first),
            Filter::Bicubic(cubic) => self.bicubic::<N>(base, at.uv, first, cubic),
            Filter::Lanczos => self.lanczos::<N>(base, at.uv, first),
            Filter::Spline => self.spline::<N>(base, at.uv, first),
            Filter::Sinc => self.sinc::<N>(base, at.uv, first),
            Filter::Trilinear => self.trilinear::<N>(at, first),
            Filter::Ripmap => self.ripmap::<N>(at, first),
            Filter::Box => match self.sums {
                Some(sums) => return self.boxed(sums, at, first),
                None => self.bilinear::<N>(base, at.uv, first),
            },
            Filter::Ewa(anisotropy) => self.ewa::<N>(at, anisotropy, first),
        };
        lanes(values)
    }

    #[inline(never)]
    pub(super) fn nearest<const N: usize>(&self, level: &Level, uv: Vec2, first: usize) -> Vec4 {
        let ([x, y, ..], _) = split((uv * level.scale()).extend(0.0).extend(0.0));
        match Wrap::place(self.wrap, [x, y], [level.width(), level.height()]) {
            Ok([x, y]) => on_level!(level, first, |view| view.texel::<N>(x, y)),
            Err(axis) => self.border::<N>(axis, first),
        }
    }

    #[inline(never)]
    pub(super) fn bilinear<const N: usize>(&self, level: &Level, uv: Vec2, first: usize) -> Vec4 {
        let ([x, y, ..], t) = before((uv * level.scale()).extend(0.0).extend(0.0));
        if !(is_inside::<2>(x, level.width()) && is_inside::<2>(y, level.height())) {
            return self.across_edges::<N, 2>(level, uv, first, linear_weights);
        }
        on_level!(level, first, |view| {
            let square = view.square::<N>(x as usize, y as usize);
            interpolate(&square, [Vec4::splat(t.x), Vec4::splat(t.y)])
        })
    }

    #[inline(never)]
    fn bicubic<const N: usize>(&self, level: &Level, uv: Vec2, first: usize, cubic: Cubic) -> Vec4 {
        self.separable::<N, 4>(level, uv, first, |t| cubic.weights(t))
    }

    #[inline(never)]
    fn lanczos<const N: usize>(&self, level: &Level, uv: Vec2, first: usize) -> Vec4 {
        self.separable::<N, 6>(level, uv, first, lanczos_weights)
    }

    #[inline(never)]
    pub(super) fn spline<const N: usize>(&self, level: &Level, uv: Vec2, first: usize) -> Vec4 {
        self.separable::<N, SPLINE_TAPS>(level, uv, first, spline_weights)
    }

    /// All texels, each with a product of two weights.
    #[inline(never)]
    pub(super) fn sinc<const N: usize>(&self, level: &Level, uv: Vec2, first: usize) -> Vec4 {
        let place = uv * level.scale() - 0.5;
        let across = periodic_sinc_weights(place.x, level.width());
        let down = periodic_sinc_weights(place.y, level.height());
        on_level!(level, first, |view| {
            let mut sum = Vec4::ZERO;
            for (y, v) in down.iter().enumerate() {
                for (x, u) in across.iter().enumerate() {
                    sum += view.texel::<N>(x, y) * (u * v);
                }
            }
            sum
        })
    }

    #[inline(never)]
    fn trilinear<const N: usize>(&self, at: &Coordinates2, first: usize) -> Vec4 {
        let base = self.levels.base();
        let Some((i, t)) = level_of_square(longest_square(base, at)) else {
            return self.bilinear::<N>(base, at.uv, first);
        };
        let Some([near, far]) = self.levels.pair(i) else {
            return self.bilinear::<N>(self.levels.last(), at.uv, first);
        };
        // Both places at once.
        let (p, q) = (at.uv * near.scale(), at.uv * far.scale());
        let ([x, y, u, v], s) = before(Vec4::new(p.x, p.y, q.x, q.y));
        if !(is_inside::<2>(x, near.width())
            && is_inside::<2>(y, near.height())
            && is_inside::<2>(u, far.width())
            && is_inside::<2>(v, far.height()))
        {
            let near = self.bilinear::<N>(near, at.uv, first);
            return near * (1.0 - t) + self.bilinear::<N>(far, at.uv, first) * t;
        }
        on_level!(near, first, |view| {
            let Some(mut other) = view.of(far) else { return Vec4::ZERO };
            let squares = view.squares::<N>([x as usize, y as usize], &mut other, [u as usize, v as usize]);
            let near = interpolate(&squares[0], [Vec4::splat(s.x), Vec4::splat(s.y)]);
            let far = interpolate(&squares[1], [Vec4::splat(s.z), Vec4::splat(s.w)]);
            near * (1.0 - t) + far * t
        })
    }

    #[inline(never)]
    fn ripmap<const N: usize>(&self, at: &Coordinates2, first: usize) -> Vec4 {
        let (columns, rows) = self.levels.counts();
        let extent = extent(self.levels.base(), at);
        let ((i, s), (j, t)) = (level_of(extent.x, columns), level_of(extent.y, rows));
        let on = |i: usize, j: usize| self.bilinear::<N>(self.levels.at(i, j), at.uv, first);
        let along = |j: usize| mix(on(i, j), s, || on(i + 1, j));
        mix(along(j), t, || along(j + 1))
    }

    #[inline(never)]
    fn boxed<const N: usize>(&self, sums: &SummedArea, at: &Coordinates2, first: usize) -> [f32; N] {
        let base = self.levels.base();
        let size = extent(base, at).max(Vec2::ONE).min(Vec2::splat(1e6));
        let centre = at.uv * base.scale();
        sums.mean(centre.as_dvec2().into(), size.as_dvec2().into(), self.wrap, self.borders, first)
    }

    /// `K × K` texels with weights that are products; `weights` is for a point that lies `t` beyond the texel before
    /// it.
    #[inline(always)]
    fn separable<const N: usize, const K: usize>(
        &self,
        level: &Level,
        uv: Vec2,
        first: usize,
        weights: impl Fn(f32) -> [f32; K],
    ) -> Vec4 {
        let ([x, y], t) = first_tap::<K>(level, uv);
        if !(is_inside::<K>(x, level.width()) && is_inside::<K>(y, level.height())) {
            return self.across_edges::<N, K>(level, uv, first, weights);
        }
        let (across, down) = (weights(t.x), weights(t.y));
        on_level!(level, first, |view| {
            let mut sum = Vec4::ZERO;
            for j in 0..K {
                sum += mean(&view.strip::<N, K>(x as usize, y as usize + j), &across) * down[j];
            }
            sum
        })
    }

    /// [`Self::separable`] for texels some of which are outside.
    #[cold]
    #[inline(never)]
    fn across_edges<const N: usize, const K: usize>(
        &self,
        level: &Level,
        uv: Vec2,
        first: usize,
        weights: impl Fn(f32) -> [f32; K],
    ) -> Vec4 {
        let ([x, y], t) = first_tap::<K>(level, uv);
        let (across, down) = (weights(t.x), weights(t.y));
        on_level!(level, first, |view| {
            let mut sum = Vec4::ZERO;
            for j in 0..K {
                let mut strip = [Vec4::ZERO; K];
                for k in 0..K {
                    strip[k] = self.texel::<N, _>(&mut view, level, [x + k as i32, y + j as i32], first);
                }
                sum += mean(&strip, &across) * down[j];
            }
            sum
        })
    }

    /// Texel at a position that may be outside of the picture.
    #[inline]
    pub(super) fn texel<'a, const N: usize, V: View<'a>>(
        &self,
        view: &mut V,
        level: &Level,
        at: [i32; 2],
        first: usize,
    ) -> Vec4 {
        match Wrap::place(self.wrap, at, [level.width(), level.height()]) {
            Ok([x, y]) => view.texel::<N>(x, y),
            Err(axis) => self.border::<N>(axis, first),
        }
    }

    /// The colour beyond the ends of an axis.
    fn border<const N: usize>(&self, axis: usize, first: usize) -> Vec4 {
        let mut values = [0.0; 4];
        values[..N].copy_from_slice(&self.borders[axis][first..first + N]);
        Vec4::from_array(values)
    }
}

#[inline(always)]
fn linear_weights(t: f32) -> [f32; 2] {
    [1.0 - t, t]
}

/// The first of the `K × K` texels around a place, and how far it is beyond the one before it.
#[inline(always)]
pub(super) fn first_tap<const K: usize>(level: &Level, uv: Vec2) -> ([i32; 2], Vec2) {
    let ([x, y, ..], t) = split((uv * level.scale() - 0.5).extend(0.0).extend(0.0));
    let before = K as i32 / 2 - 1;
    ([x - before, y - before], t.truncate().truncate())
}

#[inline(always)]
fn is_inside<const K: usize>(start: i32, n: usize) -> bool {
    // Negative numbers are large ones without sign.
    start as u32 as usize + K <= n
}

/// Linear between four texels, row by row, for places in each lane's square.
#[inline(always)]
fn interpolate(square: &[Vec4; 4], [x, y]: [Vec4; 2]) -> Vec4 {
    let along = |a: Vec4, b: Vec4| a * (Vec4::ONE - x) + b * x;
    along(square[0], square[1]) * (Vec4::ONE - y) + along(square[2], square[3]) * y
}

#[inline(always)]
fn mean<const K: usize>(texels: &[Vec4; K], weights: &[f32; K]) -> Vec4 {
    let mut mean = texels[0] * weights[0];
    for k in 1..K {
        mean += texels[k] * weights[k];
    }
    mean
}

/// The first lanes.
#[inline(always)]
pub(super) fn lanes<const N: usize>(values: Vec4) -> [f32; N] {
    let values = values.to_array();
    let mut first = [0.0; N];
    first.copy_from_slice(&values[..N]);
    first
}

/// Square of the length of the longer side of the footprint, in texels.
#[inline]
pub(super) fn longest_square(base: &Level, at: &Coordinates2) -> f32 {
    let scale = base.scale();
    let (x, y) = ((at.dx * scale).length_squared(), (at.dy * scale).length_squared());
    if x > y { x } else { y }
}

/// Size of the box around the footprint, a parallelogram with these sides, in texels.
#[inline]
pub(super) fn extent(base: &Level, at: &Coordinates2) -> Vec2 {
    (at.dx.abs() + at.dy.abs()) * base.scale()
}

#[inline(always)]
pub(super) fn mix(near: Vec4, t: f32, far: impl FnOnce() -> Vec4) -> Vec4 {
    if t == 0.0 { near } else { near * (1.0 - t) + far() * t }
}
