//! OpenEXR files: our own header check, then the `exr` crate decodes and encodes the pixel blocks.

mod b44;
mod chroma;
mod decode;
mod dwa;
mod encode;
mod header;

pub(crate) use decode::{decode_image, decode_texels};
pub(crate) use encode::encode;
