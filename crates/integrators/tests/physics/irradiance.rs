//! Irradiance from lights of every shape against closed forms and quadrature, by three ways of finding light:
//! next-event estimation alone (`whitted` asks every light once at a diffuse surface), scattering alone, and both with
//! multiple importance sampling (`direct`).

use crate::{
    shot::{Shot, is_exactly, mean},
    stage::{Stage, diffuse, found_by_scattering_alone, rectangle, shape, sphere},
};
use std::f64::consts::PI;
use steradian_core::{
    ColorMode, Scene,
    light::{
        Environment, Light, Lights,
        environment::{EnvironmentImage, Parametrization},
    },
    sampler::{Sampler, SamplerKind},
};
use steradian_image::{Encoding, TexelData, Texels};
use steradian_integrators::{Counters, Depth, Integrator, PathContext, path::PathTracer};
use steradian_math::{
    DVec3, Ray, Transform, Vec3,
    hash::HashRng,
    spectra::{Wavelengths, role::Color},
};
use steradian_scene::Mesh;

/// The point that receives light, and its normal.
const AT: [f64; 3] = [0.3, -0.2, 0.5];

/// A lamp of radiance one over a small white receiver at [`AT`] that faces +z, with a probe that looks at it from
/// `height` above. Positions of lamps are relative to the receiver.
fn receiver(height: f64) -> Stage {
    let mut stage = Stage::new();
    stage.solid(shape("disk").with("radius", 1e-3), diffuse(1.0)).world_from_object =
        Transform::translate(DVec3::from_array(AT));
    stage.probe([AT[0] + 0.2 * height, AT[1] + 0.1 * height, AT[2] + height], AT);
    stage
}

fn at(p: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| p[i] + AT[i])
}

/// The three estimates of irradiance, each within 4σ of `expected`. `by_chance` is the share of directions that meet
/// the light: scattering alone is not asked about lights that it hardly finds.
#[track_caller]
fn check(stage: &Stage, what: &str, expected: f64, by_chance: bool) {
    let scene = stage.scene();
    for (integrator, spp) in [("whitted", 20_000), ("direct", 20_000)] {
        let e = mean(&Shot::of(integrator, spp).take(&scene)).times(PI);
        e.is_near_grey(&format!("{what}, {integrator}"), expected, 0.02);
    }
    if by_chance {
        let e = mean(&Shot::of("direct", 60_000).take(&found_by_scattering_alone(scene))).times(PI);
        e.is_near_grey(&format!("{what}, scattering alone"), expected, 0.03);
    }
}

/// Irradiance from a polygon of radiance one on a surface at the origin that faces +z: Lambert's formula `½ Σ Γᵢ·z`
/// over the edges of what is above the horizon (Lambert 1760; Baum et al. 1989).
fn lambert(polygon: &[DVec3]) -> f64 {
    let mut above = Vec::new();
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if a.z >= 0.0 {
            above.push(a);
        }
        if (a.z > 0.0) != (b.z > 0.0) && a.z != b.z {
            above.push(a + (b - a) * (a.z / (a.z - b.z)));
        }
    }
    let edge = |i: usize| {
        let (a, b) = (above[i].normalize(), above[(i + 1) % above.len()].normalize());
        let across = a.cross(b);
        if across.length() < 1e-15 { 0.0 } else { a.angle_between(b) * across.normalize().z }
    };
    (0..above.len()).map(edge).sum::<f64>().abs() * 0.5
}

/// M66, M72: a disk of radius r over a point at height h and distance a from its axis gives E = π/2 (1 − (a² + h² −
/// r²)/√((a² + h² + r²)² − 4a²r²)); for L = r = h = 1 on the axis E = π/2.
#[test]
fn disk() {
    for (r, h, a) in [(1.0, 1.0, 0.0), (1.0, 0.05, 0.3), (1.0, 2.0, 1.5), (0.1, 5.0, 0.0)] {
        let (r, h, a): (f64, f64, f64) = (r, h, a);
        let s = a * a + h * h;
        let expected = PI / 2.0 * (1.0 - (s - r * r) / ((s + r * r).powi(2) - 4.0 * a * a * r * r).sqrt());
        if a == 0.0 && h == 1.0 {
            assert!((expected - PI / 2.0).abs() < 1e-12);
        }
        let mut stage = receiver(h * 0.5);
        let lamp = stage.lamp(shape("disk").with("radius", r), 1.0);
        // Its normal +z is turned down.
        (lamp.world_from_object, lamp.reverse_orientation) =
            (Transform::translate(DVec3::from_array(at([a, 0.0, h]))), true);
        check_area_sampled(&stage, &format!("disk of {r} at {h}, {a} aside"), expected, r > 0.5 * h);
    }
}

