//! The colours of a chromaticity diagram. Each place within the spectral locus has the brightest colour of sRGB of its
//! chromaticity; what is outside the gamut of sRGB is mixed with white until it is in, so it has the most saturated
//! colour of its hue.

use crate::laboratory::{Error, Picture, rgb_from_xyz_in_gamut};
use steradian_image::{FileKind, WriteOptions, encode};
use steradian_math::color::xyz::xyz_from_xyy;

/// Dark grey behind the colours (linear; #2b2b2b).
const GROUND: f32 = 0.0242;
/// Lines into which a row of pixels is divided.
const LINES: usize = 4;
/// Width of the picture behind a chart, pixels.
const BACKDROP: usize = 360;

/// A diagram in coordinates that straight lines stay straight in.
pub struct Diagram {
    /// The closed outline of all chromaticities.
    pub outline: Vec<(f64, f64)>,
    /// From 0 to where it is drawn, across and up.
    pub range: [f64; 2],
    /// `(x, y)` of a place.
    pub xy_at: fn((f64, f64)) -> (f64, f64),
}

impl Diagram {
    /// Its picture of a width in pixels, a unit as long on both axes, with a line around it.
    pub fn picture(&self, width: usize, line: [f32; 3]) -> Picture {
        let mut picture = self.colors(width);
        let unit = width as f64 / self.range[0];
        let at = |p: (f64, f64)| (p.0 * unit, (self.range[1] - p.1) * unit);
        let mut cover = vec![0.0_f32; picture.rgb.len()];
        for side in self.outline.windows(2) {
            let (a, b) = (at(side[0]), at(side[1]));
            let steps = (4.0 * (b.0 - a.0).hypot(b.1 - a.1)).ceil() as usize;
            for k in 0..=steps {
                let t = k as f64 / steps.max(1) as f64;
                stamp(&mut cover, [picture.width, picture.height], [a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)]);
            }
        }
        for (c, k) in picture.rgb.iter_mut().zip(cover) {
            *c = std::array::from_fn(|i| c[i] + k * (line[i] - c[i]));
        }
        picture
    }

    /// Its colours as a file of PNG.
    pub fn png(&self) -> Result<Vec<u8>, Error> {
        Ok(encode(FileKind::Png, &self.colors(BACKDROP).to_image()?, &WriteOptions::default())?)
    }

    fn colors(&self, width: usize) -> Picture {
        let height = (width as f64 * self.range[1] / self.range[0]).round() as usize;
        let place = |x: f64, y: f64| (self.range[0] * x / width as f64, self.range[1] * (1.0 - y / height as f64));
        // Where the lines of each row enter and leave the outline, in pixels.
        let crossings: Vec<Vec<f64>> = (0..height * LINES)
            .map(|k| {
                let y = place(0.0, (k as f64 + 0.5) / LINES as f64).1;
                let cut = self.outline.windows(2).filter(|w| (w[0].1 <= y) != (w[1].1 <= y));
                let mut across: Vec<_> = cut
                    .map(|w| w[0].0 + (y - w[0].1) / (w[1].1 - w[0].1) * (w[1].0 - w[0].0))
                    .map(|x| x / self.range[0] * width as f64)
                    .collect();
                across.sort_by(f64::total_cmp);
                across
            })
            .collect();
        Picture::from_fn(width, height, |x, y| {
            let lines = &crossings[y * LINES..(y + 1) * LINES];
            let covered = |s: &[f64]| (s[1].min(x as f64 + 1.0) - s[0].max(x as f64)).max(0.0);
            let share = lines.iter().flat_map(|l| l.chunks_exact(2)).map(covered).sum::<f64>() / LINES as f64;
            let color = self.color(place(x as f64 + 0.5, y as f64 + 0.5));
            color.map(|c| GROUND + share as f32 * (c - GROUND))
        })
    }

    /// The colour of a place.
    fn color(&self, at: (f64, f64)) -> [f32; 3] {
        let (x, y) = (self.xy_at)(at);
        let rgb = rgb_from_xyz_in_gamut(xyz_from_xyy(x, y.max(1e-4), 1.0));
        let most = rgb.iter().copied().fold(1e-6, f32::max);
        rgb.map(|c| c / most)
    }
}

/// Covers the pixels around a point, two across.
fn stamp(cover: &mut [f32], [width, height]: [usize; 2], [px, py]: [f64; 2]) {
    for (dx, dy) in (0..16).map(|k| (k % 4 - 2, k / 4 - 2)) {
        let (x, y) = (px.floor() + f64::from(dx), py.floor() + f64::from(dy));
        if x < 0.0 || y < 0.0 || x >= width as f64 || y >= height as f64 {
            continue;
        }
        let distance = (x + 0.5 - px).hypot(y + 0.5 - py);
        let pixel = &mut cover[y as usize * width + x as usize];
        *pixel = pixel.max((1.5 - distance).clamp(0.0, 1.0) as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within a triangle each place has its chromaticity; at its rim the share that is covered, outside the ground.
    #[test]
    fn places_have_their_colours() {
        let outline = vec![(0.1, 0.1), (0.7, 0.1), (0.1, 0.7), (0.1, 0.1)];
        let diagram = Diagram { outline, range: [0.8, 0.8], xy_at: |p| p };
        let p = diagram.colors(80);
        let at = |x: f64, y: f64| p.rgb[(80.0 - y * 100.0) as usize * 80 + (x * 100.0) as usize];
        // White is D65, (0.3127, 0.3290); the red primary of sRGB is at (0.64, 0.33), outside the triangle here.
        let white = at(0.3127, 0.3290);
        assert!(white.iter().all(|c| (c - 1.0).abs() < 0.1), "{white:?}");
        let [red, green, blue] = at(0.165, 0.075 + 0.03);
        assert!(blue == 1.0 && red < 0.15 && green < 0.15, "{red} {green} {blue}");
        assert_eq!(at(0.75, 0.5), [GROUND; 3]);
        let covered: f64 =
            p.rgb.iter().map(|c| f64::from(c[2].max(c[0]).max(c[1]) - GROUND) / f64::from(1.0 - GROUND)).sum();
        assert!((covered / 1800.0 - 1.0).abs() < 0.01, "the area is that of the triangle: {covered}");
    }
}
