//! Translation of the objects of each family.

use super::*;
use steradian_math::DVec3;
use steradian_scene::SpectrumValue;

#[test]
fn bsdfs_have_mitsubas_defaults() {
    let (_, m) = material("<bsdf type=\"diffuse\"/>");
    assert_eq!((m.kind.as_str(), m.float("reflectance")), ("diffuse", Some(0.5)));
    let (_, m) = material("<bsdf type=\"dielectric\"/>");
    assert!((m.float("eta").unwrap() - 1.5046 / 1.000277).abs() < 1e-12 && m.get("alpha_u").is_none());
    let (_, m) = material(
        "<bsdf type=\"roughdielectric\"><string name=\"int_ior\" value=\"Water\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>",
    );
    assert_eq!(
        (m.float("eta"), m.float("alpha_u"), m.string("distribution")),
        (Some(1.333), Some(0.1), Some("beckmann"))
    );
    assert_eq!(m.bool("remap_roughness"), Some(false));
    let (_, m) = material(
        "<bsdf type=\"roughplastic\"><string name=\"distribution\" value=\"GGX\"/><float name=\"alpha\" value=\"0.3\"/></bsdf>",
    );
    assert_eq!((m.kind.as_str(), m.float("alpha_v"), m.string("distribution")), ("plastic", Some(0.3), Some("ggx")));
    assert_eq!((m.bool("nonlinear"), m.float("diffuse_reflectance")), (Some(false), Some(0.5)));
    assert!((m.float("eta").unwrap() - 1.49 / 1.000277).abs() < 1e-12);
    let (_, m) = material("<bsdf type=\"null\"/>");
    assert_eq!(m.kind, "interface");
}

#[test]
fn conductors() {
    let (_, mirror) = material("<bsdf type=\"conductor\"/>");
    assert!(mirror.get("eta").is_none() && mirror.get("k").is_none() && mirror.get("alpha_u").is_none());
    let (_, gold) = material("<bsdf type=\"roughconductor\"><string name=\"material\" value=\"Au\"/></bsdf>");
    assert_eq!(gold.get("k"), Some(&Value::Spectrum(SpectrumValue::Named("metal-Au-k".into()))));
    let (_, given) = material("<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"0.2 1.5 3\"/></bsdf>");
    assert_eq!((given.get("eta"), given.float("k")), (Some(&rgb([0.2, 1.5, 3.0])), Some(1.0)));
    let import =
        read("<shape type=\"sphere\"><bsdf type=\"conductor\"><string name=\"material\" value=\"Cr\"/></bsdf></shape>");
    assert!(!import.diagnostics.is_lossy() && !import.diagnostics.has_errors());
    let (_, tungsten) = material("<bsdf type=\"conductor\"><string name=\"material\" value=\"W_palik\"/></bsdf>");
    assert_eq!(tungsten.get("eta"), Some(&Value::Spectrum(SpectrumValue::Named("metal-W_palik-eta".into()))));
}

#[test]
fn models_of_mitsuba_0_6() {
    let (_, m) = material("<bsdf type=\"roughdiffuse\"><float name=\"alpha\" value=\"0.3\"/></bsdf>");
    assert_eq!((m.kind.as_str(), m.string("form"), m.float("reflectance")), ("oren_nayar", Some("full"), Some(0.5)));
    assert!((m.float("sigma").unwrap() - 0.3 / 2f64.sqrt()).abs() < 1e-12);
    let (desc, m) = material(
        "<bsdf type=\"roughdiffuse\"><boolean name=\"use_fast_approx\" value=\"true\"/>
         <texture name=\"alpha\" type=\"checkerboard\"/></bsdf>",
    );
    assert_eq!((m.string("form"), child(&desc, &m, "sigma").kind.as_str()), (Some("qualitative"), "scale"));
    let (_, m) = material("<bsdf type=\"phong\"/>");
    assert_eq!((m.kind.as_str(), m.float("exponent"), m.string("form")), ("phong", Some(30.0), Some("modified")));
    assert_eq!((m.float("diffuse_reflectance"), m.float("specular_reflectance")), (Some(0.5), Some(0.2)));
    let (_, m) = material(
        "<bsdf type=\"ward\"><string name=\"variant\" value=\"ward-duer\"/><float name=\"alpha_u\" value=\"0.4\"/></bsdf>",
    );
    assert_eq!((m.kind.as_str(), m.string("form")), ("ward", Some("duer")));
    assert_eq!((m.float("alpha_u"), m.float("alpha_v")), (Some(0.4), Some(0.1)));
    let (_, m) = material("<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"as\"/></bsdf>");
    assert_eq!(m.string("distribution"), Some("blinn"));
}

