//! Looking inside: what happens in a launch for one launch id, call by call, as text and as JSON.

use crate::context::{LaunchValues, Thread};
use crate::error::{Fault, LaunchError};
use crate::event::{Entry, Journal};
use crate::group::HitGroup;
use crate::interface::Interface;
use crate::pipeline::Pipeline;
use crate::stages::{Callable, Miss, RayGeneration};
use crate::table::ShaderTables;
use crate::trace::Running;
use serde::Serialize;
use std::fmt;

/// Events and output of one launch id.
#[derive(Clone, Debug, Serialize)]
pub struct Inspection<O> {
    /// Which one.
    pub launch_id: [u32; 3],
    /// Events in order.
    pub events: Vec<Entry>,
    /// Output of the ray-generation shader, or the fault that ended it.
    #[serde(skip)]
    pub output: Result<O, Fault>,
}

/// One line for each event, indented by its depth.
impl<O> fmt::Display for Inspection<O> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [x, y, z] = self.launch_id;
        writeln!(f, "launch id {x}, {y}, {z}")?;
        for Entry { depth, event } in &self.events {
            writeln!(f, "{:indent$}{event}", "", indent = 2 * *depth as usize + 2)?;
        }
        Ok(())
    }
}

impl<O> Inspection<O> {
    /// An object with `launch_id` and `events`; what is not finite is `null`.
    pub fn to_json(&self) -> serde_json::Value {
        let events: Vec<_> = self.events.iter().filter_map(|entry| serde_json::to_value(entry).ok()).collect();
        serde_json::json!({ "launch_id": self.launch_id, "events": events })
    }
}

impl<I: Interface, R: RayGeneration<I>, H: HitGroup<I>, M: Miss<I>, C: Callable<I>> Pipeline<I, R, H, M, C> {
    /// Runs the ray-generation shader for one launch id of a launch of `size`, and notes what happens, at most 2^20
    /// events. The output is that of [`Pipeline::launch`].
    ///
    /// # Errors
    /// A launch id that is not below `size`; a record with a handle of another pipeline. A fault is no error: what led
    /// to it is among the events.
    pub fn inspect(
        &self,
        tables: &ShaderTables<I::Local>,
        size: [u32; 3],
        launch_id: [u32; 3],
    ) -> Result<Inspection<I::Output>, LaunchError> {
        self.check(tables)?;
        if launch_id.iter().zip(size).any(|(id, size)| *id >= size) {
            return Err(LaunchError::NoLaunchId { launch_id, size });
        }
        let thread = Thread { journal: Some(Journal::default()), ..Thread::default() };
        let running = Running { pipeline: self, tables };
        let handle = tables.ray_generation.handle;
        let output = match handle.and_then(|handle| self.library.ray_generation.get(handle.index as usize)) {
            Some(export) => running.launch_id(export, &thread, &LaunchValues { id: launch_id, size }),
            None => Ok(I::Output::default()),
        };
        let events = thread.journal.map(Journal::into_entries).unwrap_or_default();
        Ok(Inspection { launch_id, events, output })
    }
}
