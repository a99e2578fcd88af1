//! The commonest lookup: four texels of a picture with four channels of 8 bits.

use glam::{IVec2, Vec2, Vec4};

use super::{Sampler, TextureView};
use crate::format::{Format, decode_rgba8};

impl Sampler {
    /// The mean of the four texels around a point in texels, weighted by distance; the bits of the general way. `None`
    /// where that must do it: beyond a border with a colour of its own, for other formats, for huge coordinates.
    #[inline]
    pub(super) fn bilinear(
        &self,
        view: &TextureView,
        (level, layer): (u32, u32),
        at: Vec2,
        value: &impl Fn(Vec4) -> Vec4,
    ) -> Option<Vec4> {
        // Texel centres are at halves.
        let u = at - 0.5;
        let fits = |x: f32| x.abs() < 1e9;
        if view.format != Format::Rgba8Unorm || !fits(u.x) || !fits(u.y) {
            return None;
        }
        let size = view.size(level);
        let (texels, width) = (view.plane(level, layer)?, size.width as usize);
        // Truncated, and one less where that rounded up.
        let whole = |x: f32| x as i32 - i32::from((x as i32) as f32 > x);
        let first = IVec2::new(whole(u.x), whole(u.y));
        let weight = u - first.as_vec2();
        let place = |axis: usize, n: u32, i: i32| self.wrap[axis].texel(i64::from(i), i64::from(n));
        let columns = [place(0, size.width, first.x)? as usize, place(0, size.width, first.x + 1)? as usize];
        let rows = [place(1, size.height, first.y)? as usize, place(1, size.height, first.y + 1)? as usize];
        let mut sum = Vec4::ZERO;
        for (row, wy) in rows.into_iter().zip([1.0 - weight.y, weight.y]) {
            let texels = texels.get(row * width * 4..)?;
            for (column, wx) in columns.into_iter().zip([1.0 - weight.x, weight.x]) {
                sum += value(decode_rgba8(*texels.get(column * 4..)?.first_chunk()?)) * (wx * wy);
            }
        }
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::{Texture, Wrap};

    /// Against four texels fetched one by one; a power of two and other sizes, inside and outside.
    #[test]
    fn the_mean_is_that_of_the_four_texels_around() {
        let colors: Vec<Vec4> =
            (0..8 * 6).map(|i| Vec4::splat(i as f32 / 47.0).with_y(1.0 - i as f32 / 47.0)).collect();
        let Ok(texture) = Texture::from_colors(Format::Rgba8Unorm, 8, 6, &colors, false) else { panic!() };
        let view = texture.view();
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::MirrorOnce, Wrap::ClampToEdge] {
            let sampler = Sampler { wrap: [wrap; 3], ..Sampler::default() };
            for i in 0..1000 {
                let at = Vec2::new((i * 37 % 1000) as f32 * 0.031 - 12.0, (i * 91 % 1000) as f32 * 0.023 - 9.0);
                let (low, share) = ((at - 0.5).floor(), (at - 0.5) - (at - 0.5).floor());
                let mut expected = Vec4::ZERO;
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let weight = |d, s: f32| if d == 1 { s } else { 1.0 - s };
                    let of = |d, low: f32, n| wrap.texel(i64::from(d) + low as i64, n).unwrap_or(0);
                    let texel = view.fetch(0, [of(dx, low.x, 8), of(dy, low.y, 6), 0], 0);
                    expected += texel * (weight(dx, share.x) * weight(dy, share.y));
                }
                assert_eq!(sampler.bilinear(&view, (0, 0), at, &|texel| texel), Some(expected), "{wrap:?} {at}");
            }
        }
        let sampler = Sampler { wrap: [Wrap::ClampToBorder; 3], ..Sampler::default() };
        assert_eq!(sampler.bilinear(&view, (0, 0), Vec2::ZERO, &|texel| texel), None);
        assert_eq!(Sampler::default().bilinear(&view, (0, 0), Vec2::new(0.0, f32::NAN), &|texel| texel), None);
    }
}
