//! Attributes (appendix A, mode 0): blocks of elements, in them byte by byte, the differences from one element to the
//! next in groups of 16.

use super::{Stream, unzigzag};

/// Elements of a group.
const GROUP: usize = 16;

/// Elements of `stride` bytes, a multiple of four up to 256.
pub(super) fn unpack(packed: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    let mut stream = Stream { left: packed };
    let is_new = match stream.byte()? {
        0xa0 => false,
        0xa1 => true,
        byte => return Err(format!("packed attributes begin with the byte 0xa0 or 0xa1, not 0x{byte:02x}")),
    };
    // The first element's base and the kinds of differences stand at the end.
    let channels = stride / 4;
    let (tail, least) = if is_new { (stride + channels, 24) } else { (stride, 32) };
    let body = stream.left.len().checked_sub(tail.max(least)).ok_or("the packed data ends early")?;
    let (body, end) = stream.left.split_at(body);
    let end = &end[end.len() - tail..];
    let mut last = end[..stride].to_vec();
    let modes = if is_new { end[stride..].to_vec() } else { vec![0; channels] };
    if let Some(mode) = modes.iter().find(|m| !matches!(**m, 0 | 1) && **m & 15 != 2) {
        return Err(format!("the kind of differences 0x{mode:02x} is not known"));
    }
    let mut stream = Stream { left: body };
    let in_block = ((8192 / stride) & !15).min(256);
    let mut out = Vec::new();
    let mut deltas = vec![0; in_block * stride];
    let mut left = count;
    while left > 0 {
        let elements = left.min(in_block);
        let groups = elements.div_ceil(GROUP);
        let controls = if is_new { Some(stream.take(channels)?) } else { None };
        for (byte, plane) in deltas.chunks_exact_mut(in_block).enumerate() {
            match controls.map(|c| c[byte / 4] >> (byte % 4 * 2) & 3) {
                None => plane_of_groups(&mut stream, &mut plane[..groups * GROUP], [0, 2, 4, 8])?,
                Some(0) => plane_of_groups(&mut stream, &mut plane[..groups * GROUP], [0, 1, 2, 4])?,
                Some(1) => plane_of_groups(&mut stream, &mut plane[..groups * GROUP], [1, 2, 4, 8])?,
                Some(2) => plane.fill(0),
                Some(_) => plane[..elements].copy_from_slice(stream.take(elements)?),
            }
        }
        for k in 0..elements {
            for (channel, mode) in modes.iter().enumerate() {
                let delta = std::array::from_fn(|b| deltas[(4 * channel + b) * in_block + k]);
                if let Some(value) = last[4 * channel..].first_chunk_mut::<4>() {
                    *value = step(*value, delta, *mode);
                }
            }
            out.extend_from_slice(&last);
        }
        left -= elements;
    }
    stream.finish()?;
    Ok(out)
}

/// The differences of one byte of all elements of a block, whose groups have one of four numbers of bits.
fn plane_of_groups(stream: &mut Stream<'_>, plane: &mut [u8], widths: [u32; 4]) -> Result<(), String> {
    let header = stream.take((plane.len() / GROUP).div_ceil(4))?;
    for (k, group) in plane.chunks_exact_mut(GROUP).enumerate() {
        let width = widths[usize::from(header[k / 4] >> (k % 4 * 2) & 3)];
        match width {
            0 => group.fill(0),
            8 => group.copy_from_slice(stream.take(GROUP)?),
            _ => {
                let bits = stream.take(2 * width as usize)?;
                let (most, in_byte) = ((1u8 << width) - 1, 8 / width as usize);
                for (n, delta) in group.iter_mut().enumerate() {
                    // The first is in the highest bits, but of single bits in the lowest.
                    let place = if width == 1 { n % 8 } else { (in_byte - 1 - n % in_byte) * width as usize };
                    *delta = bits[n / in_byte] >> place & most;
                }
                // What does not fit follows as a whole byte.
                for delta in group.iter_mut().filter(|d| **d == most) {
                    *delta = stream.byte()?;
                }
            }
        }
    }
    Ok(())
}

/// Four bytes of an element from those of the one before.
fn step(before: [u8; 4], delta: [u8; 4], mode: u8) -> [u8; 4] {
    match mode & 15 {
        0 => std::array::from_fn(|k| before[k].wrapping_add(unzigzag(delta[k].into()) as u8)),
        1 => {
            let half = |k: usize| {
                let delta = unzigzag(u16::from_le_bytes([delta[k], delta[k + 1]]).into()) as u16;
                u16::from_le_bytes([before[k], before[k + 1]]).wrapping_add(delta).to_le_bytes()
            };
            let ([a, b], [c, d]) = (half(0), half(2));
            [a, b, c, d]
        }
        _ => {
            let turned = u32::from_le_bytes(delta).rotate_right(u32::from(mode >> 4));
            (u32::from_le_bytes(before) ^ turned).to_le_bytes()
        }
    }
}
