//! Inspection of a launch id.

use std::ops::ControlFlow;
use std::sync::Arc;
use steradian_math::{Bounds3, Vec3};
use steradian_rt::context::{
    AnyHitContext, CallableContext, ClosestHitContext, IntersectionContext, MissContext, RayGenerationContext,
};
use steradian_rt::{
    AnyHit, Barycentrics, BottomLevel, BoxGeometry, BuildOptions, Callable, ClosestHit, Decision, EndSearch, Event,
    Export, Fault, Geometries, GeometryFlags, HitGroup, HitKind, Instance, Interface, Intersection, LaunchError,
    Library, Miss, Pipeline, PipelineConfig, ProceduralGroup, RayDesc, RayGeneration, Record, ShaderTable,
    ShaderTables, TopLevel, TraceRay, Transform3x4, TriangleGeometry, TriangleGroup,
};

enum Numbers {}
impl Interface for Numbers {
    type Payload = f32;
    type Attributes = ();
    type Parameter = f32;
    type Local = ();
    type Output = f32;
}

struct Shaders(TopLevel);

/// Along z, but for the second column, which asks for a record that is not there.
impl RayGeneration<Numbers> for Shaders {
    fn run(&self, context: &mut RayGenerationContext<Numbers>) -> Result<f32, Fault> {
        let [x, y, _] = context.launch().id;
        let mut t = 0.0;
        let ray = RayDesc::new(Vec3::new(0.2, if y == 0 { 0.2 } else { 9.0 }, -1.0), Vec3::Z);
        context.trace(&TraceRay { ray_contribution: 5 * x, ..TraceRay::new(&self.0, ray) }, &mut t)?;
        Ok(t)
    }
}

/// Nothing but the ball at z = 5 stops a ray.
struct Through;
impl AnyHit<Numbers, Barycentrics> for Through {
    fn run(&self, context: &AnyHitContext<Numbers>, _: &mut f32, _: &Barycentrics) -> Decision {
        context.ignore_hit()
    }
}

impl Intersection<Numbers> for Through {
    fn run(&self, context: &mut IntersectionContext<Numbers>) -> ControlFlow<EndSearch> {
        let kind = HitKind::procedural(3).expect("small");
        context.report_hit(-1.0, kind, ())?;
        context.report_hit(6.0, kind, ())?;
        ControlFlow::Continue(())
    }
}

impl AnyHit<Numbers, ()> for Through {
    fn run(&self, context: &AnyHitContext<Numbers>, _: &mut f32, _: &()) -> Decision {
        context.accept_hit_and_end_search()
    }
}

impl ClosestHit<Numbers, ()> for Through {
    fn run(&self, context: &mut ClosestHitContext<Numbers>, t: &mut f32, _: &()) -> Result<(), Fault> {
        *t = context.ray().t_current;
        context.call(0, t)
    }
}

impl Callable<Numbers> for Through {
    fn run(&self, _: &mut CallableContext<Numbers>, t: &mut f32) -> Result<(), Fault> {
        *t *= 2.0;
        Ok(())
    }
}

impl Miss<Numbers> for Through {
    fn run(&self, _: &mut MissContext<Numbers>, t: &mut f32) -> Result<(), Fault> {
        *t = -1.0;
        Ok(())
    }
}

fn scene() -> TopLevel {
    let corners = [Vec3::ZERO, Vec3::Y, Vec3::X];
    let card = TriangleGeometry::new(&corners).with_flags(GeometryFlags::NONE);
    let card = BottomLevel::build(Geometries::Triangles(&[card]), BuildOptions::default()).expect("valid");
    let boxes = [Bounds3::new(Vec3::NEG_ONE, Vec3::ONE)];
    let ball = BoxGeometry::new(&boxes).with_flags(GeometryFlags::NONE);
    let ball = BottomLevel::build(Geometries::Boxes(&[ball]), BuildOptions::default()).expect("valid");
    let behind = Transform3x4::translation(5.0 * Vec3::Z);
    let ball = Instance::new(Arc::new(ball)).with_transform(behind).with_hit_group_offset(1);
    TopLevel::build(&[Instance::new(Arc::new(card)), ball], BuildOptions::default()).expect("valid")
}

