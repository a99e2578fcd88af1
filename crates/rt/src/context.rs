//! Contexts of the shader stages: readable values and callable functions.

use crate::decision::{Decision, EndSearch, Verdict};
use crate::error::Fault;
use crate::event::{Event, Journal};
use crate::flags::RayFlags;
use crate::interface::Interface;
use crate::queue::Candidate;
use crate::ray::{HitKind, Primitive, RayDesc, RayValues};
use crate::top_level::TopLevel;
use std::cell::Cell;
use std::ops::ControlFlow;

/// Arguments of `trace` (DXR, "TraceRay"; Vulkan, `traceRayEXT`).
#[derive(Clone, Copy, Debug)]
pub struct TraceRay<'s> {
    /// Structure to trace in; without one nothing is hit.
    pub scene: Option<&'s TopLevel>,
    /// Ray flags.
    pub flags: RayFlags,
    /// Instances whose mask has a bit in common with this one are met; the low 8 bits count.
    pub mask: u32,
    /// Ray contribution to the index of hit-group records; the low 4 bits count.
    pub ray_contribution: u32,
    /// By what the index of the geometry is multiplied before it is added to it; the low 4 bits count.
    pub geometry_multiplier: u32,
    /// Index of the miss record; the low 16 bits count.
    pub miss_index: u32,
    /// The ray.
    pub ray: RayDesc,
}

impl<'s> TraceRay<'s> {
    /// Without flags, in all instances, with the indices zero; geometries have one record each.
    #[inline]
    pub fn new(scene: &'s TopLevel, ray: RayDesc) -> Self {
        Self {
            scene: Some(scene),
            flags: RayFlags::NONE,
            mask: 0xff,
            ray_contribution: 0,
            geometry_multiplier: 1,
            miss_index: 0,
            ray,
        }
    }

    /// Values of the ray for shaders; `t_current` is its end now, or where its hit is.
    #[inline]
    pub(crate) fn values(&self, t_current: f32) -> RayValues {
        let RayDesc { origin, direction, t_min, .. } = self.ray;
        RayValues { origin, direction, t_min, t_current, flags: self.flags }
    }
}

/// Launch values that shaders can read (DXR, "Ray dispatch system values").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaunchValues {
    /// `DispatchRaysIndex`, `gl_LaunchIDEXT`.
    pub id: [u32; 3],
    /// `DispatchRaysDimensions`, `gl_LaunchSizeEXT`.
    pub size: [u32; 3],
}

/// Executor of shaders: a pipeline with its tables.
pub(crate) trait Machine<I: Interface> {
    fn trace(&self, frame: &Frame<I>, call: &TraceRay, payload: &mut I::Payload) -> Result<(), Fault>;
    fn call(&self, frame: &Frame<I>, index: u32, parameter: &mut I::Parameter) -> Result<(), Fault>;
}

/// State of a launch id while it runs.
#[derive(Default)]
pub(crate) struct Thread {
    /// Memory for candidates, lent to one search at a time.
    pub waiting: Cell<Vec<Candidate>>,
    /// The first fault, also where a shader has passed over it.
    pub fault: Cell<Option<Box<Fault>>>,
    /// Journal of events, where the launch id is inspected.
    pub journal: Option<Journal>,
}

impl Thread {
    /// Remembers a fault unless there is an earlier one.
    #[cold]
    pub fn note(&self, fault: &Fault) {
        let earlier = self.fault.take();
        self.fault.set(earlier.or_else(|| Some(Box::new(fault.clone()))));
    }
}

/// Stack frame of a shader in the chain of calls.
pub(crate) struct Frame<'a, I: Interface> {
    pub machine: &'a dyn Machine<I>,
    pub thread: &'a Thread,
    pub launch: &'a LaunchValues,
    /// Recursion depth of rays: zero in a ray-generation shader.
    pub depth: u32,
    /// Number of callable shaders in the chain.
    pub calls: u32,
    /// Bytes that the shaders in the chain have declared.
    pub stack: u64,
}

impl<I: Interface> Clone for Frame<'_, I> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<I: Interface> Copy for Frame<'_, I> {}

