//! Framebuffers: attachment points, draw buffers and completeness (OpenGL 4.6 core, sections 9.2, 9.4 and 17.4.1).

use std::{collections::BTreeMap, rc::Rc};

use super::{
    context::Context,
    error::{invalid_operation, invalid_value},
    names::Object,
    storage::Storage,
    textures::TextureObject,
};
use crate::{error::Result, format::Numeric, state::MAX_TARGETS, texture::TextureKind};

/// Target that a framebuffer is bound to (section 9.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramebufferTarget {
    /// Destination of draws, clears and blits.
    Draw,
    /// Source of copies and blits.
    Read,
    /// Both.
    Both,
}

/// Point of a framebuffer that an image is attached to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AttachmentPoint {
    /// Colours: 0 to 7.
    Color(u32),
    /// Depths.
    Depth,
    /// Stencil values.
    Stencil,
    /// Both depths and stencil values.
    DepthStencil,
}

/// State of a framebuffer: complete, or the rule that is broken (section 9.4.2). With several, the first counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramebufferStatus {
    /// It can be drawn to.
    Complete,
    /// An attached image has no storage, or a format that its point does not take.
    IncompleteAttachment,
    /// No image is attached.
    MissingAttachment,
    /// A draw buffer names a point without an image. A rule of OpenGL up to 4.0, which the reference pages still have.
    IncompleteDrawBuffer,
    /// The read buffer names a point without an image, likewise.
    IncompleteReadBuffer,
    /// Depths and stencil values are of different images, which cards do not support.
    Unsupported,
    /// Attached images have different numbers of samples.
    IncompleteMultisample,
    /// Some images are attached with all layers and others with one, or colours have textures of different kinds.
    IncompleteLayerTargets,
}

/// Attached level of a texture or renderbuffer, and one layer of it or all.
#[derive(Clone, Debug)]
pub(super) struct Attachment {
    pub image: Object<TextureObject>,
    pub level: u32,
    pub layer: Option<u32>,
}

/// Attachments by point, colour buffers that locations of outputs are drawn to, and the one that is read from.
#[derive(Debug)]
pub(super) struct FramebufferObject {
    pub attachments: BTreeMap<AttachmentPoint, Attachment>,
    pub draw_buffers: Vec<Option<u32>>,
    pub read_buffer: Option<u32>,
}

impl Default for FramebufferObject {
    fn default() -> Self {
        Self { attachments: BTreeMap::new(), draw_buffers: vec![Some(0)], read_buffer: Some(0) }
    }
}

impl FramebufferObject {
    /// Takes a texture or renderbuffer out of all attachments.
    pub fn detach(&mut self, image: &Object<TextureObject>) {
        self.attachments.retain(|_, attachment| !Rc::ptr_eq(&attachment.image, image));
    }

    /// Another with the attachments.
    pub fn copied(&self) -> Self {
        Self { attachments: self.attachments.clone(), draw_buffers: self.draw_buffers.clone(), ..*self }
    }

    pub fn color(&self, number: u32) -> Option<&Attachment> {
        self.attachments.get(&AttachmentPoint::Color(number))
    }

    /// The rules of sections 9.4.1 and 9.4.2.
    pub fn status(&self) -> FramebufferStatus {
        let mut images = Vec::new();
        for (point, attachment) in &self.attachments {
            match attachment.storage() {
                Some(storage) if takes(*point, &storage) && attachment.is_within(&storage) => {
                    images.push((point, attachment, storage))
                }
                _ => return FramebufferStatus::IncompleteAttachment,
            }
        }
        let Some((_, first, storage)) = images.first() else { return FramebufferStatus::MissingAttachment };
        if self.draw_buffers.iter().flatten().any(|number| self.color(*number).is_none()) {
            return FramebufferStatus::IncompleteDrawBuffer;
        }
        if self.read_buffer.is_some_and(|number| self.color(number).is_none()) {
            return FramebufferStatus::IncompleteReadBuffer;
        }
        let of = |point: AttachmentPoint| self.attachments.get(&point);
        let same =
            |a: &Attachment, b: &Attachment| Rc::ptr_eq(&a.image, &b.image) && (a.level, a.layer) == (b.level, b.layer);
        if of(AttachmentPoint::Depth).zip(of(AttachmentPoint::Stencil)).is_some_and(|(a, b)| !same(a, b)) {
            return FramebufferStatus::Unsupported;
        }
        if images.iter().any(|(.., other)| other.samples != storage.samples) {
            return FramebufferStatus::IncompleteMultisample;
        }
        let is_color = |point: &AttachmentPoint| matches!(point, AttachmentPoint::Color(_));
        let layered = first.layer.is_none();
        let differs = |(point, attachment, other): &(&AttachmentPoint, &Attachment, Storage)| {
            // Points are in order, so that the first is a colour if there are colours.
            attachment.layer.is_none() != layered
                || layered && is_color(point) && other.range.kind != storage.range.kind
        };
        if images.iter().any(differs) {
            return FramebufferStatus::IncompleteLayerTargets;
        }
        FramebufferStatus::Complete
    }
}

