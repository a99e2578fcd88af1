//! Storage of textures: texels that a texture and its views share, and the part of them that one shows (OpenGL 4.6
//! core, sections 8.18 and 8.19).

use std::{cell::RefCell, rc::Rc};

use super::names::Object;
use crate::{
    error::Result,
    format::{Format, Numeric},
    texture::{Texture, TextureKind, TextureSize, ViewRange},
};

/// Texels, and which levels and layers of them a texture has in which format.
#[derive(Clone, Debug)]
pub(super) struct Storage {
    pub texels: Object<Texture>,
    pub range: ViewRange,
    /// Size of the first level.
    pub size: TextureSize,
    pub samples: u32,
}

impl Storage {
    /// All of a texture.
    pub fn new(texels: Texture) -> Self {
        let size = texels.size();
        let (levels, layers) = (0..texels.level_count(), 0..size.layers);
        let range = ViewRange { kind: texels.kind(), format: texels.format(), levels, layers };
        Self { samples: texels.samples(), texels: Rc::new(RefCell::new(texels)), range, size }
    }

    /// A part of it, whose levels and layers count from its own first ones; levels beyond the last are left out.
    pub fn view(&self, part: ViewRange) -> Result<Self> {
        let within = |part: &std::ops::Range<u32>, of: &std::ops::Range<u32>| {
            let place = |number: u32| of.start.saturating_add(number);
            place(part.start)..place(part.end)
        };
        let levels = within(&part.levels, &self.range.levels);
        let levels = levels.start..levels.end.min(self.range.levels.end);
        let layers = within(&part.layers, &self.range.layers);
        // Layers beyond this part's are not there, though the texels may have them.
        let layers = if layers.end > self.range.layers.end { 0..0 } else { layers };
        let range = ViewRange { levels, layers, ..part };
        self.texels.borrow().view_of(range.clone())?;
        let layers = range.layers.end - range.layers.start;
        let size = TextureSize { layers, ..self.size.level(part.levels.start) };
        Ok(Self { texels: Rc::clone(&self.texels), range, size, samples: self.samples })
    }

    pub fn format(&self) -> Format {
        self.range.format
    }

    pub fn levels(&self) -> u32 {
        self.range.levels.end - self.range.levels.start
    }

    /// Texels of a level in x, y and z, in which slices or layers count.
    pub fn sides(&self, level: u32) -> [u32; 3] {
        let size = self.size.level(level);
        [size.width, size.height, size.depth.max(size.layers)]
    }

    /// Bytes of a texel, all samples together.
    pub fn texel_bytes(&self) -> usize {
        self.format().bytes() * self.samples as usize
    }

    /// First byte of a texel in the level of the texels that a level is; z counts slices of volumes, else layers.
    fn place(&self, texels: &Texture, level: u32, [x, y, z]: [u32; 3]) -> Option<usize> {
        let (slice, layer) = if self.range.kind == TextureKind::D3 { (z, 0) } else { (0, z) };
        texels.place(self.range.levels.start + level, [x, y, slice], self.range.layers.start + layer)
    }

    /// Bytes of texels from one on, in the order of columns, rows and layers; none where they are not there.
    pub fn bytes<'a>(&self, texels: &'a Texture, level: u32, at: [u32; 3], count: usize) -> &'a [u8] {
        let place = self.place(texels, level, at);
        let bytes = texels.level(self.range.levels.start + level).zip(place).and_then(|(bytes, at)| bytes.get(at..));
        bytes.and_then(|bytes| bytes.get(..count * self.texel_bytes())).unwrap_or_default()
    }

    /// Bytes of texels, to be written.
    pub fn bytes_mut<'a>(&self, texels: &'a mut Texture, level: u32, at: [u32; 3], count: usize) -> &'a mut [u8] {
        let place = self.place(texels, level, at);
        let bytes = texels.level_mut(self.range.levels.start + level).zip(place);
        let bytes = bytes.and_then(|(bytes, at)| bytes.get_mut(at..));
        bytes.and_then(|bytes| bytes.get_mut(..count * self.texel_bytes())).unwrap_or_default()
    }
}

/// True for formats whose bits may be seen, or copied, as those of another format of their size (table 8.22).
pub(super) fn is_in_view_class(format: Format) -> bool {
    let bits = format.bits();
    let equal = bits.iter().all(|other| *other == 0 || *other == bits[0]) && matches!(bits[0], 8 | 16 | 32);
    let packed = matches!(format, Format::Rgb10A2Unorm | Format::Rgb10A2Uint | Format::Rg11B10Float | Format::Rgb9E5);
    packed || equal && !matches!(format.numeric(), Numeric::Depth | Numeric::Stencil | Numeric::DepthStencil)
}