#[test]
fn nested_bsdfs() {
    let (desc, m) = material("<bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf>");
    assert_eq!((m.node("front"), m.kind.as_str()), (m.node("back"), "two_sided"));
    assert_eq!(child(&desc, &m, "front").kind, "diffuse");
    let (desc, m) = material(
        "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.25\"/><bsdf type=\"diffuse\"/><bsdf type=\"plastic\"/></bsdf>",
    );
    let Some(Value::Nodes(both)) = m.get("materials") else { panic!() };
    assert_eq!((desc.node(both[0]).kind.as_str(), desc.node(both[1]).kind.as_str()), ("diffuse", "plastic"));
    assert_eq!(m.float("amount"), Some(0.25));
    let (desc, m) = material(
        "<bsdf type=\"mask\"><texture type=\"checkerboard\" name=\"opacity\"/><bsdf type=\"diffuse\"/></bsdf>",
    );
    // Read as single numbers, Mitsuba's checkerboard is the other way round.
    assert_eq!(
        (child(&desc, &m, "opacity").float("a"), child(&desc, &m, "material").kind.as_str()),
        (Some(0.2), "diffuse")
    );
    let (desc, m) = material(
        "<bsdf type=\"bumpmap\"><texture type=\"checkerboard\"/><float name=\"scale\" value=\"3\"/><bsdf type=\"plastic\"/></bsdf>",
    );
    assert_eq!((m.kind.as_str(), child(&desc, &m, "bump").float("scale")), ("plastic", Some(3.0)));
    assert_eq!((m.string("detail_facing"), m.bool("detail_shadowing")), (Some("turned"), Some(true)));
    let (_, m) = material(
        "<bsdf type=\"normalmap\"><texture type=\"checkerboard\" name=\"normalmap\"/><bsdf type=\"diffuse\"/>
         <boolean name=\"flip_invalid_normals\" value=\"false\"/><boolean name=\"use_shadowing_function\" value=\"false\"/></bsdf>",
    );
    assert_eq!((m.string("detail_facing"), m.bool("detail_shadowing")), (Some("as_it_is"), Some(false)));
}

#[test]
fn hair_takes_the_names_of_its_paper() {
    let (_, m) = material("<bsdf type=\"hair\"><float name=\"azimuthal_roughness\" value=\".4\"/></bsdf>");
    let of = |name: &str| m.float(name);
    assert_eq!(
        (m.kind.as_str(), of("eumelanin"), of("pheomelanin"), of("beta_n")),
        ("hair", Some(1.3), Some(0.2), Some(0.4))
    );
    assert_eq!((of("beta_m"), of("alpha"), m.bool("round")), (Some(0.3), Some(2.0), Some(true)));
    let (desc, m) = material(
        "<bsdf type=\"hair\"><rgb name=\"sigma_a\" value=\".2 .3 .7\"/><float name=\"scale\" value=\"20\"/></bsdf>",
    );
    assert_eq!((child(&desc, &m, "sigma_a").float("scale"), m.get("eumelanin")), (Some(20.0), None));
}

#[test]
fn polarizing_filters() {
    let (_, m) = material("<bsdf type=\"polarizer\"><float name=\"theta\" value=\"30\"/></bsdf>");
    assert_eq!((m.kind.as_str(), m.float("theta"), m.string("form")), ("polarizer", Some(30.0), None));
    let (_, m) = material("<bsdf type=\"circular\"><boolean name=\"left_handed\" value=\"true\"/></bsdf>");
    assert_eq!((m.kind.as_str(), m.string("form")), ("polarizer", Some("left_circular")));
    let (_, m) = material("<bsdf type=\"circular\"/>");
    assert_eq!(m.string("form"), Some("right_circular"));
    let (_, m) = material("<bsdf type=\"retarder\"><float name=\"theta\" value=\"-45\"/></bsdf>");
    assert_eq!((m.kind.as_str(), m.float("theta"), m.float("delta")), ("retarder", Some(-45.0), Some(90.0)));
    let (_, m) = material("<bsdf type=\"polarizer\"><boolean name=\"polarizing\" value=\"false\"/></bsdf>");
    assert_eq!(
        (m.kind.as_str(), m.float("eta"), m.float("specular_transmittance")),
        ("thin_dielectric", Some(1.0), Some(0.5))
    );
    let (_, m) = material("<bsdf type=\"pplastic\"><float name=\"alpha\" value=\".2\"/></bsdf>");
    assert_eq!((m.kind.as_str(), m.float("alpha_u")), ("plastic", Some(0.2)));
}

