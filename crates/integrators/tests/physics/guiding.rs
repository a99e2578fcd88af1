//! Paths that a training guides have the mean of those that are not guided, and less noise where light is behind a
//! door.

use crate::{
    shot::{Estimate, Shot, same_bits},
    stage::{Stage, cuboid, diffuse, look_at, material, medium, rectangle, rgb, white},
};
use steradian_core::{ColorMode, Scene};
use steradian_scene::{Family, Node};

/// Two rooms with a wall between them that leaves a gap; the lamp is in the room that is not seen.
fn gap(fog: bool) -> Stage {
    let mut stage = Stage::new();
    let wall = stage.add(material("diffuse").with("reflectance", rgb([0.8, 0.6, 0.4])));
    let rooms = stage.place_mesh(cuboid([-2.0, 0.0, -1.0], [2.0, 2.0, 1.0]));
    (rooms.material, rooms.reverse_orientation) = (Some(wall), true);
    stage.place_mesh(cuboid([-0.05, 0.0, -1.0], [0.05, 2.0, 0.7])).material = Some(wall);
    stage.mesh_lamp(rectangle([-1.6, 1.9, -0.6], [0.3, 0.0, 0.0], [0.0, 0.0, 0.3]), 40.0);
    stage.film(32, 32).look([1.8, 1.0, -0.8], [0.3, 0.8, 0.6], 70.0);
    if fog {
        let fog = stage.add(medium(white(0.02), white(0.2)));
        let camera = Node::new(Family::Camera, "perspective", None)
            .with("fov", 70.0)
            .with("to_world", look_at([1.8, 1.0, -0.8], [0.3, 0.8, 0.6]))
            .with("medium", fog);
        stage.camera(camera);
    }
    stage
}

/// Means of the quarters of a picture.
fn quarters(shot: Shot, scene: &Scene) -> [Estimate; 4] {
    let film = shot.take(scene);
    let (w, h) = (scene.film().width as usize, scene.film().height as usize);
    std::array::from_fn(|q| {
        let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
        for (i, p) in film.pixels.iter().enumerate() {
            if q == usize::from(i % w * 2 >= w) + 2 * usize::from(i / w * 2 >= h) {
                for c in 0..3 {
                    mean[c] += p.mean()[c] * 4.0 / (w * h) as f64;
                    variance[c] += p.variance_of_mean()[c] * (4.0 / (w * h) as f64).powi(2);
                }
            }
        }
        Estimate { mean, sigma: variance.map(f64::sqrt) }
    })
}

/// Enough samples for three rounds of training.
const SPP: u32 = 640;

/// 4σ for every quarter, on surfaces and in fog, in both colour modes; and less than half of the variance.
#[test]
fn a_field_changes_noise_alone() {
    for (name, fog, mode) in [("path", false, ColorMode::Rgb), ("volpath", true, ColorMode::Spectral)] {
        let scene = gap(fog).scene_in(mode);
        let shot = Shot::of(name, SPP).depth(6);
        let [alone, guided] = [false, true].map(|guiding| quarters(Shot { guiding: Some(guiding), ..shot }, &scene));
        let variance = |of: &[Estimate; 4]| of.iter().map(|e| e.sigma[1].powi(2)).sum::<f64>();
        assert!(
            variance(&guided) < 0.5 * variance(&alone),
            "{name} {mode:?}: {} {}",
            variance(&guided),
            variance(&alone)
        );
        for (q, (guided, alone)) in guided.iter().zip(&alone).enumerate() {
            guided.agrees(&format!("{name}, {mode:?}, quarter {q}"), *alone, 0.1);
        }
    }
}

/// A guided picture has the same bits on one thread and on three, and other bits than one without a guide.
#[test]
fn fields_are_the_same_on_every_run() {
    let scene = gap(false).scene();
    let shot = Shot { guiding: Some(true), ..Shot::of("path", 100).depth(6) };
    let film = shot.take(&scene);
    same_bits(&film, &Shot { threads: 3, ..shot }.take(&scene), "three threads");
    let alone = Shot { guiding: Some(false), ..shot }.take(&scene);
    assert!(film.pixels.iter().zip(&alone.pixels).any(|(a, b)| a.mean() != b.mean()), "nothing was guided");
}

/// A training tells whether it pays: through a gap it does, under an open lamp not.
#[test]
fn a_training_tells_whether_it_pays() {
    let mut open = Stage::new();
    let grey = open.add(diffuse(0.5));
    open.place_mesh(rectangle([-2.0, 0.0, 2.0], [4.0, 0.0, 0.0], [0.0, 0.0, -4.0])).material = Some(grey);
    open.mesh_lamp(rectangle([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), 5.0);
    open.film(32, 32).look([0.0, 1.0, -3.0], [0.0, 0.3, 0.0], 50.0);
    for (stage, pays) in [(gap(false), true), (open, false)] {
        let scene = stage.scene();
        let picture = |guiding| {
            let film = Shot { guiding, ..Shot::of("path", SPP).depth(4) }.take(&scene);
            film.pixels.iter().map(|p| p.mean().map(f64::to_bits)).collect::<Vec<_>>()
        };
        assert!(picture(None) == picture(Some(pays)), "pays: {pays}");
    }
}
