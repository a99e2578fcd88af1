//! Calls that give textures their storage, and views of it (OpenGL 4.6 core, sections 8.14.4, 8.18 and 8.19).

use super::{
    context::Context,
    error::{invalid_operation, invalid_value},
    names::written,
    storage::{Storage, is_in_view_class},
    textures::TextureObject,
};
use crate::{
    error::Result,
    format::Format,
    texture::{Texture, TextureKind, TextureSize, ViewRange},
};

impl Context {
    /// Gives a texture immutable storage of zero bits (section 8.19).
    ///
    /// # Errors
    /// For names without objects, storage that is there already, kinds with samples, and a size or number of levels
    /// that the kind does not have.
    pub fn texture_storage(&self, texture: u32, levels: u32, format: Format, size: TextureSize) -> Result<()> {
        self.give_storage(texture, "texture_storage", |kind| {
            if kind.is_multisample() {
                return invalid_operation("texture_storage", format_args!("a {kind:?} texture has samples"));
            }
            Texture::new(kind, format, size, levels)
        })
    }

    /// Gives a texture with samples immutable storage of zero bits (section 8.19).
    ///
    /// # Errors
    /// For names without objects, storage that is there already, kinds without samples, formats that cannot be drawn
    /// to, and a size or number of samples that the kind does not have.
    pub fn texture_storage_multisample(
        &self,
        texture: u32,
        samples: u32,
        format: Format,
        size: TextureSize,
    ) -> Result<()> {
        self.give_storage(texture, "texture_storage_multisample", |kind| {
            if !kind.is_multisample() {
                let rule = format_args!("a {kind:?} texture has no samples");
                return invalid_operation("texture_storage_multisample", rule);
            }
            Texture::multisample(kind, format, size, samples)
        })
    }

    fn give_storage(
        &self,
        texture: u32,
        call: &'static str,
        new: impl FnOnce(TextureKind) -> Result<Texture>,
    ) -> Result<()> {
        let texture = self.shared.borrow().textures.object(texture, call)?;
        let mut texture = written(&texture, call)?;
        if texture.storage.is_some() {
            return invalid_operation(call, "the storage is immutable");
        }
        if texture.kind == TextureKind::Buffer {
            return invalid_operation(call, "texels of a buffer texture are those of a buffer, which is not there yet");
        }
        match new(texture.kind) {
            Ok(texels) => texture.storage = Some(Storage::new(texels)),
            Err(error) if error.call == call => return Err(error),
            Err(error) => return invalid_value(call, error.rule),
        }
        Ok(())
    }

    /// Makes a generated name that of a texture which shares the texels of another: the levels and layers of a range,
    /// from those of the other on, as a kind and in a format that fit them (section 8.18). Both live as long as either.
    ///
    /// # Errors
    /// For a name that was not generated or has its object already, another without storage, and a range, a kind or a
    /// format that does not fit.
    pub fn texture_view(&self, texture: u32, original: u32, range: ViewRange) -> Result<()> {
        const CALL: &str = "texture_view";
        let mut shared = self.shared.borrow_mut();
        let source = shared.textures.object(original, CALL)?;
        let source = source.borrow();
        let storage = source.storage(CALL)?;
        if shared.textures.has_object(texture) {
            return invalid_operation(CALL, format_args!("texture {texture} has its object already"));
        }
        let (own, format, kind) = (storage.format(), range.format, range.kind);
        if kind == TextureKind::Buffer {
            return invalid_operation(CALL, "a buffer texture has no views");
        }
        if own != format && !(is_in_view_class(own) && is_in_view_class(format) && own.bytes() == format.bytes()) {
            return invalid_operation(CALL, format_args!("{own:?} cannot be seen as {format:?}"));
        }
        let view = match storage.view(range) {
            Ok(view) => view,
            Err(error) if error.rule.contains("texture cannot be seen as") => {
                return invalid_operation(CALL, error.rule);
            }
            Err(error) => return invalid_value(CALL, error.rule),
        };
        let object = shared.textures.first_use(texture, CALL, || TextureObject::new(kind))?;
        object.borrow_mut().storage = Some(view);
        Ok(())
    }

    /// Makes the levels of a texture from its first (section 8.14.4).
    ///
    /// # Errors
    /// For names without objects, textures without storage or of kinds without levels, and formats that cannot be
    /// averaged.
    pub fn generate_texture_mipmap(&self, texture: u32) -> Result<()> {
        const CALL: &str = "generate_texture_mipmap";
        let texture = self.shared.borrow().textures.object(texture, CALL)?;
        let texture = texture.borrow();
        let storage = texture.storage(CALL)?;
        if !texture.kind.has_levels() {
            return invalid_operation(CALL, format_args!("a {:?} texture has no levels", texture.kind));
        }
        let mut texels = written(&storage.texels, CALL)?;
        let whole = storage.range.levels == (0..texels.level_count()) && storage.range.format == texels.format();
        if !whole || storage.range.layers != (0..texels.size().layers) {
            return invalid_operation(CALL, "the texture is a view of a part, or in another format");
        }
        match texels.generate_levels() {
            Err(error) => invalid_operation(CALL, error.rule),
            Ok(()) => Ok(()),
        }
    }
}
