//! Pictures as textures: kept in the file's precision, decoded at lookup.

use super::{Mapping, TextureContext};
use steradian_image::{TexelData, Texels};
use steradian_math::{Vec2, Vec3};

/// What lies outside of the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// Its mirror image.
    Mirror,
    /// The nearest edge texel.
    Clamp,
    /// Black.
    Black,
}

impl Wrap {
    /// By name.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "repeat" => Self::Repeat,
            "mirror" => Self::Mirror,
            "clamp" => Self::Clamp,
            "black" => Self::Black,
            _ => return None,
        })
    }

    /// The texel that stands at index `i` of `n`; `None` for black.
    #[inline]
    pub fn apply(self, i: i64, n: usize) -> Option<usize> {
        let n = n as i64;
        if (0..n).contains(&i) {
            return Some(i as usize);
        }
        match self {
            Self::Repeat => Some(i.rem_euclid(n) as usize),
            Self::Mirror => {
                let k = i.rem_euclid(2 * n);
                Some(if k < n { k } else { 2 * n - 1 - k } as usize)
            }
            Self::Clamp => Some(i.clamp(0, n - 1) as usize),
            Self::Black => None,
        }
    }
}

/// A picture with everything its lookup needs.
#[derive(Clone, Debug)]
pub struct ImageTexture {
    /// The picture.
    pub texels: std::sync::Arc<Texels>,
    /// Linear values of 8-bit codes.
    pub decode: Box<[f32; 256]>,
    /// Horizontal wrap.
    pub wrap_u: Wrap,
    /// Vertical wrap.
    pub wrap_v: Wrap,
    /// The nearest texel instead of bilinear interpolation.
    pub nearest: bool,
    /// Row 0 of the file is at v = 1 (as pbrt has it).
    pub origin_bottom: bool,
    /// Factor on the values.
    pub scale: f32,
    /// `1 − value`, after the scale.
    pub invert: bool,
    /// Where lookups take place.
    pub mapping: Mapping,
}

impl ImageTexture {
    #[inline]
    fn texel(&self, x: usize, y: usize, c: usize) -> f32 {
        let t = &*self.texels;
        let i = (y * t.width + x) * t.channels + c;
        match &t.data {
            TexelData::U8(d) => self.decode[d[i] as usize],
            _ => t.linear(x, y, c),
        }
    }

    /// The interpolated linear values of `N` channels (channel indices given), before scale and inversion.
    #[inline]
    fn lookup<const N: usize>(&self, uv: Vec2, channels: [usize; N]) -> [f32; N] {
        let (w, h) = (self.texels.width, self.texels.height);
        let v = if self.origin_bottom { 1.0 - uv.y } else { uv.y };
        let (x, y) = (uv.x * w as f32, v * h as f32);
        let fetch = |x: i64, y: i64| -> [f32; N] {
            match (self.wrap_u.apply(x, w), self.wrap_v.apply(y, h)) {
                (Some(x), Some(y)) => channels.map(|c| self.texel(x, y, c)),
                _ => [0.0; N],
            }
        };
        if self.nearest {
            return fetch(x.floor() as i64, y.floor() as i64);
        }
        // Texel centres are at half-integers; weights belong to the other end (E37).
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (dx, dy) = (x - x0, y - y0);
        let (x0, y0) = (x0 as i64, y0 as i64);
        let (a, b) = (fetch(x0, y0), fetch(x0.saturating_add(1), y0));
        let (c, d) = (fetch(x0, y0.saturating_add(1)), fetch(x0.saturating_add(1), y0.saturating_add(1)));
        std::array::from_fn(|i| (a[i] * (1.0 - dx) + b[i] * dx) * (1.0 - dy) + (c[i] * (1.0 - dx) + d[i] * dx) * dy)
    }

    #[inline]
    fn finish(&self, v: f32) -> f32 {
        let v = v * self.scale;
        if self.invert { (1.0 - v).max(0.0) } else { v }
    }

    /// The colour at a point; grey pictures give equal components. `None` only for pictures without channels.
    #[inline]
    pub fn rgb(&self, at: &TextureContext) -> Option<Vec3> {
        let uv = self.mapping.uv(at);
        if !uv.is_finite() {
            return Some(Vec3::ZERO);
        }
        let rgb = match self.texels.channels {
            0 => return None,
            1 | 2 => Vec3::splat(self.lookup(uv, [0])[0]),
            _ => Vec3::from(self.lookup(uv, [0, 1, 2])),
        };
        Some(Vec3::new(self.finish(rgb.x), self.finish(rgb.y), self.finish(rgb.z)))
    }

    /// The value at a point: the mean of the colour channels.
    #[inline]
    pub fn float(&self, at: &TextureContext) -> f32 {
        let uv = self.mapping.uv(at);
        if !uv.is_finite() {
            return 0.0;
        }
        self.finish(match self.texels.channels {
            0 => 0.0,
            1 | 2 => self.lookup(uv, [0])[0],
            _ => self.lookup(uv, [0, 1, 2]).iter().sum::<f32>() / 3.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_image::Encoding;

    fn two_by_two(nearest: bool, wrap: Wrap) -> ImageTexture {
        let texels = Texels {
            width: 2,
            height: 2,
            channels: 1,
            data: TexelData::F32(vec![0.0, 1.0, 2.0, 4.0]),
            encoding: Encoding::Linear,
            metadata: Default::default(),
        };
        ImageTexture {
            texels: std::sync::Arc::new(texels),
            decode: Box::new([0.0; 256]),
            wrap_u: wrap,
            wrap_v: wrap,
            nearest,
            origin_bottom: false,
            scale: 1.0,
            invert: false,
            mapping: Mapping::default(),
        }
    }

    fn at(u: f32, v: f32) -> TextureContext<'static> {
        TextureContext::new(Vec3::ZERO, Vec2::new(u, v))
    }

    #[test]
    fn half_texel_conventions() {
        let t = two_by_two(false, Wrap::Clamp);
        assert_eq!(t.float(&at(0.25, 0.25)), 0.0);
        assert_eq!(t.float(&at(0.75, 0.25)), 1.0);
        assert_eq!(t.float(&at(0.5, 0.5)), 1.75);
        assert_eq!(t.float(&at(0.5, 0.25)), 0.5);
        assert_eq!(t.float(&at(1.0, 1.0)), 4.0);
        let r = two_by_two(false, Wrap::Repeat);
        assert_eq!(r.float(&at(0.0, 0.25)), 0.5);
        assert_eq!(r.float(&at(1.25, 0.25)), 0.0);
        assert_eq!(two_by_two(true, Wrap::Clamp).float(&at(1.0, 1.0)), 4.0);
        assert_eq!(two_by_two(true, Wrap::Black).float(&at(1.0, 1.0)), 0.0);
        let mut bottom = two_by_two(true, Wrap::Clamp);
        bottom.origin_bottom = true;
        assert_eq!(bottom.float(&at(0.1, 0.1)), 2.0);
    }

    #[test]
    fn wraps() {
        let at = |w: Wrap| (-3..5).map(|i| w.apply(i, 2).map_or(9, |x| x)).collect::<Vec<_>>();
        assert_eq!(at(Wrap::Repeat), [1, 0, 1, 0, 1, 0, 1, 0]);
        assert_eq!(at(Wrap::Mirror), [1, 1, 0, 0, 1, 1, 0, 0]);
        assert_eq!(at(Wrap::Clamp), [0, 0, 0, 0, 1, 1, 1, 1]);
        assert_eq!(at(Wrap::Black), [9, 9, 9, 0, 1, 9, 9, 9]);
    }
}
