//! Renderbuffers: images that are drawn to and not sampled (OpenGL 4.6 core, section 9.2.4).

use super::{
    context::Context,
    error::{invalid_enum, invalid_value},
    names::written,
    storage::Storage,
    textures::TextureObject,
};
use crate::{
    error::Result,
    format::{Format, Numeric},
    texture::{Texture, TextureKind, TextureSize},
};

impl Context {
    /// Makes renderbuffers without storage.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn create_renderbuffers(&mut self, count: usize) -> Result<Vec<u32>> {
        let new = || TextureObject::new(TextureKind::D2Multisample);
        self.shared.borrow_mut().renderbuffers.create(count, "create_renderbuffers", new)
    }

    /// Deletes names of renderbuffers.
    pub fn delete_renderbuffers(&mut self, names: &[u32]) {
        for name in names {
            let deleted = self.shared.borrow_mut().renderbuffers.delete(*name);
            if let Some(image) = deleted {
                self.detach(&image);
            }
        }
    }

    /// True if the name is that of a renderbuffer.
    pub fn is_renderbuffer(&self, name: u32) -> bool {
        self.shared.borrow().renderbuffers.has_object(name)
    }

    /// Gives a renderbuffer storage of zero bits in the place of what it has, with so many samples; 0 are as 1.
    ///
    /// # Errors
    /// For names without objects, formats that cannot be drawn to, and a size or number of samples that there is not.
    pub fn named_renderbuffer_storage(
        &mut self,
        renderbuffer: u32,
        samples: u32,
        format: Format,
        [width, height]: [u32; 2],
    ) -> Result<()> {
        const CALL: &str = "named_renderbuffer_storage";
        let image = self.shared.borrow().renderbuffers.object(renderbuffer, CALL)?;
        if format.numeric() == Numeric::SharedExponent {
            return invalid_enum(CALL, format_args!("{format:?} cannot be drawn to"));
        }
        let size = TextureSize::d2(width, height);
        match Texture::multisample(TextureKind::D2Multisample, format, size, samples.max(1)) {
            Ok(texels) => written(&image, CALL)?.storage = Some(Storage::new(texels)),
            Err(error) => return invalid_value(CALL, error.rule),
        }
        Ok(())
    }
}
