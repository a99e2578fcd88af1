//! Every model with its parameters and pbrt's defaults.

use super::*;
use steradian_math::spectra::photometry::photometric_from_y;
use steradian_scene::{ColorSpace, SpectrumValue, Value};

fn constant(v: f64) -> Value {
    SpectrumValue::Constant(v).into()
}

fn rgb(r: f64, g: f64, b: f64) -> Value {
    SpectrumValue::Rgb([r, g, b], ColorSpace::Srgb).into()
}

fn named(name: &str) -> Value {
    SpectrumValue::Named(name.into()).into()
}

/// Checks values; `None` means absent.
fn check(n: &Node, kind: &str, values: &[(&str, Option<Value>)]) {
    assert_eq!(n.kind, kind);
    for (name, value) in values {
        assert_eq!(n.get(name), value.as_ref(), "{kind}: {name}");
    }
}

fn some(v: impl Into<Value>) -> Option<Value> {
    Some(v.into())
}

#[test]
fn an_empty_scene_has_the_defaults_of_pbrt() {
    let d = world("");
    check(
        camera(&d),
        "perspective",
        &[
            ("fov", some(90.0)),
            ("fov_axis", some("smaller")),
            ("lens_radius", some(0.0)),
            ("shutter_close", some(1.0)),
            ("to_world", some(Transform::IDENTITY)),
            ("screen_window", None),
        ],
    );
    check(
        d.node(d.film.unwrap()),
        "rgb",
        &[("width", some(1280)), ("height", some(720)), ("exposure_time", some(1.0)), ("crop", None)],
    );
    check(
        d.node(d.filter.unwrap()),
        "gaussian",
        &[("radius_x", some(1.5)), ("radius_y", some(1.5)), ("sigma", some(0.5))],
    );
    check(d.node(d.sampler.unwrap()), "zsobol", &[("samples", some(16)), ("seed", some(0))]);
    check(d.node(d.integrator.unwrap()), "volpath", &[("max_depth", some(5))]);
}

#[test]
fn cameras() {
    let d = options(
        "Camera \"perspective\" \"float fov\" 40 \"float lensradius\" 0.1 \"float focaldistance\" 5 \"float frameaspectratio\" 2
        \"float screenwindow\" [-1 1 -2 2] \"float shutteropen\" 0.25 \"float shutterclose\" 0.75",
    );
    check(
        camera(&d),
        "perspective",
        &[
            ("fov", some(40.0)),
            ("lens_radius", some(0.1)),
            ("focal_distance", some(5.0)),
            ("frame_aspect", some(2.0)),
            ("screen_window", some(vec![-1.0, 1.0, -2.0, 2.0])),
            ("shutter_open", some(0.25)),
        ],
    );
    assert_eq!(d.node(d.film.unwrap()).float("exposure_time"), Some(0.5), "the shutter exposes the film");
    let d = options("Camera \"orthographic\" \"float screenwindow\" [-3 3 -2 2]");
    check(camera(&d), "orthographic", &[("screen_window", some(vec![-3.0, 3.0, -2.0, 2.0])), ("fov", None)]);
    let d = options("Camera \"spherical\" \"string mapping\" \"equirectangular\"");
    check(camera(&d), "spherical", &[("mapping", some("equirectangular"))]);
    let i = load("Camera \"realistic\" \"string lensfile\" \"wide.dat\" WorldBegin");
    assert!(i.diagnostics.has_errors(), "there is no such file");
    let i = load(
        "Camera \"realistic\" \"float focusdistance\" 2 \"string aperture\" \"star\"
         Film \"rgb\" \"float diagonal\" 43 WorldBegin",
    );
    assert!(i.diagnostics.has_errors(), "a lens is needed");
    check(
        camera(&i.desc),
        "realistic",
        &[
            ("focus_distance", some(2.0)),
            ("aperture_diameter", some(1.0)),
            ("film_diagonal", some(43.0)),
            ("aperture", some("star")),
        ],
    );
}

#[test]
fn look_at_gives_the_camera_of_the_vocabulary() {
    let d = options("LookAt 0 0 5  0 0 0  0 1 0 Camera \"perspective\"");
    let t = camera(&d).transform("to_world").unwrap();
    assert_near(image_of(t, [0.0; 3]), [0.0, 0.0, 5.0]);
    assert_near(image_of(t, [0.0, 0.0, 1.0]), [0.0, 0.0, 4.0]);
    assert_near(image_of(t, [0.0, 1.0, 0.0]), [0.0, 1.0, 5.0]);
    // pbrt's space is left-handed: looking along -z, +x is to the left of the world.
    assert_near(image_of(t, [1.0, 0.0, 0.0]), [-1.0, 0.0, 5.0]);
}

