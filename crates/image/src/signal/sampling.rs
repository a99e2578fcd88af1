//! Sampling: combs, aliases, and prefilters.

use super::Dft;

/// The frequency at which a wave of frequency `f` appears when it is sampled at a rate (both in cycles per pixel): the
/// nearest to zero of those that differ from `f` by multiples of the rate. What is below half the rate stays.
pub fn alias(f: f64, rate: f64) -> f64 {
    f - rate * (f / rate).round()
}

/// Keeps every `step`-th pixel both ways, times `step²` so that the mean stays, and sets the others to zero: the
/// product with a comb, whose transform repeats that of the picture at multiples of the rate 1/step.
pub fn comb(plane: &[f32], width: usize, step: usize) -> Vec<f32> {
    let gain = (step * step) as f32;
    let kept = |i: usize| (i % width).is_multiple_of(step) && (i / width).is_multiple_of(step);
    plane.iter().enumerate().map(|(i, &v)| if kept(i) { v * gain } else { 0.0 }).collect()
}

/// A filter before sampling at every `step`-th pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prefilter {
    /// None.
    None,
    /// The mean over `step` pixels.
    Box,
    /// A Gaussian whose standard deviation is half of `step`.
    Gaussian,
    /// Ideal low-pass: all below half the rate, nothing above.
    Sinc,
}

impl Prefilter {
    /// The prefilters by name.
    pub const ALL: [(&str, Self); 4] =
        [("none", Self::None), ("box", Self::Box), ("gaussian", Self::Gaussian), ("sinc", Self::Sinc)];

    /// Factor on a wave's amplitude.
    pub fn response(self, [fx, fy]: [f64; 2], step: usize) -> f64 {
        use std::f64::consts::PI;
        let s = step as f64;
        // Of the discrete box: the Dirichlet kernel.
        let mean = |f: f64| if f == 0.0 { 1.0 } else { (PI * f * s).sin() / (s * (PI * f).sin()) };
        match self {
            Self::None => 1.0,
            Self::Box => mean(fx) * mean(fy),
            Self::Gaussian => (-2.0 * (PI * 0.5 * s).powi(2) * (fx * fx + fy * fy)).exp(),
            Self::Sinc => f64::from(u8::from(fx.abs() < 0.5 / s && fy.abs() < 0.5 / s)),
        }
    }
}

/// The picture of a transform after a prefilter.
pub fn prefilter(dft: &Dft, filter: Prefilter, step: usize) -> Vec<f32> {
    dft.filtered(|f| filter.response(f, step)).inverse()
}

/// A wave that a picture holds, and what sampling makes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Its frequency, cycles per pixel, with the first component (or, where that is zero, the second) not negative.
    pub frequency: [f64; 2],
    /// Its amplitude: that of a cosine.
    pub amplitude: f64,
    /// The frequency at which it appears after sampling.
    pub alias: [f64; 2],
    /// True if that differs from its own frequency.
    pub is_aliased: bool,
}

