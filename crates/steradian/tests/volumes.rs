//! Media of files that vary.

use steradian::{CompileOptions, Quality, compile, formats::Options, load, render};

/// A `.vol` file of one channel.
fn voxels(size: [i32; 3], bounds: [f32; 6], values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for n in [1, size[0], size[1], size[2], 1] {
        bytes.extend(n.to_le_bytes());
    }
    bounds.iter().chain(values).for_each(|v| bytes.extend(v.to_le_bytes()));
    bytes
}

/// Mitsuba's `heterogeneous` with a grid of equal numbers is its `homogeneous` medium, wherever the grid lies, by its
/// transform or by the box in its file; one with an empty half lets more light through. Within 5σ of the frames.
#[test]
fn a_grid_of_equal_numbers_is_homogeneous() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    file("even.vol", &voxels([2, 2, 2], [-2.0, -2.0, -2.0, 2.0, 2.0, 2.0], &[1.5; 8]));
    file("half.vol", &voxels([2, 1, 1], [-2.0, -2.0, -2.0, 2.0, 2.0, 2.0], &[1.5, 0.0]));
    let seen = |sigma_t: &str| {
        let text = format!(
            "<scene version='3.0.0'><integrator type='volpath'><integer name='max_depth' value='12'/></integrator>
             <sensor type='perspective'><transform name='to_world'><lookat origin='0,0,-4' target='0,0,0' up='0,1,0'/>
             </transform><float name='fov' value='20'/><film type='hdrfilm'><integer name='width' value='8'/>
             <integer name='height' value='8'/></film></sensor><emitter type='constant'/>
             <shape type='cube'><bsdf type='null'/><medium name='interior' type='heterogeneous'>{sigma_t}
             <rgb name='albedo' value='.5 .7 .9'/><float name='scale' value='0.6'/></medium></shape></scene>"
        );
        let path = folder.path().join("scene.xml");
        std::fs::write(&path, text).expect("written");
        let loaded = load(&path, &Options::default());
        assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
        let scene = compile(&loaded.desc, &CompileOptions::default()).scene.expect("a scene");
        let frames = (0..6).map(|seed| {
            let picture =
                render(&scene, &Quality { spp: Some(256), seed: Some(seed), ..Quality::default() }).expect("a picture");
            let plane = picture.channel("G").expect("green");
            plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64
        });
        let frames: Vec<f64> = frames.collect();
        let mean = frames.iter().sum::<f64>() / 6.0;
        (mean, frames.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / 30.0)
    };
    let grid = |file: &str, place: &str| {
        format!("<volume name='sigma_t' type='gridvolume'><string name='filename' value='{file}'/>{place}</volume>")
    };
    let placed = "<transform name='to_world'><translate value='-.5'/><scale value='4'/></transform>";
    let boxed = "<boolean name='use_grid_bbox' value='true'/>";
    let plain = seen("<float name='sigma_t' value='1.5'/>");
    for place in [placed, boxed] {
        let even = seen(&grid("even.vol", place));
        let apart = (even.0 - plain.0).abs();
        assert!(apart < 5.0 * (even.1 + plain.1).sqrt() && apart < 0.01, "{place}: {even:?} {plain:?}");
        let half = seen(&grid("half.vol", place));
        assert!(half.0 > plain.0 + 0.05, "{place}: {half:?} {plain:?}");
    }
}
