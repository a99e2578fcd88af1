//! The path of one sample of a pixel, as the path tracer of a render makes it.

use crate::{Error, Quality};
use steradian_core::Scene;
use steradian_integrators::{
    Depth,
    traced::{self, TracedPath},
};

/// A path, and which tracer it is of.
#[derive(Clone, Debug)]
pub struct SinglePath {
    /// The path.
    pub path: TracedPath,
    /// `path` or `volpath`.
    pub tracer: &'static str,
    /// True if the picture is made so; else the method follows no such paths, and this is the path of a path tracer for
    /// the pixel.
    pub is_of_picture: bool,
}

/// Traces sample `sample` of a pixel of the full frame, as a render of this quality begins it: with its sampler, seed
/// and depth, on its own, without what is done against noise (`reuse=1,effort=even,caustics=false`).
///
/// # Errors
/// [`Error`] for unknown names and options, and numbers that are too large; [`Error::OutOfRange`] for pixels outside
/// the frame.
pub fn trace_path(scene: &Scene, quality: &Quality, pixel: [u32; 2], sample: u32) -> Result<SinglePath, Error> {
    let film = scene.film();
    for (what, size, asked) in [("columns", film.width, pixel[0]), ("rows", film.height, pixel[1])] {
        if asked >= size {
            let most = size.saturating_sub(1) as usize;
            return Err(Error::OutOfRange { what, least: 0, most, asked: asked as usize });
        }
    }
    let render = quality.render(scene)?;
    let of_scene = Depth {
        max: quality.max_depth.unwrap_or(scene.settings().max_depth),
        roulette_after: scene.settings().rr_depth,
        hide_emitters: scene.settings().hide_emitters,
    };
    let (has_media, depth, is_of_picture) = match render.method.camera_paths() {
        Some(paths) if paths.is_plain => (paths.media, paths.depth, true),
        _ => (scene.has_media(), of_scene, false),
    };
    let path = traced::trace(scene, &render.plan.sampler, (has_media, depth), pixel, sample);
    Ok(SinglePath { path, tracer: if has_media { "volpath" } else { "path" }, is_of_picture })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CompileOptions, compile, render};
    use std::sync::Arc;
    use steradian_integrators::traced::{End, Event, VertexKind};
    use steradian_math::Vec3;

    const SIZE: u32 = 24;
    const PLAIN: &str = "reuse=1,effort=even,caustics=false";

    fn scene(name: &str) -> Arc<Scene> {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../");
        let name = if name.starts_with("builtin:") { name.into() } else { format!("{root}{name}") };
        of(&crate::load(&name, &Default::default()).desc)
    }

    fn of(desc: &steradian_scene::SceneDesc) -> Arc<Scene> {
        let options = CompileOptions { size: Some((SIZE, SIZE)), ..CompileOptions::default() };
        Arc::new(compile(desc, &options).scene.expect("a sound scene"))
    }

    fn light(path: &TracedPath) -> [f64; 3] {
        path.vertices.iter().fold([0.0; 3], |sum, v| {
            let direct = v.direct.map_or(Vec3::ZERO, |d| d.light);
            std::array::from_fn(|c| sum[c] + f64::from(v.emitted[c]) + f64::from(direct[c]))
        })
    }

    /// A path's value has the bits of the picture of one sample, and is the sum of what its vertices bring; the samples
    /// of a pixel have the mean that the picture of them has.
    #[test]
    fn paths_are_those_of_the_picture() {
        let mut ends = Vec::new();
        for (name, tracer) in [
            ("builtin:cornell-box", "path"),
            ("scenes/showcase.xml", "path"),
            ("scenes/verify/glass.pbrt", "path"),
            ("scenes/verify/dispersive.pbrt", "path"),
            ("scenes/verify/pool.pbrt", "path"),
            ("scenes/verify/fog.pbrt", "volpath"),
            ("scenes/subsurface.steradian", "path"),
            ("scenes/fluorescence.steradian", "path"),
        ] {
            let scene = scene(name);
            let one = Quality::of(&format!("{tracer}:{PLAIN}")).spp(1);
            let picture = render(&scene, &one).unwrap().to_rgb().unwrap();
            let (mut lit, mut longest) = (0, 0);
            for k in (0..SIZE * SIZE).step_by(5) {
                let pixel = [k % SIZE, k / SIZE];
                let SinglePath { path, is_of_picture, .. } = trace_path(&scene, &one, pixel, 0).unwrap();
                assert!(is_of_picture);
                assert_eq!(path.value.to_array(), picture[k as usize], "{name} {pixel:?}");
                // Each sum of two numbers rounds by half of the last place of the greatest on the way.
                let (sum, n) = (light(&path), path.vertices.len() as f64);
                let most = sum.iter().fold(f64::from(path.value.abs().max_element()), |m, v| m.max(v.abs()));
                for c in 0..3 {
                    let apart = (sum[c] - f64::from(path.value[c])).abs();
                    assert!(apart <= (n + 8.0) * 6e-8 * most, "{name} {pixel:?}: {sum:?} {:?}", path.value);
                }
                lit += u32::from(most > 0.0);
                longest = longest.max(path.vertices.len());
                ends.push(path.end);
            }
            assert!(lit > 20 && longest > 3, "{name}: {lit} {longest}");
        }
        for end in [End::Absorbed, End::Depth, End::Escaped, End::Roulette] {
            assert!(ends.contains(&end), "{end:?}");
        }
    }

    #[test]
    fn samples_make_up_the_pixel() {
        let scene = scene("builtin:cornell-box");
        let quality = Quality { seed: Some(5), ..Quality::of(&format!("path:{PLAIN}")).spp(6) };
        let picture = render(&scene, &quality).unwrap().to_rgb().unwrap();
        for pixel in [[0, 0], [7, 12], [12, 20], [23, 23]] {
            let mut sum = [0.0; 3];
            for sample in 0..6 {
                let value = trace_path(&scene, &quality, pixel, sample).unwrap().path.value;
                sum = std::array::from_fn(|c| sum[c] + f64::from(value[c]));
            }
            let mean = sum.map(|v| (v / 6.0) as f32);
            assert_eq!(mean, picture[(pixel[1] * SIZE + pixel[0]) as usize], "{pixel:?}");
        }
        let beyond = trace_path(&scene, &quality, [3, SIZE], 0).unwrap_err().to_string();
        assert!(beyond.contains("rows are whole numbers from 0 to 23, not 24"), "{beyond}");
    }

    /// A mirror in the plane z = 0 before a camera at z = -3: its image of the wall z = -10 is at z = 10, where the ray
    /// through the vertex on the mirror goes straight.
    #[test]
    fn mirrors_reflect_by_the_law() {
        let text = r#"LookAt 0 0 -3  0 0 0  0 1 0 Camera "perspective" "float fov" 40 Film "rgb" PixelFilter "box"
            WorldBegin
            AttributeBegin Material "conductor" "rgb reflectance" [0.5 0.25 1]
            Shape "trianglemesh" "point3 P" [-5 -5 0  -5 5 0  5 5 0  5 -5 0]
            "integer indices" [0 1 2 0 2 3] AttributeEnd
            AttributeBegin Material "diffuse" "rgb reflectance" [0 0 0] AreaLightSource "diffuse" "rgb L" [2 4 8]
            Shape "trianglemesh" "point3 P" [-40 -40 -10  40 -40 -10  40 40 -10  -40 40 -10]
            "integer indices" [0 1 2 0 2 3] AttributeEnd"#;
        let desc = crate::load_bytes("mirror.pbrt", text.as_bytes().to_vec(), Some("pbrt"), &Default::default()).desc;
        let options =
            CompileOptions { size: Some((SIZE, SIZE)), mode: Some(crate::ColorMode::Rgb), ..CompileOptions::default() };
        let scene = compile(&desc, &options).scene.expect("a sound scene");
        for (sample, pixel) in [(0, [2, 3]), (1, [12, 12]), (999, [23, 17])] {
            let SinglePath { path, tracer, is_of_picture } =
                trace_path(&scene, &Quality::of("bdpt"), pixel, sample).unwrap();
            assert_eq!((tracer, is_of_picture), ("path", false));
            let [camera, mirror, wall] = &path.vertices[..] else { panic!("{:?}", path.vertices) };
            assert_eq!((camera.kind, camera.position), (VertexKind::Camera, Vec3::new(0.0, 0.0, -3.0)));
            let Vec3 { x, y, .. } = mirror.position;
            assert!((mirror.position - Vec3::new(x, y, 0.0)).length() < 1e-6);
            let image = Vec3::new(x, y, 0.0) * (13.0 / 3.0);
            assert!((wall.position - Vec3::new(image.x, image.y, -10.0)).length() < 1e-5 * 10.0, "{wall:?}");
            let n = mirror.normal.unwrap();
            let reflected = mirror.direction - n * (2.0 * mirror.direction.dot(n));
            assert!((reflected - wall.direction).length() < 1e-6, "{reflected} {}", wall.direction);
            let Some(Event::Lobe(lobe)) = mirror.event else { panic!("{mirror:?}") };
            assert!(lobe.is_specular() && !lobe.is_transmission());
            assert_eq!((mirror.throughput, path.end), (Vec3::ONE, End::Absorbed));
            let seen = wall.throughput * Vec3::new(2.0, 4.0, 8.0);
            assert!((wall.emitted - seen).abs().max_element() < 1e-6 && path.value == wall.emitted);
        }
    }
}
