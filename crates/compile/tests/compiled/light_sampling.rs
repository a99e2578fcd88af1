//! Every light's sampler against its own density: χ² over the sphere of directions, at one percent over all cases
//! together (Šidák), and `∫ pdf = 1` (M72, M74, M78).

use std::{f64::consts::TAU, sync::Arc};
use steradian_compile::{Options, compile};
use steradian_core::{
    ColorMode, Scene,
    light::{
        Environment, LightContext,
        environment::{EnvironmentImage, Parametrization},
    },
};
use steradian_image::{Encoding, TexelData, Texels};
use steradian_math::{
    DVec3, Frame, Ray, Transform, Vec2, Vec3,
    hash::HashRng,
    spectra::{Wavelengths, role::Color},
};
use steradian_scene::{ColorSpace, Family, Mesh, Node, SceneDesc, Shape, SpectrumValue, Value};
use steradian_testkit::{chi2_test, sidak};

const SAMPLES: u64 = 40_000;
const LAMBDA: Wavelengths = Wavelengths::RGB;

/// A light that can be drawn from, as seen from a point.
struct Case {
    name: String,
    /// Directions with the density they came with; `None` for a draw that brings no light.
    sample: Box<dyn Fn(Vec2) -> Option<(Vec3, f32)>>,
    /// The density that a direction should have.
    density: Box<dyn Fn(Vec3) -> f64>,
    /// True if every draw brings light, so that the density integrates to one.
    complete: bool,
}

/// A scene of one lamp.
fn lamp(node: Node, mesh: Option<Mesh>, place: Transform, two_sided: bool, reverse: bool) -> Scene {
    let mut desc = SceneDesc::default();
    let white = Value::Spectrum(SpectrumValue::Rgb([1.0; 3], ColorSpace::Srgb));
    let emission = Node::new(Family::Light, "area", None).with("radiance", white).with("two_sided", two_sided);
    let (node, emission) = (desc.add(node), desc.add(emission));
    let mesh = mesh.map(|m| desc.add_mesh(m));
    desc.shapes.push(Shape {
        mesh,
        world_from_object: place,
        reverse_orientation: reverse,
        emission: Some(emission),
        ..Shape::new(node)
    });
    let camera = desc.add(Node::new(Family::Camera, "perspective", None));
    desc.cameras.push(camera);
    let compiled = compile(&desc, &Options::default());
    let said: Vec<String> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
    compiled.scene.unwrap_or_else(|| panic!("{said:?}"))
}

/// The light of a lamp from a point: drawn by choice of one of its lights, held against the sum over all its surfaces
/// in a direction.
fn seen_from(name: &str, scene: Scene, p: Vec3, complete: bool) -> Case {
    let ctx = LightContext { p, n: Vec3::ZERO };
    let scene = Arc::new(scene);
    let other = scene.clone();
    let sample = move |u: Vec2| {
        // The choice of a light takes its number from the first coordinate, and gives it back stretched.
        let n = other.lights().lights.len() as f32;
        let light = ((u.x * n) as u32).min(n as u32 - 1);
        let u = Vec2::new((u.x * n - light as f32).clamp(0.0, 1.0 - f32::EPSILON), u.y);
        let s = other.lights().sample(light, &ctx, u, &LAMBDA, other.textures())?;
        Some((s.wi, s.pdf / n))
    };
    let density = move |w: Vec3| {
        let n = scene.lights().lights.len() as f64;
        let (mut ray, mut sum) = (Ray::new(p, w), 0.0);
        for _ in 0..8 {
            let Some(hit) = scene.intersect(&ray) else { break };
            let i = scene.interaction(&ray, &hit);
            let geometry = &scene.geometries()[i.geometry as usize];
            let (emitter, light) = (geometry.emitter.expect("a lamp"), geometry.light(i.id.prim).expect("a light"));
            let at = || scene.texture_context(&i);
            let shines =
                scene.lights().emitters[emitter as usize].radiance(i.surface.n, i.wo, at, &LAMBDA, scene.textures());
            if !shines.is_black() {
                // The density of the light alone: that of its choice is divided out.
                let chosen = scene.lights().probability(&ctx, light);
                let pdf = scene.lights().area_pdf(light, &ctx, (w, (i.surface.p - p).length()), i.surface.n, 0.0);
                sum += f64::from(pdf / chosen) / n;
            }
            ray = i.spawn(w);
        }
        sum
    };
    Case { name: name.into(), sample: Box::new(sample), density: Box::new(density), complete }
}

