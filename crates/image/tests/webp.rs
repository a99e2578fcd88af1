//! WebP files that pillow 13 (libwebp) wrote, against what it reads from them again (the PNG files).

use steradian_image::{Encoding, Error, Limits, TexelData, Texels, read_texels_bytes};
use steradian_math::hash::HashRng;

macro_rules! pair {
    ($name:literal) => {
        ($name, include_bytes!(concat!("webp/", $name, ".webp")), include_bytes!(concat!("webp/", $name, ".png")))
    };
}

const PAIRS: [(&str, &[u8], &[u8]); 4] =
    [pair!("lossless-rgb"), pair!("lossless-rgba"), pair!("lossy-rgb"), pair!("lossy-rgba")];

fn read(bytes: &[u8]) -> Result<Texels, Error> {
    read_texels_bytes(bytes, None, &Limits::default())
}

fn codes(texels: &Texels) -> &[u8] {
    let TexelData::U8(codes) = &texels.data else { panic!("8 bits are expected") };
    codes
}

#[test]
fn pictures_are_those_of_the_reference_decoder() {
    for (name, webp, png) in PAIRS {
        let (found, wanted) = (read(webp).unwrap(), read(png).unwrap());
        assert_eq!((found.width, found.height, found.channels), (24, 17, wanted.channels), "{name}");
        assert_eq!(found.encoding, Encoding::Srgb);
        let error = codes(&found).iter().zip(codes(&wanted)).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert_eq!(error, 0, "{name}");
    }
}

#[test]
fn what_is_not_read_is_told() {
    let moving = read(include_bytes!("webp/moving.webp")).unwrap_err().to_string();
    assert_eq!(moving, "unsupported in WebP files: animations");
    // 16384 × 16384 pixels in 90 bytes.
    let mut bomb = PAIRS[0].1.to_vec();
    bomb[21..25].copy_from_slice(&0x0fff_ffffu32.to_le_bytes());
    assert!(matches!(read(&bomb), Err(Error::TooShort { width: 16384, height: 16384, .. })));
    let small = Limits { pixels: 100, ..Limits::default() };
    assert!(matches!(read_texels_bytes(PAIRS[0].1, None, &small), Err(Error::Limit { declared: 408, .. })));
}

#[test]
fn damaged_files_are_refused_or_read() {
    let mut rng = HashRng::new(3);
    let mut below = move |n: usize| (rng.next_u64() % n as u64) as usize;
    for (name, webp, _) in PAIRS {
        for cut in 0..webp.len() {
            assert!(read(&webp[..cut]).is_err(), "{name} of {cut} bytes");
        }
        for _ in 0..2000 {
            let mut bytes = webp.to_vec();
            for _ in 0..=below(4) {
                bytes[below(webp.len())] = below(256) as u8;
            }
            let _ = read(&bytes);
        }
    }
}
