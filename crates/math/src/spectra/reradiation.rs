//! Fluorescence: light that is absorbed at one wavelength and leaves at another, by a matrix (Donaldson 1954,
//! "Spectrophotometry of fluorescent pigments").

use super::{LAMBDA_COUNT, LAMBDA_MIN, Wavelengths, curve::interval, parse::number};
use crate::{Error, Spectrum};

/// Bins of wavelengths, each the visible part of the nanometre around a whole one, as in the tables of all spectra.
const BINS: usize = LAMBDA_COUNT;

/// A matrix of reradiation: the radiant exitance per nanometre at a wavelength, of irradiance at another.
#[derive(Clone, Debug)]
pub struct Reradiation {
    /// For each wavelength of light that leaves the sums over those that it comes from; the last is what all bring, of
    /// irradiance of one per nanometre.
    sums: Vec<f32>,
    /// The illuminant by which half of the wavelengths are drawn, where one is set.
    illuminant: Option<Illuminant>,
}

/// Light by which wavelengths are drawn.
#[derive(Clone, Debug)]
struct Illuminant {
    /// By wavelength, in any unit.
    values: Vec<f32>,
    /// As [`Reradiation::sums`], of irradiance like this.
    sums: Vec<f32>,
}

/// The whole wavelength of a bin, nm.
fn whole(bin: usize) -> f32 {
    LAMBDA_MIN + bin as f32
}

/// The width of a bin, nm: half at both ends of the visible range.
fn width(bin: usize) -> f32 {
    let [low, high] = interval(whole(bin));
    high - low
}

impl Reradiation {
    /// Matrix of a function of the integer wavelengths, in nm, that light leaves with and that it comes with, in 1/nm:
    /// means over the nanometres around them.
    pub fn new(matrix: impl Fn(f32, f32) -> f32) -> Self {
        let mut sums = Vec::with_capacity(BINS * BINS);
        for out in 0..BINS {
            let mut sum = 0.0f64;
            sums.extend((0..BINS).map(|from| {
                let value = matrix(whole(out), whole(from));
                sum += if value > 0.0 && value.is_finite() { f64::from(value * width(from)) } else { 0.0 };
                sum as f32
            }));
        }
        Self { sums, illuminant: None }
    }

    /// Matrix of one pigment: the part of photons that it absorbs by wavelength, the number of photons emitted per
    /// absorbed one, and the shape of the emission spectrum (photons per nanometre, in any unit), both spectra as
    /// tables of whole wavelengths. A photon has an energy in proportion to 1/λ.
    pub fn of_pigment(absorbed: impl Fn(f32) -> f32, quantum_yield: f32, emitted: impl Fn(f32) -> f32) -> Self {
        let all: f32 = (0..BINS).map(|bin| emitted(whole(bin)).max(0.0) * width(bin)).sum();
        let factor = if all > 0.0 { quantum_yield / all } else { 0.0 };
        Self::new(|out, from| absorbed(from).clamp(0.0, 1.0) * factor * emitted(out).max(0.0) * (from / out))
    }

    fn row(lambda: f32) -> usize {
        ((lambda - LAMBDA_MIN + 0.5).max(0.0) as usize).min(BINS - 1)
    }

    /// Light emitted at a wavelength for incident light of one per nanometre at all wavelengths.
    pub fn total(&self, out: f32) -> f32 {
        self.sums[Self::row(out) * BINS + BINS - 1]
    }

    /// Draws half of the wavelengths by the row times an illuminant, in any unit: lamps of narrow spectra are found
    /// then.
    pub fn set_illuminant(&mut self, light: impl Fn(f32) -> f32) {
        let values: Vec<f32> = (0..BINS).map(|bin| light(whole(bin))).collect();
        let most = values.iter().copied().fold(0.0, f32::max);
        if !(most > 0.0 && most.is_finite()) {
            return;
        }
        let values: Vec<f32> = values.into_iter().map(|v| if v > 0.0 { v / most } else { 0.0 }).collect();
        let mut sums = Vec::with_capacity(self.sums.len());
        for row in self.sums.chunks_exact(BINS) {
            let (mut before, mut sum) = (0.0f32, 0.0f64);
            sums.extend(row.iter().zip(&values).map(|(until, light)| {
                sum += f64::from(until - before) * f64::from(*light);
                before = *until;
                sum as f32
            }));
        }
        self.illuminant = Some(Illuminant { values, sums });
    }

