//! Clears of textures and copies between them (OpenGL 4.6 core, sections 8.21 and 18.3.3).

use super::{
    context::Context,
    error::{invalid_enum, invalid_operation, invalid_value},
    names::written,
    storage::{Storage, is_in_view_class},
    textures::{Region, check, check_transfer},
};
use crate::{
    error::Result,
    format::{Format, Numeric},
    render_target::{ColorTarget, DepthTarget, Extent},
    texture::TextureKind,
};

impl Context {
    /// Fills a region of a texture, all samples, with a pixel of a format, or with zeros for no bytes:
    /// `glClearTexSubImage`.
    ///
    /// # Errors
    /// For names without objects, textures without storage, a region that is not all there, formats of integers and of
    /// floats mixed, and a pixel of another length than the format's.
    pub fn clear_texture_sub_image(&self, texture: u32, region: Region, format: Format, pixel: &[u8]) -> Result<()> {
        const CALL: &str = "clear_texture_sub_image";
        let texture = self.shared.borrow().textures.object(texture, CALL)?;
        let texture = texture.borrow();
        let storage = texture.storage(CALL)?;
        check(storage, region, format, CALL)?;
        if !pixel.is_empty() && pixel.len() != format.bytes() {
            let rule = format_args!("a pixel of {} bytes; {format:?} has {}", pixel.len(), format.bytes());
            return invalid_value(CALL, rule);
        }
        let mut sample = vec![0; storage.format().bytes()];
        if !pixel.is_empty() {
            storage.format().write(format.read(pixel), &mut sample);
        }
        let mut texels = written(&storage.texels, CALL)?;
        for row in rows(region) {
            let bytes = storage.bytes_mut(&mut texels, region.level, row, region.size[0] as usize);
            bytes.chunks_exact_mut(sample.len()).for_each(|part| part.copy_from_slice(&sample));
        }
        Ok(())
    }

    /// Fills a level of a texture as [`clear_texture_sub_image`](Self::clear_texture_sub_image) does a region:
    /// `glClearTexImage`.
    ///
    /// # Errors
    /// As that call, and for a level that is not there.
    pub fn clear_texture_image(&self, texture: u32, level: u32, format: Format, pixel: &[u8]) -> Result<()> {
        const CALL: &str = "clear_texture_image";
        let object = self.shared.borrow().textures.object(texture, CALL)?;
        let size = object.borrow().storage(CALL)?.sides(level);
        let region = Region { level, origin: [0; 3], size };
        self.clear_texture_sub_image(texture, region, format, pixel).map_err(|mut error| {
            error.call = CALL;
            error
        })
    }

    /// Copies the bits of a region of a texture to another, or to other texels of it, from a level and texel on:
    /// `glCopyImageSubData`. Texels that are both read and written are read first.
    ///
    /// # Errors
    /// For names without objects, textures without storage, buffer textures, numbers of samples that differ, formats
    /// whose bits do not fit each other, and regions that are not all there.
    pub fn copy_image_sub_data(
        &self,
        (source, region): (u32, Region),
        (target, level, origin): (u32, u32, [u32; 3]),
    ) -> Result<()> {
        const CALL: &str = "copy_image_sub_data";
        let storage = |name: u32| -> Result<Storage> {
            let texture = self.shared.borrow().textures.object(name, CALL)?;
            let texture = texture.borrow();
            if texture.kind == TextureKind::Buffer {
                return invalid_enum(CALL, format_args!("texture {name} is a Buffer"));
            }
            texture.storage(CALL).cloned()
        };
        let (from, to) = (storage(source)?, storage(target)?);
        let written_region = Region { level, origin, size: region.size };
        check(&from, region, from.format(), CALL)?;
        check(&to, written_region, to.format(), CALL)?;
        if from.samples != to.samples {
            return invalid_operation(CALL, format_args!("{} samples to {}", from.samples, to.samples));
        }
        let (a, b) = (from.format(), to.format());
        if a != b && !(a.bytes() == b.bytes() && is_in_view_class(a) && is_in_view_class(b)) {
            return invalid_operation(CALL, format_args!("bits of {a:?} are not those of {b:?}"));
        }
        let width = region.size[0] as usize;
        let copied: Vec<Vec<u8>> = {
            let texels = from.texels.borrow();
            rows(region).map(|row| from.bytes(&texels, region.level, row, width).to_vec()).collect()
        };
        let mut texels = written(&to.texels, CALL)?;
        for (row, bytes) in rows(written_region).zip(copied) {
            to.bytes_mut(&mut texels, level, row, width).copy_from_slice(&bytes);
        }
        Ok(())
    }
}

