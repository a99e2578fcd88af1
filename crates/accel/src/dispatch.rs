//! The queries, compiled for each instruction set.
#![allow(unsafe_code)]

use crate::bvh::Tree;
use crate::every::every;
use crate::layout::ChildRef;
use crate::packet::{Found, Packet, any_batch, any_packet, nearest_batch, nearest_packet};
use crate::search::{any, nearest};
use crate::simd::{self, DoubleLanes, Lanes, WIDE};
use crate::traverse::{Nearest, RayConstants, Start, UserLeaves, is_traceable};
use crate::{Hit, Isa};
use glam::Mat4;
use steradian_math::Ray;

/// The queries as functions compiled for each instruction set, and for each query the function that chooses among them.
macro_rules! queries {
    ($(
        $(#[$doc:meta])*
        fn $name:ident<U: UserLeaves>($($arg:ident: $ty:ty),* $(,)?) $(-> $out:ty)? = |$isa:ident, $s:ident, $l:ident| $body:expr;
    )*) => {
        #[cfg(target_arch = "x86_64")]
        level!(avx2, "avx2,fma,bmi1,bmi2,popcnt", simd::Avx2::assume_supported(), simd::Avx2::assume_supported(), {
            $(fn $name<U: UserLeaves>($($arg: $ty),*) $(-> $out)? = |$isa, $s, $l| $body;)*
        });
        #[cfg(target_arch = "x86_64")]
        level!(avx512, "avx512f,avx512vl,avx2,fma,bmi1,bmi2,popcnt", simd::Avx512::assume_supported(), simd::Avx512Wide::assume_supported(), {
            $(fn $name<U: UserLeaves>($($arg: $ty),*) $(-> $out)? = |$isa, $s, $l| $body;)*
        });
        #[cfg(target_arch = "x86_64")]
        level!(sse2, "sse2", simd::Sse2::assume_supported(), simd::Sse2::assume_supported(), {
            $(fn $name<U: UserLeaves>($($arg: $ty),*) $(-> $out)? = |$isa, $s, $l| $body;)*
        });

        $(
            $(#[$doc])*
            #[inline]
            pub(crate) fn $name<U: UserLeaves>(isa: SupportedIsa, $($arg: $ty),*) $(-> $out)? {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: a `SupportedIsa` is one that this machine has.
                unsafe {
                    match isa.level {
                        Isa::Baseline => sse2::$name(isa, $($arg),*),
                        Isa::Avx2 => avx2::$name(isa, $($arg),*),
                        Isa::Avx512 => avx512::$name(isa, $($arg),*),
                    }
                }
                #[cfg(not(target_arch = "x86_64"))]
                {
                    let ($isa, $s, $l) = (isa, simd::Portable, simd::Portable);
                    let _ = ($isa, $l);
                    $body
                }
            }
        )*
    };
}

/// The queries of one instruction set.
#[cfg(target_arch = "x86_64")]
macro_rules! level {
    ($level:ident, $features:literal, $single:expr, $packet:expr, {
        $(fn $name:ident<U: UserLeaves>($($arg:ident: $ty:ty),*) $(-> $out:ty)? = |$isa:ident, $s:ident, $l:ident| $body:expr;)*
    }) => {
        mod $level {
            use super::*;

            $(
                #[target_feature(enable = $features)]
                pub(super) fn $name<U: UserLeaves>($isa: SupportedIsa, $($arg: $ty),*) $(-> $out)? {
                    // SAFETY: this function can be called only where its features are supported.
                    let ($s, $l) = unsafe { ($single, $packet) };
                    let _ = ($isa, $l);
                    $body
                }
            )*
        }
    };
}

queries! {
    /// The nearest hit in `(0, ray.t_max)` on a tree; `None` for a ray that is not traceable.
    fn nearest_hit<U: UserLeaves>(tree: &Tree, ray: &Ray, users: &U) -> Option<Nearest<U::Extra>> = |isa, s, l| {
        if !is_traceable(ray) {
            return None;
        }
        nearest(s, tree, ray, users, &RayConstants::new(ray, &tree.bounds), Start { child: tree.root, t: ray.t_max, best: None })
    };
    /// The nearest hit of a traceable ray in `(0, ray.t_max)` on a tree, from a start on.
    fn nearest_hit_from<U: UserLeaves>(
        tree: &Tree, ray: &Ray, users: &U, constants: &RayConstants, start: Start<U::Extra>,
    ) -> Option<Nearest<U::Extra>> = |isa, s, l| nearest(s, tree, ray, users, constants, start);
    /// True if a tree is hit in `(0, ray.t_max)`; `false` for a ray that is not traceable.
    fn any_hit<U: UserLeaves>(tree: &Tree, ray: &Ray, users: &U) -> bool = |isa, s, l| {
        is_traceable(ray) && any(s, tree, ray, users, &RayConstants::new(ray, &tree.bounds), tree.root)
    };
    /// True if a tree is hit by a traceable ray in `(0, ray.t_max)` below a child.
    fn any_hit_from<U: UserLeaves>(tree: &Tree, ray: &Ray, users: &U, constants: &RayConstants, start: ChildRef) -> bool =
        |isa, s, l| any(s, tree, ray, users, constants, start);
    /// Collects all hits in `(0, ray.t_max)` on a tree, in any order.
    fn all_hits<U: UserLeaves>(tree: &Tree, ray: &Ray, users: &U, hits: &mut Vec<Hit>) = |isa, s, l| {
        if is_traceable(ray) {
            every(s, tree, ray, users, hits);
        }
    };
    /// The nearest hits of rays.
    fn nearest_hits<U: UserLeaves>(tree: &Tree, rays: &[Ray], users: &U, hits: &mut [Option<Hit>]) = |isa, s, l| {
        let isa = isa.for_rays(l, rays.len());
        if isa.is_narrow(l) {
            nearest_batch(isa, (s, l), tree, rays, users, hits);
        } else {
            nearest_batch(isa, (s, DoubleLanes(l)), tree, rays, users, hits);
        }
    };
    /// Which rays hit anything.
    fn any_hits<U: UserLeaves>(tree: &Tree, rays: &[Ray], users: &U, occluded: &mut [bool]) = |isa, s, l| {
        let isa = isa.for_rays(l, rays.len());
        if isa.is_narrow(l) {
            any_batch(isa, (s, l), tree, rays, users, occluded);
        } else {
            any_batch(isa, (s, DoubleLanes(l)), tree, rays, users, occluded);
        }
    };
    /// The nearest hits of a packet that is moved to the space of a tree, in intervals that end where `found` says.
    fn nearest_packet_in<U: UserLeaves>(
        tree: &Tree, placed: (&Packet, &Mat4), lanes: u32, users: &U, found: &mut Found,
    ) = |isa, s, l| {
        if isa.is_narrow(l) {
            let packet = placed.0.transformed(l, placed.1, &found.t);
            nearest_packet(isa, (s, l), tree, &packet, lanes, users, found);
        } else {
            let packet = placed.0.transformed(DoubleLanes(l), placed.1, &found.t);
            nearest_packet(isa, (s, DoubleLanes(l)), tree, &packet, lanes, users, found);
        }
    };
    /// Which rays of a packet that is moved to the space of a tree hit anything.
    fn any_packet_in<U: UserLeaves>(tree: &Tree, placed: (&Packet, &Mat4), lanes: u32, users: &U) -> u32 = |isa, s, l| {
        if isa.is_narrow(l) {
            let packet = placed.0.transformed(l, placed.1, &placed.0.t_max);
            any_packet(isa, (s, l), tree, &packet, lanes, users)
        } else {
            let packet = placed.0.transformed(DoubleLanes(l), placed.1, &placed.0.t_max);
            any_packet(isa, (s, DoubleLanes(l)), tree, &packet, lanes, users)
        }
    };
}

/// A level that was found to be supported by this machine, and how many rays a packet may have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SupportedIsa {
    level: Isa,
    width: u8,
}

impl SupportedIsa {
    /// The fastest one, with packets as wide as they may be.
    pub fn best() -> Self {
        Self { level: Isa::best(), width: WIDE as u8 }
    }

    /// The same with another level, if this machine supports it.
    pub fn with_level(self, level: Isa) -> Self {
        if level.is_supported() { Self { level, ..self } } else { self }
    }

    /// The same with packets of at most so many rays: a power of two from four to thirty-two, whichever is next to what
    /// is asked for.
    pub fn with_width(self, width: usize) -> Self {
        Self { width: width.clamp(4, WIDE).next_power_of_two() as u8, ..self }
    }

    /// Which level it is.
    pub fn get(self) -> Isa {
        self.level
    }

    /// Most rays of a packet.
    #[inline(always)]
    pub fn width(self) -> usize {
        self.width.into()
    }

    /// The same for a given number of rays: those that one register has lanes for do not make wider packets.
    #[inline(always)]
    fn for_rays<L: Lanes>(self, _: L, count: usize) -> Self {
        if count <= L::COUNT { self.with_width(self.width().min(L::COUNT)) } else { self }
    }

    /// True if packets need no more lanes than a register has.
    #[inline(always)]
    fn is_narrow<L: Lanes>(self, _: L) -> bool {
        self.width() <= L::COUNT
    }
}
