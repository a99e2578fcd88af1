//! Random tables, flags, rays and geometry, much of it garbage: nothing panics, nothing runs for ever, no primitive is
//! asked about twice.

use std::ops::ControlFlow;
use std::sync::Arc;
use steradian_math::{Bounds3, Vec3, hash::HashRng};
use steradian_rt::context::{
    AnyHitContext, CallableContext, ClosestHitContext, IntersectionContext, MissContext, RayGenerationContext,
};
use steradian_rt::{
    AnyHit, BottomLevel, BoxGeometry, BuildOptions, Callable, ClosestHit, Decision, EndSearch, Export, Fault,
    Geometries, GeometryFlags, HitGroup, HitKind, Indices, Instance, InstanceFlags, Interface, Intersection, Library,
    Miss, Pipeline, PipelineConfig, PrimitiveId, ProceduralGroup, QueryCandidate, RayDesc, RayFlags, RayGeneration,
    RayQuery, Record, ShaderTable, ShaderTables, TopLevel, TraceRay, Transform3x4, TriangleGeometry, TriangleGroup,
};

/// A number that is often of the kind that breaks things.
fn wild(rng: &mut HashRng) -> f32 {
    const WILD: [f32; 12] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::MIN_POSITIVE,
        1e-45,
        f32::MAX,
        f32::MIN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        1e19,
    ];
    match rng.next_u64() % 16 {
        0 => WILD[(rng.next_u64() % 12) as usize],
        1 => f32::from_bits(rng.next_u64() as u32),
        _ => 2.0 * rng.next_f32() - 1.0,
    }
}

fn wild3(rng: &mut HashRng) -> Vec3 {
    Vec3::new(wild(rng), wild(rng), wild(rng))
}

fn below(rng: &mut HashRng, n: u32) -> u32 {
    (rng.next_u64() % u64::from(n)) as u32
}

fn geometry_flags(rng: &mut HashRng) -> GeometryFlags {
    GeometryFlags::from_bits(below(rng, 4) as u8).expect("two flags")
}

fn bottom(rng: &mut HashRng) -> Option<BottomLevel> {
    let points: Vec<Vec3> = (0..3 * (1 + below(rng, 12))).map(|_| wild3(rng)).collect();
    let bounds: Vec<Bounds3> = points.chunks_exact(2).map(|p| Bounds3 { min: p[0], max: p[1] }).collect();
    let indices: Vec<u16> = points.iter().map(|_| below(rng, points.len() as u32) as u16).collect();
    let options = BuildOptions { allow_update: true, ..BuildOptions::default() };
    if rng.next_f32() < 0.4 {
        let boxes = [0; 2].map(|_| BoxGeometry::new(&bounds).with_flags(geometry_flags(rng)));
        return BottomLevel::build(Geometries::Boxes(&boxes), options).ok();
    }
    let triangles = [0; 2].map(|i| {
        let geometry = TriangleGeometry::new(&points).with_flags(geometry_flags(rng));
        if i == 0 { geometry } else { TriangleGeometry { indices: Indices::U16(&indices), ..geometry } }
    });
    let mut level = BottomLevel::build(Geometries::Triangles(&triangles), options).ok()?;
    // An update with garbage is an error, or is followed.
    let moved: Vec<Vec3> = points.iter().map(|&p| if rng.next_f32() < 0.1 { wild3(rng) } else { p }).collect();
    let _ = level.update(Geometries::Triangles(&triangles.map(|t| TriangleGeometry { vertices: &moved, ..t })));
    Some(level)
}

fn scene(rng: &mut HashRng) -> Option<TopLevel> {
    let levels: Vec<Arc<BottomLevel>> = (0..3).filter_map(|_| bottom(rng)).map(Arc::new).collect();
    let instance = |rng: &mut HashRng| {
        let transform = match below(rng, 3) {
            0 => Transform3x4::IDENTITY,
            1 => Transform3x4::translation(wild3(rng)),
            _ => Transform3x4 { rows: [[0; 4]; 3].map(|row| row.map(|_: i32| wild(rng))) },
        };
        let level = levels.get(below(rng, levels.len().max(1) as u32) as usize)?.clone();
        Some(
            Instance::new(level)
                .with_transform(transform)
                .with_mask(rng.next_u64() as u8 | 1)
                .with_hit_group_offset(below(rng, 6))
                .with_flags(InstanceFlags::from_bits(below(rng, 16) as u8)?),
        )
    };
    let instances: Vec<Instance> = (0..6).filter_map(|_| instance(rng)).collect();
    // Those that break a rule are left out.
    let is_valid = |i: &Instance| TopLevel::build(std::slice::from_ref(i), BuildOptions::default()).is_ok();
    let instances: Vec<Instance> = instances.into_iter().filter(is_valid).collect();
    TopLevel::build(&instances, BuildOptions::default()).ok()
}