#[test]
fn films() {
    let film = |text: &str| {
        let import = load(&format!("{text}\nWorldBegin"));
        assert!(errors(&import).is_empty(), "{text}");
        import.desc.node(import.desc.film.unwrap()).clone()
    };
    let f = film(
        "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 50 \"float cropwindow\" [0.25 0.5 1 0] \"string filename\" \"a.exr\"
        \"float iso\" 200 \"string sensor\" \"canon_eos_5d\" \"float maxcomponentvalue\" 10 \"float diagonal\" 35 \"bool savefp16\" false",
    );
    check(
        &f,
        "rgb",
        &[
            ("crop", some(vec![25i64, 50, 0, 50])),
            ("filename", some("a.exr")),
            ("iso", some(200.0)),
            ("sensor", some("canon_eos_5d")),
            ("white_balance", some(6500.0)),
            ("max_component", some(10.0)),
        ],
    );
    let f = film(
        "Film \"gbuffer\" \"integer xresolution\" 100 \"integer yresolution\" 50 \"integer pixelbounds\" [10 20 30 40]",
    );
    check(&f, "gbuffer", &[("crop", some(vec![10i64, 20, 30, 40])), ("white_balance", None)]);
    let f = film("Film \"spectral\" \"integer nbuckets\" 31 \"float lambdamin\" 400");
    let of = [("buckets", some(31i64)), ("lambda_min", some(400.0)), ("lambda_max", some(830.0))];
    check(&f, "spectral", &of);
}

/// Additional outputs of pbrt's films are reported as left out.
#[test]
fn layers_of_films_are_told() {
    for (kind, lost) in [("gbuffer", "dzdx, dzdy and RelativeVariance"), ("spectral", ""), ("rgb", "")] {
        let import = load(&format!("Film \"{kind}\"\nWorldBegin\n"));
        let said: String = import.diagnostics.iter().map(|d| format!("{d}\n")).collect();
        assert_eq!((import.diagnostics.is_lossy(), said.contains(lost)), (!lost.is_empty(), true), "{said}");
    }
}

#[test]
fn filters() {
    for (theirs, ours, radius) in [
        ("box", "box", 0.5),
        ("triangle", "tent", 2.0),
        ("gaussian", "gaussian", 1.5),
        ("mitchell", "mitchell", 2.0),
        ("sinc", "lanczos", 4.0),
    ] {
        let d = options(&format!("PixelFilter \"{theirs}\" \"float yradius\" 3"));
        check(d.node(d.filter.unwrap()), ours, &[("radius_x", some(radius)), ("radius_y", some(3.0))]);
    }
    let d = options("PixelFilter \"mitchell\" \"float B\" 0.5");
    check(d.node(d.filter.unwrap()), "mitchell", &[("b", some(0.5)), ("c", some(1.0 / 3.0))]);
    let d = options("PixelFilter \"sinc\"");
    check(d.node(d.filter.unwrap()), "lanczos", &[("tau", some(3.0))]);
}

