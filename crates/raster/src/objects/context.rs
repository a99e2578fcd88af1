//! A context: the bindings of one user of a share group (OpenGL 4.6 core, sections 2.5 and 5.1).

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use glam::Vec4;

use super::{
    buffers::Buffer,
    containers::VertexArrayObject,
    error::{invalid_operation, invalid_value},
    feedback::Feedback,
    framebuffers::{FramebufferObject, FramebufferTarget},
    images::ImageBinding,
    indexed::IndexedBuffer,
    names::{Names, Object, refers_to},
    queries::Queries,
    textures::{PixelStore, TextureObject},
};
use crate::{
    error::Result,
    render_target::Framebuffer,
    texture::{Sampler, TextureKind},
    vertex_array::MAX_ATTRIBUTES,
};

/// The most texture units.
pub(super) const MAX_UNITS: u32 = 80;

/// Targets that buffers are bound to (table 6.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BufferTarget {
    /// Attributes of vertices, as a handle: vertex arrays refer to their buffers by name.
    Array,
    /// Atomic counters, by index.
    AtomicCounter,
    /// Source of copies.
    CopyRead,
    /// Destination of copies.
    CopyWrite,
    /// Parameters of dispatches.
    DispatchIndirect,
    /// Parameters of draws.
    DrawIndirect,
    /// Indices: the binding belongs to the vertex array that is bound.
    ElementArray,
    /// Counts of draws whose parameters are in a buffer.
    Parameter,
    /// Destination of pixels that are read from textures.
    PixelPack,
    /// Source of pixels that are written to textures.
    PixelUnpack,
    /// Results of queries.
    Query,
    /// Storage blocks, by index.
    ShaderStorage,
    /// Texels of buffer textures, as a handle.
    Texture,
    /// Vertices that transform feedback writes.
    TransformFeedback,
    /// Uniform blocks, by index.
    Uniform,
}

/// A buffer in a call: the one that is bound to a target, or that of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BufferRef {
    /// The buffer that is bound to this target.
    Target(BufferTarget),
    /// The buffer of this name (direct state access).
    Name(u32),
}

impl From<BufferTarget> for BufferRef {
    fn from(target: BufferTarget) -> Self {
        Self::Target(target)
    }
}

impl From<u32> for BufferRef {
    fn from(name: u32) -> Self {
        Self::Name(name)
    }
}

/// Names and objects that several contexts share: buffers, textures, renderbuffers and samplers. Containers and queries
/// are not shared (section 5.1). The contexts of a group live in one thread.
#[derive(Clone, Debug)]
pub struct ShareGroup(pub(super) Rc<RefCell<Shared>>);

#[derive(Debug)]
pub(super) struct Shared {
    pub buffers: Names<Buffer>,
    pub textures: Names<TextureObject>,
    pub renderbuffers: Names<TextureObject>,
    pub samplers: Names<Sampler>,
}

impl ShareGroup {
    /// A group without names.
    pub fn new() -> Self {
        Self(Rc::new(RefCell::new(Shared {
            buffers: Names::new("buffer"),
            textures: Names::new("texture"),
            renderbuffers: Names::new("renderbuffer"),
            samplers: Names::new("sampler"),
        })))
    }
}

impl Default for ShareGroup {
    fn default() -> Self {
        Self::new()
    }
}

