//! Participating media (M171): Beer–Lambert attenuation, single scattering in closed form, and furnaces.

use crate::{
    shot::{Estimate, Shot, is_exactly, mean},
    stage::{Stage, cuboid, diffuse, light, material, medium, plane, rectangle, rgb, shape, sphere, white},
};
use std::f64::consts::PI;
use steradian_core::ColorMode;
use steradian_scene::{Family, Mesh, Node, Shape, Value};

/// Fills the last shape with a medium, as a boundary that scatters nothing unless it has a material.
fn fill(stage: &mut Stage, what: Node) -> &mut Shape {
    let (what, interface) = (stage.add(what), stage.add(material("interface")));
    let shape = stage.desc.shapes.last_mut().expect("a shape to fill");
    (shape.interior, shape.is_medium_boundary) = (Some(what), true);
    shape.material = shape.material.or(Some(interface));
    shape
}

fn ball(what: Node, radius: f64) -> Stage {
    let mut stage = Stage::new();
    stage.place(sphere([0.0; 3], radius));
    fill(&mut stage, what);
    stage
}

fn with_g(node: Node, g: f64, stage: &mut Stage) -> Node {
    let phase = stage.add(Node::new(Family::Phase, "hg", None).with("g", g));
    node.with("phase", phase)
}

/// M139, M171: an absorbing ball, slab, and mesh let exp(−σd) through: exact, in each lane of RGB mode.
#[test]
fn absorption_is_exact() {
    let sigma = [0.3, 1.0, 2.5];
    let expected = |d: f64| sigma.map(|s: f64| (-s * d).exp());
    for (offset, length) in [(0.0_f64, 2.0_f64), (0.6, 1.6)] {
        let mut stage = ball(medium(rgb(sigma), 0.0), 1.0);
        stage.sky(1.0).probe([offset, 0.0, -5.0], [offset, 0.0, 0.0]);
        is_exactly(&Shot::of("volpath", 8).take(&stage.scene()), "ball", expected(length));
    }
    let slab = |mesh: Mesh, what: Node, probe: [f64; 3]| {
        let mut stage = Stage::new();
        stage.place_mesh(mesh);
        fill(&mut stage, what);
        stage.sky(1.0).probe(probe, [0.1, 0.2, 0.0]);
        stage.scene()
    };
    let film = Shot::of("volpath", 8).take(&slab(
        cuboid([-9.0, -9.0, 0.0], [9.0, 9.0, 0.7]),
        medium(rgb(sigma), 0.0),
        [0.1, 0.2, -3.0],
    ));
    is_exactly(&film, "slab", expected(0.7));
    // At 60° the way through is twice as long.
    let film = Shot::of("volpath", 8).take(&slab(
        cuboid([-9.0, -9.0, 0.0], [9.0, 9.0, 0.7]),
        medium(rgb(sigma), 0.0),
        [0.1 - 3.0 * 3.0_f64.sqrt(), 0.2, -3.0],
    ));
    is_exactly(&film, "slanted slab", expected(1.4));
    // `scale` multiplies, and sigma_t with albedo is another way to say the same.
    let other =
        Node::new(Family::Medium, "homogeneous", None).with("sigma_t", rgb(sigma.map(|s| s / 4.0))).with("albedo", 0.0);
    let film = Shot::of("volpath", 8).take(&slab(
        cuboid([-9.0, -9.0, 0.0], [9.0, 9.0, 0.7]),
        other.with("scale", 4.0),
        [0.1, 0.2, -3.0],
    ));
    is_exactly(&film, "scaled slab", expected(0.7));
}

/// M171: absorption is told apart wavelength by wavelength: in spectral mode a chromatic absorber gives ∫ exp(−σ(λ)d)
/// D65 x̄ȳz̄. 4σ.
#[test]
fn chromatic_absorption_in_spectral_mode() {
    use steradian_math::{
        color::space::REC709,
        spectra::{cie, d65},
    };
    let (lambdas, values) = (vec![360.0, 480.0, 560.0, 650.0, 830.0], vec![2.0, 0.2, 1.0, 0.1, 0.6]);
    let curve = steradian_math::spectra::Curve::new(lambdas.clone(), values.clone()).expect("a curve");
    let sigma = Value::Spectrum(steradian_scene::SpectrumValue::Sampled { lambdas, values });
    let mut stage = ball(medium(sigma, 0.0), 1.0);
    stage.sky(1.0).probe([0.0, 0.0, -5.0], [0.0; 3]);
    let through = cie::to_xyz(|l| (-2.0 * curve.eval(l)).exp() * d65().eval(l)) / cie::to_xyz(|l| d65().eval(l)).y;
    let expected = (REC709.rgb_from_xyz() * through).to_array();
    let film = Shot::of("volpath", 60_000).take(&stage.scene_in(ColorMode::Spectral));
    mean(&film).is_near("chromatic ball", expected, 0.03);
}

