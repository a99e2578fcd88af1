//! BC4: two 8-bit ends, and for each texel which of eight values between them it has; or of six, with 0 and 255
//! besides.

/// Encodes one channel of a block.
pub fn encode(values: &[u8; 16]) -> [u8; 8] {
    let (low, high) = (values.iter().min().copied().unwrap_or(0), values.iter().max().copied().unwrap_or(0));
    let eight = assign(values, high, low);
    // Where extremes occur the others may lie closer together.
    let inner = values.iter().copied().filter(|v| (1..255).contains(v));
    let (a, b) = (inner.clone().min(), inner.max());
    match (a, b) {
        (Some(a), Some(b)) if low == 0 || high == 255 => {
            let six = assign(values, a, b);
            if six.0 < eight.0 { six.1 } else { eight.1 }
        }
        _ => eight.1,
    }
}

/// Squared error and bytes for two ends: eight values where the first is larger, six and the extremes where it is not.
fn assign(values: &[u8; 16], a: u8, b: u8) -> (u32, [u8; 8]) {
    let (x, y) = (u32::from(a), u32::from(b));
    let palette: [u32; 8] = if a > b {
        std::array::from_fn(|i| match i as u32 {
            0 => x,
            1 => y,
            i => ((8 - i) * x + (i - 1) * y + 3) / 7,
        })
    } else {
        std::array::from_fn(|i| match i as u32 {
            0 => x,
            1 => y,
            6 => 0,
            7 => 255,
            i => ((6 - i) * x + (i - 1) * y + 2) / 5,
        })
    };
    let (mut error, mut bits) = (0, 0_u64);
    for (k, &v) in values.iter().enumerate() {
        let distance = |p: &u32| p.abs_diff(u32::from(v)).pow(2);
        let (index, least) = palette
            .iter()
            .enumerate()
            .map(|(i, p)| (i as u64, distance(p)))
            .fold((0, u32::MAX), |best, now| if now.1 < best.1 { now } else { best });
        error += least;
        bits |= index << (3 * k);
    }
    let mut bytes = [a, b, 0, 0, 0, 0, 0, 0];
    bytes[2..].copy_from_slice(&bits.to_le_bytes()[..6]);
    (error, bytes)
}