#[test]
fn volumes_texture_surfaces() {
    let folder = std::env::temp_dir();
    let file = folder.join(format!("steradian-{}.vol", std::process::id()));
    std::fs::write(&file, b"VOL").unwrap();
    let (desc, m) = material(&format!(
        "<bsdf type=\"diffuse\"><texture type=\"volume\" name=\"reflectance\"><volume type=\"gridvolume\" name=\"volume\">
         <string name=\"filename\" value=\"{}\"/><string name=\"filter_type\" value=\"nearest\"/>
         <transform name=\"to_world\"><translate x=\"2\"/></transform></volume></texture></bsdf>",
        file.display()
    ));
    std::fs::remove_file(&file).unwrap();
    let grid = child(&desc, child(&desc, &m, "reflectance"), "value");
    assert_eq!(
        (grid.kind.as_str(), grid.string("filter"), grid.string("wrap")),
        ("grid", Some("nearest"), Some("clamp"))
    );
    assert_eq!(grid.transform("texture_from_world").unwrap().point(DVec3::new(2.0, 0.0, 0.0)), DVec3::ZERO);
    let (desc, m) = material(
        "<bsdf type=\"diffuse\"><texture type=\"volume\" name=\"reflectance\"><float name=\"volume\" value=\".3\"/></texture></bsdf>",
    );
    assert_eq!(child(&desc, &m, "reflectance").float("value"), Some(0.3));
}

#[test]
fn bsdfs_that_steradian_lacks_keep_their_parameters() {
    let (desc, m) = material(
        "<bsdf type=\"principled\"><rgb name=\"base_color\" value=\"1 .5 0\"/><float name=\"metallic\" value=\".7\"/>
         <texture name=\"roughness\" type=\"checkerboard\"/></bsdf>",
    );
    assert_eq!(
        (m.kind.as_str(), m.float("metallic"), m.get("base_color")),
        ("principled", Some(0.7), Some(&rgb([1.0, 0.5, 0.0])))
    );
    assert_eq!(child(&desc, &m, "roughness").kind, "checkerboard");
    let (desc, m) =
        material("<bsdf type=\"coating\"><string name=\"int_ior\" value=\"water\"/><bsdf type=\"diffuse\"/></bsdf>");
    assert_eq!((child(&desc, &m, "material").kind.as_str(), m.float("int_ior")), ("diffuse", Some(1.333)));
    let desc = good(
        "<shape type=\"cube\"><medium name=\"interior\" type=\"heterogeneous\"><phase type=\"rayleigh\"/>
         <volume name=\"albedo\" type=\"constvolume\"><rgb name=\"value\" value=\".5\"/></volume></medium></shape>",
    );
    let cloud = desc.node(desc.shapes[0].interior.unwrap());
    // Its extinction is one in the unit cube.
    assert_eq!((cloud.kind.as_str(), child(&desc, cloud, "phase").kind.as_str()), ("heterogeneous", "rayleigh"));
    assert_eq!(cloud.float("sigma_t"), Some(1.0));
    assert_eq!(cloud.get("albedo"), Some(&rgb([0.5; 3])));
}

/// Phase functions and their blends, nested ones too; the order is that of the file.
#[test]
fn phase_functions_are_read() {
    let desc = good(
        "<shape type=\"cube\"><medium name=\"interior\" type=\"homogeneous\"><phase type=\"blendphase\">
         <float name=\"weight\" value=\".3\"/>
         <phase name=\"b\" type=\"blendphase\"><phase type=\"rayleigh\"/><phase type=\"hg\"/></phase>
         <phase name=\"a\" type=\"tabphase\"><string name=\"values\" value=\"0.5, 1, 4\"/></phase>
         </phase></medium></shape>",
    );
    let medium = desc.node(desc.shapes[0].interior.unwrap());
    let blend = child(&desc, medium, "phase");
    assert_eq!((blend.kind.as_str(), blend.float("weight")), ("blend", Some(0.3)));
    let (first, second) = (child(&desc, blend, "first"), child(&desc, blend, "second"));
    assert_eq!((first.kind.as_str(), second.kind.as_str()), ("blend", "tabulated"));
    assert_eq!(second.get("values"), Some(&Value::Floats(vec![0.5, 1.0, 4.0])));
    assert_eq!(child(&desc, first, "first").kind, "rayleigh");
}