/// The strongest waves of a picture, the mean aside, that are stronger than their neighbours; predicted for sampling at
/// every `step`-th pixel.
pub fn peaks(dft: &Dft, step: usize, most: usize) -> Vec<Peak> {
    let (w, h) = (dft.width, dft.height);
    let amplitudes = dft.amplitudes();
    let at = |x: usize, y: usize| amplitudes[y * w + x];
    let floor = amplitudes.iter().skip(1).fold(0.0, |a: f64, &b| a.max(b)) * 1e-3;
    let mut found = Vec::new();
    for y in 0..h {
        for x in 0..w {
            let f = dft.frequency(y * w + x);
            // One of each pair f, −f; zero is the mean.
            let (mx, my) = ((w - x) % w, (h - y) % h);
            let own_mirror = (mx, my) == (x, y);
            if (x, y) == (0, 0) || (!own_mirror && (f[0] < 0.0 || (f[0] == 0.0 && f[1] < 0.0))) {
                continue;
            }
            // On the edge f = −1/2 both of a pair are negative.
            if !own_mirror && f[0] == -0.5 && f[1] < 0.0 {
                continue;
            }
            let here = at(x, y);
            let neighbours = [(1, 0), (w - 1, 0), (0, 1), (0, h - 1)];
            let strongest = neighbours.into_iter().all(|(dx, dy)| {
                let (nx, ny) = ((x + dx) % w, (y + dy) % h);
                (nx, ny) == (x, y) || (nx, ny) == (0, 0) || here >= at(nx, ny)
            });
            if here > floor && strongest {
                found.push((here * if own_mirror { 1.0 } else { 2.0 }, f));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let rate = 1.0 / step.max(1) as f64;
    let peak = |(amplitude, frequency): (f64, [f64; 2])| {
        let alias = frequency.map(|f| alias(f, rate));
        let is_aliased = (0..2).any(|k| (alias[k] - frequency[k]).abs() > 1e-9);
        Peak { frequency, amplitude, alias, is_aliased }
    };
    found.into_iter().take(most).map(peak).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize, cycles: f64) -> Vec<f32> {
        (0..n).map(|i| 0.5 + 0.25 * (std::f64::consts::TAU * cycles * i as f64 / n as f64).cos() as f32).collect()
    }

    /// M214, E36: a wave above half the rate, not only one above the rate, appears at the frequency that is predicted,
    /// and a prefilter takes it away.
    #[test]
    fn waves_alias_to_the_predicted_frequency() {
        let (n, step) = (120, 4);
        for cycles in [5.0, 14.0, 16.0, 23.0, 29.0, 37.0, 55.0] {
            let plane = wave(n, cycles);
            let dft = Dft::new(&plane, n, 1).unwrap();
            let found = peaks(&dft, step, 4);
            assert_eq!(found.len(), 1);
            assert!((found[0].frequency[0] - cycles / 120.0).abs() < 1e-12);
            assert!((found[0].amplitude - 0.25).abs() < 1e-6);
            assert_eq!(found[0].is_aliased, cycles > 15.0, "half the rate is 15 cycles in 120 pixels");
            // The samples alone, as a picture of their own.
            let samples: Vec<f32> = plane.iter().step_by(step).copied().collect();
            let seen = peaks(&Dft::new(&samples, n / step, 1).unwrap(), 1, 1)[0];
            let predicted = found[0].alias[0].abs() * step as f64;
            assert!((seen.frequency[0].abs() - predicted).abs() < 1e-9, "{cycles}: {seen:?} {predicted}");
            // After the ideal prefilter nothing is left of what would alias.
            let safe = prefilter(&dft, Prefilter::Sinc, step);
            let spread = safe.iter().fold(0.0_f32, |a, v| a.max((v - 0.5).abs()));
            assert_eq!(spread > 1e-3, cycles < 15.0, "{cycles}: {spread}");
        }
    }

    /// The comb's transform is a comb: the product with it repeats the spectrum at multiples of the rate.
    #[test]
    fn combs_repeat_the_spectrum() {
        let (n, step) = (96, 4);
        let plane: Vec<f32> = wave(n, 5.0);
        let before = Dft::new(&plane, n, 1).unwrap();
        // One row: the comb keeps a quarter of it, and gains 16.
        let after = Dft::new(&comb(&plane, n, step), n, 1).unwrap();
        for k in 0..n {
            let replicas: f64 = (0..step).map(|r| before.values[(k + r * n / step) % n].re).sum();
            assert!((after.values[k].re - 4.0 * replicas).abs() < 1e-3, "{k}");
        }
    }

    /// The box's response is that of the mean over pixels.
    #[test]
    fn box_prefilter_is_a_mean() {
        let (n, step) = (60, 5);
        let plane: Vec<f32> = (0..n).map(|i| ((i * i * 7) % 31) as f32).collect();
        let dft = Dft::new(&plane, n, 1).unwrap();
        // An odd width has its centre on a pixel, so that the response is real.
        let seen = prefilter(&dft, Prefilter::Box, step);
        for i in 0..n {
            let mean = (0..step).map(|k| plane[(i + n + k - step / 2) % n]).sum::<f32>() / step as f32;
            assert!((seen[i] - mean).abs() < 1e-3, "{i}");
        }
    }

    #[test]
    fn aliases() {
        assert_eq!(alias(0.2, 0.5), 0.2);
        assert!((alias(0.3, 0.5) + 0.2).abs() < 1e-12);
        assert!((alias(0.45, 0.25) + 0.05).abs() < 1e-12);
    }
}
