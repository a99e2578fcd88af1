//! All structures in one table, on generated meshes.

use crate::{
    generate,
    report::{Report, Table},
};
use serde_json::{Value, json};
use std::{error::Error, path::Path, sync::Arc, time::Duration};
use steradian::{Accelerator, CompileOptions, Scene, bench, formats::Options, scene::SceneDesc};

/// Sizes of meshes.
const TRIANGLES: [usize; 3] = [1_000, 30_000, 1_000_000];
/// Primitives with which testing all of them for every ray is not worth the wait.
const MOST_FOR_NONE: usize = 2_000;

/// Reads a scene that was generated.
pub fn load(path: &Path) -> Result<SceneDesc, Box<dyn Error>> {
    let loaded = steradian::load(path, &Options::default());
    match loaded.diagnostics.error_count() {
        0 => Ok(loaded.desc),
        _ => Err(format!("{} cannot be read", path.display()).into()),
    }
}

/// Compiles a scene; gives the seconds of building its structure, too.
pub fn compile(desc: &SceneDesc, options: &CompileOptions) -> Result<(Arc<Scene>, f64), Box<dyn Error>> {
    let compiled = steradian::compile(desc, options);
    let scene = compiled.scene.ok_or("a generated scene does not compile")?;
    Ok((Arc::new(scene), compiled.build_time.as_secs_f64()))
}

/// Measures.
pub fn measure(folder: &Path, most: usize, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let mut table = Table::new(
        "Structures",
        &[
            "triangles",
            "structure",
            "build s",
            "bytes per triangle",
            "primary Mrays/s",
            "steps",
            "tests",
            "bounce Mrays/s",
            "bounce steps",
            "bounce tests",
            "shadow Mrays/s",
            "shadow steps",
            "shadow tests",
        ],
    );
    let mut disagree = Vec::new();
    for triangles in TRIANGLES.into_iter().filter(|&n| n <= most) {
        let path = folder.join(format!("mesh_{triangles}.xml"));
        generate::scene(&path, &generate::bumpy_sphere(triangles), 256)?;
        let desc = load(&path)?;
        let faces = desc.face_count() as f64;
        let mut sets = None;
        let mut found = Vec::new();
        for accelerator in Accelerator::ALL {
            if accelerator == Accelerator::None && triangles > MOST_FOR_NONE {
                continue;
            }
            let (scene, build) = compile(&desc, &CompileOptions { accelerator, ..CompileOptions::default() })?;
            let sets = sets.get_or_insert_with(|| bench::ray_sets(&scene, 1 << 16));
            let name = accelerator.about().0;
            let mut cells: Vec<Value> =
                vec![json!(triangles), json!(name), json!(build), json!(scene.accel().bytes() as f64 / faces)];
            let mut checksums = Vec::new();
            for set in sets.iter() {
                let Some(m) = bench::measure(&scene, set, Duration::from_millis(300)) else { continue };
                cells.extend([json!(m.mrays_per_cpu_second), json!(m.steps), json!(m.tests)]);
                checksums.push(m.found);
            }
            if *found.first().get_or_insert(&checksums) != &checksums {
                disagree.push(format!("{name} at {triangles}"));
            }
            found.push(checksums);
            table.row(cells);
        }
    }
    table.note(if disagree.is_empty() {
        "One thread. All structures find the same hits, bit by bit.".into()
    } else {
        format!("One thread. THESE FIND OTHER HITS THAN THE HIERARCHY: {}.", disagree.join(", "))
    });
    report.add(table);
    Ok(())
}