/// A context: bindings, the objects that it shares, those of its own, and the default framebuffer.
#[derive(Debug)]
pub struct Context {
    pub(super) shared: Rc<RefCell<Shared>>,
    /// Buffers by target, but for indices, which vertex arrays hold.
    pub(super) buffers: BTreeMap<BufferTarget, Object<Buffer>>,
    /// Textures by unit and kind.
    pub(super) textures: BTreeMap<(u32, u8), Object<TextureObject>>,
    /// Samplers by unit.
    pub(super) samplers: BTreeMap<u32, Object<Sampler>>,
    /// Images by unit.
    pub(super) images: BTreeMap<u32, ImageBinding>,
    /// Buffers by target and index.
    pub(super) indexed: BTreeMap<(BufferTarget, u32), IndexedBuffer>,
    pub(super) vertex_arrays: Names<VertexArrayObject>,
    pub(super) vertex_array: Option<Object<VertexArrayObject>>,
    pub(super) framebuffers: Names<FramebufferObject>,
    pub(super) draw_framebuffer: Option<Object<FramebufferObject>>,
    pub(super) read_framebuffer: Option<Object<FramebufferObject>>,
    pub(super) queries: Queries,
    /// Values of attributes that are not enabled.
    pub(super) constants: [Vec4; MAX_ATTRIBUTES],
    pub(super) pack: PixelStore,
    pub(super) unpack: PixelStore,
    pub(super) feedback: Option<Feedback>,
    pub(super) rasterizer_discard: bool,
    pub(super) default: Framebuffer,
}

impl Context {
    /// A context of a share group, nothing bound, with the framebuffer that is bound under the name 0.
    pub fn new(group: &ShareGroup, default: Framebuffer) -> Self {
        Self {
            shared: Rc::clone(&group.0),
            buffers: BTreeMap::new(),
            textures: BTreeMap::new(),
            samplers: BTreeMap::new(),
            images: BTreeMap::new(),
            indexed: BTreeMap::new(),
            vertex_arrays: Names::new("vertex array"),
            vertex_array: None,
            framebuffers: Names::new("framebuffer"),
            draw_framebuffer: None,
            read_framebuffer: None,
            queries: Queries::new(),
            constants: [Vec4::W; MAX_ATTRIBUTES],
            pack: PixelStore::default(),
            unpack: PixelStore::default(),
            feedback: None,
            rasterizer_discard: false,
            default,
        }
    }

    /// The framebuffer of the name 0.
    pub fn default_framebuffer(&self) -> &Framebuffer {
        &self.default
    }

    /// Binds a buffer to a target, or with 0 none (section 6.1). A generated name gets its object now.
    ///
    /// # Errors
    /// For names that were not generated, for indices without a vertex array, and for the target of transform feedback
    /// while that is active.
    pub fn bind_buffer(&mut self, target: BufferTarget, name: u32) -> Result<()> {
        const CALL: &str = "bind_buffer";
        if target == BufferTarget::TransformFeedback && self.feedback.is_some() {
            return invalid_operation(CALL, "transform feedback is active");
        }
        if target == BufferTarget::ElementArray && self.vertex_array.is_none() {
            return invalid_operation(CALL, "indices belong to a vertex array, and none is bound");
        }
        let object = match name {
            0 => None,
            _ => Some(self.shared.borrow_mut().buffers.first_use(name, CALL, Buffer::new)?),
        };
        match (&self.vertex_array, object) {
            (Some(array), object) if target == BufferTarget::ElementArray => array.borrow_mut().elements = object,
            (_, Some(object)) => drop(self.buffers.insert(target, object)),
            (_, None) => drop(self.buffers.remove(&target)),
        }
        Ok(())
    }

    /// Binds a texture to a unit, or with 0 none (section 8.1): `glActiveTexture` and `glBindTexture` in one. A
    /// generated name gets its object, of the target's kind, now.
    ///
    /// # Errors
    /// For names that were not generated, units beyond the last (79), and a texture of another kind.
    pub fn bind_texture(&mut self, unit: u32, target: TextureKind, name: u32) -> Result<()> {
        const CALL: &str = "bind_texture";
        if unit >= MAX_UNITS {
            return invalid_value(CALL, format_args!("unit {unit}; there are {MAX_UNITS}"));
        }
        if name == 0 {
            self.textures.remove(&(unit, target as u8));
            return Ok(());
        }
        let object = self.shared.borrow_mut().textures.first_use(name, CALL, || TextureObject::new(target))?;
        let kind = object.borrow().kind;
        if kind != target {
            return invalid_operation(CALL, format_args!("texture {name} is {kind:?}, not {target:?}"));
        }
        self.textures.insert((unit, target as u8), object);
        Ok(())
    }

