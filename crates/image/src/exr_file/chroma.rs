//! Luminance/chroma files: subsampled channels brought to full resolution, and `Y`, `RY`, `BY` turned into `R`, `G`,
//! `B`.
//!
//! OpenEXR ("Technical Introduction", luminance/chroma images): RY = (R − Y)/Y, BY = (B − Y)/Y, where Y weighs R, G, B
//! as the file's primaries do. Between stored samples we interpolate linearly; OpenEXR's own library uses a 27-tap
//! filter, which differs by a few percent at coloured edges.

use exr::meta::attribute::Chromaticities;

/// Rec.709 luminance weights.
const REC709: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Fills a plane whose values stand at every `step`-th column and row.
pub(super) fn upsample(plane: &mut [f32], width: usize, step: [usize; 2]) {
    let height = plane.len() / width.max(1);
    for y in (0..height).step_by(step[1]) {
        let row = &mut plane[y * width..][..width];
        let stored: Vec<f32> = row.iter().copied().step_by(step[0]).collect();
        fill(width, step[0], |x, v| row[x] = v, &stored);
    }
    if step[1] > 1 {
        for x in 0..width {
            let stored: Vec<f32> = (0..height).step_by(step[1]).map(|y| plane[y * width + x]).collect();
            fill(height, step[1], |y, v| plane[y * width + x] = v, &stored);
        }
    }
}

/// Sets `size` values from those stored at multiples of `step`; the last one continues to the end.
fn fill(size: usize, step: usize, mut set: impl FnMut(usize, f32), stored: &[f32]) {
    for at in 0..size {
        let (index, rest) = (at / step, at % step);
        let left = stored[index];
        let right = stored.get(index + 1).copied().unwrap_or(left);
        set(at, if rest == 0 { left } else { left + (right - left) * (rest as f32 / step as f32) });
    }
}

/// Turns planes of `Y`, `RY`, `BY` into `R`, `G`, `B` in place.
pub(super) fn to_rgb(y: &mut [f32], ry: &mut [f32], by: &mut [f32], primaries: Option<Chromaticities>) {
    let [wr, wg, wb] = primaries.and_then(luminance_weights).unwrap_or(REC709);
    for ((y, ry), by) in y.iter_mut().zip(ry).zip(by) {
        let (r, b) = ((*ry + 1.0) * *y, (*by + 1.0) * *y);
        let g = (*y - wr * r - wb * b) / wg;
        // The three planes change their meaning: RY becomes R, Y becomes G, BY becomes B.
        (*ry, *y, *by) = (r, g, b);
    }
}

/// The Y row of the matrix from these primaries to XYZ; `None` for primaries that span no gamut.
fn luminance_weights(c: Chromaticities) -> Option<[f32; 3]> {
    super::primaries::to_xyz(c).map(|xyz| xyz.row(1).as_vec3().to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::math::Vec2;

    #[test]
    fn rec709_weights_follow_from_its_primaries() {
        let c = Chromaticities {
            red: Vec2(0.64, 0.33),
            green: Vec2(0.3, 0.6),
            blue: Vec2(0.15, 0.06),
            white: Vec2(0.3127, 0.329),
        };
        let weights = luminance_weights(c).unwrap();
        assert!(weights.iter().zip(REC709).all(|(a, b)| (a - b).abs() < 1e-4), "{weights:?}");
        assert!(luminance_weights(Chromaticities { green: c.red, ..c }).is_none());
    }

    #[test]
    fn chroma_returns_the_colours() {
        let (r, g, b) = (0.8f32, 0.3, 0.1);
        let luma = REC709[0] * r + REC709[1] * g + REC709[2] * b;
        let (mut y, mut ry, mut by) = ([luma], [r / luma - 1.0], [b / luma - 1.0]);
        to_rgb(&mut y, &mut ry, &mut by, None);
        assert!((ry[0] - r).abs() < 1e-6 && (y[0] - g).abs() < 1e-6 && (by[0] - b).abs() < 1e-6);
    }

    #[test]
    fn upsampling_interpolates() {
        let mut plane = vec![0.0, 9.0, 2.0, 9.0, 9.0, 9.0, 9.0, 9.0, 4.0, 9.0, 6.0, 9.0, 9.0, 9.0, 9.0, 9.0];
        upsample(&mut plane, 4, [2, 2]);
        assert_eq!(plane, [0.0, 1.0, 2.0, 2.0, 2.0, 3.0, 4.0, 4.0, 4.0, 5.0, 6.0, 6.0, 4.0, 5.0, 6.0, 6.0]);
    }
}
