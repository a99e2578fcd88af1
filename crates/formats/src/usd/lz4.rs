//! Blocks of LZ4, in the framing of binary layers.

/// Unpacks to at most `most` bytes; `None` where the data are damaged or longer.
///
/// A first byte of zero is followed by one block, else by so many, each after its length in four bytes.
pub(super) fn unpack(data: &[u8], most: usize) -> Option<Vec<u8>> {
    let (&count, mut rest) = data.split_first()?;
    let mut out = Vec::new();
    if count == 0 {
        block(rest, most, &mut out)?;
        return Some(out);
    }
    for _ in 0..count {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let length = u32::from_le_bytes(*length) as usize;
        let base = out.len();
        let mut part = Vec::new();
        block(after.get(..length)?, most.checked_sub(base)?, &mut part)?;
        out.extend(part);
        rest = after.get(length..)?;
    }
    Some(out)
}

/// The rest of a length whose first four bits are `first`.
fn length(first: u8, data: &mut &[u8]) -> Option<usize> {
    let mut length = usize::from(first);
    if first == 15 {
        loop {
            let (&more, rest) = data.split_first()?;
            *data = rest;
            length = length.checked_add(usize::from(more))?;
            if more != 255 {
                break;
            }
        }
    }
    Some(length)
}

fn block(mut data: &[u8], most: usize, out: &mut Vec<u8>) -> Option<()> {
    loop {
        let (&token, rest) = data.split_first()?;
        data = rest;
        let literals = length(token >> 4, &mut data)?;
        if out.len().checked_add(literals)? > most {
            return None;
        }
        out.extend_from_slice(data.get(..literals)?);
        data = data.get(literals..)?;
        // The last sequence has literals alone.
        let Some((offset, rest)) = data.split_first_chunk::<2>() else { return data.is_empty().then_some(()) };
        data = rest;
        let offset = usize::from(u16::from_le_bytes(*offset));
        let count = length(token & 15, &mut data)?.checked_add(4)?;
        if offset == 0 || out.len().checked_add(count)? > most {
            return None;
        }
        let from = out.len().checked_sub(offset)?;
        // What is copied may overlap what is made.
        for k in 0..count {
            let byte = *out.get(from + k)?;
            out.push(byte);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_unpacked_and_damaged_ones_refused() {
        // Three letters, then nine bytes from three back, then the literal end.
        let packed = [0, 0x35, b'a', b'b', b'c', 3, 0, 0x10, b'!'];
        assert_eq!(unpack(&packed, 100).unwrap(), b"abcabcabcabc!");
        assert_eq!(unpack(&packed, 12), None);
        assert_eq!(unpack(&packed[..6], 100), None);
        assert_eq!(unpack(&[0, 0x05, 1, 0], 100), None);
        let mut two = vec![2, 8, 0, 0, 0];
        two.extend(&packed[1..]);
        two.extend([8, 0, 0, 0]);
        two.extend(&packed[1..]);
        assert_eq!(unpack(&two, 100).unwrap(), b"abcabcabcabc!abcabcabcabc!");
    }
}
