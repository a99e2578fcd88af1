//! Containers of Blosc (version 1) with LZ4 in them, as volumes have them.
//!
//! A head of 16 bytes (versions, flags, size of an element; then the sizes of what is packed, of a block and of the
//! whole), the places of the blocks, and the blocks. A block is one stream, or as many as an element has bytes; a
//! stream is its packed length and LZ4's sequences, or bytes as they are where the length is the unpacked one. With the
//! flag of shuffling, the first bytes of all elements of a block come first, then the second ones, and so on.

use crate::{Error, bytes::Bytes};

const SHUFFLED: u8 = 1;
const STORED: u8 = 2;
const BITS_SHUFFLED: u8 = 4;
const NOT_SPLIT: u8 = 16;
const LZ4: u8 = 1;
/// Elements of more bytes are never split into streams.
const MOST_STREAMS: u64 = 16;
/// Blocks whose streams would have fewer elements are not split.
const LEAST_STREAM: u64 = 128;
/// Most bytes that a byte of LZ4 may stand for.
const MOST_OF_LZ4: u64 = 255;

/// Unpacks a container of `size` bytes.
pub(crate) fn unpack(packed: &[u8], size: u64) -> Result<Vec<u8>, Error> {
    let packed = Bytes { all: packed, what: "a part packed by Blosc" };
    let [flags, element] = [2, 3].map(|at| packed.part(at, 1).map(|b| b[0]));
    let (flags, element) = (flags?, u64::from(element?));
    let [whole, block] = [4, 8].map(|at| packed.u32(at).map(u64::from));
    let (whole, block) = (whole?, block?);
    if whole != size {
        return Err(Error::Malformed(format!("a part unpacks to {whole} bytes where {size} are declared")));
    }
    if flags & STORED != 0 {
        return Ok(packed.part(16, size)?.to_vec());
    }
    if size > (packed.all.len() as u64).saturating_mul(MOST_OF_LZ4) {
        return Err(Error::Malformed(format!("{} packed bytes cannot stand for {size}", packed.all.len())));
    }
    if flags >> 5 != LZ4 || flags & BITS_SHUFFLED != 0 {
        return Err(Error::Unsupported("it is packed by Blosc in another way than LZ4; save it anew".into()));
    }
    if block == 0 || element == 0 {
        return Err(Error::Malformed("a part packed by Blosc has blocks of no bytes".into()));
    }
    let mut all = Vec::with_capacity(size as usize);
    for i in 0..size.div_ceil(block) {
        let length = block.min(size - i * block);
        // What is left over at the end is one stream.
        let is_split = flags & NOT_SPLIT == 0
            && element <= MOST_STREAMS
            && length == block
            && block / element >= LEAST_STREAM
            && block % element == 0;
        let streams = if is_split { element } else { 1 };
        let first = all.len();
        let mut at = u64::from(packed.u32(16 + 4 * i)?);
        for _ in 0..streams {
            let count = u64::from(packed.u32(at)?);
            let stream = packed.part(at + 4, count)?;
            let end = all.len() + (length / streams) as usize;
            if count == length / streams {
                all.extend_from_slice(stream);
            } else {
                lz4(stream, &mut all, end)?;
            }
            at += 4 + count;
        }
        if flags & SHUFFLED != 0 && element > 1 {
            gather(&mut all[first..], element as usize);
        }
    }
    Ok(all)
}

/// Puts the bytes of elements next to each other again; what is left over stays.
fn gather(block: &mut [u8], element: usize) {
    let (apart, count) = (block.to_vec(), block.len() / element);
    for (i, bytes) in block.chunks_exact_mut(element).enumerate() {
        for (k, byte) in bytes.iter_mut().enumerate() {
            *byte = apart[k * count + i];
        }
    }
}

/// Unpacks a block of LZ4's format, whose matches reach back no further than where it began, up to a length of `all`.
fn lz4(stream: &[u8], all: &mut Vec<u8>, end: usize) -> Result<(), Error> {
    let fault = || Error::Malformed("a part packed by LZ4 is damaged".into());
    let (begin, mut bytes) = (all.len(), stream.iter().copied());
    // Lengths of 15 go on in bytes until one is not 255.
    let length = |nibble: u8, bytes: &mut dyn Iterator<Item = u8>| -> Option<usize> {
        let (mut sum, mut goes_on) = (usize::from(nibble), nibble == 15);
        while goes_on {
            let more = bytes.next()?;
            sum += usize::from(more);
            goes_on = more == 255;
        }
        Some(sum)
    };
    while all.len() < end {
        // A sequence: literal bytes, then a match, which the last one has not.
        let token = bytes.next().ok_or_else(fault)?;
        let literals = length(token >> 4, &mut bytes).filter(|n| *n <= end - all.len()).ok_or_else(fault)?;
        let before = all.len();
        all.extend(bytes.by_ref().take(literals));
        if all.len() != before + literals {
            return Err(fault());
        }
        if all.len() == end {
            break;
        }
        let [low, high] = [bytes.next(), bytes.next()].map(|b| b.ok_or_else(fault));
        let back = usize::from(u16::from_le_bytes([low?, high?]));
        let count = length(token & 15, &mut bytes).map(|n| n + 4).filter(|n| *n <= end - all.len());
        let count = count.ok_or_else(fault)?;
        if back == 0 || back > all.len() - begin {
            return Err(fault());
        }
        // Matches may reach into themselves.
        for _ in 0..count {
            all.push(all[all.len() - back]);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// LZ4's sequences with nothing but literal bytes, and one with a match that reaches into itself.
    #[test]
    fn sequences_are_unpacked() {
        let run = |stream: &[u8], end| {
            let mut all = Vec::new();
            lz4(stream, &mut all, end).map(|()| all)
        };
        assert_eq!(run(b"\x30abc", 3).unwrap(), b"abc");
        // Two bytes, then nine from two back, then one.
        assert_eq!(run(b"\x25ab\x02\x00\x10!", 12).unwrap(), b"abababababa!");
        let long: Vec<u8> = [0xf0, 255, 3].into_iter().chain((0..273).map(|i| i as u8)).collect();
        assert_eq!(run(&long, 273).unwrap()[272], 16);
        for bad in [&b""[..], b"\x30ab", b"\x25ab\x03\x00\x10!", b"\x25ab\x00\x00\x10!", b"\xf0\xff"] {
            assert!(run(bad, 12).is_err());
        }
    }

    #[test]
    fn blocks_are_put_together() {
        // 128 elements of two bytes, shuffled into two streams: one as it is, one of a match.
        let mut packed = vec![2, 1, SHUFFLED | LZ4 << 5, 2];
        for v in [256_u32, 256, 0, 20] {
            packed.extend(v.to_le_bytes());
        }
        packed.extend(128_u32.to_le_bytes());
        packed.extend(0..128);
        packed.extend(6_u32.to_le_bytes());
        // One byte, and 127 like it.
        packed.extend([0x1f, 7, 1, 0, 108, 0]);
        let all = unpack(&packed, 256).unwrap();
        assert!(all.chunks(2).enumerate().all(|(i, pair)| pair == [i as u8, 7]));
        for end in 0..packed.len() - 1 {
            assert!(unpack(&packed[..end], 256).is_err(), "{end}");
        }
    }
}
