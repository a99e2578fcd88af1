//! Unpacking of zlib's streams into a size that is known.

use crate::Error;
use std::io::Read;

/// Most bytes that a byte of a deflated stream may stand for (Deutsch, RFC 1951: 258 bytes of two bits).
const MOST_OF_ZLIB: u64 = 1032;

/// Inflates a stream of zlib into `size` bytes.
pub(crate) fn inflate(packed: &[u8], size: u64) -> Result<Vec<u8>, Error> {
    if size > (packed.len() as u64).saturating_mul(MOST_OF_ZLIB) {
        return Err(Error::Malformed(format!("{} packed bytes cannot stand for {size}", packed.len())));
    }
    let mut all = Vec::new();
    let outcome = flate2::read::ZlibDecoder::new(packed).take(size + 1).read_to_end(&mut all);
    match outcome {
        Ok(_) if all.len() as u64 == size => Ok(all),
        Ok(_) => Err(Error::Malformed(format!("a part unpacks to {} bytes where {size} are declared", all.len()))),
        Err(e) => Err(Error::Malformed(format!("a part cannot be unpacked ({e})"))),
    }
}