const SIZE: [u32; 3] = [2, 2, 1];

#[test]
fn everything_that_happens_is_told_in_order() {
    let card: Box<dyn HitGroup<Numbers>> = Box::new(TriangleGroup { any_hit: Through, closest_hit: () });
    let ball = Box::new(ProceduralGroup { intersection: Through, any_hit: Through, closest_hit: Through });
    let library = Library::<Numbers, _, _, _, _>::new()
        .with_ray_generation(Export::new("rays", Shaders(scene())))
        .with_hit_group(Export::new("card", card))
        .with_hit_group(Export::new("ball", ball))
        .with_miss(Export::new("sky", Through))
        .with_callable(Export::new("double", Through));
    let pipeline = Pipeline::link([library], PipelineConfig::default()).expect("unique names");
    let group = |name| Record::new(pipeline.hit_group(name).expect("exported"), ());
    let tables = ShaderTables::new(Record::new(pipeline.ray_generation("rays").expect("exported"), ()))
        .with_hit_groups(ShaderTable::new(vec![group("card"), group("ball")]))
        .with_miss(ShaderTable::new(vec![Record::new(pipeline.miss("sky").expect("exported"), ())]))
        .with_callable(ShaderTable::new(vec![Record::new(pipeline.callable("double").expect("exported"), ())]));
    let inspect = |id| pipeline.inspect(&tables, SIZE, id);

    let hit = inspect([0, 0, 0]).expect("legal");
    assert_eq!(hit.output, Ok(12.0));
    let expected = r#"launch id 0, 0, 0
  ray generation shader "rays"
    trace from [0.2, 0.2, -1] along [0, 0, 1], 0 to inf, flags NONE, mask 0xff
      candidate: non-opaque triangle 0.0.0 at t = 1
      hit-group record 0 = 0 + 1 * (0 + 1 * 0 + 0): "card"
      any hit shader "card"
        decision: ignore
      candidate: non-opaque box 1.0.0 at t = 4.9999976
      hit-group record 1 = 0 + 1 * (0 + 1 * 0 + 1): "ball"
      intersection shader "ball"
        report t = -1, kind 3: does not count
        any hit shader "ball"
          decision: accept and end search
        report t = 6, kind 3: counts
      hit: 1.0.0 at t = 6
      hit-group record 1 = 0 + 1 * (0 + 1 * 0 + 1): "ball"
      closest hit shader "ball"
        call 0
          callable record 0 = 0 + 1 * 0: "double"
          callable shader "double"
"#;
    assert_eq!(hit.to_string(), expected);
    let json = hit.to_json();
    assert_eq!(json["events"].as_array().map(Vec::len), Some(hit.events.len()));
    assert_eq!(json["events"][1]["t_max"], serde_json::Value::Null);
    assert_eq!((&json["events"][1]["event"], &json["events"][1]["depth"]), (&"trace".into(), &1.into()));
    assert_eq!(
        (&json["events"][3]["table"], &json["events"][8]["stage"]),
        (&"hit_group".into(), &"intersection".into())
    );

    let miss = inspect([0, 1, 0]).expect("legal");
    let told = miss.to_string();
    let end = "      no hit\n      miss record 0 = 0 + 1 * 0: \"sky\"\n      miss shader \"sky\"\n";
    assert!(miss.output == Ok(-1.0) && told.ends_with(end), "{told}");

    let fault = inspect([1, 0, 0]).expect("legal");
    assert!(matches!(fault.output, Err(Fault::HitGroupRecord { place: 5, .. })));
    let last = fault.events.last().map(|entry| &entry.event);
    assert!(matches!(last, Some(Event::Fault { message }) if message.contains("no hit-group record at 5 = 0 + 1 *")));
    assert_eq!(inspect([2, 0, 0]).err(), Some(LaunchError::NoLaunchId { launch_id: [2, 0, 0], size: SIZE }));
}
