//! Participating media in the methods that join subpaths, held against volumetric path tracing.

use crate::{
    bidirectional::{disagreement, furnish, lamp, room},
    shot::{Shot, mean, same_bits},
    stage::{Stage, cuboid, diffuse, light, look_at, material, medium, rgb, sphere, white},
};
use steradian_core::{ColorMode, Scene};
use steradian_integrators::Control;
use steradian_scene::{Family, Node, NodeId, Value};

/// Fog of a colour.
fn fog(thickness: f64) -> Node {
    medium(rgb([0.1, 0.2, 0.05].map(|v| v * thickness)), rgb([0.6, 0.5, 0.9].map(|v| v * thickness)))
}

/// A medium in the box from (-0.9, -0.9, -0.9) to (0.9, 0.9, 0.9), of lumps.
fn lumps() -> Node {
    let density: Vec<f64> = (0..64).map(|i| if i % 3 == 0 { 3.0 } else { 0.2 * f64::from(i % 7) }).collect();
    Node::new(Family::Medium, "uniformgrid", None)
        .with("nx", 4_i64)
        .with("ny", 4_i64)
        .with("nz", 4_i64)
        .with("density", density)
        .with("p0", Value::Vec3([-0.9; 3]))
        .with("p1", Value::Vec3([0.9; 3]))
        .with("sigma_a", rgb([0.2, 0.1, 0.3]))
        .with("sigma_s", rgb([0.8, 1.0, 0.6]))
}

/// Fills the last shape with a medium, in another one.
fn fill(stage: &mut Stage, inside: Node, outside: Option<NodeId>, made_of: Node) {
    let (inside, made_of) = (stage.add(inside), stage.add(made_of));
    let shape = stage.desc.shapes.last_mut().expect("a shape to fill");
    (shape.interior, shape.exterior) = (Some(inside), outside);
    (shape.material, shape.is_medium_boundary) = (Some(made_of), true);
}

/// A box in the room, bounded by an interface, that holds a medium with whatever else is in the room.
fn filled(stage: &mut Stage, inside: Node) {
    stage.place_mesh(cuboid([-0.99; 3], [0.99; 3]));
    fill(stage, inside, None, material("interface"));
}

/// The camera in a medium, which fills the world but for other media.
fn drowned(stage: &mut Stage, inside: Node) -> NodeId {
    let inside = stage.add(inside);
    let camera = Node::new(Family::Camera, "perspective", None).with("fov", 40.0).with("fov_axis", "x");
    stage.camera(camera.with("to_world", look_at([0.0, 0.0, -3.2], [0.0; 3])).with("medium", inside));
    inside
}

