//! Texture objects, and transfers of pixels from and to the client or a buffer (OpenGL 4.6 core, sections 8.4, 8.11,
//! 8.19 and 18.2).
//!
//! A format of pixels in memory is a [`Format`], too: `Rgba8Unorm` stands for `GL_RGBA` with `GL_UNSIGNED_BYTE`.

use super::{
    context::{BufferTarget, Context},
    error::{as_operation, invalid_operation, invalid_value},
    names::written,
    sampling::Parameters,
    storage::Storage,
};
use crate::{
    error::Result,
    format::{Format, Numeric},
    texture::TextureKind,
};

/// A texture: its kind, and its storage once that is given.
#[derive(Debug)]
pub(super) struct TextureObject {
    pub kind: TextureKind,
    pub storage: Option<Storage>,
    pub parameters: Parameters,
}

impl TextureObject {
    pub fn new(kind: TextureKind) -> Self {
        Self { kind, storage: None, parameters: Parameters::new(kind) }
    }

    pub fn storage(&self, call: &'static str) -> Result<&Storage> {
        match &self.storage {
            Some(storage) => Ok(storage),
            None => invalid_operation(call, "the texture has no storage"),
        }
    }
}

/// Layout of pixels in memory (section 8.4.1): `glPixelStore`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelStore {
    /// Rows begin at multiples of so many bytes: 1, 2, 4 or 8; 4 at first.
    pub alignment: usize,
    /// Pixels from one row to the next; 0 for the width of the region.
    pub row_length: usize,
    /// Rows from one slice to the next; 0 for the height of the region.
    pub image_height: usize,
}

impl Default for PixelStore {
    fn default() -> Self {
        Self { alignment: 4, row_length: 0, image_height: 0 }
    }
}

/// Pixels that are written to a texture.
#[derive(Clone, Copy, Debug)]
pub enum Pixels<'a> {
    /// Bytes of the client.
    Bytes(&'a [u8]),
    /// Bytes from this offset on of the buffer that is bound to `PixelUnpack`.
    Offset(usize),
}

/// Memory that pixels of a texture are read into.
#[derive(Debug)]
pub enum PixelsMut<'a> {
    /// Bytes of the client.
    Bytes(&'a mut [u8]),
    /// Bytes from this offset on of the buffer that is bound to `PixelPack`.
    Offset(usize),
}

/// Texels of a level: a box. Slices, layers and faces count in z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The level.
    pub level: u32,
    /// The first texel: x, y, z.
    pub origin: [u32; 3],
    /// Number of texels in x, y and z.
    pub size: [u32; 3],
}

/// Place of the pixels of a region in memory.
struct Rows {
    row: usize,
    slice: usize,
    pixel: usize,
    bytes: usize,
}

impl Rows {
    /// Rows of a region of pixels (section 8.4.4.1): each begins at a multiple of the alignment.
    fn new(store: PixelStore, format: Format, size: [u32; 3], call: &'static str) -> Result<Self> {
        let [width, height, depth] = size.map(|side| side as usize);
        let pixel = format.bytes();
        let pixels = if store.row_length > 0 { store.row_length } else { width };
        let rows = if store.image_height > 0 { store.image_height } else { height };
        let row = pixels.checked_mul(pixel).and_then(|bytes| bytes.checked_next_multiple_of(store.alignment));
        let slice = row.and_then(|row| row.checked_mul(rows));
        // The last row ends with its last pixel.
        let bytes = row.zip(slice).and_then(|(row, slice)| {
            let before =
                slice.checked_mul(depth.saturating_sub(1))?.checked_add(row.checked_mul(height.saturating_sub(1))?)?;
            before.checked_add(width.checked_mul(pixel)?)
        });
        match (row, slice, bytes) {
            _ if size.contains(&0) => Ok(Self { row: 0, slice: 0, pixel, bytes: 0 }),
            (Some(row), Some(slice), Some(bytes)) => Ok(Self { row, slice, pixel, bytes }),
            _ => invalid_value(call, format_args!("rows of {pixels} pixels and slices of {rows} rows are too long")),
        }
    }

    fn place(&self, [x, y, z]: [u32; 3]) -> usize {
        z as usize * self.slice + y as usize * self.row + x as usize * self.pixel
    }
}

impl Context {
    /// Sets the layout of pixels that are read from textures (`is_pack`), or written to them.
    ///
    /// # Errors
    /// For alignments other than 1, 2, 4 and 8.
    pub fn pixel_store(&mut self, is_pack: bool, store: PixelStore) -> Result<()> {
        if !matches!(store.alignment, 1 | 2 | 4 | 8) {
            return invalid_value("pixel_store", format_args!("alignment {}; one of 1, 2, 4 and 8", store.alignment));
        }
        *(if is_pack { &mut self.pack } else { &mut self.unpack }) = store;
        Ok(())
    }

