//! Operations on acceleration structures: sizes before they are built, a build by two threads, compaction, structures
//! as bytes and back, and the capture of a launch with its replay. The picture is the same after each; it is written to
//! `builds.png`, and the size of each structure in bytes is printed.

pub mod scene;

use scene::{grid, pipeline};
use std::{collections::HashMap, error::Error, fmt::Write, sync::Arc, thread};
use steradian_image::Image;
use steradian_math::Vec3;
use steradian_rt::*;

const SIZE: [u32; 3] = [320, 240, 1];

/// Two objects, built by two threads and compacted.
fn objects(said: &mut String) -> Result<Vec<Arc<BottomLevel>>, Box<dyn Error>> {
    let hills = grid(40, |x, z| Vec3::new(4.0 * x, 0.5 * x * x * z, 4.0 * z));
    let sides = [1.0, -1.0].map(|z| grid(12, |x, y| Vec3::new(x, -z * y, -z).normalize()));
    let (hills, sides) = ([TriangleGeometry::new(&hills)], sides.each_ref().map(|side| TriangleGeometry::new(side)));
    let options = BuildOptions { allow_update: true, allow_compaction: true, ..BuildOptions::default() };
    let (hills, sides) = (Geometries::Triangles(&hills), Geometries::Triangles(&sides));
    let operation = DeferredBuild::new(vec![(hills, options), (sides, options)]);
    let work = || {
        while operation.join() == Join::Idle {
            thread::yield_now();
        }
    };
    thread::scope(|scope| (0..operation.max_concurrency().min(2)).for_each(|_| drop(scope.spawn(work))));
    let mut compacted = Vec::new();
    for (counts, level) in [&[3200][..], &[288, 288]].into_iter().zip(operation.result()?) {
        let most = BottomLevel::sizes(PrimitiveCounts::Triangles(counts), options)?;
        let (structure, scratch, update) = (most.structure, most.build_scratch, most.update_scratch);
        writeln!(said, "{counts:?} triangles: at most {structure}, to build {scratch}, to update {update}")?;
        writeln!(said, "  built {}, compacted {}", level.bytes(), level.compacted_bytes()?)?;
        compacted.push(Arc::new(level.compacted()?));
    }
    Ok(compacted)
}

/// The picture, and what all takes in bytes.
pub fn picture() -> Result<(Image, String), Box<dyn Error>> {
    let mut said = String::new();
    let levels = objects(&mut said)?;
    let place = |y: f32| Transform3x4::translation(Vec3::new(0.0, y, 0.0));
    let sides = Instance::new(levels[1].clone()).with_transform(place(0.9)).with_hit_group_offset(1);
    let instances = [Instance::new(levels[0].clone()), sides];
    let options = BuildOptions { allow_compaction: true, ..BuildOptions::default() };
    let built = TopLevel::build(&instances, options)?;
    let (most, small) = (TopLevel::sizes(2, options)?.structure, built.compacted_bytes()?);
    writeln!(said, "2 instances: at most {most}, built {}, compacted {small}", built.bytes())?;
    let scene = built.compacted()?;

    let first = pipeline(&scene)?;
    let camera = first.ray_generation("camera").ok_or("no such shader")?;
    let matt = first.hit_group("matt").ok_or("no such group")?;
    let colors = [Vec3::new(0.5, 0.7, 0.3), Vec3::new(0.8, 0.4, 0.2)];
    let tables = ShaderTables::new(Record::new(camera, Vec3::ZERO))
        .with_hit_groups(ShaderTable::new(colors.map(|color| Record::new(matt, color)).to_vec()))
        .with_miss(ShaderTable::new(vec![Record::null(Vec3::ZERO)]));
    let picture = first.launch(&tables, SIZE)?;

    // Structures as bytes, and back: the top level asks for its bottom levels by their handles.
    let bytes = scene.serialize();
    let saved: HashMap<_, _> = levels.iter().map(|level| (level.handle(), level.serialize())).collect();
    writeln!(said, "serialized {}, {}", bytes.len(), saved.values().map(Vec::len).sum::<usize>())?;
    let mut loaded = Vec::new();
    for handle in TopLevel::serialized_handles(&bytes)? {
        let level = saved.get(&handle).ok_or("no such structure")?;
        loaded.push(Arc::new(BottomLevel::deserialize(level)?));
    }
    let loaded = TopLevel::deserialize(&bytes, &loaded)?;

    // The same shaders have the same handles in every pipeline, so that captured tables can be replayed.
    let second = pipeline(&loaded)?;
    let handle = first.handle_bytes(camera).ok_or("another pipeline")?;
    let capture = first.capture(&tables, SIZE, &scene, |color| color.to_array().map(f32::to_le_bytes).concat())?;
    let capture = Capture::from_bytes(&capture.to_bytes())?;
    writeln!(said, "capture {}, handle {:02x?}", capture.to_bytes().len(), &handle[..8])?;
    let color = |bytes: &[u8]| {
        let (numbers, []) = bytes.as_chunks() else { return None };
        Some(Vec3::from_array(<[[u8; 4]; 3]>::try_from(numbers).ok()?.map(f32::from_le_bytes)))
    };
    let replayed = second.replay(&capture, color)?;
    if !(replayed.ray_generation.handle == Some(second.handle(&handle)?)
        && [&loaded, capture.scene()].iter().all(|again| again.same_bits(&scene))
        && second.launch(&replayed, capture.size())? == picture)
    {
        return Err("not the same".into());
    }
    let colors: Vec<_> = picture.iter().map(Vec3::to_array).collect();
    Ok((Image::from_rgb(SIZE[0] as usize, SIZE[1] as usize, &colors)?, said))
}

#[allow(dead_code, clippy::print_stdout, reason = "tests include this file")]
fn main() -> Result<(), Box<dyn Error>> {
    let (image, said) = picture()?;
    print!("{said}");
    Ok(steradian_image::write("builds.png".as_ref(), &image, &Default::default())?)
}
