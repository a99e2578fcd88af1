//! Procedural spheres against a model that tries all of them.

use crate::worlds::{in_cube, ray, transform};
use std::ops::ControlFlow;
use std::sync::Arc;
use steradian_math::{Bounds3, Vec3, hash::HashRng};
use steradian_rt::context::{AnyHitContext, ClosestHitContext, IntersectionContext, MissContext, RayGenerationContext};
use steradian_rt::{
    AnyHit, BottomLevel, BoxGeometry, BuildOptions, ClosestHit, Decision, EndSearch, Export, Fault, Geometries,
    GeometryFlags, HitKind, Instance, Interface, Intersection, LaunchError, Library, Miss, Pipeline, PipelineConfig,
    ProceduralGroup, RayDesc, RayFlags, RayGeneration, Record, ShaderTable, ShaderTables, TopLevel, TraceRay,
};

#[derive(Clone, Copy)]
struct Sphere {
    center: Vec3,
    radius: f32,
}

/// Ray parameters of entry into a sphere and of exit.
fn crossings(sphere: &Sphere, origin: Vec3, direction: Vec3) -> Option<[f32; 2]> {
    let (o, d) = ((origin - sphere.center).as_dvec3(), direction.as_dvec3());
    let (a, b) = (d.dot(d), o.dot(d));
    let root = (b * b - a * (o.dot(o) - f64::from(sphere.radius).powi(2))).sqrt();
    root.is_finite().then(|| [((-b - root) / a) as f32, ((-b + root) / a) as f32])
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Seen {
    /// Distance, sphere, kind, and the attribute.
    hit: Option<(f32, u32, u8, f32)>,
    asked: u32,
    missed: bool,
    /// True once an any-hit shader has ended the search.
    ended: bool,
}

enum Spheres {}

impl Interface for Spheres {
    type Payload = Seen;
    type Attributes = f32;
    type Parameter = ();
    type Local = ();
    type Output = Seen;
}

struct Shaders<'s> {
    scene: &'s TopLevel,
    spheres: &'s [Sphere],
    rays: &'s [(RayDesc, RayFlags)],
    kind: HitKind,
}

impl RayGeneration<Spheres> for &Shaders<'_> {
    fn run(&self, context: &mut RayGenerationContext<Spheres>) -> Result<Seen, Fault> {
        let (ray, flags) = self.rays[context.launch().id[0] as usize];
        let mut seen = Seen::default();
        context.trace(&TraceRay { flags, ..TraceRay::new(self.scene, ray) }, &mut seen)?;
        Ok(seen)
    }
}

impl Intersection<Spheres> for &Shaders<'_> {
    fn run(&self, context: &mut IntersectionContext<Spheres>) -> ControlFlow<EndSearch> {
        let primitive = *context.primitive();
        let sphere = &self.spheres[primitive.primitive_index() as usize];
        let (origin, direction) = (primitive.object_ray_origin(), primitive.object_ray_direction());
        // The far one first, so that the interval shrinks twice.
        for t in crossings(sphere, origin, direction).into_iter().flatten().rev() {
            let (inside, before) = (context.ray(), t <= context.ray().t_current);
            let accepted = context.report_hit(t, self.kind, 2.0 * t)?;
            assert!(!accepted || before && t >= inside.t_min && context.ray().t_current == t);
        }
        ControlFlow::Continue(())
    }
}

/// Refuses every third sphere, and ends the search at every seventh.
impl AnyHit<Spheres, f32> for &Shaders<'_> {
    fn run(&self, context: &AnyHitContext<Spheres>, seen: &mut Seen, attribute: &f32) -> Decision {
        assert_eq!((*attribute, context.hit_kind()), (2.0 * context.ray().t_current, self.kind));
        assert!(!seen.ended, "asked after the end of the search");
        seen.asked += 1;
        match context.primitive().primitive_index() {
            i if i.is_multiple_of(3) => context.ignore_hit(),
            i if i.is_multiple_of(7) => {
                seen.ended = true;
                context.accept_hit_and_end_search()
            }
            _ => context.accept_hit(),
        }
    }
}

impl ClosestHit<Spheres, f32> for &Shaders<'_> {
    fn run(&self, context: &mut ClosestHitContext<Spheres>, seen: &mut Seen, attribute: &f32) -> Result<(), Fault> {
        let kind = context.hit_kind().get();
        seen.hit = Some((context.ray().t_current, context.primitive().primitive_index(), kind, *attribute));
        Ok(())
    }
}

impl Miss<Spheres> for &Shaders<'_> {
    fn run(&self, _: &mut MissContext<Spheres>, seen: &mut Seen) -> Result<(), Fault> {
        seen.missed = true;
        Ok(())
    }
}

fn launch(shaders: &Shaders) -> Result<Vec<Seen>, LaunchError> {
    let group = ProceduralGroup { intersection: shaders, any_hit: shaders, closest_hit: shaders };
    let library = Library::<Spheres, _, _, _>::new()
        .with_ray_generation(Export::new("rays", shaders))
        .with_hit_group(Export::new("spheres", group))
        .with_miss(Export::new("miss", shaders));
    let pipeline = Pipeline::link([library], PipelineConfig::default()).expect("unique names");
    let group = pipeline.hit_group("spheres").expect("exported");
    let tables = ShaderTables::new(Record::new(pipeline.ray_generation("rays").expect("exported"), ()))
        .with_hit_groups(ShaderTable::new(vec![Record::new(group, ())]))
        .with_miss(ShaderTable::new(vec![Record::new(pipeline.miss("miss").expect("exported"), ())]));
    pipeline.launch(&tables, [shaders.rays.len() as u32, 1, 1])
}

