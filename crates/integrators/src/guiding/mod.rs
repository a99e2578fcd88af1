//! Path guiding: directions drawn by where paths found light before.
//!
//! A path tracer whose directions follow scattering alone finds light behind a door that is ajar by chance. So a part
//! of a picture's samples is spent on training ([`training`]): rounds of paths, each twice as many as the last one and
//! guided by what all before found. A round leaves a *field* ([`field`]): for kinds of vertices by their normals,
//! regions of space with about as many finds each ([`regions`](crate::regions)), and for each region a density of directions
//! ([`quadtree`]) in proportion to the light `f L |cosθ|` that they brought (Müller et al. 2017). The picture is
//! rendered with the field of the last round, which it does not change. So samples stay independent of each other, and
//! the mean is right whatever the field is; a render that goes on later trains the same field again.
//!
//! At a vertex the direction comes from one sample of a mixture of three densities: scattering, the field, and photons
//! that mirrors and glass focused ([`Caustics`]). Light that light samples find is weighted before it counts as found,
//! so that the field leads to what they miss.
//!
//! Finds take 24 bytes each while the field is trained, 2²² of them 96 MiB, and those of the round under way 32 bytes
//! each, 128 MiB at most; regions about 1 KiB each, of which there are about four thousand at most.

mod field;
mod quadtree;
mod training;

pub(crate) use field::Field;

use crate::{Stop, caustics::Caustics, path::PathTracer};
use steradian_core::Scene;
use steradian_math::{Vec2, Vec3};
use steradian_transport::{Directions, Guide, Vertex};

/// Guides of paths.
#[derive(Clone, Debug, Default)]
pub struct Guides {
    /// Photons that mirrors and glass focused.
    pub caustics: Option<Caustics>,
    /// Directions in which paths of a training found light.
    pub field: Option<Field>,
}

impl Guides {
    /// With a field trained for a picture of so many samples.
    pub(crate) fn trained<const MEDIA: bool>(
        self,
        scene: &Scene,
        path: &PathTracer<MEDIA>,
        samples: u64,
        stop: &Stop,
    ) -> Self {
        training::train(scene, path, self, samples, stop)
    }

    /// True if there may be a guide at a point after some scattering events, by whatever is there.
    #[inline]
    pub(crate) fn may_know(&self, p: Vec3, events: u32) -> bool {
        self.field.is_some() || self.caustics.as_ref().is_some_and(|caustics| caustics.reaches(p, events))
    }

    /// True if nothing guides.
    pub fn is_empty(&self) -> bool {
        self.caustics.is_none() && self.field.is_none()
    }
}

impl Guide for Guides {
    #[inline]
    fn at(&self, vertex: &Vertex<'_>, events: u32) -> Option<impl Directions> {
        let field = self.field.as_ref().and_then(|field| field.at(vertex, events));
        let caustics = self.caustics.as_ref().and_then(|caustics| caustics.at(vertex, events));
        (field.is_some() || caustics.is_some()).then_some(Both(field, caustics))
    }
}

/// Directions of two guides, of which at least one is there: the second one draws its share, the first one its share of
/// the rest.
struct Both<A, B>(Option<A>, Option<B>);

impl<A: Directions, B: Directions> Both<A, B> {
    /// Probabilities of the two among all directions.
    fn shares(&self) -> [f32; 2] {
        let second = self.1.as_ref().map_or(0.0, Directions::share);
        [self.0.as_ref().map_or(0.0, Directions::share) * (1.0 - second), second]
    }
}

impl<A: Directions, B: Directions> Directions for Both<A, B> {
    #[inline]
    fn share(&self) -> f32 {
        self.shares().iter().sum()
    }

    #[inline]
    fn sample(&self, u: f32, u2: Vec2) -> Vec3 {
        let [first, second] = self.shares();
        let part = second / (first + second);
        match self {
            Self(_, Some(b)) if u < part => b.sample(u / part, u2),
            Self(Some(a), _) => a.sample((u - part) / (1.0 - part), u2),
            Self(None, Some(b)) => b.sample(u, u2),
            Self(None, None) => Vec3::Z,
        }
    }

    #[inline]
    fn pdf(&self, w: Vec3) -> f32 {
        let [first, second] = self.shares();
        let of_first = self.0.as_ref().map_or(0.0, |a| first * a.pdf(w));
        let of_second = self.1.as_ref().map_or(0.0, |b| second * b.pdf(w));
        (of_first + of_second) / (first + second)
    }
}
