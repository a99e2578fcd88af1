//! The colours of viridis, by N. Smith and S. van der Walt (2015), whose data are in the public domain (CC0): even in
//! lightness, and so for the eyes of most who see colours differently.

/// Every fifth of its 256 colours, sRGB.
const COLORS: [u32; 52] = [
    0x440154, 0x46085c, 0x471063, 0x481769, 0x481d6f, 0x482475, 0x472a7a, 0x46307e, 0x453781, 0x433d84, 0x414287,
    0x3f4889, 0x3d4e8a, 0x3a538b, 0x38598c, 0x355e8d, 0x33638d, 0x31688e, 0x2e6d8e, 0x2c718e, 0x2a768e, 0x297b8e,
    0x27808e, 0x25848e, 0x23898e, 0x218e8d, 0x20928c, 0x1f978b, 0x1e9c89, 0x1fa188, 0x21a585, 0x24aa83, 0x28ae80,
    0x2eb37c, 0x35b779, 0x3dbc74, 0x46c06f, 0x50c46a, 0x5ac864, 0x65cb5e, 0x70cf57, 0x7cd250, 0x89d548, 0x95d840,
    0xa2da37, 0xb0dd2f, 0xbddf26, 0xcae11f, 0xd8e219, 0xe5e419, 0xf1e51d, 0xfde725,
];

/// The colour at `t` in [0, 1], sRGB, interpolated between its neighbours.
pub(super) fn color(t: f64) -> [u8; 3] {
    let x = t.clamp(0.0, 1.0) * (COLORS.len() - 1) as f64;
    let i = (x as usize).min(COLORS.len() - 2);
    let (from, to) = (COLORS[i].to_be_bytes(), COLORS[i + 1].to_be_bytes());
    let mix = |c: usize| f64::from(from[c]) + (x - i as f64) * (f64::from(to[c]) - f64::from(from[c]));
    [1, 2, 3].map(|c| mix(c).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoding::srgb_decode;
    use steradian_math::{
        DVec3,
        color::{lab::lab_from_xyz, space::REC709},
    };

    /// Colours between those above, by the published table.
    #[test]
    fn it_is_viridis() {
        for (index, published) in [
            (0, [0.267004, 0.004874, 0.329415]),
            (3, [0.271305, 0.019942, 0.347269]),
            (64, [0.229739, 0.322361, 0.545706]),
            (127, [0.128729, 0.563265, 0.551229]),
            (201, [0.449368, 0.813768, 0.335384]),
            (252, [0.964894, 0.902323, 0.123941]),
            (255, [0.993248, 0.906157, 0.143936]),
        ] {
            let found = color(f64::from(index) / 255.0);
            let near = found.iter().zip(published).all(|(&f, p): (&u8, f64)| (f64::from(f) - 255.0 * p).abs() < 1.5);
            assert!(near, "{index}: {found:?}");
        }
    }

    /// CIE lightness rises from 15 to 91 along a line, within 2.
    #[test]
    fn lightness_is_even() {
        for step in 0..=100 {
            let t = f64::from(step) / 100.0;
            let rgb = DVec3::from(color(t).map(|v| f64::from(srgb_decode(f32::from(v) / 255.0))));
            let lightness = lab_from_xyz(REC709.xyz_from_rgb() * rgb, REC709.white()).x;
            assert!((lightness - (14.9 + 76.0 * t)).abs() < 2.0, "{t}: {lightness}");
        }
    }
}
