//! The file format itself: parameters, includes, references, transforms, versions.

use super::*;
use steradian_math::DVec3;

#[test]
fn defaults_are_overridden_and_substituted() {
    let text = r#"<scene version="3.0.0"><default name="spp" value="16"/><default name="kind" value="perspective"/>
        <sensor type="$kind"><sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor></scene>"#;
    let samples = |options: &Options| {
        let import = import_text(text, Path::new("a.xml"), options);
        assert_eq!(errors(&import), Vec::<String>::new());
        let warnings: Vec<String> = import.diagnostics.iter().map(|d| d.message.clone()).collect();
        (import.desc.node(import.desc.sampler.unwrap()).int("samples"), warnings)
    };
    assert_eq!(samples(&Options::default()), (Some(16), vec![]));
    let defines = [("spp".to_owned(), "99".to_owned()), ("sp".to_owned(), "1".to_owned())].into();
    let (count, warnings) = samples(&Options { defines, ..Options::default() });
    assert_eq!(count, Some(99));
    assert_eq!(warnings, ["the scene has no parameter 'sp'"]);
}

#[test]
fn transforms_compose_outwards() {
    let placed = |operations: &str| {
        let desc = good(&format!("<shape type=\"cube\"><transform name=\"to_world\">{operations}</transform></shape>"));
        desc.shapes[0].world_from_object
    };
    let t = placed("<scale value=\"2\"/><rotate z=\"1\" angle=\"90\"/><translate x=\"1\" y=\"2\" z=\"3\"/>");
    assert!((t.point(DVec3::X) - DVec3::new(1.0, 4.0, 3.0)).length() < 1e-12);
    let t = placed("<lookat origin=\"1, 2, 3\" target=\"1 2 0\" up=\"0 1 0\"/>");
    assert!((t.point(DVec3::Z) - DVec3::new(1.0, 2.0, 2.0)).length() < 1e-12);
    assert!((t.vector(DVec3::Y) - DVec3::Y).length() < 1e-12);
    let t = placed("<matrix value=\"1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\"/>");
    assert_eq!(t.point(DVec3::ZERO), DVec3::new(5.0, 6.0, 7.0));
    let t = placed("<translate value=\"1, 2, 3\"/><scale x=\"2\"/>");
    assert_eq!(t.point(DVec3::ZERO), DVec3::new(2.0, 2.0, 3.0));
}

/// Mitsuba 3 takes the axis as it stands: about (0, 0, 2) by θ the plane is turned and stretched by cosθ and 2 sinθ,
/// and z becomes cosθ + 4 (1 − cosθ). Version 0.6 brings it to unit length.
#[test]
fn rotations_about_axes_of_any_length() {
    let read = |version: &str, z: f64| {
        let text = format!(
            "<scene version=\"{version}\"><shape type=\"cube\"><transform name=\"{}\"><rotate z=\"{z}\" angle=\"60\"/></transform></shape></scene>",
            if version == "0.6.0" { "toWorld" } else { "to_world" }
        );
        let import = import_text(&text, Path::new("a.xml"), &Options::default());
        assert_eq!(errors(&import), Vec::<String>::new());
        let said = import.diagnostics.iter().any(|d| d.message.contains("unit length"));
        (import.desc.shapes[0].world_from_object, said)
    };
    let (sin, cos) = (0.75f64.sqrt(), 0.5);
    for (version, z, x_to, z_to, warned) in [
        ("3.0.0", 2.0, DVec3::new(cos, 2.0 * sin, 0.0), cos + 4.0 * (1.0 - cos), true),
        ("3.0.0", 1.0, DVec3::new(cos, sin, 0.0), 1.0, false),
        ("0.6.0", 2.0, DVec3::new(cos, sin, 0.0), 1.0, false),
    ] {
        let (t, said) = read(version, z);
        assert!((t.point(DVec3::X) - x_to).length() < 1e-12, "{version} {z}: {}", t.point(DVec3::X));
        assert!((t.point(DVec3::Z) - DVec3::new(0.0, 0.0, z_to)).length() < 1e-12, "{version} {z}");
        assert_eq!(said, warned);
    }
}

