//! The queries, compiled for each instruction set.
#![allow(unsafe_code)]

use crate::Isa;
use crate::bvh::Tree;
use crate::simd;
use crate::traverse::{Nearest, Users, any, nearest};
use steradian_math::Ray;

/// The queries of one instruction set, as functions compiled for it.
#[cfg(target_arch = "x86_64")]
macro_rules! level {
    ($name:ident, $token:ident, $features:literal) => {
        mod $name {
            use super::*;

            #[target_feature(enable = $features)]
            pub(super) fn nearest_hit<U: Users>(tree: &Tree, ray: &Ray, users: &U) -> Option<Nearest<U::Extra>> {
                // SAFETY: this function can be called only where its features are supported.
                nearest(unsafe { simd::$token::assume_supported() }, tree, ray, users)
            }

            #[target_feature(enable = $features)]
            pub(super) fn any_hit<U: Users>(tree: &Tree, ray: &Ray, users: &U) -> bool {
                // SAFETY: this function can be called only where its features are supported.
                any(unsafe { simd::$token::assume_supported() }, tree, ray, users)
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
level!(avx2, Avx2, "avx2,bmi1,bmi2");
#[cfg(target_arch = "x86_64")]
level!(avx512, Avx512, "avx512f,avx512vl,avx2,bmi1,bmi2");
#[cfg(target_arch = "x86_64")]
level!(sse2, Sse2, "sse2");

/// The nearest hit in `(0, ray.t_max)` on a tree.
#[inline]
pub(crate) fn nearest_hit<U: Users>(isa: SupportedIsa, tree: &Tree, ray: &Ray, users: &U) -> Option<Nearest<U::Extra>> {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a `SupportedIsa` is one that this machine has.
    unsafe {
        match isa.0 {
            Isa::Baseline => sse2::nearest_hit(tree, ray, users),
            Isa::Avx2 => avx2::nearest_hit(tree, ray, users),
            Isa::Avx512 => avx512::nearest_hit(tree, ray, users),
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _ = isa;
        nearest(simd::Portable, tree, ray, users)
    }
}

/// Whether a tree is hit in `(0, ray.t_max)`.
#[inline]
pub(crate) fn any_hit<U: Users>(isa: SupportedIsa, tree: &Tree, ray: &Ray, users: &U) -> bool {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a `SupportedIsa` is one that this machine has.
    unsafe {
        match isa.0 {
            Isa::Baseline => sse2::any_hit(tree, ray, users),
            Isa::Avx2 => avx2::any_hit(tree, ray, users),
            Isa::Avx512 => avx512::any_hit(tree, ray, users),
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _ = isa;
        any(simd::Portable, tree, ray, users)
    }
}

/// A level that was found to be supported by this machine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SupportedIsa(Isa);

impl SupportedIsa {
    /// The fastest one.
    pub fn best() -> Self {
        Self(Isa::best())
    }

    /// The level, if this machine supports it.
    pub fn new(isa: Isa) -> Option<Self> {
        isa.is_supported().then_some(Self(isa))
    }

    /// Which one it is.
    pub fn get(self) -> Isa {
        self.0
    }
}
