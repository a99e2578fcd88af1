//! A pipeline of task, mesh and fragment shaders.
//!
//! Task groups run 1024 at a time, then the mesh groups that they emitted in jobs of 16. Their primitives go the way of
//! all others, from `primitive` on.

use std::{ops::AddAssign, ops::Range};

use rayon::prelude::*;

use super::{
    output::{MeshOutput, TaskOutput, fault_of_groups},
    primitives::{Count, feed},
    stages::{
        MAX_GROUP_INVOCATIONS, MAX_OUTPUT_PRIMITIVES, MAX_OUTPUT_VERTICES, MAX_PAYLOAD_BYTES, MeshShader, NoTask,
        TaskShader,
    },
};
use crate::{
    compute::run_group,
    counters::Counters,
    error::{Error, Result, refuse},
    front::Sink,
    pipeline::{check_distances, check_layout, checked_targets, draw_tiles, plan},
    primitive::{Chunk, Setup, Window},
    render_target::{Framebuffer, Layout},
    stages::FragmentShader,
    state::State,
    tile::Plan,
};

/// Task groups whose payloads are kept before their mesh groups run.
const TASK_BATCH: u64 = 1024;
/// Mesh groups of a job: a job is worked on by one thread.
const JOB: u64 = 16;
/// Jobs whose primitives are kept before tiles are drawn.
const BATCH: u64 = 16;

/// The shaders of a mesh pipeline.
#[derive(Clone, Copy, Debug)]
pub struct MeshProgram<T, M, F> {
    /// The task shader. Fields of shaders may be changed between draws.
    pub task: T,
    /// The mesh shader.
    pub mesh: M,
    /// The fragment shader.
    pub fragment: F,
}

impl<M: MeshShader, F> MeshProgram<NoTask, M, F> {
    /// Mesh and fragment shader. The compiler refuses a pipeline whose stages do not fit.
    pub fn new(mesh: M, fragment: F) -> Self {
        Self { task: NoTask, mesh, fragment }
    }

    /// With a task shader.
    pub fn task<T: TaskShader<Payload = M::Payload>>(self, task: T) -> MeshProgram<T, M, F> {
        MeshProgram { task, mesh: self.mesh, fragment: self.fragment }
    }
}

/// Counts of a draw. They do not depend on the number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshCounters {
    /// Work groups of the task shader.
    pub task_groups: u64,
    /// Work groups of the mesh shader.
    pub mesh_groups: u64,
    /// Vertices that mesh groups put out.
    pub vertices: u64,
    /// Primitives that mesh groups put out.
    pub primitives: u64,
    /// Primitives among these that were dropped by the mesh shader.
    pub culled: u64,
    /// Counts of the rasteriser for the others.
    pub rasterized: Counters,
}

impl AddAssign for MeshCounters {
    fn add_assign(&mut self, other: Self) {
        self.task_groups += other.task_groups;
        self.mesh_groups += other.mesh_groups;
        self.vertices += other.vertices;
        self.primitives += other.primitives;
        self.culled += other.culled;
        self.rasterized += other.rasterized;
    }
}

/// Shaders and state, checked, as [`Pipeline`](crate::Pipeline) with other stages before the rasteriser. What
/// primitives are made of the mesh shader says: [`State::topology`] and [`State::restart`] have no effect.
#[derive(Clone, Debug)]
pub struct MeshPipeline<T, M, F> {
    /// The shaders. Their fields (uniforms, textures) may be changed between draws.
    pub program: MeshProgram<T, M, F>,
    state: State,
    layout: Layout,
    plan: Plan,
}

/// The mesh groups that a task group emitted.
struct Emitted<P> {
    payload: P,
    groups: [u32; 3],
    /// Mesh groups of the task groups before.
    before: u64,
}

