//! Pictures as textures: kept in the file's precision, decoded at lookup.

use super::{
    Filter, Mapping, TextureContext, Wrap, filter::Source, levels::Levels, mapping::Coordinates2, summed::SummedArea,
    wrap::Borders,
};
use std::sync::Arc;
use steradian_math::Vec3;

/// A picture with everything its lookup needs.
#[derive(Clone, Debug)]
pub struct ImageTexture {
    /// The picture and its smaller sizes.
    pub levels: Arc<Levels>,
    /// Its sums, for the filter that needs them.
    pub sums: Option<Arc<SummedArea>>,
    /// Filter from texels to values.
    pub filter: Filter,
    /// Enables stochastic filtering: one texel is drawn at random instead of the filter's mean.
    pub stochastic: bool,
    /// Horizontal and vertical wrap.
    pub wrap: [Wrap; 2],
    /// The colours of borders.
    pub borders: Borders,
    /// The channel to look at instead of the colour.
    pub channel: Option<usize>,
    /// Row 0 of the file is at v = 1 (as pbrt has it).
    pub origin_bottom: bool,
    /// Factor on the values.
    pub scale: f32,
    /// `1 − value`, after the scale.
    pub invert: bool,
    /// Mapping from surface points to the image.
    pub mapping: Mapping,
}

impl ImageTexture {
    /// The filtered linear values of `N` channels from `first` on, before scale and inversion; black where there is no
    /// place.
    #[inline]
    pub fn channels<const N: usize>(&self, at: &TextureContext, first: usize) -> [f32; N] {
        let Some(place) = self.place(at) else { return [0.0; N] };
        let source = self.source();
        if self.stochastic {
            let salt = at.p.x.to_bits() ^ at.p.y.to_bits().rotate_left(11) ^ at.p.z.to_bits().rotate_left(22);
            return source.one_tap(self.filter, &place, salt, first);
        }
        source.lookup(self.filter, &place, first)
    }

    /// Levels, sums and borders of the picture, for the filters.
    #[inline]
    pub(super) fn source(&self) -> Source<'_> {
        Source { levels: &self.levels, sums: self.sums.as_deref(), wrap: self.wrap, borders: &self.borders }
    }

    /// The place of a lookup, in periods from the top left corner, with its footprint if the filter asks for it; `None`
    /// where there is no place.
    #[inline]
    pub(super) fn place(&self, at: &TextureContext) -> Option<Coordinates2> {
        let Coordinates2 { mut uv, mut dx, mut dy } = if self.filter.is_prefiltered() {
            self.mapping.coordinates(at)
        } else {
            Coordinates2 { uv: self.mapping.uv(at), ..Coordinates2::default() }
        };
        if !uv.is_finite() {
            return None;
        }
        if self.origin_bottom {
            uv.y = 1.0 - uv.y;
            (dx.y, dy.y) = (-dx.y, -dy.y);
        }
        Some(Coordinates2 { uv: Wrap::reduce(self.wrap, uv), dx, dy })
    }

    /// A linear value after scale and inversion.
    #[inline]
    pub fn finish(&self, v: f32) -> f32 {
        let v = v * self.scale;
        if self.invert { (1.0 - v).max(0.0) } else { v }
    }

    /// The one channel to look at, where it is not the colour.
    #[inline]
    fn single(&self) -> Option<usize> {
        match self.channel {
            None if self.levels.base().channels() < 3 => Some(0),
            channel => channel,
        }
    }

    /// The colour at a point; grey pictures and single channels give equal components. `None` only for pictures without
    /// channels.
    #[inline]
    pub fn rgb(&self, at: &TextureContext) -> Option<Vec3> {
        if self.levels.base().channels() == 0 {
            return None;
        }
        let rgb = match self.single() {
            Some(channel) => Vec3::splat(self.channels::<1>(at, channel)[0]),
            None => Vec3::from(self.channels(at, 0)),
        };
        Some(Vec3::new(self.finish(rgb.x), self.finish(rgb.y), self.finish(rgb.z)))
    }

    /// The value at a point: of the channel to look at, or the mean of the colour.
    #[inline]
    pub fn float(&self, at: &TextureContext) -> f32 {
        if self.levels.base().channels() == 0 {
            return self.finish(0.0);
        }
        self.finish(match self.single() {
            Some(channel) => self.channels::<1>(at, channel)[0],
            None => self.channels::<3>(at, 0).iter().sum::<f32>() / 3.0,
        })
    }
}
