//! Recursion, stacks and nested calls: legal up to the limit, an error beyond it.

use std::sync::Arc;
use steradian_math::Vec3;
use steradian_rt::context::{CallableContext, ClosestHitContext, MissContext, RayGenerationContext};
use steradian_rt::{
    Barycentrics, BottomLevel, BuildOptions, Callable, ClosestHit, Export, Fault, Geometries, HitGroupStack, Instance,
    Interface, LaunchError, Library, MAX_CALL_DEPTH, Miss, Pipeline, PipelineConfig, RayDesc, RayGeneration, Record,
    ShaderTable, ShaderTables, TopLevel, TraceRay, TriangleGeometry, TriangleGroup,
};

enum Deep {}

impl Interface for Deep {
    /// Number of rays that follow this one, and of those that have arrived.
    type Payload = (u32, u32);
    type Attributes = ();
    /// Number of calls that follow this one, and of those that have arrived.
    type Parameter = (u32, u32);
    type Local = ();
    type Output = [u32; 2];
}

struct Mirrors<'s> {
    scene: &'s TopLevel,
    rays: u32,
    calls: u32,
    /// True if shaders pass over faults.
    passes_over: bool,
}

impl Mirrors<'_> {
    fn ray(&self, direction: Vec3) -> TraceRay<'_> {
        TraceRay::new(self.scene, RayDesc::new(Vec3::ZERO, direction))
    }

    fn outcome(&self, result: Result<(), Fault>) -> Result<(), Fault> {
        if self.passes_over { Ok(()) } else { result }
    }
}

impl RayGeneration<Deep> for &Mirrors<'_> {
    fn run(&self, context: &mut RayGenerationContext<Deep>) -> Result<[u32; 2], Fault> {
        let (mut rays, mut calls) = ((self.rays, 0), (self.calls, 0));
        if let Some(following) = self.rays.checked_sub(1) {
            rays.0 = following;
            self.outcome(context.trace(&self.ray(Vec3::Z), &mut rays))?;
        }
        if let Some(following) = self.calls.checked_sub(1) {
            calls.0 = following;
            self.outcome(context.call(0, &mut calls))?;
        }
        Ok([rays.1, calls.1])
    }
}

impl ClosestHit<Deep, Barycentrics> for &Mirrors<'_> {
    fn run(&self, context: &mut ClosestHitContext<Deep>, rays: &mut (u32, u32), _: &Barycentrics) -> Result<(), Fault> {
        rays.1 += 1;
        let Some(following) = rays.0.checked_sub(1) else { return Ok(()) };
        rays.0 = following;
        // Every other ray misses.
        self.outcome(context.trace(&self.ray(-context.ray().direction), rays))
    }
}

impl Miss<Deep> for &Mirrors<'_> {
    fn run(&self, context: &mut MissContext<Deep>, rays: &mut (u32, u32)) -> Result<(), Fault> {
        rays.1 += 1;
        let Some(following) = rays.0.checked_sub(1) else { return Ok(()) };
        rays.0 = following;
        self.outcome(context.trace(&self.ray(-context.ray().direction), rays))
    }
}

impl Callable<Deep> for &Mirrors<'_> {
    fn run(&self, context: &mut CallableContext<Deep>, calls: &mut (u32, u32)) -> Result<(), Fault> {
        calls.1 += 1;
        let Some(following) = calls.0.checked_sub(1) else { return Ok(()) };
        calls.0 = following;
        self.outcome(context.call(0, calls))
    }
}

/// Declared bytes of ray generation, intersection, any hit, closest hit, miss, callable.
type Sizes = [u32; 6];

fn launch(config: PipelineConfig, sizes: Sizes, rays: u32, calls: u32) -> (u64, Result<Vec<[u32; 2]>, LaunchError>) {
    run(config, sizes, (rays, calls), false)
}

