//! Pictures: pixel images with named channels, the files they live in, tone curves that bring radiance to a display,
//! and the metrics that compare two pictures.
//!
//! * [`Image`] holds linear `f32` planes with names (`R`, `albedo.G`, `Z`, …) and metadata; [`read`] and [`write()`]
//!   move it between memory and EXR, PNG, JPEG, TGA, BMP, Radiance HDR, PFM, PPM/PGM, DDS and KTX2 files; WebP is read.
//! * [`Texels`] keeps the samples as the file stores them (8 and 16 bit, half, float), for textures.
//! * [`tone`] maps linear Rec.709 to display values, [`encoding`] has the sRGB transfer functions.
//! * [`Sensor`] adds the noise of a camera's sensor.
//! * [`FalseColor`] shows luminance.
//! * [`metrics`] compares pictures.
//! * [`signal`] has their Fourier transform, and what sampling does to it.
//!
//! Row 0 is the top row in memory, whatever the file's order is. Every size that a file declares is checked against
//! [`Limits`] and against the bytes there really are before a pixel is allocated.

mod atomic;
mod basis;
pub mod block;
mod colour;
mod container;
mod dds;
pub mod encoding;
mod error;
mod exr_file;
mod failpoint;
mod false_color;
mod hdr;
mod image;
mod kind;
mod ktx2;
mod limits;
pub mod metrics;
mod pfm;
mod photo;
mod png_file;
mod pnm;
mod read;
mod regular;
mod sensor;
pub mod signal;
mod temporary;
mod texels;
mod together;
pub mod tone;
mod voxel_grid;
mod webp;
mod write;
mod write_options;

pub use self::image::{Channel, Image, Metadata, RgbPlanes, Value, Window};
pub use atomic::{check_place, discard_drafts, stream_progress, stream_whole, write_whole};
pub use encoding::Encoding;
pub use error::{Error, Result};
pub use exr_file::clamped_to_half;
pub use false_color::FalseColor;
pub use kind::FileKind;
pub use limits::Limits;
pub use read::{declared_bytes, read, read_bands, read_bytes, read_texels, read_texels_bytes};
pub use regular::{Stamp, open_regular, read_regular};
pub use sensor::Sensor;
pub use temporary::TemporaryFolder;
pub use texels::{TakeBand, TexelData, Texels};
pub use together::write_together;
pub use voxel_grid::{VoxelGrid, decode as decode_voxel_grid, read_voxel_grid};
pub use write::{display8, encode, write};
pub use write_options::{Compression, Precision, WriteOptions};
