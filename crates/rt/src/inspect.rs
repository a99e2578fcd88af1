//! Looking inside: what happens in a launch for one launch id, call by call, as text and as JSON.

use crate::context::{LaunchValues, Thread};
use crate::error::{Fault, LaunchError};
use crate::flags::RayFlags;
use crate::group::HitGroup;
use crate::pipeline::Pipeline;
use crate::ray::PrimitiveId;
use crate::stages::{Callable, Interface, Miss, RayGeneration, Verdict};
use crate::table::{Place, ShaderTables};
use crate::trace::Running;
use serde::{Serialize, Serializer};
use std::cell::RefCell;
use std::fmt;
use steradian_math::Vec3;

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

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    /// Nesting depth: a shader is below the call that led to it, its own calls are below the shader.
    pub depth: u32,
    /// The event.
    #[serde(flatten)]
    pub event: Event,
}

/// Shader stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// [`RayGeneration`].
    RayGeneration,
    /// [`Intersection`](crate::Intersection).
    Intersection,
    /// [`AnyHit`](crate::AnyHit).
    AnyHit,
    /// [`ClosestHit`](crate::ClosestHit).
    ClosestHit,
    /// [`Miss`].
    Miss,
    /// [`Callable`].
    Callable,
}

/// An event in a launch.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Event {
    /// A shader begins.
    Shader {
        /// Its stage.
        stage: Stage,
        /// The name of its export.
        name: String,
    },
    /// A ray is traced. In JSON an interval without end has the end `null`.
    Trace {
        /// Ray origin.
        origin: Vec3,
        /// Ray direction.
        direction: Vec3,
        /// Start of the ray's interval.
        t_min: f32,
        /// End of the ray's interval.
        t_max: f32,
        /// Its flags.
        #[serde(serialize_with = "as_text")]
        flags: RayFlags,
        /// Its mask; the low 8 bits.
        mask: u8,
    },
    /// A callable shader is called.
    Call {
        /// The index that was asked for.
        index: u32,
    },
    /// Something must be asked about. What is certain without asking is not among these.
    Candidate {
        /// Which primitive.
        primitive: PrimitiveId,
        /// Ray parameter of the hit; for a procedural primitive, of the ray's entry into its box.
        t: f32,
        /// True for a procedural primitive, false for a triangle.
        is_procedural: bool,
        /// True if it is opaque.
        is_opaque: bool,
    },
    /// A record of a shader table is chosen.
    Record {
        /// Which one, and how the formula came to it.
        #[serde(flatten)]
        place: Place,
        /// The export that it names; none where it is null.
        name: Option<String>,
    },
    /// An any-hit shader has decided.
    Decision {
        /// Decision of the shader.
        verdict: &'static str,
    },
    /// An intersection shader has reported a hit.
    Report {
        /// Ray parameter of the hit.
        t: f32,
        /// Kind of the hit.
        kind: u8,
        /// True if the hit counts.
        counts: bool,
    },
    /// The search is over: this is the hit.
    Hit {
        /// Which primitive.
        primitive: PrimitiveId,
        /// Ray parameter of the hit.
        t: f32,
    },
    /// The search is over: there is no hit.
    NoHit,
    /// A call failed.
    Fault {
        /// Why.
        message: String,
    },
}

fn as_text<T: fmt::Display, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::RayGeneration => "ray generation",
            Self::Intersection => "intersection",
            Self::AnyHit => "any hit",
            Self::ClosestHit => "closest hit",
            Self::Miss => "miss",
            Self::Callable => "callable",
        })
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Shader { stage, name } => write!(f, "{stage} shader {name:?}"),
            Self::Trace { origin, direction, t_min, t_max, flags, mask } => {
                write!(f, "trace from {origin} along {direction}, {t_min} to {t_max}, flags {flags}, mask {mask:#04x}")
            }
            Self::Call { index } => write!(f, "call {index}"),
            Self::Candidate { primitive, t, is_procedural, is_opaque } => {
                let opacity = if *is_opaque { "opaque" } else { "non-opaque" };
                let kind = if *is_procedural { "box" } else { "triangle" };
                write!(f, "candidate: {opacity} {kind} {primitive} at t = {t}")
            }
            Self::Record { place, name: Some(name) } => write!(f, "{place}: {name:?}"),
            Self::Record { place, name: None } => write!(f, "{place}: null"),
            Self::Decision { verdict } => write!(f, "decision: {verdict}"),
            Self::Report { t, kind, counts } => {
                write!(f, "report t = {t}, kind {kind}: {}", if *counts { "counts" } else { "does not count" })
            }
            Self::Hit { primitive, t } => write!(f, "hit: {primitive} at t = {t}"),
            Self::NoHit => f.write_str("no hit"),
            Self::Fault { message } => write!(f, "fault: {message}"),
        }
    }
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

impl Verdict {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Accept => "accept",
            Self::Ignore => "ignore",
            Self::AcceptAndEndSearch => "accept and end search",
        }
    }
}

/// Events as they happen.
#[derive(Default)]
pub(crate) struct Journal(RefCell<Vec<Entry>>);

/// Most events of a journal: what follows is left out.
const MAX_EVENTS: usize = 1 << 20;

impl Journal {
    pub fn note(&self, depth: u32, event: Event) {
        let mut entries = self.0.borrow_mut();
        if entries.len() < MAX_EVENTS {
            entries.push(Entry { depth, event });
        }
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
            Some(export) => running.launch_id(export, &thread, LaunchValues { id: launch_id, size }),
            None => Ok(I::Output::default()),
        };
        let events = thread.journal.map(|journal| journal.0.into_inner()).unwrap_or_default();
        Ok(Inspection { launch_id, events, output })
    }
}
