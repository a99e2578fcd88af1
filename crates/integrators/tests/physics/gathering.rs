//! `gather`: many directions at each surface, against paths and closed forms.

use crate::{
    shot::{Shot, mean},
    stage::{Stage, diffuse, shape, sphere},
};
use steradian_core::Scene;
use steradian_integrators::Control;

/// A room that emits nothing but from a ball below its ceiling.
fn room() -> Scene {
    let mut stage = Stage::new();
    stage.solid(sphere([0.0, 0.0, 0.0], 2.0), diffuse(0.6));
    stage.lamp(sphere([0.3, 1.2, 0.2], 0.4), 3.0);
    stage.probe([0.0, 0.0, -0.5], [0.2, -1.0, 0.4]);
    stage.scene()
}

fn film(scene: &Scene, options: &str, shot: Shot) -> (steradian_integrators::Film, u64) {
    let method = shot.method(scene, options);
    let mut session = shot.session_of(scene, &*method);
    session.step(u32::MAX, &Control::default());
    (session.film(), session.counters().rays)
}

/// M159: gathering at two surfaces is the light of paths of up to two scattering events, whatever the number of rays.
/// M152: one sample has up to 1 + N + N² rays.
#[test]
fn gathering_is_the_integral_of_two_bounces() {
    let scene = room();
    let paths = mean(&Shot::of("path", 60_000).depth(2).take(&scene));
    for rays in [1_u64, 4, 9] {
        let spp = 200_000 / (rays * rays) as u32;
        let shot = Shot::of("gather", spp).depth(2).seed(rays);
        let (film, counted) = film(&scene, &format!("rays={rays}"), shot);
        mean(&film).agrees(&format!("{rays} rays"), paths, 0.03);
        // Rays that meet the lamp, which scatters nothing, end there.
        let full = u64::from(spp) * film.pixels.len() as u64 * (1 + rays + rays * rays);
        assert!(counted <= full && counted * 10 > full * 9, "{rays} rays: {counted} of {full}");
    }
}

/// M145: below a ball of radiance L that is seen under the angle θ the radiance is ρ L sin²θ. The midpoint rule has the
/// same error whatever the seed, and less of it the finer the grid.
#[test]
fn grids_are_biased_and_without_noise() {
    let mut stage = Stage::new();
    stage.solid(shape("disk").with("radius", 1e-3), diffuse(0.5));
    stage.lamp(sphere([0.0, 0.0, 2.0], 0.8_f64.sqrt()), 1.0);
    stage.probe([0.2, 0.1, 0.5], [0.0, 0.0, 0.0]);
    let scene = stage.scene();
    let right = 0.5 * 0.2;
    let by = |directions: &str, rays: u32, seed: u64| {
        let shot = Shot::of("gather", 1).depth(1).seed(seed);
        mean(&film(&scene, &format!("directions={directions},rays={rays}"), shot).0).mean[0]
    };
    let error = |rays: u32| (by("grid", rays, 1) / right - 1.0).abs();
    for rays in [16, 256, 4096] {
        let (first, second) = (by("grid", rays, 1), by("grid", rays, 2));
        assert!((first - second).abs() < 1e-3 * right, "{rays}: {first} and {second}");
    }
    assert!(by("random", 16, 1) != by("random", 16, 2));
    // The border of the ball cuts cells: the error falls no faster than their size.
    let errors = [16, 4096, 65536].map(error);
    assert!(errors[0] > 0.1 && errors[1] < 0.05 && errors[2] < 0.01, "{errors:?}");
}

/// Beyond the bound trees go on by single rays, which roulette ends: no light is left out.
#[test]
fn bounded_trees_leave_no_light_out() {
    let scene = room();
    let paths = mean(&Shot::of("path", 100_000).roulette_after(2).take(&scene));
    for (branches, most) in [(1, 4), (20, 16), (64, 64)] {
        let spp = 100_000 / most;
        let shot = Shot::of("gather", spp).roulette_after(2);
        let (film, _) = film(&scene, &format!("rays=4,branches={branches}"), shot);
        mean(&film).agrees(&format!("{branches} branches"), paths, 0.03);
    }
}
