//! The ray-tracing pipeline of `steradian-rt` against scenes and integrators.

use std::sync::Arc;
use steradian::{
    ColorMode, CompileOptions, Control, Quality, Scene, compile, load, load_bytes,
    math::{Ray, Vec3, hash::HashRng},
};
use steradian_rt::{
    Barycentrics, BottomLevel, BuildOptions, ClosestHit, Export, Fault, Geometries, Indices, Instance, Interface,
    Library, Pipeline, PipelineConfig, RayDesc, RayFlags, RayGeneration, RayQuery, Record, ShaderTable, ShaderTables,
    TopLevel, TraceRay, TriangleGeometry, TriangleGroup,
    context::{ClosestHitContext, RayGenerationContext},
};

#[path = "../../../rt/examples/cornell_box/main.rs"]
mod cornell_box;

/// The box by the path tracer of the example and by `path`: pixel by pixel within the noise of both, and their means.
#[test]
fn a_path_tracer_in_shaders_is_a_path_tracer() {
    const WIDTH: u32 = 24;
    const RUNS: u64 = 24;
    let mut loaded = load("builtin:cornell-box-area", &Default::default());
    let filter = loaded.desc.filter.expect("it has a filter");
    loaded.desc.node_mut(filter).kind = "box".into();
    let options = CompileOptions { size: Some((WIDTH, WIDTH)), mode: Some(ColorMode::Rgb), ..Default::default() };
    let scene = Arc::new(compile(&loaded.desc, &options).scene.expect("a sound scene"));
    // As many scattering events, and pixels that err independently.
    let integrator = Some(format!("path:reuse=1,max_depth={}", cornell_box::MAX_RAYS - 1));
    let quality = Quality { integrator, spp: Some(1024), ..Quality::default() };
    let mut session = quality.render(&scene).expect("registered").session(&scene).expect("a session");
    session.step(u32::MAX, &Control::default());
    let film = session.film();

    let runs: Vec<_> = (0..RUNS).map(|seed| cornell_box::render(WIDTH, 32, seed, false).expect("no fault")).collect();
    assert_eq!(cornell_box::render(WIDTH, 32, 0, true).expect("no fault"), runs[0], "recursion gives the same bits");
    let n = RUNS as f64;
    let (mut difference, mut variance, mut squares) = (0.0, 0.0, 0.0);
    for (i, pixel) in film.pixels.iter().enumerate() {
        for channel in 0..3 {
            let values = runs.iter().map(|run| f64::from(run[i][channel]));
            let mean = values.clone().sum::<f64>() / n;
            let own = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (n * (n - 1.0));
            let d = mean - pixel.mean()[channel];
            let v = own + pixel.variance_of_mean()[channel] + 1e-12;
            assert!(d * d < 36.0 * v, "pixel {i}, channel {channel}: {d} where the noise is {}", v.sqrt());
            (difference, variance, squares) = (difference + d, variance + v, squares + d * d / v);
        }
    }
    let count = (3 * WIDTH * WIDTH) as f64;
    // Channels of a pixel are correlated: at most by a factor of three.
    let error = difference / (3.0 * variance).sqrt();
    assert!(error.abs() < 4.0 && (0.7..1.5).contains(&(squares / count)), "{error} {}", squares / count);
}

/// Five meshes of random triangles as pbrt writes them, and their vertices.
fn meshes() -> (Scene, Vec<Vec<Vec3>>) {
    let mut rng = HashRng::new(3);
    let mut point = |size: f32| (Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0) * size;
    let mut triangle = |center: Vec3| [0; 3].map(|_| center + point(0.05));
    let mut centers = HashRng::new(4);
    let mut center = || Vec3::new(centers.next_f32(), centers.next_f32(), centers.next_f32()) * 2.0 - 1.0;
    let meshes: Vec<Vec<Vec3>> = (0..5).map(|_| (0..4000).flat_map(|_| triangle(center())).collect()).collect();
    let mut text = String::from("Camera \"perspective\"\nWorldBegin\n");
    for mesh in &meshes {
        let points: Vec<String> = mesh.iter().map(|p| format!("{} {} {}", p.x, p.y, p.z)).collect();
        let indices: Vec<String> = (0..mesh.len()).map(|i| i.to_string()).collect();
        let (points, indices) = (points.join(" "), indices.join(" "));
        text += &format!("Shape \"trianglemesh\" \"point3 P\" [{points}] \"integer indices\" [{indices}]\n");
    }
    let loaded = load_bytes("meshes.pbrt", text.into_bytes(), Some("pbrt"), &Default::default());
    assert!(!loaded.diagnostics.has_errors(), "{:#?}", loaded.diagnostics);
    (compile(&loaded.desc, &CompileOptions::default()).scene.expect("a sound scene"), meshes)
}

