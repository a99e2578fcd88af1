//! Report of a finished render: one JSON object for programs, a line for people.

use crate::{diagnostics::Counts, progress};
use serde::Serialize;
use serde_json::Number;
use std::{collections::BTreeMap, path::PathBuf};

/// The summary that `--json` prints. Times are in seconds.
#[derive(Debug, Serialize)]
pub struct Report<'a> {
    /// Version of this layout.
    pub schema: u32,
    /// `Steradian` and its version.
    pub software: &'static str,
    /// The scene as named on the command line.
    pub scene: &'a str,
    /// The integrator by name.
    pub integrator: &'a str,
    /// `rgb` or `spectral`.
    pub color: &'static str,
    /// The sampler's seed.
    pub seed: u64,
    /// Samples per pixel; the mean where pixels differ.
    pub spp: Number,
    /// True if parts of the picture that err more got more samples.
    pub adaptive: bool,
    /// True if photons told where light comes from behind mirrors and glass.
    pub caustics: bool,
    /// Number of paths of pixels near each other that shared what they found: 1 where none did.
    pub sharing: u32,
    /// The estimated relative error of the picture's pixels: the root of the expected relMSE if samples were
    /// independent; null where pixels have fewer than two.
    pub relative_error: Option<f64>,
    /// Why that error is not to be trusted: null where it is.
    pub unreliable: Option<String>,
    /// The measured relative error of means over squares of pixels, by the edge of the squares. Pixels that share paths
    /// err alike, so it may be more than the error of a pixel over the edge.
    pub relative_error_of_means: Option<BTreeMap<u32, f64>>,
    /// The relative error that remains after `--denoise`, by the difference of halves of the samples, which leaves out
    /// lost detail: a lower bound. Null where nothing tells it.
    pub denoised_relative_error: Option<f64>,
    /// The part of the light that the integrator cannot find (caustics of lights without size); null below a hundredth.
    pub missing_light: Option<f64>,
    /// Remarks of the integrator on what it did, as people read them.
    pub notes: Vec<String>,
    /// Pixels of the picture.
    pub width: u32,
    /// Pixels of the picture.
    pub height: u32,
    /// Threads of the render.
    pub threads: usize,
    /// Camera samples taken.
    pub samples: u64,
    /// Rays traced, shadow rays and those of radiosity's solution among them.
    pub rays: u64,
    /// Reading the scene with its meshes and images, and preparing them.
    pub load_seconds: f64,
    /// Building the hierarchy.
    pub build_seconds: f64,
    /// Wall time of rendering, with that of radiosity's solution.
    pub render_seconds: f64,
    /// Time of all processors, rendering alone.
    pub cpu_seconds: f64,
    /// Developing, encoding and writing the pictures.
    pub save_seconds: f64,
    /// Largest resident size of the process; null where the system does not tell.
    pub peak_rss_bytes: Option<u64>,
    /// Samples that were not finite and count as black.
    pub nonfinite_dropped: u64,
    /// Pixels without any sample, when stopped early.
    pub empty_pixels: u64,
    /// Reason of an early end: `time`, `error`, `SIGINT`, `SIGTERM`, or null.
    pub stopped: Option<&'static str>,
    /// The files written.
    pub outputs: &'a [PathBuf],
    /// Number of messages of each kind.
    pub diagnostics: Counts,
}

/// A number without a fraction where it has none.
pub fn number(value: f64) -> Number {
    let whole = (value.fract() == 0.0 && (0.0..9e15).contains(&value)).then(|| Number::from(value as u64));
    whole.or_else(|| Number::from_f64(value)).unwrap_or_else(|| Number::from(0))
}

impl Report<'_> {
    /// The summary for people.
    pub fn line(&self) -> String {
        let seconds = self.render_seconds.max(1e-9);
        let memory = self.peak_rss_bytes.map(|b| format!(", {}", crate::memory::readable(b))).unwrap_or_default();
        format!(
            "{} x {}, {} spp, {}: {:.2} s ({} · {:.2} Mray/s), load {:.2} s, build {:.2} s{memory}",
            self.width,
            self.height,
            // At most three digits after the point.
            number((self.spp.as_f64().unwrap_or(0.0) * 1e3).round() / 1e3),
            self.integrator,
            self.render_seconds,
            progress::rate(self.samples as f64 / seconds),
            self.rays as f64 / seconds * 1e-6,
            self.load_seconds,
            self.build_seconds,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn whole_numbers_stay_whole() {
        assert_eq!(number(16.0).to_string(), "16");
        assert_eq!(number(3.5).to_string(), "3.5");
        assert_eq!(number(0.0).to_string(), "0");
    }
}
