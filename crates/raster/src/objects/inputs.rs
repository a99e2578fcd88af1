//! Inputs of shaders: attributes and resources (OpenGL 4.6 core, sections 7.6, 7.7, 8.26 and 10.3).

use std::sync::atomic::AtomicU32;

use glam::{DVec4, Vec4};

use super::{
    context::BufferTarget,
    error::invalid_operation,
    images::{Image, ImageAccess},
    indexed::MAX_UNIFORM_BYTES,
    resources::{Bound, Resources},
};
use crate::{
    block_layout::{Block, BlockRules},
    error::Result,
    stages::VertexInput,
    texture::{Sampler, TextureKind, TextureView},
    vertex_array::VertexArray,
};

/// Attributes, textures, images and blocks as a draw or a dispatch finds them bound. Shaders refer to it.
#[derive(Debug)]
pub struct Inputs<'a> {
    pub(super) attributes: VertexArray<'a>,
    /// First instances of the draws.
    pub(super) first_instances: Vec<u32>,
    pub(super) resources: &'a Resources<'a>,
}

impl<'a> Inputs<'a> {
    /// Value of an attribute for a vertex, integers as bits. Components that the buffer does not have are 0, the last
    /// 1; so is all that lies beyond its bytes.
    #[inline]
    pub fn attribute(&self, number: usize, vertex: VertexInput) -> Vec4 {
        self.attributes.fetch(number, vertex, self.first_instance(vertex))
    }

    /// Value of an attribute in doubles: a shader's input of `Conversion::Long`.
    pub fn attribute_double(&self, number: usize, vertex: VertexInput) -> DVec4 {
        self.attributes.fetch_double(number, vertex, self.first_instance(vertex))
    }

    #[inline]
    fn first_instance(&self, vertex: VertexInput) -> u32 {
        self.first_instances.get(vertex.draw as usize).copied().unwrap_or(0)
    }

    /// The texture of a kind that is bound to a unit, from its base level to its last.
    ///
    /// # Errors
    /// An error for units without a texture, for textures without storage, and for those whose texels are attached to
    /// the framebuffer that is drawn to: a feedback loop (section 9.3.1).
    pub fn texture(&self, unit: u32, kind: TextureKind) -> Result<TextureView<'a>> {
        self.bound_texture(unit, kind, "Inputs::texture").map(|(texture, _)| texture)
    }

    /// As [`texture`](Self::texture), with the sampler that is bound to the unit, else that of the texture's parameters
    /// (section 8.2).
    ///
    /// # Errors
    /// As there, and for textures that are not complete: filters other than `Nearest` of integers and stencil values,
    /// and textures of buffers and with samples, which are fetched.
    pub fn sampler(&self, unit: u32, kind: TextureKind) -> Result<(TextureView<'a>, Sampler)> {
        const CALL: &str = "Inputs::sampler";
        let (texture, sampler) = self.bound_texture(unit, kind, CALL)?;
        match sampler.check(&texture) {
            Ok(()) => Ok((texture, sampler)),
            Err(error) => invalid_operation(CALL, error.rule),
        }
    }

    fn bound_texture(&self, unit: u32, kind: TextureKind, call: &'static str) -> Result<(TextureView<'a>, Sampler)> {
        match self.resources.textures.iter().find(|bound| bound.key == (unit, kind as u8)) {
            Some(Bound { feedback: Some(rule), .. }) => invalid_operation(call, rule),
            Some(bound) => Ok((bound.texture, bound.sampler)),
            None => invalid_operation(call, format_args!("no {kind:?} texture with storage is bound to unit {unit}")),
        }
    }

    /// The image of a unit, for an access that its binding allows.
    ///
    /// # Errors
    /// An error for units without an image, for another access than that of the binding, and for images that are
    /// attached to the framebuffer that is drawn to.
    pub fn image(&self, unit: u32, access: ImageAccess) -> Result<Image<'a>> {
        const CALL: &str = "Inputs::image";
        match self.resources.image(unit) {
            Some(Ok(image)) => image.checked(unit, access, CALL),
            Some(Err(rule)) => invalid_operation(CALL, rule),
            None => invalid_operation(CALL, format_args!("no image is bound to unit {unit}")),
        }
    }

    /// The uniform block at an index, laid out by `std140`, as it was before the command.
    ///
    /// # Errors
    /// An error for indices without a buffer, fewer bytes than the block has, and blocks of more than 64 KiB.
    pub fn uniform<B: Block>(&self, index: u32) -> Result<B> {
        const CALL: &str = "Inputs::uniform";
        let Some(bytes) = self.resources.bytes(BufferTarget::Uniform, index) else {
            return invalid_operation(CALL, format_args!("no buffer is bound to index {index} of Uniform"));
        };
        if B::size(BlockRules::Std140) > MAX_UNIFORM_BYTES {
            return invalid_operation(CALL, format_args!("a block of more than {MAX_UNIFORM_BYTES} bytes"));
        }
        B::from_bytes(BlockRules::Std140, bytes).or_else(|error| invalid_operation(CALL, error.rule))
    }

    /// Words of the storage block at an index, which all invocations share; bytes after the last whole word are left
    /// out.
    ///
    /// # Errors
    /// An error for indices without a buffer.
    pub fn storage(&self, index: u32) -> Result<&'a [AtomicU32]> {
        match self.resources.words(BufferTarget::ShaderStorage, index) {
            Some(words) => Ok(words),
            None => {
                let rule = format_args!("no buffer is bound to index {index} of ShaderStorage");
                invalid_operation("Inputs::storage", rule)
            }
        }
    }

    /// The atomic counter at a byte of the buffer at an index.
    ///
    /// # Errors
    /// An error for indices without a buffer, and bytes that are no multiple of 4 or not there.
    pub fn counter(&self, index: u32, offset: usize) -> Result<&'a AtomicU32> {
        const CALL: &str = "Inputs::counter";
        let Some(words) = self.resources.words(BufferTarget::AtomicCounter, index) else {
            return invalid_operation(CALL, format_args!("no buffer is bound to index {index} of AtomicCounter"));
        };
        match words.get(offset / 4).filter(|_| offset.is_multiple_of(4)) {
            Some(counter) => Ok(counter),
            None => invalid_operation(CALL, format_args!("no counter is at byte {offset}")),
        }
    }

    /// Resources without attributes.
    pub(super) fn of_dispatch(resources: &'a Resources<'a>) -> Self {
        Self { attributes: VertexArray::new(), first_instances: Vec::new(), resources }
    }
}
