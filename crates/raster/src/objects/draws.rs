//! Draws over what is bound: attributes, indices, textures, framebuffer, transform feedback (OpenGL 4.6 core, sections
//! 10.3, 10.4, 13.3 and 17.4).

use glam::Vec4;

use super::{
    attached::{load, store},
    commands::Command,
    containers::source,
    context::Context,
    error::invalid_operation,
    feedback::{Feedback, FeedbackPrimitive},
    inputs::Inputs,
    names,
};
use crate::{
    counters::Counters,
    draw::Draw,
    error::Result,
    pipeline::Pipeline,
    render_target::{Framebuffer, Layout},
    stages::{FragmentShader, GeometryShader, Tessellation, Vertex, VertexShader},
    varyings::Varyings,
    vertex_array::VertexArray,
};

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
        let feedback = match &self.feedback {
            Some(Feedback { primitive, buffer, end }) => {
                Some((*primitive, buffer.borrow().all(call)?.len().saturating_sub(*end)))
            }
            None => None,
        };
        let object = self.draw_framebuffer.clone();
        let mut loaded = match &object {
            Some(object) => Some(load(&object.borrow(), call)?),
            None => None,
        };
        if self.queries.drops() {
            return Ok(Counters::default());
        }
        let gathered = self.gather(true);
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
        let (done, changes) =
            gathered.with(call, |resources| program(&Inputs { attributes, first_instances, resources }, &mut output));
        let Output { captured, written, counters, .. } = output;
        drop(buffers);
        gathered.write_back(changes, call)?;
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

    /// Clears all colour targets, depth and stencil of the framebuffer that is drawn to (section 17.4.3).
    ///
    /// # Errors
    /// For a framebuffer that is not complete.
    pub fn clear(&mut self, color: Vec4, depth: f32, stencil: u8) -> Result<()> {
        const CALL: &str = "clear";
        match self.draw_framebuffer.clone() {
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