#[test]
fn samplers_and_integrators() {
    for (text, kind, samples) in [
        ("\"independent\"", "independent", 4),
        ("\"sobol\"", "sobol", 16),
        ("\"zsobol\" \"integer pixelsamples\" 7", "zsobol", 7),
        ("\"halton\"", "halton", 16),
        ("\"paddedsobol\" \"string randomization\" \"owen\"", "sobol", 16),
        ("\"pmj02bn\"", "pmj02", 16),
        ("\"stratified\" \"integer xsamples\" 3", "stratified", 12),
    ] {
        let i = load(&format!("Sampler {text} WorldBegin"));
        assert!(!i.diagnostics.is_lossy() && !i.diagnostics.has_errors(), "{text}: only the noise differs");
        check(i.desc.node(i.desc.sampler.unwrap()), kind, &[("samples", some(samples))]);
    }
    for (given, kind, lossy) in [
        ("path", "path", false),
        ("simplepath", "path", false),
        ("volpath", "volpath", false),
        ("simplevolpath", "volpath", false),
        ("bdpt", "bdpt", false),
        ("mlt", "mmlt", false),
        ("sppm", "sppm", false),
        ("lightpath", "light", false),
        ("randomwalk", "path", true),
        ("ambientocclusion", "ao", false),
        ("function", "path", true),
    ] {
        let i = load(&format!(
            "Integrator \"{given}\" \"integer maxdepth\" 9 Accelerator \"kdtree\" \"integer maxdepth\" 3 WorldBegin"
        ));
        assert_eq!((i.diagnostics.is_lossy(), i.diagnostics.has_errors()), (lossy, false), "{given}");
        check(i.desc.node(i.desc.integrator.unwrap()), kind, &[("max_depth", some(9))]);
    }
    let i = load("Integrator \"sppm\" \"integer photonsperiteration\" 5000 \"float radius\" 0.25 WorldBegin");
    check(i.desc.node(i.desc.integrator.unwrap()), "sppm", &[("photons", some(5000)), ("radius", some(0.25))]);
    let i = load(
        "Integrator \"mlt\" \"integer mutationsperpixel\" 200 \"float largestepprobability\" 0.5 \"integer chains\" 7 WorldBegin",
    );
    check(i.desc.node(i.desc.integrator.unwrap()), "mmlt", &[("samples", some(200)), ("large_step", some(0.5))]);
    assert!(i.diagnostics.iter().any(|d| d.message.contains("'chains'")), "what has no effect is told");
    let i = load("Integrator \"ambientocclusion\" \"bool cossample\" false \"float maxdistance\" 2 WorldBegin");
    check(i.desc.node(i.desc.integrator.unwrap()), "ao", &[("distance", some(2.0))]);
    assert!(i.diagnostics.iter().any(|d| d.message.contains("'cossample'")), "what has no effect is told");
    for wrong in [
        "\"ambientocclusion\" \"float maxdistance\" 0",
        "\"sppm\" \"float radius\" 0",
        "\"mlt\" \"integer mutationsperpixel\" 0",
        "\"mlt\" \"float largestepprobability\" 2",
    ] {
        assert!(load(&format!("Integrator {wrong} WorldBegin")).diagnostics.has_errors(), "{wrong}");
    }
}

fn one_light(text: &str) -> Node {
    light(&world(text)).clone()
}

#[test]
fn lights() {
    let l = one_light("LightSource \"point\"");
    check(
        &l,
        "point",
        &[
            ("intensity", some(rgb(1.0, 1.0, 1.0))),
            ("normalize", some(true)),
            ("scale", some(1.0)),
            ("power", None),
            ("position", some([0.0; 3])),
        ],
    );
    let l = one_light(
        "Translate 1 2 3 Scale 2 2 2 LightSource \"point\" \"blackbody I\" 5000 \"point3 from\" [1 0 0] \"float power\" 60 \"float scale\" 2",
    );
    check(
        &l,
        "point",
        &[
            ("intensity", some(SpectrumValue::Blackbody(5000.0))),
            ("position", some([3.0, 2.0, 3.0])),
            ("power", some(60.0 * photometric_from_y(1.0))),
            ("scale", some(2.0)),
        ],
    );
    let l = one_light("LightSource \"point\" \"float power\" -1");
    check(&l, "point", &[("power", None)]);

    let l = one_light(
        "Rotate 90 1 0 0 LightSource \"distant\" \"rgb L\" [1 2 3] \"point from\" [0 0 2] \"point3 to\" [0 0 0] \"float illuminance\" 100",
    );
    check(
        &l,
        "distant",
        &[("radiance", some(rgb(1.0, 2.0, 3.0))), ("illuminance", some(100.0 * photometric_from_y(1.0)))],
    );
    assert_near(l.vec3("direction").unwrap(), [0.0, 1.0, 0.0]);
    assert_near(one_light("LightSource \"distant\"").vec3("direction").unwrap(), [0.0, 0.0, 1.0]);

    let l = one_light(
        "LightSource \"spot\" \"float coneangle\" 45 \"float conedeltaangle\" 10 \"point3 from\" [1 1 1] \"point3 to\" [1 5 1]",
    );
    check(&l, "spot", &[("cone_angle", some(45.0)), ("falloff_start", some(35.0)), ("falloff", some("smoothstep"))]);
    let t = l.transform("to_world").unwrap();
    assert_near(image_of(t, [0.0; 3]), [1.0, 1.0, 1.0]);
    assert_near(image_of(t, [0.0, 0.0, 1.0]), [1.0, 2.0, 1.0]);
    assert!((t.matrix.determinant() - 1.0).abs() < 1e-12, "a rotation");

    let l = one_light("Translate 1 0 0 LightSource \"infinite\" \"float scale\" 3");
    check(
        &l,
        "environment",
        &[("radiance", some(rgb(1.0, 1.0, 1.0))), ("normalize", some(true)), ("scale", some(3.0)), ("file", None)],
    );
    let l =
        one_light("LightSource \"infinite\" \"spectrum L\" [300 1 800 1] \"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]");
    assert_eq!(l.floats("portal").unwrap().len(), 12);
    let flat = SpectrumValue::Sampled { lambdas: vec![300.0, 800.0], values: vec![1.0, 1.0] };
    check(&l, "environment", &[("radiance", some(flat))]);
}

