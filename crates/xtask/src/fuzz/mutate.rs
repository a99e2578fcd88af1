//! Damage: bits and bytes changed, pieces cut, left out, repeated and taken from other seeds, numbers replaced by odd
//! ones.

use steradian::math::hash::HashRng;

/// Replacements of numbers in texts.
const NUMBERS: [&str; 20] = [
    "nan",
    "inf",
    "-inf",
    "1e39",
    "-1e39",
    "1e38",
    "-1",
    "0",
    "-0",
    "1e-45",
    "1e400",
    "4294967296",
    "-2147483649",
    "9223372036854775808",
    "18446744073709551616",
    "0.5",
    "x",
    "",
    "00000000000000000001",
    "1e",
];
/// Replacements of whole numbers in bytes.
const WHOLE: [u64; 12] =
    [0, 1, 0x7f, 0x80, 0xff, 0x7fff, 0xffff, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x7fff_ffff_ffff_ffff, u64::MAX];
/// Longest input, bytes.
const LONGEST: usize = 1 << 18;

/// Makes an input of one of some seeds: of sixteen one is sound, others have one to eight faults.
pub fn mutate(seeds: &[Vec<u8>], rng: &mut HashRng) -> Vec<u8> {
    let mut below = |n: usize| (rng.next_u64() % n.max(1) as u64) as usize;
    let Some(seed) = seeds.get(below(seeds.len())) else { return Vec::new() };
    let other = &seeds[below(seeds.len())];
    let mut bytes = seed.clone();
    if below(16) == 0 {
        return bytes;
    }
    let is_text = std::str::from_utf8(seed).is_ok();
    for _ in 0..=below(2) * below(8) {
        if bytes.is_empty() {
            break;
        }
        let at = below(bytes.len());
        match below(if is_text { 16 } else { 11 }) {
            0 => bytes[at] ^= 1 << below(8),
            1 => bytes[at] = below(256) as u8,
            2 => bytes.truncate(at),
            3 => _ = bytes.drain(at..(at + below(60)).min(bytes.len())),
            4 => {
                let piece = bytes[at..(at + below(200)).min(bytes.len())].to_vec();
                let to = below(bytes.len());
                bytes.splice(to..to, piece);
            }
            5 => {
                let end = (at + below(8) + 1).min(bytes.len());
                bytes[at..end].fill([0, 0xff, 0x80, 0x7f][below(4)]);
            }
            6 | 7 => {
                let (number, size) = (WHOLE[below(WHOLE.len())], 1 << below(4));
                let digits =
                    if below(2) == 0 { number.to_le_bytes() } else { (number << (64 - 8 * size)).to_be_bytes() };
                let end = (at + size).min(bytes.len());
                bytes[at..end].copy_from_slice(&digits[..end - at]);
            }
            8 => {
                let from = below(other.len());
                let piece = other[from..(from + below(300)).min(other.len())].to_vec();
                bytes.splice(at..at, piece);
            }
            9 => {
                bytes.truncate(at);
                bytes.extend_from_slice(&other[below(other.len())..]);
            }
            10 => {
                let piece = bytes[at..(at + 1 + below(16)).min(bytes.len())].to_vec();
                bytes.splice(at..at, piece.repeat(1 + below(64)));
            }
            _ => replace_number(&mut bytes, at, NUMBERS[below(NUMBERS.len())]),
        }
    }
    bytes.truncate(LONGEST);
    bytes
}

/// Replaces the first number from a place on.
fn replace_number(bytes: &mut Vec<u8>, from: usize, by: &str) {
    let is_part = |b: &u8| b.is_ascii_digit() || b"+-.".contains(b);
    let Some(start) = bytes[from..].iter().position(is_part).map(|i| from + i) else { return };
    let length = bytes[start..].iter().position(|b| !is_part(b)).unwrap_or(bytes.len() - start);
    bytes.splice(start..start + length, by.bytes());
}