/// Distance, geometry, triangle, and where in it.
type Found = Option<(u32, [u32; 2], [u32; 2])>;

enum Finding {}
impl Interface for Finding {
    type Payload = Found;
    type Attributes = ();
    type Parameter = ();
    type Local = ();
    type Output = Found;
}

struct Rays<'s>(&'s TopLevel, &'s [Ray]);
impl RayGeneration<Finding> for Rays<'_> {
    fn run(&self, context: &mut RayGenerationContext<Finding>) -> Result<Found, Fault> {
        let ray = &self.1[context.launch().id[0] as usize];
        let mut found = None;
        context.trace(&TraceRay::new(self.0, RayDesc::new(ray.origin, ray.direction)), &mut found)?;
        Ok(found)
    }
}

struct Find;
impl ClosestHit<Finding, Barycentrics> for Find {
    fn run(&self, context: &mut ClosestHitContext<Finding>, out: &mut Found, at: &Barycentrics) -> Result<(), Fault> {
        *out = found(context.ray().t_current, context.primitive().id(), at);
        Ok(())
    }
}

fn found(t: f32, id: steradian_rt::PrimitiveId, at: &Barycentrics) -> Found {
    Some((t.to_bits(), [id.geometry, id.primitive], [at.u.to_bits(), at.v.to_bits()]))
}

/// A million rays: the scene, the pipeline and the query find the same, bit by bit.
#[test]
fn pipeline_query_and_scene_find_the_same() {
    let (scene, meshes) = meshes();
    let indices: Vec<u32> = (0..meshes[0].len() as u32).collect();
    let geometries: Vec<_> = meshes
        .iter()
        .map(|mesh| TriangleGeometry { indices: Indices::U32(&indices), ..TriangleGeometry::new(mesh) })
        .collect();
    let level = BottomLevel::build(Geometries::Triangles(&geometries), BuildOptions::default()).expect("valid");
    let top = TopLevel::build(&[Instance::new(Arc::new(level))], BuildOptions::default()).expect("valid");

    let mut rng = HashRng::new(5);
    let mut point = |size: f32| (Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0) * size;
    let rays: Vec<Ray> = (0..1_000_000)
        .map(|_| {
            let origin = point(3.0);
            Ray::new(origin, point(1.0) - origin)
        })
        .collect();

    let library = Library::<Finding, _, _>::new()
        .with_ray_generation(Export::new("rays", Rays(&top, &rays)))
        .with_hit_group(Export::new("find", TriangleGroup { any_hit: (), closest_hit: Find }));
    let pipeline = Pipeline::link([library], PipelineConfig::default()).expect("unique names");
    let find = Record { handle: pipeline.hit_group("find"), local: () };
    let tables = ShaderTables::new(Record { handle: pipeline.ray_generation("rays"), local: () })
        .with_hit_groups(ShaderTable::new(vec![find]).with_region(0, 0))
        .with_miss(ShaderTable::new(vec![Record::null(())]));
    let by_pipeline = pipeline.launch(&tables, [rays.len() as u32, 1, 1]).expect("no fault");

    let mut hits = 0;
    for (ray, by_pipeline) in rays.iter().zip(by_pipeline) {
        let desc = RayDesc::new(ray.origin, ray.direction);
        let mut query = RayQuery::new(Some(&top), RayFlags::NONE, 0xff, desc).expect("a legal ray");
        assert!(query.proceed().is_none());
        let by_query = query.committed().and_then(|hit| found(hit.t, hit.primitive.id(), &hit.barycentrics));
        let by_scene = scene
            .intersect(ray)
            .map(|hit| (hit.t.to_bits(), [hit.id.geom, hit.id.prim], [hit.u.to_bits(), hit.v.to_bits()]));
        assert_eq!((by_query, by_pipeline), (by_scene, by_scene), "{ray:?}");
        hits += usize::from(by_scene.is_some());
    }
    assert!(hits > 300_000, "{hits} hits");
}