/// M171: what was not scattered passes a medium as exp(−σ_t d), whatever the albedo: paths of no event. Chromatic, so
/// that flights are drawn by one lane and weighted for all. 4σ.
#[test]
fn unscattered_light_is_attenuated() {
    let (a, s): ([f64; 3], [f64; 3]) = ([0.1, 0.4, 0.2], [0.9, 0.3, 1.5]);
    let expected = std::array::from_fn(|c| (-2.0 * (a[c] + s[c])).exp());
    let mut stage = ball(medium(rgb(a), rgb(s)), 1.0);
    stage.sky(1.0).probe([0.0, 0.0, -5.0], [0.0; 3]);
    mean(&Shot::of("volpath", 100_000).depth(0).take(&stage.scene())).is_near("ball", expected, 0.03);
    // In spectral mode of grey coefficients the sky's own colour noise stays.
    let mut stage = ball(medium(white(0.2), white(0.7)), 1.0);
    stage.sky(1.0).probe([0.0, 0.0, -5.0], [0.0; 3]);
    let film = Shot::of("volpath", 100_000).depth(0).take(&stage.scene_in(ColorMode::Spectral));
    mean(&film).is_near_grey("grey ball in spectral mode", (-1.8_f64).exp(), 0.03);
}

/// M171: light scattered once in a slab of thickness D that parallel light enters with the camera's rays at a cosine μ:
/// with k = σ_t (1 + 1/μ), L = σ_s p(cos Θ) E (1 − e^(−kD)) / k. Shadow rays pass the interface on their way. 4σ,
/// isotropic and g = ±0.7, each lane with coefficients of its own.
#[test]
fn single_scattering_in_a_slab() {
    let (sa, ss): ([f64; 3], [f64; 3]) = ([0.2, 0.5, 0.1], [0.8, 0.3, 1.2]);
    let thickness = 1.5_f64;
    for g in [0.0_f64, 0.7, -0.7] {
        for degrees in [0.0_f64, 50.0] {
            let (sin, mu) = degrees.to_radians().sin_cos();
            let mut stage = Stage::new();
            stage.place_mesh(cuboid([-500.0, -500.0, 0.0], [500.0, 500.0, thickness]));
            let what = with_g(medium(rgb(sa), rgb(ss)), g, &mut stage);
            fill(&mut stage, what);
            stage.light(light("distant").with("direction", [sin, 0.0, mu]).with("radiance", white(2.0)));
            stage.probe([0.3, 0.1, -4.0], [0.3, 0.1, 0.0]);
            let film = Shot::of("volpath", 40_000).depth(1).take(&stage.scene());
            // Light that travels at (sin, 0, μ) is turned towards −z.
            let cos_scattering = -mu;
            let phase = (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos_scattering).powf(1.5));
            let expected = std::array::from_fn(|c| {
                let k = (sa[c] + ss[c]) * (1.0 + 1.0 / mu);
                ss[c] * phase * 2.0 * (1.0 - (-k * thickness).exp()) / k
            });
            mean(&film).is_near(&format!("g = {g}, {degrees}°"), expected, 0.02);
        }
    }
}