/// [`check`] for shapes that are sampled by area: the nearer they are, the wider their estimates spread.
#[track_caller]
fn check_area_sampled(stage: &Stage, what: &str, expected: f64, by_chance: bool) {
    let scene = stage.scene();
    for (integrator, spp) in [("whitted", 100_000), ("direct", 40_000)] {
        let e = mean(&Shot::of(integrator, spp).take(&scene)).times(PI);
        e.is_near_grey(&format!("{what}, {integrator}"), expected, 0.06);
    }
    if by_chance {
        let e = mean(&Shot::of("direct", 60_000).take(&found_by_scattering_alone(scene))).times(PI);
        e.is_near_grey(&format!("{what}, scattering alone"), expected, 0.03);
    }
}

/// M72: rectangles, from one that fills the view (sampled by solid angle) to one that is a point (sampled by area),
/// slanted, and half below the horizon.
#[test]
fn rectangles() {
    let mut cases = vec![
        ([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]),
        ([-1.0, -1.0, 0.02], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]),
        ([-0.2, 0.1, 30.0], [0.0, 0.5, 0.0], [0.5, 0.0, 0.0]),
        ([0.5, 0.5, 0.5], [0.0, 1.0, 0.0], [3.0, 0.0, 0.0]),
        // A wall that stands on the ground, and one that reaches below it.
        ([1.0, -1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]),
        ([1.0, -1.0, -2.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]),
    ];
    // A slanted one that is long and thin.
    cases.push(([-2.0, 0.3, 0.4], [0.0, 0.1, 0.1], [4.0, 0.0, 0.0]));
    for (corner, ex, ey) in cases {
        let polygon: Vec<DVec3> = {
            let (c, x, y) = (DVec3::from_array(corner), DVec3::from_array(ex), DVec3::from_array(ey));
            vec![c, c + x, c + x + y, c + y]
        };
        let mut stage = receiver(0.004);
        stage.mesh_lamp(rectangle(at(corner), ex, ey), 1.0);
        let facing = DVec3::from_array(ex).cross(DVec3::from_array(ey)).dot(DVec3::from_array(corner)) < 0.0;
        stage.desc.shapes.last_mut().expect("the lamp").reverse_orientation = !facing;
        let expected = lambert(&polygon);
        check(&stage, &format!("rectangle at {corner:?}"), expected, expected > 0.1);
    }
}

/// M72: triangles alone, and meshes of many: a lamp of triangles that make no rectangles.
#[test]
fn triangles() {
    let cases: [&[[f64; 3]]; 4] = [
        &[[-1.0, -1.0, 0.8], [-0.5, 1.2, 1.0], [1.3, 0.1, 0.6]],
        &[[-1.0, -1.0, 0.03], [-0.5, 1.2, 0.03], [1.3, 0.1, 0.03]],
        &[[3.0, 0.0, 20.0], [3.0, 0.7, 20.0], [3.6, 0.0, 20.0]],
        // A fan of four around a point.
        &[[0.0, 0.2, 1.0], [1.0, -0.3, 0.5], [-0.2, -1.0, 0.7], [-1.0, 0.1, 0.9], [0.1, 1.0, 0.6]],
    ];
    for points in cases {
        let p: Vec<DVec3> = points.iter().map(|p| DVec3::from_array(*p)).collect();
        let triangles: Vec<[u32; 3]> = match p.len() {
            3 => vec![[0, 1, 2]],
            n => (1..n as u32).map(|i| [0, i, if i as usize == n - 1 { 1 } else { i + 1 }]).collect(),
        };
        let expected = triangles.iter().map(|t| lambert(&t.map(|i| p[i as usize]))).sum();
        let positions = points.iter().map(|p| at(*p).map(|v| v as f32)).collect();
        let mut stage = receiver(0.004);
        let emission =
            stage.add(crate::stage::light("area").with("radiance", crate::stage::white(1.0)).with("two_sided", true));
        stage.mesh_lamp(Mesh { positions, triangles: triangles.into(), ..Mesh::default() }, 1.0).emission =
            Some(emission);
        check(&stage, &format!("triangles at {:?}", points[0]), expected, expected > 0.1);
    }
}

