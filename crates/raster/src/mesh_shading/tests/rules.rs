use std::sync::Mutex;

use glam::{Vec3, Vec4};

use super::drawing::framebuffer;
use crate::{
    Extent, Fragment, Invocation, State, fragment,
    mesh_shading::{
        Corners, MAX_GROUPS, MeshOutput, MeshPipeline, MeshPrimitive, MeshProgram, MeshShader, MeshVertex, TaskOutput,
        TaskShader,
    },
    stages::DepthOnly,
    state::Viewport,
};

/// A mesh shader of a closure without attributes; `SIZE` invocations, at most 8 vertices and 6 primitives.
struct Mesh<F, P, C, const SIZE: u32>(F, std::marker::PhantomData<fn(P, C)>);

fn mesh<P, C, F: Fn(Invocation, &P, &mut MeshOutput<(), (), C>)>(shade: F) -> Mesh<F, P, C, 1> {
    Mesh(shade, std::marker::PhantomData)
}

impl<F, P, C, const SIZE: u32> MeshShader for Mesh<F, P, C, SIZE>
where
    F: Fn(Invocation, &P, &mut MeshOutput<(), (), C>) + Sync,
    P: Copy + Default + Send + Sync,
    C: Corners,
{
    type Payload = P;
    type Shared = ();
    type Private = ();
    type Vertex = ();
    type Primitive = ();
    type Corners = C;
    type Varyings = ();
    const LOCAL_SIZE: [u32; 3] = [SIZE, 1, 1];
    const MAX_VERTICES: usize = 8;
    const MAX_PRIMITIVES: usize = 6;
    fn shade(&self, _: u32, at: Invocation, payload: &P, (): &mut (), (): &mut (), out: &mut MeshOutput<(), (), C>) {
        (self.0)(at, payload, out);
    }
    fn varyings((): &(), (): &()) {}
}

/// A task shader of a closure.
struct Task<F, P>(F, std::marker::PhantomData<fn(P)>);

fn task<P, F: Fn(Invocation, &mut TaskOutput<P>)>(shade: F) -> Task<F, P> {
    Task(shade, std::marker::PhantomData)
}

impl<F: Fn(Invocation, &mut TaskOutput<P>) + Sync, P: Copy + Default + Send + Sync> TaskShader for Task<F, P> {
    type Payload = P;
    type Shared = ();
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [1, 1, 1];
    fn shade(&self, _: u32, at: Invocation, (): &mut (), (): &mut (), out: &mut TaskOutput<P>) {
        (self.0)(at, out);
    }
}

fn corner(x: f32, y: f32) -> MeshVertex<()> {
    MeshVertex::new(Vec4::new(x, y, 0.5, 1.0), ())
}

type Output = MeshOutput<(), (), [u8; 3]>;

/// Rule for which a group's output is refused.
fn rule_of(shade: impl Fn(&mut Output) + Sync) -> String {
    let shader = mesh(|at: Invocation, _: &(), out: &mut Output| {
        // The second group is the one at fault.
        if at.group[1] == 1 { shade(out) } else { triangle(out) }
    });
    let framebuffer = framebuffer(Extent::new(8, 8));
    let pipeline =
        MeshPipeline::new(MeshProgram::new(shader, DepthOnly::new()), State::default(), framebuffer.layout());
    let error = pipeline.unwrap().count([1, 3, 1]).unwrap_err();
    assert_eq!(error.call, "MeshPipeline::count");
    error.rule.strip_prefix("mesh group [0, 1, 0]: ").unwrap().to_owned()
}

/// A triangle over the whole picture.
fn triangle(out: &mut Output) {
    out.set_counts(3, 1);
    [corner(-1.0, -1.0), corner(3.0, -1.0), corner(-1.0, 3.0)]
        .into_iter()
        .enumerate()
        .for_each(|(i, v)| out.vertex(i, v));
    out.primitive(0, MeshPrimitive::new([0, 1, 2], ()));
}