fn shape(kind: &str) -> Node {
    Node::new(Family::Shape, kind, None)
}

fn mesh(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Option<Mesh> {
    Some(Mesh { positions: points.to_vec(), triangles: triangles.to_vec().into(), ..Mesh::default() })
}

/// Surfaces of every kind, from points for which they look large and small.
fn surfaces() -> Vec<Case> {
    let here = Transform::IDENTITY;
    let mut cases = Vec::new();
    let triangle = || {
        lamp(
            shape("mesh"),
            mesh(&[[-1.0, -1.0, 0.0], [1.0, -0.7, 0.2], [0.1, 1.0, -0.3]], &[[0, 1, 2]]),
            here,
            true,
            false,
        )
    };
    for (at, p) in
        [("near", Vec3::new(0.1, 0.0, 0.4)), ("beside", Vec3::new(1.5, 0.2, 0.3)), ("far", Vec3::new(3.0, 2.0, 12.0))]
    {
        cases.push(seen_from(&format!("triangle, {at}"), triangle(), p, true));
    }
    let rectangle = |two_sided| {
        let corners = [[-1.0, -0.5, 0.0], [1.0, -0.5, 0.0], [1.0, 0.5, 0.0], [-1.0, 0.5, 0.0]];
        lamp(shape("mesh"), mesh(&corners, &[[0, 1, 2], [0, 2, 3]]), here, two_sided, false)
    };
    assert_eq!(rectangle(true).lights().lights.len(), 1, "two triangles that make a rectangle are one light");
    for (at, p) in
        [("near", Vec3::new(0.3, -0.2, 0.2)), ("beside", Vec3::new(2.0, 1.0, 0.5)), ("far", Vec3::new(-4.0, 5.0, 20.0))]
    {
        cases.push(seen_from(&format!("rectangle, {at}"), rectangle(true), p, true));
    }
    cases.push(seen_from("rectangle, one side", rectangle(false), Vec3::new(0.3, -0.2, 0.8), true));
    let fan = mesh(
        &[[0.0, 0.2, 1.0], [1.0, -0.3, 0.5], [-0.2, -1.0, 0.7], [-1.0, 0.1, 0.9], [0.1, 1.0, 0.6]],
        &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]],
    );
    cases.push(seen_from(
        "fan of triangles",
        lamp(shape("mesh"), fan, here, true, false),
        Vec3::new(0.1, 0.1, 0.0),
        true,
    ));
    let sphere = |reverse| {
        let place = Transform::translate(DVec3::new(0.5, 0.0, 0.2)) * Transform::scale(DVec3::splat(0.5));
        lamp(shape("sphere").with("radius", 2.0), None, place, false, reverse)
    };
    for (at, p) in [
        ("near", Vec3::new(0.5, 1.002, 0.2)),
        ("far", Vec3::new(4.0, -3.0, 5.0)),
        ("middling", Vec3::new(2.0, 0.5, 0.0)),
    ] {
        cases.push(seen_from(&format!("sphere, {at}"), sphere(false), p, true));
    }
    cases.push(seen_from("sphere, within", sphere(true), Vec3::new(0.9, 0.3, 0.5), true));
    cases.push(seen_from(
        "disk",
        lamp(shape("disk").with("radius", 1.0), None, here, true, false),
        Vec3::new(0.4, 0.3, 0.8),
        true,
    ));
    let ring = shape("disk").with("radius", 1.0).with("inner_radius", 0.4).with("phi_max", 200.0);
    let squeeze = Transform::scale(DVec3::new(1.5, 0.6, 1.0));
    cases.push(seen_from(
        "part of a ring, squeezed",
        lamp(ring, None, squeeze, true, false),
        Vec3::new(0.4, 0.3, 0.8),
        true,
    ));
    let cylinder = |two_sided, reverse| {
        let node = shape("cylinder").with("radius", 0.6).with("z_min", -1.0).with("z_max", 0.8).with("phi_max", 300.0);
        lamp(node, None, here, two_sided, reverse)
    };
    cases.push(seen_from("cylinder, outside", cylinder(false, false), Vec3::new(1.2, 0.4, 0.3), false));
    // Both sides shine, but from where an outline shows both, the density has no bound there: too much for quadrature.
    cases.push(seen_from("cylinder, from its end", cylinder(true, false), Vec3::new(0.1, 0.2, 1.5), true));
    cases.push(seen_from("cylinder, within", cylinder(false, true), Vec3::new(0.1, 0.2, 0.0), true));
    let part = |two_sided| {
        let node = shape("sphere").with("radius", 1.0).with("z_min", -0.5).with("z_max", 0.8).with("phi_max", 250.0);
        lamp(node, None, here, two_sided, false)
    };
    cases.push(seen_from("part of a sphere", part(false), Vec3::new(1.5, 0.9, 0.7), false));
    cases.push(seen_from("part of a sphere, both sides, within", part(true), Vec3::new(0.2, 0.3, 0.1), true));
    let egg = lamp(shape("sphere"), None, Transform::scale(DVec3::new(1.0, 0.5, 0.7)), false, false);
    cases.push(seen_from("egg", egg, Vec3::new(1.5, 0.9, 0.7), false));
    let cone = lamp(shape("cone"), None, squeeze, false, false);
    cases.push(seen_from("cone, squeezed", cone, Vec3::new(1.6, 0.9, 1.1), false));
    cases
}

