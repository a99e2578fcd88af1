//! Events of a launch, and the journal that they are noted in.

use crate::flags::RayFlags;
use crate::ray::PrimitiveId;
use crate::table::Place;
use serde::{Serialize, Serializer};
use std::cell::RefCell;
use std::fmt;
use steradian_math::Vec3;

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
    /// [`RayGeneration`](crate::RayGeneration).
    RayGeneration,
    /// [`Intersection`](crate::Intersection).
    Intersection,
    /// [`AnyHit`](crate::AnyHit).
    AnyHit,
    /// [`ClosestHit`](crate::ClosestHit).
    ClosestHit,
    /// [`Miss`](crate::Miss).
    Miss,
    /// [`Callable`](crate::Callable).
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

    /// The events so far.
    pub fn into_entries(self) -> Vec<Entry> {
        self.0.into_inner()
    }
}
