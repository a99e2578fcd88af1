//! Cut-outs as signed distance fields: a mask of high resolution is made into a small picture of distances to its edge,
//! which bilinear interpolation magnifies with sharp and smooth edges (Green, "Improved Alpha-Tested Magnification for
//! Vector Textures and Special Effects", SIGGRAPH 2007 courses; M212).
//!
//! Distances are exact between texels of the mask (Felzenszwalb, Huttenlocher, "Distance Transforms of Sampled
//! Functions", 2012). The coverage of a footprint of width `w` (the change of the distance `d` over it) is
//! `smoothstep(½ + d/(1.5 w))`, whose slope at the edge is that of a box, `1/w`; without a footprint it is 0 or 1. A
//! field says nothing of what is smaller than its texels, so footprints of one to two texels lead over to mip-maps of
//! the mask's mean, which keep the coverage (Green's has distances alone).

use super::{
    Filter, ImageTexture, TextureContext, Wrap,
    filter::Source,
    levels::{Levels, Recipe, Shape},
    mapping::Coordinates2,
    store::{Level, Pages},
};
use rayon::prelude::*;
use std::sync::Arc;
use steradian_image::{Encoding, TexelData, Texels};
use steradian_math::Vec2;

/// Most texels along the longer side of a field.
pub const MAX_SIZE: usize = 4096;
/// Greatest distance that a field holds, in its texels.
pub const MAX_SPREAD: f32 = 64.0;

/// A mask as distances to its edge.
#[derive(Clone, Debug)]
pub struct DistanceField {
    /// Distances as `½ + d/(2 spread)`, positive inside, and the mean of the mask, with its mip-maps.
    pub image: ImageTexture,
    /// Distance that the picture holds on each side of the edge, in texels of the field.
    pub spread: f32,
}

/// Construction of a field from a mask.
#[derive(Clone, Copy, Debug)]
pub struct FieldRecipe {
    /// Texels of the field along the longer side of the mask.
    pub size: usize,
    /// Distance that it holds on each side of the edge, in its texels.
    pub spread: f32,
    /// Value from which on a texel of the mask is inside.
    pub cut: f32,
    /// Channel of the mask; the mean of all for `None`.
    pub channel: Option<usize>,
    /// Wrap modes of the mask, horizontally and vertically.
    pub wrap: [Wrap; 2],
}

impl FieldRecipe {
    /// The levels of the field of a mask.
    ///
    /// # Errors
    /// Where levels cannot be written to `pages`.
    pub fn levels(&self, mask: &Level, pages: Option<&Arc<Pages>>) -> std::io::Result<Levels> {
        let (w, h, channels) = (mask.width(), mask.height(), mask.channels());
        let ratio = w.max(h) as f32 / self.size as f32;
        let sides = [w, h].map(|n| ((n as f32 / ratio).round() as usize).max(1));
        let mut inside = vec![false; w * h];
        inside.par_chunks_mut(w).enumerate().for_each(|(y, row)| {
            let mut values = vec![0.0; w];
            mask.linear_row(y, |i, v| match self.channel {
                Some(c) if i % channels != c => {}
                Some(_) => values[i / channels] = v,
                None => values[i / channels] += v / channels as f32,
            });
            row.iter_mut().zip(&values).for_each(|(inside, v)| *inside = *v >= self.cut);
        });
        let most = ratio * self.spread;
        let distances = Distances::new(&inside, [w, h], self.wrap, most);
        let mut data = vec![0_u16; 2 * sides[0] * sides[1]];
        data.par_chunks_mut(2 * sides[0]).enumerate().for_each(|(y, row)| {
            for (x, texel) in row.chunks_exact_mut(2).enumerate() {
                let at = Vec2::new((x as f32 + 0.5) / sides[0] as f32, (y as f32 + 0.5) / sides[1] as f32);
                let d = distances.at(at * Vec2::new(w as f32, h as f32));
                let ends = |i: usize, n: usize, side: usize| (i * n / side, ((i + 1) * n).div_ceil(side));
                let ((left, right), (top, bottom)) = (ends(x, w, sides[0]), ends(y, h, sides[1]));
                let within = (top..bottom).map(|y| inside[y * w + left..y * w + right].iter().filter(|i| **i).count());
                let mean = within.sum::<usize>() as f32 / ((right - left) * (bottom - top)) as f32;
                let distance = (0.5 + 0.5 * d / most).clamp(0.0, 1.0);
                texel.copy_from_slice(&[distance, mean].map(steradian_image::encoding::quantize16));
            }
        });
        let texels = Texels {
            width: sides[0],
            height: sides[1],
            channels: 2,
            data: TexelData::U16(data),
            encoding: Encoding::Linear,
            metadata: Default::default(),
        };
        let recipe = Recipe {
            shape: Shape::Mip,
            kernel: super::kernel::MipKernel::Box,
            wrap: self.wrap,
            keep_coverage: None,
            bleed: false,
        };
        Levels::new(Level::new(Arc::new(texels), pages)?, &recipe, pages)
    }
}