#[test]
fn lights_with_images() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("i.exr"), "").unwrap();
    let load = |text: &str| {
        let i = load_in(dir.path(), &format!("WorldBegin {text}"));
        assert!(i.diagnostics.is_empty(), "{:?}", i.diagnostics);
        i.desc
    };
    let d = load("Scale -1 1 1 LightSource \"infinite\" \"string filename\" \"i.exr\" \"float illuminance\" 10");
    let file = Some(dir.path().join("i.exr").into());
    check(
        light(&d),
        "environment",
        &[
            ("file", file.clone()),
            ("radiance", None),
            ("parametrization", some("auto")),
            ("illuminance", some(10.0 * photometric_from_y(1.0))),
        ],
    );
    assert!(light(&d).transform("to_world").unwrap().swaps_handedness());
    let d = load("LightSource \"projection\" \"string filename\" \"i.exr\" \"float fov\" 30");
    check(
        light(&d),
        "projection",
        &[("file", file.clone()), ("fov", some(30.0)), ("fov_axis", some("smaller")), ("normalize", some(true))],
    );
    let d = load("LightSource \"goniometric\" \"string filename\" \"i.exr\"");
    check(light(&d), "goniometric", &[("file", file.clone())]);
    assert_near(image_of(light(&d).transform("to_world").unwrap(), [1.0, 2.0, 3.0]), [1.0, 3.0, 2.0]);
    let d = load("AreaLightSource \"diffuse\" \"string filename\" \"i.exr\" Shape \"sphere\"");
    check(d.node(d.shapes[0].emission.unwrap()), "area", &[("file", file)]);
}

#[test]
fn area_lights_are_shared_by_shapes() {
    let d = world(
        "AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"bool twosided\" true \"float power\" 9 Shape \"sphere\" Shape \"disk\"",
    );
    assert_eq!(d.shapes[0].emission, d.shapes[1].emission);
    let l = d.node(d.shapes[0].emission.unwrap());
    check(
        l,
        "area",
        &[
            ("radiance", some(rgb(1.0, 2.0, 3.0))),
            ("two_sided", some(true)),
            ("power", some(9.0 * photometric_from_y(1.0))),
            ("normalize", some(true)),
        ],
    );
    assert!(d.lights.is_empty());
}

fn one_material(text: &str) -> Node {
    material(&world(&format!("{text} Shape \"sphere\""))).clone()
}