impl<I: Interface> Frame<'_, I> {
    /// Notes an event where there is a journal: `below` is how much deeper than the calls of this frame's shader.
    #[inline]
    pub fn note(&self, below: u32, event: impl FnOnce() -> Event) {
        if let Some(journal) = &self.thread.journal {
            journal.note(2 * (self.depth + self.calls) + below, event());
        }
    }

    /// Remembers a fault.
    #[cold]
    fn failed(&self, fault: &Fault) {
        self.note(1, || Event::Fault { message: fault.to_string() });
        self.thread.note(fault);
    }

    #[inline]
    fn trace(&self, call: &TraceRay, payload: &mut I::Payload) -> Result<(), Fault> {
        self.machine.trace(self, call, payload).inspect_err(|fault| self.failed(fault))
    }

    fn call(&self, index: u32, parameter: &mut I::Parameter) -> Result<(), Fault> {
        self.machine.call(self, index, parameter).inspect_err(|fault| self.failed(fault))
    }
}

/// Contexts with what every stage has.
macro_rules! contexts {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $ty:ty,)* })*) => {$(
        $(#[$doc])*
        pub struct $name<'a, I: Interface> {
            pub(crate) frame: Frame<'a, I>,
            pub(crate) local: &'a I::Local,
            $(pub(crate) $field: $ty,)*
        }

        impl<I: Interface> $name<'_, I> {
            /// Launch id and size.
            #[inline]
            pub fn launch(&self) -> LaunchValues {
                *self.frame.launch
            }

            /// The local data of the record that the shader runs for.
            #[inline]
            pub fn local(&self) -> &I::Local {
                self.local
            }
        }
    )*};
}

contexts! {
    /// Context of a ray-generation shader: it may trace and call. There is no ray yet:
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &RayGenerationContext<I>) { context.ray(); }
    /// ```
    RayGenerationContext {}
    /// Context of an intersection shader: it may report hits. It can neither trace, nor call, nor see the payload:
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &mut IntersectionContext<I>, call: &TraceRay, payload: &mut I::Payload) {
    ///     let _ = context.trace(call, payload);
    /// }
    /// ```
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &mut IntersectionContext<I>) { context.ignore_hit(); }
    /// ```
    IntersectionContext { primitive: Primitive<'a>, reporter: &'a mut dyn Report<I>, }
    /// Context of an any-hit shader: it may accept or ignore the hit. It cannot trace, call or report:
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &mut AnyHitContext<I>, call: &TraceRay, payload: &mut I::Payload) {
    ///     let _ = context.trace(call, payload);
    /// }
    /// ```
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &mut AnyHitContext<I>, parameter: &mut I::Parameter) {
    ///     let _ = context.call(0, parameter);
    /// }
    /// ```
    AnyHitContext { call: &'a TraceRay<'a>, t: f32, primitive: Primitive<'a>, kind: Option<HitKind>, }
    /// Context of a closest-hit shader: it may trace and call. The hit is decided:
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &mut ClosestHitContext<I>) { context.ignore_hit(); }
    /// ```
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &mut ClosestHitContext<I>, attributes: I::Attributes) {
    ///     let _ = context.report_hit(1.0, HitKind::procedural(0).unwrap(), attributes);
    /// }
    /// ```
    ClosestHitContext { call: &'a TraceRay<'a>, t: f32, primitive: Primitive<'a>, kind: Option<HitKind>, }
    /// Context of a miss shader: it may trace and call. Nothing was hit:
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &MissContext<I>) { context.primitive(); }
    /// ```
    MissContext { call: &'a TraceRay<'a>, t: f32, }
    /// Context of a callable shader: it may call. It cannot trace:
    ///
    /// ```compile_fail,E0599
    /// # use steradian_rt::{*, context::*};
    /// fn shader<I: Interface>(context: &mut CallableContext<I>, call: &TraceRay, payload: &mut I::Payload) {
    ///     let _ = context.trace(call, payload);
    /// }
    /// ```
    CallableContext {}
}