impl Context {
    /// Copies pixels of the framebuffer that is read from, from one on, to as many texels of a texture as the region
    /// has: depths to formats of depth, else colours of the read buffer. Rows keep their order:
    /// `glCopyTextureSubImage2D`.
    ///
    /// # Errors
    /// For names without objects, textures without storage or with samples, a framebuffer that is not complete, has
    /// samples or lacks what is read, regions that are not all there, and formats of integers and of floats mixed.
    pub fn copy_texture_sub_image(&mut self, texture: u32, region: Region, from: [u32; 2]) -> Result<()> {
        const CALL: &str = "copy_texture_sub_image";
        let texture = self.shared.borrow().textures.object(texture, CALL)?;
        let texture = texture.borrow();
        let storage = texture.storage(CALL)?;
        let format = storage.format();
        check_transfer(storage, region, format, CALL)?;
        if region.size[2] > 1 {
            return invalid_value(CALL, format_args!("{} layers of pixels", region.size[2]));
        }
        let read = self.read(format, CALL)?;
        let extent = read.extent();
        if extent.samples > 1 {
            return invalid_operation(CALL, "the framebuffer has samples");
        }
        let ends = [0, 1].map(|axis| from[axis].checked_add(region.size[axis]));
        if !(ends[0].is_some_and(|end| end <= extent.width) && ends[1].is_some_and(|end| end <= extent.height)) {
            let rule = format_args!("{:?} pixels from {from:?} on are not all within {extent:?}", region.size);
            return invalid_value(CALL, rule);
        }
        let source = match &read {
            Read::Color(target) => target.format(),
            Read::Depth(_) => format,
        };
        check(storage, region, source, CALL)?;
        let mut texels = written(&storage.texels, CALL)?;
        for (row, start) in (0..).zip(rows(region)) {
            let bytes = storage.bytes_mut(&mut texels, region.level, start, region.size[0] as usize);
            for (column, texel) in (0..).zip(bytes.chunks_exact_mut(format.bytes())) {
                let at = [from[0] + column, from[1] + row];
                match &read {
                    Read::Color(target) => format.write(target.sample(at, 0, 0).unwrap_or_default(), texel),
                    Read::Depth(target) => {
                        // Stencil values stay.
                        let mut value = format.read(texel);
                        value.x = target.sample(at, 0, 0).unwrap_or(value.x);
                        format.write(value, texel);
                    }
                }
            }
        }
        Ok(())
    }

    /// The target of the framebuffer that is read from which pixels of a format are read from.
    fn read(&self, format: Format, call: &'static str) -> Result<Read> {
        let wants_depth = matches!(format.numeric(), Numeric::Depth | Numeric::DepthStencil);
        let (color, depth, _) = self.read_parts(call)?;
        match (wants_depth, depth, color) {
            (true, Some(depth), _) => Ok(Read::Depth(depth)),
            (false, _, Some(color)) => Ok(Read::Color(color)),
            _ => invalid_operation(call, format_args!("the framebuffer has nothing to read for {format:?}")),
        }
    }
}

/// A target that is read.
enum Read {
    Color(ColorTarget),
    Depth(DepthTarget),
}

impl Read {
    fn extent(&self) -> Extent {
        match self {
            Self::Color(target) => target.extent(),
            Self::Depth(target) => target.extent(),
        }
    }
}

/// First texels of the rows of a region.
fn rows(region: Region) -> impl Iterator<Item = [u32; 3]> {
    let [x, y, z] = region.origin;
    let [width, height, depth] = region.size;
    let height = if width == 0 { 0 } else { height };
    (0..depth).flat_map(move |slice| (0..height).map(move |row| [x, y + row, z + slice]))
}