    /// Binds a vertex array, or with 0 none (section 10.3.1).
    ///
    /// # Errors
    /// For names that were not generated by this context.
    pub fn bind_vertex_array(&mut self, name: u32) -> Result<()> {
        self.vertex_array = match name {
            0 => None,
            _ => Some(self.vertex_arrays.first_use(name, "bind_vertex_array", VertexArrayObject::default)?),
        };
        Ok(())
    }

    /// Binds a framebuffer to a target, or with 0 the default one (section 9.2).
    ///
    /// # Errors
    /// For names that were not generated by this context.
    pub fn bind_framebuffer(&mut self, target: FramebufferTarget, name: u32) -> Result<()> {
        let object = match name {
            0 => None,
            _ => Some(self.framebuffers.first_use(name, "bind_framebuffer", FramebufferObject::default)?),
        };
        if target != FramebufferTarget::Read {
            self.draw_framebuffer = object.clone();
        }
        if target != FramebufferTarget::Draw {
            self.read_framebuffer = object;
        }
        Ok(())
    }

    /// The name of the buffer that is bound to a target; 0 if there is none or its name is deleted.
    pub fn buffer_binding(&self, target: BufferTarget) -> u32 {
        self.bound_buffer(target).map_or(0, |buffer| self.shared.borrow().buffers.name_of(&buffer))
    }

    pub(super) fn bound_buffer(&self, target: BufferTarget) -> Option<Object<Buffer>> {
        match target {
            BufferTarget::ElementArray => self.vertex_array.as_ref()?.borrow().elements.clone(),
            _ => self.buffers.get(&target).cloned(),
        }
    }

    /// The buffer that a call names.
    pub(super) fn buffer(&self, buffer: impl Into<BufferRef>, call: &'static str) -> Result<Object<Buffer>> {
        match buffer.into() {
            BufferRef::Name(name) => self.shared.borrow().buffers.object(name, call),
            BufferRef::Target(target) => match self.bound_buffer(target) {
                Some(buffer) => Ok(buffer),
                None => invalid_operation(call, format_args!("no buffer is bound to {target:?}")),
            },
        }
    }

    /// Takes a deleted buffer out of this context's bindings and the containers that it has bound; other contexts and
    /// containers keep it (section 5.1.2).
    pub(super) fn unbind_buffer(&mut self, buffer: &Object<Buffer>) {
        self.buffers.retain(|_, bound| !Rc::ptr_eq(bound, buffer));
        self.indexed.retain(|_, bound| !Rc::ptr_eq(&bound.buffer, buffer));
        if let Some(array) = &self.vertex_array {
            array.borrow_mut().detach(buffer);
        }
    }

    /// Takes a deleted texture out of this context's bindings and the framebuffers that it has bound.
    pub(super) fn unbind_texture(&mut self, texture: &Object<TextureObject>) {
        self.textures.retain(|_, bound| !Rc::ptr_eq(bound, texture));
        self.images.retain(|_, bound| !Rc::ptr_eq(&bound.texture, texture));
        self.detach(texture);
    }

    /// Takes a deleted texture or renderbuffer out of the framebuffers that are bound (section 9.2.8).
    pub(super) fn detach(&self, image: &Object<TextureObject>) {
        for framebuffer in self.draw_framebuffer.iter().chain(&self.read_framebuffer) {
            framebuffer.borrow_mut().detach(image);
        }
    }

    pub(super) fn unbind_vertex_array(&mut self, array: &Object<VertexArrayObject>) {
        if refers_to(&self.vertex_array, array) {
            self.vertex_array = None;
        }
    }

    pub(super) fn unbind_framebuffer(&mut self, framebuffer: &Object<FramebufferObject>) {
        for bound in [&mut self.draw_framebuffer, &mut self.read_framebuffer] {
            if refers_to(bound, framebuffer) {
                *bound = None;
            }
        }
    }
}
