//! Sinks: receivers of the light that a path finds.

use crate::vertex::Vertex;
use steradian_bsdf::BsdfSample;
use steradian_core::scene::Interaction;
use steradian_math::{Ray, Spectrum, Vec3};

/// The last segment of a path.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Its ray.
    pub ray: Ray,
    /// The path throughput along it.
    pub beta: Spectrum,
    /// Scattering events so far.
    pub events: u32,
}

/// Event of a path. A sink that keeps these has the path itself.
#[derive(Clone, Copy, Debug)]
pub enum Step<'a> {
    /// A surface is met. What it emits is added next.
    Surface(Segment, &'a Interaction),
    /// The path scatters at this point of a medium.
    Medium(Segment, Vec3),
    /// Nothing is met. What environments emit is added next.
    Escaped(Segment),
    /// The surface scatters nothing, and the path goes on behind it.
    Passed,
    /// The path goes on by this sample, in the frame of its vertex.
    Scattered(&'a BsdfSample),
    /// Russian roulette ends the path.
    Roulette,
}

/// Receives a path's contributions, and is told what happens to it. A [`Spectrum`] is one: it adds the contributions
/// up.
pub trait Sink {
    /// Adds a contribution that is emitted at the path's current vertex.
    fn add(&mut self, light: Spectrum);

    /// Adds the contribution of an infinite light in direction `towards`, seen from the origin of the path's last ray.
    #[inline]
    fn add_from_infinity(&mut self, light: Spectrum, _point: Vec3, _towards: Vec3) {
        self.add(light);
    }

    /// True if direct light is given by [`Sink::add_direct`], with one light sample at each vertex.
    fn is_timed(&self) -> bool {
        false
    }

    /// Adds direct light of a light sample in direction `towards`, at a distance from the path's current vertex.
    #[inline]
    fn add_direct(&mut self, light: Spectrum, _vertex: &Vertex<'_>, _towards: Vec3, _distance: f32) {
        self.add(light);
    }

    /// Replaces the whole result by a value that is not finite; the film counts such samples and leaves them out.
    fn spoil(&mut self, light: Spectrum);

    /// The path took a step. Told where it happens, in the order of the path.
    #[inline(always)]
    fn tell(&mut self, _step: Step<'_>) {}

    /// The path was extended by a segment of this length.
    #[inline]
    fn advance(&mut self, _distance: f32) {}

    /// The path crossed a surface; the index of refraction beyond it is `eta` times the one before.
    #[inline]
    fn refract(&mut self, _eta: f32) {}

    /// The path was delayed at a vertex, by seconds.
    #[inline]
    fn wait(&mut self, _seconds: f32) {}
}

impl Sink for Spectrum {
    #[inline(always)]
    fn add(&mut self, light: Spectrum) {
        *self += light;
    }

    #[inline(always)]
    fn spoil(&mut self, light: Spectrum) {
        *self = light;
    }
}