    /// A wavelength that light comes from which leaves at another, by a number in `[0, 1)`, and what it counts by: what
    /// leaves, over the density of the wavelength.
    pub fn sample(&self, out: f32, u: f32) -> (f32, f32) {
        let (row, total) = (Self::row(out), self.total(out));
        let Some(light) = self.illuminant.as_ref().filter(|l| l.sums[row * BINS + BINS - 1] > 0.0) else {
            return (Self::drawn(&self.sums, row, u), total);
        };
        // Half of them by the matrix alone, so that none counts by more than twice its total.
        let from =
            if u < 0.5 { Self::drawn(&self.sums, row, 2.0 * u) } else { Self::drawn(&light.sums, row, 2.0 * u - 1.0) };
        let by_light = light.values[Self::row(from)] / light.sums[row * BINS + BINS - 1];
        (from, 2.0 / (1.0 / total + by_light))
    }

    /// A wavelength by the sums of a row.
    fn drawn(sums: &[f32], row: usize, u: f32) -> f32 {
        let sums = &sums[row * BINS..][..BINS];
        let target = u * sums[BINS - 1];
        let bin = sums.partition_point(|s| *s <= target).min(BINS - 1);
        let before = if bin > 0 { sums[bin - 1] } else { 0.0 };
        let share = sums[bin] - before;
        let part = if share > 0.0 { ((target - before) / share).clamp(0.0, 1.0) } else { 0.5 };
        // A number just below the upper limit, so that rounding never leaves the bin.
        (interval(whole(bin))[0] + width(bin) * part).min(interval(whole(bin))[1].next_down())
    }

    /// Number of photons emitted per incident photon of a wavelength.
    pub fn photons(&self, from: f32) -> f32 {
        let bin = Self::row(from);
        let of = |out: usize| {
            let row = &self.sums[out * BINS..];
            let value = row[bin] - if bin > 0 { row[bin - 1] } else { 0.0 };
            f64::from(value / width(bin) * width(out) * whole(out) / whole(bin))
        };
        (0..BINS).map(of).sum::<f64>() as f32
    }

    /// Draws for each lane the wavelength that its light comes from, by a number in `[0, 1)`, and what it counts by.
    pub fn shift(&self, lambda: &mut Wavelengths, u: f32) -> Spectrum {
        let mut lane = 0;
        let factors = lambda.lambda.map(|out| {
            let (from, factor) = self.sample(out, (u + 0.25 * lane as f32).fract());
            lambda.lambda[lane] = from;
            lane += 1;
            factor
        });
        Spectrum::new(factors)
    }
}

/// A measured matrix.
#[derive(Clone, Debug)]
pub struct BispectralTable {
    out: Vec<f32>,
    from: Vec<f32>,
    /// By wavelength of light that comes, then by that which leaves.
    values: Vec<f32>,
}

