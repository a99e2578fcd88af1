//! Basis Universal in KTX2 files that the reference encoder 1.16 wrote, against what its own unpacker makes of them
//! without loss: UASTC as ASTC, ETC1S as ETC1 (the PNG files).

use steradian_image::{Encoding, Error, Limits, TexelData, Texels, read_texels_bytes};
use steradian_math::hash::HashRng;

macro_rules! pair {
    ($name:literal) => {
        ($name, include_bytes!(concat!("basis/", $name, ".ktx2")), include_bytes!(concat!("basis/", $name, ".png")))
    };
}

const PAIRS: [(&str, &[u8], &[u8]); 5] =
    [pair!("etc1s-rgb"), pair!("etc1s-rgba"), pair!("uastc-rgb"), pair!("uastc-rgba"), pair!("zstd-rgba")];

fn read(bytes: &[u8]) -> Result<Texels, Error> {
    read_texels_bytes(bytes, None, &Limits::default())
}

fn codes(texels: &Texels) -> &[u8] {
    let TexelData::U8(codes) = &texels.data else { panic!("8 bits are expected") };
    codes
}

#[test]
fn pictures_are_those_of_the_reference_decoder() {
    for (name, ktx2, png) in PAIRS {
        let (found, wanted) = (read(ktx2).unwrap(), read(png).unwrap());
        let channels = if name.ends_with('a') { 4 } else { 3 };
        assert_eq!((found.width, found.height, found.channels), (20, 14, channels), "{name}");
        assert_eq!(found.encoding, Encoding::Srgb);
        let texels = codes(&found).chunks(channels).zip(codes(&wanted).chunks(wanted.channels));
        for (k, (a, b)) in texels.enumerate() {
            let seen = wanted.channels.min(channels);
            assert_eq!(a[..seen], b[..seen], "{name} {k}");
            // Alpha fell by 12 from column to column.
            if channels == 4 {
                assert!(a[3].abs_diff((255 - 12 * (k % 20)) as u8) <= 20, "{name} {k}: {}", a[3]);
            }
        }
    }
}

#[test]
fn damaged_files_are_refused_or_read() {
    let mut rng = HashRng::new(5);
    let mut below = move |n: usize| (rng.next_u64() % n as u64) as usize;
    for (name, ktx2, _) in PAIRS {
        for cut in 0..ktx2.len() {
            assert!(read(&ktx2[..cut]).is_err(), "{name} of {cut} bytes");
        }
        for _ in 0..3000 {
            let mut bytes = ktx2.to_vec();
            for _ in 0..=below(4) {
                let among = if below(2) == 0 { 160 } else { ktx2.len() };
                let place = below(among);
                bytes[place] = below(256) as u8;
            }
            let _ = read(&bytes);
        }
    }
}
