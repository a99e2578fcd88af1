//! Media of files that vary.

use steradian::{CompileOptions, Quality, compile, formats::Options, load, render, scene::Severity};

/// A `.vol` file of as many channels as there are values for.
fn voxels(size: [i32; 3], bounds: [f32; 6], values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    let channels = values.len() as i32 / size.iter().product::<i32>();
    for n in [1, size[0], size[1], size[2], channels] {
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
    let seen = |kind: &str, sigma_t: &str| {
        let text = format!(
            "<scene version='3.0.0'><integrator type='volpath'><integer name='max_depth' value='12'/></integrator>
             <sensor type='perspective'><transform name='to_world'><lookat origin='0,0,-4' target='0,0,0' up='0,1,0'/>
             </transform><float name='fov' value='20'/><film type='hdrfilm'><integer name='width' value='8'/>
             <integer name='height' value='8'/></film></sensor><emitter type='constant'/>
             <shape type='cube'><bsdf type='null'/><medium name='interior' type='{kind}'>{sigma_t}
             <rgb name='albedo' value='.5 .7 .9'/><float name='scale' value='0.6'/></medium></shape></scene>"
        );
        let path = folder.path().join("scene.xml");
        std::fs::write(&path, text).expect("written");
        let loaded = load(&path, &Options::default());
        assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
        let scene = std::sync::Arc::new(compile(&loaded.desc, &CompileOptions::default()).scene.expect("a scene"));
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
    let plain = seen("homogeneous", "<float name='sigma_t' value='1.5'/>");
    for place in [placed, boxed] {
        let even = seen("heterogeneous", &grid("even.vol", place));
        let apart = (even.0 - plain.0).abs();
        assert!(apart < 5.0 * (even.1 + plain.1).sqrt() && apart < 0.01, "{place}: {even:?} {plain:?}");
        let half = seen("heterogeneous", &grid("half.vol", place));
        assert!(half.0 > plain.0 + 0.05, "{place}: {half:?} {plain:?}");
    }
}

/// A heterogeneous medium of Mitsuba fills the box, parallel to the axes, around the unit cube of its extinction, with
/// the filter and the wrapping of the grid; albedo may be a grid that lies elsewhere. Each is seen along z before an
/// even sky of one, of which exp(−∫σ_t) passes where nothing is scattered, and all returns where nothing is absorbed.
#[test]
fn media_of_mitsuba_have_its_boxes_filters_and_albedo() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, size, values: &[f32]| {
        std::fs::write(folder.path().join(name), voxels(size, [0.0, 0.0, 0.0, 1.0, 1.0, 1.0], values))
            .expect("written");
    };
    file("one.vol", [2; 3], &[1.0; 8]);
    file("step.vol", [2, 1, 1], &[2.0, 0.0]);
    file("albedo.vol", [2, 1, 1], &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0]);
    let seen = |(x, y): (f64, f64), medium: &str| {
        let text = format!(
            "<scene version='3.0.0'><integrator type='volpath'><integer name='max_depth' value='400'/></integrator>
             <sensor type='orthographic'><transform name='to_world'><scale x='.001' y='.001'/>
             <lookat origin='{x},{y},-20' target='{x},{y},0' up='0,1,0'/></transform>
             <film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='4'/>
             <rfilter type='box'/></film></sensor><emitter type='constant'/>
             <shape type='sphere'><float name='radius' value='10'/><bsdf type='null'/>
             <medium name='interior' type='heterogeneous'>{medium}</medium></shape></scene>"
        );
        let path = folder.path().join("scene.xml");
        std::fs::write(&path, text).expect("written");
        let loaded = load(&path, &Options::default());
        let compiled = compile(&loaded.desc, &CompileOptions::default());
        let all = loaded.diagnostics.iter().chain(compiled.diagnostics.iter());
        let said: Vec<_> = all.filter(|d| d.severity != Severity::Note).map(|d| &d.message).collect();
        assert!(said.is_empty(), "{said:?}");
        let quality = Quality { spp: Some(4096), ..Quality::default() };
        let picture = render(&std::sync::Arc::new(compiled.scene.expect("a scene")), &quality).expect("a picture");
        ["R", "G", "B"].map(|c| picture.channel(c).expect("a channel").iter().sum::<f32>() / 16.0)
    };
    let volume = |name: &str, file: &str, more: &str| {
        let file = format!("<string name='filename' value='{file}'/><boolean name='raw' value='true'/>");
        format!("<volume name='{name}' type='gridvolume'>{file}{more}</volume>")
    };
    let black = "<float name='albedo' value='0'/>";
    let constant = |place: &str| {
        format!("{black}<volume name='sigma_t' type='constvolume'><float name='value' value='.8'/>{place}</volume>")
    };
    // The unit square turned by 45° about its corner.
    let turned = "<transform name='to_world'><rotate y='1' angle='45'/></transform>";
    let nearest = "<string name='filter_type' value='nearest'/>";
    let wrapped = |mode: &str| format!("{turned}<string name='wrap_mode' value='{mode}'/>{nearest}");
    let diagonal = std::f32::consts::SQRT_2;
    let step = |more: &str| format!("{black}{}", volume("sigma_t", "step.vol", more));
    let far = |x: i32| {
        format!("{nearest}<transform name='to_world'><scale value='200'/><translate x='{x}' y='-9'/></transform>")
    };
    let albedo = |x: i32| volume("sigma_t", "one.vol", "") + &volume("albedo", "albedo.vol", &far(x));
    let cases = [
        ("a constant", (0.5, 0.5), constant(""), [(-0.8_f32).exp(); 3]),
        ("beside a constant", (-0.5, 0.5), constant(""), [1.0; 3]),
        ("a number", (0.5, 0.5), format!("{black}<float name='sigma_t' value='.8'/>"), [(-0.8_f32).exp(); 3]),
        ("extinction of one where none is given", (0.5, 0.5), black.into(), [(-1.0_f32).exp(); 3]),
        ("a constant turned", (0.1, 0.5), constant(turned), [(-0.8 * diagonal).exp(); 3]),
        (
            "a grid turned",
            (0.1, 0.5),
            format!("{black}{}", volume("sigma_t", "one.vol", turned)),
            [(-diagonal).exp(); 3],
        ),
        ("beside a grid turned", (1.5, 0.5), format!("{black}{}", volume("sigma_t", "one.vol", turned)), [1.0; 3]),
        ("between numbers", (0.4, 0.5), step(""), [(-1.4_f32).exp(); 3]),
        ("the nearest", (0.4, 0.5), step(nearest), [(-2.0_f32).exp(); 3]),
        // Along z, from −√½ to √½, the first of the two numbers is from x = 0 to ½ of the turned grid: √½ of the way.
        ("clamped", (0.1, 0.5), step(&wrapped("clamp")), [(-2.0 * (diagonal - 0.1)).exp(); 3]),
        ("mirrored", (0.1, 0.5), step(&wrapped("mirror")), [(-2.0 * (diagonal - 0.1)).exp(); 3]),
        ("repeated", (0.1, 0.5), step(&wrapped("repeat")), [(-diagonal).exp(); 3]),
        ("albedo (0, 0, 0)", (0.5, 0.5), albedo(0), [(-1.0_f32).exp(); 3]),
        ("albedo (1, 0, 1)", (0.5, 0.5), albedo(-150), [1.0, (-1.0_f32).exp(), 1.0]),
        ("albedo beyond its grid", (0.5, 0.5), albedo(-300), [1.0, (-1.0_f32).exp(), 1.0]),
    ];
    for (what, at, medium, expected) in cases {
        let found = seen(at, &medium);
        // 65536 samples of a variance of a quarter at most: σ = 0.002.
        let is_near = found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 0.01);
        assert!(is_near, "{what}: {found:?}, not {expected:?}");
    }
}