#[test]
fn mesh_groups_are_refused_by_name() {
    assert_eq!(rule_of(|out| out.set_counts(9, 0)), "9 vertices; MAX_VERTICES of the mesh shader is 8");
    assert_eq!(
        rule_of(|out| out.set_counts(usize::MAX, 7)),
        format!("{} vertices; MAX_VERTICES of the mesh shader is 8", usize::MAX)
    );
    assert_eq!(rule_of(|out| out.set_counts(8, 7)), "7 primitives; MAX_PRIMITIVES of the mesh shader is 6");
    assert_eq!(rule_of(|out| out.vertex(0, corner(0.0, 0.0))), "vertex 0 is written; the output is set to 0");
    assert_eq!(
        rule_of(|out| {
            triangle(out);
            out.vertex(3, corner(0.0, 0.0));
        }),
        "vertex 3 is written; the output is set to 3"
    );
    assert_eq!(
        rule_of(|out| {
            triangle(out);
            out.primitive(1, MeshPrimitive::new([0; 3], ()));
        }),
        "primitive 1 is written; the output is set to 1"
    );
    assert_eq!(
        rule_of(|out| {
            triangle(out);
            out.set_counts(3, 2);
        }),
        "the output is set to [3, 2] vertices and primitives after [3, 1]"
    );
    assert_eq!(
        rule_of(|out| {
            triangle(out);
            out.primitive(0, MeshPrimitive::new([0, 3, 1], ()));
        }),
        "primitive 0 has a corner at vertex 3 of 3"
    );
    assert_eq!(rule_of(|out| out.set_counts(2, 0)), "vertex 0 of 2 is not written");
    assert_eq!(rule_of(|out| out.set_counts(0, 2)), "primitive 0 of 2 is not written");
}

#[test]
fn mesh_pipelines_refuse_what_is_beyond_the_limits() {
    let mut framebuffer = framebuffer(Extent::new(8, 8));
    let layout = framebuffer.layout();
    // 16384 bytes of payload are allowed, one float more is not.
    #[derive(Clone, Copy)]
    struct Bytes<const N: usize>([f32; N]);
    impl<const N: usize> Default for Bytes<N> {
        fn default() -> Self {
            Self([0.0; N])
        }
    }
    let nothing = |_: Invocation, _: &Bytes<4096>, _: &mut Output| {};
    let program =
        MeshProgram::new(mesh(nothing), DepthOnly::new()).task(task(|_, out: &mut TaskOutput<Bytes<4096>>| {
            out.payload.0[0] = 1.0;
        }));
    assert_eq!(
        MeshPipeline::new(program, State::default(), layout.clone()).unwrap().count([2, 1, 1]).unwrap().task_groups,
        2
    );
    let nothing = |_: Invocation, _: &Bytes<4097>, _: &mut Output| {};
    let program = MeshProgram::new(mesh(nothing), DepthOnly::new()).task(task(|_, _: &mut TaskOutput<Bytes<4097>>| {}));
    let error = MeshPipeline::new(program, State::default(), layout.clone()).err().unwrap();
    assert_eq!(error.to_string(), "MeshPipeline::new: the payload has 16388 bytes; at most 16384");
    // Invocations of a group.
    let wide =
        |n: &str| format!("MeshPipeline::new: LOCAL_SIZE of the mesh shader is [{n}, 1, 1]; from 1 to 128 in all");
    let none = |_: Invocation, (): &(), _: &mut Output| {};
    let program = MeshProgram::new(Mesh::<_, _, _, 129>(none, std::marker::PhantomData), DepthOnly::new());
    assert_eq!(MeshPipeline::new(program, State::default(), layout.clone()).err().unwrap().to_string(), wide("129"));
    let program = MeshProgram::new(Mesh::<_, _, _, 0>(none, std::marker::PhantomData), DepthOnly::new());
    assert_eq!(MeshPipeline::new(program, State::default(), layout.clone()).err().unwrap().to_string(), wide("0"));
    let program = MeshProgram::new(Mesh::<_, _, _, 128>(none, std::marker::PhantomData), DepthOnly::new());
    let pipeline = MeshPipeline::new(program, State::default(), layout).unwrap();
    // Groups of a draw.
    let rule = |groups| pipeline.count(groups).unwrap_err().rule;
    assert_eq!(rule([65536, 1, 1]), "[65536, 1, 1] groups; at most 65535 along each axis");
    assert_eq!(rule([2048, 2048, 2]), "[2048, 2048, 2] groups are 8388608; at most 4194304 in all");
    assert!(rule([u32::MAX; 3]).contains("65535 along each axis"));
    assert_eq!(pipeline.count([0, 65535, 65535]).unwrap().mesh_groups, 0);
    assert_eq!(pipeline.draw(&mut framebuffer, [0; 3]).unwrap().mesh_groups, 0);
    let mut other = super::drawing::framebuffer(Extent::new(8, 8).samples(4));
    assert!(pipeline.draw(&mut other, [0; 3]).unwrap_err().rule.contains("was made for"));
}

