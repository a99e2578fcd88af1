//! Stochastic filtering: one texel instead of a mean (Pharr, Wronski, Salvi, Fajardo, "Filtering After Shading with
//! Stochastic Texture Filtering", 2024).

use super::{
    detail::level_of,
    filter::{Filter, Source, extent, first_tap, lanes, longest_square},
    kernel::{SPLINE_TAPS, lanczos_weights, spline_weights},
    mapping::Coordinates2,
    store::{Level, on_level},
};
use steradian_math::{Vec2, Vec4, hash::mix32};

impl Source<'_> {
    /// One texel, drawn such that the mean over many draws is the filter's value. The random numbers are a hash of the
    /// place and `salt`.
    pub fn one_tap<const N: usize>(&self, filter: Filter, at: &Coordinates2, salt: u32, first: usize) -> [f32; N] {
        let mut random = Random::new(at.uv, salt);
        let base = self.levels.base();
        let linear = |t: f32| [1.0 - t, t];
        let choose_level = |length: f32, count: usize, random: &mut Random| {
            let (i, t) = level_of(length, count);
            i + usize::from(random.next() < t)
        };
        lanes(match filter {
            Filter::Nearest => self.nearest::<N>(base, at.uv, first),
            Filter::Bilinear => self.tap::<N, 2>(base, at.uv, first, &mut random, linear),
            Filter::Bicubic(cubic) => self.tap::<N, 4>(base, at.uv, first, &mut random, |t| cubic.weights(t)),
            Filter::Spline => self.tap::<N, SPLINE_TAPS>(base, at.uv, first, &mut random, spline_weights),
            // Exactness is what it is for.
            Filter::Sinc => self.sinc::<N>(base, at.uv, first),
            Filter::Lanczos => self.tap::<N, 6>(base, at.uv, first, &mut random, lanczos_weights),
            Filter::Trilinear => {
                let i = choose_level(longest_square(base, at).sqrt(), self.levels.counts().0, &mut random);
                self.tap::<N, 2>(self.levels.at(i, 0), at.uv, first, &mut random, linear)
            }
            Filter::Ripmap => {
                let ((columns, rows), extent) = (self.levels.counts(), extent(base, at));
                let i = choose_level(extent.x, columns, &mut random);
                let j = choose_level(extent.y, rows, &mut random);
                self.tap::<N, 2>(self.levels.at(i, j), at.uv, first, &mut random, linear)
            }
            Filter::Box => {
                let size = extent(base, at).max(Vec2::ONE) / base.scale();
                let offset = Vec2::new(random.next(), random.next()) - 0.5;
                self.nearest::<N>(base, at.uv + size * offset, first)
            }
            Filter::Ewa(anisotropy) => {
                let scale = base.scale();
                let (a, b) = ((at.dx * scale).length(), (at.dy * scale).length());
                let i = choose_level(a.min(b).max(a.max(b) / anisotropy), self.levels.counts().0, &mut random);
                // e^(-2r²) cut at r = 1: by the inverse of its radial distribution.
                let r = (-0.5 * (1.0 - random.next() * (1.0 - (-2.0_f32).exp())).ln()).max(0.0).sqrt();
                let (sin, cos) = (random.next() * std::f32::consts::TAU).sin_cos();
                let uv = at.uv + (at.dx * cos + at.dy * sin) * r;
                let uv = if uv.is_finite() { uv } else { at.uv };
                self.tap::<N, 2>(self.levels.at(i, 0), uv, first, &mut random, linear)
            }
        })
    }

    /// One of `K × K` texels by its weight; where weights are negative by their magnitude, times the sign.
    fn tap<const N: usize, const K: usize>(
        &self,
        level: &Level,
        uv: Vec2,
        first: usize,
        random: &mut Random,
        weights: impl Fn(f32) -> [f32; K],
    ) -> Vec4 {
        let ([x, y], t) = first_tap::<K>(level, uv);
        let mut choose = |t: f32| {
            let weights = weights(t);
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
            (chosen as i32, sum.copysign(weights[chosen]))
        };
        let ((i, wx), (j, wy)) = (choose(t.x), choose(t.y));
        on_level!(level, first, |view| self.texel::<N, _>(&mut view, level, [x + i, y + j], first)) * wx * wy
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
