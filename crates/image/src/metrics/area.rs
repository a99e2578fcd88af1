//! Pictures of another size, by areas.

use crate::{Error, Image, Result, RgbPlanes};
use rayon::prelude::*;

/// A reference at `width × height` pixels: each pixel is the mean over its area, where the pixels of the original are
/// rectangles of one colour. The mean over the whole picture stays what it is, but for rounding. Colours are kept, the
/// layer `variance` (as the variance of that mean, for pixels of independent errors), and metadata.
///
/// # Errors
/// [`Error::Invalid`] where a size is zero or the aspect ratios differ: at the size of the smaller one, one side of the
/// other must fit to less than a pixel. [`Error::MissingChannels`] where there is no colour.
pub fn resampled(reference: &Image, width: usize, height: usize) -> Result<Image> {
    let from = [reference.width(), reference.height()];
    if from.contains(&0) || width == 0 || height == 0 {
        return Err(Error::Invalid("the pictures are empty".into()));
    }
    if !has_aspect(from, [width, height]) {
        let [w, h] = from;
        return Err(Error::Invalid(format!(
            "the reference has {w}x{h} pixels, and the picture {width}x{height}: another size is resampled, but not \
             another aspect ratio"
        )));
    }
    let mut image = Image::new(width, height);
    image.metadata = reference.metadata.clone();
    let axes = [Axis::new(from[0], width), Axis::new(from[1], height)];
    let planes = |RgbPlanes { r, g, b }: RgbPlanes<'_>, power: i32| [r, g, b].map(|plane| means(plane, &axes, power));
    for (name, plane) in ["R", "G", "B"].into_iter().zip(planes(reference.require_rgb()?, 1)) {
        image.push(name, plane)?;
    }
    if let Some(variance) = reference.layer_rgb("variance") {
        for (name, plane) in ["variance.R", "variance.G", "variance.B"].into_iter().zip(planes(variance, 2)) {
            image.push(name, plane)?;
        }
    }
    Ok(image)
}

/// True where two sizes are of one shape, but for rounding to whole pixels of the smaller one.
fn has_aspect(a: [usize; 2], b: [usize; 2]) -> bool {
    let area = |[w, h]: [usize; 2]| w as f64 * h as f64;
    let [small, large] = if area(a) < area(b) { [a, b] } else { [b, a] }.map(|size| size.map(|n| n as f64));
    let miss = |this: usize, other: usize| (large[this] * small[other] / large[other] - small[this]).abs();
    miss(0, 1) < 1.0 || miss(1, 0) < 1.0
}

/// Shares of old pixels in new ones along an edge.
struct Axis {
    from: usize,
    /// First old pixel of each new one, and the shares of it and its successors, of sum 1.
    shares: Vec<(usize, Vec<f64>)>,
}

impl Axis {
    /// Overlaps are counted in whole parts, `from · to` of them on the edge: they are exact.
    fn new(from: usize, to: usize) -> Self {
        let share = |k: usize| {
            let (begin, end) = (k * from, (k + 1) * from);
            let (first, last) = (begin / to, end.div_ceil(to));
            let overlap = |i: usize| (end.min((i + 1) * to) - begin.max(i * to)) as f64 / from as f64;
            (first, (first..last).map(overlap).collect())
        };
        Self { from, shares: (0..to).map(share).collect() }
    }
}

/// Sums over the areas of new pixels, weighted by powers of the shares.
fn means(plane: &[f32], [across, down]: &[Axis; 2], power: i32) -> Vec<f32> {
    let weighted = |shares: &[f64], value: &dyn Fn(usize) -> f64| -> f64 {
        // A share of nothing does not bring in what is not finite.
        shares.iter().enumerate().filter(|s| *s.1 > 0.0).map(|(k, s)| s.powi(power) * value(k)).sum()
    };
    let row = |(top, rows): &(usize, Vec<f64>)| -> Vec<f32> {
        let column = |x: usize| weighted(rows, &|k| f64::from(plane[(top + k) * across.from + x]));
        let columns: Vec<f64> = (0..across.from).map(column).collect();
        let pixel = |(left, shares): &(usize, Vec<f64>)| weighted(shares, &|k| columns[left + k]) as f32;
        across.shares.iter().map(pixel).collect()
    };
    down.shares.par_iter().flat_map_iter(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(width: usize, height: usize) -> Image {
        let pixel = |i: usize| [(i * 37 % 101) as f32 / 64.0, (i * 53 % 89) as f32 / 32.0, 0.25];
        Image::from_rgb(width, height, &(0..width * height).map(pixel).collect::<Vec<_>>()).unwrap()
    }

    fn mean(image: &Image, channel: &str) -> f64 {
        let plane = image.channel(channel).unwrap();
        plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64
    }

    #[test]
    fn means_are_kept_by_every_size() {
        let image = pattern(30, 20);
        for (width, height) in [(15, 10), (6, 4), (7, 5), (45, 30), (31, 21), (3, 2), (300, 200)] {
            let other = resampled(&image, width, height).unwrap();
            for channel in ["R", "G", "B"] {
                let (found, expected) = (mean(&other, channel), mean(&image, channel));
                assert!((found - expected).abs() < 1e-7 * expected, "{width} x {height}: {found}, not {expected}");
            }
        }
        assert_eq!(resampled(&image, 30, 20).unwrap().rgb().unwrap().r, image.rgb().unwrap().r);
    }

    #[test]
    fn areas_by_hand() {
        // Three pixels in two: the middle one is shared.
        let mut image = Image::from_rgb(3, 3, &[1.0, 2.0, 4.0].map(|v| [v; 3]).repeat(3)).unwrap();
        image.push_layer("variance", ["R", "G", "B"], &[[9.0; 3]; 9]).unwrap();
        image.push("Z", vec![1.0; 9]).unwrap();
        let half = resampled(&image, 2, 2).unwrap();
        let near = |a: f32, b: f64| assert!((f64::from(a) - b).abs() < 1e-6, "{a}, expected {b}");
        near(half.rgb().unwrap().g[0], (1.0 + 0.5 * 2.0) / 1.5);
        near(half.rgb().unwrap().g[3], (4.0 + 0.5 * 2.0) / 1.5);
        // Shares of 2/3 and 1/3 along both edges: (4/9 + 1/9)² of the variance.
        near(half.layer_rgb("variance").unwrap().r[1], 9.0 * (5.0f64 / 9.0).powi(2));
        assert!(half.channel("Z").is_none());
        // What is not finite stays where it is.
        image.channel_mut("R").unwrap()[0] = f32::NAN;
        let r: Vec<bool> = resampled(&image, 6, 6).unwrap().rgb().unwrap().r.iter().map(|v| v.is_nan()).collect();
        assert_eq!(r.iter().filter(|v| **v).count(), 4);
    }

    #[test]
    fn shapes_must_be_alike() {
        let fits = |w: usize, h: usize, to: [usize; 2]| resampled(&pattern(w, h), to[0], to[1]);
        assert!(fits(1280, 853, [640, 427]).is_ok() && fits(100, 67, [1000, 667]).is_ok());
        for (w, h, to) in
            [(8, 8, [2, 1]), (8, 8, [8, 10]), (64, 48, [64, 47]), (64, 48, [48, 64]), (640, 480, [640, 360])]
        {
            let refused = fits(w, h, to).unwrap_err().to_string();
            assert!(
                refused.contains(&format!("{w}x{h}")) && refused.contains(&format!("{}x{}", to[0], to[1])),
                "{refused}"
            );
        }
        assert!(fits(4, 4, [0, 0]).is_err());
    }
}