fn spheres(rng: &mut HashRng, count: usize) -> (Vec<Sphere>, Vec<Bounds3>) {
    let sphere = |rng: &mut HashRng| Sphere { center: in_cube(rng), radius: 0.02 + 0.3 * rng.next_f32() };
    let spheres: Vec<_> = (0..count).map(|_| sphere(rng)).collect();
    let boxes = spheres.iter().map(|s| Bounds3 { min: s.center - s.radius * 1.001, max: s.center + s.radius * 1.001 });
    let boxes = boxes.collect();
    (spheres, boxes)
}

#[test]
fn procedural_spheres_are_the_analytic_ones() {
    let mut rng = HashRng::new(8);
    let (spheres, boxes) = spheres(&mut rng, 60);
    let geometry = BoxGeometry::new(&boxes).with_flags(GeometryFlags::NONE);
    let level = BottomLevel::build(Geometries::Boxes(&[geometry]), BuildOptions::default()).expect("valid");
    let instance = Instance::new(Arc::new(level)).with_transform(transform(&mut rng));
    let scene = TopLevel::build(std::slice::from_ref(&instance), BuildOptions::default()).expect("valid");
    let flags = [
        RayFlags::NONE,
        RayFlags::FORCE_OPAQUE,
        RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH,
        RayFlags::CULL_NON_OPAQUE,
        RayFlags::SKIP_PROCEDURAL_PRIMITIVES,
    ];
    let rays: Vec<_> = (0..20_000)
        .map(|i| (ray(&mut rng).with_extents(0.4 * rng.next_f32(), 0.5 + rng.next_f32()), flags[i % flags.len()]))
        .collect();
    let kind = HitKind::procedural(5).expect("at most 127");
    let seen = launch(&Shaders { scene: &scene, spheres: &spheres, rays: &rays, kind }).expect("no fault");
    let inverse = instance.transform.to_mat4().as_dmat4().inverse().as_mat4();
    let (mut hits, mut missed, mut ended) = (0, 0, 0);
    for ((ray, flags), seen) in rays.into_iter().zip(seen) {
        let (origin, direction) = (inverse.transform_point3(ray.origin), inverse.transform_vector3(ray.direction));
        let is_opaque = flags == RayFlags::FORCE_OPAQUE;
        let culled = flags.intersects(RayFlags::CULL_NON_OPAQUE | RayFlags::SKIP_PROCEDURAL_PRIMITIVES);
        let all = spheres.iter().enumerate().filter(|(i, _)| !culled && (is_opaque || !i.is_multiple_of(3)));
        let all = all.flat_map(|(i, sphere)| {
            crossings(sphere, origin, direction).into_iter().flatten().map(move |t| (t, i as u32))
        });
        let all: Vec<_> = all.filter(|&(t, _)| ray.t_min <= t && t <= ray.t_max).collect();
        let nearest = all.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0));
        let hit = seen.hit.map(|(t, i, ..)| (t, i));
        if flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
            assert!(hit.is_none_or(|hit| all.contains(&hit)));
            assert_eq!(hit.is_some(), nearest.is_some());
        } else if seen.ended {
            // The hit that ended the search stands, though nearer ones were not looked for.
            assert!(hit.is_some_and(|hit| all.contains(&hit) && hit.1.is_multiple_of(7)), "{flags} {ray:?}");
            ended += usize::from(hit != nearest);
        } else {
            assert_eq!(hit, nearest, "{flags} {ray:?}");
        }
        assert!(seen.hit.is_none_or(|(t, _, kind, attribute)| (kind, attribute) == (5, 2.0 * t)));
        assert_eq!(seen.missed, seen.hit.is_none());
        assert!(!is_opaque || seen.asked == 0);
        hits += usize::from(seen.hit.is_some());
        missed += usize::from(seen.missed);
    }
    assert!(hits > 3000 && missed > 3000 && ended > 100, "{hits} hits, {missed} missed, {ended} ended early");
}

#[test]
fn hits_at_both_ends_of_the_interval_count() {
    let spheres = [Sphere { center: Vec3::ZERO, radius: 1.0 }];
    let boxes = [Bounds3 { min: -Vec3::ONE, max: Vec3::ONE }];
    let level = BottomLevel::build(Geometries::Boxes(&[BoxGeometry::new(&boxes)]), BuildOptions::default());
    let scene = TopLevel::build(&[Instance::new(Arc::new(level.expect("valid")))], BuildOptions::default());
    let ray = RayDesc::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z);
    let extents = [(0.0, 2.0), (2.0, 2.0), (2.0, 3.0), (2.5, 4.0), (4.0, 4.0), (0.0, 1.9), (4.1, 9.0)];
    let mut rays: Vec<_> = extents.iter().map(|&(a, b)| (ray.with_extents(a, b), RayFlags::NONE)).collect();
    // From the surface itself, in an interval of zero length.
    rays.push((RayDesc::new(-Vec3::Z, Vec3::Z).with_extents(0.0, 0.0), RayFlags::NONE));
    let kind = HitKind::procedural(127).expect("at most 127");
    let scene = scene.expect("valid");
    let seen = launch(&Shaders { scene: &scene, spheres: &spheres, rays: &rays, kind }).expect("no fault");
    let t: Vec<_> = seen.iter().map(|seen| seen.hit.map(|hit| hit.0)).collect();
    assert_eq!(t, [Some(2.0), Some(2.0), Some(2.0), Some(4.0), Some(4.0), None, None, Some(0.0)]);
    // A kind of triangles is a fault of the launch id.
    let kind = HitKind::TRIANGLE_BACK_FACE;
    let fault = launch(&Shaders { scene: &scene, spheres: &spheres, rays: &rays, kind }).err();
    assert_eq!(fault, Some(LaunchError::Fault { launch_id: [0; 3], fault: Fault::HitKind { kind: 255 } }));
}