/// A sky with bright spots, in every parametrisation, and constant skies through portals.
fn environments() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: String, sky: Environment, p: Vec3| {
        let sky = Arc::new(sky);
        let other = sky.clone();
        cases.push(Case {
            name,
            sample: Box::new(move |u| sky.sample(p, u)),
            density: Box::new(move |w| f64::from(other.pdf(p, w))),
            complete: true,
        });
    };
    let sky = |image, portal| {
        let (radiance, celestial) = (Color::constant(1.0), None);
        Environment { radiance, scale: 1.0, image, celestial, portal, mode: ColorMode::Rgb }
    };
    let image = |parametrization, seed, power: i32| {
        let (width, height) = if parametrization == Parametrization::Octahedral { (12, 12) } else { (16, 8) };
        let mut rng = HashRng::new(seed);
        let data = (0..width * height * 3).map(|_| 0.1 + rng.next_f32().powi(power)).collect();
        let (data, encoding) = (TexelData::F32(data), Encoding::Linear);
        let texels = Texels { width, height, channels: 3, data, encoding, metadata: Default::default() };
        let turn = Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 0.7).affine().expect("a rotation");
        EnvironmentImage::new(texels, parametrization, turn)
    };
    for parametrization in
        [Parametrization::Octahedral, Parametrization::LatLongY { poles: true }, Parametrization::LatLongZ]
    {
        for (seed, power) in [(1, 1), (2, 6)] {
            let name = format!("{parametrization:?}, power {power}");
            add(name, sky(Some(image(parametrization, seed, power)), None), Vec3::ZERO);
        }
    }
    let portal = [Vec3::new(-0.5, -1.0, 1.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)];
    for (at, p) in [("before", Vec3::ZERO), ("close", Vec3::new(0.4, 0.9, 0.95)), ("behind", Vec3::new(0.5, 0.0, 3.0))]
    {
        add(format!("portal, {at}"), sky(None, Some(portal)), p);
    }
    add(
        "image through a portal".into(),
        sky(Some(image(Parametrization::LatLongY { poles: true }, 3, 3)), Some(portal)),
        Vec3::new(0.2, 0.1, 0.3),
    );
    cases
}

