//! The figures of one picture against another.

use crate::{failure::Failure, values::METRICS};
use serde::Serialize;
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};
use steradian::{
    compare::{Noise, Reference},
    image::{
        self, Image,
        metrics::{self, Comparison, DeltaE, ZTest},
    },
};

/// The figures of one picture against another.
#[derive(Debug, Serialize)]
pub struct Pair {
    pub picture: PathBuf,
    pub reference: PathBuf,
    pub width: usize,
    pub height: usize,
    /// Width and height of the reference, where it was resampled.
    pub resampled_from: Option<[usize; 2]>,
    mse: f64,
    rmse: f64,
    relmse: f64,
    pub mape: f64,
    smape: f64,
    psnr: f64,
    ssim: f64,
    pub flip: f64,
    delta_e_76: f64,
    delta_e_94: f64,
    delta_e_2000: f64,
    delta_e_max: f64,
    max_abs: f64,
    mean: [f64; 3],
    reference_mean: [f64; 3],
    ratio: [f64; 3],
    pub nonfinite: usize,
    pub z_test: Option<Z>,
    /// Why there is no z-test, where one of the pictures tells its variance.
    pub no_z_test: Option<String>,
}

/// The z-test, with what it was made from.
#[derive(Debug, Serialize)]
pub struct Z {
    samples: f64,
    accepted: f64,
    level: f64,
    min_p: f64,
    pub passes: bool,
}

impl Pair {
    /// Compares pictures, by a z-test too where there is noise to go by.
    ///
    /// # Errors
    /// [`Failure`] naming both pictures.
    pub fn of(
        (path, picture): (&Path, &Image),
        (reference_path, reference): (&Path, &Reference),
        noise: &Result<Option<Noise<'_>>, String>,
    ) -> Result<Self, Failure> {
        let about =
            |e: image::Error| Failure::bad_input(format!("{} and {}: {e}", path.display(), reference_path.display()));
        let resampled_from = reference.resampled_from;
        let reference = &*reference.image;
        let Comparison { mse, rmse, rel_mse, mape, smape, psnr, max_abs, mean, reference_mean, ratio, non_finite } =
            metrics::compare(picture, reference).map_err(about)?;
        let flip = metrics::flip(picture, reference, metrics::DEFAULT_PIXELS_PER_DEGREE).map_err(about)?;
        let ssim = metrics::ssim(picture, reference).map_err(about)?;
        let DeltaE { cie76, cie94, ciede2000, max_ciede2000 } = metrics::delta_e(picture, reference).map_err(about)?;
        let noise = noise.as_ref().map_err(Clone::clone).map(Option::as_ref);
        let z_test = noise.as_ref().ok().copied().flatten().map(|noise| {
            let test = metrics::z_test_with(picture, reference, |i| noise.of_one_sample(i), noise.samples());
            test.map(|test| Z::of(noise.samples(), test)).map_err(about)
        });
        Ok(Self {
            picture: path.into(),
            reference: reference_path.into(),
            width: picture.width(),
            height: picture.height(),
            resampled_from,
            mse,
            rmse,
            relmse: rel_mse,
            mape,
            smape,
            psnr,
            ssim,
            flip,
            delta_e_76: cie76,
            delta_e_94: cie94,
            delta_e_2000: ciede2000,
            delta_e_max: max_ciede2000,
            max_abs,
            mean,
            reference_mean,
            ratio,
            nonfinite: non_finite,
            z_test: z_test.transpose()?,
            no_z_test: noise.err(),
        })
    }

    /// A metric by its name in [`METRICS`](crate::values::METRICS); `None` for the z-test where there was none.
    pub fn metric(&self, name: &str) -> Option<f64> {
        Some(match name {
            "mse" => self.mse,
            "rmse" => self.rmse,
            "relmse" => self.relmse,
            "mape" => self.mape,
            "smape" => self.smape,
            "psnr" => self.psnr,
            "ssim" => self.ssim,
            "ssim_error" => 1.0 - self.ssim,
            "flip" => self.flip,
            "delta_e_76" => self.delta_e_76,
            "delta_e_94" => self.delta_e_94,
            "delta_e_2000" => self.delta_e_2000,
            "delta_e_max" => self.delta_e_max,
            "max_abs" => self.max_abs,
            "mean_ratio_error" => self.mean_ratio_error(),
            _ => 1.0 - self.z_test.as_ref()?.accepted,
        })
    }

