//! Hit groups: what runs on the primitives of a geometry (DXR, "Hit groups").

use crate::context::{AnyHitContext, ClosestHitContext, IntersectionContext};
use crate::decision::{Decision, EndSearch, Verdict};
use crate::error::Fault;
use crate::interface::Interface;
use crate::ray::Barycentrics;
use crate::stages::{AnyHit, ClosestHit, Intersection};
use std::ops::ControlFlow;

/// Attributes of a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HitAttributes<A> {
    /// Position in the triangle.
    Triangle(Barycentrics),
    /// Attributes reported by the intersection shader.
    Procedural(A),
}

/// The shaders of a hit group: a [`TriangleGroup`], a [`ProceduralGroup`], or a box of either where a pipeline has
/// several types of them.
pub trait HitGroup<I: Interface>: Sync {
    /// True for a group of procedural primitives, false for one of triangles.
    fn is_procedural(&self) -> bool;

    /// True if it has an any-hit shader.
    fn has_any_hit(&self) -> bool;

    /// True if it has a closest-hit shader.
    fn has_closest_hit(&self) -> bool;

    /// Runs the intersection shader.
    fn intersection(&self, context: &mut IntersectionContext<I>) -> ControlFlow<EndSearch>;

    /// Runs the any-hit shader.
    fn any_hit(
        &self,
        context: &AnyHitContext<I>,
        payload: &mut I::Payload,
        attributes: &HitAttributes<I::Attributes>,
    ) -> Decision;

    /// Runs the closest-hit shader.
    ///
    /// # Errors
    /// What calls in it have given.
    fn closest_hit(
        &self,
        context: &mut ClosestHitContext<I>,
        payload: &mut I::Payload,
        attributes: &HitAttributes<I::Attributes>,
    ) -> Result<(), Fault>;
}

/// A hit group for triangles; `()` stands for a shader that is not there.
#[derive(Clone, Copy, Debug, Default)]
pub struct TriangleGroup<H, C> {
    /// The any-hit shader.
    pub any_hit: H,
    /// The closest-hit shader.
    pub closest_hit: C,
}

/// A hit group for procedural primitives; `()` stands for a shader that is not there, but for the intersection shader.
#[derive(Clone, Copy, Debug, Default)]
pub struct ProceduralGroup<X, H, C> {
    /// The intersection shader.
    pub intersection: X,
    /// The any-hit shader.
    pub any_hit: H,
    /// The closest-hit shader.
    pub closest_hit: C,
}

impl<I: Interface, H: AnyHit<I, Barycentrics>, C: ClosestHit<I, Barycentrics>> HitGroup<I> for TriangleGroup<H, C> {
    #[inline]
    fn is_procedural(&self) -> bool {
        false
    }

    #[inline]
    fn has_any_hit(&self) -> bool {
        self.any_hit.is_present()
    }

    #[inline]
    fn has_closest_hit(&self) -> bool {
        self.closest_hit.is_present()
    }

    #[inline]
    fn intersection(&self, _: &mut IntersectionContext<I>) -> ControlFlow<EndSearch> {
        ControlFlow::Continue(())
    }

    #[inline]
    fn any_hit(
        &self,
        context: &AnyHitContext<I>,
        payload: &mut I::Payload,
        attributes: &HitAttributes<I::Attributes>,
    ) -> Decision {
        match attributes {
            HitAttributes::Triangle(attributes) => self.any_hit.run(context, payload, attributes),
            HitAttributes::Procedural(_) => Decision(Verdict::Accept),
        }
    }

    #[inline]
    fn closest_hit(
        &self,
        context: &mut ClosestHitContext<I>,
        payload: &mut I::Payload,
        attributes: &HitAttributes<I::Attributes>,
    ) -> Result<(), Fault> {
        match attributes {
            HitAttributes::Triangle(attributes) => self.closest_hit.run(context, payload, attributes),
            HitAttributes::Procedural(_) => Ok(()),
        }
    }
}

impl<I, X, H, C> HitGroup<I> for ProceduralGroup<X, H, C>
where
    I: Interface,
    X: Intersection<I>,
    H: AnyHit<I, I::Attributes>,
    C: ClosestHit<I, I::Attributes>,
{
    #[inline]
    fn is_procedural(&self) -> bool {
        true
    }

    #[inline]
    fn has_any_hit(&self) -> bool {
        self.any_hit.is_present()
    }

    #[inline]
    fn has_closest_hit(&self) -> bool {
        self.closest_hit.is_present()
    }

    #[inline]
    fn intersection(&self, context: &mut IntersectionContext<I>) -> ControlFlow<EndSearch> {
        self.intersection.run(context)
    }

    #[inline]
    fn any_hit(
        &self,
        context: &AnyHitContext<I>,
        payload: &mut I::Payload,
        attributes: &HitAttributes<I::Attributes>,
    ) -> Decision {
        match attributes {
            HitAttributes::Procedural(attributes) => self.any_hit.run(context, payload, attributes),
            HitAttributes::Triangle(_) => Decision(Verdict::Accept),
        }
    }

    #[inline]
    fn closest_hit(
        &self,
        context: &mut ClosestHitContext<I>,
        payload: &mut I::Payload,
        attributes: &HitAttributes<I::Attributes>,
    ) -> Result<(), Fault> {
        match attributes {
            HitAttributes::Procedural(attributes) => self.closest_hit.run(context, payload, attributes),
            HitAttributes::Triangle(_) => Ok(()),
        }
    }
}

/// Groups of several types in one pipeline.
impl<I: Interface, G: HitGroup<I> + ?Sized> HitGroup<I> for Box<G> {
    #[inline]
    fn is_procedural(&self) -> bool {
        (**self).is_procedural()
    }

    #[inline]
    fn has_any_hit(&self) -> bool {
        (**self).has_any_hit()
    }

    #[inline]
    fn has_closest_hit(&self) -> bool {
        (**self).has_closest_hit()
    }

    #[inline]
    fn intersection(&self, context: &mut IntersectionContext<I>) -> ControlFlow<EndSearch> {
        (**self).intersection(context)
    }

    #[inline]
    fn any_hit(
        &self,
        context: &AnyHitContext<I>,
        payload: &mut I::Payload,
        attributes: &HitAttributes<I::Attributes>,
    ) -> Decision {
        (**self).any_hit(context, payload, attributes)
    }

    #[inline]
    fn closest_hit(
        &self,
        context: &mut ClosestHitContext<I>,
        payload: &mut I::Payload,
        attributes: &HitAttributes<I::Attributes>,
    ) -> Result<(), Fault> {
        (**self).closest_hit(context, payload, attributes)
    }
}