/// Small scenes by name, each about one thing.
fn scenes() -> Vec<(&'static str, Scene)> {
    let mut all = Vec::new();
    let mut add = |name, made: &dyn Fn(&mut Stage)| {
        let mut stage = room(0.6);
        made(&mut stage);
        all.push((name, stage.scene()));
    };
    let point = || light("point").with("position", [0.3, 0.4, -0.2]).with("intensity", white(0.6));
    add("lamp in fog", &|s| {
        lamp(s, 0.8, 4.0);
        filled(s, fog(1.0));
    });
    add("point in fog", &|s| {
        s.light(point());
        filled(s, fog(1.0));
        furnish(s, diffuse(0.5));
    });
    add("lamp that is the boundary of fog", &|s| {
        s.lamp(sphere([0.1, 0.3, 0.0], 0.3), 4.0);
        fill(s, fog(1.0), None, material("interface"));
    });
    add("forwards", &|s| {
        lamp(s, 0.8, 4.0);
        filled(s, fog(2.0).with("g", 0.7));
    });
    add("ball", &|s| {
        lamp(s, 0.8, 4.0);
        s.place(sphere([0.1, -0.3, 0.0], 0.5));
        fill(s, fog(4.0), None, material("interface"));
    });
    add("ball of glass", &|s| {
        lamp(s, 1.2, 2.0);
        s.place(sphere([0.1, -0.3, 0.0], 0.5));
        fill(s, fog(2.0), None, material("dielectric"));
    });
    add("ball of rough glass in fog", &|s| {
        lamp(s, 1.2, 2.0);
        let outside = drowned(s, fog(0.2));
        s.place(sphere([0.1, -0.3, 0.0], 0.5));
        let rough = material("dielectric").with("alpha_u", 0.4).with("alpha_v", 0.4);
        fill(s, fog(2.0), Some(outside), rough);
    });
    add("pane", &|s| {
        lamp(s, 0.8, 4.0);
        filled(s, fog(1.0));
        s.place_mesh(cuboid([-0.5, -0.5, -0.5], [0.5, 0.5, 0.2]));
        let pane = s.add(material("thin_dielectric"));
        s.desc.shapes.last_mut().expect("a pane").material = Some(pane);
    });
    add("camera in fog", &|s| {
        lamp(s, 0.8, 4.0);
        s.light(point());
        drowned(s, fog(0.3));
        furnish(s, diffuse(0.5));
    });
    add("sky over a ball", &|s| {
        s.sky(0.8);
        s.place(sphere([0.1, -0.3, -0.6], 0.5));
        fill(s, fog(3.0), None, material("interface"));
    });
    add("distant light on fog", &|s| {
        s.light(light("distant").with("direction", [0.3, -0.4, 1.0]).with("radiance", white(1.5)));
        filled(s, fog(1.0));
    });
    add("lumps", &|s| {
        lamp(s, 0.8, 4.0);
        filled(s, lumps());
    });
    // Field and sky reach beyond the surfaces; the medium is the camera's, which is not within its box.
    add("lumps around the room, under a sky", &|s| {
        s.sky(0.5);
        drowned(s, lumps().with("p0", Value::Vec3([-1.2, -1.2, -2.0])).with("p1", Value::Vec3([1.2; 3])));
    });
    all
}