impl BispectralTable {
    /// Reads a table of text: in its first line the wavelengths that light leaves with, in nm, then a line for each
    /// that it comes with, which begins with that; values in 1/nm, separated by white space or commas. `#` starts a
    /// comment.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let mut table = Self { out: Vec::new(), from: Vec::new(), values: Vec::new() };
        for (line, content) in text.lines().enumerate().map(|(i, l)| (i + 1, l)) {
            let fail = |reason: String| Error::SpectrumFile { line, reason };
            let words = content.split('#').next().unwrap_or("").split(|c: char| c.is_whitespace() || c == ',');
            let numbers: Result<Vec<f32>, Error> =
                words.filter(|w| !w.is_empty()).map(|w| number(w).map_err(&fail)).collect();
            let numbers = numbers?;
            let is_rising = |l: &[f32]| l.windows(2).all(|w| w[0] < w[1]);
            match numbers.as_slice() {
                [] => {}
                first if table.out.is_empty() => {
                    if first.len() < 2 || !is_rising(first) {
                        return Err(fail("the first line needs two or more wavelengths that increase".into()));
                    }
                    table.out = numbers;
                }
                [from, values @ ..] => {
                    if values.len() != table.out.len() {
                        let (n, found) = (table.out.len(), values.len());
                        return Err(fail(format!("expected a wavelength and {n} values, found {found} values")));
                    }
                    if table.from.last().is_some_and(|last| last >= from) {
                        return Err(fail(format!("wavelengths must increase, but {from} nm does not")));
                    }
                    if let Some(v) = values.iter().find(|v| **v < 0.0) {
                        return Err(fail(format!("{v} is negative")));
                    }
                    table.from.push(*from);
                    table.values.extend_from_slice(values);
                }
            }
        }
        if table.from.len() < 2 {
            let reason = "expected two or more lines of values after that of wavelengths".into();
            return Err(Error::SpectrumFile { line: text.lines().count(), reason });
        }
        Ok(table)
    }

    /// The mean over the nanometres around two whole wavelengths, exact: light that leaves, light that comes.
    pub fn mean(&self, out: f32, from: f32) -> f32 {
        let (outs, froms) = (pieces(&self.out, out), pieces(&self.from, from));
        // Within a cell of the table the mean is the value in the middle.
        let row = |from: f32| outs.iter().map(|(out, share)| self.eval(*out, from) * share).sum::<f32>();
        froms.iter().map(|(from, share)| row(*from) * share).sum()
    }

    /// The value at two wavelengths, linear between those of the table, zero beyond.
    pub fn eval(&self, out: f32, from: f32) -> f32 {
        let place = |l: &[f32], x: f32| {
            let high = l.partition_point(|v| *v <= x);
            let is_last = high == l.len() && l.last() == Some(&x);
            let high = if is_last { high - 1 } else { high };
            (high > 0 && high < l.len()).then(|| (high - 1, (x - l[high - 1]) / (l[high] - l[high - 1])))
        };
        let (Some((i, s)), Some((j, t))) = (place(&self.out, out), place(&self.from, from)) else { return 0.0 };
        let at = |i: usize, j: usize| self.values[j * self.out.len() + i];
        let row = |j: usize| at(i, j) + s * (at(i + 1, j) - at(i, j));
        row(j) + t * (row(j + 1) - row(j))
    }
}