impl<T, M, F> MeshPipeline<T, M, F>
where
    T: TaskShader<Payload = M::Payload>,
    M: MeshShader,
    F: FragmentShader<Varyings = M::Varyings>,
{
    /// A pipeline that draws to framebuffers of this layout.
    ///
    /// # Errors
    /// Where a shader's constants or the size of its payload are beyond the limits of mesh shading
    /// ([`MAX_GROUP_INVOCATIONS`] and those beside it), the state breaks a rule, or shaders, state and layout do not
    /// fit; the message names which.
    pub fn new(program: MeshProgram<T, M, F>, state: State, layout: Layout) -> Result<Self> {
        // Limits of the shaders, rules of the state, then the fit of varyings and targets.
        let checked = || {
            check_shaders::<T, M>()?;
            state.check()?;
            check_distances::<M::Varyings>()?;
            checked_targets::<F>(state, &layout)
        };
        let state = checked().map_err(|error| Error { call: "MeshPipeline::new", ..error })?;
        let plan = plan::<F>(&state, &layout);
        Ok(Self { program, state, layout, plan })
    }

    /// Its state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Draws with so many groups along each axis: task groups, or mesh groups without a task shader. Groups take effect
    /// in their order, x fastest, those of a task group before those of the next, so the result does not depend on the
    /// number of threads (those of the rayon pool it is called in).
    ///
    /// # Errors
    /// Where the framebuffer does not have the layout of the pipeline, the groups are too many, or a shader breaks a
    /// rule of [`TaskOutput`] or [`MeshOutput`]. In the last case some groups before that one may have been drawn.
    pub fn draw(&self, framebuffer: &mut Framebuffer, groups: [u32; 3]) -> Result<MeshCounters> {
        const CALL: &str = "MeshPipeline::draw";
        check_layout(framebuffer, &self.layout, CALL)?;
        // Set-up and tiles work as in the vertex pipeline; only the source of primitives differs.
        let window = Window::new(&self.state, framebuffer.extent(), self.layout.depth);
        let mut tiles = framebuffer.tiles();
        self.run(
            CALL,
            groups,
            || Setup::<M::Varyings>::new(&window),
            |setups| {
                let chunks: Vec<Chunk> = setups.into_iter().map(Setup::finish).collect();
                let mut counters = Counters::default();
                chunks.iter().for_each(|chunk| counters += chunk.counters);
                counters += draw_tiles(&self.program.fragment, &self.state, &self.plan, &window, &mut tiles, &chunks);
                counters
            },
        )
    }

    /// Runs task and mesh shaders, and counts what they put out. Nothing is drawn.
    ///
    /// # Errors
    /// Where the groups are too many, or a shader breaks a rule of [`TaskOutput`] or [`MeshOutput`].
    pub fn count(&self, groups: [u32; 3]) -> Result<MeshCounters> {
        self.run("MeshPipeline::count", groups, || Count, |_| Counters::default())
    }

    /// Runs all groups, a batch at a time: each of its jobs has a sink, and `draw` takes those of a batch in order.
    fn run<S: Sink<M::Varyings> + Send>(
        &self,
        call: &'static str,
        groups: [u32; 3],
        sink: impl Fn() -> S + Sync,
        mut draw: impl FnMut(Vec<S>) -> Counters,
    ) -> Result<MeshCounters> {
        let refused = |rule: String| Error { call, rule };
        if let Some(rule) = fault_of_groups(groups) {
            return Err(refused(rule));
        }
        let mut counters = MeshCounters::default();
        // Without a task shader one task stands for all mesh groups.
        let tasks = if T::ACTIVE { total(groups) } else { 1 };
        for first in (0..tasks).step_by(TASK_BATCH as usize) {
            // Run a batch of task groups, which say how many mesh groups follow and with what payload.
            let emitted = self.tasks(groups, first..(first + TASK_BATCH).min(tasks), &mut counters).map_err(refused)?;
            let meshes = emitted.last().map_or(0, |last| last.before + total(last.groups));
            for start in (0..meshes).step_by((JOB * BATCH) as usize) {
                let end = (start + JOB * BATCH).min(meshes);
                // A job runs consecutive mesh groups into a sink of its own.
                let job = |i: u64| {
                    let mut sink = sink();
                    let numbers = start + i * JOB..(start + (i + 1) * JOB).min(end);
                    self.meshes(&emitted, numbers, &mut sink).map(|counters| (sink, counters))
                };
                // Run jobs in parallel and draw their sinks in order.
                let jobs: Vec<_> = (0..(end - start).div_ceil(JOB)).into_par_iter().map(job).collect();
                let mut sinks = Vec::with_capacity(jobs.len());
                for job in jobs {
                    let (sink, of_job) = job.map_err(refused)?;
                    sinks.push(sink);
                    counters += of_job;
                }
                counters.rasterized += draw(sinks);
            }
        }
        Ok(counters)
    }

    /// Runs task groups of these numbers. Those that emit nothing are left out.
    fn tasks(
        &self,
        groups: [u32; 3],
        numbers: Range<u64>,
        counters: &mut MeshCounters,
    ) -> std::result::Result<Vec<Emitted<T::Payload>>, String> {
        if !T::ACTIVE {
            return Ok(vec![Emitted { payload: T::Payload::default(), groups, before: 0 }]);
        }
        // Each task group runs its phases with shared memory of its own.
        counters.task_groups += numbers.end - numbers.start;
        let run = |number| {
            let group = place(number, groups);
            let mut shared = T::Shared::default();
            let mut out = TaskOutput::new();
            run_group(T::LOCAL_SIZE, T::PHASES, group, |phase, invocation, private| {
                self.program.task.shade(phase, invocation, private, &mut shared, &mut out);
            });
            out.finish().map_err(|rule| format!("task group {group:?}: {rule}"))
        };
        let outputs: Vec<_> = numbers.into_par_iter().map(run).collect();
        // Number the mesh groups through: prefix sums over the task groups.
        let mut before = 0;
        let mut emitted = Vec::new();
        for output in outputs {
            let (payload, groups) = output?;
            if total(groups) > 0 {
                emitted.push(Emitted { payload, groups, before });
                before += total(groups);
            }
        }
        Ok(emitted)
    }

    /// Runs mesh groups of these numbers, which count on from task group to task group.
    fn meshes(
        &self,
        emitted: &[Emitted<T::Payload>],
        numbers: Range<u64>,
        sink: &mut impl Sink<M::Varyings>,
    ) -> std::result::Result<MeshCounters, String> {
        let mut counters = MeshCounters::default();
        let mut out = MeshOutput::new([M::MAX_VERTICES, M::MAX_PRIMITIVES]);
        for number in numbers {
            // Find the task group that emitted this mesh group by binary search.
            let task = emitted.partition_point(|e| e.before <= number).saturating_sub(1);
            let Some(Emitted { payload, groups, before }) = emitted.get(task) else { continue };
            // Position of the group along the axes of its own task.
            let group = place(number - before, *groups);
            let mut shared = M::Shared::default();
            out.begin();
            run_group(M::LOCAL_SIZE, M::PHASES, group, |phase, invocation, private| {
                self.program.mesh.shade(phase, invocation, payload, private, &mut shared, &mut out);
            });
            // Refuse broken outputs before any primitive goes on; then feed the rasteriser.
            out.check().map_err(|rule| format!("mesh group {group:?}: {rule}"))?;
            counters.mesh_groups += 1;
            counters.vertices += out.vertices.len() as u64;
            counters.primitives += out.primitives.len() as u64;
            counters.culled += feed::<M>(&out, self.state.provoking, sink);
        }
        Ok(counters)
    }
}