/// Connections, light tracing and Metropolis have the mean of volumetric path tracing at each depth.
#[test]
fn joined_subpaths_agree_with_volumetric_path_tracing() {
    let mut wrong = Vec::new();
    for (name, scene) in scenes() {
        let is_held_at_each = ["lamp in fog", "pane", "lumps"].contains(&name);
        for depth in if is_held_at_each { 1..=6 } else { 3..=3 } {
            let paths = Shot::of("volpath", 400).depth(depth).seed(7).take(&scene);
            let mut hold = |shot: Shot, precision| {
                let what = format!("{}, {name}, {depth} events", shot.integrator);
                wrong.extend(disagreement(&what, &shot.depth(depth).take(&scene), &paths, precision));
            };
            hold(Shot::of("bdpt", 120), 0.05);
            let light = Shot::of("light", 400);
            match light.limit(&scene) {
                None => hold(light, 0.05),
                Some(what) => assert!(["ball of glass", "pane"].contains(&name), "{name}: {what}"),
            }
            if depth == 3 {
                hold(Shot::of("pssmlt", 160), 0.08);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Merging, on surfaces alone, leaves the bias of its radius.
#[test]
fn merging_leaves_media_to_connections() {
    let mut wrong = Vec::new();
    for (name, scene) in scenes() {
        let paths = Shot::of("volpath", 400).depth(6).seed(7).take(&scene);
        let shot = Shot::of("vcm", 120).depth(6);
        let mut session = shot.session_of(&scene, &*shot.method(&scene, "radius=0.02"));
        session.step(u32::MAX, &Control::default());
        wrong.extend(disagreement(&format!("vcm, {name}"), &session.film(), &paths, 0.05));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Photons in media have the mean of volumetric path tracing, but for what their radius leaves out at the bounds of
/// media and at edges: 3 % at most.
#[test]
fn photons_have_the_mean_of_volumetric_path_tracing() {
    for (name, scene) in scenes() {
        if !["lamp in fog", "ball of glass", "lumps"].contains(&name) {
            continue;
        }
        let paths = mean(&Shot::of("volpath", 500).depth(6).seed(7).take(&scene));
        for (method, spp, options) in
            [("sppm", 120, ""), ("photon", 60, "nearest=20,"), ("photon", 60, "gather=false,")]
        {
            let shot = Shot::of(method, spp).depth(6);
            let options = format!("{options}photons=1500,radius=0.1");
            let mut session = shot.session_of(&scene, &*shot.method(&scene, &options));
            session.step(u32::MAX, &Control::default());
            let photons = mean(&session.film());
            for c in 0..3 {
                let (found, expected) = (photons.mean[c], paths.mean[c]);
                let sigma = photons.sigma[c].hypot(paths.sigma[c]);
                assert!(sigma < 0.05 * expected, "{method} {options}, {name}: {found} ± {sigma} is too vague");
                let is_near = (found - expected).abs() < 4.0 * sigma + 0.03 * expected;
                assert!(is_near, "{method} {options}, {name}, channel {c}: {found} against {expected} ± {sigma}");
            }
        }
    }
}

/// Under an even sky a medium that only scatters cannot be seen.
#[test]
fn white_media_are_invisible_under_an_even_sky() {
    let grid = lumps().with("sigma_a", white(0.0)).with("sigma_s", rgb([0.9, 1.0, 1.1])).with("g", 0.3);
    for inside in [medium(white(0.0), rgb([0.9, 1.0, 1.1])), medium(white(0.0), white(2.0)).with("g", 0.7), grid] {
        let mut stage = Stage::new();
        stage.place_mesh(cuboid([-0.9; 3], [0.9; 3]));
        fill(&mut stage, inside, None, material("interface"));
        stage.sky(1.0).film(3, 3).look([0.3, 0.2, -4.0], [0.0; 3], 20.0);
        let film = Shot::of("bdpt", 4000).depth(400).take(&stage.scene());
        mean(&film).is_near_grey("a white medium", 1.0, 0.01);
    }
}

/// Media that glow are seen by camera subpaths, directly and by what scatters their light.
#[test]
fn media_that_glow_agree() {
    let mut stage = room(0.6);
    stage.place(sphere([0.1, -0.3, 0.0], 0.5));
    fill(&mut stage, fog(1.5).with("Le", rgb([1.0, 2.0, 0.5])), None, material("interface"));
    let scene = stage.scene();
    let paths = Shot::of("volpath", 800).depth(6).seed(7).take(&scene);
    assert_eq!(disagreement("glow", &Shot::of("bdpt", 400).depth(6).take(&scene), &paths, 0.05), None);
    assert!(Shot::of("light", 4).limit(&scene).is_some(), "light tracing leaves scattered glow out");
}

/// Media are those of volumetric path tracing with lights hidden from the camera, and in spectral mode, too.
#[test]
fn hidden_lights_and_spectral_media_agree() {
    let mut stage = room(0.6);
    lamp(&mut stage, 0.8, 4.0);
    stage.lamp(sphere([0.3, -0.2, -0.5], 0.2), 2.0);
    filled(&mut stage, fog(1.0).with("g", 0.4));
    for (mode, hide_emitters) in [(ColorMode::Rgb, true), (ColorMode::Spectral, false)] {
        let scene = stage.scene_in(mode);
        let shot = |method, spp| Shot { hide_emitters, ..Shot::of(method, spp).depth(5) };
        let paths = shot("volpath", 1000).seed(7).take(&scene);
        for (method, spp) in [("bdpt", 160), ("light", 500)] {
            let film = shot(method, spp).take(&scene);
            assert_eq!(disagreement(&format!("{method}, {mode:?}"), &film, &paths, 0.05), None);
        }
    }
}

/// No number of threads changes a bit in media.
#[test]
fn threads_do_not_change_a_bit_in_media() {
    let mut stage = room(0.6);
    lamp(&mut stage, 0.6, 6.0);
    filled(&mut stage, lumps());
    let scene = stage.scene();
    for method in ["light", "bdpt", "vcm", "pssmlt", "mmlt", "sppm", "photon"] {
        let shot = Shot::of(method, 16).depth(5);
        same_bits(&shot.take(&scene), &Shot { threads: 2, ..shot }.take(&scene), method);
    }
}
