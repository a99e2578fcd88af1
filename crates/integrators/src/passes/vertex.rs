//! Vertices of subpaths, on surfaces and in media: scattering there, and towards another subpath.

use super::{
    subpath::{Sums, Ways, squared},
    surface::{Surface, View},
};
use steradian_bsdf::TransportMode;
use steradian_core::{Scene, light::LightContext, medium::Medium, scene::SHADOW_END};
use steradian_math::{Ray, Spectrum, Vec2, Vec3, spectra::Wavelengths};

/// Vertex of a subpath.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex<'s> {
    pub place: Place<'s>,
    /// Throughput of the subpath on arrival.
    pub beta: Spectrum,
    pub lambda: Wavelengths,
    /// Scattering events before this one.
    pub events: u32,
    pub sums: Sums,
    /// The medium that the subpath came through.
    pub medium: Option<u32>,
}

/// Matter that scatters at a vertex.
#[expect(
    clippy::large_enum_variant,
    reason = "values live on the stack of one step; a box would cost an allocation per vertex"
)]
#[derive(Clone, Copy, Debug)]
pub(super) enum Place<'s> {
    Surface(Surface<'s>),
    Medium(Within<'s>),
}

/// A point within a medium, which scatters by its phase function.
#[derive(Clone, Copy, Debug)]
pub(super) struct Within<'s> {
    pub p: Vec3,
    /// Back along the subpath.
    pub wo: Vec3,
    /// The moment of the exposure.
    pub time: f32,
    pub medium: &'s Medium,
}

/// `f |cos|` of a vertex for a direction, and the densities of the subpath going on and of another one coming back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattered {
    pub value: Spectrum,
    pub pdf: f32,
    pub reverse: f32,
}

/// A direction in which a subpath goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub wi: Vec3,
    /// Factor on the throughput of the subpath.
    pub weight: Spectrum,
    /// The relative index of refraction that was passed.
    pub eta: f32,
    /// Densities of going on and of coming back; `None` for specular events.
    pub densities: Option<(f32, f32)>,
    /// True if light subpaths come this way too.
    pub is_two_way: bool,
    /// True if it leads through the surface.
    pub is_transmission: bool,
}

impl Vertex<'_> {
    /// The point.
    #[inline]
    pub fn p(&self) -> Vec3 {
        match &self.place {
            Place::Surface(s) => s.i.surface.p,
            Place::Medium(m) => m.p,
        }
    }

    /// Index of the geometry whose surface it lies on.
    pub fn geometry(&self) -> Option<u32> {
        match &self.place {
            Place::Surface(s) => Some(s.i.geometry),
            Place::Medium(_) => None,
        }
    }

    /// True if connections find nothing here.
    #[inline]
    pub fn is_specular(&self) -> bool {
        matches!(&self.place, Place::Surface(s) if s.scattering.bsdf.is_specular())
    }

    /// True if it lies on a curve that faces the ray.
    #[inline]
    pub fn is_on_curve(&self) -> bool {
        matches!(&self.place, Place::Surface(s) if s.view == View::Curve)
    }

    /// The cosine between a direction and the surface; 1 in media, whose points have no orientation.
    #[inline]
    pub fn cos(&self, w: Vec3) -> f32 {
        match &self.place {
            Place::Surface(s) => s.i.surface.n.dot(w).abs(),
            Place::Medium(_) => 1.0,
        }
    }

    /// The square of the expected number of photons that merge here, per unit density: of [`Ways::merge`]. In media
    /// nothing merges.
    #[inline]
    pub fn merge(&self, ways: &Ways) -> f64 {
        match &self.place {
            Place::Surface(s) if s.view != View::Curve => ways.merge * squared(s.opacity),
            _ => 0.0,
        }
    }

    /// Scattering from where the subpath came towards `w`; `None` where it is nothing.
    #[inline]
    pub fn eval(&self, scene: &Scene, w: Vec3, mode: TransportMode) -> Option<Scattered> {
        match &self.place {
            Place::Surface(s) => s.eval((scene, &self.lambda), w, mode),
            // A phase function is its own density, from both sides.
            Place::Medium(m) => {
                let phase = m.medium.phase(m.wo, w);
                (phase > 0.0).then(|| Scattered { value: Spectrum::splat(phase), pdf: phase, reverse: phase })
            }
        }
    }

    /// A direction to go on in.
    pub fn sample(&self, scene: &Scene, u: f32, u2: Vec2, mode: TransportMode) -> Option<Drawn> {
        match &self.place {
            Place::Surface(s) => s.sample((scene, &self.lambda), u, u2, mode),
            Place::Medium(m) => {
                let (wi, pdf) = m.medium.sample_phase(m.wo, u2);
                Some(Drawn {
                    wi,
                    weight: Spectrum::ONE,
                    eta: 1.0,
                    densities: Some((pdf, pdf)),
                    is_two_way: true,
                    is_transmission: false,
                })
            }
        }
    }

    /// Reference point for light sampling: the same from both sides.
    #[inline]
    pub fn context(&self) -> LightContext {
        match &self.place {
            Place::Surface(s) => s.context(),
            Place::Medium(m) => LightContext { p: m.p, n: Vec3::ZERO },
        }
    }

    /// A ray that leaves in a direction.
    #[inline]
    pub fn spawn(&self, w: Vec3) -> Ray {
        match &self.place {
            Place::Surface(s) => s.i.spawn(w),
            Place::Medium(m) => Ray { time: m.time, ..Ray::new(m.p, w) },
        }
    }

    /// A ray to a point at a distance in a unit direction, that ends just before it.
    #[inline]
    pub fn spawn_towards(&self, w: Vec3, distance: f32) -> Ray {
        match &self.place {
            Place::Surface(s) => s.i.spawn_towards(w, distance),
            Place::Medium(_) => Ray { t_max: distance * SHADOW_END, ..self.spawn(w) },
        }
    }

    /// The medium that a direction leads through.
    #[inline]
    pub fn medium_towards(&self, scene: &Scene, w: Vec3) -> Option<u32> {
        match &self.place {
            Place::Surface(s) => scene.medium_towards(&s.i, w, self.medium),
            Place::Medium(_) => self.medium,
        }
    }
}