#[test]
fn emission_means_multiples_of_d65() {
    let radiance = |value: &str| {
        let desc = good(&format!("<shape type=\"sphere\"><emitter type=\"area\">{value}</emitter></shape>"));
        // Without a BSDF, a shape that emits is black.
        let black = desc.node(desc.shapes[0].material.unwrap()).get("reflectance").cloned();
        assert_eq!(black, Some(rgb([0.0; 3])));
        let light = desc.node(desc.shapes[0].emission.unwrap());
        assert_eq!((light.bool("normalize"), light.bool("two_sided")), (Some(false), Some(false)));
        light.get("radiance").unwrap().clone()
    };
    assert_eq!(radiance(""), rgb([1.0; 3]));
    assert_eq!(radiance("<rgb name=\"radiance\" value=\"1 2 3\"/>"), rgb([1.0, 2.0, 3.0]));
    assert_eq!(radiance("<float name=\"radiance\" value=\"4\"/>"), rgb([4.0; 3]));
    assert_eq!(
        radiance("<spectrum type=\"d65\" name=\"radiance\"><float name=\"scale\" value=\"5\"/></spectrum>"),
        rgb([5.0; 3])
    );
    // A constant spectrum is not D65, and not neutral in RGB.
    let flat = SpectrumValue::Sampled { lambdas: vec![360.0, 830.0], values: vec![2.0, 2.0] };
    assert_eq!(radiance("<spectrum name=\"radiance\" value=\"2\"/>"), Value::Spectrum(flat));
    let listed = SpectrumValue::Sampled { lambdas: vec![400.0, 500.0, 700.0], values: vec![0.0, 8.0, 15.6] };
    assert_eq!(radiance("<spectrum name=\"radiance\" value=\"400:0, 500:8, 700:15.6\"/>"), Value::Spectrum(listed));
    let hot = radiance(
        "<spectrum type=\"blackbody\" name=\"radiance\"><float name=\"temperature\" value=\"5000\"/></spectrum>",
    );
    assert!(matches!(hot, Value::Spectrum(SpectrumValue::Sampled { lambdas, .. }) if lambdas[0] == 360.0));
}