fn flags(rng: &mut HashRng) -> RayFlags {
    // Few at once, so that many are legal.
    let bit = |rng: &mut HashRng| 1 << below(rng, 10);
    let bits = (0..below(rng, 4)).fold(0, |bits, _| bits | bit(rng));
    RayFlags::from_bits(bits).expect("ten flags")
}

fn ray(rng: &mut HashRng) -> RayDesc {
    let ray = RayDesc::new(wild3(rng), wild3(rng));
    if rng.next_f32() < 0.5 { ray } else { ray.with_extents(wild(rng).abs(), wild(rng).abs() + 1.0) }
}

enum Garbage {}

#[derive(Clone, Debug, Default, PartialEq)]
struct Log {
    seed: u64,
    asked: Vec<PrimitiveId>,
    hits: u32,
}

impl Interface for Garbage {
    type Payload = Log;
    type Attributes = u64;
    type Parameter = u64;
    type Local = u64;
    type Output = Log;
}

/// Does whatever the local data of its record and the payload say.
struct Any<'s>(&'s TopLevel);

impl Any<'_> {
    fn call(&self, rng: &mut HashRng) -> TraceRay<'_> {
        TraceRay {
            scene: (below(rng, 20) > 0).then_some(self.0),
            flags: flags(rng),
            mask: rng.next_u64() as u32 | 1,
            ray_contribution: below(rng, 3),
            geometry_multiplier: below(rng, 3),
            miss_index: below(rng, 4),
            ray: ray(rng),
        }
    }
}

impl RayGeneration<Garbage> for &Any<'_> {
    fn run(&self, context: &mut RayGenerationContext<Garbage>) -> Result<Log, Fault> {
        let mut rng = HashRng::new(*context.local());
        let mut log = Log { seed: rng.next_u64(), ..Log::default() };
        context.call(below(&mut rng, 2), &mut log.seed)?;
        context.trace(&self.call(&mut rng), &mut log)?;
        Ok(log)
    }
}

impl Intersection<Garbage> for &Any<'_> {
    fn run(&self, context: &mut IntersectionContext<Garbage>) -> ControlFlow<EndSearch> {
        let mut rng = HashRng::new(*context.local() ^ u64::from(context.primitive().primitive_index()));
        for _ in 0..4 {
            let kind = HitKind::procedural(below(&mut rng, 128) as u8).expect("at most 127");
            context.report_hit(wild(&mut rng), kind, rng.next_u64())?;
        }
        ControlFlow::Continue(())
    }
}

impl<A> AnyHit<Garbage, A> for &Any<'_> {
    fn run(&self, context: &AnyHitContext<Garbage>, log: &mut Log, _: &A) -> Decision {
        let kind = context.hit_kind();
        if kind.is_triangle() {
            assert!(!log.asked.contains(&context.primitive().id()), "asked twice");
            log.asked.push(context.primitive().id());
        }
        match HashRng::new(log.asked.len() as u64 ^ log.seed).next_u64() % 8 {
            0..5 => context.ignore_hit(),
            5..7 => context.accept_hit(),
            _ => context.accept_hit_and_end_search(),
        }
    }
}

impl<A> ClosestHit<Garbage, A> for &Any<'_> {
    fn run(&self, context: &mut ClosestHitContext<Garbage>, log: &mut Log, _: &A) -> Result<(), Fault> {
        let (ray, mut rng) = (context.ray(), HashRng::new(log.seed ^ u64::from(log.hits)));
        assert!(ray.t_min <= ray.t_current, "{ray:?}");
        log.hits += 1;
        log.asked.clear();
        if below(&mut rng, 2) == 0 { context.trace(&self.call(&mut rng), log) } else { Ok(()) }
    }
}

impl Miss<Garbage> for &Any<'_> {
    fn run(&self, context: &mut MissContext<Garbage>, log: &mut Log) -> Result<(), Fault> {
        context.call(0, &mut log.seed)
    }
}

