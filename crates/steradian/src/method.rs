//! A method with what it is to render: what a [`Quality`](crate::Quality) comes to for a scene.

use crate::{Error, Plan, Scene, Session};
use std::sync::Arc;
use steradian_engine::Passes;
use steradian_integrators::{Depth, IntegratorKind};
use steradian_realtime::{FrameKind, Hybrid, Options, Preview, Rasterizer};

/// A way to make pictures.
#[derive(Clone, Copy, Debug)]
pub enum Method {
    /// Light transport by rays.
    Rays(IntegratorKind),
    /// The graphics pipeline, with the most scattering events.
    Pipeline(Options, Depth),
}

/// A method, and what is asked of it.
#[derive(Clone, Copy, Debug)]
pub struct Render {
    /// The method.
    pub method: Method,
    /// What is asked.
    pub plan: Plan,
}

/// Bytes per pixel of a film while it is rendered, copied, developed and encoded, for `layers` auxiliary layers.
///
/// A pixel's sums take 56 bytes and those of its first hits 64, both twice while the film is copied; a layer has up to
/// three planes of four bytes, that are there again in the encoded file.
pub fn film_bytes_per_pixel(layers: usize) -> u64 {
    let sums = 56 + if layers > 0 { 64 } else { 0 };
    2 * sums + 2 * 12 * (1 + layers as u64)
}

impl Render {
    /// Bytes of the film while it is rendered, copied, developed and encoded, with so many layers that were asked for.
    /// Mattes, the light of groups, intervals of arrival and halves count for themselves.
    pub fn film_bytes(&self, scene: &Scene, layers: usize) -> u64 {
        // Mattes are counted apart from other layers, and have eight times as many planes.
        let mattes = if self.plan.mattes { 16 } else { 0 };
        let groups = if self.plan.by_light { 3 * scene.light_groups().names.len() } else { 0 };
        let bins = self.integrator().map_or(0, |i| 3 * i.bins() as usize);
        // Sums of even number beside those of all, and two more pictures.
        let halves = if self.plan.halves { 8 } else { 0 };
        let crop = scene.film().crop;
        let pixels = u64::from(crop.width()) * u64::from(crop.height());
        pixels.saturating_mul(film_bytes_per_pixel(layers + mattes + groups + bins + halves))
    }

    /// The integrator, of methods by rays.
    pub fn integrator(&self) -> Option<&IntegratorKind> {
        match &self.method {
            Method::Rays(integrator) => Some(integrator),
            Method::Pipeline(..) => None,
        }
    }

    /// Why a denoiser cannot tell noise in the picture: where what pixels err is not independent, or not noise.
    pub fn not_denoisable(&self, scene: &Scene) -> Option<&'static str> {
        match &self.method {
            _ if scene.film().sensor.is_some() => Some("the film adds the noise of a sensor, which is to stay"),
            Method::Pipeline(..) => {
                Some("rasterisation has no noise of paths (its frames frame=hybrid are denoised already)")
            }
            Method::Rays(IntegratorKind::Radiosity(_)) => Some("patches err, not pixels"),
            Method::Rays(IntegratorKind::Stokes(_)) => Some("Stokes parameters are no radiance"),
            Method::Rays(IntegratorKind::Transient(_)) => Some("the layers of arrival times would keep their noise"),
            Method::Rays(IntegratorKind::Passes(kind)) => kind.correlates().then_some(
                "neighbouring pixels share photons or light paths, so that their errors are alike; \
                 'path', 'volpath' and 'bdpt' can",
            ),
            Method::Rays(_) => None,
        }
    }

    /// Why there are no halves of samples that err independently: what a denoiser cannot take, and a single sample.
    pub fn no_halves(&self, scene: &Scene) -> Option<String> {
        if self.plan.sampler.spp < 2 {
            return Some("the layer 'halves' with one sample per pixel; it takes two or more".into());
        }
        self.not_denoisable(scene).map(|why| format!("the layer 'halves': {why}"))
    }

    /// Starts with an empty film.
    ///
    /// # Errors
    /// [`Error::Raster`] for scenes that the pipeline cannot take.
    pub fn session(&self, scene: &Arc<Scene>) -> Result<Box<dyn Session>, Error> {
        Ok(match self.method {
            Method::Rays(integrator) => integrator.session(Arc::clone(scene), self.plan),
            Method::Pipeline(options, depth) => {
                let local = scene.is_for_paths_alone().then(|| Arc::new(Scene::clone(scene).with_local_scattering()));
                let scene = local.as_ref().unwrap_or(scene);
                if options.frame == FrameKind::Hybrid {
                    let hybrid = Hybrid::new(scene, options, depth, &self.plan)?;
                    return Ok(Box::new(Passes::new(Arc::clone(scene), hybrid, self.plan)));
                }
                if options.frame == FrameKind::Preview {
                    let preview = Preview::new(scene, options, depth, &self.plan)?;
                    return Ok(Box::new(Passes::new(Arc::clone(scene), preview, self.plan)));
                }
                let rasterizer = Rasterizer::new(scene, options, depth, &self.plan)?;
                Box::new(Passes::new(Arc::clone(scene), rasterizer, self.plan))
            }
        })
    }
}