#[test]
fn materials() {
    check(&one_material("Material \"diffuse\""), "diffuse", &[("reflectance", some(constant(0.5)))]);
    check(
        &one_material("Material \"diffuse\" \"color reflectance\" [0.1 0.2 0.3]"),
        "diffuse",
        &[("reflectance", some(rgb(0.1, 0.2, 0.3)))],
    );
    let rough = [("alpha_u", some(0.0)), ("alpha_v", some(0.0)), ("remap_roughness", some(true))];
    let m = one_material("Material \"conductor\"");
    check(&m, "conductor", &rough);
    check(
        &m,
        "conductor",
        &[("eta", some(named("metal-Cu-eta"))), ("k", some(named("metal-Cu-k"))), ("reflectance", None)],
    );
    let m = one_material(
        "Material \"conductor\" \"rgb reflectance\" [1 1 1] \"float roughness\" 0.3 \"float vroughness\" 0.1 \"bool remaproughness\" false",
    );
    check(
        &m,
        "conductor",
        &[("eta", None), ("k", None), ("alpha_u", some(0.3)), ("alpha_v", some(0.1)), ("remap_roughness", some(false))],
    );
    let m = one_material("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"float uroughness\" 0.2");
    check(
        &m,
        "conductor",
        &[
            ("eta", some(named("metal-Au-eta"))),
            ("k", some(named("metal-Cu-k"))),
            ("alpha_u", some(0.2)),
            ("alpha_v", some(0.0)),
        ],
    );
    check(&one_material("Material \"dielectric\""), "dielectric", &rough);
    check(&one_material("Material \"dielectric\" \"float eta\" 1.33"), "dielectric", &[("eta", some(1.33))]);
    check(
        &one_material("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\""),
        "dielectric",
        &[("eta", some(named("glass-BK7")))],
    );
    check(&one_material("Material \"thindielectric\""), "thin_dielectric", &[("eta", some(1.5))]);
    let m = one_material("Material \"coateddiffuse\"");
    check(&m, "coated_diffuse", &rough);
    check(
        &m,
        "coated_diffuse",
        &[
            ("reflectance", some(constant(0.5))),
            ("eta", some(1.5)),
            ("thickness", some(0.01)),
            ("albedo", some(constant(0.0))),
            ("g", some(0.0)),
            ("max_depth", some(10)),
            ("samples", some(1)),
        ],
    );
    check(&one_material("Material \"interface\""), "interface", &[]);
    check(&one_material("Material \"\""), "interface", &[]);
    check(&one_material("Material \"none\""), "interface", &[]);
}

#[test]
fn materials_that_keep_their_own_words() {
    let m = one_material("Material \"coatedconductor\" \"float conductor.roughness\" 0.4");
    check(
        &m,
        "coated_conductor",
        &[
            ("conductor.uroughness", some(0.4)),
            ("interface.vroughness", some(0.0)),
            ("interface.eta", some(1.5)),
            ("conductor.k", some(named("metal-Cu-k"))),
            ("max_depth", some(10)),
        ],
    );
    let m = one_material("Material \"diffusetransmission\" \"float scale\" 2 \"rgb transmittance\" [0.1 0.2 0.3]");
    check(
        &m,
        "diffuse_transmission",
        &[("reflectance", some(constant(0.5))), ("transmittance", some(rgb(0.2, 0.4, 0.6)))],
    );
    let d = world(
        "Texture \"t\" \"spectrum\" \"constant\" Material \"diffusetransmission\" \"float scale\" 2 \"texture reflectance\" \"t\" Shape \"sphere\"",
    );
    check(d.node(material(&d).node("reflectance").unwrap()), "scale", &[("scale", some(2.0))]);
    let m = one_material("Material \"hair\" \"float eumelanin\" 0.8");
    check(
        &m,
        "hair",
        &[
            ("eumelanin", some(0.8)),
            ("eta", some(1.55)),
            ("beta_m", some(0.3)),
            ("alpha", some(2.0)),
            ("sigma_a", None),
        ],
    );
    let m = one_material("Material \"subsurface\"");
    check(
        &m,
        "subsurface",
        &[("sigma_a", some(rgb(0.0011, 0.0024, 0.014))), ("eta", some(1.33)), ("scale", some(1.0))],
    );
    let m = one_material("Material \"subsurface\" \"string name\" \"Ketchup\"");
    check(&m, "subsurface", &[("sigma_s", some(rgb(0.18, 0.07, 0.03)))]);
    let m = one_material("Material \"subsurface\" \"rgb reflectance\" [0.5 0.5 0.5]");
    check(&m, "subsurface", &[("mfp", some(constant(1.0))), ("sigma_a", None)]);
}

#[test]
fn mixed_materials_and_maps() {
    let d = world(
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" \"conductor\"
        Texture \"d\" \"float\" \"constant\"
        MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.25
        NamedMaterial \"m\" Shape \"sphere\" Material \"diffuse\" \"texture displacement\" \"d\" Shape \"sphere\"",
    );
    let m = material(&d);
    assert_eq!((m.kind.as_str(), m.float("amount"), m.name.as_deref()), ("mix", Some(0.25), Some("m")));
    let Some(Value::Nodes(parts)) = m.get("materials") else { panic!() };
    assert_eq!(parts.iter().map(|p| d.node(*p).kind.as_str()).collect::<Vec<_>>(), ["diffuse", "conductor"]);
    assert!(d.node(d.shapes[1].material.unwrap()).node("displacement").is_some());
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("n.png"), "").unwrap();
    let d = load_in(dir.path(), "WorldBegin Material \"diffuse\" \"string normalmap\" \"n.png\" Shape \"sphere\"").desc;
    check(
        d.node(material(&d).node("normal_map").unwrap()),
        "image",
        &[("raw", some(true)), ("encoding", some("linear")), ("origin", some("bottom"))],
    );
    let i = load(
        "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"interface\" Material \"mix\" \"string materials\" [\"a\" \"a\"]",
    );
    assert!(errors(&i)[0].message.contains("cannot be mixed"));
}

