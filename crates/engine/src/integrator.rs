//! Interfaces of integrators: estimators of radiance, for single pixels and for groups.

use crate::{
    Counters, PathContext, Plan, Stop, dimension,
    partition::{Partition, Place},
};
use std::fmt::Debug;
use steradian_core::{
    Scene,
    sampler::{PixelSampler, Sampler},
};
use steradian_math::{Ray, Spectrum, Vec2, spectra::Wavelengths};

/// An estimator of radiance.
pub trait Integrator: Debug + Send + Sync {
    /// Prepared data of a scene, made before the first sample; `()` where there are none.
    type Prepared: Debug + Default + Send + Sync;

    /// Finds that out; of no use where a stop was asked for meanwhile.
    fn prepare(&self, _scene: &Scene, _plan: &Plan, _stop: &Stop) -> Self::Prepared {
        Self::Prepared::default()
    }

    /// True if there is a picture without the preparation, too: with the default of [`Self::Prepared`], where trials
    /// are skipped.
    fn works_unprepared(&self) -> bool {
        true
    }

    /// Number of time bins of a transient render, which layers show; 0 without bins.
    fn bins(&self) -> u32 {
        0
    }

    /// The radiance that arrives along a camera ray. A pure function of its arguments, counters aside.
    fn radiance(&self, prepared: &Self::Prepared, ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum;
}

/// An estimator that takes samples of several pixels at once, since they share what they find.
pub trait GroupIntegrator: Debug + Send + Sync {
    /// Prepared data of a scene, as [`Integrator::Prepared`].
    type Prepared: Debug + Default + Send + Sync;
    /// Buffer of a thread; kept, so that nothing is allocated per sample.
    type Buffer<'s>: Default;

    /// Makes the prepared data, as [`Integrator::prepare`].
    fn prepare(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Self::Prepared;

    /// True if there is a picture without the preparation, as [`Integrator::works_unprepared`].
    fn works_unprepared(&self) -> bool;

    /// Takes a sample for each pixel of a group.
    fn group<'s>(
        &self,
        scene: &'s Scene,
        prepared: &Self::Prepared,
        pixel_samples: &mut [PixelSample],
        buffer: &mut Self::Buffer<'s>,
        counters: &mut Counters,
    );

    /// Takes samples that share nothing, and says of each how many rays it took.
    fn wave<'s>(
        &self,
        scene: &'s Scene,
        prepared: &Self::Prepared,
        pixel_samples: &mut [PixelSample],
        buffer: &mut Self::Buffer<'s>,
        counters: &mut Counters,
    ) {
        for sample in pixel_samples {
            let before = counters.rays;
            self.group(scene, prepared, std::slice::from_mut(sample), buffer, counters);
            sample.rays = (counters.rays - before) as u32;
        }
    }

    /// Pixels of a group: 1, 4 or 16.
    fn group_size(&self, _prepared: &Self::Prepared) -> u32 {
        1
    }

    /// True if pixels of a plan share, or may, when the scene is prepared: [`Self::group_size`] is known after that.
    fn may_share(&self, _plan: &Plan) -> bool {
        false
    }

    /// Number of paths that a sample of a pixel is the mean of, up to [`MOST_PATHS`](crate::MOST_PATHS).
    fn paths(&self, _prepared: &Self::Prepared, _pixel: [u32; 2]) -> u32 {
        1
    }

    /// Probability that one camera sample finds the rarest paths that carry a good part of the light, where that is
    /// known.
    fn rarest_path_probability(&self, _prepared: &Self::Prepared) -> Option<f64> {
        None
    }

    /// True if photons guide paths towards caustics.
    fn asks_photons(&self, _prepared: &Self::Prepared) -> bool {
        false
    }

    /// Number of time bins, as [`Integrator::bins`].
    fn bins(&self) -> u32 {
        0
    }

    /// Most scattering events of a path.
    fn max_events(&self) -> u32 {
        u32::MAX
    }
}

/// Samples that know nothing of each other.
#[derive(Clone, Copy, Debug)]
pub struct OneByOne<I>(pub I);

impl<I: Integrator> GroupIntegrator for OneByOne<I> {
    type Prepared = I::Prepared;
    type Buffer<'s> = ();

    fn prepare(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> I::Prepared {
        self.0.prepare(scene, plan, stop)
    }

    fn works_unprepared(&self) -> bool {
        self.0.works_unprepared()
    }

    fn bins(&self) -> u32 {
        self.0.bins()
    }

    fn group(
        &self,
        scene: &Scene,
        prepared: &I::Prepared,
        pixel_samples: &mut [PixelSample],
        (): &mut (),
        counters: &mut Counters,
    ) {
        for s in pixel_samples {
            let mut context = PathContext { scene, sampler: &s.own, lambda: &mut s.lambda, counters };
            s.radiance = self.0.radiance(prepared, s.ray, &mut context);
        }
    }
}

/// A pixel's part in a group: one sample of it.
#[derive(Clone, Copy, Debug)]
pub struct PixelSample {
    /// The camera ray.
    pub ray: Ray,
    /// The pixel's own numbers, for the path up to x and light samples there.
    pub own: PixelSampler,
    /// Numbers stratified over the group, for all that follows.
    pub joint: PixelSampler,
    /// Wavelengths, the same for the whole group; afterwards without the secondary ones where the path dispersed.
    pub lambda: Wavelengths,
    /// The result.
    pub radiance: Spectrum,
    /// Rays that it took, where it shares none.
    pub rays: u32,
}

impl PixelSample {
    /// A sample of a pixel, by its number and the numbers of its group, and the weight that the film
    /// and the camera give it.
    pub fn at(scene: &Scene, sampler: &Sampler, partition: &Partition, index: u32, place: &Place) -> (Self, f32) {
        let film = scene.film();
        let own = sampler.pixel(place.x, place.y, index);
        let is_alone = partition.size() == 1;
        let joint = if is_alone { own } else { partition.joint(sampler, place, index) };
        let common = |dimension| match is_alone {
            true => own.get_1d(dimension),
            false => partition.common(sampler, place, index, dimension),
        };
        let (offset, weight) = film.filter.sample(own.get_2d(dimension::FILM));
        let point = Vec2::new(place.x as f32 + 0.5, place.y as f32 + 0.5) + offset;
        let lens = if scene.camera().lens_radius > 0.0 { own.get_2d(dimension::LENS) } else { Vec2::splat(0.5) };
        let lambda = scene.mode().wavelengths(|| common(dimension::WAVELENGTH));
        let mut lambda = if scene.is_timed() { lambda.at_time(common(dimension::TIME)) } else { lambda };
        let (ray, share) = scene.camera().sample(film, point, lens, &mut lambda);
        (Self { ray, own, joint, lambda, radiance: Spectrum::ZERO, rays: 0 }, weight * share)
    }
}
