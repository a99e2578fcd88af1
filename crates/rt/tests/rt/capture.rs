//! Launches that are captured, written, read and replayed.

use crate::worlds::{instances, two_geometries};
use steradian_math::{Vec3, hash::HashRng};
use steradian_rt::context::{CallableContext, ClosestHitContext, MissContext, RayGenerationContext};
use steradian_rt::table::kind;
use steradian_rt::{
    Barycentrics, BuildOptions, Callable, Capture, ClosestHit, Export, Fault, HANDLE_BYTES, Interface, LaunchError,
    LaunchValues, Library, LoadError, Miss, Pipeline, PipelineConfig, RayDesc, RayGeneration, Record, ReplayError,
    ShaderTable, ShaderTables, TopLevel, TraceRay, TriangleGroup, UnknownHandle,
};

enum Marks {}
impl Interface for Marks {
    type Payload = [u32; 3];
    type Attributes = ();
    type Parameter = [u32; 3];
    type Local = u16;
    type Output = [u32; 3];
}

struct Camera<'s>(&'s TopLevel);
impl RayGeneration<Marks> for Camera<'_> {
    fn run(&self, context: &mut RayGenerationContext<Marks>) -> Result<[u32; 3], Fault> {
        let LaunchValues { id: [x, y, z], size } = context.launch();
        let mut mark = [0, 0, u32::from(*context.local())];
        let to = Vec3::new(x as f32 / size[0] as f32 - 0.5, y as f32 / size[1] as f32 - 0.5, 1.0);
        let ray = RayDesc::new(Vec3::new(0.0, 0.0, -4.0 - z as f32), to);
        let trace =
            TraceRay { ray_contribution: 1, geometry_multiplier: 1, miss_index: z, ..TraceRay::new(self.0, ray) };
        context.trace(&trace, &mut mark)?;
        context.call(x % 2, &mut mark)?;
        Ok(mark)
    }
}

/// Adds a number of its own and the local one.
struct Mark(u32);
impl Mark {
    fn mark(&self, local: u16, mark: &mut [u32; 3]) {
        mark[1] = mark[1] * 1000 + self.0 + u32::from(local);
    }
}
impl ClosestHit<Marks, Barycentrics> for Mark {
    fn run(&self, context: &mut ClosestHitContext<Marks>, mark: &mut [u32; 3], _: &Barycentrics) -> Result<(), Fault> {
        mark[0] = context.ray().t_current.to_bits();
        self.mark(*context.local(), mark);
        Ok(())
    }
}
impl Miss<Marks> for Mark {
    fn run(&self, context: &mut MissContext<Marks>, mark: &mut [u32; 3]) -> Result<(), Fault> {
        self.mark(*context.local(), mark);
        Ok(())
    }
}
impl Callable<Marks> for Mark {
    fn run(&self, context: &mut CallableContext<Marks>, mark: &mut [u32; 3]) -> Result<(), Fault> {
        self.mark(*context.local(), mark);
        Ok(())
    }
}

type Shaders<'s> = Pipeline<Marks, Camera<'s>, TriangleGroup<(), Mark>, Mark, Mark>;

/// A pipeline of these hit groups.
fn pipeline<'s>(scene: &'s TopLevel, groups: &[&str]) -> Shaders<'s> {
    let mut library = Library::new()
        .with_ray_generation(Export::new("camera", Camera(scene)))
        .with_miss(Export::new("a", Mark(10)))
        .with_callable(Export::new("a", Mark(20)));
    for name in groups {
        let closest_hit = Mark(name.len() as u32);
        library = library.with_hit_group(Export::new(*name, TriangleGroup { any_hit: (), closest_hit }));
    }
    Pipeline::link([library], PipelineConfig::default()).expect("valid")
}

fn tables(pipeline: &Shaders) -> ShaderTables<u16> {
    let group = |place: usize| pipeline.hit_group(["a", "bb"][place % 2]).expect("there");
    let groups = (0..16).map(|i| Record::new(group(i), 50 * i as u16)).collect();
    let (miss, callable) = (pipeline.miss("a").expect("there"), pipeline.callable("a").expect("there"));
    ShaderTables::new(Record::new(pipeline.ray_generation("camera").expect("there"), 7))
        .with_hit_groups(ShaderTable::new(groups).with_region(2, 2))
        .with_miss(ShaderTable::new(vec![Record::new(miss, 3), Record::null(4)]))
        .with_callable(ShaderTable::new(vec![Record::null(5), Record::new(callable, 6)]))
}

fn scene() -> TopLevel {
    let mut rng = HashRng::new(40);
    let levels = [two_geometries(&mut rng, 12), two_geometries(&mut rng, 9)];
    let placed = instances(&mut rng, &levels, 6).into_iter().map(|i| i.with_mask(0xff).with_hit_group_offset(1));
    TopLevel::build(&placed.collect::<Vec<_>>(), BuildOptions::default()).expect("valid")
}

