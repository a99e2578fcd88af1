//! Pictures by the graphics pipeline: the integrator `raster`.

use crate::{Error, Quality};
use std::time::{Duration, Instant};
use steradian_core::Scene;
use steradian_integrators::Film;
pub use steradian_realtime::Options;

/// Name and description of the integrator, for the registry.
pub const RASTER: (&str, &str) = (
    "raster",
    "what is seen by the graphics pipeline, direct light on it, and mirrors and glass by rays, at once: one sample per pixel unless --spp says otherwise; shadows (ray, none, of maps: map, cube, trapezoid, perspective, cascades, variance, moments, pcss; volume, volume-pass, planar), size (1024), bias (1.5), bias-by (slope, constant, normal, plane), pcf (1), cascades (4) of shadow maps, visibility (zbuffer, painter, bsp, newell, warnock), points (4) on each light, bounces (8), show (picture, depth, normal, primitives, overdraw, wireframe, clip, tiles, stencil, shadow-map)",
);

/// A finished render.
#[derive(Debug)]
pub struct Rendered {
    /// The film, without first hits.
    pub film: Film,
    /// Samples per pixel.
    pub spp: u32,
    /// Rays traced.
    pub rays: u64,
    /// Samples that were not finite.
    pub nonfinite: u64,
    /// What is to be said of it.
    pub notes: Vec<String>,
    /// Wall time.
    pub wall: Duration,
    /// Time of all processors.
    pub cpu: Duration,
}

/// The options of the integrator `raster`, where it is the one that the quality or the scene asks for.
///
/// # Errors
/// [`Error::Raster`] for options that do not exist, [`Error::OutOfRange`] for a number that is too large.
pub fn options(quality: &Quality, scene: &Scene) -> Result<Option<Options>, Error> {
    quality.check()?;
    let asked = quality.integrator.as_deref().unwrap_or(&scene.settings.integrator);
    let (name, options) = asked.split_once(':').unwrap_or((asked, ""));
    if name == RASTER.0 { Ok(Some(Options::parse(options)?)) } else { Ok(None) }
}

/// Renders a scene. Without a number of samples, one per pixel is taken.
///
/// # Errors
/// [`Error::Raster`] for scenes that the pipeline cannot take.
pub fn render(scene: &Scene, quality: &Quality, options: &Options) -> Result<Rendered, Error> {
    let (start, cpu) = (Instant::now(), cpu_time());
    let spp = quality.spp.unwrap_or(1).max(1);
    let picture = steradian_realtime::render(scene, spp, options)?;
    let film = Film {
        crop: scene.film.crop,
        pixels: picture.pixels,
        features: Vec::new(),
        mattes: Vec::new(),
        by_light: Vec::new(),
    };
    let (rays, nonfinite, notes) = (picture.rays, picture.nonfinite, picture.notes);
    Ok(Rendered { film, spp, rays, nonfinite, notes, wall: start.elapsed(), cpu: cpu_time().saturating_sub(cpu) })
}

/// CPU time of all threads of this process.
fn cpu_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(t.tv_sec as u64, t.tv_nsec as u32)
}
