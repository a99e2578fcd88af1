//! The noise of a camera's sensor, added to a finished picture: shot noise, dark current, full well, read noise and the
//! analogue-to-digital converter, as in the linear model of EMVA 1288 (release 4.0, section 2).
//!
//! A value of 1 is where the converter ends, `W = full_well · 100 / iso` electrons: a camera reaches higher ISO by more
//! gain, and then sees fewer electrons at the same value. Of a channel's value `v` at an exposure time `t`
//!
//! ```text
//! n = min(Poisson(v W + dark_current t), full_well) − dark_current t + read_noise N(0, 1)
//! v' = round(n C / W) / C,  C = 2^bits − 1,  |v'| ≤ 1
//! ```
//!
//! so the mean stays where nothing is cut off, and with the gain `K = C/W` in steps per electron the variance in steps
//! is that of the photon transfer curve, `K² read_noise² + K² dark_current t + K μ + 1/12`. The black level is
//! subtracted: dark pixels scatter about zero, and values below it are kept.
//!
//! It departs from a camera in that red, green and blue of Rec.709 are counted, each at every pixel, without a mosaic
//! of filters and without a matrix of colours, and that all pixels are alike.

use crate::{Image, colour};
use rayon::prelude::*;
use steradian_math::{
    hash::{HashRng, combine64},
    photon_noise::{normal, poisson},
};

/// A sensor and how a picture was taken with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Electrons that a pixel holds, above 0.
    pub full_well: f64,
    /// Standard deviation of reading a pixel, electrons.
    pub read_noise: f64,
    /// Electrons per second that come without light.
    pub dark_current: f64,
    /// Bits of the converter, 1 to 24.
    pub bits: u32,
    /// Sensitivity, above 0: at 100 the converter ends where the well is full.
    pub iso: f64,
    /// Exposure time, seconds.
    pub exposure_time: f64,
    /// Chooses among equally likely pictures.
    pub seed: u64,
    /// Number of the picture in a sequence, whose noise is independent.
    pub frame: u32,
}

impl Default for Sensor {
    /// 14 bits, ISO 100, 1 s; without a well, which is always to be given.
    fn default() -> Self {
        Self {
            full_well: 0.0,
            read_noise: 0.0,
            dark_current: 0.0,
            bits: 14,
            iso: 100.0,
            exposure_time: 1.0,
            seed: 0,
            frame: 0,
        }
    }
}