fn from_bytes(bytes: &[u8]) -> Option<u16> {
    bytes.try_into().ok().map(u16::from_le_bytes)
}

const SIZE: [u32; 3] = [33, 17, 2];

fn captured() -> (TopLevel, Vec<u8>, Vec<[u32; 3]>) {
    let scene = scene();
    let first = pipeline(&scene, &["a", "bb"]);
    let tables = tables(&first);
    let capture = first.capture(&tables, SIZE, &scene, |local| local.to_le_bytes().to_vec()).expect("its own");
    let picture = first.launch(&tables, SIZE).expect("legal");
    (scene.clone(), capture.to_bytes(), picture)
}

#[test]
fn a_replay_has_the_bits_of_what_was_captured() {
    let (scene, bytes, picture) = captured();
    let capture = Capture::from_bytes(&bytes).expect("its own bytes");
    assert_eq!((capture.to_bytes(), capture.size()), (bytes, SIZE));
    assert!(capture.scene().same_bits(&scene));
    // Linked in another order, and with more: places differ, handles do not.
    let second = pipeline(capture.scene(), &["ccc", "bb", "a"]);
    let replayed = second.replay(&capture, from_bytes).expect("all there");
    assert_eq!(second.launch(&replayed, capture.size()).as_ref(), Ok(&picture));
    let marks: std::collections::HashSet<_> = picture.iter().map(|mark| mark[1]).collect();
    assert!(picture.iter().filter(|mark| mark[0] != 0).count() > 200 && marks.len() > 4, "{marks:?}");
}

#[test]
fn handles_that_a_pipeline_does_not_have_are_errors() {
    let (scene, bytes, _) = captured();
    let capture = Capture::from_bytes(&bytes).expect("its own bytes");
    let lacking = pipeline(&scene, &["a"]);
    let error = |kind, place| ReplayError::Handle { place, error: UnknownHandle { kind } };
    assert_eq!(lacking.replay(&capture, from_bytes).err(), Some(error("hit group", 1)));
    let local = ReplayError::Local { kind: "ray-generation shader", place: 0, bytes: 2 };
    assert_eq!(lacking.replay(&capture, |_| None).err(), Some(local));

    // Handles tell kinds apart, and come back in a pipeline of the same names.
    let (first, second) = (pipeline(&scene, &["a", "bb"]), pipeline(&scene, &["bb", "a"]));
    let group = first.hit_group("a").expect("there");
    let bytes = first.handle_bytes(group).expect("its own");
    assert_eq!(second.handle::<kind::HitGroup>(&bytes).ok(), second.hit_group("a"));
    assert_eq!(second.handle::<kind::Miss>(&bytes).err(), Some(UnknownHandle { kind: "miss shader" }));
    let none = Some(UnknownHandle { kind: "hit group" });
    assert_eq!(second.handle::<kind::HitGroup>(&[0; HANDLE_BYTES]).err(), none);
    assert_eq!(second.handle_bytes(group), None);
    let foreign = second.capture(&tables(&first), SIZE, &scene, |_| Vec::new()).err();
    assert_eq!(foreign, Some(LaunchError::ForeignHandle { table: "ray-generation", place: 0 }));
}

#[test]
fn bytes_that_are_no_capture_are_errors() {
    let (scene, bytes, _) = captured();
    let other = Some(LoadError::NoStructure { what: "capture of a launch" });
    assert_eq!(Capture::from_bytes(&scene.serialize()).err(), other);
    for end in (0..bytes.len()).step_by(7).chain([bytes.len() - 1]) {
        assert_eq!(Capture::from_bytes(&bytes[..end]).err(), Some(LoadError::TooShort));
    }
    let longer = [&bytes[..], &[0]].concat();
    assert_eq!(Capture::from_bytes(&longer).err(), Some(LoadError::TooLong { bytes: 1 }));
    let mut newer = bytes.clone();
    newer[8] = 9;
    assert_eq!(Capture::from_bytes(&newer).err(), Some(LoadError::Version { version: 9, readable: 1 }));
    // What can be read can be replayed, or is an error; launched it is a picture or a fault.
    let (mut rng, mut errors) = (HashRng::new(41), 0);
    for _ in 0..2000 {
        let mut broken = bytes.clone();
        let place = (rng.next_u64() % bytes.len() as u64) as usize;
        broken[place] = rng.next_u64() as u8;
        let Ok(capture) = Capture::from_bytes(&broken) else {
            errors += 1;
            continue;
        };
        let pipeline = pipeline(capture.scene(), &["a", "bb"]);
        match pipeline.replay(&capture, from_bytes) {
            Ok(tables) => drop(pipeline.launch(&tables, [2, 2, 1])),
            Err(_) => errors += 1,
        }
    }
    assert!(errors > 500, "{errors} errors");
}