/// M171: a medium of albedo one in a white furnace cannot be seen, thin or thick, whatever the phase function, in a
/// sphere, a mesh, behind glass or around the camera: 4σ.
#[test]
fn white_media_are_invisible() {
    let shot = Shot::of("volpath", 1000).roulette_after(1000);
    for (sigma, g) in [(0.2, 0.0), (3.0, 0.0), (2.0, 0.7), (2.0, -0.7), (12.0, 0.9)] {
        let mut stage = Stage::new();
        stage.place(sphere([0.0; 3], 1.0));
        let what = with_g(medium(white(0.0), white(sigma)), g, &mut stage);
        fill(&mut stage, what);
        stage.sky(1.0).film(5, 5).look([0.0, 0.0, -4.0], [0.0; 3], 24.0);
        // Every weight is one: the sum is exact.
        let film = shot.take(&stage.scene());
        mean(&film).is_near_grey(&format!("σ = {sigma}, g = {g}"), 1.0, 1e-3);
    }
    // Chromatic: each lane keeps its own balance.
    for mode in [ColorMode::Rgb, ColorMode::Spectral] {
        let mut stage = ball(medium(white(0.0), rgb([0.3, 1.0, 2.0])), 1.0);
        stage.sky(1.0).probe([0.2, 0.1, -4.0], [0.2, 0.1, 0.0]);
        let film = Shot::of("volpath", 40_000).roulette_after(1000).take(&stage.scene_in(mode));
        mean(&film).is_near_grey(&format!("chromatic, {mode:?}"), 1.0, 0.03);
    }
    // In a closed mesh of glass, with light that goes round inside.
    let mut stage = Stage::new();
    let glass = stage.add(material("dielectric").with("eta", 1.4));
    stage.place_mesh(cuboid([-1.0; 3], [1.0; 3])).material = Some(glass);
    fill(&mut stage, medium(white(0.0), white(1.0)));
    stage.sky(1.0).probe([0.5, 1.5, -4.0], [0.1, 0.2, 0.0]);
    mean(&shot.take(&stage.scene())).is_near_grey("glass block", 1.0, 1e-3);
    // The camera within the medium.
    let mut stage = ball(medium(white(0.0), white(1.5)), 2.0);
    let inside = stage.desc.shapes[0].interior.expect("it is filled");
    let camera = Node::new(Family::Camera, "perspective", None).with("fov", 60.0).with("medium", inside);
    stage.sky(1.0).film(4, 4).camera(camera);
    mean(&shot.take(&stage.scene())).is_near_grey("from within", 1.0, 1e-3);
}

/// M171: the camera in an absorbing medium sees the sky through what lies between: exp(−σ r). Exact.
#[test]
fn camera_inside_an_absorber() {
    let mut stage = ball(medium(white(0.8), white(0.0)), 2.0);
    let inside = stage.desc.shapes[0].interior.expect("it is filled");
    stage
        .sky(1.0)
        .film(6, 6)
        .camera(Node::new(Family::Camera, "perspective", None).with("fov", 90.0).with("medium", inside));
    is_exactly(&Shot::of("volpath", 4).take(&stage.scene()), "from the middle", [(-1.6_f64).exp(); 3]);
}

/// A boundary of nothing cannot be seen, nor can one of index one around the same medium: interfaces nested in a medium
/// change nothing. The first exactly, the second within 4σ.
#[test]
fn matched_boundaries_are_invisible() {
    for mesh in [false, true] {
        let mut stage = Stage::new();
        let interface = stage.add(material("interface"));
        let body =
            if mesh { stage.place_mesh(cuboid([-1.0; 3], [1.0; 3])) } else { stage.place(sphere([0.0; 3], 1.0)) };
        body.material = Some(interface);
        stage.solid(plane([0.0, 0.0, 1.0], 3.0), diffuse(0.5));
        stage.sky(1.0).film(8, 8).look([0.0, 0.0, -4.0], [0.0; 3], 20.0);
        let with = Shot::of("volpath", 4).take(&stage.scene());
        is_exactly(&with, "wall behind an interface", [0.5; 3]);
        is_exactly(&Shot::of("path", 4).take(&stage.scene()), "wall behind an interface, path", [0.5; 3]);
    }
    let cut = |how: Option<&str>| -> Estimate {
        let mut stage = ball(medium(white(0.2), white(0.8)), 1.0);
        let (what, around) = (stage.desc.shapes[0].interior, stage.desc.shapes[0].interior);
        if let Some(kind) = how {
            let boundary = stage.add(material(kind).with("eta", 1.0));
            let inner = stage.place(sphere([0.1, 0.0, 0.0], 0.6));
            (inner.interior, inner.exterior, inner.is_medium_boundary, inner.material) =
                (what, around, true, Some(boundary));
        }
        stage.light(light("distant").with("direction", [1.0, -1.0, 0.5]).with("radiance", white(3.0)));
        stage.sky(0.5).probe([0.2, 0.1, -4.0], [0.2, 0.1, 0.0]);
        mean(&Shot::of("volpath", 60_000).seed(how.map_or(3, |k| k.len() as u64)).take(&stage.scene()))
    };
    let whole = cut(None);
    cut(Some("interface")).agrees("cut by an interface", whole, 0.02);
}

