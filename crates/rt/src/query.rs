//! Ray queries: tracing in the middle of any code, without shaders (DXR, "Inline raytracing"; Vulkan, `rayQueryEXT`).

use crate::committed::Committed;
use crate::context::TraceRay;
use crate::error::RayError;
use crate::flags::RayFlags;
use crate::queue::Candidate;
use crate::ray::{Barycentrics, HitKind, Primitive, RayDesc, RayValues};
use crate::search::Search;
use crate::top_level::TopLevel;

/// A ray on its way through a structure.
///
/// ```
/// use std::sync::Arc;
/// use steradian_math::Vec3;
/// use steradian_rt::*;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [Vec3::ZERO, Vec3::Y, Vec3::X];
/// let leaf = TriangleGeometry::new(&corners).with_flags(GeometryFlags::NONE);
/// let leaf = BottomLevel::build(Geometries::Triangles(&[leaf]), BuildOptions::default())?;
/// let scene = TopLevel::build(&[Instance::new(Arc::new(leaf))], BuildOptions::default())?;
///
/// let ray = RayDesc::new(Vec3::new(0.25, 0.25, -1.0), Vec3::Z);
/// let mut query = RayQuery::new(Some(&scene), RayFlags::NONE, 0xff, ray)?;
/// while let Some(candidate) = query.proceed() {
///     if let QueryCandidate::Triangle(mut triangle) = candidate {
///         // Here a texture would say whether there is anything.
///         triangle.confirm();
///     }
/// }
/// let hit = query.committed().expect("the triangle was confirmed");
/// assert_eq!((hit.t, hit.kind), (1.0, HitKind::TRIANGLE_FRONT_FACE));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct RayQuery<'a> {
    search: Search<'a>,
}

/// A hit that has been committed.
#[derive(Clone, Copy, Debug)]
pub struct CommittedHit<'a> {
    /// Ray parameter (`CommittedRayT`).
    pub t: f32,
    /// The primitive hit.
    pub primitive: Primitive<'a>,
    /// Which face of a triangle, or the number that the caller gave to a procedural hit.
    pub kind: HitKind,
    /// Position in the triangle; zero for procedural hits.
    pub barycentrics: Barycentrics,
}

/// Candidate hit that the caller of a query must decide.
#[derive(Debug)]
pub enum QueryCandidate<'q, 'a> {
    /// A hit on a triangle that is not opaque.
    Triangle(TriangleCandidate<'q, 'a>),
    /// A procedural primitive that the ray may meet.
    Procedural(ProceduralCandidate<'q, 'a>),
}

/// A hit on a triangle that is not opaque. It is in the interval.
#[derive(Debug)]
pub struct TriangleCandidate<'q, 'a> {
    query: &'q mut RayQuery<'a>,
    candidate: Candidate,
    primitive: Primitive<'a>,
    barycentrics: Barycentrics,
}

/// A procedural primitive that the ray may meet.
#[derive(Debug)]
pub struct ProceduralCandidate<'q, 'a> {
    query: &'q mut RayQuery<'a>,
    candidate: Candidate,
    primitive: Primitive<'a>,
}

impl<'a> RayQuery<'a> {
    /// A query that has not begun (`TraceRayInline`, `rayQueryInitializeEXT`). Without a structure nothing is hit. Of
    /// the mask only the low 8 bits count: instances whose mask has none of them are not met.
    ///
    /// # Errors
    /// A ray with a NaN or an interval that is none, flags that exclude each other, or
    /// [`RayFlags::SKIP_CLOSEST_HIT_SHADER`].
    #[inline]
    pub fn new(scene: Option<&'a TopLevel>, flags: RayFlags, mask: u32, ray: RayDesc) -> Result<Self, RayError> {
        if flags.contains(RayFlags::SKIP_CLOSEST_HIT_SHADER) {
            return Err(RayError::SkipClosestHitInQuery);
        }
        let flags = flags.validated()?;
        ray.check()?;
        let call = TraceRay { scene, flags, mask, ray_contribution: 0, geometry_multiplier: 0, miss_index: 0, ray };
        Ok(Self { search: Search::new(call, Vec::new()) })
    }

