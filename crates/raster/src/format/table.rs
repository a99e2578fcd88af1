//! The list of formats.

use super::Numeric;

/// Order of the channels in the texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Red at the lowest bits.
    Rgba,
    /// Blue at the lowest bits, then green, red, alpha.
    Bgra,
    /// Red at the highest bits, alpha at the lowest.
    Abgr,
}

macro_rules! formats {
    ($($(#[$meta:meta])* $name:ident $numeric:ident [$r:literal $g:literal $b:literal $a:literal] $order:ident;)*) => {
        /// A sized format: channels and their bits, then what the bits mean.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[expect(missing_docs, reason = "names say what they are")]
        pub enum Format { $($(#[$meta])* $name,)* }

        impl Format {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// Meaning, bits of red, green, blue and alpha, order.
            pub(crate) const fn layout(self) -> (Numeric, [u8; 4], Order) {
                match self { $(Self::$name => (Numeric::$numeric, [$r, $g, $b, $a], Order::$order),)* }
            }

            /// Its name.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => stringify!($name),)* }
            }
        }
    };
}

formats! {
    R8Unorm Unorm [8 0 0 0] Rgba;
    R8Snorm Snorm [8 0 0 0] Rgba;
    R8Uint Uint [8 0 0 0] Rgba;
    R8Sint Sint [8 0 0 0] Rgba;
    R16Unorm Unorm [16 0 0 0] Rgba;
    R16Snorm Snorm [16 0 0 0] Rgba;
    R16Uint Uint [16 0 0 0] Rgba;
    R16Sint Sint [16 0 0 0] Rgba;
    R16Float Float [16 0 0 0] Rgba;
    R32Uint Uint [32 0 0 0] Rgba;
    R32Sint Sint [32 0 0 0] Rgba;
    R32Float Float [32 0 0 0] Rgba;
    Rg8Unorm Unorm [8 8 0 0] Rgba;
    Rg8Snorm Snorm [8 8 0 0] Rgba;
    Rg8Uint Uint [8 8 0 0] Rgba;
    Rg8Sint Sint [8 8 0 0] Rgba;
    Rg16Unorm Unorm [16 16 0 0] Rgba;
    Rg16Snorm Snorm [16 16 0 0] Rgba;
    Rg16Uint Uint [16 16 0 0] Rgba;
    Rg16Sint Sint [16 16 0 0] Rgba;
    Rg16Float Float [16 16 0 0] Rgba;
    Rg32Uint Uint [32 32 0 0] Rgba;
    Rg32Sint Sint [32 32 0 0] Rgba;
    Rg32Float Float [32 32 0 0] Rgba;
    Rgb8Unorm Unorm [8 8 8 0] Rgba;
    Rgb8Snorm Snorm [8 8 8 0] Rgba;
    Rgb8Uint Uint [8 8 8 0] Rgba;
    Rgb8Sint Sint [8 8 8 0] Rgba;
    Rgb8Srgb Srgb [8 8 8 0] Rgba;
    Rgb16Unorm Unorm [16 16 16 0] Rgba;
    Rgb16Snorm Snorm [16 16 16 0] Rgba;
    Rgb16Uint Uint [16 16 16 0] Rgba;
    Rgb16Sint Sint [16 16 16 0] Rgba;
    Rgb16Float Float [16 16 16 0] Rgba;
    Rgb32Uint Uint [32 32 32 0] Rgba;
    Rgb32Sint Sint [32 32 32 0] Rgba;
    Rgb32Float Float [32 32 32 0] Rgba;
    Rgba8Unorm Unorm [8 8 8 8] Rgba;
    Rgba8Snorm Snorm [8 8 8 8] Rgba;
    Rgba8Uint Uint [8 8 8 8] Rgba;
    Rgba8Sint Sint [8 8 8 8] Rgba;
    Rgba8Srgb Srgb [8 8 8 8] Rgba;
    Bgra8Unorm Unorm [8 8 8 8] Bgra;
    Bgra8Srgb Srgb [8 8 8 8] Bgra;
    Rgba16Unorm Unorm [16 16 16 16] Rgba;
    Rgba16Snorm Snorm [16 16 16 16] Rgba;
    Rgba16Uint Uint [16 16 16 16] Rgba;
    Rgba16Sint Sint [16 16 16 16] Rgba;
    Rgba16Float Float [16 16 16 16] Rgba;
    Rgba32Uint Uint [32 32 32 32] Rgba;
    Rgba32Sint Sint [32 32 32 32] Rgba;
    Rgba32Float Float [32 32 32 32] Rgba;
    Rgb332Unorm Unorm [3 3 2 0] Abgr;
    Rgb4Unorm Unorm [4 4 4 0] Abgr;
    Rgb5Unorm Unorm [5 5 5 0] Abgr;
    Rgb565Unorm Unorm [5 6 5 0] Abgr;
    Rgba2Unorm Unorm [2 2 2 2] Abgr;
    Rgba4Unorm Unorm [4 4 4 4] Abgr;
    Rgb5A1Unorm Unorm [5 5 5 1] Abgr;
    Rgb10Unorm Unorm [10 10 10 0] Rgba;
    Rgb12Unorm Unorm [12 12 12 0] Rgba;
    Rgba12Unorm Unorm [12 12 12 12] Rgba;
    Rgb10A2Unorm Unorm [10 10 10 2] Rgba;
    Rgb10A2Uint Uint [10 10 10 2] Rgba;
    Rg11B10Float Float [11 11 10 0] Rgba;
    /// Mantissas of 9 bits from the lowest up, then the exponent.
    Rgb9E5 SharedExponent [9 9 9 5] Rgba;
    Depth16 Depth [16 0 0 0] Rgba;
    Depth24 Depth [24 0 0 0] Rgba;
    Depth32Float Depth [32 0 0 0] Rgba;
    Stencil8 Stencil [8 0 0 0] Rgba;
    /// Depth in the low 24 bits, stencil above.
    Depth24Stencil8 DepthStencil [24 8 0 0] Rgba;
    /// Depth in the low 32 bits, stencil above.
    Depth32FloatStencil8 DepthStencil [32 8 0 0] Rgba;
}