impl Callable<Garbage> for &Any<'_> {
    fn run(&self, context: &mut CallableContext<Garbage>, seed: &mut u64) -> Result<(), Fault> {
        *seed = HashRng::new(*seed ^ *context.local()).next_u64();
        if seed.is_multiple_of(3) { context.call(1, seed) } else { Ok(()) }
    }
}

type Groups<'s> = Box<dyn HitGroup<Garbage> + 's>;

fn launch(rng: &mut HashRng, any: &Any) -> (u32, u32, u32) {
    let triangles: Groups = Box::new(TriangleGroup { any_hit: any, closest_hit: any });
    let procedural: Groups = Box::new(ProceduralGroup { intersection: any, any_hit: any, closest_hit: any });
    let library = Library::<Garbage, _, Groups, _, _>::new()
        .with_ray_generation(Export::new("any", any))
        .with_hit_group(Export::new("triangles", triangles))
        .with_hit_group(Export::new("procedural", procedural))
        .with_miss(Export::new("any", any))
        .with_callable(Export::new("any", any));
    let config = PipelineConfig { max_recursion_depth: below(rng, 4), stack_size: None };
    let pipeline = Pipeline::link([library], config).expect("unique names");
    let group = |rng: &mut HashRng| {
        let handle = [pipeline.hit_group("triangles"), pipeline.hit_group("procedural"), None];
        Record { handle: handle[below(rng, 3) as usize], local: rng.next_u64() }
    };
    let groups = (0..8 + below(rng, 8)).map(|_| group(rng)).collect();
    let callable = Record::new(pipeline.callable("any").expect("exported"), rng.next_u64());
    let mut tables = ShaderTables::new(Record::new(pipeline.ray_generation("any").expect("exported"), 0))
        .with_hit_groups(ShaderTable::new(groups).with_region(below(rng, 2), below(rng, 2)))
        .with_miss(ShaderTable::new(vec![Record::new(pipeline.miss("any").expect("exported"), 1); 3]))
        .with_callable(ShaderTable::new(vec![callable; 2]));
    let (mut done, mut faults, mut hits) = (0, 0, 0);
    for seed in 0..100 {
        // One id at a time, so that one fault does not hide the rest.
        tables.ray_generation.local = seed;
        match pipeline.launch(&tables, [1, 1, 1]) {
            Ok(logs) => {
                done += 1;
                hits += logs.iter().map(|log| log.hits).sum::<u32>();
            }
            Err(_) => faults += 1,
        }
    }
    (done, faults, hits)
}

/// Runs queries with random answers; gives how many hits there were.
fn query(rng: &mut HashRng, scene: &TopLevel) -> u32 {
    let Ok(mut query) = RayQuery::new(Some(scene), flags(rng), u32::MAX, ray(rng)) else { return 0 };
    let mut asked = Vec::new();
    while let Some(candidate) = query.proceed() {
        let id = match candidate {
            QueryCandidate::Triangle(mut triangle) => {
                if below(rng, 4) == 0 {
                    triangle.confirm();
                }
                triangle.primitive().id()
            }
            QueryCandidate::Procedural(mut procedural) => {
                let kind = HitKind::procedural(0).expect("at most 127");
                (0..below(rng, 3)).for_each(|_| {
                    procedural.generate(wild(rng), kind);
                });
                procedural.primitive().id()
            }
        };
        assert!(!asked.contains(&id), "asked twice");
        asked.push(id);
    }
    query.committed().is_some().into()
}

#[test]
fn garbage_neither_panics_nor_runs_for_ever() {
    let (mut scenes, mut done, mut faults, mut hits, mut found) = (0, 0, 0, 0, 0);
    for seed in 0..2000 {
        let mut rng = HashRng::new(1000 + seed);
        let Some(scene) = scene(&mut rng) else { continue };
        scenes += 1;
        let (d, f, h) = launch(&mut rng, &Any(&scene));
        (done, faults, hits) = (done + d, faults + f, hits + h);
        found += (0..60).map(|_| query(&mut rng, &scene)).sum::<u32>();
    }
    assert!(scenes > 1500 && faults > 300 && found > 300, "{scenes} scenes, {faults} faults, {found} found");
    assert!(done > 300 && hits > 100, "{done} done, {hits} hits");
}