fn one_texture(values: &str, text: &str) -> Node {
    let dir = tempfile::tempdir().unwrap();
    for name in ["i.png", "i.exr", "i.jpg"] {
        std::fs::write(dir.path().join(name), "").unwrap();
    }
    let i = load_in(dir.path(), &format!("WorldBegin Scale 2 2 2 Texture \"t\" \"{values}\" {text}"));
    let is_told = |d: &&Diagnostic| d.message.starts_with("'encoding' of texture 'imagemap' has no effect");
    let messages: Vec<String> = i.diagnostics.iter().filter(|d| !is_told(d)).map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
    i.desc.nodes.iter().find(|n| n.name.as_deref() == Some("t")).unwrap().clone()
}

#[test]
fn textures() {
    check(&one_texture("float", "\"constant\""), "constant", &[("value", some(1.0))]);
    check(
        &one_texture("spectrum", "\"constant\" \"rgb value\" [1 2 3]"),
        "constant",
        &[("value", some(rgb(1.0, 2.0, 3.0)))],
    );
    check(
        &one_texture("float", "\"scale\" \"float scale\" 2"),
        "scale",
        &[("texture", some(1.0)), ("scale", some(2.0))],
    );
    check(&one_texture("spectrum", "\"scale\""), "scale", &[("texture", some(constant(1.0))), ("scale", some(1.0))]);
    check(&one_texture("float", "\"mix\""), "mix", &[("a", some(0.0)), ("b", some(1.0)), ("amount", some(0.5))]);
    let t = one_texture("spectrum", "\"checkerboard\" \"rgb tex2\" [1 0 0] \"float uscale\" 4 \"float vdelta\" 0.5");
    check(
        &t,
        "checkerboard",
        &[
            ("a", some(constant(1.0))),
            ("b", some(rgb(1.0, 0.0, 0.0))),
            ("dimension", some(2)),
            ("scale_u", some(4.0)),
            ("scale_v", some(1.0)),
            ("delta_v", some(0.5)),
            ("mapping", some("uv")),
        ],
    );
    let t = one_texture("float", "\"checkerboard\" \"integer dimension\" 3");
    assert_near(image_of(t.transform("texture_from_world").unwrap(), [2.0, 4.0, 6.0]), [1.0, 2.0, 3.0]);
    let t = one_texture(
        "float",
        "\"checkerboard\" \"string mapping\" \"planar\" \"vector3 v1\" [0 0 1] \"float udelta\" 2",
    );
    check(
        &t,
        "checkerboard",
        &[
            ("mapping", some("planar")),
            ("v1", some([0.0, 0.0, 1.0])),
            ("v2", some([0.0, 1.0, 0.0])),
            ("delta_u", some(2.0)),
        ],
    );
    assert!(t.transform("texture_from_world").is_some());
    for (text, kind) in [
        ("\"bilerp\" \"float v00\" 3", "bilerp"),
        ("\"dots\" \"float inside\" 0.5 \"string mapping\" \"spherical\"", "dots"),
        ("\"fbm\" \"integer octaves\" 4", "fbm"),
        ("\"wrinkled\" \"float roughness\" 0.7", "wrinkled"),
        ("\"windy\"", "windy"),
        ("\"directionmix\" \"vector dir\" [1 0 0]", "direction_mix"),
    ] {
        assert_eq!(one_texture("float", text).kind, kind);
    }
    check(
        &one_texture("spectrum", "\"marble\" \"float scale\" 3"),
        "marble",
        &[("scale", some(3.0)), ("variation", some(0.2)), ("octaves", some(8))],
    );
    check(&one_texture("float", "\"dots\" \"float inside\" 0.5"), "dots", &[("b", some(0.5)), ("a", some(0.0))]);
}

#[test]
fn ptex_is_refused_by_name() {
    let import = load("WorldBegin Texture \"t\" \"spectrum\" \"ptex\" \"string filename\" \"a.ptx\"");
    assert!(errors(&import)[0].message.contains("Ptex textures are not supported"));
}

