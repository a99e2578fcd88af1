//! Flags of rays, geometries and instances (DXR functional spec, "Ray flags", "D3D12_RAYTRACING_GEOMETRY_FLAGS",
//! "D3D12_RAYTRACING_INSTANCE_FLAGS"; Vulkan, "Ray Tracing", ray flags). The bits are those of both APIs.

use std::ops::BitOr;

/// Sets of flags in one integer.
macro_rules! flags {
    ($(#[$doc:meta])* $name:ident($int:ty) { $($(#[$flag_doc:meta])* $flag:ident = $bits:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub struct $name($int);

        impl $name {
            /// No flag.
            pub const NONE: Self = Self(0);
            $($(#[$flag_doc])* pub const $flag: Self = Self($bits);)*
            /// Each flag with its name.
            pub const ALL: &[(Self, &str)] = &[$((Self::$flag, stringify!($flag)),)*];

            /// The flags as bits.
            #[inline]
            pub const fn bits(self) -> $int {
                self.0
            }

            /// The flags that have these bits; `None` when a bit is no flag.
            pub const fn from_bits(bits: $int) -> Option<Self> {
                const KNOWN: $int = 0 $(| $bits)*;
                if bits & !KNOWN == 0 { Some(Self(bits)) } else { None }
            }

            /// True if all flags of `other` are among these.
            #[inline]
            pub const fn contains(self, other: Self) -> bool {
                self.0 & other.0 == other.0
            }

            /// True if any flag of `other` is among these.
            #[inline]
            pub const fn intersects(self, other: Self) -> bool {
                self.0 & other.0 != 0
            }

            /// The flags of both.
            #[inline]
            pub const fn union(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }

        impl BitOr for $name {
            type Output = Self;

            #[inline]
            fn bitor(self, other: Self) -> Self {
                self.union(other)
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                let has = |flag: &&(Self, &'static str)| self.contains(flag.0);
                let names: Vec<&str> = Self::ALL.iter().filter(has).map(|flag| flag.1).collect();
                f.write_str(if names.is_empty() { "NONE".to_owned() } else { names.join(" | ") }.as_str())
            }
        }
    };
}

flags! {
    /// Ray flags: opacity, face culling, and early termination of the search.
    RayFlags(u32) {
        /// All that is met counts as opaque, whatever geometry and instance say.
        FORCE_OPAQUE = 0x1,
        /// All that is met counts as non-opaque, whatever geometry and instance say.
        FORCE_NON_OPAQUE = 0x2,
        /// The first hit that is accepted ends the search: some hit, not the closest.
        ACCEPT_FIRST_HIT_AND_END_SEARCH = 0x4,
        /// No closest-hit shader runs.
        SKIP_CLOSEST_HIT_SHADER = 0x8,
        /// Triangles that show their back are not hit.
        CULL_BACK_FACING_TRIANGLES = 0x10,
        /// Triangles that show their front are not hit.
        CULL_FRONT_FACING_TRIANGLES = 0x20,
        /// Primitives that geometry and instance make opaque are not hit.
        CULL_OPAQUE = 0x40,
        /// Primitives that geometry and instance make non-opaque are not hit.
        CULL_NON_OPAQUE = 0x80,
        /// No triangle is hit.
        SKIP_TRIANGLES = 0x100,
        /// No procedural primitive is hit.
        SKIP_PROCEDURAL_PRIMITIVES = 0x200,
    }
}

/// Two ray flags that exclude each other (DXR, "Ray flags").
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("ray flags {0} and {1} exclude each other (DXR, \"Ray flags\")")]
pub struct ExclusiveRayFlags(pub RayFlags, pub RayFlags);

impl RayFlags {
    /// Sets of flags of which a ray may have at most one.
    const EXCLUSIVE: [&[Self]; 5] = [
        &[Self::FORCE_OPAQUE, Self::FORCE_NON_OPAQUE, Self::CULL_OPAQUE, Self::CULL_NON_OPAQUE],
        &[Self::CULL_BACK_FACING_TRIANGLES, Self::CULL_FRONT_FACING_TRIANGLES],
        &[Self::SKIP_TRIANGLES, Self::CULL_BACK_FACING_TRIANGLES],
        &[Self::SKIP_TRIANGLES, Self::CULL_FRONT_FACING_TRIANGLES],
        &[Self::SKIP_TRIANGLES, Self::SKIP_PROCEDURAL_PRIMITIVES],
    ];

    /// These flags, where they may be together.
    ///
    /// # Errors
    /// The first two that exclude each other.
    #[inline]
    pub fn validated(self) -> Result<Self, ExclusiveRayFlags> {
        // Rays without any of these are the rule.
        if self.0 & !0xc == 0 {
            return Ok(self);
        }
        self.validated_each()
    }

    #[cold]
    fn validated_each(self) -> Result<Self, ExclusiveRayFlags> {
        for set in Self::EXCLUSIVE {
            let mut present = set.iter().filter(|flag| self.contains(**flag));
            if let (Some(first), Some(second)) = (present.next(), present.next()) {
                return Err(ExclusiveRayFlags(*first, *second));
            }
        }
        Ok(self)
    }
}

flags! {
    /// Flags of all primitives of a geometry.
    GeometryFlags(u8) {
        /// No any-hit shader runs on it, unless instance or ray say otherwise.
        OPAQUE = 0x1,
        /// Any-hit shaders run at most once for a primitive and a ray. In this implementation they never run more
        /// often, with or without this flag.
        NO_DUPLICATE_ANY_HIT_INVOCATION = 0x2,
    }
}

flags! {
    /// Flags of an instance, which override properties of its geometries.
    InstanceFlags(u8) {
        /// Rays do not cull its triangles by their face.
        TRIANGLE_CULL_DISABLE = 0x1,
        /// Its triangles show their front where their vertices are counter-clockwise instead of clockwise.
        TRIANGLE_FRONT_COUNTERCLOCKWISE = 0x2,
        /// All its geometries count as opaque.
        FORCE_OPAQUE = 0x4,
        /// All its geometries count as non-opaque.
        FORCE_NON_OPAQUE = 0x8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exactly_the_combinations_that_the_spec_excludes_are_errors() {
        for bits in 0..=0x3ff_u32 {
            let flags = RayFlags::from_bits(bits).expect("known bits");
            let opacity = (bits & 0x1) + (bits >> 1 & 1) + (bits >> 6 & 1) + (bits >> 7 & 1);
            let (back, front) = (bits >> 4 & 1, bits >> 5 & 1);
            let (no_triangles, no_boxes) = (bits >> 8 & 1, bits >> 9 & 1);
            let legal = opacity <= 1
                && back + front <= 1
                && no_triangles + back <= 1
                && no_triangles + front <= 1
                && no_triangles + no_boxes <= 1;
            assert_eq!(flags.validated().is_ok(), legal, "{flags}");
        }
        assert_eq!(RayFlags::from_bits(0x400), None);
        let both = RayFlags::FORCE_OPAQUE | RayFlags::CULL_OPAQUE;
        assert_eq!(both.validated(), Err(ExclusiveRayFlags(RayFlags::FORCE_OPAQUE, RayFlags::CULL_OPAQUE)));
    }
}