/// Cells of equal solid angle in the cone around the directions that a light takes up.
struct Cone {
    frame: Frame,
    /// `1 − cos` of its half angle.
    extent: f64,
}

impl Cone {
    const RINGS: usize = 12;
    const SECTORS: usize = 24;
    /// Points per cell and axis of the quadrature.
    const POINTS: usize = 64;

    /// The cone that holds all of some directions, with a margin.
    fn around(directions: &[Vec3]) -> Self {
        let axis = directions.iter().sum::<Vec3>().normalize_or(Vec3::Z);
        let extent = directions.iter().map(|w| 0.5 * f64::from((*w - axis).length_squared())).fold(0.0, f64::max);
        Self { frame: Frame::from_z(axis), extent: (extent * 1.1).min(2.0) }
    }

    /// `1 − cos` of the angle from the axis as a part of the cone's, and the azimuth as a part of the turn.
    fn coordinates(&self, w: Vec3) -> (f64, f64) {
        let local = self.frame.to_local(w).as_dvec3();
        let away = 0.5 * (local.x * local.x + local.y * local.y + (1.0 - local.z).powi(2));
        (away / self.extent, (local.y.atan2(local.x) / TAU).rem_euclid(1.0))
    }

    fn cell(&self, w: Vec3) -> Option<usize> {
        let (r, a) = self.coordinates(w);
        let ring = (r * Self::RINGS as f64) as usize;
        (ring < Self::RINGS)
            .then(|| ring * Self::SECTORS + ((a * Self::SECTORS as f64) as usize).min(Self::SECTORS - 1))
    }

    fn direction(&self, r: f64, a: f64) -> Vec3 {
        let away = r * self.extent;
        let sin = (away * (2.0 - away)).max(0.0).sqrt();
        let (s, c) = (a * TAU).sin_cos();
        self.frame.to_world(DVec3::new(sin * c, sin * s, 1.0 - away).as_vec3()).normalize()
    }

    /// The integral of a density over each cell, by jittered points: edges that cut through cells leave a random error
    /// far below that of the samples.
    fn integrate(&self, density: impl Fn(Vec3) -> f64) -> Vec<f64> {
        let mut rng = HashRng::new(7);
        let measure = self.extent * TAU / (Self::RINGS * Self::SECTORS * Self::POINTS * Self::POINTS) as f64;
        let mut cell = |ring: usize, sector: usize| {
            let mut sum = 0.0;
            for k in 0..Self::POINTS * Self::POINTS {
                let x = ((k / Self::POINTS) as f64 + f64::from(rng.next_f32())) / Self::POINTS as f64;
                let y = ((k % Self::POINTS) as f64 + f64::from(rng.next_f32())) / Self::POINTS as f64;
                sum += density(
                    self.direction((ring as f64 + x) / Self::RINGS as f64, (sector as f64 + y) / Self::SECTORS as f64),
                );
            }
            sum * measure
        };
        (0..Self::RINGS * Self::SECTORS).map(|i| cell(i / Self::SECTORS, i % Self::SECTORS)).collect()
    }
}

