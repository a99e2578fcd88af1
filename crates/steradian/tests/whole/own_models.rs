//! Models of a program's own, as the examples have them, beside those of Steradian: the same pictures, within noise or
//! rounding, and the same laws.

#[path = "../../examples/own_models/camera.rs"]
mod camera;
#[path = "../../examples/own_models/light.rs"]
mod light;
#[path = "../../examples/own_models/material.rs"]
mod material;
#[path = "../../examples/own_models/medium.rs"]
mod medium;
#[path = "../../examples/own_models/method.rs"]
mod method;
#[path = "../../examples/own_models/shape.rs"]
mod shape;
#[path = "../../examples/own_models/texture.rs"]
mod texture;

use std::sync::Arc;
use steradian::{
    Control, Film, Layer, Quality, Registry, RegistryError, Scene, Values,
    bsdf::{Inputs, OwnScatter, TransportMode},
    core::{camera::OwnCamera, light::OwnLight, medium::OwnMedium, shape::OwnShape},
    instruments::{Specimen, laws::laws},
    load_bytes,
    math::{Bounds3, DVec2, DVec3, Spectrum, Vec2, Vec3},
    scene::Diagnostics,
    schema::{Family, Group, Model, Parameter, Type, light as light_parameters, medium as medium_parameters},
    verify::{Verdict, verify},
};

fn registry() -> Registry {
    let all = || -> Result<Registry, RegistryError> {
        Registry::new()
            .material(&material::MODEL, material::Glossy)?
            .texture(&texture::MODEL, texture::Rings::new)?
            .shape(&shape::MODEL, shape::Torus::new)?
            .light(&light::MODEL, light::Beam::new)?
            .medium(&medium::MODEL, medium::Fog::new)?
            .camera(&camera::MODEL, camera::Fisheye::new)?
            .method(&method::MODEL, method::KIND)
    };
    all().expect("a sound registry")
}

/// A scene of a text, and what there is to say about it.
fn read(format: &str, text: &str) -> (Option<Arc<Scene>>, Diagnostics) {
    let registry = registry();
    let loaded = load_bytes("text", text.as_bytes().to_vec(), Some(format), &registry.reading());
    let loaded = loaded.compile(&registry.compiling());
    (loaded.scene.map(Arc::new), loaded.diagnostics)
}

fn scene(text: &str) -> Arc<Scene> {
    let (scene, said) = read("steradian", &format!("steradian: 1\nfilm: {{film: rgb, width: 24, height: 24}}\n{text}"));
    let said: Vec<String> = said.iter().map(ToString::to_string).collect();
    assert!(said.is_empty(), "{said:?}");
    scene.expect("a sound scene")
}

fn film(scene: &Arc<Scene>, integrator: &str, spp: u32) -> Film {
    film_with(scene, integrator, spp, Vec::new())
}

fn film_with(scene: &Arc<Scene>, integrator: &str, spp: u32, layers: Vec<Layer>) -> Film {
    let quality = Quality { seed: Some(3), layers, ..Quality::of(integrator).spp(spp) };
    let mut session = registry().plan(scene, &quality).expect("a plan").session(scene).expect("a session");
    session.step(u32::MAX, &Control::default());
    session.film()
}

/// The mean of green and its standard error.
fn mean(film: &Film) -> (f64, f64) {
    let n = film.pixels.len() as f64;
    let sum = |f: &dyn Fn(&steradian::Pixel) -> f64| film.pixels.iter().map(f).sum::<f64>();
    (sum(&|p| p.mean()[1]) / n, sum(&|p| p.variance_of_mean()[1]).sqrt() / n)
}

/// Asserts that two means differ by noise alone, and that there is little of it.
fn agree(a: &Film, b: &Film) {
    let ((a, s), (b, t)) = (mean(a), mean(b));
    assert!((a - b).abs() < 3.5 * s.hypot(t) && s.max(t) < 0.005 * a, "{a} ± {s}, not {b} ± {t}");
}

