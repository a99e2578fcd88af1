//! Settings of a render.

use crate::{denoise::Denoiser, look::Look, own};
use pyo3::{exceptions::PyValueError, prelude::*};
use steradian::{ColorMode, CompileOptions, Layer, Quality, SensorNoise, suited_mode};

/// Settings of a render: the keyword arguments of `Scene.render`.
#[pyclass(frozen, module = "steradian")]
pub struct Settings {
    pub quality: Quality,
    pub options: CompileOptions,
    /// Seconds after which to stop.
    pub time: Option<f64>,
    /// True if the picture is to be denoised.
    pub is_denoised: bool,
    /// Viewpoint to which the camera is moved.
    pub look: Option<Look>,
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
        layers = Vec::new(), transparent = false, denoise = None, look_at = None, fov = None, frame = None))]
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
        denoise: Option<&str>,
        look_at: Option<[[f64; 3]; 3]>,
        fov: Option<f64>,
        frame: Option<u32>,
    ) -> PyResult<Self> {
        let known = || Layer::ALL.iter().map(|l| l.name());
        let layer = |name: &String| {
            Layer::named(name).ok_or_else(|| {
                let known = known().collect::<Vec<_>>().join(", ");
                PyValueError::new_err(format!("there is no layer '{name}'; known are {known}"))
            })
        };
        let asked = layers.iter().map(layer).collect::<PyResult<Vec<_>>>()?;
        if frame.is_none() && asked.contains(&Layer::MOTION) {
            let what = "the layer 'motion' tells what has moved since the frame before: it takes frames=";
            return Err(PyValueError::new_err(what));
        }
        let denoiser = denoise.map(Denoiser::named).transpose()?;
        denoiser.map_or(Ok(()), Denoiser::check)?;
        let mut layers: Vec<Layer> = Vec::new();
        let needed = transparent.then_some(Layer::ALPHA).into_iter();
        for layer in asked.into_iter().chain(needed).chain(denoiser.iter().flat_map(|d| d.guides()).copied()) {
            if !layers.contains(&layer) {
                layers.push(layer);
            }
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
            independent: denoiser.is_some(),
        };
        own::registry().request(&quality).map_err(|e| PyValueError::new_err(e.to_string()))?;
        let suited = || quality.integrator.as_deref().and_then(suited_mode).filter(|mode| *mode == ColorMode::Rgb);
        let mode = self::color(color)?.or_else(suited);
        let sensor_noise = SensorNoise::OfFrame(frame.unwrap_or_default());
        let options = CompileOptions { mode, size, crop, camera, spp, sensor_noise, ..own::compiling() };
        let look = look_at.map(|points| Look::new(points, fov)).transpose()?;
        Ok(Self { quality, options, time, is_denoised: denoiser.is_some(), look })
    }
}