/// Samples fall where the density says, come with the density that is evaluated there, and none are lost.
#[track_caller]
fn follow_their_densities(cases: &[Case]) {
    let level = sidak(0.01, cases.len());
    for (k, case) in cases.iter().enumerate() {
        let mut rng = HashRng::new(100 + k as u64);
        let draws: Vec<(Vec3, f32)> =
            (0..SAMPLES).filter_map(|_| (case.sample)(Vec2::new(rng.next_f32(), rng.next_f32()))).collect();
        let directions: Vec<Vec3> = draws.iter().map(|d| d.0).collect();
        let cone = Cone::around(&directions);
        let mut counts = vec![0_u64; Cone::RINGS * Cone::SECTORS];
        let mut disagreeing = 0;
        for (w, pdf) in &draws {
            assert!((w.length() - 1.0).abs() < 1e-4 && *pdf > 0.0, "{}: {w} with {pdf}", case.name);
            counts[cone.cell(*w).expect("the cone holds all")] += 1;
            // Where a direction meets several surfaces, the sample's density is a part of the whole; at edges rounding
            // decides.
            if f64::from(*pdf) > (case.density)(*w) * 1.02 + 1e-6 {
                disagreeing += 1;
            }
        }
        assert!(
            disagreeing * 200 < SAMPLES,
            "{}: {disagreeing} samples have more density than their directions",
            case.name
        );
        let mass = cone.integrate(&case.density);
        let total: f64 = mass.iter().sum();
        if case.complete {
            assert!((total - 1.0).abs() < 3e-3, "{}: the density integrates to {total}", case.name);
            assert!(draws.len() as u64 * 1000 > SAMPLES * 999, "{}: {} samples of {SAMPLES}", case.name, draws.len());
        } else {
            assert!(total < 1.0 + 3e-3, "{}: the density integrates to {total}", case.name);
        }
        let expected: Vec<f64> = mass.iter().map(|m| m * SAMPLES as f64).collect();
        let chi2 = chi2_test(&counts, &expected, SAMPLES);
        assert!(chi2.p_value > level && chi2.degrees > 20, "{}: {chi2:?} at level {level:.2e}", case.name);
    }
}

#[test]
fn surfaces_follow_their_densities() {
    follow_their_densities(&surfaces());
}

#[test]
fn environments_follow_their_densities() {
    follow_their_densities(&environments());
}

/// M75: lights are chosen with the probability that is said, at points among them, before surfaces of any orientation
/// and in volumes: χ² over the lights, and the probabilities of all with what is left for none add up to one.
#[test]
fn lights_are_chosen_with_their_probability() {
    use steradian_core::light::{Isotropic, Light, Lights};
    let mut rng = HashRng::new(3);
    let mut lights: Vec<Light> = (0..60)
        .map(|_| {
            let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 8.0 - 4.0;
            Isotropic { position: p, intensity: Color::constant(rng.next_f32().powi(4)) }.into()
        })
        .collect();
    lights.push(Light::Distant(Vec3::Y, Color::constant(0.02)));
    lights.push(Light::Distant(-Vec3::X, Color::constant(0.01)));
    let lights = Lights::new(lights, Vec::new(), ColorMode::Rgb);
    let contexts: Vec<LightContext> = (0..40)
        .map(|i| {
            let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 12.0 - 6.0;
            let n = Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5).normalize();
            LightContext { p, n: if i % 3 == 0 { Vec3::ZERO } else { n } }
        })
        .collect();
    let level = sidak(0.01, contexts.len());
    for ctx in &contexts {
        let mut counts = vec![0_u64; 62];
        for _ in 0..SAMPLES {
            if let Some((light, p)) = lights.choose(ctx, rng.next_f32()) {
                counts[light as usize] += 1;
                assert!((p / lights.probability(ctx, light) - 1.0).abs() < 1e-4);
            }
        }
        let expected: Vec<f64> = (0..62).map(|l| f64::from(lights.probability(ctx, l)) * SAMPLES as f64).collect();
        let chi2 = chi2_test(&counts, &expected, SAMPLES);
        let few = if ctx.n == Vec3::ZERO { 20 } else { 1 };
        assert!(chi2.p_value > level && chi2.degrees >= few, "{ctx:?}: {chi2:?}");
    }
}
