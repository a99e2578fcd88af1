//! Block compression: 4 × 4 texels in 8 or 16 bytes (BC1 to BC7, Khronos Data Format Specification 1.3, chapters 18 to
//! 20). Decoding is the crate `bcdec_rs`'s; encoders are our own: BC1 to BC5, BC6H without
//! signs by its mode 11, and BC7 by its mode 6.

mod bc1;
mod bc2;
mod bc4;
mod bc6h;
mod bc7;

use half::f16;
use rayon::prelude::*;

/// A way to compress blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BlockFormat {
    /// Colours on a line between two ends, 8 bytes; one bit of alpha, which is not written.
    Bc1,
    /// BC1 colours with four bits of alpha for each texel, 16 bytes.
    Bc2,
    /// BC1 colours with alpha as in BC4, 16 bytes.
    Bc3,
    /// One channel between two ends, 8 bytes.
    Bc4,
    /// Two channels as in BC4, 16 bytes.
    Bc5,
    /// Three half floats, 16 bytes; those with signs are only read.
    Bc6h,
    /// Colour and alpha, 16 bytes.
    Bc7,
}

/// The formats that can be written, by name.
pub const WRITABLE: [(&str, BlockFormat); 7] = [
    ("bc1", BlockFormat::Bc1),
    ("bc2", BlockFormat::Bc2),
    ("bc3", BlockFormat::Bc3),
    ("bc4", BlockFormat::Bc4),
    ("bc5", BlockFormat::Bc5),
    ("bc6h", BlockFormat::Bc6h),
    ("bc7", BlockFormat::Bc7),
];

impl BlockFormat {
    /// Bytes of a block.
    pub fn block_bytes(self) -> usize {
        if matches!(self, Self::Bc1 | Self::Bc4) { 8 } else { 16 }
    }

    /// Bytes of a picture.
    pub fn bytes(self, width: usize, height: usize) -> usize {
        width.div_ceil(4) * height.div_ceil(4) * self.block_bytes()
    }

    /// True if samples are codes of colours, which may be sRGB-encoded.
    pub fn is_colour(self) -> bool {
        matches!(self, Self::Bc1 | Self::Bc2 | Self::Bc3 | Self::Bc7)
    }
}

/// Decodes a picture whose every block gives 16 texels of `lanes` samples; `data` is as long as [`BlockFormat::bytes`]
/// says.
fn decode_blocks<T: Copy + Default + Send>(
    data: &[u8],
    (width, height): (usize, usize),
    lanes: usize,
    block_bytes: usize,
    block: impl Fn(&[u8], &mut [T]) + Sync,
) -> Vec<T> {
    let mut texels = vec![T::default(); width * height * lanes];
    let rows = texels.par_chunks_mut(4 * width * lanes).zip(data.par_chunks(width.div_ceil(4) * block_bytes));
    rows.for_each(|(texels, blocks)| {
        let mut sixteen = vec![T::default(); 16 * lanes];
        for (bx, bytes) in blocks.chunks_exact(block_bytes).enumerate() {
            block(bytes, &mut sixteen);
            let across = (width - 4 * bx).min(4) * lanes;
            for (row, four) in texels.chunks_exact_mut(width * lanes).zip(sixteen.chunks_exact(4 * lanes)) {
                row[4 * bx * lanes..][..across].copy_from_slice(&four[..across]);
            }
        }
    });
    texels
}

/// Samples of decoded blocks.
#[derive(Clone, Debug, PartialEq)]
pub enum Decoded {
    /// Interleaved 8-bit codes of so many channels.
    Codes(Vec<u8>, usize),
    /// Interleaved half floats of so many channels.
    Halves(Vec<f16>, usize),
}

