//! Light that a picture lacks, since its integrator cannot find it.

use crate::{Film, Render, Scene};
use steradian_integrators::passes::missed_caustics;
use steradian_math::{Vec3, color::luminance};

/// Less than this part of the light is not worth a word.
const LEAST: f64 = 0.01;

/// The part of the light that is missing in a picture: caustics of points and parallel lights, which
/// no path from the camera finds. `None` where it is less than a hundredth, by an estimate.
pub fn missing_light(render: &Render, scene: &Scene, film: &Film) -> Option<f64> {
    let paths = render.method.camera_paths()?;
    let share = share_of(missed_caustics(scene, &paths.depth), film);
    (share >= LEAST).then_some(share)
}

/// The part of all light that is missing in a film.
pub(crate) fn share_of(missed: Vec3, film: &Film) -> f64 {
    let missed = f64::from(luminance(missed));
    let taken = film.pixels.iter().filter(|p| p.samples > 0);
    let (sum, count) = taken.fold((0.0, 0_usize), |(sum, n), p| {
        (sum + f64::from(luminance(Vec3::from_array(p.mean().map(|v| v as f32)))), n + 1)
    });
    if missed > 0.0 { missed / (missed + sum / count.max(1) as f64) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Control, Quality};
    use std::sync::Arc;

    /// The missing part of a room with a glass ball of a radius under a point light, and the mean of its picture.
    fn room(radius: f64, integrator: &str, spp: u32) -> (Option<f64>, f64) {
        let text = format!(
            r#"LookAt 0 0 -3.2  0 0 0  0 1 0  Camera "perspective" "float fov" 40
            Film "rgb" "integer xresolution" 24 "integer yresolution" 24  Sampler "independent"
            Integrator "path" "integer maxdepth" 5  WorldBegin
            LightSource "point" "point3 from" [0.4 0.9 0.1] "rgb I" [1 1 1]
            Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
            Shape "trianglemesh" "point3 P" [-1 -1 -1 -1 -1 1 1 -1 1 1 -1 -1] "integer indices" [0 1 2 0 2 3]
            Shape "trianglemesh" "point3 P" [-1 -1 1 -1 1 1 1 1 1 1 -1 1] "integer indices" [0 1 2 0 2 3]
            Material "dielectric"  Translate 0 -0.4 0.1  Shape "sphere" "float radius" {radius}"#
        );
        let loaded = crate::load_bytes("room.pbrt", text.into_bytes(), Some("pbrt"), &Default::default());
        let scene = Arc::new(crate::compile(&loaded.desc, &Default::default()).scene.expect("a sound scene"));
        let quality =
            Quality { integrator: Some(integrator.to_owned()), spp: Some(spp), threads: 2, ..Quality::default() };
        let render = quality.render(&scene).expect("a known integrator");
        let mut session = render.session(&scene).expect("a session");
        session.step(u32::MAX, &Control::default());
        let film = session.film();
        let mean = film.pixels.iter().map(|p| p.mean()[1]).sum::<f64>() / film.pixels.len() as f64;
        (missing_light(&render, &scene, &film), mean)
    }

    /// Light that is said to be missing is that which another method finds more.
    #[test]
    fn caustics_of_points_are_missed() {
        let (share, mean) = room(0.5, "path", 256);
        let (none, truth) = room(0.5, "bdpt", 256);
        let share = share.expect("a caustic");
        let found = 1.0 - mean / truth;
        assert!(found > 0.03 && (share / found - 1.0).abs() < 0.1, "{share} is said to be missing, {found} is");
        assert_eq!(none, None);
        // A hundredth and less is not worth a word.
        assert_eq!(room(0.06, "path", 64).0, None);
    }
}