#[test]
fn emitters_of_their_own() {
    let light = |text: &str| {
        let desc = good(text);
        let node = only(&desc, &desc.lights).clone();
        (desc, node)
    };
    let (_, l) = light(
        "<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/><rgb name=\"intensity\" value=\"2\"/></emitter>",
    );
    assert_eq!(l.transform("to_world").unwrap().point(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
    let (_, l) = light("<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"40\"/></emitter>");
    assert_eq!(
        (l.float("cone_angle"), l.float("falloff_start"), l.string("falloff")),
        (Some(40.0), Some(30.0), Some("linear"))
    );
    let (_, l) = light("<emitter type=\"directional\"><vector name=\"direction\" value=\"0, -2, 0\"/></emitter>");
    assert_eq!((l.kind.as_str(), l.vec3("direction")), ("distant", Some([0.0, -1.0, 0.0])));
    let (_, l) = light(
        "<emitter type=\"directional\"><transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/></transform></emitter>",
    );
    assert!((DVec3::from(l.vec3("direction").unwrap()) - DVec3::X).length() < 1e-12);
    let (_, l) = light("<emitter type=\"constant\"/>");
    assert_eq!((l.kind.as_str(), l.get("radiance")), ("environment", Some(&rgb([1.0; 3]))));
    let (_, l) = light(
        "<emitter type=\"projector\"><rgb name=\"irradiance\" value=\"1\"/><float name=\"fov\" value=\"45\"/></emitter>",
    );
    assert_eq!(
        (l.float("fov"), l.string("fov_axis"), l.get("radiance")),
        (Some(45.0), Some("x"), Some(&rgb([1.0; 3])))
    );
    // Local +x is on the left of the slide.
    assert_eq!(l.transform("to_world").unwrap().vector(DVec3::X), -DVec3::X);
}

/// Skies keep their numbers; version 3 has +x south and the even sun as its default, 0.6 has +y up and −z north.
#[test]
fn skies() {
    let light = |version: &str, text: &str| {
        let text = format!("<scene version=\"{version}\">{text}</scene>");
        let import = import_text(&text, Path::new("test.xml"), &Options::default());
        assert_eq!(errors(&import), Vec::<String>::new());
        (only(&import.desc, &import.desc.lights).clone(), import.diagnostics.is_lossy())
    };
    let given = "<float name=\"turbidity\" value=\"4\"/><rgb name=\"albedo\" value=\"0.1, 0.2, 0.3\"/>\
                 <integer name=\"month\" value=\"3\"/><float name=\"hour\" value=\"9.5\"/>\
                 <boolean name=\"complex_sun\" value=\"true\"/>";
    let (l, lossy) = light("3.0.0", &format!("<emitter type=\"sunsky\">{given}</emitter>"));
    assert_eq!((l.kind.as_str(), lossy), ("sky", false));
    assert_eq!((l.float("turbidity"), l.int("month"), l.float("hour")), (Some(4.0), Some(3), Some(9.5)));
    assert_eq!((l.bool("limb_darkening"), l.get("albedo")), (Some(true), Some(&rgb([0.1, 0.2, 0.3]))));
    let north = |l: &Node| l.transform("to_world").unwrap().vector(DVec3::X);
    let up = |l: &Node| l.transform("to_world").unwrap().vector(DVec3::Z);
    assert_eq!((north(&l), up(&l)), (-DVec3::X, DVec3::Z));
    let direction = "<vector name=\"sun_direction\" value=\"0, 1, 2\"/><float name=\"sky_scale\" value=\"0.5\"/>";
    let (l, _) = light("3.0.0", &format!("<emitter type=\"sunsky\">{direction}</emitter>"));
    assert_eq!((l.vec3("sun_direction"), l.float("sky_scale")), (Some([0.0, 1.0, 2.0]), Some(0.5)));
    assert_eq!(l.bool("limb_darkening"), Some(false));
    let (l, lossy) = light("0.6.0", "<emitter type=\"sky\"><float name=\"scale\" value=\"2\"/></emitter>");
    assert_eq!(
        (l.float("sun_scale"), l.float("sky_scale"), l.float("scale"), lossy),
        (Some(0.0), None, Some(2.0), false)
    );
    assert_eq!((north(&l), up(&l), l.float("albedo")), (-DVec3::Z, DVec3::Y, Some(0.15)));
    let (l, lossy) = light("0.6.0", "<emitter type=\"sun\"><float name=\"sunRadiusScale\" value=\"2\"/></emitter>");
    assert_eq!((l.float("sky_scale"), l.float("sun_aperture"), lossy), (Some(0.0), Some(1.0716), true));
    assert!(read("<emitter type=\"timed_sunsky\"/>").diagnostics.is_lossy());
}

/// Notes on behaviour of Mitsuba's own estimators that Steradian does not reproduce.
#[test]
fn differences_of_estimators_are_noted() {
    let said = |text: &str, part: &str| read(text).diagnostics.iter().filter(|d| d.message.contains(part)).count();
    for bsdf in ["<bsdf type=\"null\"/>", "<bsdf type=\"mask\"><bsdf type=\"diffuse\"/></bsdf>"] {
        let shape = format!("<shape type=\"sphere\">{bsdf}</shape>");
        for (integrator, count) in [("path", 1), ("direct", 1), ("volpath", 0)] {
            let text = format!("<integrator type=\"{integrator}\"/>{shape}");
            assert_eq!(said(&text, "towards 'max_depth'"), count, "{text}");
        }
        assert_eq!(said(&shape, "towards 'max_depth'"), 1);
    }
    assert_eq!(said("<shape type=\"sphere\"/><bsdf type=\"null\" id=\"unused\"/>", "towards 'max_depth'"), 0);
    let lamp = |kind: &str| format!("<shape type=\"disk\"><emitter type=\"{kind}\"/></shape>");
    assert_eq!(said(&lamp("directionalarea"), "finds no light"), 1);
    assert_eq!(said(&lamp("area"), "finds no light"), 0);
    for shape in ["sphere", "cylinder"] {
        for (scale, count) in [("value=\"2\"", 0), ("x=\"-1\"", 0), ("x=\"2\"", 1)] {
            let text = format!(
                "<shape type=\"{shape}\"><transform name=\"to_world\"><scale {scale}/><rotate x=\"0.6\" y=\"0.8\" angle=\"30\"/></transform></shape>"
            );
            assert_eq!(said(&text, "evenly"), count, "{text}");
        }
    }
    assert_eq!(light_rows("3.0.0"), "poles");
    assert_eq!(light_rows("0.6.0"), "centers");
}

/// Row placement of an environment map in a version.
fn light_rows(version: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sky.pfm"), b"PF\n1 1\n-1.0\n\0\0\x80?\0\0\x80?\0\0\x80?").unwrap();
    let text = format!(
        "<scene version=\"{version}\"><emitter type=\"envmap\"><string name=\"filename\" value=\"sky.pfm\"/></emitter></scene>"
    );
    let import = import_text(&text, &folder.path().join("a.xml"), &Options::default());
    only(&import.desc, &import.desc.lights).string("rows").unwrap_or_default().to_owned()
}

#[test]
fn sensors() {
    let camera = |inside: &str| {
        let desc = good(&format!("<sensor type=\"perspective\">{inside}</sensor>"));
        let node = only(&desc, &desc.cameras).clone();
        (desc, node)
    };
    let (desc, c) = camera("");
    let diagonal = 2.0 * (36f64.hypot(24.0) / 100.0).atan().to_degrees();
    assert_eq!((c.float("fov"), c.string("fov_axis")), (Some(diagonal), Some("diagonal")));
    assert_eq!((c.float("near"), c.float("far")), (Some(0.01), Some(1e4)));
    let film = desc.node(desc.film.unwrap());
    assert_eq!((film.int("width"), film.int("height")), (Some(768), Some(576)));
    let filter = desc.node(desc.filter.unwrap());
    assert_eq!(
        (filter.kind.as_str(), filter.float("sigma"), filter.float("radius_x")),
        ("gaussian", Some(0.5), Some(2.0))
    );
    assert_eq!(desc.node(desc.sampler.unwrap()).int("samples"), Some(4));
    let (_, c) = camera("<string name=\"focal_length\" value=\"35mm\"/>");
    assert!(c.float("fov").unwrap() > diagonal);
    let (_, c) = camera(
        "<float name=\"fov\" value=\"30\"/><transform name=\"to_world\"><lookat origin=\"0 0 5\" target=\"0 0 0\" up=\"0 1 0\"/></transform>",
    );
    let t = c.transform("to_world").unwrap();
    // Looking along -z with y up, +x is on the right.
    assert!((t.vector(DVec3::X) - DVec3::X).length() < 1e-12 && (t.vector(DVec3::Z) + DVec3::Z).length() < 1e-12);
    let desc = good(
        "<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"0.1\"/><float name=\"focus_distance\" value=\"4\"/>
         <float name=\"fov\" value=\"45\"/><film type=\"hdrfilm\"><integer name=\"width\" value=\"64\"/><integer name=\"height\" value=\"32\"/>
         <integer name=\"crop_offset_x\" value=\"8\"/><integer name=\"crop_width\" value=\"16\"/><rfilter type=\"lanczos\"/></film></sensor>",
    );
    let c = only(&desc, &desc.cameras);
    assert_eq!((c.float("lens_radius"), c.float("focal_distance")), (Some(0.1), Some(4.0)));
    assert_eq!(desc.node(desc.film.unwrap()).get("crop"), Some(&Value::Ints(vec![8, 24, 0, 32])));
    let filter = desc.node(desc.filter.unwrap());
    assert_eq!(
        (filter.kind.as_str(), filter.float("tau"), filter.float("radius_y")),
        ("lanczos", Some(3.0), Some(3.0))
    );
    let (_, c) = camera("<float name=\"principal_point_offset_x\" value=\"0.25\"/>");
    assert_eq!((c.float("principal_x"), c.float("principal_y")), (Some(-0.25), None));
    let desc = good("<sensor type=\"orthographic\"/>");
    assert_eq!(only(&desc, &desc.cameras).floats("screen_window"), Some(&[-1.0, 1.0, -0.75, 0.75][..]));
}

#[test]
fn meters_are_sensors() {
    let desc = good(
        "<sensor type=\"radiancemeter\"><point name=\"origin\" x=\"1\" y=\"2\" z=\"3\"/>
         <vector name=\"direction\" x=\"0\" y=\"-2\" z=\"0\"/></sensor>",
    );
    let meter = only(&desc, &desc.cameras);
    let place = meter.transform("to_world").unwrap();
    assert_eq!(meter.kind, "radiance_meter");
    assert!((place.point(DVec3::ZERO) - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
    assert!((place.vector(DVec3::Z) + DVec3::Y).length() < 1e-12);
    let desc = good(
        "<shape type=\"sphere\"><float name=\"radius\" value=\"2\"/><boolean name=\"flip_normals\" value=\"true\"/>
         <sensor type=\"irradiancemeter\"/></shape>",
    );
    let meter = only(&desc, &desc.cameras);
    assert_eq!((meter.kind.as_str(), meter.string("surface")), ("irradiance_meter", Some("sphere")));
    assert_eq!(meter.transform("to_world").unwrap().vector(DVec3::X), DVec3::new(2.0, 0.0, 0.0));
}

#[test]
fn integrators() {
    let integrator = |text: &str| {
        let desc = good(text);
        desc.node(desc.integrator.unwrap()).clone()
    };
    let i = integrator(
        "<integrator type=\"path\"><integer name=\"max_depth\" value=\"6\"/><boolean name=\"hide_emitters\" value=\"true\"/></integrator>",
    );
    assert_eq!((i.int("max_depth"), i.int("rr_depth"), i.bool("hide_emitters")), (Some(5), Some(5), Some(true)));
    assert_eq!(integrator("<integrator type=\"volpathmis\"/>").int("max_depth"), Some(-1));
    assert_eq!(integrator("<integrator type=\"ptracer\"/>").kind, "path");
    let i = integrator(
        "<integrator type=\"sppm\"><integer name=\"photon_count\" value=\"900\"/><float name=\"initial_radius\" value=\"0.5\"/></integrator>",
    );
    assert_eq!((i.kind.as_str(), i.int("photons"), i.float("radius")), ("sppm", Some(900), Some(0.5)));
    let i = integrator(
        "<integrator type=\"irrcache\"><integer name=\"resolution\" value=\"10\"/><float name=\"quality\" value=\"2\"/>\
         <integrator type=\"path\"><integer name=\"max_depth\" value=\"6\"/></integrator></integrator>",
    );
    assert_eq!((i.kind.as_str(), i.int("rays"), i.int("max_depth")), ("irradiance-cache", Some(200), Some(5)));
    assert_eq!((i.float("error"), i.float("min_spacing"), i.float("max_spacing")), (Some(0.1), Some(0.75), Some(5.0)));
    assert_eq!(integrator("<integrator type=\"ptracer\"/><medium type=\"homogeneous\" id=\"m\"/>").kind, "volpath");
    assert_eq!(integrator("<integrator type=\"aov\"><string name=\"aovs\" value=\"d:depth\"/><integrator type=\"direct\"/></integrator>").kind, "direct");
}

/// Each of Mitsuba's integrators becomes what computes its picture, to the depth that is its default.
#[test]
fn integrators_compute_the_picture_of_theirs() {
    for (plugin, kind, max_depth) in [
        ("path", "path", Some(-1)),
        ("prb", "path", Some(5)),
        ("prb_basic", "path", Some(5)),
        ("prb_projective", "path", Some(5)),
        ("prb_reparam", "path", Some(5)),
        ("prbvolpath", "volpath", Some(-1)),
        ("volpath", "volpath", Some(-1)),
        ("volpathmis", "volpath", Some(-1)),
        ("ptracer", "path", Some(-1)),
        ("direct", "direct", None),
        ("direct_projective", "direct", None),
        ("direct_reparam", "direct", None),
        ("emission_reparam", "path", Some(0)),
        ("depth", "path", Some(-1)),
    ] {
        let import = read(&format!("<integrator type=\"{plugin}\"/>"));
        assert_eq!(errors(&import), Vec::<String>::new(), "{plugin}");
        let node = import.desc.node(import.desc.integrator.unwrap());
        assert_eq!((node.kind.as_str(), node.int("max_depth")), (kind, max_depth), "{plugin}");
        assert_eq!(import.diagnostics.is_lossy(), plugin == "depth", "{plugin}");
    }
    let deep = good("<integrator type=\"prb\"><integer name=\"max_depth\" value=\"-1\"/></integrator>");
    assert_eq!(deep.node(deep.integrator.unwrap()).int("max_depth"), Some(-1));
    for plugin in ["aov", "moment", "stokes"] {
        let desc =
            good(&format!("<integrator type=\"{plugin}\"><integrator type=\"direct_projective\"/></integrator>"));
        assert_eq!(desc.node(desc.integrator.unwrap()).kind, "direct", "{plugin}");
    }
}

/// Bands of a film by their names, and distances beyond which nothing is seen.
#[test]
fn bands_and_far_planes() {
    let sensor = |inside: &str| read(&format!("<sensor type=\"perspective\">{inside}</sensor>"));
    let said = |import: &Import| import.diagnostics.iter().map(|d| format!("{d}\n")).collect::<String>();
    let bands = sensor(
        "<film type=\"specfilm\"><spectrum name=\"visible\" value=\"500:1, 600:1\"/><spectrum name=\"near\" \
          type=\"regular\">
         <float name=\"wavelength_min\" value=\"600\"/><float name=\"wavelength_max\" value=\"700\"/><string \
           name=\"values\" value=\"1, 1\"/></spectrum><rfilter type=\"box\"/></film>",
    );
    assert!(!bands.diagnostics.is_lossy() && !bands.diagnostics.has_errors(), "{}", said(&bands));
    let film = bands.desc.node(bands.desc.film.unwrap());
    let Some(Value::Nodes(nodes)) = film.get("bands") else { panic!("{film:?}") };
    let names: Vec<_> = nodes.iter().map(|id| bands.desc.node(*id).name.clone().unwrap()).collect();
    assert_eq!((film.kind.as_str(), names), ("spectral", vec!["near".into(), "visible".into()]));
    assert!(said(&sensor("<film type=\"specfilm\"/>")).contains("a spectrum for each of its bands"));
    let far = sensor("<float name=\"far_clip\" value=\"7\"/>");
    assert!(!said(&far).contains("far_clip"), "{}", said(&far));
}

#[test]
fn media() {
    let desc = good(
        "<medium id=\"fog\" type=\"homogeneous\"><float name=\"scale\" value=\"2\"/><rgb name=\"albedo\" value=\"0.9 0.8 0.7\"/>
         <phase type=\"hg\"/></medium>
         <shape type=\"sphere\"><bsdf type=\"null\"/><ref name=\"interior\" id=\"fog\"/></shape>
         <sensor type=\"perspective\"><ref id=\"fog\"/></sensor>",
    );
    let shape = &desc.shapes[0];
    assert!(shape.is_medium_boundary && shape.exterior.is_none());
    let fog = desc.node(shape.interior.unwrap());
    assert_eq!(
        (fog.float("scale"), fog.float("sigma_t"), fog.get("albedo")),
        (Some(2.0), Some(1.0), Some(&rgb([0.9, 0.8, 0.7])))
    );
    assert_eq!(child(&desc, fog, "phase").float("g"), Some(0.8));
    assert_eq!(only(&desc, &desc.cameras).node("medium"), shape.interior);
    let desc = good(
        "<shape type=\"cube\"><medium name=\"interior\" type=\"homogeneous\"><volume name=\"sigma_t\" type=\"constvolume\">
         <float name=\"value\" value=\"7\"/></volume></medium></shape>",
    );
    let medium = desc.node(desc.shapes[0].interior.unwrap());
    assert_eq!((medium.float("sigma_t"), medium.float("albedo")), (Some(7.0), Some(0.75)));
    assert_eq!(child(&desc, medium, "phase").kind, "isotropic");
}

#[test]
fn textures() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.png"), "").unwrap();
    let text = "<scene version=\"3.0.0\"><shape type=\"cube\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\">
        <string name=\"filename\" value=\"a.png\"/><string name=\"wrap_mode\" value=\"mirror\"/><boolean name=\"raw\" value=\"true\"/>
        <string name=\"filter_type\" value=\"nearest\"/></texture></bsdf></shape></scene>";
    let import = import_text(text, &folder.path().join("s.xml"), &Options::default());
    assert_eq!(errors(&import), Vec::<String>::new());
    let desc = &import.desc;
    let image = child(desc, desc.node(desc.shapes[0].material.unwrap()), "reflectance");
    assert_eq!(
        (image.string("wrap_u"), image.string("filter"), image.bool("raw")),
        (Some("mirror"), Some("nearest"), Some(true))
    );
    assert_eq!(image.string("origin"), Some("top"));
    // Version 0.6 has another default, and borders of black and white.
    let old = |inside: &str| {
        let text = format!(
            "<scene version=\"0.6.0\"><sensor type=\"perspective\"/><shape type=\"cube\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\">
             <string name=\"filename\" value=\"a.png\"/>{inside}</texture></bsdf></shape></scene>"
        );
        let import = import_text(&text, &folder.path().join("s.xml"), &Options::default());
        let said: Vec<String> = import.diagnostics.iter().map(|d| d.message.clone()).collect();
        assert!(
            said.iter().all(|s| s.starts_with("'max_anisotropy' of the texture 'bitmap' has no effect")),
            "{said:?}"
        );
        let desc = &import.desc;
        child(desc, desc.node(desc.shapes[0].material.unwrap()), "reflectance").clone()
    };
    let image = old("");
    assert_eq!((image.string("filter"), image.float("max_anisotropy")), (Some("ewa"), Some(20.0)));
    let image = old("<string name=\"filterType\" value=\"trilinear\"/><float name=\"maxAnisotropy\" value=\"4\"/>\
         <string name=\"wrapModeU\" value=\"one\"/><string name=\"wrapModeV\" value=\"zero\"/>");
    assert_eq!((image.string("filter"), image.get("max_anisotropy")), (Some("trilinear"), None));
    assert_eq!((image.string("wrap_u"), image.string("wrap_v")), (Some("one"), Some("black")));
    let (desc, m) = material(
        "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"checkerboard\"><rgb name=\"color0\" value=\"1\"/>
         <transform name=\"to_uv\"><scale value=\"5\"/></transform></texture></bsdf>",
    );
    let board = child(&desc, &m, "reflectance");
    assert_eq!((board.get("a"), board.float("b")), (Some(&rgb([1.0; 3])), Some(0.2)));
    assert_eq!(board.transform("to_uv").unwrap().point(DVec3::new(1.0, 1.0, 0.0)), DVec3::new(10.0, 10.0, 0.0));
    let (desc, m) = material(
        "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"mesh_attribute\"><string name=\"name\" value=\"face_color\"/></texture></bsdf>",
    );
    let attribute = child(&desc, &m, "reflectance");
    assert_eq!((attribute.string("name"), attribute.string("domain")), (Some("color"), Some("face")));
}
