//! Pipelines give the hits of ray queries, and any-hit shaders cut holes as geometry does.

use crate::worlds::{ray, scene};
use std::sync::Arc;
use steradian_math::{Vec3, hash::HashRng};
use steradian_rt::context::{AnyHitContext, ClosestHitContext, MissContext, RayGenerationContext};
use steradian_rt::{
    AnyHit, Barycentrics, BottomLevel, BuildOptions, ClosestHit, Decision, Export, Fault, Geometries, GeometryFlags,
    HitKind, Indices, Instance, Interface, Library, Miss, Pipeline, PipelineConfig, PrimitiveId, QueryCandidate,
    RayDesc, RayFlags, RayGeneration, RayQuery, Record, ShaderTable, ShaderTables, TopLevel, TraceRay, Transform3x4,
    TriangleGeometry, TriangleGroup,
};

/// Hit that was found, and its position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    hit: Option<(f32, PrimitiveId, HitKind, Barycentrics)>,
    missed: bool,
    asked: u32,
}

enum Seeing {}

impl Interface for Seeing {
    type Payload = Seen;
    type Attributes = ();
    type Parameter = ();
    type Local = ();
    type Output = Seen;
}

/// Traces a given ray for each launch id.
struct Rays<'s> {
    scene: &'s TopLevel,
    rays: &'s [(RayDesc, RayFlags, u32)],
}

impl RayGeneration<Seeing> for Rays<'_> {
    fn run(&self, context: &mut RayGenerationContext<Seeing>) -> Result<Seen, Fault> {
        let [x, y, _] = context.launch().id;
        let (ray, flags, mask) = self.rays[(x + y * context.launch().size[0]) as usize];
        let mut seen = Seen::default();
        context.trace(&TraceRay { flags, mask, ..TraceRay::new(self.scene, ray) }, &mut seen)?;
        Ok(seen)
    }
}

struct See;

impl ClosestHit<Seeing, Barycentrics> for See {
    fn run(&self, context: &mut ClosestHitContext<Seeing>, seen: &mut Seen, at: &Barycentrics) -> Result<(), Fault> {
        seen.hit = Some((context.ray().t_current, context.primitive().id(), context.hit_kind(), *at));
        // The same point in both spaces.
        let (ray, primitive) = (context.ray(), context.primitive());
        let world = ray.origin + ray.direction * ray.t_current;
        let object = primitive.object_ray_origin() + primitive.object_ray_direction() * ray.t_current;
        let corners = primitive.triangle().unwrap_or_default();
        assert!(primitive.object_to_world().point(object).distance(world) < 1e-3);
        assert!(primitive.world_to_object().point(world).distance(at.interpolate(corners)) < 1e-3);
        Ok(())
    }
}

impl Miss<Seeing> for See {
    fn run(&self, _: &mut MissContext<Seeing>, seen: &mut Seen) -> Result<(), Fault> {
        seen.missed = true;
        Ok(())
    }
}

/// Refuses triangles whose number a function refuses.
struct Refuse<F>(F);

impl<F: Fn(u32, &Barycentrics) -> bool + Sync> AnyHit<Seeing, Barycentrics> for Refuse<F> {
    fn run(&self, context: &AnyHitContext<Seeing>, seen: &mut Seen, at: &Barycentrics) -> Decision {
        seen.asked += 1;
        let counts = (self.0)(context.primitive().primitive_index(), at);
        if counts { context.accept_hit() } else { context.ignore_hit() }
    }
}

/// Runs all rays through a pipeline of one hit group.
fn launch<A: AnyHit<Seeing, Barycentrics>>(
    scene: &TopLevel,
    rays: &[(RayDesc, RayFlags, u32)],
    any_hit: A,
    threads: usize,
) -> Vec<Seen> {
    let library = Library::<Seeing, _, _, _>::new()
        .with_ray_generation(Export::new("rays", Rays { scene, rays }))
        .with_hit_group(Export::new("see", TriangleGroup { any_hit, closest_hit: See }))
        .with_miss(Export::new("miss", See));
    let pipeline = Pipeline::link([library], PipelineConfig::default()).expect("unique names");
    let group = pipeline.hit_group("see").expect("exported");
    let tables = ShaderTables::new(Record::new(pipeline.ray_generation("rays").expect("exported"), ()))
        .with_hit_groups(ShaderTable::new(vec![Record::new(group, ())]).with_region(0, 0))
        .with_miss(ShaderTable::new(vec![Record::new(pipeline.miss("miss").expect("exported"), ())]));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let width = 20;
    let size = [width, rays.len() as u32 / width, 1];
    pool.install(|| pipeline.launch(&tables, size)).expect("no fault")
}

fn confirms(primitive: u32) -> bool {
    !primitive.is_multiple_of(3)
}