#[test]
fn image_textures() {
    let t = one_texture("spectrum", "\"imagemap\" \"string filename\" \"i.png\"");
    check(
        &t,
        "image",
        &[
            ("encoding", some("srgb")),
            ("filter", some("bilinear")),
            ("wrap_u", some("repeat")),
            ("wrap_v", some("repeat")),
            ("raw", some(false)),
            ("origin", some("bottom")),
            ("scale", some(1.0)),
            ("invert", some(false)),
        ],
    );
    let t = one_texture(
        "float",
        "\"imagemap\" \"string filename\" \"i.png\" \"string encoding\" \"linear\" \"string wrap\" \"clamp\" \"string filter\" \"EWA\" \"float maxanisotropy\" 4 \"bool invert\" true",
    );
    check(
        &t,
        "image",
        &[
            ("encoding", some("linear")),
            ("raw", some(true)),
            ("wrap_v", some("clamp")),
            ("filter", some("ewa")),
            ("invert", some(true)),
        ],
    );
    let t = one_texture(
        "float",
        "\"imagemap\" \"string filename\" \"i.png\" \"string encoding\" \"gamma 2.2\" \"string filter\" \"point\"",
    );
    check(&t, "image", &[("encoding", some(2.2)), ("raw", some(false)), ("filter", some("nearest"))]);
    // What lies beyond an octahedral map is on the other half of its edge, both ways.
    let t = one_texture("spectrum", "\"imagemap\" \"string filename\" \"i.png\" \"string wrap\" \"octahedralsphere\"");
    check(&t, "image", &[("wrap_u", some("octahedral")), ("wrap_v", some("octahedral"))]);
    // pbrt obeys the encoding of PNG files alone.
    check(
        &one_texture("float", "\"imagemap\" \"string filename\" \"i.jpg\" \"string encoding\" \"linear\""),
        "image",
        &[("encoding", some("srgb"))],
    );
    check(
        &one_texture("float", "\"imagemap\" \"string filename\" \"i.exr\""),
        "image",
        &[("encoding", some("linear")), ("raw", some(true))],
    );
}

#[test]
fn media() {
    let medium = |text: &str| {
        let d = world(&format!("Translate 1 0 0 MakeNamedMedium \"m\" \"string type\" {text}"));
        let m = d.nodes.iter().find(|n| n.name.as_deref() == Some("m")).unwrap().clone();
        let phase = d.node(m.node("phase").unwrap()).clone();
        (m, phase)
    };
    let (m, phase) = medium("\"homogeneous\"");
    check(
        &m,
        "homogeneous",
        &[("sigma_a", some(constant(1.0))), ("sigma_s", some(constant(1.0))), ("scale", some(1.0)), ("to_world", None)],
    );
    assert_eq!(phase.kind, "isotropic");
    let (m, phase) = medium("\"homogeneous\" \"string preset\" \"Ketchup\" \"float g\" -0.5 \"float scale\" 10");
    check(
        &m,
        "homogeneous",
        &[("sigma_s", some(rgb(0.18, 0.07, 0.03))), ("sigma_a", some(rgb(0.061, 0.97, 1.45))), ("scale", some(10.0))],
    );
    check(&phase, "hg", &[("g", some(-0.5))]);
    let (m, _) = medium("\"uniformgrid\" \"integer nx\" 2 \"float density\" [1 2] \"point3 p1\" [2 1 1]");
    check(
        &m,
        "uniformgrid",
        &[
            ("density", some(vec![1.0, 2.0])),
            ("nx", some(2)),
            ("ny", some(1)),
            ("p0", some([0.0; 3])),
            ("p1", some([2.0, 1.0, 1.0])),
        ],
    );
    assert!(m.transform("to_world").is_some());
    let (m, _) = medium("\"rgbgrid\" \"rgb sigma_s\" [1 2 3]");
    check(&m, "rgbgrid", &[("sigma_s", some(vec![1.0, 2.0, 3.0]))]);
    let (m, _) = medium("\"cloud\" \"float density\" 4");
    check(&m, "cloud", &[("density", some(4.0)), ("wispiness", some(1.0)), ("frequency", some(5.0))]);
}

