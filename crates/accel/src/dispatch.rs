//! Functions compiled for each instruction set, and the choice of the one of this machine.

/// The queries as functions compiled for each instruction set, and for each query the function that chooses among them.
macro_rules! queries {
    ($(
        $(#[$doc:meta])*
        fn $name:ident<U: UserLeaves>($($arg:ident: $ty:ty),* $(,)?) $(-> $out:ty)? =
            |$isa:ident, $s:ident, $l:ident| $body:expr;
    )*) => {
        #[cfg(target_arch = "x86_64")]
        $crate::dispatch::level!(avx2, "avx2,fma,bmi1,bmi2,popcnt", Avx2, Avx2, {
            $(fn $name<U: UserLeaves>($($arg: $ty),*) $(-> $out)? = |$isa, $s, $l| $body;)*
        });
        #[cfg(target_arch = "x86_64")]
        $crate::dispatch::level!(avx512, "avx512f,avx512vl,avx2,fma,bmi1,bmi2,popcnt", Avx512, Avx512Wide, {
            $(fn $name<U: UserLeaves>($($arg: $ty),*) $(-> $out)? = |$isa, $s, $l| $body;)*
        });
        #[cfg(target_arch = "x86_64")]
        $crate::dispatch::level!(sse2, "sse2", Sse2, Sse2, {
            $(fn $name<U: UserLeaves>($($arg: $ty),*) $(-> $out)? = |$isa, $s, $l| $body;)*
        });

        $(
            $(#[$doc])*
            #[inline]
            pub(crate) fn $name<U: $crate::leaves::UserLeaves>(
                isa: $crate::supported_isa::SupportedIsa, $($arg: $ty),*
            ) $(-> $out)? {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: a `SupportedIsa` is one that this machine has.
                unsafe {
                    match isa.get() {
                        $crate::Isa::Baseline => sse2::$name(isa, $($arg),*),
                        $crate::Isa::Avx2 => avx2::$name(isa, $($arg),*),
                        $crate::Isa::Avx512 => avx512::$name(isa, $($arg),*),
                    }
                }
                #[cfg(not(target_arch = "x86_64"))]
                {
                    let ($isa, $s, $l) = (isa, $crate::simd::Portable, $crate::simd::Portable);
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
    ($level:ident, $features:literal, $single:ident, $packet:ident, {
        $(fn $name:ident<U: UserLeaves>($($arg:ident: $ty:ty),*) $(-> $out:ty)? =
            |$isa:ident, $s:ident, $l:ident| $body:expr;)*
    }) => {
        mod $level {
            use super::*;

            $(
                #[target_feature(enable = $features)]
                pub(super) fn $name<U: $crate::leaves::UserLeaves>(
                    $isa: $crate::supported_isa::SupportedIsa, $($arg: $ty),*
                ) $(-> $out)? {
                    // SAFETY: this function can be called only where its features are supported.
                    let ($s, $l) = unsafe {
                        ($crate::simd::$single::assume_supported(), $crate::simd::$packet::assume_supported())
                    };
                    let _ = ($isa, $l);
                    $body
                }
            )*
        }
    };
}

#[cfg(target_arch = "x86_64")]
pub(crate) use level;
pub(crate) use queries;