/// Decodes a picture; `None` when there are fewer bytes than its blocks take. `signed` is for BC4, BC5 and BC6H. BC5
/// gives red and green, and blue of zero. Colours whose alpha is one everywhere are given without it.
pub fn decode(format: BlockFormat, signed: bool, data: &[u8], width: usize, height: usize) -> Option<Decoded> {
    let size = (width, height);
    let data = data.get(..format.bytes(width, height))?;
    let n = format.block_bytes();
    let colour = |block: fn(&[u8], &mut [u8], usize)| {
        let texels = decode_blocks(data, size, 4, n, |bytes, out: &mut [u8]| block(bytes, out, 16));
        let opaque = texels.chunks_exact(4).all(|t| t[3] == 255);
        if opaque {
            Decoded::Codes(texels.chunks_exact(4).flat_map(|t| [t[0], t[1], t[2]]).collect(), 3)
        } else {
            Decoded::Codes(texels, 4)
        }
    };
    Some(match format {
        BlockFormat::Bc1 => colour(bcdec_rs::bc1),
        BlockFormat::Bc2 => colour(bcdec_rs::bc2),
        BlockFormat::Bc3 => colour(bcdec_rs::bc3),
        BlockFormat::Bc7 => colour(bcdec_rs::bc7),
        BlockFormat::Bc4 if signed => {
            let floats =
                decode_blocks(data, size, 1, n, |bytes, out: &mut [f32]| bcdec_rs::bc4_float(bytes, out, 4, true));
            Decoded::Halves(floats.into_iter().map(f16::from_f32).collect(), 1)
        }
        BlockFormat::Bc4 => Decoded::Codes(
            decode_blocks(data, size, 1, n, |bytes, out: &mut [u8]| bcdec_rs::bc4(bytes, out, 4, false)),
            1,
        ),
        BlockFormat::Bc5 if signed => {
            let floats =
                decode_blocks(data, size, 2, n, |bytes, out: &mut [f32]| bcdec_rs::bc5_float(bytes, out, 8, true));
            let texels = floats.chunks_exact(2).flat_map(|t| [t[0], t[1], 0.0].map(f16::from_f32));
            Decoded::Halves(texels.collect(), 3)
        }
        BlockFormat::Bc5 => {
            let codes = decode_blocks(data, size, 2, n, |bytes, out: &mut [u8]| bcdec_rs::bc5(bytes, out, 8, false));
            Decoded::Codes(codes.chunks_exact(2).flat_map(|t| [t[0], t[1], 0]).collect(), 3)
        }
        BlockFormat::Bc6h => {
            let bits =
                decode_blocks(data, size, 3, n, |bytes, out: &mut [u16]| bcdec_rs::bc6h_half(bytes, out, 12, signed));
            Decoded::Halves(bits.into_iter().map(f16::from_bits).collect(), 3)
        }
    })
}

/// Encodes interleaved RGBA codes; edges are continued to whole blocks. `None` for BC6H, which has no codes.
pub fn encode(format: BlockFormat, rgba: &[u8], width: usize, height: usize) -> Option<Vec<u8>> {
    if format == BlockFormat::Bc6h {
        return None;
    }
    let texel = |at: usize| [rgba[4 * at], rgba[4 * at + 1], rgba[4 * at + 2], rgba[4 * at + 3]];
    Some(encode_blocks(format, (width, height), texel, |texels, bytes| {
        let lane = |c: usize| texels.map(|t| t[c]);
        match format {
            BlockFormat::Bc1 => bytes.copy_from_slice(&bc1::encode(texels)),
            BlockFormat::Bc2 => {
                bytes[..8].copy_from_slice(&bc2::encode_alpha(&lane(3)));
                bytes[8..].copy_from_slice(&bc1::encode(texels));
            }
            BlockFormat::Bc3 => {
                bytes[..8].copy_from_slice(&bc4::encode(&lane(3)));
                bytes[8..].copy_from_slice(&bc1::encode(texels));
            }
            BlockFormat::Bc4 => bytes.copy_from_slice(&bc4::encode(&lane(0))),
            BlockFormat::Bc5 => {
                bytes[..8].copy_from_slice(&bc4::encode(&lane(0)));
                bytes[8..].copy_from_slice(&bc4::encode(&lane(1)));
            }
            BlockFormat::Bc7 => bytes.copy_from_slice(&bc7::encode(texels)),
            BlockFormat::Bc6h => {}
        }
    }))
}

/// Encodes linear values as BC6H without signs: below zero they become zero. `texel` gives the one of an index, by
/// rows.
pub fn encode_linear(width: usize, height: usize, texel: impl Fn(usize) -> [f32; 3] + Sync) -> Vec<u8> {
    encode_blocks(BlockFormat::Bc6h, (width, height), texel, |texels, bytes| {
        bytes.copy_from_slice(&bc6h::encode(texels));
    })
}

