//! Views: parts of a texture, perhaps as another kind or format.

use std::ops::Range;

use glam::Vec4;

use super::{Texture, TextureKind, TextureSize};
use crate::{
    error::{Result, refuse},
    format::{Format, Numeric},
};

/// Part of a texture that a view shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewRange {
    /// As which kind.
    pub kind: TextureKind,
    /// In which format: one with as many bytes, not of depth or stencil.
    pub format: Format,
    /// Which levels.
    pub levels: Range<u32>,
    /// Which layers.
    pub layers: Range<u32>,
}

/// A texture, or a part of it, as shaders see it.
#[derive(Clone, Copy, Debug)]
pub struct TextureView<'a> {
    texture: &'a Texture,
    pub(super) kind: TextureKind,
    pub(super) format: Format,
    first_level: u32,
    pub(super) levels: u32,
    first_layer: u32,
    pub(super) layers: u32,
}

impl Texture {
    /// The whole texture.
    pub fn view(&self) -> TextureView<'_> {
        TextureView {
            texture: self,
            kind: self.kind,
            format: self.format,
            first_level: 0,
            levels: self.level_count(),
            first_layer: 0,
            layers: self.size.layers,
        }
    }

    /// A part of it.
    ///
    /// # Errors
    /// Where levels or layers are not there, or kind or format do not fit the texture's.
    pub fn view_of(&self, range: ViewRange) -> Result<TextureView<'_>> {
        const CALL: &str = "Texture::view_of";
        let ViewRange { kind, format, levels, layers } = range;
        if levels.is_empty() || levels.end > self.level_count() || layers.is_empty() || layers.end > self.size.layers {
            return refuse(CALL, format!("levels {levels:?} and layers {layers:?} are not all there"));
        }
        // Bits may be read in another format of the same size, but for depth and stencil.
        let depth = |f: Format| matches!(f.numeric(), Numeric::Depth | Numeric::Stencil | Numeric::DepthStencil);
        if format != self.format && (format.bytes() != self.format.bytes() || depth(format) || depth(self.format)) {
            return refuse(CALL, format!("{:?} cannot be seen as {format:?}", self.format));
        }
        // A view keeps the number of dimensions; it may be an array, a cube or a single layer of one.
        let dimensions = |kind: TextureKind| match kind {
            TextureKind::D1 | TextureKind::D1Array => 1,
            TextureKind::D3 => 3,
            TextureKind::Buffer => 0,
            // Pictures of unnormalised coordinates, and with samples, are seen as such alone.
            TextureKind::Rectangle => 4,
            TextureKind::D2Multisample | TextureKind::D2MultisampleArray => 5,
            TextureKind::D2 | TextureKind::D2Array | TextureKind::Cube | TextureKind::CubeArray => 2,
        };
        if dimensions(kind) != dimensions(self.kind) {
            return refuse(CALL, format!("a {:?} texture cannot be seen as {kind:?}", self.kind));
        }
        // The part that is seen must be a texture of its kind by itself.
        let count = layers.end - layers.start;
        kind.check(TextureSize { layers: count, ..self.size }, CALL)?;
        Ok(TextureView {
            texture: self,
            kind,
            format,
            first_level: levels.start,
            levels: levels.end - levels.start,
            first_layer: layers.start,
            layers: count,
        })
    }
}

impl TextureView<'_> {
    /// Size of a level of the view.
    #[inline]
    pub fn size(&self, level: u32) -> TextureSize {
        TextureSize { layers: self.layers, ..self.texture.size.level(self.first_level + level) }
    }

    /// Number of levels of the view.
    pub fn level_count(&self) -> u32 {
        self.levels
    }

    /// A texel without filter, of samples the first. GLSL: `texelFetch`; zero outside.
    #[inline]
    pub fn fetch(&self, level: u32, at: [u32; 3], layer: u32) -> Vec4 {
        self.texel(level, at, layer, 0)
    }

    /// A sample of a texel. GLSL: `texelFetch` of multisample textures; zero outside.
    #[inline]
    pub fn fetch_sample(&self, at: [u32; 2], layer: u32, sample: u32) -> Vec4 {
        self.texel(0, [at[0], at[1], 0], layer, sample)
    }

    /// The bytes of a layer of a level, and what follows them; `None` outside.
    #[inline(always)]
    pub(super) fn plane(&self, level: u32, layer: u32) -> Option<&[u8]> {
        if level >= self.levels || layer >= self.layers {
            return None;
        }
        let level = self.first_level + level;
        let place = self.texture.place(level, [0; 3], self.first_layer + layer)?;
        self.texture.levels[level as usize].get(place..)
    }

    #[inline]
    fn texel(&self, level: u32, at: [u32; 3], layer: u32, sample: u32) -> Vec4 {
        // Levels and layers count from the first ones of the view.
        if level >= self.levels || layer >= self.layers || sample >= self.texture.samples {
            return Vec4::ZERO;
        }
        let level = self.first_level + level;
        match self.texture.place(level, at, self.first_layer + layer) {
            Some(place) => {
                let place = place + sample as usize * self.format.bytes();
                self.format.read(&self.texture.levels[level as usize][place..])
            }
            None => Vec4::ZERO,
        }
    }
}