impl Sensor {
    /// Adds the noise to the picture's colour; other layers stay as they are. Noise is a function of the pixel's place
    /// in the whole frame, where `origin` is that of the first pixel: a crop has the noise of its part. Negative values
    /// count as black, infinite ones as white, NaN stays.
    pub fn expose(&self, image: &mut Image, origin: [i32; 2]) {
        let width = image.width().max(1);
        let names: Vec<String> = image.channels().iter().map(|c| c.name.clone()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        // The fourth, or the one after grey, is alpha.
        let colour = colour::channels(&names).unwrap_or_default();
        let colour = colour.iter().take(if colour.len() < 3 { 1 } else { 3 });
        for (channel, &index) in colour.enumerate() {
            let Some(plane) = index.and_then(|index| image.channel_mut(names[index])) else { continue };
            let stream = [u64::from(self.frame), channel as u64].into_iter().fold(self.seed, combine64);
            plane.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
                let row_stream = combine64(stream, (i64::from(origin[1]) + y as i64) as u64);
                for (x, value) in row.iter_mut().enumerate() {
                    let pixel = combine64(row_stream, (i64::from(origin[0]) + x as i64) as u64);
                    *value = self.read(*value, &mut HashRng::new(pixel));
                }
            });
        }
    }

    /// Sensor reading of a pixel of the given value.
    fn read(&self, value: f32, rng: &mut HashRng) -> f32 {
        if value.is_nan() {
            return value;
        }
        let end = self.full_well * 100.0 / self.iso;
        let steps = f64::from((1_u32 << self.bits.clamp(1, 24)) - 1);
        let dark = self.dark_current * self.exposure_time;
        // A well that is certainly full is full, however much more light there is.
        let most = 2.0 * self.full_well + 1000.0;
        let mean = (f64::from(value).max(0.0) * end + dark).min(most);
        let electrons = poisson(mean, rng).min(self.full_well) - dark + self.read_noise * normal(rng);
        ((electrons * steps / end).round().clamp(-steps, steps) / steps) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENSOR: Sensor = Sensor {
        full_well: 2000.0,
        read_noise: 6.0,
        dark_current: 0.0,
        bits: 12,
        iso: 100.0,
        exposure_time: 1.0,
        seed: 5,
        frame: 0,
    };
    const SIDE: usize = 200;

    fn flat(value: f32, sensor: &Sensor) -> Image {
        let mut image = Image::from_rgb(SIDE, SIDE, &[[value; 3]; SIDE * SIDE]).unwrap();
        sensor.expose(&mut image, [0, 0]);
        image
    }

    /// Mean and variance of the readings of an even picture, in steps of the converter.
    fn moments(value: f32, sensor: &Sensor) -> [f64; 2] {
        let image = flat(value, sensor);
        let steps = f64::from((1 << sensor.bits) - 1);
        let values = || ["R", "G", "B"].iter().flat_map(|c| image.channel(c).unwrap()).map(|v| f64::from(*v) * steps);
        let n = (3 * SIDE * SIDE) as f64;
        let mean = values().sum::<f64>() / n;
        [mean, values().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)]
    }

    /// EMVA 1288's photon transfer curve: the variance is a line over the mean, whose slope is the gain in steps per
    /// electron and which begins at the squares of read noise and of dark current's shot noise; it falls at saturation.
    #[test]
    fn the_photon_transfer_curve_is_a_line() {
        let n = (3 * SIDE * SIDE) as f64;
        let hot = Sensor { dark_current: 40.0, exposure_time: 2.0, ..SENSOR };
        for sensor in [SENSOR, Sensor { iso: 800.0, ..SENSOR }, hot] {
            let gain = 4095.0 / (sensor.full_well * 100.0 / sensor.iso);
            let dark = sensor.dark_current * sensor.exposure_time;
            let at_black = gain * gain * (36.0 + dark) + 1.0 / 12.0;
            let levels = [0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
            let curve = levels.map(|v| moments(v, &sensor));
            for (level, [mean, variance]) in levels.into_iter().zip(curve) {
                let expected = at_black + gain * f64::from(level) * 4095.0;
                assert!((mean - f64::from(level) * 4095.0).abs() < 4.0 * (expected / n).sqrt(), "{level}: {mean}");
                // The fourth cumulant of counts is their mean.
                let counts = f64::from(level) * 4095.0 / gain + dark;
                let error = ((2.0 * expected.powi(2) + gain.powi(4) * counts) / n).sqrt();
                assert!((variance - expected).abs() < 4.0 * error, "{level}: {variance} {expected}");
            }
            let average = |k: usize| curve.iter().map(|c| c[k]).sum::<f64>() / levels.len() as f64;
            let (x, y) = (average(0), average(1));
            let slope = curve.iter().map(|c| (c[0] - x) * (c[1] - y)).sum::<f64>()
                / curve.iter().map(|c| (c[0] - x).powi(2)).sum::<f64>();
            assert!((slope / gain - 1.0).abs() < 0.02, "{slope} {gain}");
            assert!((y - slope * x - at_black).abs() < 0.01 * curve[7][1], "{} {at_black}", y - slope * x);
            let [mean, variance] = moments(2.0, &sensor);
            assert!(mean < 4095.1 && variance < 0.5 * curve[7][1], "{mean} {variance}");
        }
    }

    /// At a higher ISO a value is fewer electrons: signal over noise falls as their root.
    #[test]
    fn a_stop_costs_the_root_of_two_in_signal_over_noise() {
        let ideal = Sensor { full_well: 50_000.0, read_noise: 0.0, bits: 16, ..SENSOR };
        let ratio = |iso: f64| moments(0.25, &Sensor { iso, ..ideal }).into_iter().reduce(|m, v| m / v.sqrt()).unwrap();
        for iso in [100.0, 1600.0, 25_600.0] {
            let expected = f64::sqrt(0.25 * 50_000.0 * 100.0 / iso);
            assert!((ratio(iso) / expected - 1.0).abs() < 0.02, "{iso}: {} {expected}", ratio(iso));
        }
    }

    /// The middle of a step of light is read as neighbouring codes only, without noise as the nearest one.
    #[test]
    fn the_converter_has_its_codes() {
        let sensor = Sensor { full_well: 1e9, read_noise: 0.0, bits: 2, ..SENSOR };
        for (value, code) in [(0.0, 0.0), (0.16, 0.0), (0.18, 1.0), (0.49, 1.0), (0.9, 3.0), (5.0, 3.0)] {
            assert!(
                flat(value, &sensor).channels().iter().all(|c| c.data.iter().all(|v| (v * 3.0 - code).abs() < 1e-6))
            );
        }
        // Below ISO 100 the well is full before the converter ends.
        let full = flat(1.0, &Sensor { iso: 50.0, ..sensor });
        assert!(full.channels()[0].data.iter().all(|v| (v * 3.0 - 2.0).abs() < 1e-6));
    }

    #[test]
    fn noise_is_a_function_of_place_seed_and_frame() {
        let pixels: Vec<[f32; 3]> = (0..63 * 40).map(|i| [i as f32 / 2520.0, 0.1, 0.01]).collect();
        let image = Image::from_rgb(63, 40, &pixels).unwrap();
        let exposed = |sensor: Sensor, threads: usize| {
            let mut image = image.clone();
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sensor.expose(&mut image, [0, 0]));
            image
        };
        let whole = exposed(SENSOR, 1);
        assert!([2, 3, 7].iter().all(|threads| exposed(SENSOR, *threads) == whole));
        for other in [Sensor { seed: 6, ..SENSOR }, Sensor { frame: 1, ..SENSOR }] {
            assert_ne!(exposed(other, 1), whole);
        }
        // A crop from column 13, row 7.
        let part: Vec<[f32; 3]> = (0..20 * 10).map(|i| pixels[(7 + i / 20) * 63 + 13 + i % 20]).collect();
        let mut part = Image::from_rgb(20, 10, &part).unwrap();
        SENSOR.expose(&mut part, [13, 7]);
        let (whole, part) = (whole.rgb().unwrap(), part.rgb().unwrap());
        assert!((0..200).all(|i| part.at(i) == whole.at((7 + i / 20) * 63 + 13 + i % 20)));
    }

    #[test]
    fn layers_stay_clean_and_strange_values_do_no_harm() {
        let strange = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 1e38, 0.5];
        let mut image = Image::from_rgb(6, 1, &strange.map(|v| [v; 3])).unwrap();
        for name in ["A", "N.X", "variance.R", "Z"] {
            image.push(name, vec![0.5; 6]).unwrap();
        }
        let quiet = Sensor { read_noise: 0.0, ..SENSOR };
        quiet.expose(&mut image, [i32::MAX, i32::MIN]);
        assert!(["A", "N.X", "variance.R", "Z"].iter().all(|name| image.channel(name).unwrap() == [0.5; 6]));
        let red = image.channel("R").unwrap();
        assert!(red[0].is_nan() && red[1..5] == [1.0, 0.0, 0.0, 1.0] && red[5] != 0.5, "{red:?}");
        let mut grey = Image::new(2, 1);
        grey.push("Y", vec![0.5; 2]).unwrap();
        grey.push("A", vec![0.5; 2]).unwrap();
        quiet.expose(&mut grey, [0, 0]);
        assert!(grey.channel("Y").unwrap() != [0.5; 2] && grey.channel("A").unwrap() == [0.5; 2]);
    }
}
