//! Shader tables, exhaustively, against a model written from the formula.

use std::sync::Arc;
use steradian_math::Vec3;
use steradian_rt::context::{AnyHitContext, CallableContext, ClosestHitContext, MissContext, RayGenerationContext};
use steradian_rt::{
    AnyHit, Barycentrics, BottomLevel, BuildOptions, Callable, ClosestHit, Decision, Export, Fault, Geometries,
    GeometryFlags, HitGroup, Instance, Interface, LaunchError, Library, Miss, Pipeline, PipelineConfig, PipelineError,
    RayDesc, RayFlags, RayGeneration, Record, ShaderTable, ShaderTables, TopLevel, TraceRay, TriangleGeometry,
    TriangleGroup,
};

/// Shaders run: the local data of their records, with a letter for the stage.
type Ran = Vec<(char, u32)>;

enum Marks {}

impl Interface for Marks {
    type Payload = Ran;
    type Attributes = ();
    type Parameter = Ran;
    type Local = u32;
    type Output = Ran;
}

/// Actions of a launch id.
#[derive(Clone, Copy, Debug)]
struct Call {
    flags: RayFlags,
    x: f32,
    ray_contribution: u32,
    geometry_multiplier: u32,
    miss_index: u32,
    callable: Option<u32>,
}

const CALL: Call =
    Call { flags: RayFlags::NONE, x: 0.2, ray_contribution: 0, geometry_multiplier: 0, miss_index: 0, callable: None };

struct Tracer<'s> {
    scene: &'s TopLevel,
    call: Call,
}

impl RayGeneration<Marks> for Tracer<'_> {
    fn run(&self, context: &mut RayGenerationContext<Marks>) -> Result<Ran, Fault> {
        let Call { flags, x, ray_contribution, geometry_multiplier, miss_index, callable } = self.call;
        let mut ran = vec![('g', *context.local())];
        if let Some(index) = callable {
            context.call(index, &mut ran)?;
        }
        let ray = RayDesc::new(Vec3::new(x, 0.2, -1.0), Vec3::Z);
        let trace = TraceRay::new(self.scene, ray);
        let trace = TraceRay { flags, ray_contribution, geometry_multiplier, miss_index, ..trace };
        context.trace(&trace, &mut ran)?;
        Ok(ran)
    }
}

struct Mark;

impl AnyHit<Marks, Barycentrics> for Mark {
    fn run(&self, context: &AnyHitContext<Marks>, ran: &mut Ran, _: &Barycentrics) -> Decision {
        ran.push(('a', *context.local()));
        context.accept_hit()
    }
}

impl ClosestHit<Marks, Barycentrics> for Mark {
    fn run(&self, context: &mut ClosestHitContext<Marks>, ran: &mut Ran, _: &Barycentrics) -> Result<(), Fault> {
        ran.push(('c', *context.local()));
        Ok(())
    }
}

impl Miss<Marks> for Mark {
    fn run(&self, context: &mut MissContext<Marks>, ran: &mut Ran) -> Result<(), Fault> {
        ran.push(('m', *context.local()));
        Ok(())
    }
}

impl Callable<Marks> for Mark {
    fn run(&self, context: &mut CallableContext<Marks>, ran: &mut Ran) -> Result<(), Fault> {
        ran.push(('k', *context.local()));
        Ok(())
    }
}

/// Two geometries, side by side; only the first is opaque. Two instances, one beneath the other.
fn scene(offsets: [u32; 2]) -> TopLevel {
    let triangle = [Vec3::ZERO, Vec3::Y, Vec3::X];
    let beside = triangle.map(|corner| corner + Vec3::X);
    let geometries = [TriangleGeometry::new(&triangle), TriangleGeometry::new(&beside).with_flags(GeometryFlags::NONE)];
    let level = BottomLevel::build(Geometries::Triangles(&geometries), BuildOptions::default()).expect("valid");
    let level = Arc::new(level);
    let place = |i: usize| steradian_rt::Transform3x4::translation(Vec3::new(4.0 * i as f32, 0.0, 0.0));
    let instance = |i: usize| Instance::new(level.clone()).with_transform(place(i)).with_hit_group_offset(offsets[i]);
    TopLevel::build(&[instance(0), instance(1)], BuildOptions::default()).expect("valid")
}

type Groups = Box<dyn HitGroup<Marks>>;
type Marking<'s> = Pipeline<Marks, Tracer<'s>, Groups, Mark, Mark>;

