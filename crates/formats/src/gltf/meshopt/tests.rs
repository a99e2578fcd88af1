//! Streams of the reference encoder (meshoptimizer 0.23, by scripts/packed_gltf.py), and mutants of them.

use super::{Packing, filters};
use crate::mesh::test_files::mutants;

struct Case {
    mode: String,
    filter: String,
    count: usize,
    stride: usize,
    packed: Vec<u8>,
    plain: Vec<u8>,
}

impl Case {
    fn packing(&self) -> Packing<'_> {
        Packing { mode: &self.mode, filter: &self.filter, count: self.count, stride: self.stride }
    }
}

fn cases() -> Vec<Case> {
    let hex = |text: &str| -> Vec<u8> {
        text.as_bytes()
            .chunks(2)
            .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap())
            .collect()
    };
    let case = |line: &str| {
        let words: Vec<_> = line.split(' ').collect();
        let number = |k: usize| words[k].parse().unwrap();
        let (mode, filter) = (words[0].to_owned(), words[1].to_owned());
        Case { mode, filter, count: number(2), stride: number(3), packed: hex(words[4]), plain: hex(words[5]) }
    };
    include_str!("../packed/streams.txt").lines().map(case).collect()
}

/// Largest difference between two lists of signed integers of one or two bytes, in units of the last place.
fn apart(a: &[u8], b: &[u8], size: usize) -> i32 {
    let number = |b: &[u8]| if size == 1 { i32::from(b[0] as i8) } else { i32::from(i16::from_le_bytes([b[0], b[1]])) };
    a.chunks(size).zip(b.chunks(size)).map(|(a, b)| (number(a) - number(b)).abs()).max().unwrap_or(0)
}

#[test]
fn streams_of_the_reference_encoder_unpack() {
    let mut count = 0;
    for (k, case) in cases().iter().enumerate() {
        case.packing().check().unwrap();
        let found = case.packing().unpack(&case.packed).unwrap_or_else(|e| panic!("{k}: {e}"));
        assert_eq!(found.len(), case.plain.len(), "{k}");
        // Appendix B allows filters an error of one unit, but for EXPONENTIAL.
        let most = i32::from(matches!(case.filter.as_str(), "OCTAHEDRAL" | "QUATERNION"));
        let size = if case.stride == 4 || most == 0 { 1 } else { 2 };
        let first = found.iter().zip(&case.plain).position(|(a, b)| a != b);
        let error = apart(&found, &case.plain, size);
        assert!(error <= most, "case {k} {} {}: {error} at byte {first:?}", case.mode, case.filter);
        count += 1;
    }
    assert_eq!(count, 30);
}

/// The bytes that are spelt out in the extension's text.
#[test]
fn the_example_of_the_specification_unpacks() {
    let group = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
    let deltas: [i32; 16] = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0];
    // One block of 16 elements: groups of four bits in the first byte, none in the others; then padding and the base.
    let mut packed = vec![0xa0, 2];
    packed.extend(group);
    packed.extend([0; 3 + 28 + 4]);
    let packing = Packing { mode: "ATTRIBUTES", filter: "NONE", count: 16, stride: 4 };
    let mut sum = 0i32;
    let wanted = deltas.map(|d| {
        sum += d;
        [sum as u8, 0, 0, 0]
    });
    assert_eq!(packing.unpack(&packed).unwrap(), wanted.as_flattened());
}

#[test]
fn colors_come_back() {
    // Y, Co, Cg of whole numbers (r, g, b): Co = (r − b)/2, Cg = (g − (r + b)/2)/2, Y = g − Cg; alpha has one bit less.
    for [r, g, b, a] in [[200i32, 40, 100, 255], [0, 0, 0, 0], [255, 255, 255, 129], [10, 250, 10, 1]] {
        let co = (r - b) / 2;
        let around = b + co;
        let cg = (g - around) / 2;
        let y = around + cg;
        let mut bytes = [y as u8, co as u8, cg as u8, 128 | (a / 2) as u8];
        filters::color(&mut bytes, 4);
        let near = [r, g, b, a].iter().zip(bytes).all(|(v, found)| (v - i32::from(found)).abs() <= 1);
        assert!(near, "{:?} became {bytes:?}", [r, g, b, a]);
        // Of 16 bits, packed by ten: codes of up to 1023 become 65535 times their part.
        let mut words: Vec<u8> =
            [4 * y, 4 * co, 4 * cg, 512 | a].iter().flat_map(|v| (*v as i16).to_le_bytes()).collect();
        filters::color(&mut words, 8);
        let red = f64::from(u16::from_le_bytes([words[0], words[1]]));
        assert!((red - f64::from(4 * (y + co - cg)) * 65535.0 / 1023.0).abs() <= 0.5, "{red}");
    }
}

#[test]
fn cut_off_and_changed_streams_do_not_panic() {
    for case in cases() {
        for cut in 0..case.packed.len() {
            assert!(case.packing().unpack(&case.packed[..cut]).is_err(), "{} cut at {cut}", case.mode);
        }
        let mut long = case.packed.clone();
        long.insert(1, 0);
        long.push(0);
        let _ = case.packing().unpack(&long);
        mutants(&case.packed, 300, |bytes| {
            if let Ok(found) = case.packing().unpack(bytes) {
                assert_eq!(found.len(), case.count * case.stride);
            }
        });
    }
}

#[test]
fn counts_beyond_the_data_are_refused_at_once() {
    for case in cases() {
        let count = usize::MAX / 8 / 3 * 3;
        let packing = Packing { count, ..case.packing() };
        assert!(packing.unpack(&case.packed).is_err());
    }
}