    /// Writes pixels of a format to a region of a texture, from the client, or from the buffer that is bound to
    /// `PixelUnpack` (section 8.6).
    ///
    /// # Errors
    /// For names without objects, a texture without storage, a region that is not all there, formats of integers and of
    /// floats mixed, bytes of the client while a buffer is bound and an offset without, an offset that is no multiple
    /// of the component's size, bytes beyond the end, and a buffer that is mapped but not persistently.
    pub fn texture_sub_image(&self, texture: u32, region: Region, format: Format, pixels: Pixels) -> Result<()> {
        const CALL: &str = "texture_sub_image";
        let texture = self.shared.borrow().textures.object(texture, CALL)?;
        let texture = texture.borrow();
        let storage = texture.storage(CALL)?;
        check_transfer(storage, region, format, CALL)?;
        let rows = Rows::new(self.unpack, format, region.size, CALL)?;
        let buffer = self.bound_buffer(BufferTarget::PixelUnpack);
        let buffer = buffer.as_ref().map(|buffer| buffer.borrow());
        let bytes = match (pixels, &buffer) {
            (Pixels::Offset(offset), Some(buffer)) => {
                check_offset(offset, format, CALL)?;
                as_operation(buffer.read(offset, rows.bytes, CALL))?
            }
            (Pixels::Bytes(bytes), None) if bytes.len() >= rows.bytes => bytes,
            (Pixels::Bytes(bytes), None) => return too_few(bytes.len(), rows.bytes, CALL),
            (Pixels::Offset(_), None) => return invalid_operation(CALL, "no buffer is bound to PixelUnpack"),
            (Pixels::Bytes(_), Some(_)) => return invalid_operation(CALL, "a buffer is bound to PixelUnpack"),
        };
        let mut target = written(&storage.texels, CALL)?;
        for at in texels(region.size) {
            let color = format.read(&bytes[rows.place(at)..]);
            storage.format().write(color, storage.bytes_mut(&mut target, region.level, moved(at, region), 1));
        }
        Ok(())
    }

    /// Reads a region of a texture as pixels of a format, to the client, or to the buffer that is bound to `PixelPack`
    /// (section 8.11.4).
    ///
    /// # Errors
    /// As [`texture_sub_image`](Self::texture_sub_image), with `PixelPack`.
    pub fn get_texture_sub_image(&self, texture: u32, region: Region, format: Format, pixels: PixelsMut) -> Result<()> {
        const CALL: &str = "get_texture_sub_image";
        let texture = self.shared.borrow().textures.object(texture, CALL)?;
        let texture = texture.borrow();
        let storage = texture.storage(CALL)?;
        check_transfer(storage, region, format, CALL)?;
        let rows = Rows::new(self.pack, format, region.size, CALL)?;
        let buffer = self.bound_buffer(BufferTarget::PixelPack);
        let mut buffer = match &buffer {
            Some(buffer) => Some(written(buffer, CALL)?),
            None => None,
        };
        let bytes = match (pixels, &mut buffer) {
            (PixelsMut::Offset(offset), Some(buffer)) => {
                check_offset(offset, format, CALL)?;
                as_operation(buffer.write(offset, rows.bytes, CALL))?
            }
            (PixelsMut::Bytes(bytes), None) if bytes.len() >= rows.bytes => bytes,
            (PixelsMut::Bytes(bytes), None) => return too_few(bytes.len(), rows.bytes, CALL),
            (PixelsMut::Offset(_), None) => return invalid_operation(CALL, "no buffer is bound to PixelPack"),
            (PixelsMut::Bytes(_), Some(_)) => return invalid_operation(CALL, "a buffer is bound to PixelPack"),
        };
        let source = storage.texels.borrow();
        for at in texels(region.size) {
            let color = storage.format().read(storage.bytes(&source, region.level, moved(at, region), 1));
            format.write(color, &mut bytes[rows.place(at)..]);
        }
        Ok(())
    }
}

/// Checks a region, and that pixels and texels are both integers of one sign, both depths, or neither.
pub(super) fn check(storage: &Storage, region: Region, format: Format, call: &'static str) -> Result<()> {
    let sides = storage.sides(region.level);
    let is_there =
        |axis: usize| region.origin[axis].checked_add(region.size[axis]).is_some_and(|end| end <= sides[axis]);
    if region.level >= storage.levels() || !(0..3).all(is_there) {
        return invalid_value(call, format_args!("{region:?} is not all within {sides:?}"));
    }
    let is_color =
        |format: Format| !matches!(format.numeric(), Numeric::Depth | Numeric::Stencil | Numeric::DepthStencil);
    let own = storage.format();
    if own.class() != format.class() || is_color(own) != is_color(format) {
        return invalid_operation(call, format_args!("{own:?} does not take pixels of {format:?}"));
    }
    Ok(())
}

/// As [`check`], for pixels, which have one sample.
pub(super) fn check_transfer(storage: &Storage, region: Region, format: Format, call: &'static str) -> Result<()> {
    if storage.range.kind.is_multisample() {
        return invalid_operation(call, "texels with samples are neither written nor read as pixels");
    }
    check(storage, region, format, call)
}

/// Checks that an offset is a multiple of the size of a component, or of a texel whose components are packed.
fn check_offset(offset: usize, format: Format, call: &'static str) -> Result<()> {
    let bits = format.bits();
    let is_packed = bits.iter().any(|other| *other != 0 && (*other != bits[0] || other % 8 != 0));
    let unit = if is_packed { format.bytes() } else { usize::from(bits[0] / 8) };
    if !offset.is_multiple_of(unit) {
        return invalid_operation(call, format_args!("offset {offset} is no multiple of {unit}, the component's size"));
    }
    Ok(())
}

fn too_few<T>(have: usize, want: usize, call: &'static str) -> Result<T> {
    invalid_operation(call, format_args!("{have} bytes for pixels of {want}"))
}

fn texels([width, height, depth]: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    (0..depth).flat_map(move |z| (0..height).flat_map(move |y| (0..width).map(move |x| [x, y, z])))
}

/// The texel of a pixel of a region.
fn moved(at: [u32; 3], region: Region) -> [u32; 3] {
    [0, 1, 2].map(|axis| region.origin[axis] + at[axis])
}
