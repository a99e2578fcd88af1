//! The preview that stands until the render is nearer to the truth.
//!
//! The pipeline's picture is free of noise and biased, the render's first samples are noisy and right in the mean. Of
//! the render an early state is kept, with and without its noise. The samples that come after it give a second picture
//! B, which errs independently of both candidates: of the preview P, and of the early picture E without its noise. The
//! variance of B cancels in Σ w ((P − B)² − (E − B)²) = Σ w (P − E)(P + E − 2 B), whose mean is the difference of the
//! squared errors. Where it is above zero beyond doubt, the render is shown, which has more samples than E by then.

use crate::frame::{Shown, rgb};

/// Samples per pixel before the first test, and the factor between tests.
const FIRST_TEST: f64 = 1.0;
const TEST_AGAIN: f64 = 2.0;
/// Standard errors by which the render must be better.
const BEYOND_DOUBT: f64 = 2.0;
/// Largest value of B, in those of the candidates: a rare bright sample decides nothing.
const BRIGHTEST: f64 = 16.0;

/// A preview.
pub struct Preview {
    size: [usize; 2],
    /// R, G, B of pixels.
    values: Vec<f32>,
    /// True for a picture by the pipeline; first paths give way to the render's first whole pass.
    stands: bool,
    early: Option<Early>,
}

/// Early state of the render.
struct Early {
    samples: f64,
    /// Samples of pixels, and sums of R, G, B.
    counts: Vec<u32>,
    sums: Vec<[f64; 3]>,
    /// R, G, B without noise.
    clean: Vec<f32>,
}

impl Preview {
    /// A preview; `stands` if it may be better than a render's first samples.
    pub fn new(shown: &Shown, stands: bool) -> Self {
        Self { size: shown.size(), values: rgb(&shown.picture(&[])), stands, early: None }
    }

    /// True if it may be better than a render's first samples.
    pub fn stands(&self) -> bool {
        self.stands
    }

    /// Number of its pixels.
    pub fn pixels(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Samples per pixel of the render at which it is to be tested.
    pub fn next_test(&self) -> f64 {
        self.early.as_ref().map_or(FIRST_TEST, |early| TEST_AGAIN * early.samples)
    }

    /// True if the render without its noise is better. Keeps its state for the next test, if not.
    pub fn is_beaten(&mut self, shown: &Shown) -> bool {
        // A render whose noise cannot be removed, or is to be seen, is shown as it is.
        if !self.stands || shown.denoised.is_none() {
            return true;
        }
        let [w, h] = shown.size();
        let [pw, ph] = self.size;
        if pw * ph == 0 {
            return true;
        }
        if let Some(early) = &self.early
            && early.clean.len() == 3 * w * h
        {
            let at = |k: usize| 3 * ((k / w * ph / h) * pw + k % w * pw / w);
            if early.is_nearer(shown, |k| &self.values[at(k)..at(k) + 3]) {
                return true;
            }
        }
        let pixels = &shown.film.pixels;
        self.early = Some(Early {
            samples: shown.samples,
            counts: pixels.iter().map(|p| p.samples).collect(),
            sums: pixels.iter().map(|p| p.sum).collect(),
            clean: rgb(&shown.picture(&[])),
        });
        false
    }
}

impl Early {
    /// True if this picture is nearer to the truth than the preview, by the samples that came since.
    fn is_nearer<'p>(&self, shown: &Shown, preview: impl Fn(usize) -> &'p [f32]) -> bool {
        let mean = self.clean.iter().map(|v| f64::from(*v).max(0.0)).sum::<f64>() / self.clean.len().max(1) as f64;
        let (mut sum, mut squares) = (0.0, 0.0);
        for (k, pixel) in shown.film.pixels.iter().enumerate() {
            let count = pixel.samples.saturating_sub(self.counts[k]);
            if count == 0 {
                continue;
            }
            let mut gain = 0.0;
            for (c, p) in preview(k).iter().enumerate() {
                let (p, e) = (f64::from(*p), f64::from(self.clean[3 * k + c]));
                let b = (pixel.sum[c] - self.sums[k][c]) / f64::from(count);
                let b = b.clamp(0.0, BRIGHTEST * (p.max(e).max(0.0) + mean));
                let scale = p.max(e).powi(2) + 0.01 * mean * mean;
                gain += if scale > 0.0 { (p - e) * (p + e - 2.0 * b) / scale } else { 0.0 };
            }
            if gain.is_finite() {
                sum += gain;
                squares += gain * gain;
            }
        }
        sum > BEYOND_DOUBT * squares.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{frame::tests::shown, protocol::FrameKind};
    use steradian::film::Pixel;

    const SIZE: [u32; 2] = [32, 24];

    /// Pixels of a grey of 0.5 with noise, by so many samples; the first ones are those of fewer samples.
    fn noisy(samples: u32, seed: u64) -> Vec<Pixel> {
        let pixel = |k: u32| {
            let mut state = seed.wrapping_mul(1_000_003).wrapping_add(u64::from(k)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let mut pixel = Pixel::default();
            for _ in 0..samples {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                let value = if (state >> 40) % 10 == 0 { 5.0 } else { 0.0 };
                pixel.sum = pixel.sum.map(|s| s + value);
                pixel.samples += 1;
            }
            pixel
        };
        (0..SIZE[0] * SIZE[1]).map(pixel).collect()
    }

    /// A grey picture of so many samples, with noise or without.
    fn grey(value: f32, samples: u32, seed: u64) -> Shown {
        let mut shown = shown(FrameKind::Render, SIZE, noisy(samples, seed));
        shown.samples = f64::from(samples);
        let planes = ["R", "G", "B"].map(|name| (name.to_owned(), vec![value; (SIZE[0] * SIZE[1]) as usize]));
        let mut clean = steradian::image::Image::new(SIZE[0] as usize, SIZE[1] as usize);
        for (name, plane) in planes {
            clean.push(name, plane).unwrap();
        }
        shown.denoised = Some(clean);
        shown
    }

    /// The render wins by its error alone, whatever its noise.
    #[test]
    fn the_picture_nearer_to_the_truth_is_shown() {
        for (preview, early, is_better) in
            [(0.3, 0.45, true), (0.8, 0.55, true), (0.45, 0.3, false), (0.52, 0.9, false)]
        {
            for seed in 1..20 {
                let mut standing = Preview::new(&grey(preview, 1, seed), true);
                assert_eq!(standing.next_test(), 1.0);
                assert!(!standing.is_beaten(&grey(early, 1, seed)));
                assert_eq!(standing.next_test(), 2.0);
                assert_eq!(standing.is_beaten(&grey(early, 65, seed)), is_better, "{preview} {early} {seed}");
            }
        }
    }

    #[test]
    fn what_cannot_be_tested_gives_way() {
        assert!(Preview::new(&grey(0.5, 1, 1), false).is_beaten(&grey(0.9, 1, 1)));
        let raw = Shown { denoised: None, ..grey(0.9, 1, 1) };
        assert!(Preview::new(&grey(0.5, 1, 1), true).is_beaten(&raw));
    }
}