#[test]
fn task_groups_hand_payloads_to_the_groups_that_they_emit_in_order() {
    let seen = Mutex::new(Vec::new());
    let note = |at: Invocation, payload: &[u32; 3], _: &mut MeshOutput<(), (), [u8; 1]>| {
        seen.lock().unwrap().push((*payload, at.group));
    };
    let emit = task(|at: Invocation, out: &mut TaskOutput<[u32; 3]>| {
        out.payload = at.group;
        // Group (1, 1) emits nothing, group (2, 0) does not say.
        if at.group[..2] != [2, 0] {
            out.emit([at.group[0] + 1, 2, u32::from(at.group[..2] != [1, 1])]);
        }
    });
    let layout = framebuffer(Extent::new(8, 8)).layout();
    let pipeline =
        MeshPipeline::new(MeshProgram::new(mesh(note), DepthOnly::new()).task(emit), State::default(), layout).unwrap();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let counters = one.install(|| pipeline.count([3, 2, 2])).unwrap();
    let mut expected = Vec::new();
    for group in (0..12).map(|i| [i % 3, i / 3 % 2, i / 6]) {
        let count = if group[..2] == [2, 0] || group[..2] == [1, 1] { 0 } else { 2 * (group[0] + 1) };
        expected.extend((0..count).map(|i| (group, [i % (group[0] + 1), i / (group[0] + 1), 0])));
    }
    assert_eq!((counters.task_groups, counters.mesh_groups), (12, expected.len() as u64));
    let mut seen = seen.into_inner().unwrap();
    // Jobs of one thread may run in any order.
    let key = |(p, g): &([u32; 3], [u32; 3])| (p[2], p[1], p[0], g[2], g[1], g[0]);
    seen.sort_by_key(key);
    assert_eq!(seen, expected);
}

#[test]
fn task_groups_are_refused_by_name() {
    let rule = |emit: &(dyn Fn(&mut TaskOutput<()>) + Sync)| {
        let none = |_: Invocation, (): &(), _: &mut Output| {};
        let emit = task(move |at: Invocation, out: &mut TaskOutput<()>| {
            if at.group[2] == 3 {
                emit(out);
            }
        });
        let layout = framebuffer(Extent::new(8, 8)).layout();
        let program = MeshProgram::new(mesh(none), DepthOnly::new()).task(emit);
        let result = MeshPipeline::new(program, State::default(), layout).unwrap().count([1, 1, 5]);
        result.map_err(|error| error.rule.strip_prefix("task group [0, 0, 3]: ").unwrap().to_owned())
    };
    assert_eq!(
        rule(&|out| out.emit([1, 70000, 1])).unwrap_err(),
        "[1, 70000, 1] groups; at most 65535 along each axis"
    );
    assert_eq!(
        rule(&|out| out.emit([256, 256, 65])).unwrap_err(),
        "[256, 256, 65] groups are 4259840; at most 4194304 in all"
    );
    assert_eq!(
        rule(&|out| [1, 2].into_iter().for_each(|n| out.emit([n, 1, 1]))).unwrap_err(),
        "[2, 1, 1] groups are emitted after [1, 1, 1]"
    );
    assert_eq!(rule(&|out| [3, 3].into_iter().for_each(|n| out.emit([n, 1, 1]))).unwrap().mesh_groups, 3);
    assert_eq!(rule(&|out| out.emit([256, 256, 64])).unwrap().mesh_groups, MAX_GROUPS);
}