    /// Largest |mean / reference mean − 1|; equal means agree, black ones too.
    fn mean_ratio_error(&self) -> f64 {
        let error = |c: usize| if self.mean[c] == self.reference_mean[c] { 0.0 } else { (self.ratio[c] - 1.0).abs() };
        (0..3).map(error).fold(0.0, |a, b| if b.is_nan() { b } else { a.max(b) })
    }

    pub fn text(&self) -> String {
        let three = |v: [f64; 3]| v.map(|x| format!("{x:<12.6}")).join(" ");
        let mut out = String::new();
        let _ = writeln!(
            out,
            "{} against {}, {} x {}",
            self.picture.display(),
            self.reference.display(),
            self.width,
            self.height
        );
        let _ = writeln!(out, "  MSE       {:.6e}", self.mse);
        let _ = writeln!(out, "  RMSE      {:.6e}", self.rmse);
        let _ = writeln!(out, "  relMSE    {:.6e}", self.relmse);
        let _ = writeln!(out, "  MAPE      {:.6e}", self.mape);
        let _ = writeln!(out, "  SMAPE     {:.6e}", self.smape);
        let _ = writeln!(out, "  PSNR      {:.2} dB of the display values", self.psnr);
        let _ = writeln!(out, "  SSIM      {:.6}", self.ssim);
        let _ = writeln!(out, "  FLIP      {:.6}", self.flip);
        let [e76, e94, e00, most] = [self.delta_e_76, self.delta_e_94, self.delta_e_2000, self.delta_e_max];
        let _ = writeln!(out, "  ΔE        {e76:.4} (1976), {e94:.4} (94), {e00:.4} (2000, at most {most:.4})");
        let _ = writeln!(out, "  max |Δ|   {:.6e}", self.max_abs);
        let _ = writeln!(out, "  means     {}", three(self.mean).trim_end());
        let _ = writeln!(out, "  reference {}", three(self.reference_mean).trim_end());
        let _ = writeln!(out, "  ratios    {}", three(self.ratio).trim_end());
        if self.nonfinite > 0 {
            let _ = writeln!(out, "  not finite: {} components, left out of all numbers", self.nonfinite);
        }
        if let Some(z) = &self.z_test {
            let verdict = if z.passes { "passes" } else { "fails" };
            let share = 100.0 * z.accepted;
            let _ = writeln!(
                out,
                "  z-test    {share:.4} % accepted, least p {:.3e}, at {} spp: {verdict}",
                z.min_p, z.samples
            );
        }
        if let Some(why) = &self.no_z_test {
            let _ = writeln!(out, "  z-test    none: {why}");
        }
        out
    }
}

/// Columns of tables: both pictures, their size, and all metrics.
pub fn columns() -> impl Iterator<Item = &'static str> {
    ["picture", "reference", "width", "height", "resampled_from"].into_iter().chain(METRICS.iter().copied())
}

impl Pair {
    /// Cells of [`columns`], with numbers by a function; empty where there is no number.
    pub fn cells(&self, number: impl Fn(f64) -> String) -> Vec<String> {
        let name = |path: &Path| path.display().to_string();
        let resampled = self.resampled_from.map_or(String::new(), |[w, h]| format!("{w}x{h}"));
        let first =
            [name(&self.picture), name(&self.reference), self.width.to_string(), self.height.to_string(), resampled];
        let metrics = METRICS.iter().map(|metric| self.metric(metric).map_or(String::new(), &number));
        first.into_iter().chain(metrics).collect()
    }
}

impl Z {
    fn of(samples: f64, ZTest { accepted, level, min_p, passes }: ZTest) -> Self {
        Self { samples, accepted, level, min_p, passes }
    }
}
