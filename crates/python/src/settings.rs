//! Settings of a render.

use pyo3::{exceptions::PyValueError, prelude::*};
use steradian::{ColorMode, CompileOptions, Layer, Quality};

/// Settings of a render: the keyword arguments of `Scene.render`.
#[pyclass(frozen, module = "steradian")]
pub struct Settings {
    pub quality: Quality,
    pub options: CompileOptions,
    /// Seconds after which to stop.
    pub time: Option<f64>,
}

/// The color mode of a name; `None` leaves it to the scene.
pub fn color(name: &str) -> PyResult<Option<ColorMode>> {
    match name {
        "auto" => Ok(None),
        "rgb" => Ok(Some(ColorMode::Rgb)),
        "spectral" => Ok(Some(ColorMode::Spectral)),
        other => Err(PyValueError::new_err(format!("there is no color mode '{other}'; known are auto, rgb, spectral"))),
    }
}

#[pymethods]
impl Settings {
    #[new]
    #[pyo3(signature = (*, spp = None, size = None, crop = None, camera = None, integrator = None, sampler = None,
        max_depth = None, seed = None, threads = 0, color = "auto", adaptive = false, error = None, time = None,
        layers = Vec::new(), transparent = false))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        spp: Option<u32>,
        size: Option<(u32, u32)>,
        crop: Option<[u32; 4]>,
        camera: Option<String>,
        integrator: Option<String>,
        sampler: Option<String>,
        max_depth: Option<u32>,
        seed: Option<u64>,
        threads: usize,
        color: &str,
        adaptive: bool,
        error: Option<f64>,
        time: Option<f64>,
        layers: Vec<String>,
        transparent: bool,
    ) -> PyResult<Self> {
        let known = || Layer::ALL.iter().map(|l| l.name());
        let layer = |name: &String| {
            Layer::named(name).ok_or_else(|| {
                let known = known().collect::<Vec<_>>().join(", ");
                PyValueError::new_err(format!("there is no layer '{name}'; known are {known}"))
            })
        };
        let layers = layers.iter().map(layer).collect::<PyResult<Vec<_>>>()?;
        if layers.contains(&Layer::MOTION) {
            let what =
                "the layer 'motion' tells what has moved since the frame before: steradian render --frames writes it";
            return Err(PyValueError::new_err(what));
        }
        if size.is_some_and(|(w, h)| w == 0 || h == 0) {
            return Err(PyValueError::new_err("size is two whole numbers above 0"));
        }
        if [error, time].into_iter().flatten().any(|v| !(v > 0.0 && v < 1e9)) {
            return Err(PyValueError::new_err("error and time are numbers above 0"));
        }
        let endless = spp.is_none() && (error.is_some() || time.is_some());
        let quality = Quality {
            integrator,
            spp: if endless { Some(1 << 20) } else { spp },
            adaptive,
            error,
            seed,
            threads,
            max_depth,
            sampler,
            layers,
            transparent,
            independent: false,
        };
        quality.request().map_err(|e| PyValueError::new_err(e.to_string()))?;
        let options =
            CompileOptions { mode: self::color(color)?, size, crop, camera, spp, ..CompileOptions::default() };
        Ok(Self { quality, options, time })
    }
}
