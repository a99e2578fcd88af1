//! Noise of charts against means that are known.

use super::{Texel, denoise};
use steradian_math::Vec3;

const SIDE: usize = 48;

/// Means of two charts side by side without any gap: black, and a light that falls off.
fn mean(x: usize, y: usize) -> f32 {
    if x < SIDE / 2 { 0.0 } else { 1.0 + 0.02 * (x + y) as f32 }
}

/// Numbers from −1 to 1 with the variance 1/3 (the mixer of SplitMix64).
fn noise(k: usize) -> f32 {
    let mut bits = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    (bits >> 40) as f32 / (1 << 23) as f32 - 1.0
}

/// The root mean square error of the bright chart falls below a third, its mean stays, and nothing of it reaches the
/// black chart beside it, though their texels touch.
#[test]
fn charts_are_denoised_apart() {
    let texel = |number: usize| {
        let (x, y) = (number % SIDE, number / SIDE);
        let is_bright = x >= SIDE / 2;
        let sigma = if is_bright { 0.5 } else { 0.0 };
        Texel {
            number,
            chart: u32::from(is_bright),
            normal: Vec3::Z,
            parts: vec![[mean(x, y) + sigma * noise(number); 3]],
            variances: vec![[sigma * sigma / 3.0; 3]],
            ..Texel::default()
        }
    };
    let noisy: Vec<Texel> = (0..SIDE * SIDE).map(texel).collect();
    let mut texels = noisy.clone();
    denoise::charts(&mut texels, SIDE).unwrap();
    let measures = |texels: &[Texel]| {
        let bright = texels.iter().filter(|texel| texel.chart == 1);
        let errors = bright.map(|t| f64::from(t.parts[0][0] - mean(t.number % SIDE, t.number / SIDE)));
        let (sum, squares, count) = errors.fold((0.0, 0.0, 0.0), |(s, q, n), e| (s + e, q + e * e, n + 1.0));
        [sum / count, f64::sqrt(squares / count)]
    };
    let ([mean_before, error_before], [mean_after, error_after]) = (measures(&noisy), measures(&texels));
    assert!(error_after < error_before / 3.0, "{error_before} {error_after}");
    assert!((mean_after - mean_before).abs() < 0.02, "{mean_before} {mean_after}");
    assert!(texels.iter().filter(|texel| texel.chart == 0).all(|texel| texel.parts[0] == [0.0; 3]));
    // At the very edge of the chart, too.
    let edge = texels.iter().filter(|t| t.number % SIDE == SIDE / 2);
    let errors: Vec<f32> = edge.map(|t| (t.parts[0][0] - mean(t.number % SIDE, t.number / SIDE)).abs()).collect();
    assert!(errors.iter().sum::<f32>() < 0.15 * errors.len() as f32, "{errors:?}");
}