#[test]
fn mesh_primitives_choose_layer_and_viewport_and_may_be_culled() {
    let shader = mesh(|_, (): &(), out: &mut Output| {
        out.set_counts(3, 5);
        let corners = [corner(-1.0, -1.0), corner(3.0, -1.0), corner(-1.0, 3.0)];
        corners.into_iter().enumerate().for_each(|(i, v)| out.vertex(i, v));
        let whole = MeshPrimitive::new([0, 1, 2], ());
        out.primitive(0, MeshPrimitive { layer: 1, id: 5, ..whole });
        out.primitive(1, MeshPrimitive { layer: 2, viewport: 1, id: 7, ..whole });
        out.primitive(2, MeshPrimitive { layer: 0, culled: true, ..whole });
        out.primitive(3, MeshPrimitive { layer: 3, ..whole });
        out.primitive(4, MeshPrimitive { viewport: 2, ..whole });
    });
    let look = fragment(|f: &Fragment<()>| Vec3::splat(f.primitive_id() as f32).extend(f.quad.viewport as f32));
    let mut framebuffer = framebuffer(Extent { layers: 3, ..Extent::new(8, 8) });
    let half = |x| Viewport { x, ..Viewport::new(4.0, 8.0) };
    let state = State { viewports: vec![half(0.0), half(4.0)], ..State::default() };
    let pipeline = MeshPipeline::new(MeshProgram::new(shader, look), state, framebuffer.layout()).unwrap();
    let counters = pipeline.draw(&mut framebuffer, [1; 3]).unwrap();
    assert_eq!((counters.primitives, counters.culled, counters.rasterized.primitives), (5, 1, 4));
    assert_eq!((counters.rasterized.outside, counters.rasterized.fragments), (2, 64));
    let clear = Vec4::new(0.25, 0.5, 0.75, 1.0);
    let color = |layer, x| framebuffer.color(0).sample([x, 3], layer, 0).unwrap();
    assert_eq!([0, 1, 2].map(|layer| color(layer, 3)), [clear, Vec4::new(5.0, 5.0, 5.0, 0.0), clear]);
    assert_eq!([0, 1, 2].map(|layer| color(layer, 4)), [clear, clear, Vec4::new(7.0, 7.0, 7.0, 1.0)]);
}

#[test]
fn mesh_groups_put_out_points_and_lines() {
    let white = || fragment(|_: &Fragment<()>| Vec4::ONE);
    let mut target = framebuffer(Extent::new(16, 16));
    let points = mesh(|_, (): &(), out: &mut MeshOutput<(), (), [u8; 1]>| {
        out.set_counts(2, 1);
        out.vertex(0, corner(0.0, 0.0));
        out.vertex(1, MeshVertex { point_size: 4.0, ..corner(0.5, 0.5) });
        out.primitive(0, MeshPrimitive::new([1], ()));
    });
    let pipeline = MeshPipeline::new(MeshProgram::new(points, white()), State::default(), target.layout()).unwrap();
    assert_eq!(pipeline.draw(&mut target, [1; 3]).unwrap().rasterized.fragments, 16);
    let lines = mesh(|_, (): &(), out: &mut MeshOutput<(), (), [u8; 2]>| {
        out.set_counts(2, 1);
        out.vertex(0, corner(-1.0, 0.0625));
        out.vertex(1, corner(1.0, 0.0625));
        out.primitive(0, MeshPrimitive::new([0, 1], ()));
    });
    let pipeline = MeshPipeline::new(MeshProgram::new(lines, white()), State::default(), target.layout()).unwrap();
    assert_eq!(pipeline.draw(&mut target, [1; 3]).unwrap().rasterized.fragments, 16);
}
