//! Values that vertices hand to fragments, and how they are interpolated.
//!
//! [`varyings!`](crate::varyings!) declares a struct of them; offsets are kept by the compiler:
//!
//! ```
//! use steradian_raster::{glam::{Vec2, Vec3}, varyings};
//!
//! varyings! {
//!     /// What the fragment shader of a textured surface needs.
//!     pub struct Surface {
//!         /// Interpolated with perspective, as nothing else is said.
//!         pub normal: Vec3,
//!         /// At the centroid of the covered samples.
//!         pub uv: Vec2 => centroid,
//!         /// From the provoking vertex.
//!         pub material: u32 => flat,
//!         /// Vertices are cut away where this is negative.
//!         pub above_water: f32 => clip,
//!     }
//! }
//! ```

use glam::{Mat3, Vec2, Vec3, Vec4};

/// Interpolation of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// With perspective: linear on the primitive in space. The default.
    Perspective,
    /// Linear in the window.
    Linear,
    /// The provoking vertex's.
    Flat,
    /// With perspective, at the centroid of the covered samples rather than at the pixel's centre.
    Centroid,
    /// Linear in the window, at the centroid of the covered samples.
    LinearCentroid,
    /// With perspective, at each sample; the fragment shader runs for each.
    Sample,
    /// Linear in the window, at each sample; the fragment shader runs for each.
    LinearSample,
    /// A distance that cuts the primitive away where it is negative; interpolated with perspective.
    Clip,
    /// A distance that drops the primitive where it is negative at all vertices; interpolated with perspective.
    Cull,
}

/// A type that varyings may have: a fixed number of floats.
pub trait Component: Copy {
    /// Number of floats.
    const FLOATS: usize;
    /// True if the floats are bits of integers, which cannot be interpolated.
    const INTEGER: bool = false;
    /// Hands its floats over in order.
    fn put(self, put: &mut impl FnMut(f32));
    /// Makes it of floats that are asked for in order.
    fn get(get: &mut impl FnMut() -> f32) -> Self;
}

impl Component for f32 {
    const FLOATS: usize = 1;
    #[inline(always)]
    fn put(self, put: &mut impl FnMut(f32)) {
        put(self);
    }
    #[inline(always)]
    fn get(get: &mut impl FnMut() -> f32) -> Self {
        get()
    }
}

/// Integers travel as bits, so they must be [`Mode::Flat`]; [`varyings!`](crate::varyings!) refuses others.
impl Component for u32 {
    const FLOATS: usize = 1;
    const INTEGER: bool = true;
    #[inline(always)]
    fn put(self, put: &mut impl FnMut(f32)) {
        put(f32::from_bits(self));
    }
    #[inline(always)]
    fn get(get: &mut impl FnMut() -> f32) -> Self {
        get().to_bits()
    }
}

macro_rules! vector_component {
    ($vector:ty, $floats:literal) => {
        impl Component for $vector {
            const FLOATS: usize = $floats;
            #[inline(always)]
            fn put(self, put: &mut impl FnMut(f32)) {
                self.to_array().into_iter().for_each(put);
            }
            #[inline(always)]
            fn get(get: &mut impl FnMut() -> f32) -> Self {
                Self::from_array(std::array::from_fn(|_| get()))
            }
        }
    };
}

vector_component!(Vec2, 2);
vector_component!(Vec3, 3);
vector_component!(Vec4, 4);

impl Component for Mat3 {
    const FLOATS: usize = 9;
    #[inline(always)]
    fn put(self, put: &mut impl FnMut(f32)) {
        self.to_cols_array().into_iter().for_each(put);
    }
    #[inline(always)]
    fn get(get: &mut impl FnMut() -> f32) -> Self {
        Self::from_cols_array(&std::array::from_fn(|_| get()))
    }
}

/// An array of floats of a length known to the compiler.
pub trait Floats: Copy + Send + Sync + AsRef<[f32]> + AsMut<[f32]> {
    /// All zero.
    const ZERO: Self;
    /// As many floats for each of the four pixels of a quad.
    type Quad: Copy + AsRef<[[f32; 4]]> + AsMut<[[f32; 4]]>;
    /// All zero.
    const ZERO_QUAD: Self::Quad;
}

impl<const N: usize> Floats for [f32; N] {
    const ZERO: Self = [0.0; N];
    type Quad = [[f32; 4]; N];
    const ZERO_QUAD: Self::Quad = [[0.0; 4]; N];
}

/// A set of varyings. Made by [`varyings!`](crate::varyings!); `()` is the empty set.
pub trait Varyings: Copy + Send + Sync {
    /// The floats of all fields together.
    type Floats: Floats;
    /// Interpolation mode of each float, in order.
    const MODES: &'static [Mode];
    /// The fields as floats.
    fn to_floats(&self) -> Self::Floats;
    /// The fields from floats, which are asked for by index.
    fn from_floats(float: impl Fn(usize) -> f32) -> Self;
}