    /// Goes on to what must be asked about next (`Proceed`, `rayQueryProceedEXT`); `None` when the search is over.
    /// Candidates come from near to far; of those at equal distance, the one with the smaller
    /// [`PrimitiveId`](crate::PrimitiveId) first. A procedural primitive has the distance where the ray enters its box.
    #[inline]
    pub fn proceed(&mut self) -> Option<QueryCandidate<'_, 'a>> {
        let candidate = self.search.proceed()?;
        let primitive = Primitive::new(self.search.call.scene?, candidate.id, &self.search.call.ray)?;
        Some(match candidate.triangle {
            Some(barycentrics) => {
                QueryCandidate::Triangle(TriangleCandidate { query: self, candidate, primitive, barycentrics })
            }
            None => QueryCandidate::Procedural(ProceduralCandidate { query: self, candidate, primitive }),
        })
    }

    /// Ends the search: [`RayQuery::proceed`] gives `None` from now on (`Abort`, `rayQueryTerminateEXT`).
    pub fn terminate(&mut self) {
        self.search.end();
    }

    /// The nearest hit that has been committed up to now.
    #[inline]
    pub fn committed(&self) -> Option<CommittedHit<'a>> {
        let Committed { t, id, kind, barycentrics } = self.search.committed?;
        let primitive = Primitive::new(self.search.call.scene?, id, &self.search.call.ray)?;
        let kind = kind.unwrap_or_else(|| primitive.face());
        Some(CommittedHit { t, primitive, kind, barycentrics })
    }

    /// The ray; `t_current` is where its interval ends now.
    pub fn ray(&self) -> RayValues {
        self.search.call.values(self.search.t_current())
    }
}

impl<'a> TriangleCandidate<'_, 'a> {
    /// Ray parameter (`CandidateTriangleRayT`).
    #[inline]
    pub fn t(&self) -> f32 {
        self.candidate.t
    }

    /// Position in the triangle.
    #[inline]
    pub fn barycentrics(&self) -> Barycentrics {
        self.barycentrics
    }

    /// True if the triangle is front-facing (`CandidateTriangleFrontFace`).
    pub fn is_front_face(&self) -> bool {
        self.primitive.face() == HitKind::TRIANGLE_FRONT_FACE
    }

    /// The triangle.
    pub fn primitive(&self) -> &Primitive<'a> {
        &self.primitive
    }

    /// The hit counts (`CommitNonOpaqueTriangleHit`, `rayQueryConfirmIntersectionEXT`). To confirm it again changes
    /// nothing.
    #[inline]
    pub fn confirm(&mut self) {
        self.query.search.commit_triangle(&self.candidate);
    }

    /// Ends the search.
    pub fn terminate(self) {
        self.query.terminate();
    }
}

impl<'a> ProceduralCandidate<'_, 'a> {
    /// True if geometry, instance and ray make it non-opaque (`CandidateProceduralPrimitiveNonOpaque`). The consequence
    /// is up to the caller.
    pub fn is_non_opaque(&self) -> bool {
        !self.candidate.is_opaque
    }

    /// The primitive.
    pub fn primitive(&self) -> &Primitive<'a> {
        &self.primitive
    }

    /// The ray; `t_current` is where its interval ends now.
    pub fn ray(&self) -> RayValues {
        self.query.ray()
    }

    /// There is a hit on it (`CommitProceduralPrimitiveHit`, `rayQueryGenerateIntersectionEXT`), with a number of the
    /// caller's. Gives whether it counts: where `t` is outside of `t_min <= t <= t_current`, or the search is over, it
    /// does not. May be called several times.
    pub fn generate(&mut self, t: f32, kind: HitKind) -> bool {
        let search = &mut self.query.search;
        let counts = !search.is_done() && t >= search.call.ray.t_min && t <= search.t_current() && !kind.is_triangle();
        if counts {
            let id = self.candidate.id;
            search.commit(Committed { t, id, kind: Some(kind), barycentrics: Barycentrics::default() });
        }
        counts
    }

    /// Ends the search.
    pub fn terminate(self) {
        self.query.terminate();
    }
}