/// Number of groups in all.
fn total(groups: [u32; 3]) -> u64 {
    groups.iter().map(|&n| u64::from(n)).product()
}

/// Position of group `number` along the axes, x fastest.
fn place(number: u64, groups: [u32; 3]) -> [u32; 3] {
    // Mixed radix: x varies fastest.
    let [x, y, _] = groups.map(u64::from);
    [number % x, number / x % y, number / x / y].map(|i| i as u32)
}

/// Checks that the constants of the shaders are within the limits.
fn check_shaders<T: TaskShader, M: MeshShader>() -> Result<()> {
    const CALL: &str = "MeshPipeline::new";
    // The number of invocations of a group is the product of its sizes, without overflow.
    for (shader, size) in [("task", T::LOCAL_SIZE), ("mesh", M::LOCAL_SIZE)] {
        let invocations = size.iter().try_fold(1u64, |all, &n| all.checked_mul(u64::from(n)));
        if !invocations.is_some_and(|n| (1..=MAX_GROUP_INVOCATIONS).contains(&n)) {
            let rule =
                format!("LOCAL_SIZE of the {shader} shader is {size:?}; from 1 to {MAX_GROUP_INVOCATIONS} in all");
            return refuse(CALL, rule);
        }
    }
    let payload = size_of::<T::Payload>();
    if payload > MAX_PAYLOAD_BYTES {
        return refuse(CALL, format!("the payload has {payload} bytes; at most {MAX_PAYLOAD_BYTES}"));
    }
    let outputs =
        [("VERTICES", M::MAX_VERTICES, MAX_OUTPUT_VERTICES), ("PRIMITIVES", M::MAX_PRIMITIVES, MAX_OUTPUT_PRIMITIVES)];
    for (what, count, most) in outputs {
        if !(1..=most).contains(&count) {
            return refuse(CALL, format!("MAX_{what} of the mesh shader is {count}; from 1 to {most}"));
        }
    }
    Ok(())
}
