//! Execution of traced rays and of calls of callable shaders (DXR, "TraceRay control flow").

use crate::RayFlags;
use crate::certain::{certain_hit, is_certain};
use crate::committed::Committed;
use crate::context::{
    AnyHitContext, CallableContext, ClosestHitContext, Frame, IntersectionContext, Machine, MissContext, Report,
    TraceRay,
};
use crate::decision::{EndSearch, Verdict};
use crate::error::Fault;
use crate::event::{Event, Stage};
use crate::group::{HitAttributes, HitGroup};
use crate::interface::Interface;
use crate::pipeline::{Export, HitGroupStack, MAX_CALL_DEPTH, Pipeline};
use crate::queue::Candidate;
use crate::ray::{Barycentrics, HitKind, Primitive, PrimitiveId, RayDesc, RayValues};
use crate::search::Search;
use crate::stages::{Callable, Miss, RayGeneration};
use crate::table::{HitIndex, ShaderTables};
use crate::top_level::TopLevel;
use std::ops::ControlFlow;

/// A pipeline with its tables.
pub(crate) struct Running<'a, I: Interface, R, H, M, C> {
    pub pipeline: &'a Pipeline<I, R, H, M, C>,
    pub tables: &'a ShaderTables<I::Local>,
}

/// The hit group of a record, and the record's data.
type Group<'a, I, H> = (&'a Export<H, HitGroupStack>, &'a <I as Interface>::Local);

impl<I: Interface, R, H, M, C> Machine<I> for Running<'_, I, R, H, M, C>
where
    R: RayGeneration<I>,
    H: HitGroup<I>,
    M: Miss<I>,
    C: Callable<I>,
{
    fn trace(&self, frame: &Frame<I>, call: &TraceRay, payload: &mut I::Payload) -> Result<(), Fault> {
        let limit = self.pipeline.config.max_recursion_depth;
        if frame.depth >= limit {
            return Err(Fault::RecursionDepth { limit });
        }
        call.flags.validated().map_err(crate::RayError::from)?;
        call.ray.check()?;
        frame.note(1, || {
            let RayDesc { origin, direction, t_min, t_max } = call.ray;
            Event::Trace { origin, direction, t_min, t_max, flags: call.flags, mask: call.mask as u8 }
        });
        let mut attributes = None;
        let committed = match call.scene {
            None => None,
            Some(scene) if is_certain(scene, call.flags) => certain_hit(scene, call),
            Some(_) => self.asked(frame, call, payload, &mut attributes)?,
        };
        frame.note(2, || match committed {
            Some(Committed { id, t, .. }) => Event::Hit { primitive: id, t },
            None => Event::NoHit,
        });
        let frame = &Frame { depth: frame.depth + 1, ..*frame };
        match (committed, call.scene) {
            (Some(hit), Some(scene)) => self.closest_hit(frame, (call, scene), &hit, payload, attributes),
            _ => self.miss(frame, call, payload),
        }
    }

    fn call(&self, frame: &Frame<I>, index: u32, parameter: &mut I::Parameter) -> Result<(), Fault> {
        if frame.calls >= MAX_CALL_DEPTH {
            return Err(Fault::CallDepth { limit: MAX_CALL_DEPTH });
        }
        frame.note(1, || Event::Call { index });
        let table = &self.tables.callable;
        let record = table.callable(index)?;
        let export = record.handle.and_then(|h| self.pipeline.library.callable.get(h.index as usize));
        let name = || export.map(|export| export.name.clone());
        frame.note(2, || Event::Record { place: table.callable_place(index), name: name() });
        let Some(export) = export else { return Ok(()) };
        let frame = Frame { calls: frame.calls + 1, ..self.deeper(frame, export.stack)? };
        self.begins(&frame, Stage::Callable, &export.name);
        export.shader.run(&mut CallableContext { frame, local: &record.local }, parameter)
    }
}