/// Encodes each block of a picture, whose edges are continued to whole ones.
fn encode_blocks<T>(
    format: BlockFormat,
    (width, height): (usize, usize),
    texel: impl Fn(usize) -> T + Sync,
    block: impl Fn(&[T; 16], &mut [u8]) + Sync,
) -> Vec<u8> {
    let mut out = vec![0; format.bytes(width, height)];
    out.par_chunks_mut(width.div_ceil(4) * format.block_bytes()).enumerate().for_each(|(by, row)| {
        for (bx, bytes) in row.chunks_exact_mut(format.block_bytes()).enumerate() {
            let texels = std::array::from_fn(|i| {
                texel((4 * by + i / 4).min(height - 1) * width + (4 * bx + i % 4).min(width - 1))
            });
            block(&texels, bytes);
        }
    });
    out
}

/// The mean of points, and the line through it along which they vary most (by power iteration on their covariance).
fn principal_line<const N: usize>(points: &[[f32; N]; 16]) -> ([f32; N], [f32; N]) {
    let mut mean = [0.0; N];
    points.iter().for_each(|p| (0..N).for_each(|c| mean[c] += p[c] / 16.0));
    let mut covariance = [[0.0; N]; N];
    for p in points {
        for (i, row) in covariance.iter_mut().enumerate() {
            (0..N).for_each(|j| row[j] += (p[i] - mean[i]) * (p[j] - mean[j]));
        }
    }
    // From the row of the channel that varies most, which is not at right angles to the line.
    let widest = (0..N).max_by(|&a, &b| covariance[a][a].total_cmp(&covariance[b][b])).unwrap_or(0);
    let mut axis = covariance[widest];
    for _ in 0..8 {
        let turned: [f32; N] = std::array::from_fn(|i| (0..N).map(|j| covariance[i][j] * axis[j]).sum());
        let length = turned.iter().map(|v| v * v).sum::<f32>().sqrt();
        if length < 1e-12 {
            break;
        }
        axis = turned.map(|v| v / length);
    }
    (mean, axis)
}

/// The two ends of the line that all points lie between.
fn ends_of_line<const N: usize>(points: &[[f32; N]; 16]) -> [[f32; N]; 2] {
    let (mean, axis) = principal_line(points);
    let square = axis.iter().map(|v| v * v).sum::<f32>().max(1e-12);
    let along = points.map(|p| (0..N).map(|c| (p[c] - mean[c]) * axis[c]).sum::<f32>() / square);
    let (low, high) = along.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), &t| (a.min(t), b.max(t)));
    [low, high].map(|t| std::array::from_fn(|c| mean[c] + axis[c] * t))
}

/// Sixty-fourths of the way between ends that the sixteen indices of BC6H and BC7 stand for.
const SIXTEEN_PLACES: [u32; 16] = [0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64];

