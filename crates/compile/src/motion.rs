//! Compiling what moves while the shutter is open.

use super::{Compiler, params::default_of};
use std::sync::Arc;
use steradian_math::{Motion, Transform};
use steradian_scene::{Movement, Node, Span};
use steradian_schema::Parameter;

/// When the shutter opens and closes: parameters of the camera.
const SHUTTER: [&str; 2] = ["shutter_open", "shutter_close"];

impl Compiler<'_> {
    /// When the shutter opens and closes.
    pub(super) fn shutter(&self) -> [f64; 2] {
        let Some(camera) = self.chosen_camera().map(|id| self.desc.node(id)) else { return [0.0, 1.0] };
        SHUTTER.map(|name| {
            camera
                .float(name)
                .unwrap_or_else(|| default_of(camera, name, Parameter::default_number).unwrap_or_default())
        })
    }

    /// A motion over the time of the shutter; `None`, reported, where it is not one.
    pub(super) fn motion(
        &mut self,
        start: Transform,
        Movement { end, times: [begin, finish] }: Movement,
        span: Option<Span>,
    ) -> Option<Motion> {
        let [open, close] = self.shutter();
        let times = [begin, finish, open, close];
        if !(begin < finish && open <= close && times.iter().all(|t| t.is_finite())) {
            let what = format!(
                "a motion from {begin} to {finish} in an exposure from {open} to {close}: times must be finite and rise"
            );
            self.error(span, what);
            return None;
        }
        // On the clock of the motion where an exposure without length sees one moment, else on that of the exposure.
        let is_instant = open == close;
        let [zero, one] = if is_instant { [begin, finish] } else { [open, close] };
        let part = |time: f64| ((time - zero) / (one - zero)).clamp(-1e30, 1e30) as f32;
        let motion = Motion::new([(part(begin), start), (part(finish), end)]);
        let motion = if is_instant { motion.map(|motion| motion.stopped_at(part(open))) } else { motion };
        if motion.is_none() {
            self.error(span, "the transform at the end of this motion is singular or not finite");
        }
        motion
    }

    /// Motion of a camera; times of its shutter that are no numbers are reported, once for all motions.
    pub(super) fn camera_motion(&mut self, node: &Node) -> Option<Arc<Motion>> {
        for name in SHUTTER {
            self.float(node, name);
        }
        node.get("to_world_end")?;
        let times = match self.list(node, "motion_times").as_deref() {
            None => [0.0, 1.0],
            Some(&[begin, finish]) => [begin, finish].map(f64::from),
            Some(other) => {
                self.error(node.span, format!("'motion_times' are two numbers, not {}", other.len()));
                return None;
            }
        };
        let movement = Movement { end: self.transform(node, "to_world_end"), times };
        let start = self.transform(node, "to_world");
        self.motion(start, movement, node.span).map(Arc::new)
    }
}
