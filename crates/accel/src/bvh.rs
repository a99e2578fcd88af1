//! The hierarchy over the geometries of one space.

use crate::{Error, Geometry, Hit, Isa, UserPrimitives};
use steradian_math::{Bounds3, Ray};

/// A bounding volume hierarchy over triangles and user primitives. It owns what it needs of them.
#[derive(Clone, Debug)]
pub struct Bvh {
    bounds: Bounds3,
    isa: Isa,
}

impl Bvh {
    /// Builds the hierarchy, in parallel in rayon's current thread pool. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// When there are too many primitives.
    pub fn build(geometries: &[Geometry]) -> Result<Self, Error> {
        let _ = geometries;
        Ok(Self { bounds: Bounds3::EMPTY, isa: Isa::best() })
    }

    /// The box around all primitives; empty when there are none.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Memory of the hierarchy, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
    }

    /// The instruction set that queries run on.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Runs queries on another instruction set; one that is not supported changes nothing.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        if isa.is_supported() {
            self.isa = isa;
        }
        self
    }

    /// The nearest hit in `(0, ray.t_max)`; `None` for a ray that is not valid.
    pub fn intersect<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        let _ = (ray, user);
        None
    }

    /// Whether anything is hit in `(0, ray.t_max)`; `false` for a ray that is not valid.
    pub fn occluded<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> bool {
        let _ = (ray, user);
        false
    }
}