/// Stages that may do something.
macro_rules! may {
    (trace: $($name:ident)*) => {$(
        impl<I: Interface> $name<'_, I> {
            /// Traces a ray, and runs the shaders that it leads to (`TraceRay`, `traceRayEXT`).
            ///
            /// # Errors
            /// A ray or flags that break a rule, an index beyond a table, a hit group of the wrong kind, recursion
            /// deeper than declared, a stack that is too small. The launch fails even where the shader goes on.
            #[inline]
            pub fn trace(&mut self, call: &TraceRay, payload: &mut I::Payload) -> Result<(), Fault> {
                self.frame.trace(call, payload)
            }
        }
    )*};
    (call: $($name:ident)*) => {$(
        impl<I: Interface> $name<'_, I> {
            /// Runs a callable shader (`CallShader`, `executeCallableEXT`).
            ///
            /// # Errors
            /// An index beyond the table, calls that are nested too deeply, a stack that is too small. The launch fails
            /// even where the shader goes on.
            pub fn call(&mut self, index: u32, parameter: &mut I::Parameter) -> Result<(), Fault> {
                self.frame.call(index, parameter)
            }
        }
    )*};
    (ray: $($name:ident)*) => {$(
        impl<I: Interface> $name<'_, I> {
            /// The ray in world space.
            #[inline]
            pub fn ray(&self) -> RayValues {
                self.call.values(self.t)
            }
        }
    )*};
    (primitive: $($name:ident)*) => {$(
        impl<'a, I: Interface> $name<'a, I> {
            /// The primitive, its instance, and the ray in object space.
            #[inline]
            pub fn primitive(&self) -> &Primitive<'a> {
                &self.primitive
            }
        }
    )*};
    (kind: $($name:ident)*) => {$(
        impl<I: Interface> $name<'_, I> {
            /// Which face of a triangle, or what the intersection shader said.
            #[inline]
            pub fn hit_kind(&self) -> HitKind {
                self.kind.unwrap_or_else(|| self.primitive.face())
            }
        }
    )*};
}

may!(trace: RayGenerationContext ClosestHitContext MissContext);
may!(call: RayGenerationContext ClosestHitContext MissContext CallableContext);
may!(ray: AnyHitContext ClosestHitContext MissContext);
may!(primitive: IntersectionContext AnyHitContext ClosestHitContext);
may!(kind: AnyHitContext ClosestHitContext);

/// Who hears of hits on a procedural primitive.
pub(crate) trait Report<I: Interface> {
    fn ray(&self) -> RayValues;
    fn report(&mut self, t: f32, kind: HitKind, attributes: I::Attributes) -> ControlFlow<EndSearch, bool>;
}

impl<I: Interface> IntersectionContext<'_, I> {
    /// The ray in world space; `t_current` is where its interval ends now.
    pub fn ray(&self) -> RayValues {
        self.reporter.ray()
    }

    /// There is a hit (`ReportHit`, `reportIntersectionEXT`). Gives whether it counts: it does where
    /// `t_min <= t <= t_current` and no any-hit shader ignores it; the interval then ends at `t`. Breaks where the
    /// search is over: the shader hands it on by `?`, and whatever it reports else has no effect. A kind that belongs
    /// to triangles is a fault, which ends the search and the launch.
    pub fn report_hit(&mut self, t: f32, kind: HitKind, attributes: I::Attributes) -> ControlFlow<EndSearch, bool> {
        self.reporter.report(t, kind, attributes)
    }
}

impl<I: Interface> AnyHitContext<'_, I> {
    /// The hit counts. The API has no name for it: it is what happens where the shader just ends.
    #[inline]
    pub fn accept_hit(&self) -> Decision {
        Decision(Verdict::Accept)
    }

    /// The hit does not count (`IgnoreHit`, `ignoreIntersectionEXT`).
    #[inline]
    pub fn ignore_hit(&self) -> Decision {
        Decision(Verdict::Ignore)
    }

    /// The hit counts, and no other is looked for (`AcceptHitAndEndSearch`, `terminateRayEXT`).
    #[inline]
    pub fn accept_hit_and_end_search(&self) -> Decision {
        Decision(Verdict::AcceptAndEndSearch)
    }
}
