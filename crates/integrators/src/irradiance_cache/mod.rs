//! Irradiance caching (Ward, Rubinstein, Clear 1988): indirect irradiance on Lambertian surfaces is computed at few
//! points by many rays, and interpolated between them. Direct light is found as `path` does, and so is all light on
//! other surfaces, behind which paths go on to the first Lambertian one. Since irradiance is kept, and not radiosity,
//! textures are exact. Where no record counts the path goes on, too.

mod filling;
mod hemisphere;
mod records;
#[cfg(test)]
mod tests;

use crate::{Depth, Integrator, Plan, Session, Stop, support};
pub use filling::Cache;
use hemisphere::{Hemisphere, Irradiance};
use records::Records;
use std::{f32::consts::FRAC_1_PI, sync::Arc};
use steradian_bsdf::Bsdf;
use steradian_core::{ColorMode, Scene};
use steradian_engine::{Asked, Feature, Method, MethodKind, PathContext, Refusal, Support, Tiles};
use steradian_math::{Ray, Spectrum, Vec3};
use steradian_transport::{Arrival, NoGuide, PathState, Vertex, arrive, escape, leaving};

/// Most bytes of records.
const MOST_BYTES: u64 = 2 << 30;

/// The settings.
#[derive(Clone, Copy, Debug)]
pub struct IrradianceCache {
    /// Rays of a record, about.
    pub rays: u32,
    /// Ward's `a`: the largest error of a record that counts, by the split-sphere model.
    pub error: f32,
    /// Enables gradients.
    pub gradients: bool,
    /// Least and largest reach of a record, in pixels.
    pub spacing: [f32; 2],
    /// Most records.
    pub records: u32,
    /// Wavelengths of records in spectral renders.
    pub wavelengths: u32,
    /// Path depth.
    pub depth: Depth,
}

/// `irradiance-cache`.
pub const IRRADIANCE_CACHE: MethodKind =
    MethodKind::new("irradiance-cache", |asked| Ok(Arc::new(IrradianceCache::of(asked))));

impl IrradianceCache {
    fn of(asked: &Asked<'_>) -> Self {
        let number = |name| asked.options.number(name).unwrap_or(1.0) as f32;
        Self {
            rays: asked.options.count("rays"),
            error: number("error"),
            gradients: asked.options.flag("gradients"),
            spacing: ["min_spacing", "max_spacing"].map(number),
            records: asked.options.count("records"),
            wavelengths: asked.options.count("wavelengths"),
            depth: asked.depth(),
        }
    }

    /// Makes the records of a scene.
    pub fn fill(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Cache {
        filling::fill(self, scene, plan, stop)
    }

    fn hemisphere(&self) -> Hemisphere {
        Hemisphere::new(self.rays)
    }

    fn bands(&self) -> usize {
        (self.wavelengths as usize).div_ceil(4)
    }

    /// The events by which records are told apart after so many; `None` where indirect light would be too deep.
    fn events(&self, events: u32) -> Option<u32> {
        match self.depth.max {
            u32::MAX => Some(0),
            max => (events.saturating_add(2) <= max).then_some(events),
        }
    }
}

/// The reflectance of a Lambertian surface seen from its front, and its normal.
#[inline]
fn lambertian(vertex: &Vertex<'_>) -> Option<(Spectrum, Vec3)> {
    let Vertex::Surface { i, scattering, frame, .. } = vertex else { return None };
    match &scattering.bsdf {
        Bsdf::Diffuse(b) if frame.to_local(i.wo).z > 0.0 => Some((b.reflectance, frame.z)),
        _ => None,
    }
}

impl Method for IrradianceCache {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::Media => Support::Refuses(""),
            Feature::Motion => Support::Refuses("records hold the light of one moment"),
            Feature::Bands => Support::Approximates("records know the light at a few wavelengths"),
            Feature::Denoising => Support::Refuses("neighbouring pixels share records, so that their errors are alike"),
            _ => support::of_local_scattering(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        let [least, most] = self.spacing;
        if least > most {
            return Err(Refusal(format!("'min_spacing' ({least}) is at most 'max_spacing' ({most})")));
        }
        let bands = if scene.mode() == ColorMode::Rgb { 1 } else { self.bands() };
        let (each, count) = (Records::bytes(bands), u64::from(self.records));
        if each * count > MOST_BYTES {
            return Err(Refusal(format!(
                "{count} records of {each} bytes take {} MiB; at most {} records fit into {} MiB ('records')",
                (each * count) >> 20,
                MOST_BYTES / each,
                MOST_BYTES >> 20,
            )));
        }
        Ok(Box::new(Tiles::per_pixel(scene, *self, plan)))
    }
}

impl Integrator for IrradianceCache {
    type Prepared = Option<Cache>;

    fn prepare(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Self::Prepared {
        Some(self.fill(scene, plan, stop))
    }

    fn radiance(&self, cache: &Self::Prepared, ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        let mut state = PathState::camera(context.scene, ray);
        let (mut light, mut arrival) = (Spectrum::ZERO, Arrival::End);
        loop {
            arrive::<false>(&mut state, &self.depth, &mut light, &mut arrival, context);
            let vertex = match &arrival {
                Arrival::Vertex(vertex) => vertex,
                Arrival::End => return light,
                Arrival::Escaped => {
                    escape(&state, &self.depth, &mut light, context);
                    return light;
                }
            };
            // Lambertian surfaces that records cover end the path: ρ E/π, and direct light, whose paths have one event
            // more.
            let kept = cache.as_ref().zip(lambertian(vertex)).zip(self.events(state.events));
            let kept = kept.and_then(|((cache, (reflectance, n)), events)| {
                let lambda = &*context.lambda;
                let of = |bands: &[Irradiance], place, normal| cache.bands.of(|k| bands[k].at(place, normal), lambda);
                cache.records.at(vertex.p(), n, events, of).map(|e| reflectance * e * FRAC_1_PI)
            });
            if let Some(indirect) = kept {
                let direct = Depth { max: state.events + 1, ..self.depth };
                light += state.beta * indirect;
                return leaving::<false, _>(vertex, state, direct, None::<&NoGuide>, context, light);
            }
            // Others scatter as in path tracing.
            state.add_direct::<false>(vertex, &mut light, context);
            let Some(drawn) = state.sample(vertex, context.sampler, None::<&NoGuide>) else { return light };
            state.turn::<false>(context.scene, vertex, &drawn);
            if !state.beta.is_finite() {
                return state.beta;
            }
            if !state.survives(&self.depth, context) {
                return light;
            }
        }
    }
}