#[test]
fn quadrics() {
    let s = shape(&world("Shape \"sphere\" \"float radius\" 2 \"float zmin\" -1 \"float phimax\" 90")).clone();
    check(
        &s,
        "sphere",
        &[("radius", some(2.0)), ("z_min", some(-1.0)), ("z_max", some(2.0)), ("phi_max", some(90.0)), ("alpha", None)],
    );
    let s = shape(&world("Shape \"disk\" \"float height\" 1 \"float innerradius\" 0.5 \"float alpha\" 0.5")).clone();
    check(
        &s,
        "disk",
        &[
            ("height", some(1.0)),
            ("radius", some(1.0)),
            ("inner_radius", some(0.5)),
            ("phi_max", some(360.0)),
            ("alpha", some(0.5)),
        ],
    );
    let s = shape(&world("Shape \"cylinder\" \"float zmax\" 3")).clone();
    check(&s, "cylinder", &[("radius", some(1.0)), ("z_min", some(-1.0)), ("z_max", some(3.0))]);
    // Those of pbrt-v3, with its defaults.
    let s = shape(&world("Shape \"cone\" \"float height\" 3")).clone();
    check(&s, "cone", &[("radius", some(1.0)), ("height", some(3.0)), ("phi_max", some(360.0))]);
    let s = shape(&world("Shape \"paraboloid\" \"float zmin\" 0.5 \"float zmax\" 2 \"float phimax\" 90")).clone();
    check(
        &s,
        "paraboloid",
        &[("radius", some(1.0)), ("z_min", some(0.5)), ("z_max", some(2.0)), ("phi_max", some(90.0))],
    );
    let s = shape(&world("Shape \"hyperboloid\" \"point p1\" [1 0 0] \"point p2\" [0.5 1 2]")).clone();
    check(&s, "hyperboloid", &[("p1", some([1.0, 0.0, 0.0])), ("p2", some([0.5, 1.0, 2.0])), ("phi_max", some(360.0))]);
}

#[test]
fn meshes_written_in_the_scene() {
    let d = world(
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"integer indices\" [0 1 2 0 2 3] \"normal N\" [0 0 1 0 0 1 0 0 1 0 0 1]
        \"point2 uv\" [0 0 1 0 1 1 0 1] \"vector3 S\" [1 0 0 1 0 0 1 0 0 1 0 0]",
    );
    assert_eq!(shape(&d).kind, "mesh");
    let m = &d.meshes[d.shapes[0].mesh.unwrap()];
    assert_eq!((m.positions.len(), m.normals.len(), m.tangents.len()), (4, 4, 4));
    assert_eq!((m.triangles[1], m.uvs[2]), ([0, 2, 3], [1.0, 1.0]));
    let d = world("Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 1 1 0]");
    assert_eq!(d.meshes[0].triangles, [[0, 1, 2]], "one triangle needs no indices");
    let d = world("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]");
    assert_eq!(d.meshes[0].patches, [[0, 1, 2, 3]]);
    let d =
        world("Shape \"loopsubdiv\" \"integer levels\" 2 \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer indices\" [0 1 2]");
    check(shape(&d), "loop_subdivision", &[("levels", some(2))]);
    assert_eq!(d.meshes[0].triangles.len(), 1);
}

#[test]
fn height_fields_of_the_version_before() {
    let s = shape(&world("Shape \"heightfield\" \"integer nu\" 3 \"integer nv\" 2 \"float Pz\" [0 1 2 3 4 5]")).clone();
    check(&s, "height_field", &[("nu", some(3)), ("nv", some(2)), ("alpha", None)]);
    assert_eq!(s.floats("heights"), Some(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0][..]));
}

#[test]
fn curves() {
    let d = world("Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0] \"float width\" 0.5 \"float width1\" 0.1");
    check(
        shape(&d),
        "curve",
        &[
            ("degree", some(3)),
            ("basis", some("bezier")),
            ("type", some("flat")),
            ("width0", some(0.5)),
            ("width1", some(0.1)),
            ("split_depth", some(3)),
            ("normals", None),
        ],
    );
    assert_eq!(shape(&d).floats("points").unwrap().len(), 12);
    let d = world(
        "Shape \"curve\" \"string basis\" \"bspline\" \"integer degree\" 2 \"string type\" \"ribbon\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0] \"normal N\" [0 0 1 0 0 1 0 0 1]",
    );
    check(shape(&d), "curve", &[("degree", some(2)), ("basis", some("bspline")), ("type", some("ribbon"))]);
    assert_eq!(shape(&d).floats("normals").unwrap().len(), 9);
}