impl Varyings for () {
    type Floats = [f32; 0];
    const MODES: &'static [Mode] = &[];
    #[inline(always)]
    fn to_floats(&self) -> Self::Floats {
        []
    }
    #[inline(always)]
    fn from_floats(_: impl Fn(usize) -> f32) -> Self {}
}

/// True if any of these modes needs the fragment shader to run at each sample.
pub(crate) const fn any_per_sample(modes: &[Mode]) -> bool {
    let mut i = 0;
    while i < modes.len() {
        if matches!(modes[i], Mode::Sample | Mode::LinearSample) {
            return true;
        }
        i += 1;
    }
    false
}

/// True if any of these modes needs the centroid.
pub(crate) const fn any_centroid(modes: &[Mode]) -> bool {
    let mut i = 0;
    while i < modes.len() {
        if matches!(modes[i], Mode::Centroid | Mode::LinearCentroid) {
            return true;
        }
        i += 1;
    }
    false
}

/// True if [`Mode::Clip`], or else [`Mode::Cull`], is among these modes.
pub(crate) const fn any_is(modes: &[Mode], clip: bool) -> bool {
    let mut i = 0;
    while i < modes.len() {
        match modes[i] {
            Mode::Clip if clip => return true,
            Mode::Cull if !clip => return true,
            _ => i += 1,
        }
    }
    false
}

/// Declares a struct of varyings: fields are written `name: type` or `name: type => mode`, where the mode is one of
/// `perspective` (the default), `linear`, `flat`, `centroid`, `linear_centroid`, `sample`, `linear_sample`, `clip` and
/// `cull` ([`Mode`]). See the [module](mod@crate::varyings).
#[macro_export]
macro_rules! varyings {
    ($(#[$meta:meta])* $vis:vis struct $name:ident {
        $($(#[$field_meta:meta])* $field_vis:vis $field:ident : $type:ty $(=> $mode:ident)?),* $(,)?
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug)]
        $vis struct $name { $($(#[$field_meta])* $field_vis $field: $type,)* }

        impl $crate::Varyings for $name {
            type Floats = [f32; 0 $(+ <$type as $crate::varyings::Component>::FLOATS)*];
            const MODES: &'static [$crate::varyings::Mode] = &{
                const COUNT: usize = 0 $(+ <$type as $crate::varyings::Component>::FLOATS)*;
                let mut modes = [$crate::varyings::Mode::Perspective; COUNT];
                let mut next = 0;
                $(
                    let end = next + <$type as $crate::varyings::Component>::FLOATS;
                    while next < end {
                        assert!(
                            !<$type as $crate::varyings::Component>::INTEGER
                                || matches!($crate::__varying_mode!($($mode)?), $crate::varyings::Mode::Flat),
                            "an integer varying must be flat"
                        );
                        modes[next] = $crate::__varying_mode!($($mode)?);
                        next += 1;
                    }
                )*
                let _ = next;
                modes
            };
            #[inline(always)]
            #[allow(unused_mut, unused_variables, unused_assignments, reason = "without fields")]
            fn to_floats(&self) -> Self::Floats {
                let mut floats = <Self::Floats as $crate::varyings::Floats>::ZERO;
                let mut next = 0;
                $($crate::varyings::Component::put(self.$field, &mut |value| {
                    floats[next] = value;
                    next += 1;
                });)*
                floats
            }
            #[inline(always)]
            #[allow(unused_mut, unused_variables, reason = "without fields")]
            fn from_floats(float: impl Fn(usize) -> f32) -> Self {
                let mut next = 0;
                let mut get = || {
                    next += 1;
                    float(next - 1)
                };
                Self { $($field: $crate::varyings::Component::get(&mut get),)* }
            }
        }
    };
}

/// The mode of a field by its word; a part of [`varyings!`](crate::varyings!).
#[doc(hidden)]
#[macro_export]
macro_rules! __varying_mode {
    () => {
        $crate::varyings::Mode::Perspective
    };
    (perspective) => {
        $crate::varyings::Mode::Perspective
    };
    (linear) => {
        $crate::varyings::Mode::Linear
    };
    (flat) => {
        $crate::varyings::Mode::Flat
    };
    (centroid) => {
        $crate::varyings::Mode::Centroid
    };
    (linear_centroid) => {
        $crate::varyings::Mode::LinearCentroid
    };
    (sample) => {
        $crate::varyings::Mode::Sample
    };
    (linear_sample) => {
        $crate::varyings::Mode::LinearSample
    };
    (clip) => {
        $crate::varyings::Mode::Clip
    };
    (cull) => {
        $crate::varyings::Mode::Cull
    };
}
