//! Transform feedback (OpenGL 4.6 core, sections 13.3 and 14.1).

use super::{
    buffers::Buffer,
    context::{BufferTarget, Context},
    error::invalid_operation,
    names::Object,
};
use crate::error::Result;

/// Kind of primitives that transform feedback captures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedbackPrimitive {
    /// One vertex each.
    Points,
    /// Two vertices each.
    Lines,
    /// Three vertices each.
    Triangles,
}

impl FeedbackPrimitive {
    pub(super) const fn vertices(self) -> usize {
        match self {
            Self::Points => 1,
            Self::Lines => 2,
            Self::Triangles => 3,
        }
    }
}

/// Transform feedback that has begun.
#[derive(Debug)]
pub(super) struct Feedback {
    pub primitive: FeedbackPrimitive,
    pub buffer: Object<Buffer>,
    /// Byte after the last that was written.
    pub end: usize,
}

impl Context {
    /// Drops primitives after transform feedback and queries of primitives (section 14.1): `GL_RASTERIZER_DISCARD`.
    pub fn rasterizer_discard(&mut self, enabled: bool) {
        self.rasterizer_discard = enabled;
    }

    /// Begins to capture primitives into the buffer that is bound to `TransformFeedback`, from its first byte on
    /// (section 13.3.2).
    ///
    /// # Errors
    /// While transform feedback is active, and without a buffer.
    pub fn begin_transform_feedback(&mut self, primitive: FeedbackPrimitive) -> Result<()> {
        const CALL: &str = "begin_transform_feedback";
        if self.feedback.is_some() {
            return invalid_operation(CALL, "transform feedback is active already");
        }
        let Some(buffer) = self.bound_buffer(BufferTarget::TransformFeedback) else {
            return invalid_operation(CALL, "no buffer is bound to TransformFeedback");
        };
        self.feedback = Some(Feedback { primitive, buffer, end: 0 });
        Ok(())
    }

    /// Ends transform feedback.
    ///
    /// # Errors
    /// While transform feedback is not active.
    pub fn end_transform_feedback(&mut self) -> Result<()> {
        match self.feedback.take() {
            Some(_) => Ok(()),
            None => invalid_operation("end_transform_feedback", "transform feedback is not active"),
        }
    }
}
