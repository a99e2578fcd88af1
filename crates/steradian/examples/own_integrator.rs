//! An integrator of one's own: paths that find light by chance. Progress, layers and resuming come with the session:
//! `cargo run --release -p steradian --example own_integrator -- scenes/showcase.pbrt own.exr`

use std::{error::Error, fs::File, io::Write, path::Path, sync::Arc};
use steradian::bsdf::TransportMode;
use steradian::engine::{Integrator, PathContext, PerPixel, Session, dimension};
use steradian::math::{Ray, Spectrum};
use steradian::{Layer, Quality, image, transport::nee};

#[derive(Debug)]
pub(crate) struct ByChance;

impl Integrator for ByChance {
    type Prepared = ();
    fn radiance(&self, (): &(), mut ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        let PathContext { scene, sampler, lambda, counters } = context;
        let (mut sum, mut beta) = (Spectrum::ZERO, Spectrum::ONE);
        for event in 0..64 {
            counters.rays += 1;
            let Some(hit) = scene.intersect(&ray) else {
                return sum + beta * nee::background(scene, ray.origin, ray.direction, &None, lambda);
            };
            let i = scene.interaction(&ray, &hit);
            sum += beta * nee::emission(scene, &i, &None, lambda);
            let number = |purpose| sampler.get_1d(dimension::at(event, purpose));
            let Some((surface, frame)) = scene.scattering(&i, number(dimension::MIXTURE), lambda) else {
                ray = i.spawn(ray.direction);
                continue;
            };
            let (choice, u) = (number(dimension::LOBE), sampler.get_2d(dimension::at(event, dimension::DIRECTION)));
            let Some(s) = surface.sample(frame.to_local(i.wo), choice, u, TransportMode::Radiance) else { break };
            (beta, ray) = (beta * s.weight, i.spawn(frame.to_world(s.wi)));
        }
        sum
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let [file, output] = &names[..] else { return Err("usage: own_integrator SCENE OUT.exr".into()) };
    let (scene, messages) = steradian::open(file)?;
    messages.iter().try_for_each(|message| writeln!(std::io::stderr(), "{message}"))?;
    let quality = Quality { spp: Some(64), layers: vec![Layer::ALBEDO, Layer::NORMAL], ..Quality::default() };
    let mut session = PerPixel::per_pixel(Arc::clone(&scene), ByChance, quality.render(&scene)?.plan);
    File::open("own.state").ok().map_or(Ok(()), |mut state| session.restore(&mut state))?;
    while !session.is_done() {
        session.step(8, &Default::default());
        session.save(&mut File::create("own.state")?)?;
        writeln!(std::io::stderr(), "{} samples per pixel", session.samples())?;
    }
    let picture = steradian::develop(&scene, &session.film(), &quality.layers);
    Ok(image::write(Path::new(output), &picture, &Default::default())?)
}