fn pipeline(scene: &TopLevel, call: Call) -> Marking<'_> {
    // Linked from two libraries.
    let hits = Library::<Marks, Tracer, Groups, Mark, Mark>::new()
        .with_hit_group(Export::new("both", Box::new(TriangleGroup { any_hit: Mark, closest_hit: Mark }) as _))
        .with_hit_group(Export::new("closest", Box::new(TriangleGroup { any_hit: (), closest_hit: Mark }) as _));
    let others = Library::new()
        .with_ray_generation(Export::new("tracer", Tracer { scene, call }))
        .with_miss(Export::new("mark", Mark))
        .with_callable(Export::new("mark", Mark));
    Pipeline::link([hits, others], PipelineConfig::default()).expect("unique names")
}

/// Which hit-group records are null, and which have no any-hit shader.
fn is_null(place: u32) -> bool {
    place % 5 == 4
}

fn has_any_hit(place: u32) -> bool {
    place.is_multiple_of(2)
}

fn tables(pipeline: &Marking, base: u32, stride: u32) -> ShaderTables<u32> {
    let group = |place: u32| match (is_null(place), has_any_hit(place)) {
        (true, _) => Record::null(place),
        (_, true) => Record::new(pipeline.hit_group("both").expect("exported"), place),
        (_, false) => Record::new(pipeline.hit_group("closest").expect("exported"), place),
    };
    let miss = |place| Record::new(pipeline.miss("mark").expect("exported"), place);
    let callable = |place| Record::new(pipeline.callable("mark").expect("exported"), place);
    ShaderTables::new(Record::new(pipeline.ray_generation("tracer").expect("exported"), 99))
        .with_hit_groups(ShaderTable::new((0..RECORDS).map(group).collect()).with_region(base, stride))
        .with_miss(ShaderTable::new((0..3).map(miss).collect()).with_region(1, 1))
        .with_callable(ShaderTable::new((0..3).map(callable).collect()).with_region(0, 2))
}

const RECORDS: u32 = 40;

#[test]
fn hit_groups_are_chosen_by_the_formula() {
    let (mut ran, mut faults) = (0, 0);
    for offsets in [[0, 1], [3, 17]] {
        let scene = scene(offsets);
        for (base, stride) in [(0, 1), (2, 1), (1, 2), (7, 0), (0, 3)] {
            for ray_contribution in [0, 1, 2, 15, 16, 0x11] {
                for geometry_multiplier in [0, 1, 2, 3, 15, 16, 0xf2] {
                    for (instance, geometry) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        let x = 0.2 + 4.0 * instance as f32 + geometry as f32;
                        let call = Call { x, ray_contribution, geometry_multiplier, ..CALL };
                        let pipeline = pipeline(&scene, call);
                        let result = pipeline.launch(&tables(&pipeline, base, stride), [1, 1, 1]);
                        let (contribution, multiplier) = (ray_contribution % 16, geometry_multiplier % 16);
                        let place = base + stride * (contribution + multiplier * geometry + offsets[instance]);
                        if place >= RECORDS {
                            let fault = Fault::HitGroupRecord {
                                base,
                                stride,
                                ray_contribution: contribution,
                                geometry_multiplier: multiplier,
                                geometry,
                                instance_offset: offsets[instance],
                                place: place.into(),
                                records: RECORDS as usize,
                            };
                            assert_eq!(result, Err(LaunchError::Fault { launch_id: [0; 3], fault }));
                            faults += 1;
                            continue;
                        }
                        let mut expected = vec![('g', 99)];
                        if !is_null(place) {
                            expected.extend((geometry == 1 && has_any_hit(place)).then_some(('a', place)));
                            expected.push(('c', place));
                        }
                        assert_eq!(result, Ok(vec![expected]), "{call:?} {base} {stride}");
                        ran += 1;
                    }
                }
            }
        }
    }
    assert!(ran > 500 && faults > 100, "{ran} ran, {faults} faults");
}

#[test]
fn an_index_beyond_the_table_shows_its_numbers() {
    let scene = scene([20, 0]);
    let call = Call { x: 1.2, ray_contribution: 3, geometry_multiplier: 2, ..CALL };
    let pipeline = pipeline(&scene, call);
    let error = pipeline.launch(&tables(&pipeline, 1, 2), [1, 1, 1]).expect_err("beyond");
    assert_eq!(
        error.to_string(),
        "launch id [0, 0, 0]: no hit-group record at 51 = 1 + 2 * (3 + 2 * 1 + 20): the table has 40 (DXR, \"Hit group \
         table indexing\")"
    );
}

