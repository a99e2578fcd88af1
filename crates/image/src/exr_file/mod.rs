//! OpenEXR files: our own header check, then the `exr` crate decodes and encodes the pixel blocks.

mod b44;
mod chroma;
mod decode;
mod dwa;
mod encode;
mod header;
mod primaries;

pub(crate) use decode::{decode_image, decode_texels};
pub use encode::clamped_to_half;
pub(crate) use encode::encode;
