//! What becomes of the light that a path finds.

use crate::vertex::Vertex;
use steradian_math::{Spectrum, Vec3};

/// Where a path leaves the light that it finds, and what is told of its way. A sum alone asks for nothing else.
pub trait Sink {
    /// Adds light that set out where the path is.
    fn add(&mut self, light: Spectrum);

    /// Adds light that comes from infinity, from a direction, to the point from where the path's last ray goes there.
    #[inline]
    fn add_from_infinity(&mut self, light: Spectrum, _point: Vec3, _towards: Vec3) {
        self.add(light);
    }

    /// Whether light straight from a light is added with where it comes from, one light sample at a vertex.
    fn is_timed(&self) -> bool {
        false
    }

    /// Adds light that comes straight from a light in a direction, at a distance from the vertex where the path is.
    #[inline]
    fn add_direct(&mut self, light: Spectrum, _vertex: &Vertex<'_>, _towards: Vec3, _distance: f32) {
        self.add(light);
    }

    /// All is replaced by what is no light, which the film counts.
    fn spoil(&mut self, light: Spectrum);

    /// The path went on by a distance.
    #[inline]
    fn advance(&mut self, _distance: f32) {}

    /// The path crossed a surface, on whose other side the index of refraction is so many times what it was.
    #[inline]
    fn refract(&mut self, _eta: f32) {}

    /// The path was held back, s.
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