/// M72: a sphere of radius r at distance d wholly above the horizon gives E = π (r/d)² cos θ; from the inside it gives
/// π.
#[test]
fn spheres() {
    for (center, r) in
        [([0.0, 0.0, 1.5], 1.0), ([0.0, 0.0, 1.01], 1.0), ([2.0, 1.0, 2.0], 0.5), ([0.0, 30.0, 40.0], 0.5)]
    {
        let c = DVec3::from_array(center);
        let expected = PI * r * r / c.length_squared() * c.z / c.length();
        let mut stage = receiver(0.004);
        stage.lamp(sphere(at(center), r), 1.0);
        check(&stage, &format!("sphere at {center:?}"), expected, expected > 0.1);
    }
    for center in [[0.0, 0.0, 0.0], [0.5, -1.0, 0.3]] {
        let mut stage = receiver(0.1);
        stage.lamp(sphere(at(center), 3.0), 1.0).reverse_orientation = true;
        check(&stage, "inside a sphere", PI, true);
    }
}

/// M72: a luminous tube around the receiver that stands on its plane gives E = π h²/(r² + h²): all but the disk at its
/// end.
#[test]
fn cylinder_from_within() {
    for (r, h) in [(1.0, 1.0), (0.5, 4.0)] {
        let mut stage = receiver(0.02);
        let tube = shape("cylinder").with("radius", r).with("z_min", 0.0).with("z_max", h);
        let lamp = stage.lamp(tube, 1.0);
        (lamp.world_from_object, lamp.reverse_orientation) = (Transform::translate(DVec3::from_array(AT)), true);
        check_area_sampled(&stage, &format!("tube of {r} by {h}"), PI * h * h / (r * r + h * h), true);
    }
}

/// `∫ cos cos' / d² dA` over a surface given by its points, normals and area elements on a grid: the irradiance at the
/// origin facing +z where the surface does not hide itself.
fn quadrature(surface: impl Fn(f64, f64) -> (DVec3, DVec3, f64)) -> f64 {
    let n = 1500;
    let cell = |i: usize, j: usize| {
        let (p, normal, da) = surface((i as f64 + 0.5) / n as f64, (j as f64 + 0.5) / n as f64);
        let d = p.length();
        let (cos, cos_light) = (p.z / d, -normal.dot(p) / d);
        if cos > 0.0 && cos_light > 0.0 { cos * cos_light * da / (d * d) } else { 0.0 }
    };
    (0..n * n).map(|k| cell(k / n, k % n)).sum::<f64>() / (n * n) as f64
}

/// M72: a cylinder seen from outside and a part of a sphere (cut in z and φ, open side away), against quadrature in
/// double precision.
#[test]
fn curved_parts() {
    let (r, z0, z1, center) = (0.4, -0.7, 1.2, DVec3::new(0.8, 0.9, 1.5));
    let expected = quadrature(|u, v| {
        let n = DVec3::new((u * 2.0 * PI).cos(), (u * 2.0 * PI).sin(), 0.0);
        (center + n * r + DVec3::Z * (z0 + v * (z1 - z0)), n, 2.0 * PI * r * (z1 - z0))
    });
    let mut stage = receiver(0.1);
    let node = shape("cylinder").with("radius", r).with("z_min", z0).with("z_max", z1);
    stage.lamp(node, 1.0).world_from_object = Transform::translate(center + DVec3::from_array(AT));
    check_area_sampled(&stage, "cylinder from outside", expected, true);

    // The lower cap of a sphere, three quarters of the turn; only the outside shines.
    let (r, z0, z1, turn, center) = (0.9, -0.9, -0.3, 1.5 * PI, DVec3::new(0.3, 0.2, 1.6));
    let expected = quadrature(|u, v| {
        let z = z0 + v * (z1 - z0);
        let rho = (r * r - z * z).sqrt();
        let p = DVec3::new(rho * (u * turn).cos(), rho * (u * turn).sin(), z);
        (center + p, p / r, turn * r * (z1 - z0))
    });
    let mut stage = receiver(0.1);
    let node = sphere([0.0; 3], r).with("z_min", z0).with("z_max", z1).with("phi_max", turn.to_degrees());
    stage.lamp(node, 1.0).world_from_object = Transform::translate(center + DVec3::from_array(AT));
    check_area_sampled(&stage, "part of a sphere", expected, true);
}

