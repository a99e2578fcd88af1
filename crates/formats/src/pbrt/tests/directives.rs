//! Effect of directives on the graphics state, and of the state on what follows.

use super::*;
use crate::Limits;
use steradian_scene::{ColorSpace, SpectrumValue, Value};

#[test]
fn transforms_compose_in_order() {
    for (text, p, image) in [
        ("Translate 1 2 3", [1.0, 1.0, 1.0], [2.0, 3.0, 4.0]),
        ("Scale 2 3 4", [1.0, 1.0, 1.0], [2.0, 3.0, 4.0]),
        ("Translate 1 0 0 Scale 2 2 2", [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]),
        ("Scale 2 2 2 Translate 1 0 0", [1.0, 0.0, 0.0], [4.0, 0.0, 0.0]),
        ("Rotate 90 0 0 1", [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ("Rotate -90 0 2 0", [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ("Translate 9 9 9 Identity", [1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
        ("Translate 9 9 9 Transform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1]", [0.0; 3], [5.0, 6.0, 7.0]),
        ("Translate 1 1 1 ConcatTransform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1]", [0.0; 3], [6.0, 7.0, 8.0]),
        ("AttributeBegin Translate 1 0 0 AttributeEnd", [0.0; 3], [0.0; 3]),
        ("CoordinateSystem \"a\" Translate 1 0 0 CoordSysTransform \"a\"", [0.0; 3], [0.0; 3]),
        ("Translate 1 0 0 CoordSysTransform \"world\"", [0.0; 3], [0.0; 3]),
        // LookAt maps the eye to the origin and the view to +z.
        ("LookAt 1 2 3  1 2 4  0 1 0", [1.0, 2.0, 5.0], [0.0, 0.0, 2.0]),
        ("LookAt 0 0 0  1 0 0  0 0 1", [3.0, 0.0, 0.0], [0.0, 0.0, 3.0]),
    ] {
        let d = world(&format!("{text} Shape \"sphere\""));
        assert_near(image_of(d.shapes[0].world_from_object, p), image);
    }
}

#[test]
fn the_camera_takes_the_inverse_and_names_its_space() {
    let d =
        load("Translate 0 0 5 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\" Shape \"sphere\"").desc;
    assert_near(image_of(camera(&d).transform("to_world").unwrap(), [0.0; 3]), [0.0, 0.0, -5.0]);
    assert_near(image_of(d.shapes[0].world_from_object, [0.0; 3]), [0.0, 0.0, -5.0]);
    // World space starts afresh.
    let d = load("Translate 0 0 5 WorldBegin Shape \"sphere\"").desc;
    assert_near(image_of(d.shapes[0].world_from_object, [0.0; 3]), [0.0; 3]);
}

#[test]
fn cameras_shapes_and_instances_move() {
    let i = load(
        "TransformTimes 2 3\nActiveTransform EndTime Translate 0 0 -5 ActiveTransform All\nCamera \"perspective\"\nWorldBegin\n\
         ObjectBegin \"o\" Shape \"sphere\" ObjectEnd\nAttributeBegin ActiveTransform EndTime Translate 1 0 0\n\
         Shape \"sphere\" Shape \"disk\" ObjectInstance \"o\" AttributeEnd Shape \"sphere\"",
    );
    assert!(i.diagnostics.is_empty());
    let d = i.desc;
    assert_eq!((d.shapes.len(), d.groups.len(), d.instances.len()), (1, 3, 3));
    for instance in &d.instances {
        let movement = instance.movement.unwrap();
        assert_eq!(movement.times, [2.0, 3.0]);
        assert_near(image_of(instance.world_from_group, [0.0; 3]), [0.0; 3]);
        assert_near(image_of(movement.end, [0.0; 3]), [1.0, 0.0, 0.0]);
        assert_eq!(d.groups[instance.group].shapes.len(), 1);
    }
    let camera = d.node(d.cameras[0]);
    assert_near(image_of(camera.transform("to_world_end").unwrap(), [0.0; 3]), [0.0, 0.0, 5.0]);
    // What cannot move is said once.
    let i = load(
        "WorldBegin\nActiveTransform EndTime Translate 1 0 0 ActiveTransform All\nLightSource \"point\"\n\
         AreaLightSource \"diffuse\" Shape \"sphere\"",
    );
    assert!(i.diagnostics.is_lossy() && i.desc.shapes.is_empty());
    assert!(i.desc.instances[0].movement.is_some() && i.desc.groups[0].shapes[0].emission.is_some());
    assert!(load("TransformTimes 1 1\nWorldBegin").diagnostics.has_errors());
    let i = load(
        "WorldBegin\nActiveTransform StartTime Translate 1 0 0 ActiveTransform EndTime Translate 1 0 0\nShape \"sphere\"",
    );
    assert!(i.diagnostics.is_empty(), "both ends moved the same way");
    assert_near(image_of(i.desc.shapes[0].world_from_object, [0.0; 3]), [1.0, 0.0, 0.0]);
}

#[test]
fn blocks_save_everything() {
    let d = world(
        "Material \"diffuse\"
        AttributeBegin
            Material \"conductor\" ReverseOrientation AreaLightSource \"diffuse\" ColorSpace \"rec2020\"
            MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" MediumInterface \"fog\" \"\"
            Attribute \"shape\" \"float radius\" 3
            Shape \"sphere\"
        AttributeEnd
        LightSource \"point\" \"rgb I\" [1 2 3]
        Shape \"sphere\"",
    );
    let [inner, outer] = &d.shapes[..] else { panic!() };
    assert!(inner.reverse_orientation && inner.emission.is_some() && inner.is_medium_boundary);
    assert_eq!((d.node(inner.node).float("radius"), d.node(outer.node).float("radius")), (Some(3.0), Some(1.0)));
    assert!(!outer.reverse_orientation && outer.emission.is_none() && !outer.is_medium_boundary);
    assert_eq!(d.node(outer.material.unwrap()).kind, "diffuse");
    assert_eq!(light(&d).get("intensity"), Some(&SpectrumValue::Rgb([1.0, 2.0, 3.0], ColorSpace::Srgb).into()));
}

#[test]
fn color_spaces_hold_where_the_value_is_written() {
    let d = world(
        "ColorSpace \"aces2065-1\" Attribute \"light\" \"rgb I\" [1 1 1]
        ColorSpace \"rec2020\" LightSource \"point\" LightSource \"point\" \"rgb I\" [1 1 1]
        LightSource \"distant\"",
    );
    let space = |i: usize, name: &str| match d.node(d.lights[i]).get(name) {
        Some(Value::Spectrum(SpectrumValue::Rgb(_, space))) => *space,
        other => panic!("{other:?}"),
    };
    assert_eq!(space(0, "intensity"), ColorSpace::Aces, "that of Attribute");
    assert_eq!(space(1, "intensity"), ColorSpace::Rec2020);
    assert_eq!(space(2, "radiance"), ColorSpace::Rec2020, "the default is that space's white");
}

#[test]
fn media_change_only_where_they_differ() {
    let d = world(
        "MakeNamedMedium \"a\" \"string type\" \"homogeneous\" MakeNamedMedium \"b\" \"string type\" \"homogeneous\"
        MediumInterface \"a\" \"b\" Shape \"sphere\"
        MediumInterface \"a\" Shape \"sphere\"
        MediumInterface \"\" \"\" Shape \"sphere\"
        MediumInterface \"\" \"b\" Shape \"sphere\" LightSource \"point\"",
    );
    let name = |m: Option<steradian_scene::NodeId>| m.and_then(|m| d.node(m).name.clone());
    let sides: Vec<_> = d.shapes.iter().map(|s| (s.is_medium_boundary, name(s.interior), name(s.exterior))).collect();
    let (a, b) = (Some("a".to_string()), Some("b".to_string()));
    assert_eq!(sides, [(true, a, b.clone()), (false, None, None), (false, None, None), (true, None, b.clone())]);
    assert_eq!(name(light(&d).node("medium")), b);
}

#[test]
fn the_camera_stands_in_the_outer_medium() {
    let d = options(
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" MediumInterface \"\" \"fog\" Camera \"perspective\"",
    );
    assert_eq!(d.node(camera(&d).node("medium").unwrap()).name.as_deref(), Some("fog"));
}

#[test]
fn objects_are_placed_by_instances() {
    let d = world(
        "ObjectInstance \"late\"
        ObjectBegin \"late\" Translate 1 0 0 Shape \"sphere\" ObjectEnd
        Translate 0 2 0 ObjectInstance \"late\"",
    );
    assert!(d.shapes.is_empty());
    assert_eq!((d.groups.len(), d.groups[0].shapes.len(), d.instances.len()), (1, 1, 2));
    let place = |i: usize| d.instances[i].world_from_group * d.groups[0].shapes[0].world_from_object;
    assert_near(image_of(place(0), [0.0; 3]), [1.0, 0.0, 0.0]);
    assert_near(image_of(place(1), [0.0; 3]), [1.0, 2.0, 0.0]);
    assert!(d.groups[0].shapes[0].material.is_some());
}

#[test]
fn objects_do_not_emit() {
    let i = load(
        "WorldBegin AreaLightSource \"diffuse\" ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"",
    );
    assert!(i.desc.groups[0].shapes[0].emission.is_none() && i.diagnostics.is_lossy());
}

#[test]
fn invisible_surfaces_do_not_emit() {
    let i = load("WorldBegin AreaLightSource \"diffuse\" Material \"interface\" Shape \"sphere\"");
    assert!(i.desc.shapes[0].emission.is_none() && i.diagnostics.is_lossy());
}

#[test]
fn named_materials_and_defaults() {
    let d = world(
        "Shape \"sphere\" NamedMaterial \"later\" Shape \"sphere\" Material \"dielectric\" Shape \"sphere\"
        MakeNamedMaterial \"later\" \"string type\" \"conductor\"",
    );
    let kinds: Vec<_> = d.shapes.iter().map(|s| d.node(s.material.unwrap()).kind.as_str()).collect();
    assert_eq!(kinds, ["diffuse", "conductor", "dielectric"]);
}

#[test]
fn float_and_spectrum_textures_have_their_own_names() {
    let d = world(
        "Texture \"t\" \"float\" \"constant\" \"float value\" 0.25
        Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [1 0 0]
        Material \"coateddiffuse\" \"texture reflectance\" \"t\" \"texture roughness\" \"t\" Shape \"sphere\"",
    );
    let m = material(&d);
    let of = |name: &str| d.node(m.node(name).unwrap()).get("value").unwrap();
    assert_eq!(of("alpha_u"), &Value::Float(0.25));
    assert_eq!(of("reflectance"), &SpectrumValue::Rgb([1.0, 0.0, 0.0], ColorSpace::Srgb).into());
}

#[test]
fn materials_may_precede_their_textures() {
    let d = world(
        "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\" \"texture alpha\" \"a\"
        Texture \"t\" \"spectrum\" \"constant\" Texture \"a\" \"float\" \"constant\"",
    );
    assert!(material(&d).node("reflectance").is_some());
    assert!(shape(&d).node("alpha").is_some());
}

#[test]
fn options_and_leftovers_of_older_versions() {
    let i = load("Option \"seed\" 7 Option \"render-coord-sys\" \"world\" Sampler \"sobol\" WorldBegin WorldEnd");
    assert!(!i.diagnostics.has_errors());
    assert_eq!(i.desc.node(i.desc.sampler.unwrap()).int("seed"), Some(7));
    let d = options("# nothing\nSampler \"sobol\" \"integer seed\" 3 # comment ] \" \nOption \"seed\" 7");
    assert_eq!(d.node(d.sampler.unwrap()).int("seed"), Some(3));
}

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = dir.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    dir
}

#[test]
fn include_continues_and_import_keeps_to_itself() {
    let dir = folder(&[
        ("options.pbrt", "Film \"rgb\" \"integer xresolution\" 10"),
        ("part.pbrt", "Translate 1 0 0\nShape \"sphere\""),
        ("sub/deep.pbrt", "Include \"beside.pbrt\""),
        ("sub/beside.pbrt", "MakeNamedMaterial \"m\" \"string type\" \"conductor\""),
    ]);
    let i = load_in(
        dir.path(),
        "Include \"options.pbrt\" WorldBegin Include \"part.pbrt\" Import \"part.pbrt\" Shape \"sphere\"
        Include \"sub/deep.pbrt\" NamedMaterial \"m\" Shape \"disk\"",
    );
    assert!(i.diagnostics.is_empty(), "{:?}", i.diagnostics);
    let x: Vec<f64> = i.desc.shapes.iter().map(|s| image_of(s.world_from_object, [0.0; 3])[0]).collect();
    assert_eq!(x, [1.0, 2.0, 1.0, 1.0]);
    assert_eq!(i.desc.node(i.desc.film.unwrap()).int("width"), Some(10));
    assert_eq!(i.desc.node(i.desc.shapes[3].material.unwrap()).kind, "conductor");
}

#[test]
fn faults_in_included_files_name_the_file() {
    let dir = folder(&[
        ("bad.pbrt", "\n\n  Shape \"spehre\""),
        ("open.pbrt", "AttributeBegin"),
        ("close.pbrt", "AttributeEnd"),
    ]);
    let i = load_in(dir.path(), "WorldBegin Include \"bad.pbrt\"");
    let location = errors(&i)[0].location.clone().unwrap();
    assert!(location.path.ends_with("bad.pbrt") && (location.line, location.column) == (3, 9), "{location:?}");
    // Blocks may span includes, but not imports.
    assert!(load_in(dir.path(), "WorldBegin Include \"open.pbrt\" Include \"close.pbrt\"").diagnostics.is_empty());
    let i = load_in(dir.path(), "WorldBegin Import \"open.pbrt\" Shape \"sphere\"");
    assert!(errors(&i)[0].message.contains("not closed in the imported file"));
    let i = load_in(dir.path(), "WorldBegin AttributeBegin Import \"close.pbrt\" AttributeEnd");
    assert_eq!(errors(&i).len(), 1);
}

#[test]
fn files_that_include_themselves_are_refused() {
    let dir = folder(&[("a.pbrt", "Include \"b.pbrt\""), ("b.pbrt", "WorldBegin Include \"a.pbrt\"")]);
    let i = import(&dir.path().join("a.pbrt"), &Options::default());
    assert_eq!(errors(&i).len(), 1);
    assert_eq!(errors(&i)[0].message, "'a.pbrt' includes itself");
    assert!(errors(&i)[0].location.as_ref().unwrap().path.ends_with("b.pbrt"));
}

#[test]
fn includes_are_bounded_in_depth_and_number() {
    let files: Vec<(String, String)> =
        (0..40).map(|i| (format!("{i}.pbrt"), format!("Include \"{}.pbrt\"", i + 1))).collect();
    let dir = folder(&files.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect::<Vec<_>>());
    let i = import(&dir.path().join("0.pbrt"), &Options::default());
    assert!(errors(&i)[0].message.contains("more than 15 deep"));
    let dir = folder(&[("e.pbrt", "")]);
    let limits = Limits { includes: 3, ..Limits::default() };
    let options = Options { limits, ..Options::default() };
    let i = import_text(
        "s",
        "WorldBegin Include \"e.pbrt\" ".to_string() + &"Include \"e.pbrt\"\n".repeat(5),
        dir.path(),
        &options,
    );
    assert_eq!(errors(&i).len(), 3);
}

#[test]
fn missing_files_are_reported_with_the_places_searched() {
    let dir = folder(&[("other/here.ply", "")]);
    let options = Options { search: vec![dir.path().join("other")], ..Options::default() };
    let i = import_text("s", "WorldBegin Shape \"plymesh\" \"string filename\" \"gone.ply\"", dir.path(), &options);
    let message = &errors(&i)[0].message;
    assert!(message.contains("cannot find 'gone.ply'") && message.contains("other"), "{message}");
    assert_eq!(errors(&i)[0].location.as_ref().unwrap().column, 46);
    assert_eq!(errors(&import(Path::new("/nonexistent/x.pbrt"), &options)).len(), 1);
}

#[test]
fn compressed_scenes_are_read() {
    use std::io::Write;
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("s.pbrt.gz");
    let mut gz = flate2::write::GzEncoder::new(std::fs::File::create(&path).unwrap(), flate2::Compression::fast());
    gz.write_all(b"WorldBegin\nShape \"spehre\"").unwrap();
    gz.finish().unwrap();
    let i = import(&path, &Options::default());
    assert_eq!(errors(&i)[0].location.as_ref().unwrap().line, 2);
    assert_eq!(errors(&i)[0].help.as_deref(), Some("did you mean 'sphere'?"));
}

#[test]
fn mesh_files_are_read_once() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    let dir = folder(&[("m.ply", ply), ("bad.ply", "ply\nformat ascii 1.0\nelement vertex 1\n")]);
    let use_it = "Shape \"plymesh\" \"string filename\" \"m.ply\"\n";
    let i = load_in(dir.path(), &format!("WorldBegin {use_it}{use_it}"));
    assert!(i.diagnostics.is_empty(), "{:?}", i.diagnostics);
    assert_eq!((i.desc.meshes.len(), i.desc.shapes.len()), (1, 2));
    assert_eq!(i.desc.shapes[0].mesh, i.desc.shapes[1].mesh);
    assert_eq!((i.desc.meshes[0].patches.len(), i.desc.meshes[0].triangles.len()), (1, 0), "quads are patches");
    let i = load_in(dir.path(), "WorldBegin\nShape \"plymesh\"\n \"string filename\" \"bad.ply\"");
    assert!(errors(&i)[0].message.contains("cannot read the mesh"), "{}", errors(&i)[0]);
    assert_eq!(errors(&i)[0].location.as_ref().unwrap().line, 3);
}

#[test]
fn spectrum_files_are_found_and_checked() {
    let dir = folder(&[("a.spd", "# measured\n400 1\n500 2.5\n"), ("bad.spd", "400 1\n300 2\n")]);
    let i = load_in(dir.path(), "WorldBegin LightSource \"point\" \"spectrum I\" \"a.spd\"");
    assert!(i.diagnostics.is_empty(), "{:?}", i.diagnostics);
    let sampled = SpectrumValue::Sampled { lambdas: vec![400.0, 500.0], values: vec![1.0, 2.5] };
    assert_eq!(light(&i.desc).get("intensity"), Some(&sampled.into()));
    let i = load_in(dir.path(), "WorldBegin LightSource \"point\" \"spectrum I\" \"bad.spd\"");
    assert!(errors(&i)[0].message.contains("line 2"), "{}", errors(&i)[0]);
}