/// M171: shadow rays lose exp(−σd) in an absorbing ball between a surface and its light, and a part at a pane of glass:
/// 1 − R with R = 2F/(1 + F). Exact.
#[test]
fn shadow_rays_see_through() {
    let lit = |stage: &mut Stage| {
        stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
        stage.light(light("point").with("position", [0.0, 0.0, 4.0]).with("intensity", white(16.0)));
        stage.probe([0.4, 0.3, 0.5], [0.0; 3]);
        Shot::of("volpath", 4).depth(1).take(&stage.scene())
    };
    let mut ball = Stage::new();
    ball.place(sphere([0.0, 0.0, 2.0], 1.0));
    fill(&mut ball, medium(rgb([0.1, 0.7, 1.5]), white(0.0)));
    is_exactly(&lit(&mut ball), "through a ball", [0.1, 0.7, 1.5].map(|s: f64| (-2.0 * s).exp() / PI));
    let mut pane = Stage::new();
    pane.solid(shape("disk").with("height", 2.0), material("thin_dielectric").with("eta", 1.5));
    let f: f64 = 0.04;
    is_exactly(&lit(&mut pane), "through a pane", [(1.0 - 2.0 * f / (1.0 + f)) / PI; 3]);
    // What scatters blocks.
    let mut block = Stage::new();
    block.solid(shape("disk").with("height", 2.0), diffuse(0.5));
    is_exactly(&lit(&mut block), "behind a disk", [0.0; 3]);
}

/// M171: area lights seen through an absorber by scattering and by light sampling carry the same weight: E = exp(−σd)
/// E₀ where the whole way lies in the medium. The mean over a large lamp is by quadrature of exp(−σ/cos θ) over its
/// rectangle. 4σ.
#[test]
fn area_lights_through_media() {
    let (sigma, height) = (0.6_f64, 1.0_f64);
    let n = 800;
    let cell = |i: usize, j: usize| {
        let (x, y) = ((i as f64 + 0.5) / n as f64 * 4.0 - 2.0, (j as f64 + 0.5) / n as f64 * 4.0 - 2.0);
        let d2 = x * x + y * y + height * height;
        let d = d2.sqrt();
        (-sigma * d).exp() * (height / d).powi(2) / d2 * 16.0 / (n * n) as f64
    };
    let irradiance: f64 = (0..n * n).map(|k| cell(k / n, k % n)).sum();
    let mut stage = Stage::new();
    stage.solid(plane([0.0, 0.0, 1.0], 0.0), diffuse(1.0));
    stage.mesh_lamp(rectangle([-2.0, -2.0, height], [0.0, 4.0, 0.0], [4.0, 0.0, 0.0]), 1.0);
    // The camera and all else is within.
    stage.place(sphere([0.0; 3], 50.0));
    let inside = fill(&mut stage, medium(white(sigma), white(0.0))).interior;
    let eye = crate::stage::look_at([0.02, 0.01, 0.05], [0.0; 3]);
    let camera = Node::new(Family::Camera, "perspective", None).with("fov", 1e-4).with("to_world", eye);
    stage.camera(camera.with("medium", inside.expect("it is filled")));
    let to_eye = (0.05_f64.powi(2) + 0.02_f64.powi(2) + 0.01_f64.powi(2)).sqrt();
    let film = Shot::of("volpath", 40_000).depth(1).take(&stage.scene());
    mean(&film).is_near_grey("lamp in fog", irradiance / PI * (-sigma * to_eye).exp(), 0.01);
}

/// M171: the furnace whose walls are a lamp, found by light sampling through the boundary and by the phase function,
/// weighted against each other: one everywhere, as without next-event estimation. 4σ.
#[test]
fn white_media_are_invisible_inside_a_lamp() {
    for g in [0.0, 0.7, -0.7] {
        for radius in [30.0, 1.5] {
            let mut stage = Stage::new();
            stage.place(sphere([0.0; 3], 1.0));
            let what = with_g(medium(white(0.0), white(1.5)), g, &mut stage);
            fill(&mut stage, what);
            stage.lamp(sphere([0.0; 3], radius), 1.0).reverse_orientation = true;
            stage.probe([0.3, 0.2, -1.4], [0.3, 0.2, 0.0]);
            let film = Shot::of("volpath", 60_000).roulette_after(1000).take(&stage.scene());
            mean(&film).is_near_grey(&format!("g = {g}, lamp of {radius}"), 1.0, 0.01);
        }
    }
}