#[test]
fn includes_paths_and_references() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    };
    write(
        "parts/look.xml",
        r#"<scene version="3.0.0"><bsdf type="dielectric" id="glass"/><include filename="deeper.xml"/></scene>"#,
    );
    write("parts/deeper.xml", r#"<bsdf version="3.0.0" type="conductor" id="mirror"/>"#);
    write("parts/textures/t.png", "");
    write(
        "old.xml",
        r#"<scene version="0.6.0"><bsdf type="dielectric" id="old"><float name="intIOR" value="3"/><float name="extIOR" value="2"/></bsdf></scene>"#,
    );
    let main = write(
        "main.xml",
        r#"<scene version="3.0.0"><path value="parts"/><include filename="parts/look.xml"/><include filename="old.xml"/>
        <alias id="glass" as="glas"/>
        <shape type="sphere"><ref id="glas"/></shape><shape type="sphere"><ref name="bsdf" id="mirror"/></shape>
        <shape type="sphere"><ref id="old"/></shape>
        <shape type="cube"><bsdf type="diffuse"><texture name="reflectance" type="bitmap">
            <string name="filename" value="textures\t.png"/></texture></bsdf></shape></scene>"#,
    );
    let import = crate::mitsuba::import(&main, &Options::default());
    assert_eq!(errors(&import), Vec::<String>::new());
    let desc = &import.desc;
    let materials: Vec<&Node> = desc.shapes.iter().map(|s| desc.node(s.material.unwrap())).collect();
    assert_eq!(
        materials.iter().map(|m| m.kind.as_str()).collect::<Vec<_>>(),
        ["dielectric", "conductor", "dielectric", "diffuse"]
    );
    assert_eq!(materials[2].float("eta"), Some(1.5));
    let image = child(desc, materials[3], "reflectance");
    assert_eq!(image.path("file"), Some(folder.path().join("parts/textures/t.png").as_path()));
    assert_eq!(import.desc.sources.iter().count(), 4);
}

#[test]
fn an_include_that_includes_itself_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("loop.xml");
    std::fs::write(&path, r#"<scene version="3.0.0"><include filename="loop.xml"/></scene>"#).unwrap();
    let import = crate::mitsuba::import(&path, &Options::default());
    assert_eq!(import.diagnostics.error_count(), 1);
    assert!(errors(&import)[0].contains("more than 15 deep"), "{:?}", errors(&import));
}

#[test]
fn version_0_6_is_upgraded() {
    let text = r##"<scene version="0.5.0">
        <integrator type="path"><integer name="maxDepth" value="8"/></integrator>
        <sensor type="perspective"><float name="fov" value="40"/><string name="fovAxis" value="smaller"/>
            <transform name="toWorld"><lookAt origin="0,0,0" target="0,0,1" up="0,1,0"/></transform>
            <sampler type="ldsampler"><integer name="sampleCount" value="32"/></sampler>
            <film type="ldrfilm"><integer name="width" value="100"/><boolean name="banner" value="false"/></film></sensor>
        <shape type="rectangle"><transform name="toWorld"><translate x="1"/></transform>
            <bsdf type="diffuse"><texture name="diffuseReflectance" type="checkerboard">
                <float name="uscale" value="3"/><float name="uoffset" value="0.5"/><srgb name="color0" value="#808080"/></texture></bsdf>
            <emitter type="area"><spectrum name="radiance" value="1, 2, 3"/></emitter></shape></scene>"##;
    let import = import_text(text, Path::new("old.xml"), &Options::default());
    assert_eq!(errors(&import), Vec::<String>::new());
    let desc = &import.desc;
    assert_eq!(desc.node(desc.integrator.unwrap()).int("max_depth"), Some(7));
    let camera = only(desc, &desc.cameras);
    assert_eq!((camera.float("fov"), camera.string("fov_axis")), (Some(40.0), Some("smaller")));
    let shape = &desc.shapes[0];
    assert_eq!(shape.world_from_object.point(DVec3::ZERO), DVec3::X);
    let board = child(desc, desc.node(shape.material.unwrap()), "reflectance");
    let uv = board.transform("to_uv").unwrap().point(DVec3::new(0.25, 0.25, 0.0));
    assert!((uv - DVec3::new(2.0 * 3.0 * 0.75, 0.5, 0.0)).length() < 1e-12);
    let Some(Value::Spectrum(steradian_scene::SpectrumValue::Rgb(c, _))) = board.get("a") else { panic!("{board:?}") };
    assert!((c[0] - 0.215861).abs() < 1e-5);
    assert_eq!(desc.node(shape.emission.unwrap()).get("radiance"), Some(&rgb([1.0, 2.0, 3.0])));
}