#[test]
fn miss_and_callable_records_are_chosen_by_their_index() {
    let scene = scene([0, 0]);
    for (miss_index, callable) in [(0, 0), (1, 1), (0x1_0001, 0), (2, 0), (0xffff, 0), (0, 2), (0, u32::MAX)] {
        let call = Call { x: -1.0, miss_index, callable: Some(callable), ..CALL };
        let pipeline = pipeline(&scene, call);
        let result = pipeline.launch(&tables(&pipeline, 0, 1), [1, 1, 1]);
        let (miss, call) = (1 + (miss_index & 0xffff), 2 * u64::from(callable));
        let fault = |table, base, stride, index, place| {
            let fault = Fault::Record { table, base, stride, index, place, records: 3 };
            Err(LaunchError::Fault { launch_id: [0; 3], fault })
        };
        let expected = if call >= 3 {
            fault("callable", 0, 2, callable, call)
        } else if miss >= 3 {
            fault("miss", 1, 1, miss_index & 0xffff, miss.into())
        } else {
            Ok(vec![vec![('g', 99), ('k', call as u32), ('m', miss)]])
        };
        assert_eq!(result, expected);
    }
}

#[test]
fn flags_choose_which_shaders_run() {
    let scene = scene([0, 0]);
    let ran = |x, flags| {
        let pipeline = pipeline(&scene, Call { x, flags, ..CALL });
        let stages = pipeline.launch(&tables(&pipeline, 0, 1), [1, 1, 1]).expect("legal").concat();
        stages.into_iter().map(|(stage, _)| stage).collect::<String>()
    };
    assert_eq!((ran(0.2, RayFlags::NONE), ran(1.2, RayFlags::NONE)), ("gc".into(), "gac".into()));
    assert_eq!(ran(0.2, RayFlags::FORCE_NON_OPAQUE), "gac");
    assert_eq!(ran(1.2, RayFlags::FORCE_OPAQUE), "gc");
    assert_eq!(ran(1.2, RayFlags::SKIP_CLOSEST_HIT_SHADER), "ga");
    assert_eq!(ran(1.2, RayFlags::CULL_NON_OPAQUE), "gm");
    assert_eq!(ran(0.2, RayFlags::CULL_OPAQUE), "gm");
    assert_eq!(ran(0.2, RayFlags::SKIP_TRIANGLES), "gm");
}

#[test]
fn null_ray_generation_runs_nothing_and_foreign_handles_are_errors() {
    let scene = scene([0, 0]);
    let (one, other) = (pipeline(&scene, CALL), pipeline(&scene, CALL));
    let null = ShaderTables { ray_generation: Record::null(0), ..tables(&one, 0, 1) };
    assert_eq!(one.launch(&null, [2, 1, 1]), Ok(vec![vec![], vec![]]));
    let foreign = one.launch(&tables(&other, 0, 1), [1, 1, 1]);
    assert_eq!(foreign, Err(LaunchError::ForeignHandle { table: "ray-generation", place: 0 }));
    let mixed = ShaderTables { ray_generation: Record::null(0), ..tables(&other, 0, 1) };
    assert_eq!(one.launch(&mixed, [1, 1, 1]), Err(LaunchError::ForeignHandle { table: "miss", place: 0 }));
    let size = [1 << 20, 1 << 10, 2];
    let too_large = LaunchError::TooLarge { size, count: 1 << 31, limit: 1 << 30 };
    assert_eq!(one.launch(&null, size), Err(too_large));
    assert_eq!(one.launch(&tables(&one, 0, 1), [5, 0, 7]), Ok(vec![]));
}

#[test]
fn libraries_may_not_share_names() {
    let library = || Library::<Marks, Tracer, Groups, Mark, Mark>::new().with_miss(Export::new("sky", Mark));
    let twice = Pipeline::link([library(), library()], PipelineConfig::default()).err();
    assert_eq!(twice, Some(PipelineError::DuplicateName { kind: "miss shader", name: "sky".into() }));
    let deep = PipelineConfig { max_recursion_depth: 32, stack_size: None };
    let deep = Pipeline::link([library()], deep).err();
    assert_eq!(deep, Some(PipelineError::RecursionDepth { declared: 32, limit: 31 }));
    let one = Pipeline::link([library()], PipelineConfig::default()).expect("unique");
    assert!(one.miss("sky").is_some() && one.miss("ground").is_none() && one.callable("sky").is_none());
}