/// Share of pixels of two films of the same samples that differ by more than rounding.
fn differing(a: &Film, b: &Film) -> f64 {
    let differs = |(a, b): &(&steradian::Pixel, &steradian::Pixel)| (a.mean()[1] - b.mean()[1]).abs() > 1e-3;
    a.pixels.iter().zip(&b.pixels).filter(differs).count() as f64 / a.pixels.len() as f64
}

const FLOOR: &str = "{shape: disk, radius: 9, to_world: [{rotate: [1, 0, 0], degrees: -90}, {translate: [0, -1, 0]}]}";
const VIEW: &str = "lights: [{light: environment, radiance: 1}, {light: point, position: [0, 3, 2], intensity: 20}]
camera: {camera: perspective, fov: 40, to_world: {look_at: [0, 0, 0], from: [0, 1, 5], up: [0, 1, 0]}}";

fn ball(material: &str) -> Arc<Scene> {
    scene(&format!("{VIEW}\nshapes: [{{shape: sphere, material: {{material: {material}}}}}]"))
}

#[test]
fn a_material_looks_as_the_built_in_one_and_keeps_the_laws() {
    let own = ball("my_glossy, diffuse: [0.2, 0.4, 0.6], glossy: 0.3, exponent: 40");
    let built_in = ball("phong, diffuse_reflectance: [0.2, 0.4, 0.6], specular_reflectance: 0.3, exponent: 40");
    agree(&film(&own, "path", 256), &film(&built_in, "path", 256));
    agree(&film(&own, "bdpt", 256), &film(&built_in, "path", 256));
    let found = laws(&Specimen::new(&own, 1), 20_000);
    assert!(found.hold, "{:?}", found.laws.iter().filter(|l| !l.holds).collect::<Vec<_>>());
}

/// A model that is not the same with the two directions exchanged, and says that it is.
#[derive(Debug)]
struct Skewed;

impl OwnScatter for Skewed {
    fn value(&self, at: &Inputs, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        at.colors[0] * (self.pdf(at, wo, wi, mode) * (1.0 - 0.9 * wi.z))
    }
}

/// `verify` accepts methods on a scene of a sound model, and finds that those from the light differ on a faulty one.
#[test]
fn verify_judges_models_of_ones_own() {
    static SKEWED: Model = Model {
        kind: "my_skewed",
        doc: "",
        parameters: &[Parameter::new(Type::Texture, "color", (0.0, 1.0), "0.8", "")],
        groups: &[],
        source: "",
    };
    let registry = registry().material(&SKEWED, Skewed).expect("a registry");
    let differing = |material: &str| {
        let text = format!(
            "steradian: 1, film: {{film: rgb, width: 16, height: 16}}, lights: [{{light: environment, radiance: 1}}]
            camera: {{camera: perspective, fov: 50,
                to_world: {{look_at: [0, -0.5, 0], from: [0, 3, 4], up: [0, 1, 0]}}}}
            materials: {{own: {{material: {material}}}}}
            shapes: [{{shape: sphere, material: own}}, {{shape: disk, radius: 4, material: own,
                to_world: [{{rotate: [1, 0, 0], degrees: -90}}, {{translate: [0, -1, 0]}}]}}]"
        );
        let loaded = load_bytes("text", text.into_bytes(), Some("steradian"), &registry.reading());
        let mut scene = Arc::new(loaded.compile(&registry.compiling()).scene.expect("a sound scene"));
        let quality = Quality { spp: Some(64), threads: 2, seed: Some(1), max_depth: Some(4), ..Quality::default() };
        let named = ["path".to_owned(), "light".to_owned()];
        let report = verify(&mut scene, &quality, &named, &Control::default(), |_| ()).expect("a report");
        report.with(Verdict::Differs).len()
    };
    assert_eq!(differing("my_glossy, diffuse: 0.5, glossy: 0.3, exponent: 10"), 0);
    assert!(differing("my_skewed") > 0);
}

