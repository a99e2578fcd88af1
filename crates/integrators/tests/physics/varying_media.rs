//! Media whose coefficients vary, and media that glow (M171).

use crate::{
    shot::{Shot, mean},
    stage::{Stage, cuboid, look_at, medium, rgb, white},
};
use steradian_core::{ColorMode, Scene};
use steradian_math::DVec3;
use steradian_scene::{Family, Node, Transform};

/// A medium in the box from (-1, -1, -1) to (1, 1, 1), `nx × ny × nz` densities.
fn grid(size: [i64; 3], density: Vec<f64>) -> Node {
    let mut node = Node::new(Family::Medium, "uniformgrid", None);
    for (name, n) in ["nx", "ny", "nz"].into_iter().zip(size) {
        node.set(name, n, None);
    }
    node.with("density", density)
        .with("p0", steradian_scene::Value::Vec3([-1.0; 3]))
        .with("p1", steradian_scene::Value::Vec3([1.0; 3]))
}

/// A box of a medium before a sky of one, seen from z = -4 through a point.
fn filled(medium: Node, x: f64, y: f64, mode: ColorMode) -> Scene {
    let mut stage = Stage::new();
    let inside = stage.add(medium);
    let clear = stage.add(Node::new(Family::Material, "interface", None));
    let body = stage.place_mesh(cuboid([-1.0; 3], [1.0; 3]));
    (body.material, body.interior, body.is_medium_boundary) = (Some(clear), Some(inside), true);
    stage.sky(1.0);
    let node = Node::new(Family::Camera, "perspective", None).with("fov", 1e-4);
    stage.film(1, 1).camera(node.with("to_world", look_at([x, y, -4.0], [x, y, 0.0])));
    stage.scene_in(mode)
}

fn absorbing(node: Node, sigma_a: [f64; 3]) -> Node {
    node.with("sigma_a", rgb(sigma_a)).with("sigma_s", white(0.0))
}

/// Transmittance of a density that rises linearly along the view is exp(−∫σ), for every lane, whatever the order of the
/// cells and where the grid is turned in the world.
#[test]
fn what_passes_a_ramp_is_the_exponential_of_its_integral() {
    // Eight numbers at centres from -7/8 to 7/8; the outermost fade to half within their half cells.
    let values: Vec<f64> = (0..8).map(|i| 0.2 + 0.3 * f64::from(i)).collect();
    let middle: f64 = values.windows(2).map(|v| 0.5 * (v[0] + v[1]) * 0.25).sum();
    let depth = middle + 0.75 * 0.125 * (values[0] + values[7]);
    let sigma = [0.3, 1.0, 2.0];
    let expected = sigma.map(|s| (-s * depth).exp());
    let along_z = grid([1, 1, 8], values.clone());
    let along_x = grid([8, 1, 1], values.iter().rev().copied().collect())
        .with("to_world", Transform::rotate(DVec3::Y, std::f64::consts::FRAC_PI_2));
    for node in [along_z, along_x] {
        // Seen through a cell in which other axes do not fade.
        let scene = filled(absorbing(node, sigma), 0.0, 0.0, ColorMode::Rgb);
        mean(&Shot::of("volpath", 20_000).take(&scene)).is_near("a ramp", expected, 0.02);
    }
}

/// A constant grid is the homogeneous medium, as it scatters into all orders, in both colour modes.
#[test]
fn a_constant_grid_is_homogeneous() {
    for mode in [ColorMode::Rgb, ColorMode::Spectral] {
        let (a, s) = ([0.1, 0.2, 0.4], [0.9, 0.5, 1.5]);
        let phase = |node: Node| node.with("g", 0.4);
        // As many numbers as keep the fading border outside of the box that is seen.
        let constant = grid([1; 3], vec![2.0])
            .with("p0", steradian_scene::Value::Vec3([-1e4; 3]))
            .with("p1", steradian_scene::Value::Vec3([1e4; 3]));
        let constant =
            phase(constant.with("sigma_a", rgb(a.map(|v| 0.5 * v))).with("sigma_s", rgb(s.map(|v| 0.5 * v))));
        let plain = phase(medium(rgb(a), rgb(s)));
        let shot = |node| mean(&Shot::of("volpath", 40_000).depth(20).take(&filled(node, 0.3, 0.2, mode)));
        shot(constant).agrees(&format!("{mode:?}"), shot(plain), 0.02);
    }
}

/// Under an even sky a medium that only scatters cannot be seen, however it varies and whatever its colour.
#[test]
fn white_clouds_are_invisible_under_an_even_sky() {
    let lumps: Vec<f64> = (0..125).map(|i| if i % 3 == 0 { 8.0 } else { 0.3 * f64::from(i % 7) }).collect();
    let node = grid([5; 3], lumps).with("sigma_a", white(0.0)).with("sigma_s", rgb([0.9, 1.0, 1.1]));
    for (x, y) in [(0.0, 0.0), (0.5, -0.3)] {
        let scene = filled(node.clone().with("g", 0.3), x, y, ColorMode::Rgb);
        mean(&Shot::of("volpath", 40_000).depth(400).take(&scene)).is_near_grey("a white cloud", 1.0, 0.02);
    }
}