/// M72: a lamp shines on the side of its normal alone, or on both where it is two-sided. Black is exact.
#[test]
fn sides_of_lamps() {
    let expected = lambert(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 1.0)));
    for two_sided in [false, true] {
        for reverse in [false, true] {
            let mut stage = receiver(0.1);
            let emission = stage.add(
                crate::stage::light("area").with("radiance", crate::stage::white(1.0)).with("two_sided", two_sided),
            );
            let lamp = stage.mesh_lamp(rectangle(at([-1.0, -1.0, 1.0]), [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), 1.0);
            (lamp.emission, lamp.reverse_orientation) = (Some(emission), reverse);
            if reverse || two_sided {
                check(&stage, "towards the receiver", expected, true);
            } else {
                for integrator in ["whitted", "direct"] {
                    is_exactly(&Shot::of(integrator, 64).take(&stage.scene()), "away from the receiver", [0.0; 3]);
                }
            }
        }
    }
}

/// M74: a constant sky through a portal lights like a rectangle of its radiance: Lambert's formula; beyond the portal
/// all is black.
#[test]
fn portals() {
    let cases = [
        ([-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
        ([-0.3, 0.2, 2.0], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([1.0, -1.0, -1.0], [0.0, 3.0, 0.0], [0.0, 0.0, 2.0]),
    ];
    for (corner, ex, ey) in cases {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(s, t)| DVec3::from_array(std::array::from_fn(|i| corner[i] + s * ex[i] + t * ey[i])));
        let mut stage = receiver(0.1);
        let portal: Vec<f64> = corners.iter().flat_map(|c| at(c.to_array())).collect();
        let node = crate::stage::light("environment").with("radiance", crate::stage::white(1.0)).with("portal", portal);
        stage.light(node);
        let e = mean(&Shot::of("direct", 40_000).take(&stage.scene())).times(PI);
        e.is_near_grey(&format!("portal at {corner:?}"), lambert(&corners), 0.01);
    }
}

/// A dim sky with a few bright spots, turned.
fn spotted(parametrization: Parametrization) -> Environment {
    let (width, height) = if parametrization == Parametrization::Octahedral { (16, 16) } else { (24, 12) };
    let mut rng = HashRng::new(5);
    let data = (0..width * height * 3).map(|_| 0.2 + 8.0 * rng.next_f32().powi(12)).collect();
    let texels = Texels {
        width,
        height,
        channels: 3,
        data: TexelData::F32(data),
        encoding: Encoding::Linear,
        metadata: Default::default(),
    };
    let turn = Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 0.7).affine().expect("a rotation");
    Environment {
        radiance: Color::constant(1.0),
        scale: 2.0,
        image: Some(EnvironmentImage::new(texels, parametrization, turn)),
        celestial: None,
        portal: None,
        mode: ColorMode::Rgb,
    }
}

/// The scene under a sky instead of its lights.
fn under(stage: &Stage, sky: Environment) -> Scene {
    let sky = vec![Light::Environment(Box::new(sky))];
    stage.scene().changed(|parts| parts.lights = Lights::new(sky, Vec::new(), ColorMode::Rgb))
}

const PARAMETRIZATIONS: [Parametrization; 3] =
    [Parametrization::Octahedral, Parametrization::LatLongY { poles: true }, Parametrization::LatLongZ];

/// M74, M217: an image around the scene, in each parametrisation and turned, gives the irradiance ∫ L cos dω of its own
/// radiance by quadrature, found by light sampling and scattering together. 4σ.
#[test]
fn environment_images() {
    for parametrization in PARAMETRIZATIONS {
        let sky = spotted(parametrization);
        let expected = std::array::from_fn(|c| {
            let cosine = |w: Vec3| f64::from(sky.radiance(Vec3::ZERO, w, &Wavelengths::RGB)[c] * w.z.max(0.0));
            steradian_testkit::integrate_sphere(cosine, 1e-3)
        });
        let scene = under(&receiver(0.1), sky);
        assert!(scene.lights().can_sample());
        let e = mean(&Shot::of("direct", 60_000).take(&scene)).times(PI);
        e.is_near(&format!("{parametrization:?}"), expected, 0.02);
    }
}

/// M217: what is seen in a ball of mirror is the image looked up in the reflected direction.
#[test]
fn a_mirror_ball_shows_the_environment() {
    let mut stage = Stage::new();
    stage.solid(
        sphere([0.0; 3], 1.0),
        crate::stage::material("conductor").with("reflectance", crate::stage::white(1.0)),
    );
    stage.film(1, 1).look([0.0, 0.0, 4.0], [0.0; 3], 10.0);
    let depth = Depth { max: 8, roulette_after: 8, hide_emitters: false };
    let path = PathTracer::<false> { depth };
    let sampler = Sampler { kind: SamplerKind::Independent, spp: 1, seed: 0 };
    for parametrization in PARAMETRIZATIONS {
        let sky = spotted(parametrization);
        let scene = under(&stage, sky.clone());
        for k in 0..400 {
            let (r, phi) = (0.98 * (k as f32 / 400.0).sqrt(), 2.4 * k as f32);
            let n = Vec3::new(r * phi.cos(), r * phi.sin(), (1.0 - r * r).sqrt());
            let ray = Ray::new(Vec3::new(n.x, n.y, 4.0), -Vec3::Z);
            let counters = &mut Counters::default();
            let (sampler, lambda) = (&sampler.pixel(0, 0, k), &mut Wavelengths::RGB.clone());
            let seen = path.radiance(&(), ray, &mut PathContext { scene: &scene, sampler, lambda, counters });
            let looked_up = sky.radiance(n, 2.0 * n.z * n - Vec3::Z, &Wavelengths::RGB);
            for c in 0..3 {
                let error = (seen[c] - looked_up[c]).abs();
                assert!(error <= 2e-3 * looked_up[c], "{parametrization:?} at {n}: {seen:?} is not {looked_up:?}");
            }
        }
    }
}

/// M72: a lamp whose radiance is a texture (of one value) is the lamp without one, though it is sampled triangle by
/// triangle: Lambert's formula.
#[test]
fn textured_lamps() {
    let (corner, ex, ey) = ([-1.0, -1.0, 0.7], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
    let polygon = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.7));
    let mut stage = receiver(0.1);
    let one = steradian_scene::Node::new(steradian_scene::Family::Texture, "checkerboard", None)
        .with("a", crate::stage::white(1.5))
        .with("b", crate::stage::white(1.5));
    let one = stage.add(one);
    let emission = stage.add(crate::stage::light("area").with("radiance", one));
    let mut sheet = rectangle(at(corner), ex, ey);
    sheet.uvs = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    stage.mesh_lamp(sheet, 1.0).emission = Some(emission);
    assert_eq!(stage.scene().lights().lights.len(), 2);
    check(&stage, "textured square", 1.5 * lambert(&polygon), true);
}

/// A flat lamp that shines along its normal alone gives its radiance as irradiance within its outline, at any distance,
/// and nothing beside it. Exact.
#[test]
fn directional_lamps() {
    for height in [0.5, 50.0] {
        // The edge of the lamp nearest to the receiver, on either side of it.
        for (edge, irradiance) in [(0.1, 2.0), (-0.1, 0.0)] {
            let mut stage = receiver(0.1);
            let emission =
                stage.add(crate::stage::light("directional_area").with("radiance", crate::stage::white(2.0)));
            let lamp = rectangle(at([edge - 2.0, -1.0, height]), [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
            stage.mesh_lamp(lamp, 1.0).emission = Some(emission);
            let film = Shot::of("direct", 16).take(&stage.scene());
            is_exactly(&film, &format!("edge at {edge}, height {height}"), [irradiance / PI; 3]);
        }
    }
}
