//! Laws of emission, over every family of lights.

use std::f32::consts::PI;
use steradian_compile::{Options, compile};
use steradian_core::{
    Scene,
    light::{Isotropic, Light, LightContext, Punctual, emission::Emission},
};
use steradian_math::{
    Vec2, Vec3,
    hash::HashRng,
    spectra::{Wavelengths, role::Color},
    warp,
};
use steradian_scene::{ColorSpace, Family, Format, Mesh, Node, SceneDesc, Shape, SpectrumValue, Value};

fn white(v: f64) -> Value {
    Value::Spectrum(SpectrumValue::Rgb([v; 3], ColorSpace::Srgb))
}

/// A scene of a black unit sphere about the origin, which tells how large the scene is, a small glass ball where a
/// name says so, and one light.
fn scenes() -> Vec<(&'static str, Scene)> {
    let light = |kind: &str| Node::new(Family::Light, kind, None);
    let shape = |kind: &str| Node::new(Family::Shape, kind, None);
    let area = |two_sided: bool| light("area").with("radiance", white(2.0)).with("two_sided", two_sided);
    let quad = || Mesh {
        positions: vec![[0.0, 0.0, 2.0], [0.5, 0.0, 2.0], [0.5, 0.25, 2.0], [0.0, 0.25, 2.0]],
        triangles: vec![[0, 2, 1], [0, 3, 2]].into(),
        ..Mesh::default()
    };
    let triangle = || Mesh { triangles: vec![[0, 2, 1]].into(), ..quad() };
    let portal = Value::from(vec![-0.5, -0.5, 1.5, 0.5, -0.5, 1.5, 0.5, 0.5, 1.5, -0.5, 0.5, 1.5]);
    let mut all = Vec::new();
    let mut add = |name, of: Option<Node>, on: Option<(Option<Mesh>, Node, Node)>| {
        let mut desc = SceneDesc { format: Format::Native, ..SceneDesc::default() };
        let film = desc.add(Node::new(Family::Film, "rgb", None).with("width", 4i64).with("height", 4i64));
        desc.film = Some(film);
        desc.cameras = vec![desc.add(Node::new(Family::Camera, "perspective", None))];
        let sphere = desc.add(shape("sphere"));
        desc.shapes.push(Shape::new(sphere));
        if str::contains(name, "glass") {
            let ball = desc.add(shape("sphere").with("center", [0.2, 0.1, 0.7]).with("radius", 0.25));
            let glass = desc.add(Node::new(Family::Material, "dielectric", None));
            desc.shapes.push(Shape { material: Some(glass), ..Shape::new(ball) });
        }
        if let Some(node) = of {
            let node = desc.add(node);
            desc.lights.push(node);
        }
        if let Some((mesh, node, emission)) = on {
            let (node, emission) = (desc.add(node), desc.add(emission));
            let mesh = mesh.map(|m| desc.add_mesh(m));
            desc.shapes.push(Shape { emission: Some(emission), mesh, ..Shape::new(node) });
        }
        let compiled = compile(&desc, &Options::default());
        let said: Vec<_> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
        all.push((name, compiled.scene.unwrap_or_else(|| panic!("{name}: {said:?}"))));
    };
    add("point", Some(light("point").with("intensity", white(3.0))), None);
    add("spot", Some(light("spot").with("intensity", white(3.0))), None);
    add("distant", Some(light("distant").with("radiance", white(3.0))), None);
    add("projection", Some(light("projection").with("radiance", white(3.0)).with("fov", 60.0)), None);
    add("sky", Some(light("environment").with("radiance", white(0.5))), None);
    add("portal", Some(light("environment").with("radiance", white(0.5)).with("portal", portal)), None);
    add("rectangle", None, Some((Some(quad()), shape("mesh"), area(false))));
    add("triangle", None, Some((Some(triangle()), shape("mesh"), area(false))));
    add("two-sided", None, Some((Some(quad()), shape("mesh"), area(true))));
    add("sphere", None, Some((None, shape("sphere").with("center", [0.0, 0.0, 3.0]).with("radius", 0.5), area(false))));
    // Rays of these are aimed: at the scene, and at glass.
    let far = || shape("sphere").with("center", [0.0, 20.0, 40.0]).with("radius", 0.5);
    add("far sphere", None, Some((None, far(), area(false))));
    add("far sphere over glass", None, Some((None, far(), area(false))));
    add("rectangle over glass", None, Some((Some(quad()), shape("mesh"), area(false))));
    add("point over glass", Some(light("point").with("intensity", white(3.0)).with("position", [0.0, 2.0, 2.0])), None);
    add("distant over glass", Some(light("distant").with("radiance", white(3.0))), None);
    add("sky over glass", Some(light("environment").with("radiance", white(0.5))), None);
    add("disk", None, Some((None, shape("disk").with("radius", 0.5), area(false))));
    let cylinder = shape("cylinder").with("radius", 0.1).with("z_min", -1.0).with("z_max", 0.0);
    add("cylinder", None, Some((None, cylinder, area(false))));
    let along = light("directional_area").with("radiance", white(2.0));
    add("directional", None, Some((Some(quad()), shape("mesh"), along)));
    all
}

