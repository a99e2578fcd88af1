//! Draws over what is bound: attributes, indices, textures, framebuffer, transform feedback (OpenGL 4.6 core, sections
//! 10.3, 10.4, 13.3 and 17.4).

use std::{cell::Ref, rc::Rc};

use glam::{DVec4, Vec4};

use super::{
    attached::{load, store},
    commands::Command,
    containers::source,
    context::Context,
    error::invalid_operation,
    feedback::{Feedback, FeedbackPrimitive},
    framebuffers::Attachment,
    names::{self, Object},
    storage::Storage,
};
use crate::{
    counters::Counters,
    draw::Draw,
    error::Result,
    pipeline::Pipeline,
    render_target::{Framebuffer, Layout},
    stages::{FragmentShader, GeometryShader, Tessellation, Vertex, VertexInput, VertexShader},
    texture::{Sampler, Texture, TextureKind, TextureView, ViewRange},
    varyings::Varyings,
    vertex_array::VertexArray,
};

/// Attributes and textures as a draw finds them bound. Shaders refer to it.
#[derive(Debug)]
pub struct Inputs<'a> {
    attributes: VertexArray<'a>,
    /// First instances of the draws.
    first_instances: Vec<u32>,
    textures: Vec<Bound<'a>>,
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

    /// As [`texture`](Self::texture), with the sampler of the texture's parameters.
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
        match self.textures.iter().find(|bound| bound.key == (unit, kind as u8)) {
            Some(Bound { feedback: Some(rule), .. }) => invalid_operation(call, rule),
            Some(bound) => Ok((bound.texture, bound.sampler)),
            None => invalid_operation(call, format_args!("no {kind:?} texture with storage is bound to unit {unit}")),
        }
    }
}

/// A texture that is bound, and its sampler.
#[derive(Debug)]
struct Bound<'a> {
    /// Unit and kind.
    key: (u32, u8),
    texture: TextureView<'a>,
    sampler: Sampler,
    /// The texture and the attachment that are a feedback loop.
    feedback: Option<String>,
}

/// Destination of a draw: framebuffer, and transform feedback where that has begun.
#[derive(Debug)]
pub struct Output<'a> {
    framebuffer: &'a mut Framebuffer,
    draws: Vec<Draw<'a>>,
    rasterizer_discard: bool,
    /// Kind of captured primitives, and bytes that there is still room for.
    feedback: Option<(FeedbackPrimitive, usize)>,
    captured: Vec<u8>,
    written: u64,
    counters: Counters,
}

impl Output<'_> {
    /// Formats of the framebuffer, for [`Pipeline::new`].
    pub fn layout(&self) -> Layout {
        self.framebuffer.layout()
    }

    /// Draws by a pipeline, each draw of the call in turn. Transform feedback captures, for each vertex, the position
    /// and the floats of the varyings, as 32-bit floats one after the other; whole primitives only, as long as there is
    /// room.
    ///
    /// # Errors
    /// An error for pipelines of another layout, and for primitives other than those that feedback captures.
    pub fn draw<V, T, G, F>(&mut self, pipeline: &Pipeline<V, T, G, F>) -> Result<Counters>
    where
        V: VertexShader,
        T: Tessellation<Input = V::Varyings>,
        G: GeometryShader<Input = T::Output>,
        F: FragmentShader<Varyings = G::Output>,
    {
        let mut counters = Counters::default();
        for draw in &self.draws {
            let mut of_draw = Counters::default();
            if self.feedback.is_some() || self.rasterizer_discard {
                let (vertices, of_capture) = pipeline.capture(draw);
                of_draw = of_capture;
                if let Some((primitive, room)) = &mut self.feedback {
                    let count = primitive.vertices();
                    if vertices.len() as u64 != of_draw.primitives * count as u64 {
                        let rule = format_args!("feedback of {primitive:?}, but the pipeline gives other primitives");
                        return invalid_operation("Output::draw", rule);
                    }
                    for vertices in vertices.chunks_exact(count) {
                        let bytes: Vec<u8> = vertices.iter().flat_map(captured).collect();
                        // A primitive that finds no room is generated but not written.
                        if bytes.len() > *room {
                            continue;
                        }
                        *room -= bytes.len();
                        self.captured.extend(bytes);
                        self.written += 1;
                    }
                }
            }
            if !self.rasterizer_discard {
                of_draw = pipeline.draw(self.framebuffer, draw)?;
            }
            counters += of_draw;
        }
        self.counters += counters;
        Ok(counters)
    }
}

/// Bytes of a vertex that feedback captures.
fn captured<V: Varyings>(vertex: &Vertex<V>) -> Vec<u8> {
    let (position, varyings) = (vertex.position.to_array(), vertex.varyings.to_floats());
    position.iter().chain(varyings.as_ref()).flat_map(|x| x.to_le_bytes()).collect()
}

/// Unit and kind of a bound texture, the part that lookups see, its sampler, its texels, and the rule that it breaks.
type BoundTexture = ((u32, u8), ViewRange, Sampler, Object<Texture>, Option<String>);

