//! Interface of queries to the leaves that are not triangles.

use crate::nearest::{Extra, Nearest};
use crate::packet_hits::Found;
use crate::packet_rays::Packet;
use crate::supported_isa::SupportedIsa;
use crate::{Hit, UserHit};
use steradian_math::Ray;

/// Leaves behind the user references of a tree: user primitives or instances.
pub(crate) trait UserLeaves {
    /// Data of a hit beyond [`UserHit`].
    type Extra: Extra;
    /// Data of a hit on a triangle of this tree.
    fn triangle(&self) -> Self::Extra;
    /// The nearest hit in `(0, ray.t_max)`.
    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, Self::Extra)>;
    /// True if there is any hit in `(0, ray.t_max)`.
    fn occluded(&self, index: u32, ray: &Ray) -> bool;
    /// True if a hit on a filtered triangle counts.
    fn accept(&self, index: u32, hit: UserHit, ray: &Ray) -> bool;
    /// Collects hits in `(0, ray.t_max)`: of a user primitive the nearest, of an instance all.
    fn every(&self, index: u32, ray: &Ray, hits: &mut Vec<Hit>) {
        let hit = self.intersect(index, ray).filter(|(hit, _)| hit.t > 0.0 && hit.t < ray.t_max);
        hits.extend(hit.map(|(hit, extra)| self.hit(Nearest { hit, index, extra })));
    }
    /// Hit as the caller of a query gets it.
    fn hit(&self, nearest: Nearest<Self::Extra>) -> Hit;

    /// True if the results at the user references do not depend on the order in which these are tested.
    #[inline(always)]
    fn in_any_order(&self) -> bool {
        false
    }

    /// The nearest hits of the rays in `lanes` in intervals that end where `inner` says, if there is a tree behind the
    /// reference; else `false`.
    #[inline(always)]
    fn intersect_packet(&self, _: SupportedIsa, _: u32, _: &Packet, _: u32, _: &mut Found) -> bool {
        false
    }

    /// The rays in `lanes` that hit anything, if there is a tree behind the reference.
    #[inline(always)]
    fn occluded_packet(&self, _: SupportedIsa, _: u32, _: &Packet, _: u32) -> Option<u32> {
        None
    }
}