fn run(
    config: PipelineConfig,
    [generation, intersection, any_hit, closest_hit, miss, callable]: Sizes,
    (rays, calls): (u32, u32),
    passes_over: bool,
) -> (u64, Result<Vec<[u32; 2]>, LaunchError>) {
    let wall = [Vec3::new(-1.0, -1.0, 1.0), Vec3::new(0.0, 2.0, 1.0), Vec3::new(1.0, -1.0, 1.0)];
    let level = BottomLevel::build(Geometries::Triangles(&[TriangleGeometry::new(&wall)]), BuildOptions::default());
    let scene = TopLevel::build(&[Instance::new(Arc::new(level.expect("valid")))], BuildOptions::default());
    let mirrors = Mirrors { scene: &scene.expect("valid"), rays, calls, passes_over };
    let stack = HitGroupStack { intersection, any_hit, closest_hit };
    let library = Library::<Deep, _, _, _, _>::new()
        .with_ray_generation(Export::new("camera", &mirrors).with_stack(generation))
        .with_hit_group(Export::new("wall", TriangleGroup { any_hit: (), closest_hit: &mirrors }).with_stack(stack))
        .with_miss(Export::new("sky", &mirrors).with_stack(miss))
        .with_callable(Export::new("callable", &mirrors).with_stack(callable));
    let pipeline = Pipeline::link([library], config).expect("valid");
    let tables = ShaderTables::new(Record::new(pipeline.ray_generation("camera").expect("exported"), ()))
        .with_hit_groups(ShaderTable::new(vec![Record::new(pipeline.hit_group("wall").expect("exported"), ())]))
        .with_miss(ShaderTable::new(vec![Record::new(pipeline.miss("sky").expect("exported"), ())]))
        .with_callable(ShaderTable::new(vec![Record::new(pipeline.callable("callable").expect("exported"), ())]));
    (pipeline.default_stack_size(), pipeline.launch(&tables, [1, 1, 1]))
}

fn fault(fault: Fault) -> Result<Vec<[u32; 2]>, LaunchError> {
    Err(LaunchError::Fault { launch_id: [0; 3], fault })
}

#[test]
fn recursion_is_legal_exactly_to_the_limit() {
    for limit in 0..=31 {
        let config = PipelineConfig { max_recursion_depth: limit, stack_size: None };
        assert_eq!(launch(config, [0; 6], limit, 0).1, Ok(vec![[limit, 0]]));
        assert_eq!(launch(config, [0; 6], limit + 1, 0).1, fault(Fault::RecursionDepth { limit }));
        // A shader that passes over a fault does not save the launch.
        assert_eq!(run(config, [0; 6], (limit + 1, 0), true).1, fault(Fault::RecursionDepth { limit }));
    }
}

#[test]
fn the_default_stack_is_that_of_the_formula_and_suffices() {
    let sizes = [64, 10, 20, 100, 40, 8];
    for (depth, size) in [(0, 64 + 16), (1, 64 + 100 + 16), (2, 64 + 200 + 16), (31, 64 + 3100 + 16)] {
        let config = PipelineConfig { max_recursion_depth: depth, stack_size: None };
        let (stack, result) = launch(config, sizes, depth, 2);
        assert_eq!((stack, result), (size, Ok(vec![[depth, 2]])));
    }
    // Where intersection and any hit need more than the hit itself they count once.
    let config = PipelineConfig { max_recursion_depth: 3, stack_size: None };
    assert_eq!(launch(config, [1, 300, 50, 100, 120, 0], 0, 0).0, 1 + 350 + 2 * 120);
}

#[test]
fn a_stack_that_is_too_small_is_an_error() {
    // Camera, wall, sky, wall: 64 + 100 + 40 + 100.
    let config = |stack| PipelineConfig { max_recursion_depth: 3, stack_size: Some(stack) };
    let sizes = [64, 0, 0, 100, 40, 8];
    assert_eq!(launch(config(304), sizes, 3, 0).1, Ok(vec![[3, 0]]));
    assert_eq!(launch(config(303), sizes, 3, 0).1, fault(Fault::Stack { needed: 304, limit: 303 }));
    assert_eq!(launch(config(63), sizes, 0, 0).1, fault(Fault::Stack { needed: 64, limit: 63 }));
    let calls = PipelineConfig { max_recursion_depth: 0, stack_size: None };
    assert_eq!(launch(calls, sizes, 0, 3).1, fault(Fault::Stack { needed: 88, limit: 80 }));
}

#[test]
fn callable_shaders_nest_exactly_to_their_limit() {
    let config = PipelineConfig { max_recursion_depth: 0, stack_size: None };
    assert_eq!(launch(config, [0; 6], 0, MAX_CALL_DEPTH).1, Ok(vec![[0, MAX_CALL_DEPTH]]));
    let limit = MAX_CALL_DEPTH;
    assert_eq!(launch(config, [0; 6], 0, limit + 1).1, fault(Fault::CallDepth { limit }));
}