impl Context {
    /// Makes draws with what is bound.
    pub(super) fn submit<P>(&mut self, commands: &[Command], call: &'static str, program: P) -> Result<Counters>
    where
        P: FnOnce(&Inputs, &mut Output) -> Result<()>,
    {
        // Everything that is bound is borrowed for reading; what the draw writes to buffers and textures is kept aside
        // until it has ended.
        let Some(array) = self.vertex_array.clone() else { return invalid_operation(call, "no vertex array is bound") };
        let array = array.borrow();
        let enabled = || array.attributes.iter().enumerate().filter(|(_, attribute)| attribute.enabled);
        let mut buffers = Vec::new();
        for (number, attribute) in enabled() {
            match &array.bindings[attribute.binding].buffer {
                Some(buffer) => buffers.push(buffer.borrow()),
                None => return invalid_operation(call, format_args!("attribute {number} is enabled without a buffer")),
            }
        }
        let mut attributes = VertexArray::new();
        for (number, value) in self.constants.iter().enumerate() {
            attributes = attributes.constant(number, *value);
        }
        for ((number, attribute), buffer) in enabled().zip(&buffers) {
            let binding = &array.bindings[attribute.binding];
            attributes = attributes.attribute(number, source(buffer.all(call)?, attribute, binding))?;
        }
        let bound: Vec<BoundTexture> = self
            .textures
            .iter()
            .filter_map(|(key, texture)| {
                let texture = texture.borrow();
                let storage = texture.storage.clone()?;
                let seen = texture.parameters.seen(&storage);
                let feedback = self.feedback_loop(key.0, &storage, &seen);
                Some((*key, seen, texture.parameters.sampler(), storage.texels, feedback))
            })
            .collect();
        let borrowed: Vec<Ref<Texture>> = bound.iter().map(|(.., texels, _)| texels.borrow()).collect();
        let mut textures = Vec::new();
        for ((key, seen, sampler, _, feedback), texels) in bound.iter().zip(&borrowed) {
            let texture = texels.view_of(seen.clone())?;
            textures.push(Bound { key: *key, texture, sampler: *sampler, feedback: feedback.clone() });
        }
        let feedback = match &self.feedback {
            Some(Feedback { primitive, buffer, end }) => {
                Some((*primitive, buffer.borrow().all(call)?.len().saturating_sub(*end)))
            }
            None => None,
        };
        let object = self.framebuffer.clone();
        let mut loaded = match &object {
            Some(object) => Some(load(&object.borrow(), call)?),
            None => None,
        };
        if self.queries.drops() {
            return Ok(Counters::default());
        }
        let mut output = Output {
            framebuffer: loaded.as_mut().unwrap_or(&mut self.default),
            draws: (0..).zip(commands).map(|(number, command)| command.draw().numbered(number)).collect(),
            rasterizer_discard: self.rasterizer_discard,
            feedback,
            captured: Vec::new(),
            written: 0,
            counters: Counters::default(),
        };
        let first_instances = commands.iter().map(|command| command.instances.start).collect();
        let done = program(&Inputs { attributes, first_instances, textures }, &mut output);
        let Output { captured, written, counters, .. } = output;
        drop((buffers, borrowed));
        self.queries.count(&counters, written);
        if let Some(feedback) = self.feedback.as_mut().filter(|_| !captured.is_empty()) {
            let mut buffer = names::written(&feedback.buffer, call)?;
            buffer.write(feedback.end, captured.len(), call)?.copy_from_slice(&captured);
            feedback.end += captured.len();
        }
        if let (Some(object), Some(framebuffer)) = (object, loaded) {
            store(&object.borrow(), framebuffer, call)?;
        }
        done.map(|()| counters)
    }

    /// The attachment of the framebuffer that is drawn to with texels that lookups in a texture see, and both names.
    fn feedback_loop(&self, unit: u32, storage: &Storage, seen: &ViewRange) -> Option<String> {
        let framebuffer = self.framebuffer.as_ref()?;
        let object = framebuffer.borrow();
        let is_seen = |attachment: &Attachment| {
            let Some(image) = attachment.storage() else { return false };
            let level = image.range.levels.start + attachment.level;
            // Slices of volumes are seen together.
            let layers = match attachment.layer {
                Some(layer) if image.range.kind != TextureKind::D3 => {
                    let layer = image.range.layers.start + layer;
                    layer..layer + 1
                }
                _ => image.range.layers.clone(),
            };
            let common = layers.start.max(seen.layers.start)..layers.end.min(seen.layers.end);
            Rc::ptr_eq(&image.texels, &storage.texels) && seen.levels.contains(&level) && !common.is_empty()
        };
        let (point, attachment) = object.attachments.iter().find(|(_, attachment)| is_seen(attachment))?;
        let names = self.shared.borrow();
        let texture = names.textures.name_of(&attachment.image);
        let framebuffer = self.framebuffers.name_of(framebuffer);
        Some(format!(
            "the texels of unit {unit} are texture {texture}, {point:?} of framebuffer {framebuffer}: a feedback loop"
        ))
    }

    /// Clears all colour targets, depth and stencil of the framebuffer that is bound (section 17.4.3).
    ///
    /// # Errors
    /// For a framebuffer that is not complete.
    pub fn clear(&mut self, color: Vec4, depth: f32, stencil: u8) -> Result<()> {
        const CALL: &str = "clear";
        match self.framebuffer.clone() {
            _ if self.queries.drops() => {}
            None => self.default.clear(color, depth, stencil),
            Some(object) => {
                let mut framebuffer = load(&object.borrow(), CALL)?;
                framebuffer.clear(color, depth, stencil);
                store(&object.borrow(), framebuffer, CALL)?;
            }
        }
        Ok(())
    }
}
