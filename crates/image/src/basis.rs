//! Basis Universal in KTX2 files (ETC1S and UASTC), decoded by the `basisu` crate, a port of the reference transcoder,
//! after what it takes from the headers unchecked has been checked.

use crate::container::{u32_at, u64_at};
use crate::limits::within;
use crate::{Encoding, Error, FileKind, Limits, Result, TexelData, Texels};
use basisu::{DecodeFlags, SourceFormat, TargetFormat, Transcoder};

const KIND: FileKind = FileKind::Ktx2;

/// Pixels that any file may have, and more only in proportion to its bytes: pictures of one colour need next to none.
const ALWAYS: u64 = 1 << 24;
const MAX_PIXELS_PER_BYTE: f64 = 4096.0;
/// Levels of a picture of 2³¹ pixels a side.
const MOST_LEVELS: usize = 32;

/// The largest level of a picture whose container was checked to hold one picture.
pub(crate) fn decode(bytes: &[u8], (width, height): (u64, u64), limits: &Limits) -> Result<Texels> {
    let pixels = if width.saturating_mul(height) > ALWAYS {
        limits.check_against(KIND, (width, height), 4, bytes.len(), MAX_PIXELS_PER_BYTE)?
    } else {
        limits.check(KIND, width, height, 4)?
    };
    // Room is made for so many bytes before any are unpacked.
    const ZSTANDARD: u32 = 2;
    if u32_at(KIND, bytes, 44)? == ZSTANDARD {
        let blocks = width.div_ceil(4) * height.div_ceil(4);
        within("the unpacked size of a KTX2 level", u64_at(KIND, bytes, 96)?, blocks * 16)?;
    }
    // The places of the global data and of all levels are added up unchecked too.
    let levels = u32_at(KIND, bytes, 40)?.max(1) as usize;
    let ends = |place: usize| -> Result<bool> {
        let end = u64_at(KIND, bytes, place)?.checked_add(u64_at(KIND, bytes, place + 8)?);
        Ok(end.is_some_and(|end| end <= bytes.len() as u64))
    };
    if levels > MOST_LEVELS
        || !ends(64)?
        || !(0..levels).map(|k| ends(80 + 24 * k)).collect::<Result<Vec<_>>>()?.iter().all(|e| *e)
    {
        return Err(Error::malformed(KIND, "its levels do not lie within the file"));
    }
    // Without its metadata, whose lengths the crate does not check.
    let mut bytes = bytes.to_vec();
    bytes.get_mut(56..64).ok_or_else(|| Error::malformed(KIND, "the file ends in its header"))?.fill(0);
    let malformed = |e: basisu::Error| Error::malformed(KIND, format!("its Basis Universal data are damaged: {e:?}"));
    let transcoder = Transcoder::new(&bytes).map_err(malformed)?;
    if !matches!(transcoder.source_format(), SourceFormat::Etc1s | SourceFormat::UastcLdr) {
        return Err(Error::unsupported(KIND, format!("Basis Universal of the kind {:?}", transcoder.source_format())));
    }
    let mut data = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(malformed)?;
    if data.len() != 4 * pixels {
        return Err(Error::malformed(KIND, "the decoded size is wrong"));
    }
    let channels = if transcoder.has_alpha() { 4 } else { 3 };
    if channels == 3 {
        data = data.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    }
    // The transfer function in the descriptor of the format (Khronos Data Format 1.3): 2 is sRGB.
    let descriptor = u32_at(KIND, &bytes, 48)? as usize;
    let is_srgb = descriptor.checked_add(14).and_then(|at| bytes.get(at)) == Some(&2);
    let encoding = if is_srgb { Encoding::Srgb } else { Encoding::Linear };
    Ok(Texels::new(width as usize, height as usize, channels, TexelData::U8(data), encoding))
}