/// Index of the nearest colour of a palette for each point, and the sum of squared distances.
fn nearest_of_palette(points: &[[f32; 3]; 16], palette: &[[f32; 3]]) -> (f32, [u8; 16]) {
    let mut error = 0.0;
    let indices = points.map(|p| {
        let distance = |q: &[f32; 3]| (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f32>();
        let (index, least) = palette
            .iter()
            .enumerate()
            .map(|(i, q)| (i as u8, distance(q)))
            .fold((0, f32::INFINITY), |best, now| if now.1 < best.1 { now } else { best });
        error += least;
        index
    });
    (error, indices)
}

/// The ends for which the points at these places between them (0 to 1) are nearest to the given ones, by least squares.
fn refined_ends<const N: usize>(points: &[[f32; N]; 16], places: &[f32; 16]) -> Option<[[f32; N]; 2]> {
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    let (mut pa, mut pb) = ([0.0; N], [0.0; N]);
    for (p, &t) in points.iter().zip(places) {
        let s = 1.0 - t;
        (aa, ab, bb) = (aa + s * s, ab + s * t, bb + t * t);
        (0..N).for_each(|c| {
            pa[c] += s * p[c];
            pb[c] += t * p[c];
        });
    }
    let det = aa * bb - ab * ab;
    (det > 1e-6).then(|| {
        [
            std::array::from_fn(|c| (bb * pa[c] - ab * pb[c]) / det),
            std::array::from_fn(|c| (aa * pb[c] - ab * pa[c]) / det),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(i: usize) -> u8 {
        ((i as u32).wrapping_mul(2_654_435_761) >> 24) as u8
    }

    /// Mean squared error of the first `lanes` channels after a round trip.
    fn loss(format: BlockFormat, rgba: &[u8], width: usize, height: usize, lanes: usize) -> f64 {
        let bytes = encode(format, rgba, width, height).unwrap();
        assert_eq!(bytes.len(), format.bytes(width, height));
        let Some(Decoded::Codes(codes, n)) = decode(format, false, &bytes, width, height) else { panic!("codes") };
        assert_eq!(codes.len(), width * height * n);
        let pairs = rgba.chunks_exact(4).zip(codes.chunks_exact(n));
        let sum: f64 =
            pairs.flat_map(|(a, b)| (0..lanes.min(n)).map(move |c| (f64::from(a[c]) - f64::from(b[c])).powi(2))).sum();
        sum / (width * height * lanes) as f64
    }

    fn photo(width: usize, height: usize) -> Vec<u8> {
        let texel = |i: usize| {
            let (x, y) = ((i % width) as f32, (i / width) as f32);
            let wave = |f: f32, g: f32, p: f32| (127.0 + 100.0 * ((x * f + y * g + p).sin())) as u8;
            [wave(0.11, 0.05, 0.0), wave(0.07, 0.13, 1.0), wave(0.02, 0.2, 2.0), wave(0.09, -0.04, 0.5)]
        };
        (0..width * height).flat_map(texel).collect()
    }

    #[test]
    fn encoded_pictures_decode_to_what_they_were() {
        // Signal to noise of 32 dB for four colours on a line (a mean square of 41), 34 dB with alpha besides, 44 dB
        // for single channels and 33 dB for sixteen places on one line through four channels that have nothing to do
        // with each other.
        let (w, h) = (61, 37);
        let rgba = photo(w, h);
        for (format, lanes, bound) in [
            (BlockFormat::Bc1, 3, 41.0),
            (BlockFormat::Bc3, 4, 25.0),
            (BlockFormat::Bc4, 1, 2.6),
            (BlockFormat::Bc5, 2, 2.6),
            (BlockFormat::Bc7, 4, 33.0),
        ] {
            let mse = loss(format, &rgba, w, h, lanes);
            assert!(mse < bound, "{format:?}: {mse}");
        }
        // Four bits of alpha: a step of 17 has a mean square of 17²/12 = 24 in one of four channels.
        let mse = loss(BlockFormat::Bc2, &rgba, w, h, 4);
        assert!(mse < 0.75 * 41.0 + 0.25 * 25.0, "BC2: {mse}");
        assert_eq!(encode(BlockFormat::Bc6h, &rgba, w, h), None);
        // Where they have, as in most pictures: 46 dB.
        let tinted: Vec<u8> = rgba.chunks_exact(4).flat_map(|t| [t[0], t[0] / 2 + 90, 200 - t[0] / 3, 255]).collect();
        let mse = loss(BlockFormat::Bc7, &tinted, w, h, 3);
        assert!(mse < 1.6, "{mse}");
    }

    /// BC6H over eight powers of ten: errors are relative, and values that half floats do not have become the nearest.
    #[test]
    fn bright_pictures_keep_their_range() {
        let (w, h) = (61, 37);
        let value = |i: usize| {
            let (x, y) = ((i % w) as f32, (i / w) as f32);
            let light = 10f32.powf(4.0 * (0.05 * x + 0.03 * y).sin());
            [light, 0.6 * light, (0.3 + 0.1 * (0.2 * x).sin()) * light]
        };
        let bytes = encode_linear(w, h, value);
        let halves = |bytes: &[u8], w, h| match decode(BlockFormat::Bc6h, false, bytes, w, h) {
            Some(Decoded::Halves(halves, 3)) => halves.into_iter().map(f16::to_f32).collect::<Vec<_>>(),
            other => panic!("{other:?}"),
        };
        let decoded = halves(&bytes, w, h);
        let mut squares = 0.0;
        for (i, found) in decoded.chunks_exact(3).enumerate() {
            squares += (0..3).map(|c| f64::from((found[c] / value(i)[c]).ln()).powi(2)).sum::<f64>();
        }
        let error = (squares / decoded.len() as f64).sqrt();
        // A block spans up to three binades; sixteen places between its ends are a seventh of one apart, ±7 %, and
        // evenly spread errors of that have a root mean square of 4 %.
        assert!(error < 0.04, "relative error {error}");
        // One value for all texels: within half of a step of 10 bits.
        for v in [0.0, 1e-3, 0.5, 1.0, 37.5, 65504.0] {
            let found = halves(&encode_linear(4, 4, |_| [v, v / 2.0, v / 4.0]), 4, 4);
            assert!((0..3).all(|c| (found[c] - v / [1.0, 2.0, 4.0][c]).abs() <= 0.02 * v + 1e-5), "{v}: {found:?}");
        }
        let found = halves(&encode_linear(4, 4, |i| [[-1.0, f32::NAN, f32::INFINITY, 1e9][i % 4]; 3]), 4, 4);
        assert!(
            found[..6].iter().all(|v| *v < 1e-3) && found[6..12].iter().all(|v| *v > 6e4 && v.is_finite()),
            "{found:?}"
        );
    }

    /// Single colours are exact in BC4, and in BC7 to one code. In BC1 the best points at a third miss by up to 4/3
    /// with 5 bits and 2/3 with 6, to which the decoder's rounding comes: 2, 1 and 2 codes.
    #[test]
    fn single_colours_are_kept() {
        for v in 0..=255_u8 {
            let rgba: Vec<u8> = (0..16).flat_map(|_| [v, 255 - v, v / 2, 255]).collect();
            assert!(loss(BlockFormat::Bc7, &rgba, 4, 4, 3) <= 1.0, "{v}");
            assert!(loss(BlockFormat::Bc1, &rgba, 4, 4, 3) <= 3.0, "{v}");
            assert_eq!(loss(BlockFormat::Bc4, &rgba, 4, 4, 1), 0.0, "{v}");
        }
    }

    /// The BC1 palette worked out by hand: white and black, and the two thirds between.
    #[test]
    fn a_block_by_hand() {
        let block = [0xff, 0xff, 0x00, 0x00, 0b11_10_01_00, 0, 0, 0];
        let Some(Decoded::Codes(codes, 3)) = decode(BlockFormat::Bc1, false, &block, 4, 1) else { panic!("opaque") };
        assert_eq!(codes, [255, 255, 255, 0, 0, 0, 170, 170, 170, 85, 85, 85]);
        // BC4: 200 and 100, with the indices 0, 1, 2 and 7.
        let bits: u16 = 1 << 3 | 2 << 6 | 7 << 9;
        let bytes = [200, 100, bits as u8, (bits >> 8) as u8, 0, 0, 0, 0];
        let Some(Decoded::Codes(codes, 1)) = decode(BlockFormat::Bc4, false, &bytes, 4, 1) else { panic!("grey") };
        // (6·200 + 100)/7 and (200 + 6·100)/7.
        assert_eq!((codes[0], codes[1]), (200, 100));
        assert!(codes[2].abs_diff(186) <= 1 && codes[3].abs_diff(114) <= 1, "{codes:?}");
    }

    /// M215: where the first colour is not above the second, BC1 has one colour between them and a hole, black where
    /// there is no alpha.
    #[test]
    fn holes_of_bc1() {
        let block = [0x00, 0x00, 0xff, 0xff, 0b11_10_01_00, 0, 0, 0];
        let codes = match decode(BlockFormat::Bc1, false, &block, 4, 1) {
            Some(Decoded::Codes(codes, 4)) => codes,
            _ => panic!("it has alpha"),
        };
        assert_eq!(&codes[..8], [0, 0, 0, 255, 255, 255, 255, 255]);
        assert!(codes[8].abs_diff(127) <= 1 && codes[11] == 255, "{codes:?}");
        assert_eq!(&codes[12..], [0; 4]);
    }

    #[test]
    fn any_bytes_decode() {
        let bytes: Vec<u8> = (0..4096).map(noise).collect();
        for format in [
            BlockFormat::Bc1,
            BlockFormat::Bc2,
            BlockFormat::Bc3,
            BlockFormat::Bc4,
            BlockFormat::Bc5,
            BlockFormat::Bc6h,
            BlockFormat::Bc7,
        ] {
            for signed in [false, true] {
                assert!(decode(format, signed, &bytes, 50, 31).is_some());
            }
            assert_eq!(decode(format, false, &bytes, 1000, 1000), None, "too few bytes");
        }
    }
}
