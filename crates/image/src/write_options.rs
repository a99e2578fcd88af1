//! Options of writing pictures to files.

use crate::block::BlockFormat;
use crate::tone::Tone;

/// Sample type of EXR files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Precision {
    /// 16-bit floats; finite values beyond ±65504 are clamped to it. Depth, position, id, count and variance layers
    /// stay 32 bit.
    Half,
    /// 32-bit floats.
    #[default]
    Float,
}

/// Compression of EXR files; all are lossless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Compression {
    /// Stored as is.
    None,
    /// Deflate over blocks of 16 rows.
    #[default]
    Zip,
    /// Wavelets and Huffman coding; smaller for noisy pictures.
    Piz,
}

/// Options with which [`write()`](crate::write()) stores a picture. Each format uses those that concern it.
#[derive(Clone, Debug, PartialEq)]
pub struct WriteOptions {
    /// EXR: sample type.
    pub exr_precision: Precision,
    /// EXR: compression.
    pub exr_compression: Compression,
    /// PNG and PPM: 16 bits per sample instead of 8.
    pub sixteen_bit: bool,
    /// JPEG: quality, 1 to 100.
    pub jpeg_quality: u8,
    /// PPM: `P3` (text) instead of `P6` (bytes).
    pub ppm_plain: bool,
    /// PPM: linear values scaled by the picture's maximum, with a `#MAX=` comment, instead of tone-mapped display
    /// values.
    pub ppm_radiance: bool,
    /// DDS and KTX2: how blocks are compressed; one of [`crate::block::WRITABLE`].
    /// BC6H has linear values.
    pub block: BlockFormat,
    /// PNG, JPEG, PPM, and colours of DDS and KTX2: from linear radiance to display values.
    pub tone: Tone,
    /// PNG, DDS and KTX2: whether colours are premultiplied by the channel `A`, as those of EXR files are. They are
    /// divided by it then, since these formats have straight alpha.
    pub premultiplied: bool,
}

impl Default for WriteOptions {
    /// EXR float with zip, PNG with 8 bits, JPEG quality 90, PPM `P6` with linear values and `#MAX=`, BC7 blocks, plain
    /// sRGB encoding.
    fn default() -> Self {
        Self {
            exr_precision: Precision::Float,
            exr_compression: Compression::Zip,
            sixteen_bit: false,
            jpeg_quality: 90,
            ppm_plain: false,
            ppm_radiance: true,
            block: BlockFormat::Bc7,
            tone: Tone::default(),
            premultiplied: false,
        }
    }
}