impl<'a, I: Interface, R, H, M, C> Running<'a, I, R, H, M, C>
where
    R: RayGeneration<I>,
    H: HitGroup<I>,
    M: Miss<I>,
    C: Callable<I>,
{
    /// The frame of a shader that is called from another one.
    #[inline]
    pub fn deeper<'f>(&self, frame: &Frame<'f, I>, bytes: u32) -> Result<Frame<'f, I>, Fault> {
        let (needed, limit) = (frame.stack + u64::from(bytes), self.pipeline.stack_size);
        if needed > limit { Err(Fault::Stack { needed, limit }) } else { Ok(Frame { stack: needed, ..*frame }) }
    }

    /// Notes that a shader begins; `frame` is its own.
    #[inline]
    fn begins(&self, frame: &Frame<I>, stage: Stage, name: &str) {
        let below = if matches!(stage, Stage::Intersection | Stage::AnyHit) { 2 } else { 0 };
        frame.note(below, || Event::Shader { stage, name: name.to_owned() });
    }

    /// The hit group for a primitive; `None` where the record is null.
    #[inline]
    fn group(
        &self,
        frame: &Frame<I>,
        below: u32,
        (call, scene): (&TraceRay, &TopLevel),
        id: PrimitiveId,
        is_procedural: bool,
    ) -> Result<Option<Group<'a, I, H>>, Fault> {
        let table = &self.tables.hit_groups;
        let index = HitIndex {
            ray_contribution: call.ray_contribution,
            geometry_multiplier: call.geometry_multiplier,
            geometry: id.geometry,
            instance_offset: scene.instances.get(id.instance as usize).map_or(0, |placed| placed.hit_group_offset),
        };
        let record = table.hit_group(index)?;
        let export = record.handle.and_then(|handle| self.pipeline.library.hit_groups.get(handle.index as usize));
        let name = || export.map(|export| export.name.clone());
        frame.note(below, || Event::Record { place: table.hit_group_place(index), name: name() });
        let (Some(export), Some(handle)) = (export, record.handle) else { return Ok(None) };
        let name = |is_procedural| if is_procedural { "procedural primitives" } else { "triangles" };
        let is_for_procedural = export.shader.is_procedural();
        if is_for_procedural != is_procedural {
            let (group, geometry) = (name(is_for_procedural), name(is_procedural));
            return Err(Fault::GroupKind { place: handle.index, group, geometry });
        }
        Ok(Some((export, &record.local)))
    }

    /// The hit of a ray where shaders may have to be asked.
    #[inline(never)]
    fn asked(
        &self,
        frame: &Frame<I>,
        call: &TraceRay,
        payload: &mut I::Payload,
        attributes: &mut Option<I::Attributes>,
    ) -> Result<Option<Committed>, Fault> {
        let mut search = Search::new(*call, frame.thread.waiting.take());
        let searched = self.search(frame, call, &mut search, payload, attributes);
        let committed = search.committed;
        frame.thread.waiting.set(search.into_buffer());
        searched.map(|()| committed)
    }

    /// Asks shaders about all candidates.
    fn search(
        &self,
        frame: &Frame<I>,
        call: &TraceRay,
        search: &mut Search,
        payload: &mut I::Payload,
        attributes: &mut Option<I::Attributes>,
    ) -> Result<(), Fault> {
        while let Some(candidate) = search.proceed() {
            let Some(scene) = search.call.scene else { break };
            let Some(primitive) = Primitive::new(scene, candidate.id, &search.call.ray) else { continue };
            let is_procedural = candidate.triangle.is_none();
            frame.note(2, || {
                let Candidate { id: primitive, t, is_opaque, .. } = candidate;
                Event::Candidate { primitive, t, is_procedural, is_opaque }
            });
            let group = self.group(frame, 2, (call, scene), candidate.id, is_procedural)?;
            match (candidate.triangle, group) {
                (Some(barycentrics), Some((export, local))) if export.shader.has_any_hit() => {
                    let context = AnyHitContext {
                        frame: self.deeper(frame, export.stack.any_hit)?,
                        local,
                        call,
                        t: candidate.t,
                        primitive,
                        kind: None,
                    };
                    let attributes = HitAttributes::Triangle(barycentrics);
                    self.begins(frame, Stage::AnyHit, &export.name);
                    let verdict = export.shader.any_hit(&context, payload, &attributes).0;
                    frame.note(3, || Event::Decision { verdict: verdict.name() });
                    match verdict {
                        Verdict::Ignore => {}
                        Verdict::Accept => search.commit_triangle(&candidate),
                        Verdict::AcceptAndEndSearch => {
                            search.commit_triangle(&candidate);
                            search.end();
                        }
                    }
                }
                // Without an any-hit shader geometry is opaque.
                (Some(_), _) => search.commit_triangle(&candidate),
                (None, None) => {}
                (None, Some((export, local))) => {
                    let frame = self.deeper(frame, export.stack.intersection)?;
                    let any_hit = if candidate.is_opaque || !export.shader.has_any_hit() {
                        None
                    } else {
                        Some(self.deeper(&frame, export.stack.any_hit))
                    };
                    self.begins(&frame, Stage::Intersection, &export.name);
                    let mut reporter = Reporter {
                        search,
                        candidate,
                        primitive,
                        frame,
                        group: export,
                        any_hit,
                        local,
                        payload,
                        attributes,
                        fault: None,
                    };
                    let mut context = IntersectionContext { frame, local, primitive, reporter: &mut reporter };
                    // Where it broke off, the search has been ended.
                    let _ = export.shader.intersection(&mut context);
                    reporter.fault.map_or(Ok(()), Err)?;
                }
            }
        }
        Ok(())
    }

    #[inline]
    fn closest_hit(
        &self,
        frame: &Frame<I>,
        (call, scene): (&TraceRay, &TopLevel),
        hit: &Committed,
        payload: &mut I::Payload,
        attributes: Option<I::Attributes>,
    ) -> Result<(), Fault> {
        if call.flags.contains(RayFlags::SKIP_CLOSEST_HIT_SHADER) {
            return Ok(());
        }
        let is_triangle = hit.kind.is_none();
        let Some((export, local)) = self.group(frame, 0, (call, scene), hit.id, !is_triangle)? else { return Ok(()) };
        let Some(primitive) = Primitive::new(scene, hit.id, &call.ray) else { return Ok(()) };
        let attributes = match attributes.filter(|_| !is_triangle) {
            None => HitAttributes::Triangle(hit.barycentrics),
            Some(attributes) => HitAttributes::Procedural(attributes),
        };
        if !export.shader.has_closest_hit() {
            return Ok(());
        }
        let frame = self.deeper(frame, export.stack.closest_hit)?;
        self.begins(&frame, Stage::ClosestHit, &export.name);
        let mut context = ClosestHitContext { frame, local, call, t: hit.t, primitive, kind: hit.kind };
        export.shader.closest_hit(&mut context, payload, &attributes)
    }

    fn miss(&self, frame: &Frame<I>, call: &TraceRay, payload: &mut I::Payload) -> Result<(), Fault> {
        let table = &self.tables.miss;
        let record = table.miss(call.miss_index)?;
        let export = record.handle.and_then(|h| self.pipeline.library.miss.get(h.index as usize));
        let name = || export.map(|export| export.name.clone());
        frame.note(0, || Event::Record { place: table.miss_place(call.miss_index), name: name() });
        let Some(export) = export else { return Ok(()) };
        let frame = self.deeper(frame, export.stack)?;
        self.begins(&frame, Stage::Miss, &export.name);
        export.shader.run(&mut MissContext { frame, local: &record.local, call, t: call.ray.t_max }, payload)
    }
}