/// A glowing slab that scatters nothing has σ_a L (1 − e^(−σ d))/σ; a grid and a homogeneous medium.
#[test]
fn a_glowing_slab_has_its_radiance() {
    let sigma = [0.2, 0.7, 3.0];
    // In front of the sky, of which the rest passes.
    let expected = sigma.map(|s: f64| 2.0 * (1.0 - (-2.0 * s).exp()) + (-2.0 * s).exp());
    let glow = |node: Node| absorbing(node, sigma).with("Le", rgb([2.0; 3]));
    let plain = filled(glow(Node::new(Family::Medium, "homogeneous", None)), 0.1, 0.2, ColorMode::Rgb);
    mean(&Shot::of("volpath", 64).take(&plain)).is_near("homogeneous", expected, 1e-3);
    let wide = |node: Node| {
        node.with("p0", steradian_scene::Value::Vec3([-1e4; 3])).with("p1", steradian_scene::Value::Vec3([1e4; 3]))
    };
    let scene = filled(wide(glow(grid([1; 3], vec![1.0]))), 0.1, 0.2, ColorMode::Rgb);
    mean(&Shot::of("volpath", 40_000).take(&scene)).is_near("a grid", expected, 0.02);
    // With scattering: in a closed box of equal glow all around, nothing changes; here the two agree.
    let both = |node: Node| glow(node).with("sigma_s", rgb([0.4, 1.0, 0.2]));
    let plain = filled(both(Node::new(Family::Medium, "homogeneous", None)), 0.1, 0.2, ColorMode::Rgb);
    let scene = filled(wide(both(grid([1; 3], vec![1.0]))), 0.1, 0.2, ColorMode::Rgb);
    let shot = |scene: &Scene| mean(&Shot::of("volpath", 40_000).depth(20).take(scene));
    shot(&scene).agrees("with scattering", shot(&plain), 0.02);
}

/// A hot medium that is opaque looks like the black body it is, by the numbers of `Le` of the same spectrum.
#[test]
fn hot_media_are_black_bodies() {
    let hot = |kelvin: f64| {
        let node = absorbing(grid([1; 3], vec![1.0]), [30.0; 3]).with("temperature", vec![kelvin + 500.0]);
        let node = node.with("temperatureoffset", 500.0).with("Lescale", vec![3.0]);
        let wide = |p: f64| steradian_scene::Value::Vec3([p; 3]);
        filled(node.with("p0", wide(-1e7)).with("p1", wide(1e7)), 0.1, 0.2, ColorMode::Rgb)
    };
    let lamp = |kelvin: f64| {
        let mut stage = Stage::new();
        let glow = Node::new(Family::Light, "area", None)
            .with("radiance", steradian_scene::Value::Spectrum(steradian_scene::SpectrumValue::Blackbody(kelvin)));
        let glow = stage.add(glow.with("two_sided", true));
        stage.place_mesh(cuboid([-1.0; 3], [1.0; 3])).emission = Some(glow);
        let node = Node::new(Family::Camera, "perspective", None).with("fov", 1e-4);
        stage.film(1, 1).camera(node.with("to_world", look_at([0.1, 0.2, -4.0], [0.1, 0.2, 0.0])));
        stage.scene()
    };
    for kelvin in [2000.0, 6500.0] {
        let expected = mean(&Shot::of("path", 4).take(&lamp(kelvin))).mean.map(|v| 3.0 * v);
        mean(&Shot::of("volpath", 20_000).take(&hot(kelvin))).is_near(&format!("{kelvin} K"), expected, 0.02);
    }
    assert!(mean(&Shot::of("volpath", 64).take(&hot(90.0))).mean[0] < 1e-6, "nothing glows below 100 K");
}

/// Coefficients of each colour for itself: a grid of colours that are all equal is the homogeneous medium.
#[test]
fn a_grid_of_colours_is_homogeneous_where_they_are_equal() {
    let (a, s) = ([0.1, 0.2, 0.4], [0.9, 0.5, 1.5]);
    let node = Node::new(Family::Medium, "rgbgrid", None)
        .with("sigma_a", a.to_vec())
        .with("sigma_s", s.to_vec())
        .with("p0", steradian_scene::Value::Vec3([-1e4; 3]))
        .with("p1", steradian_scene::Value::Vec3([1e4; 3]));
    let shot = |node| mean(&Shot::of("volpath", 40_000).depth(20).take(&filled(node, 0.3, 0.2, ColorMode::Rgb)));
    shot(node).agrees("colours", shot(medium(rgb(a), rgb(s))), 0.02);
}

/// Light samples go through varying media as paths do: a lamp in a lumpy fog, by paths that are asked for light at
/// every vertex and by those that find it by chance, and the recursive form.
#[test]
fn light_samples_agree_with_chance() {
    let lumps: Vec<f64> = (0..64).map(|i| f64::from(i % 5) * 0.4).collect();
    let node = grid([4; 3], lumps).with("sigma_a", white(0.1)).with("sigma_s", rgb([0.6, 0.8, 0.4]));
    let build = || {
        let mut stage = Stage::new();
        let inside = stage.add(node.clone());
        let clear = stage.add(Node::new(Family::Material, "interface", None));
        let body = stage.place_mesh(cuboid([-1.0; 3], [1.0; 3]));
        (body.material, body.interior, body.is_medium_boundary) = (Some(clear), Some(inside), true);
        stage.lamp(crate::stage::sphere([0.0, 1.8, 0.0], 0.7), 5.0);
        stage.film(4, 4).look([0.0, 0.0, -4.0], [0.0; 3], 20.0);
        stage.scene()
    };
    let shot = |scene: &Scene| mean(&Shot::of("volpath", 8192).depth(6).take(scene));
    let by_chance = crate::stage::found_by_scattering_alone(build());
    shot(&build()).agrees("light samples", shot(&by_chance), 0.05);
}
