//! A method by passes of one's own: rays through places anywhere on the film, each of which shows the albedo of what it
//! meets, spread by the pixel filter. Errors, layers and resuming come with the session:
//! `cargo run --release -p steradian --example own_pass -- scenes/showcase.pbrt own.exr`
#![expect(clippy::print_stderr, reason = "output of the program")]

use std::{error::Error, path::Path, sync::Arc};
use steradian::engine::{Control, Counters, Pass, Passes, Run, Session, Sight, first_hit};
use steradian::film::{PassFilm, Splat};
use steradian::math::{Vec2, Vec3};
use steradian::{Layer, Quality, image};

#[derive(Debug)]
pub(crate) struct Sprinkled;

impl Pass for Sprinkled {
    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let (camera, spec) = (run.scene.camera(), run.scene.film());
        let size = Vec2::new(spec.width as f32, spec.height as f32);
        // Pieces of work, on all threads; what they find is added in their order, so bits do not depend on threads.
        let (rows, counters) = run.in_order(spec.height as usize, |row, counters| {
            let splat = |column| {
                let sampler = run.sampler.pixel(column, row as u32, number);
                let at = sampler.get_2d(0) * size;
                let ray = camera.ray(spec, at, sampler.get_2d(1));
                counters.rays += 1;
                counters.samples += 1;
                // As many rays as pixels: each stands for the area of one.
                Splat {
                    at,
                    rgb: Vec3::from_array(
                        first_hit(run.scene, ray, &run.wavelengths(&sampler), Sight::default(), None).albedo,
                    ),
                }
            };
            (0..spec.width).map(splat).collect::<Vec<_>>()
        })?;
        rows.iter().flatten().for_each(|splat| film.splat(splat));
        Some(counters)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let [file, output] = &names[..] else { return Err("usage: own_pass SCENE OUT.exr".into()) };
    let (scene, messages) = steradian::open(file)?;
    messages.iter().for_each(|message| eprintln!("{message}"));
    let quality = Quality { spp: Some(64), layers: vec![Layer::DEPTH, Layer::VARIANCE], ..Quality::default() };
    let mut session = Passes::new(Arc::clone(&scene), Sprinkled, quality.render(&scene)?.plan);
    while !session.is_done() {
        session.step(8, &Control::default());
        eprintln!("{} samples per pixel, relative error {:?}", session.samples(), session.error());
    }
    let picture = steradian::develop(&scene, &session.film(), &quality.layers);
    Ok(image::write(Path::new(output), &picture, &Default::default())?)
}