/// Hears of hits on one procedural primitive.
struct Reporter<'r, 's, 'f, I: Interface, H> {
    search: &'r mut Search<'s>,
    candidate: Candidate,
    primitive: Primitive<'s>,
    frame: Frame<'f, I>,
    group: &'r Export<H, HitGroupStack>,
    /// The frame of the any-hit shader where there is one to be asked.
    any_hit: Option<Result<Frame<'f, I>, Fault>>,
    local: &'r I::Local,
    payload: &'r mut I::Payload,
    attributes: &'r mut Option<I::Attributes>,
    fault: Option<Fault>,
}

impl<I: Interface, H: HitGroup<I>> Reporter<'_, '_, '_, I, H> {
    /// Verdict of the any-hit shader on a hit.
    fn verdict(&mut self, t: f32, kind: HitKind, attributes: I::Attributes) -> Result<Verdict, Fault> {
        let Some(frame) = &self.any_hit else { return Ok(Verdict::Accept) };
        let context = AnyHitContext {
            frame: *frame.as_ref().map_err(Fault::clone)?,
            local: self.local,
            call: &self.search.call,
            t,
            primitive: self.primitive,
            kind: Some(kind),
        };
        self.frame.note(3, || Event::Shader { stage: Stage::AnyHit, name: self.group.name.clone() });
        let verdict = self.group.shader.any_hit(&context, self.payload, &HitAttributes::Procedural(attributes)).0;
        self.frame.note(4, || Event::Decision { verdict: verdict.name() });
        Ok(verdict)
    }
}

impl<I: Interface, H: HitGroup<I>> Report<I> for Reporter<'_, '_, '_, I, H> {
    fn ray(&self) -> RayValues {
        self.search.call.values(self.search.t_current())
    }

    fn report(&mut self, t: f32, kind: HitKind, attributes: I::Attributes) -> ControlFlow<EndSearch, bool> {
        if self.search.is_done() || self.fault.is_some() {
            return ControlFlow::Break(EndSearch(()));
        }
        let counts = self.consider(t, kind, attributes).unwrap_or_else(|fault| {
            self.fault = Some(fault);
            false
        });
        self.frame.note(3, || Event::Report { t, kind: kind.get(), counts });
        match self.search.is_done() || self.fault.is_some() {
            true => ControlFlow::Break(EndSearch(())),
            false => ControlFlow::Continue(counts),
        }
    }
}

impl<I: Interface, H: HitGroup<I>> Reporter<'_, '_, '_, I, H> {
    /// Commits a hit where it counts, and says whether it does.
    fn consider(&mut self, t: f32, kind: HitKind, attributes: I::Attributes) -> Result<bool, Fault> {
        if !(t >= self.search.call.ray.t_min && t <= self.search.t_current()) {
            return Ok(false);
        }
        if kind.is_triangle() {
            return Err(Fault::HitKind { kind: kind.get() });
        }
        let verdict = self.verdict(t, kind, attributes)?;
        if verdict == Verdict::Ignore {
            return Ok(false);
        }
        *self.attributes = Some(attributes);
        let id = self.candidate.id;
        self.search.commit(Committed { t, id, kind: Some(kind), barycentrics: Barycentrics::default() });
        if verdict == Verdict::AcceptAndEndSearch {
            self.search.end();
        }
        Ok(true)
    }
}
