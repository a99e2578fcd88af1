//! Whole scenes: the published ones, and small ones for what directives mean.

use super::*;

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/assets/pbrt");
const SCENES: [&str; 6] = ["coffee", "cornell-box", "hair-curl", "staircase2", "veach-mis", "volumetric-caustic"];

#[test]
#[allow(clippy::print_stdout, reason = "says that it was skipped, and what was found")]
fn published_scenes_import_without_errors() {
    for name in SCENES {
        let path = Path::new(ASSETS).join(name).join("scene-v4.pbrt");
        if !path.is_file() {
            println!("skipped: no {name}");
            continue;
        }
        let Import { desc, diagnostics } = import(&path, &Options::default());
        for d in diagnostics.iter() {
            println!("{name}: {d}");
        }
        assert!(!diagnostics.has_errors(), "{name}");
        println!("{name}: {} shapes, {} faces, {} lights", desc.shapes.len(), desc.face_count(), desc.lights.len());
        assert!(!desc.shapes.is_empty());
    }
}