/// Waves compute single paths, of models of one's own, too.
#[test]
fn waves_have_the_bits_of_single_paths_with_own_models() {
    let own = ball("my_glossy, diffuse: {texture: my_rings}, exponent: {texture: checkerboard, a: 5, b: 90}");
    // Light is counted by groups path by path.
    let single = film_with(&own, "path", 8, vec![Layer::LIGHT_GROUPS]);
    let waves = film(&own, "path", 8);
    let bits = |film: &Film| film.pixels.iter().map(|p| p.sum.map(f64::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(&waves), bits(&single));
}

#[test]
fn a_texture_has_the_values_of_its_formula() {
    let own = ball("diffuse, reflectance: {texture: my_rings, rings: 3, scale_u: 2}");
    let formula = r#"{texture: expression, expression: "0.5 + 0.5*sin(2*pi*3*sqrt(x*x + y*y + z*z))"}"#;
    let formula = ball(&format!("diffuse, reflectance: {formula}"));
    assert_eq!(differing(&film(&own, "path", 16), &film(&formula, "path", 16)), 0.0);
    let warm = ball("diffuse, reflectance: {texture: my_rings, palette: warm}");
    let [r, _, b] = film(&warm, "path", 16).pixels[12 * 24 + 12].mean();
    assert!(r > 1.4 * b, "{r} {b}");
}

#[test]
fn a_shape_is_that_of_its_equation() {
    let turned = "to_world: [{scale: [1.2, 1, 0.8]}, {rotate: [1, 0.3, 0], degrees: 50}]";
    let of = |shape: &str| {
        scene(&format!("{VIEW}\nshapes: [{{shape: {shape}, {turned}, material: {{material: diffuse}}}}]"))
    };
    let equation = r#""(x*x + y*y + z*z + 1 - 0.09)^2 - 4*(x*x + y*y)""#;
    let built_in = of(&format!("implicit, expression: {equation}, min: [-1.3, -1.3, -0.3], max: [1.3, 1.3, 0.3]"));
    let own = of("my_torus, radius: 1, tube: 0.3");
    let (a, b) = (film(&own, "path", 16), film(&built_in, "path", 16));
    // Rays that graze it may meet it in one and miss it in the other.
    assert!(differing(&a, &b) < 0.05, "{}", differing(&a, &b));
    agree(&film(&own, "path", 64), &film(&built_in, "path", 64));
}

/// A beam's light on a plane, by the law of squared distances; with a power, the same flux in all.
#[test]
fn a_light_has_its_distribution() {
    let seen = |light: &str| {
        let camera = "camera: {camera: radiance_meter, to_world: {look_at: [1, 0, 0], from: [1, 0, 1], up: [0, 1, 0]}}";
        let place = "to_world: {look_at: [0, 0, 0], from: [0, 0, 2], up: [0, 1, 0]}";
        let floor = "shapes: [{shape: disk, radius: 9, material: {material: diffuse, reflectance: 0.5}}]";
        let lights = format!("lights: [{{light: my_beam, exponent: 3, {light}, {place}}}]");
        mean(&film(&scene(&format!("{camera}\n{lights}\n{floor}")), "path", 4)).0
    };
    let cos = 2.0 / 5.0_f64.sqrt();
    let expected = 0.5 / std::f64::consts::PI * 10.0 * cos.powi(3) * cos / 5.0;
    let found = seen("intensity: 10");
    assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    // Φ = 2π I/(n + 1): 1 lm of one unit of luminance.
    let by_power = seen("power: 683");
    let by_intensity = seen("intensity: 1");
    let unit = by_power / by_intensity * std::f64::consts::TAU / 4.0;
    let isotropic = "lights: [{light: point, power: 683, position: [0, 0, 2]}]\n\
        camera: {camera: radiance_meter, to_world: \
        {look_at: [0, 0, 0], from: [0, 0, 1], up: [0, 1, 0]}}\n\
        shapes: [{shape: disk, radius: 9, material: {material: diffuse, reflectance: 0.5}}]";
    let flux =
        mean(&film(&scene(isotropic), "path", 4)).0 * 4.0 * std::f64::consts::PI * 4.0 * 2.0 * std::f64::consts::PI;
    assert!((unit / flux - 1.0).abs() < 0.01, "{unit} {flux}");
}

/// Light that a fog without scattering lets pass, by Beer's law along and across it.
#[test]
fn a_medium_has_its_density() {
    for (from, to, depth) in
        [("[0, -5, 0.5]", "[0, 5, 0.5]", 4.0 * (-0.5_f64).exp()), ("[0, 0, 6]", "[0, 0, 0]", 1.0 - (-4.0_f64).exp())]
    {
        let ray = scene(&format!(
            "camera: {{camera: radiance_meter, to_world: {{look_at: {to}, from: {from}, up: [1, 0, 0]}}}}
            lights: [{{light: environment, radiance: 1}}]
            media: {{fog: {{medium: my_fog, size: 4, height: 1, sigma_a: 0.7}}}}
            shapes: [{{shape: sphere, radius: 4.5, material: {{material: interface}}, interior: fog}}]"
        ));
        let (found, error) = mean(&film(&ray, "volpath", 256));
        let expected = (-0.7 * depth).exp();
        assert!((found - expected).abs() < 3.5 * error + 1e-4 && error < 0.01, "{found} ± {error}, not {expected}");
    }
}

/// Models whose answers are wrong give wrong pictures, but every render ends, without a value that is no number.
#[test]
fn faulty_models_end_and_enter_no_picture() {
    #[derive(Debug)]
    struct Faulty(f32);
    impl OwnMedium for Faulty {
        fn bounds(&self) -> Bounds3 {
            Bounds3::new(Vec3::splat(-2.0), Vec3::splat(2.0))
        }
        fn density(&self, p: Vec3) -> f32 {
            if p.x > 0.5 { f32::NAN } else { 1.0 }
        }
        fn most(&self, _: &Bounds3) -> f32 {
            self.0
        }
    }
    impl OwnShape for Faulty {
        fn corners(&self) -> [DVec3; 2] {
            [DVec3::splat(-1.0), DVec3::splat(1.0)]
        }
        fn sample(&self, _: DVec3) -> (f64, DVec3) {
            (f64::from(self.0), DVec3::splat(f64::from(self.0)))
        }
        fn first(&self, _: DVec3, _: DVec3, range: [f64; 2]) -> Option<f64> {
            Some(range[0] + f64::from(self.0))
        }
        fn uv(&self, _: DVec3) -> DVec2 {
            DVec2::splat(f64::NAN)
        }
    }
    impl OwnLight for Faulty {
        fn share(&self, _: Vec3) -> f32 {
            self.0
        }
        fn greatest(&self) -> f32 {
            self.0
        }
    }
    impl OwnCamera for Faulty {
        fn ray(&self, film: Vec2, _: Vec2) -> (Vec3, Vec3) {
            let odd = if film.x > 0.5 { f32::NAN } else { self.0 };
            (Vec3::new(0.0, 0.0, odd), Vec3::splat(odd))
        }
    }
    const fn model(kind: &'static str, groups: &'static [&'static Group]) -> Model {
        static VALUE: [Parameter; 1] = [Parameter::new(Type::Number, "value", (-1e38, 1e38), "0", "")];
        Model { kind, doc: "", parameters: &VALUE, groups, source: "" }
    }
    static MEDIUM: Model = model("faulty_medium", &[&medium_parameters::OWN]);
    static SHAPE: Model = model("faulty_shape", &[]);
    static LIGHT: Model = model("faulty_light", &[&light_parameters::OWN]);
    static CAMERA: Model = model("faulty_camera", &[]);
    for value in [0.0, -1.0, 0.1, 1e-30, f32::NAN, f32::INFINITY] {
        let made = move |_: &Values| Ok(Faulty(value));
        let registry = Registry::new().medium(&MEDIUM, made).and_then(|r| r.shape(&SHAPE, made));
        let registry = registry.and_then(|r| r.light(&LIGHT, made)).and_then(|r| r.camera(&CAMERA, made));
        let registry = registry.expect("a registry");
        for camera in ["faulty_camera", "perspective"] {
            let text = format!(
                "steradian: 1, film: {{film: rgb, width: 8, height: 8}}
                camera: {{camera: {camera}, to_world: {{look_at: [0, 0, 0], from: [0, 0, 5], up: [0, 1, 0]}}}}
                media: {{fog: {{medium: faulty_medium, sigma_s: 0.5, sigma_a: 0.1}}}}
                lights: [{{light: environment}}, {{light: faulty_light, position: [0, 0, 3]}}]
                shapes: [{{shape: faulty_shape}},
                    {{shape: sphere, radius: 2, material: {{material: interface}}, interior: fog}}]"
            );
            let loaded = load_bytes("text", text.into_bytes(), Some("steradian"), &registry.reading());
            let scene = Arc::new(loaded.compile(&registry.compiling()).scene.expect("a scene"));
            for integrator in ["volpath", "bdpt", "raycast", "sppm", "mmlt"] {
                let quality = Quality { max_depth: Some(5), ..Quality::of(integrator).spp(4) };
                let picture = registry.render(&scene, &quality).expect("a picture");
                let planes = picture.rgb().expect("colours");
                assert!(
                    [planes.r, planes.g, planes.b].concat().iter().all(|v| v.is_finite()),
                    "{value} {camera} {integrator}"
                );
            }
        }
    }
}

/// The angle from the axis grows with the distance from the middle of the frame; integrators from the light refuse it.
#[test]
fn a_camera_has_its_projection() {
    let scene = scene("camera: {camera: my_fisheye, angle: 180}\nlights: [{light: environment}]");
    for (x, degrees) in [(12.0, 0.0_f32), (18.0, 45.0), (24.0, 90.0), (0.0, 90.0)] {
        let ray = scene.camera().ray(scene.film(), Vec2::new(x, 12.0), Vec2::ZERO);
        assert!((ray.direction.dot(scene.camera().forward()) - degrees.to_radians().cos()).abs() < 1e-5, "{x}");
    }
    let (white, _) = mean(&film(&scene, "path", 4));
    assert!((white - 1.0).abs() < 1e-4, "{white}");
    let refused = registry().plan(&scene, &Quality::of("light"));
    assert!(refused.is_err_and(|e| e.to_string().contains("no inverse")));
}

#[test]
fn a_method_is_named_by_scenes_and_requests() {
    let room = |more: &str| scene(&format!("{more}\n{VIEW}\nshapes: [{{shape: sphere}}, {FLOOR}]"));
    let plain = room("");
    let by_request = film(&plain, "my_openness:near=2", 64);
    agree(&by_request, &film(&plain, "ao:distance=2", 64));
    let named = room("integrator: {integrator: my_openness, near: 2}");
    let mut session = registry()
        .plan(&named, &Quality { seed: Some(3), spp: Some(64), ..Quality::default() })
        .unwrap()
        .session(&named)
        .unwrap();
    session.step(u32::MAX, &Control::default());
    assert_eq!(mean(&session.film()), mean(&by_request));
    let said = |text: &str| registry().plan(&plain, &Quality::of(text)).unwrap_err().to_string();
    assert!(said("my_opennes").contains("did you mean 'my_openness'?"), "{}", said("my_opennes"));
    assert!(said("my_openness:nere=1").contains("'near'"), "{}", said("my_openness:nere=1"));
}

/// pbrt's and Mitsuba's files name them, too.
#[test]
fn other_formats_name_models_of_ones_own() {
    let pbrt = r#"LookAt 0 1 5 0 0 0 0 1 0 Camera "perspective"
        Film "rgb" "integer xresolution" 24 "integer yresolution" 24
        WorldBegin LightSource "infinite" Texture "rings" "spectrum" "my_rings" "float rings" 2 "string palette" "warm"
        Material "my_glossy" "texture diffuse" "rings" "float exponent" 20
        Shape "my_torus" "float radius" 1 "float tube" 0.4"#;
    let xml = r#"<scene version="3.0.0"><sensor type="perspective">
        <transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform></sensor>
        <emitter type="constant"/>
        <shape type="sphere"><bsdf type="my_glossy"><rgb name="diffuse" value="0.1, 0.2, 0.3"/>
        <float name="exponent" value="9"/></bsdf></shape></scene>"#;
    for (format, text) in [("pbrt", pbrt), ("xml", xml)] {
        let (scene, said) = read(format, text);
        let said: Vec<String> = said.iter().map(ToString::to_string).collect();
        assert!(said.is_empty(), "{format}: {said:?}");
        let scene = scene.expect("a scene");
        assert!(mean(&film(&scene, "path", 4)).0 > 0.01, "{format}");
    }
}

/// Faults of a file are told as of built-in models: with their place, and the nearest name.
#[test]
fn faults_are_told_with_their_place() {
    for (text, wanted) in [
        (
            "{shape: sphere, material: {material: my_glossy, difuse: 0.5}}",
            "unused: material 'my_glossy' has no parameter 'difuse'\n --> text:1:72",
        ),
        ("{shape: sphere, material: {material: my_glossy, diffuse: 3}}", "it must be in [0, 1] and is held there"),
        ("{shape: sphere, material: {material: my_glosy}}", "material 'my_glosy' is not implemented"),
        ("{shape: my_torus, tube: 3}", "shape 'my_torus': its tube, 3, is to be above 0 and below its radius, 1"),
        ("{shape: my_toros}", "did you mean 'my_torus'?"),
        (
            "{shape: sphere, material: {material: diffuse, reflectance: {texture: my_rings, palette: cold}}}",
            "'cold' is not a palette; known are grey, warm",
        ),
    ] {
        let (_, said) = read("steradian", &format!("steradian: 1, shapes: [{text}]"));
        let said: Vec<String> = said.iter().map(ToString::to_string).collect();
        assert!(said.iter().any(|m| m.contains(wanted)), "{text}: {said:?}");
    }
}

/// Models that cannot be named, or whose parameters nothing could read, are refused before any scene is read.
#[test]
fn registries_refuse_what_no_scene_can_have() {
    static DIFFUSE: Model = Model { kind: "diffuse", doc: "", parameters: &[], groups: &[], source: "" };
    static FILE: Model = Model {
        kind: "my_files",
        doc: "",
        parameters: &[Parameter::new(Type::File, "file", (0.0, 1.0), "none", "a file")],
        groups: &[],
        source: "",
    };
    static BARE: Model = Model { kind: "my_beam", doc: "", parameters: &[], groups: &[], source: "" };
    let said = |r: Result<Registry, RegistryError>| r.unwrap_err().to_string();
    assert_eq!(said(Registry::new().material(&DIFFUSE, material::Glossy)), "the material 'diffuse' is there already");
    assert!(
        said(Registry::new().material(&FILE, material::Glossy))
            .starts_with("parameter 'file' of material 'my_files' cannot be a file")
    );
    assert!(said(Registry::new().shape(&FILE, shape::Torus::new)).contains("cannot be a file"));
    assert_eq!(
        said(Registry::new().light(&BARE, light::Beam::new)),
        "light 'my_beam' needs the group 'own_light' among its groups"
    );
    assert!(registry().kinds().model(Family::Camera, "my_fisheye").is_some());
    assert!(said(registry().method(&method::MODEL, method::KIND)).contains("'my_openness' is there already"));
}
