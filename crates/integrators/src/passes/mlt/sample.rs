//! A sample of the picture as a whole, as a function of the numbers of a chain: what it brings to the film, and its
//! target function.

use super::proposal::Proposal;
use crate::{
    Counters, dimension,
    passes::{
        bidirectional::Tracer,
        pair::{Joins, Technique},
        subpath::Numbers,
    },
};
use steradian_core::film::Splat;
use steradian_engine::{CameraSample, Run};
use steradian_math::{Vec2, color::luminance};

/// Contributions of a sample to the film, and its target function.
#[derive(Clone, Debug, Default)]
pub(super) struct Sample {
    pub splats: Vec<Splat>,
    pub importance: f32,
    /// Contributions of single techniques to the target function, of [`Joins::Listed`].
    pub parts: Vec<(Technique, f32)>,
}

impl Sample {
    /// The sample of the numbers as they are, joined by techniques.
    pub fn of(tracer: &Tracer, run: &Run<'_>, numbers: &Proposal, joins: Joins, counters: &mut Counters) -> Self {
        let (scene, film) = (run.scene, run.scene.film());
        // A place on the film, a camera ray, wavelengths and a moment: all from the coordinates of the chain.
        let size = Vec2::new(film.width as f32, film.height as f32);
        let margin = (film.filter.radius() - 0.5).max(Vec2::ZERO);
        // Filters of pixels at the edge reach beyond the frame.
        let at = numbers.two(dimension::FILM) * (size + 2.0 * margin) - margin;
        let ray = scene.camera().ray(film, at, numbers.two(dimension::LENS));
        let lambda = scene.mode().wavelengths(|| numbers.one(dimension::WAVELENGTH));
        let lambda = if scene.is_timed() { lambda.at_time(numbers.one(dimension::TIME)) } else { lambda };
        let sampler = run.sampler.pixel(0, 0, 0);
        let camera = CameraSample { at, ray, sampler, lambda, weight: 1.0 };
        // Bidirectional path tracing at that point of primary sample space.
        let found = tracer.connect(run, &camera, numbers, joins, counters);
        let (pixels, area) = (size.x * size.y, (size.x + 2.0 * margin.x) * (size.y + 2.0 * margin.y));
        let (mut splats, mut parts) = (found.splats, found.parts);
        splats.iter_mut().for_each(|s| s.rgb *= pixels);
        splats.push(Splat { at, rgb: found.own * area });
        splats.retain(|s| s.rgb.is_finite() && s.rgb != glam::Vec3::ZERO);
        parts.iter_mut().for_each(|(t, light)| *light *= if t.is_to_camera() { pixels } else { area });
        // Target function: luminance of everything that the sample adds to the film.
        let importance = splats.iter().map(|s| luminance(s.rgb.abs())).sum::<f32>();
        Self { importance: if importance.is_finite() { importance } else { 0.0 }, splats, parts }
    }

    /// The sample times a factor.
    pub fn times(mut self, k: f32) -> Self {
        self.splats.iter_mut().for_each(|s| s.rgb *= k);
        self.importance *= k;
        self
    }
}