impl Attachment {
    /// True if level and layer are there: storage may have come after the attachment.
    fn is_within(&self, storage: &Storage) -> bool {
        self.level < storage.levels() && self.layer.is_none_or(|layer| layer < storage.sides(self.level)[2])
    }

    pub fn storage(&self) -> Option<Storage> {
        self.image.borrow().storage.clone()
    }
}

/// True if a point takes an image: its format can be drawn to there, and level and layer are there.
fn takes(point: AttachmentPoint, storage: &Storage) -> bool {
    let format = storage.format();
    match point {
        AttachmentPoint::Color(_) => format.is_color_renderable(),
        AttachmentPoint::Depth => matches!(format.numeric(), Numeric::Depth | Numeric::DepthStencil),
        AttachmentPoint::Stencil => matches!(format.numeric(), Numeric::Stencil | Numeric::DepthStencil),
        AttachmentPoint::DepthStencil => false,
    }
}

impl Context {
    /// Attaches a level of a texture to a point of a framebuffer: all layers, where the kind has them, for layered
    /// drawing; the name 0 detaches (section 9.2.8).
    ///
    /// # Errors
    /// For names without objects, colours from 8 on, buffer textures, and a level that the storage lacks.
    pub fn named_framebuffer_texture(
        &mut self,
        framebuffer: u32,
        point: AttachmentPoint,
        texture: u32,
        level: u32,
    ) -> Result<()> {
        self.attach_texture(framebuffer, point, texture, (level, None), "named_framebuffer_texture")
    }

    /// Attaches a level and one layer of a texture (slices of volumes and faces count as layers) to a point of a
    /// framebuffer; the name 0 detaches (section 9.2.8).
    ///
    /// # Errors
    /// As [`named_framebuffer_texture`](Self::named_framebuffer_texture), for kinds without layers, and for a layer
    /// that the storage lacks.
    pub fn named_framebuffer_texture_layer(
        &mut self,
        framebuffer: u32,
        point: AttachmentPoint,
        texture: u32,
        (level, layer): (u32, u32),
    ) -> Result<()> {
        self.attach_texture(framebuffer, point, texture, (level, Some(layer)), "named_framebuffer_texture_layer")
    }

    fn attach_texture(
        &mut self,
        framebuffer: u32,
        point: AttachmentPoint,
        texture: u32,
        (level, layer): (u32, Option<u32>),
        call: &'static str,
    ) -> Result<()> {
        if texture == 0 {
            return self.attach(framebuffer, point, None, call);
        }
        let image = self.shared.borrow().textures.object(texture, call)?;
        let kind = image.borrow().kind;
        let has_layers = match kind {
            TextureKind::Buffer => return invalid_operation(call, "a buffer texture cannot be attached"),
            TextureKind::D1 | TextureKind::D2 | TextureKind::Rectangle | TextureKind::D2Multisample => false,
            _ => true,
        };
        if layer.is_some() && !has_layers {
            return invalid_operation(call, format_args!("a {kind:?} texture has no layers"));
        }
        if let Some(storage) = &image.borrow().storage
            && (level >= storage.levels() || layer.is_some_and(|layer| layer >= storage.sides(level)[2]))
        {
            let layer = layer.unwrap_or(0);
            return invalid_value(call, format_args!("level {level} and layer {layer} are not both there"));
        }
        let layer = layer.or((!has_layers).then_some(0));
        self.attach(framebuffer, point, Some(Attachment { image, level, layer }), call)
    }