impl DistanceField {
    /// The part of the footprint that lies inside, after inversion; 0 or 1 of a point.
    pub fn value(&self, at: &TextureContext) -> f32 {
        let Some(place) = self.image.place(at) else { return self.image.finish(0.0) };
        let source = self.image.source();
        let texels = [place.dx, place.dy].map(|d| (d * self.image.levels.base().scale()).length());
        let far = (texels[0].max(texels[1]) - 1.0).clamp(0.0, 1.0);
        let near = if far < 1.0 { self.near(&source, &place) } else { 0.0 };
        let mean = if far > 0.0 { source.lookup::<1>(Filter::Trilinear, &place, 1)[0] } else { 0.0 };
        self.image.finish(near * (1.0 - far) + mean * far)
    }

    /// Coverage by the distance.
    fn near(&self, source: &Source, place: &Coordinates2) -> f32 {
        let distance = |uv: Vec2| {
            let place = Coordinates2 { uv, ..Coordinates2::default() };
            (source.lookup::<1>(Filter::Bilinear, &place, 0)[0] - 0.5) * 2.0 * self.spread
        };
        let change = |by: Vec2| distance(place.uv + 0.5 * by) - distance(place.uv - 0.5 * by);
        let d = distance(place.uv);
        let width = if place.dx == Vec2::ZERO && place.dy == Vec2::ZERO {
            0.0
        } else {
            change(place.dx).hypot(change(place.dy))
        };
        if width == 0.0 {
            return if d >= 0.0 { 1.0 } else { 0.0 };
        }
        let t = (0.5 + d / (1.5 * width)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// Signed distances at the centres of a mask's texels, in texels, positive inside.
struct Distances {
    data: Vec<f32>,
    size: [usize; 2],
    /// Rows and columns around the mask, where it goes on as it is wrapped.
    margin: usize,
}

impl Distances {
    /// The distances of a mask, exact up to `most`, or half the mask.
    fn new(inside: &[bool], [w, h]: [usize; 2], wrap: [Wrap; 2], most: f32) -> Self {
        let margin = (most.ceil() as usize + 1).min(w.max(h) / 2 + 1);
        let size = [w + 2 * margin, h + 2 * margin];
        let there = |x: usize, y: usize| {
            let from = |i: usize| i as i32 - margin as i32;
            Wrap::place(wrap, [from(x), from(y)], [w, h]).is_ok_and(|[x, y]| inside[y * w + x])
        };
        let to_outside = squares(size, |x, y| !there(x, y));
        let mut data = squares(size, there);
        data.par_iter_mut().zip(to_outside).for_each(|(d, outside)| {
            // The edge lies in the middle between texels of both sides.
            *d = if outside > 0.0 { outside.sqrt() - 0.5 } else { 0.5 - d.sqrt() };
        });
        Self { data, size, margin }
    }

    /// The distance at a point of the mask, bilinear.
    fn at(&self, p: Vec2) -> f32 {
        let p = p + self.margin as f32 - 0.5;
        let (x, y, t) = (p.x as usize, p.y as usize, p.fract());
        let row = |y: usize| {
            let from = y * self.size[0] + x;
            self.data[from] * (1.0 - t.x) + self.data[from + 1] * t.x
        };
        row(y) * (1.0 - t.y) + row(y + 1) * t.y
    }
}

/// Squared distances from each texel to the nearest that is `wanted`; very large where there is none.
fn squares([w, h]: [usize; 2], wanted: impl Fn(usize, usize) -> bool + Sync) -> Vec<f32> {
    let far = (w + h) as f32;
    // Within columns, which lie one after another.
    let mut columns = vec![far; w * h];
    columns.par_chunks_mut(h).enumerate().for_each(|(x, column)| {
        let mut last = far;
        for (y, d) in column.iter_mut().enumerate() {
            last = if wanted(x, y) { 0.0 } else { last + 1.0 };
            *d = last;
        }
        for d in column.iter_mut().rev() {
            last = d.min(last + 1.0);
            *d = last;
        }
    });
    let mut data = vec![0.0; w * h];
    data.par_chunks_mut(w).enumerate().for_each(|(y, row)| {
        // The lower envelope of one parabola per column: where each begins to be the lowest.
        let height = |x: usize| columns[x * h + y].powi(2);
        let mut lowest: Vec<(usize, f32)> = vec![(0, f32::NEG_INFINITY)];
        for x in 1..w {
            loop {
                let (other, from) = lowest[lowest.len() - 1];
                let (here, there) = (x as f64, other as f64);
                let rise = f64::from(height(x)) + here * here - f64::from(height(other)) - there * there;
                let meet = (rise / (2.0 * (here - there))) as f32;
                if meet > from {
                    lowest.push((x, meet));
                    break;
                }
                lowest.pop();
            }
        }
        let mut k = 0;
        for (x, d) in row.iter_mut().enumerate() {
            while lowest.get(k + 1).is_some_and(|next| next.1 < x as f32) {
                k += 1;
            }
            *d = (x as f32 - lowest[k].0 as f32).powi(2) + height(lowest[k].0);
        }
    });
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mapping, wrap::BLACK};

    /// A ring and a slanted bar with sharp corners, in the unit square.
    fn shape(x: f32, y: f32) -> bool {
        let (r, slanted) = ((x - 0.4).hypot(y - 0.45), 0.8 * x + 0.6 * y);
        (0.15..0.3).contains(&r) || (slanted - 1.05).abs() < 0.06 && (0.6 * x - 0.8 * y).abs() < 0.4
    }

    fn level(n: usize, value: impl Fn(usize, usize) -> f32) -> Level {
        let data = (0..n * n).map(|i| value(i % n, i / n)).collect();
        let (data, encoding, metadata) = (TexelData::F32(data), Encoding::Linear, Default::default());
        Level::new(Arc::new(Texels { width: n, height: n, channels: 1, data, encoding, metadata }), None).unwrap()
    }

    fn image(levels: Levels, filter: Filter, wrap: [Wrap; 2]) -> ImageTexture {
        ImageTexture {
            levels: Arc::new(levels),
            sums: None,
            filter,
            stochastic: false,
            wrap,
            borders: BLACK,
            channel: None,
            origin_bottom: false,
            scale: 1.0,
            invert: false,
            mapping: Mapping::default(),
        }
    }

    fn field(mask: &Level, size: usize, spread: f32, wrap: Wrap) -> DistanceField {
        let recipe = FieldRecipe { size, spread, cut: 0.5, channel: Some(0), wrap: [wrap; 2] };
        let levels = recipe.levels(mask, None).unwrap();
        DistanceField { image: image(levels, Filter::Trilinear, [wrap; 2]), spread }
    }

    fn pixel(x: usize, y: usize, n: usize) -> TextureContext<'static> {
        let uv = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / n as f32;
        let mut at = TextureContext::new(uv.extend(0.0), uv);
        (at.footprint.duvdx, at.footprint.duvdy) = (Vec2::X / n as f32, Vec2::Y / n as f32);
        at
    }

    /// The part of a pixel of `n` × `n` that the shape covers, from 8 × 8 points.
    fn exact(x: usize, y: usize, n: usize) -> f32 {
        let at = |i: usize, k: usize| (i as f32 + (k as f32 + 0.5) / 8.0) / n as f32;
        (0..64).filter(|k| shape(at(x, k % 8), at(y, k / 8))).count() as f32 / 64.0
    }

    /// M212: 8 pixels to a texel, edges are wrong by less than a fifth of what bilinear opacity of the same resolution
    /// is wrong by, and by less than bilinear opacity that is cut at one half.
    #[test]
    fn edges_stay_sharp_under_magnification() {
        let (size, n) = (64, 512);
        let mask = level(1024, |x, y| f32::from(shape((x as f32 + 0.5) / 1024.0, (y as f32 + 0.5) / 1024.0)));
        let field = field(&mask, size, 4.0, Wrap::Clamp);
        let alpha = level(size, |x, y| exact(x, y, size));
        let alpha = image(Levels::flat(alpha), Filter::Bilinear, [Wrap::Clamp; 2]);
        let mut errors = [0.0_f64; 3];
        for (x, y) in (0..n * n).map(|i| (i % n, i / n)) {
            let (wanted, at) = (exact(x, y, n), pixel(x, y, n));
            let bilinear = alpha.float(&at);
            let seen = [field.value(&at), bilinear, f32::from(bilinear >= 0.5)];
            (0..3).for_each(|k| errors[k] += f64::from((seen[k] - wanted).abs()) / (n * n) as f64);
        }
        let [by_field, bilinear, cut] = errors;
        assert!(by_field < 0.2 * bilinear && by_field < 0.8 * cut, "{errors:?}");
    }

    /// From afar the mean of the field is the area of the shape, at any size of the footprint.
    #[test]
    fn coverage_is_kept_from_afar() {
        let mask = level(512, |x, y| f32::from(shape((x as f32 + 0.5) / 512.0, (y as f32 + 0.5) / 512.0)));
        let field = field(&mask, 64, 4.0, Wrap::Repeat);
        let mean = |n: usize, value: &dyn Fn(usize, usize) -> f32| {
            (0..n * n).map(|i| value(i % n, i / n)).sum::<f32>() / (n * n) as f32
        };
        let wanted = mean(512, &|x, y| exact(x, y, 512));
        for n in [1, 4, 16, 32, 48, 64, 256] {
            let seen = mean(n, &|x, y| field.value(&pixel(x, y, n)));
            assert!((seen - wanted).abs() < 2e-3, "{n}: {seen} {wanted}");
        }
    }

    #[test]
    fn distances_are_those_to_the_nearest_texel() {
        let size = [23, 17];
        let wanted = |x: usize, y: usize| steradian_math::hash::mix32((y * 23 + x) as u32).is_multiple_of(19);
        let found = squares(size, wanted);
        for (x, y) in (0..23 * 17).map(|i| (i % 23, i / 23)) {
            let all = (0..23 * 17).map(|i| (i % 23, i / 23)).filter(|(x, y)| wanted(*x, *y));
            let nearest = all.map(|(i, j)| i.abs_diff(x).pow(2) + j.abs_diff(y).pow(2)).min().unwrap();
            assert_eq!(found[y * 23 + x], nearest as f32, "{x} {y}");
        }
    }

    /// Points have no footprint: they are inside or outside, also across the seam of a mask that repeats.
    #[test]
    fn points_are_in_or_out() {
        let mask = level(256, |x, _| f32::from(!(64..192).contains(&x)));
        for (wrap, u, wanted) in [
            (Wrap::Repeat, 0.0, 1.0),
            (Wrap::Repeat, -0.24, 1.0),
            (Wrap::Repeat, -0.26, 0.0),
            (Wrap::Clamp, -3.0, 1.0),
            (Wrap::Mirror, 1.24, 1.0),
            (Wrap::Mirror, 1.26, 0.0),
        ] {
            let field = field(&mask, 32, 8.0, wrap);
            let seen = field.value(&TextureContext::new(steradian_math::Vec3::ZERO, Vec2::new(u, 0.3)));
            assert_eq!(seen, wanted, "{wrap:?} {u}");
        }
        for value in [0.0, 1.0] {
            let field = field(&level(8, |_, _| value), 8, 2.0, Wrap::Repeat);
            assert_eq!(field.value(&pixel(3, 3, 64)), value);
        }
    }
}
