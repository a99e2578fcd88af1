//! Image units: texels that shaders load, store and change by atomics (OpenGL 4.6 core, section 8.26).

use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec4;

use super::{
    context::Context,
    error::{invalid_enum, invalid_operation, invalid_value},
    names::Object,
    storage::is_in_view_class,
    textures::TextureObject,
};
use crate::{
    error::Result,
    format::{Format, Numeric},
    texture::TextureKind,
};

/// The most image units.
const MAX_IMAGES: u32 = 8;

/// Access of shaders to an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageAccess {
    /// Loads.
    ReadOnly,
    /// Stores.
    WriteOnly,
    /// Loads, stores and atomics.
    ReadWrite,
}

impl ImageAccess {
    /// True if all that another access allows is allowed.
    fn allows(self, other: Self) -> bool {
        self == Self::ReadWrite || self == other
    }
}

/// Level of a texture that is bound to an image unit, and one layer of it or all.
#[derive(Clone, Debug)]
pub(super) struct ImageBinding {
    pub texture: Object<TextureObject>,
    pub level: u32,
    pub layer: Option<u32>,
    pub access: ImageAccess,
    pub format: Format,
}

impl Context {
    /// Binds a level of a texture to an image unit, all layers or one, to be accessed in a format of its texels' size;
    /// the name 0 unbinds.
    ///
    /// # Errors
    /// For units from 8 on, names without objects, textures without storage, buffer textures and those with samples,
    /// levels and layers that are not there, formats that no image has, and one of another size than the texture's.
    pub fn bind_image_texture(
        &mut self,
        unit: u32,
        texture: u32,
        (level, layer): (u32, Option<u32>),
        access: ImageAccess,
        format: Format,
    ) -> Result<()> {
        const CALL: &str = "bind_image_texture";
        if unit >= MAX_IMAGES {
            return invalid_value(CALL, format_args!("image unit {unit}; there are {MAX_IMAGES}"));
        }
        if texture == 0 {
            self.images.remove(&unit);
            return Ok(());
        }
        let texture = self.shared.borrow().textures.object(texture, CALL)?;
        let kind = texture.borrow().kind;
        if kind == TextureKind::Buffer || kind.is_multisample() {
            return invalid_operation(CALL, format_args!("a {kind:?} texture is no image"));
        }
        let storage = texture.borrow().storage(CALL)?.clone();
        if level >= storage.levels() || layer.is_some_and(|layer| layer >= storage.sides(level)[2]) {
            return invalid_value(CALL, format_args!("level {level} and layer {layer:?} are not both there"));
        }
        if !is_of_images(format) {
            return invalid_enum(CALL, format_args!("{format:?} is no format of images"));
        }
        if format.bytes() != storage.format().bytes() || !is_in_view_class(storage.format()) {
            let rule = format_args!("texels of {:?} cannot be accessed as {format:?}", storage.format());
            return invalid_operation(CALL, rule);
        }
        self.images.insert(unit, ImageBinding { texture, level, layer, access, format });
        Ok(())
    }
}

/// True for the formats of table 8.26: one, two or four channels of 8, 16 or 32 bits, and three that are packed.
fn is_of_images(format: Format) -> bool {
    let packed = matches!(format, Format::Rgb10A2Unorm | Format::Rgb10A2Uint | Format::Rg11B10Float);
    let numeric =
        matches!(format.numeric(), Numeric::Unorm | Numeric::Snorm | Numeric::Uint | Numeric::Sint | Numeric::Float);
    let channels = format.bits().iter().filter(|bits| **bits > 0).count();
    packed || numeric && is_in_view_class(format) && channels != 3 && format != Format::Bgra8Unorm
}

/// An image as shaders see it. Loads and stores of one texel by several invocations give the bits of either; atomics
/// are whole. Helper invocations run like others: shaders that store ask [`Fragment::is_helper`](crate::Fragment).
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    /// Words of the level: texels in the order of columns, rows and layers.
    pub(super) words: &'a [AtomicU32],
    pub(super) format: Format,
    pub(super) size: [u32; 3],
    /// First layer of the image in the level.
    pub(super) first: u32,
    pub(super) access: ImageAccess,
}

impl<'a> Image<'a> {
    /// Columns, rows, and layers or slices.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// The texel at a column, row and layer or slice, integers as bits. GLSL: `imageLoad`; zero outside.
    pub fn load(&self, at: [u32; 3]) -> Vec4 {
        let mut bytes = [0; 16];
        for (bytes, word) in bytes.chunks_exact_mut(4).zip(self.texel(at)) {
            bytes.copy_from_slice(&word.load(Ordering::Relaxed).to_le_bytes());
        }
        if self.texel(at).is_empty() { Vec4::ZERO } else { self.format.read(&bytes) }
    }

    /// Writes a texel, integers as bits. GLSL: `imageStore`; nothing outside.
    pub fn store(&self, at: [u32; 3], color: Vec4) {
        let mut bytes = [0; 16];
        self.format.write(color, &mut bytes);
        for (bytes, word) in bytes.as_chunks().0.iter().zip(self.texel(at)) {
            word.store(u32::from_le_bytes(*bytes), Ordering::Relaxed);
        }
    }

    /// The word of a texel, for GLSL's `imageAtomicAdd` and so on, by the methods of [`AtomicU32`]; `None` outside, for
    /// formats other than `R32Uint`, `R32Sint` and `R32Float`, and without access of `ReadWrite`.
    pub fn atomic(&self, at: [u32; 3]) -> Option<&'a AtomicU32> {
        let single = matches!(self.format, Format::R32Uint | Format::R32Sint | Format::R32Float);
        self.texel(at).first().filter(|_| single && self.access == ImageAccess::ReadWrite)
    }

    /// Words of a texel; none outside.
    fn texel(&self, [x, y, z]: [u32; 3]) -> &'a [AtomicU32] {
        let [width, height, depth] = self.size;
        if x >= width || y >= height || z >= depth {
            return &[];
        }
        let texel = ((self.first + z) as usize * height as usize + y as usize) * width as usize + x as usize;
        let words = self.format.bytes().div_ceil(4);
        self.words.get(texel * words..(texel + 1) * words).unwrap_or_default()
    }

    /// The image, if it may be accessed so.
    pub(super) fn checked(self, unit: u32, access: ImageAccess, call: &'static str) -> Result<Self> {
        if !self.access.allows(access) {
            let rule = format_args!("image unit {unit} is bound for {:?}, not {access:?}", self.access);
            return invalid_operation(call, rule);
        }
        Ok(Self { access, ..self })
    }
}
