//! Figures of a picture against a reference, in the names of `steradian compare --json`, and in older ones.

use pyo3::{prelude::*, types::PyDict};
use std::path::Path;
use steradian::{
    compare::{Noise, Reference},
    image::{
        self, Image,
        metrics::{self, ZTest},
    },
};

/// Figures of a picture against a reference.
pub struct Comparison {
    /// Width and height of the reference, where it was resampled.
    pub resampled_from: Option<[usize; 2]>,
    figures: metrics::Comparison,
    flip: f64,
    ssim: f64,
    delta_e: metrics::DeltaE,
    z_test: Option<(ZTest, f64)>,
    /// Why there is no z-test, where one of the pictures tells its variance.
    no_z_test: Option<String>,
}

impl Comparison {
    /// Compares pictures, by a z-test too where both have the layer of variance.
    pub fn of(picture: &Image, reference: &Image) -> Result<Self, String> {
        let told = |e: image::Error| e.to_string();
        let fitted = Reference::of(picture, reference).map_err(told)?;
        let noise = Noise::by_layers((Path::new("the picture"), picture), (Path::new("the reference"), &fitted));
        let reference = &*fitted.image;
        let z_test = noise.as_ref().ok().and_then(Option::as_ref).map(|noise| {
            let test = metrics::z_test_with(picture, reference, |i| noise.of_one_sample(i), noise.samples());
            test.map(|test| (test, noise.samples())).map_err(told)
        });
        Ok(Self {
            resampled_from: fitted.resampled_from,
            figures: metrics::compare(picture, reference).map_err(told)?,
            flip: metrics::flip(picture, reference, metrics::DEFAULT_PIXELS_PER_DEGREE).map_err(told)?,
            ssim: metrics::ssim(picture, reference).map_err(told)?,
            delta_e: metrics::delta_e(picture, reference).map_err(told)?,
            z_test: z_test.transpose()?,
            no_z_test: noise.err(),
        })
    }

    pub fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (c, e, all) = (&self.figures, &self.delta_e, PyDict::new(py));
        for (name, value) in [
            ("mse", c.mse),
            ("rmse", c.rmse),
            ("rel_mse", c.rel_mse),
            ("relmse", c.rel_mse),
            ("mape", c.mape),
            ("smape", c.smape),
            ("psnr", c.psnr),
            ("ssim", self.ssim),
            ("flip", self.flip),
            ("delta_e_76", e.cie76),
            ("delta_e_94", e.cie94),
            ("delta_e_2000", e.ciede2000),
            ("delta_e_max", e.max_ciede2000),
            ("max_abs", c.max_abs),
        ] {
            all.set_item(name, value)?;
        }
        for (name, value) in [("mean", c.mean), ("reference_mean", c.reference_mean), ("ratio", c.ratio)] {
            all.set_item(name, value)?;
        }
        all.set_item("non_finite", c.non_finite)?;
        all.set_item("nonfinite", c.non_finite)?;
        all.set_item("resampled_from", self.resampled_from.map(|[w, h]| (w, h)))?;
        let z = self.z_test.as_ref().map(|(test, samples)| {
            let z = PyDict::new(py);
            for (name, value) in
                [("samples", *samples), ("accepted", test.accepted), ("level", test.level), ("min_p", test.min_p)]
            {
                z.set_item(name, value)?;
            }
            z.set_item("passes", test.passes)?;
            Ok::<_, PyErr>(z)
        });
        all.set_item("z_test", z.transpose()?)?;
        all.set_item("no_z_test", self.no_z_test.as_deref())?;
        Ok(all)
    }
}