/// The flux that samples of emission carry is that of the light in closed form, and [`Emission::pdf`] is the density
/// they come with.
#[test]
fn emitted_flux_is_that_of_the_light() {
    let lambda = Wavelengths::RGB;
    for (name, scene) in scenes() {
        let emission = Emission::new(&scene).expect("a light that emits");
        // Emission of infinite lights comes through a disk a little wider than the scene.
        let r = scene.bounds().bounding_sphere().1 * 1.001;
        let kind = name.trim_end_matches(" over glass");
        let expected = f64::from(match kind {
            "point" => 3.0 * 4.0 * PI,
            "spot" => {
                let Light::Punctual(Punctual::Spot(s)) = &scene.lights().lights[0] else { panic!() };
                3.0 * s.flux_share()
            }
            "distant" => 3.0 * PI * r * r,
            "projection" => {
                let Light::Punctual(Punctual::Projection(p)) = &scene.lights().lights[0] else { panic!() };
                // The solid angle of a rectangle at distance one.
                let (a, b) = (p.half.x, p.half.y);
                let k = p.max_intensity(steradian_core::ColorMode::Rgb);
                4.0 * (a * b / (1.0 + a * a + b * b).sqrt()).atan() * k
            }
            "sky" => 0.5 * 4.0 * PI * PI * r * r,
            "portal" => 0.5 * PI * 2.0,
            "rectangle" => 2.0 * PI * 0.125,
            "triangle" => 2.0 * PI * 0.0625,
            "two-sided" => 4.0 * PI * 0.125,
            "sphere" | "far sphere" => 2.0 * PI * 4.0 * PI * 0.25,
            "disk" => 2.0 * PI * PI * 0.25,
            "cylinder" => {
                let Light::Area(a) = &scene.lights().lights[0] else { panic!() };
                2.0 * PI * a.area()
            }
            "directional" => 2.0 * 0.125,
            other => panic!("{other}"),
        });
        let mut rng = HashRng::new(3);
        let (n, mut sum, mut squares) = (40_000, 0.0_f64, 0.0_f64);
        for _ in 0..n {
            let (u, a, b) = (rng.next_f32(), [rng.next_f32(), rng.next_f32()], [rng.next_f32(), rng.next_f32()]);
            let Some(e) = emission.sample(&scene, u, a.into(), b.into(), &lambda) else { continue };
            let pdf = emission.pdf(&scene, e.light, (e.ray.origin, e.n), e.ray.direction, lambda.time);
            assert!((pdf / e.pdf - 1.0).abs() < 2e-3, "{name}: density {pdf} for {}", e.pdf);
            assert!(
                (e.ray.direction.length() - 1.0).abs() < 1e-4 && (e.cos - e.n.dot(e.ray.direction).abs()).abs() < 1e-3
            );
            let v = f64::from(e.radiance[0] * e.cos / e.pdf);
            sum += v;
            squares += v * v;
        }
        let mean = sum / f64::from(n);
        let sigma = ((squares / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
        assert!((mean - expected).abs() < 4.0 * sigma + 2e-4 * expected, "{name}: {mean} ± {sigma} for {expected}");
    }
}

/// Two ways to count light that reaches a small disk about the scene's centre, without anything between: emission, and
/// the light's own samples for a point.
#[test]
fn emission_and_next_event_estimation_bring_the_same_light() {
    let lambda = Wavelengths::RGB;
    for (name, scene) in scenes() {
        let emission = Emission::new(&scene).expect("a light that emits");
        // A sphere that catches what crosses it on its way in: its irradiance, over all of its surface.
        let (at, size) = (Vec3::new(0.1, -0.05, 0.6), 0.3);
        let mut rng = HashRng::new(12);
        let (n, mut direct, mut squares) = (60_000, 0.0_f64, 0.0_f64);
        let mut numbers = || Vec2::new(rng.next_f32(), rng.next_f32());
        for _ in 0..n {
            let normal = warp::uniform_sphere(numbers());
            let ctx = LightContext { p: at + normal * size, n: Vec3::ZERO };
            let area = 4.0 * PI * size * size;
            let v = match &scene.lights().lights[0] {
                // Scattering finds these.
                Light::Environment(e) if e.sampled_irradiance() <= 0.0 => {
                    let w = warp::uniform_sphere(numbers());
                    e.radiance(ctx.p, w, &lambda)[0] * normal.dot(w).max(0.0) * 4.0 * PI * area
                }
                _ => scene
                    .lights()
                    .sample(0, &ctx, numbers(), &lambda, scene.textures())
                    .map_or(0.0, |s| s.radiance[0] * normal.dot(s.wi).max(0.0) / s.pdf * area),
            };
            direct += f64::from(v);
            squares += f64::from(v * v);
        }
        let direct = direct / f64::from(n);
        let variance = (squares / f64::from(n) - direct * direct) / f64::from(n);
        let (mut emitted, mut squares) = (0.0_f64, 0.0_f64);
        let m = 400_000;
        for _ in 0..m {
            let u = numbers().x;
            let Some(e) = emission.sample(&scene, u, numbers(), numbers(), &lambda) else { continue };
            let (d, o) = (e.ray.direction, at - e.ray.origin);
            let along = o.dot(d);
            let hits = o.length() > size && along > 0.0 && (o - d * along).length() < size;
            let entry = e.ray.at(along - (size * size - (o - d * along).length_squared()).max(0.0).sqrt());
            if hits && scene.lights().reaches(e.light, entry, -d, &lambda) {
                let v = f64::from(e.radiance[0] * e.cos / e.pdf);
                emitted += v;
                squares += v * v;
            }
        }
        let emitted = emitted / f64::from(m);
        let sigma = (variance + (squares / f64::from(m) - emitted * emitted) / f64::from(m)).max(0.0).sqrt();
        assert!(sigma < 0.05 * direct.max(1e-9) || direct == 0.0, "{name}: {direct} ± {sigma} tells nothing");
        assert!((emitted - direct).abs() < 4.0 * sigma + 1e-3 * direct, "{name}: {emitted}, {direct} ± {sigma}");
    }
}

/// Black lights are never chosen; scenes without light emit nothing.
#[test]
fn only_light_is_emitted() {
    let (_, scene) = scenes().remove(0);
    let scene = scene
        .changed(|parts| parts.lights.lights.push(Isotropic { position: Vec3::ZERO, intensity: Color::BLACK }.into()));
    let emission = Emission::new(&scene).expect("a light that emits");
    assert_eq!(emission.pdf(&scene, 1, (Vec3::ZERO, Vec3::Z), Vec3::Z, 0.0), 0.0);
    let scene = scene.changed(|parts| _ = parts.lights.lights.remove(0));
    assert!(Emission::new(&scene).is_none());
}

/// Emission of media may be a number, a colour or a grid; anything else is reported, and so are grids that do not fit
/// their cells.
#[test]
fn glows_and_grids_of_media_count_or_are_refused() {
    let medium = |kind: &str| Node::new(Family::Medium, kind, None);
    let compiled = |medium: Node| {
        let mut desc = SceneDesc { format: Format::Native, ..SceneDesc::default() };
        desc.film = Some(desc.add(Node::new(Family::Film, "rgb", None).with("width", 4i64).with("height", 4i64)));
        desc.cameras = vec![desc.add(Node::new(Family::Camera, "perspective", None))];
        let (medium, sphere) = (desc.add(medium), desc.add(Node::new(Family::Shape, "sphere", None)));
        desc.shapes.push(Shape { interior: Some(medium), is_medium_boundary: true, ..Shape::new(sphere) });
        let compiled = compile(&desc, &Options::default());
        let said: Vec<_> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
        compiled.scene.map(|scene| scene.media()[0].glow.is_some()).ok_or_else(|| said.join("; "))
    };
    let eight = |v: f64| Value::Floats(vec![v; 8]);
    let grid = |kind: &str| medium(kind).with("nx", 2i64).with("ny", 2i64).with("nz", 2i64);
    for le in [Value::Float(2.0), Value::Int(1), white(2.0)] {
        for node in [medium("homogeneous"), grid("uniformgrid").with("density", eight(1.0)), medium("cloud")] {
            assert_eq!(compiled(node.with("Le", le.clone())), Ok(true));
        }
        assert!(
            compiled(grid("rgbgrid").with("Le", le)).unwrap_err().contains("'Le' of medium 'rgbgrid' must be a list")
        );
    }
    assert_eq!(compiled(medium("homogeneous")), Ok(false));
    assert_eq!(compiled(grid("rgbgrid").with("Le", Value::Floats(vec![1.0; 24]))), Ok(true));
    assert!(compiled(medium("homogeneous").with("Le", "bright")).unwrap_err().contains("'Le'"));
    assert!(compiled(grid("uniformgrid")).unwrap_err().contains("needs the parameter 'density'"));
    assert!(compiled(medium("rgbgrid").with("nx", 0i64)).unwrap_err().contains("'nx' of medium 'rgbgrid' is 0"));
    assert!(
        compiled(medium("uniformgrid").with("density", eight(1.0))).unwrap_err().contains("'density' has 8 numbers")
    );
}

/// An environment's picture comes times its `radiance`, grey, coloured or a spectrum by its luminance.
#[test]
fn pictures_of_environments_take_their_factor() {
    let seen = |factor: Option<Value>| {
        let mut desc = SceneDesc { format: Format::Native, ..SceneDesc::default() };
        let mut bytes = b"PF\n4 2\n-1.0\n".to_vec();
        (0..24).for_each(|k| bytes.extend([0.25_f32, 0.5, 2.0][k % 3].to_le_bytes()));
        desc.embedded.insert("sky.pfm".into(), bytes.into());
        let mut node = Node::new(Family::Light, "environment", None).with("file", std::path::PathBuf::from("sky.pfm"));
        if let Some(factor) = factor {
            node = node.with("radiance", factor);
        }
        let node = desc.add(node);
        desc.lights.push(node);
        desc.cameras = vec![desc.add(Node::new(Family::Camera, "perspective", None))];
        let sphere = desc.add(Node::new(Family::Shape, "sphere", None));
        desc.shapes.push(Shape::new(sphere));
        let compiled = compile(&desc, &Options::default());
        let Some(scene) = compiled.scene else { panic!("{:?}", compiled.diagnostics) };
        let Light::Environment(e) = &scene.lights().lights[0] else { panic!() };
        e.radiance(Vec3::ZERO, Vec3::new(0.6, 0.0, 0.8), &Wavelengths::RGB).to_rgb()
    };
    let [r, g, b] = seen(None);
    assert_eq!([r, g, b], [0.25, 0.5, 2.0]);
    assert_eq!(seen(Some(white(0.5))), [0.5 * r, 0.5 * g, 0.5 * b]);
    let tint = Value::Spectrum(SpectrumValue::Rgb([2.0, 1.0, 0.25], ColorSpace::Srgb));
    assert_eq!(seen(Some(tint)), [2.0 * r, g, 0.25 * b]);
    let [warm, _, _] = seen(Some(Value::Spectrum(SpectrumValue::Constant(3.0))));
    assert!((warm - 3.0 * r).abs() < 1e-6);
}