#[test]
fn pipelines_give_the_hits_of_queries_on_any_number_of_threads() {
    let mut rng = HashRng::new(6);
    let (scene, _) = scene(&mut rng);
    let legal = (0..=0x3ff_u32).filter_map(RayFlags::from_bits).filter(|flags| flags.validated().is_ok());
    let legal: Vec<RayFlags> = legal.collect();
    let rays: Vec<_> = (0..20_000)
        .map(|i| {
            let ray = ray(&mut rng).with_extents(0.2 * rng.next_f32(), 0.7 + rng.next_f32());
            (ray, legal[i % legal.len()], rng.next_u64() as u32)
        })
        .collect();
    let refuse = || Refuse(|primitive: u32, _: &Barycentrics| confirms(primitive));
    let seen = launch(&scene, &rays, refuse(), 1);
    assert_eq!(seen, launch(&scene, &rays, refuse(), 3));
    let (mut hits, mut asked) = (0, 0);
    for ((ray, flags, mask), seen) in rays.into_iter().zip(seen) {
        let skips = flags.contains(RayFlags::SKIP_CLOSEST_HIT_SHADER);
        let flags = RayFlags::from_bits(flags.bits() & !RayFlags::SKIP_CLOSEST_HIT_SHADER.bits()).expect("known");
        let mut query = RayQuery::new(Some(&scene), flags, mask, ray).expect("legal");
        let mut expected = Seen::default();
        while let Some(QueryCandidate::Triangle(mut triangle)) = query.proceed() {
            expected.asked += 1;
            if confirms(triangle.primitive().primitive_index()) {
                triangle.confirm();
            }
        }
        let hit = query.committed().map(|hit| (hit.t, hit.primitive.id(), hit.kind, hit.barycentrics));
        expected.missed = hit.is_none();
        expected.hit = hit.filter(|_| !skips);
        assert_eq!(seen, expected);
        hits += usize::from(seen.hit.is_some());
        asked += seen.asked;
    }
    assert!(hits > 1000 && asked > 1000, "{hits} hits, {asked} asked");
}

#[test]
fn alpha_cuts_holes_as_geometry_does() {
    // A square of 8 × 8 cells; every cell whose coordinates have an odd sum is a hole.
    let is_hole = |x: u32, y: u32| (x + y) % 2 == 1;
    let square = [Vec3::ZERO, Vec3::Y, Vec3::X, Vec3::new(1.0, 1.0, 0.0)];
    let indices = [0, 1, 2, 3, 2, 1];
    let card = TriangleGeometry::indexed(&square, &indices).with_flags(GeometryFlags::NONE);
    let corner = |x: u32, y: u32| Vec3::new(x as f32 / 8.0, y as f32 / 8.0, 0.0);
    let cell = |x, y| [corner(x, y), corner(x, y + 1), corner(x + 1, y), corner(x + 1, y + 1)];
    let cells = (0..64).map(|i| (i % 8, i / 8)).filter(|&(x, y)| !is_hole(x, y));
    let vertices: Vec<Vec3> = cells.flat_map(|(x, y)| cell(x, y)).collect();
    let cell_indices: Vec<u16> = (0..32).flat_map(|i| indices.map(|k| (4 * i + k) as u16)).collect();
    let cut = TriangleGeometry { indices: Indices::U16(&cell_indices), ..TriangleGeometry::new(&vertices) };
    let scene = |geometry| {
        let level = BottomLevel::build(Geometries::Triangles(&[geometry]), BuildOptions::default()).expect("valid");
        // Three layers, so that holes show others.
        let level = Arc::new(level);
        let layers = [0.0, 1.0, 2.0].map(|z: f32| {
            let place = Transform3x4::translation(Vec3::new(0.06 * z, 0.0, z));
            Instance::new(level.clone()).with_transform(place)
        });
        TopLevel::build(&layers, BuildOptions::default()).expect("valid")
    };
    let mut rng = HashRng::new(7);
    let rays: Vec<_> = (0..10_000)
        .map(|_| {
            let origin = Vec3::new(rng.next_f32(), rng.next_f32(), -1.0);
            let direction = Vec3::new(0.3 * rng.next_f32(), 0.3 * rng.next_f32(), 1.0);
            (RayDesc::new(origin, direction), RayFlags::NONE, 0xff)
        })
        .collect();
    let alpha = Refuse(move |primitive: u32, at: &Barycentrics| {
        let corners =
            if primitive == 0 { [square[0], square[1], square[2]] } else { [square[3], square[2], square[1]] };
        let p = at.interpolate(corners) * 8.0;
        !is_hole(p.x as u32, p.y as u32)
    });
    let with_alpha = launch(&scene(card), &rays, alpha, 2);
    let with_geometry = launch(&scene(cut), &rays, (), 2);
    let mut apart = 0;
    for (a, b) in with_alpha.iter().zip(&with_geometry) {
        let same = match (a.hit, b.hit) {
            (Some((t, a, ..)), Some((s, b, ..))) => (t - s).abs() < 1e-5 && a.instance == b.instance,
            (a, b) => a.is_none() && b.is_none(),
        };
        apart += usize::from(!same);
    }
    let layers = [0, 1, 2].map(|i| with_alpha.iter().filter(|s| s.hit.is_some_and(|hit| hit.1.instance == i)).count());
    assert!(layers.iter().all(|&n| n > 200), "{layers:?}");
    // Where a cell ends is rounded differently.
    assert!(apart <= 10, "{apart} apart");
}