/// The pieces that wavelengths of a table cut the nanometre around a whole one into: their middles, and their shares
/// of it.
fn pieces(knots: &[f32], around: f32) -> Vec<(f32, f32)> {
    let [low, high] = interval(around);
    let first = knots.partition_point(|k| *k <= low);
    let inner = knots[first..].iter().copied().take_while(|k| *k < high);
    let mut from = low;
    inner
        .chain([high])
        .map(|to| {
            let piece = (0.5 * (from + to), (to - from) / (high - low));
            from = to;
            piece
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pigment() -> Reradiation {
        let absorbed = |l: f32| 0.8 * (-((l - 420.0) / 30.0).powi(2)).exp();
        Reradiation::of_pigment(absorbed, 0.9, |l| (-((l - 520.0) / 25.0).powi(2)).exp())
    }

    /// The pigment absorbs 0.8 of the photons at the middle of its absorption, and nine in ten of these leave again;
    /// their energy is less, by the ratio of wavelengths.
    #[test]
    fn photons_and_energy_are_those_of_the_pigment() {
        let matrix = pigment();
        assert!((matrix.photons(420.0) - 0.72).abs() < 2e-3, "{}", matrix.photons(420.0));
        assert!(matrix.photons(600.0) < 1e-6);
        // Light of one per nanometre: ∫∫ a Q e (λ_i/λ_o), both curves Gaussians: 0.8 · 30 √π photons.
        let energy: f64 = (360..830).map(|l| f64::from(matrix.total(l as f32 + 0.5))).sum();
        let expected = 0.8 * 0.9 * 30.0 * std::f64::consts::PI.sqrt() * (420.0 / 520.0);
        assert!((energy / expected - 1.0).abs() < 0.01, "{energy}, not {expected}");
    }

    /// The mean over samples of light that depends on the wavelength is the row's integral of it, whatever the
    /// illuminant; and that of a narrow lamp which is the illuminant comes in equal parts.
    #[test]
    fn samples_bring_what_the_matrix_does() {
        let mut matrix = pigment();
        brings_what_it_does(&matrix);
        matrix.set_illuminant(|l| 1.0 - (l - 500.0) * 0.001);
        brings_what_it_does(&matrix);
        let lamp = |l: f32| if (403.5..405.5).contains(&l) { 3.0 } else { 0.0 };
        matrix.set_illuminant(lamp);
        brings_what_it_does(&matrix);
        let values: Vec<f64> = (0..4000)
            .map(|k| {
                let (from, factor) = matrix.sample(520.0, (k as f32 + 0.5) / 4000.0);
                f64::from(factor * lamp(from))
            })
            .collect();
        let mean = values.iter().sum::<f64>() / 4000.0;
        let row = 0.8 * 0.9 / (25.0 * std::f64::consts::PI.sqrt());
        let expected = row * (-(15.5f64 / 30.0).powi(2)).exp() * (404.5 / 520.0) * 3.0 * 2.0;
        assert!((mean / expected - 1.0).abs() < 0.01, "{mean}, not {expected}");
        let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 4000.0).sqrt();
        assert!(deviation < 1.1 * mean, "{deviation} of {mean}");
    }

    fn brings_what_it_does(matrix: &Reradiation) {
        let light = |l: f32| 1.0 + 0.01 * (l - 400.0);
        let n = 20_000;
        let sampled: f64 = (0..n)
            .map(|k| {
                let mut lambda = Wavelengths::at([510.0, 520.0, 530.0, 540.0]);
                let factor = matrix.shift(&mut lambda, (k as f32 + 0.5) / n as f32);
                f64::from(factor[1] * light(lambda.lambda[1]))
            })
            .sum::<f64>()
            / f64::from(n);
        let row = 0.8 * 0.9 / (25.0 * std::f64::consts::PI.sqrt());
        let expected: f64 = (3600..8300)
            .map(|l| {
                let l = f64::from(l) * 0.1 + 0.05;
                row * (-((l - 420.0) / 30.0).powi(2)).exp() * (l / 520.0) * f64::from(light(l as f32)) * 0.1
            })
            .sum();
        assert!((sampled / expected - 1.0).abs() < 5e-3, "{sampled}, not {expected}");
    }

    /// A matrix whose wavelengths lie between whole nanometres keeps its integral, and a sharp edge of absorption its
    /// place: of light of 450.2 nm and above nothing is absorbed.
    #[test]
    fn edges_between_whole_nanometres_keep_their_place() {
        let table =
            BispectralTable::parse("599.4 599.5 599.6 599.7\n400 0 0 0 0\n400.1 0 10 10 0\n400.2 0 0 0 0").unwrap();
        let sum: f32 =
            (590..610).map(|out| (395..405).map(|from| table.mean(out as f32, from as f32)).sum::<f32>()).sum();
        // A trapezoid by a triangle: 10 · 0.2 · 0.1.
        assert!((sum / 0.2 - 1.0).abs() < 1e-3, "{sum}");
        let edge = |l: f32| (450.2 - (l - 0.5)).clamp(0.0, 1.0);
        let matrix = Reradiation::of_pigment(edge, 1.0, |l| if (500.0..600.0).contains(&l) { 1.0 } else { 0.0 });
        let n = 2000;
        let below: f64 = (0..n)
            .map(|k| {
                let (from, factor) = matrix.sample(550.0, (k as f32 + 0.5) / n as f32);
                assert!(from < 450.5, "{from}");
                f64::from(factor * if from < 449.5 { 0.0 } else { 1.0 }) / f64::from(n)
            })
            .sum();
        // Of the nanometre around 450 the part 0.7 absorbs, and leaves in a hundred nanometres.
        assert!((below / (0.7 * 0.01 * 450.0 / 550.0) - 1.0).abs() < 0.05, "{below}");
    }

    /// Tables are linear between their lines, and what is wrong in them is told with its line.
    #[test]
    fn tables_are_read() {
        let table = BispectralTable::parse("# nm\n500 600 700\n400, 0.001 0.003 0\n\n420 0.002 0.001 0\n").unwrap();
        for (out, from, expected) in [
            (500.0, 400.0, 0.001),
            (600.0, 410.0, 0.002),
            (550.0, 420.0, 0.0015),
            (499.0, 410.0, 0.0),
            (600.0, 421.0, 0.0),
        ] {
            assert!((table.eval(out, from) - expected).abs() < 1e-7, "{out} {from}: {}", table.eval(out, from));
        }
        for (text, line, what) in [
            ("500 400\n", 1, "increase"),
            ("500 600\n400 1\n", 2, "2 values, found 1"),
            ("500 600\n400 1 1\n400 1 1", 3, "must increase"),
            ("500 600\n400 1 -1\n410 1 1", 2, "negative"),
            ("500 600\n400 1 x\n", 2, "not a number"),
            ("500 600\n400 1 1\n", 2, "two or more lines"),
            ("", 0, "two or more lines"),
        ] {
            let Err(Error::SpectrumFile { line: found, reason }) = BispectralTable::parse(text) else {
                panic!("{text}")
            };
            assert!(found == line && reason.contains(what), "{text:?}: line {found}: {reason}");
        }
    }
}