    /// Attaches a renderbuffer to a point of a framebuffer; the name 0 detaches (section 9.2.7).
    ///
    /// # Errors
    /// For names without objects, and colours from 8 on.
    pub fn named_framebuffer_renderbuffer(
        &mut self,
        framebuffer: u32,
        point: AttachmentPoint,
        renderbuffer: u32,
    ) -> Result<()> {
        const CALL: &str = "named_framebuffer_renderbuffer";
        let attachment = match renderbuffer {
            0 => None,
            _ => {
                let image = self.shared.borrow().renderbuffers.object(renderbuffer, CALL)?;
                Some(Attachment { image, level: 0, layer: Some(0) })
            }
        };
        self.attach(framebuffer, point, attachment, CALL)
    }

    fn attach(
        &mut self,
        framebuffer: u32,
        point: AttachmentPoint,
        attachment: Option<Attachment>,
        call: &'static str,
    ) -> Result<()> {
        let object = self.framebuffers.object(framebuffer, call)?;
        let points = match point {
            AttachmentPoint::DepthStencil => vec![AttachmentPoint::Depth, AttachmentPoint::Stencil],
            AttachmentPoint::Color(number) if number as usize >= MAX_TARGETS => {
                return invalid_operation(call, format_args!("colour attachment {number}; there are {MAX_TARGETS}"));
            }
            _ => vec![point],
        };
        let mut object = object.borrow_mut();
        for point in points {
            match &attachment {
                Some(attachment) => drop(object.attachments.insert(point, attachment.clone())),
                None => drop(object.attachments.remove(&point)),
            }
        }
        Ok(())
    }

    /// Sets the colour attachments that a fragment shader's outputs are drawn to, by location; `None` drops an output.
    /// At first location 0 is drawn to attachment 0 (section 17.4.1).
    ///
    /// # Errors
    /// For names without objects, more than 8 locations, and attachments from 8 on or named twice.
    pub fn named_framebuffer_draw_buffers(&mut self, framebuffer: u32, buffers: &[Option<u32>]) -> Result<()> {
        const CALL: &str = "named_framebuffer_draw_buffers";
        let object = self.framebuffers.object(framebuffer, CALL)?;
        if buffers.len() > MAX_TARGETS {
            return invalid_value(CALL, format_args!("{} locations; there are {MAX_TARGETS}", buffers.len()));
        }
        for (location, number) in buffers.iter().enumerate().filter_map(|(i, number)| Some((i, (*number)?))) {
            check_color(number, CALL)?;
            if buffers[..location].contains(&Some(number)) {
                return invalid_operation(CALL, format_args!("colour attachment {number} for two locations"));
            }
        }
        object.borrow_mut().draw_buffers = buffers.to_vec();
        Ok(())
    }

    /// Sets the colour attachment that copies read from; at first 0 (section 18.2.1).
    ///
    /// # Errors
    /// For names without objects, and attachments from 8 on.
    pub fn named_framebuffer_read_buffer(&mut self, framebuffer: u32, buffer: Option<u32>) -> Result<()> {
        const CALL: &str = "named_framebuffer_read_buffer";
        let object = self.framebuffers.object(framebuffer, CALL)?;
        buffer.map_or(Ok(()), |number| check_color(number, CALL))?;
        object.borrow_mut().read_buffer = buffer;
        Ok(())
    }

    /// The state of a framebuffer; that of the name 0 is complete.
    ///
    /// # Errors
    /// For names without objects.
    pub fn check_named_framebuffer_status(&self, framebuffer: u32) -> Result<FramebufferStatus> {
        if framebuffer == 0 {
            return Ok(FramebufferStatus::Complete);
        }
        Ok(self.framebuffers.object(framebuffer, "check_named_framebuffer_status")?.borrow().status())
    }
}

fn check_color(number: u32, call: &'static str) -> Result<()> {
    if number as usize >= MAX_TARGETS {
        return invalid_operation(call, format_args!("colour attachment {number}; there are {MAX_TARGETS}"));
    }
    Ok(())
}
