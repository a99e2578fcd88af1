//! Pictures: named planes that are NumPy arrays.

use crate::{
    comparison::Comparison,
    denoise::Denoiser,
    guard, message, metadata,
    mix::{self, Weight},
};
use numpy::{
    IntoPyArray, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2,
    ndarray::{Array2, Array3},
};
use pyo3::{
    exceptions::{PyIOError, PyKeyError, PyValueError},
    prelude::*,
    types::{PyBytes, PyDict},
};
use std::{collections::HashMap, path::PathBuf, sync::Arc};
use steradian::{
    Layer,
    image::{self, FileKind, Limits, WriteOptions, tone::Tone},
};

/// A plane of a picture.
struct Plane {
    name: String,
    array: Py<PyArray2<f32>>,
}

/// A rendered picture: planes of linear values by name, rows from the top.
#[pyclass(frozen, module = "steradian")]
pub struct Image {
    planes: Vec<Plane>,
    /// Without planes: size, metadata, where it lies in the frame.
    rest: image::Image,
    /// Pixels from left to right.
    #[pyo3(get)]
    width: usize,
    /// Pixels from top to bottom.
    #[pyo3(get)]
    height: usize,
    /// Samples per pixel that were taken.
    #[pyo3(get)]
    spp: f64,
    /// Seconds of rendering.
    #[pyo3(get)]
    seconds: f64,
    /// Estimated relative error, if it is known.
    #[pyo3(get)]
    error: Option<f64>,
    /// Why the render ended early, if it did: `interrupt`, `time`, `error` or `progress`.
    #[pyo3(get)]
    stopped: Option<&'static str>,
    /// Files read for the render.
    files: Arc<[PathBuf]>,
}

/// Facts about a render beside its picture.
#[derive(Default)]
pub struct Facts {
    pub spp: f64,
    pub seconds: f64,
    pub error: Option<f64>,
    pub stopped: Option<&'static str>,
    pub files: Arc<[PathBuf]>,
}

impl Facts {
    /// The end of that name.
    pub fn end(name: &str) -> Option<&'static str> {
        ENDS.into_iter().find(|end| *end == name)
    }
}

impl Image {
    /// Gives the planes to NumPy, which keeps their memory.
    pub fn new(py: Python<'_>, picture: image::Image, facts: Facts) -> PyResult<Self> {
        let (width, height) = (picture.width(), picture.height());
        let mut rest = image::Image::new(width, height);
        (rest.metadata, rest.offset, rest.frame) = (picture.metadata.clone(), picture.offset, picture.frame);
        let plane = |channel: image::Channel| {
            let array = Array2::from_shape_vec((height, width), channel.data)
                .map_err(|e| PyValueError::new_err(format!("channel '{}': {e}", channel.name)))?;
            Ok(Plane { name: channel.name, array: array.into_pyarray(py).unbind() })
        };
        let planes = picture.into_channels().into_iter().map(plane).collect::<PyResult<_>>()?;
        let Facts { spp, seconds, error, stopped, files } = facts;
        Ok(Self { planes, rest, width, height, spp, seconds, error, stopped, files })
    }

    fn facts(&self) -> Facts {
        let Self { spp, seconds, error, stopped, .. } = *self;
        Facts { spp, seconds, error, stopped, files: self.files.clone() }
    }

    /// The planes whose names these are.
    fn picture(&self, py: Python<'_>, wanted: impl Fn(&str) -> bool) -> PyResult<image::Image> {
        let mut picture = self.rest.clone();
        for plane in self.planes.iter().filter(|p| wanted(&p.name)) {
            let array = plane.array.bind(py).try_readonly()?;
            let data: Vec<f32> = array.as_array().iter().copied().collect();
            picture.push(plane.name.as_str(), data).map_err(|e| PyValueError::new_err(e.to_string()))?;
        }
        Ok(picture)
    }

    /// The planes of a layer: the channel of that name, or all that are called by it, a dot and something.
    fn of_layer(&self, name: &str) -> Vec<&Plane> {
        let prefix = match Layer::named(name) {
            Some(layer) => layer.prefix(),
            None => name,
        };
        if name.is_empty() {
            return self.planes.iter().filter(|p| matches!(p.name.as_str(), "R" | "G" | "B" | "A")).collect();
        }
        let exact: Vec<&Plane> = self.planes.iter().filter(|p| p.name == prefix).collect();
        if !exact.is_empty() {
            return exact;
        }
        self.planes.iter().filter(|p| p.name.strip_prefix(prefix).is_some_and(|rest| rest.starts_with('.'))).collect()
    }

    fn layer_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = vec![""];
        for plane in &self.planes {
            let layer = plane.name.split('.').next().unwrap_or_default();
            if !matches!(layer, "R" | "G" | "B" | "A") && !names.contains(&layer) {
                names.push(layer);
            }
        }
        names
    }
}

fn write_options(tonemap: Option<&str>, exposure: Option<f32>, half: bool) -> PyResult<WriteOptions> {
    let fault = |e: image::Error| PyValueError::new_err(e.to_string());
    let mut tone = tonemap.map_or(Ok(Tone::default()), Tone::parse).map_err(fault)?;
    if let Some(ev) = exposure {
        tone = tone.with_exposure(ev).map_err(fault)?;
    }
    let exr_precision = if half { image::Precision::Half } else { image::Precision::Float };
    let ppm_radiance = tonemap.is_none() && exposure.is_none();
    Ok(WriteOptions { tone, exr_precision, ppm_radiance, ..WriteOptions::default() })
}

/// Pickled form of a picture: its type, and its planes with the facts beside them.
type Recipe<'py> = (Bound<'py, PyAny>, (Bound<'py, PyDict>, Bound<'py, PyDict>));

/// The names of ends, for pictures that are made anew.
const ENDS: [&str; 4] = ["interrupt", "time", "error", "progress"];

#[pymethods]
impl Image {
    /// A picture of planes by name, of height × width numbers each, which are copied; `about` is what
    /// [`Image::about`] gives.
    #[new]
    #[pyo3(signature = (planes, about = None))]
    fn of_planes(py: Python<'_>, planes: &Bound<'_, PyDict>, about: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut picture: Option<image::Image> = None;
        for (name, plane) in planes {
            let name: String = name.extract()?;
            let plane = py.import("numpy")?.call_method1("ascontiguousarray", (plane, "float32"))?;
            let plane: PyReadonlyArray2<'_, f32> = plane.extract().map_err(|_| {
                let shape = plane.getattr("shape").map_or_else(|e| e.to_string(), |s| s.to_string());
                PyValueError::new_err(format!("plane '{name}' has the shape {shape}, not (height, width)"))
            })?;
            let plane = plane.as_array();
            let (height, width) = plane.dim();
            let whole = picture.get_or_insert_with(|| image::Image::new(width, height));
            if (whole.height(), whole.width()) != (height, width) || height * width == 0 {
                let (h, w) = (whole.height().max(1), whole.width().max(1));
                let found = format!("({height}, {width})");
                return Err(PyValueError::new_err(format!("plane '{name}' has the shape {found}, not ({h}, {w})")));
            }
            let pushed = whole.push(name, plane.iter().copied().collect());
            pushed.map_err(|e| PyValueError::new_err(e.to_string()))?;
        }
        let mut picture = picture.ok_or_else(|| PyValueError::new_err("a picture has one plane at least"))?;
        let Some(about) = about else { return Self::new(py, picture, Facts::default()) };
        let of = |name: &str| about.get_item(name).map(|found| found.filter(|v| !v.is_none()));
        if let Some(all) = of("metadata")? {
            picture.metadata = metadata::from_python(&all.extract()?)?;
        }
        if let Some(offset) = of("offset")? {
            picture.offset = offset.extract()?;
        }
        if let Some(frame) = of("frame")? {
            let (min, max) = frame.extract()?;
            picture.frame = Some(image::Window { min, max });
        }
        let number = |name: &str| of(name)?.map(|v| v.extract::<f64>()).transpose();
        let stopped: Option<String> = of("stopped")?.map(|v| v.extract()).transpose()?;
        let facts = Facts {
            spp: number("spp")?.unwrap_or_default(),
            seconds: number("seconds")?.unwrap_or_default(),
            error: number("error")?,
            stopped: stopped.as_deref().and_then(Facts::end),
            files: Arc::default(),
        };
        Self::new(py, picture, facts)
    }

    /// Facts about the picture beside its planes.
    fn about<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let about = PyDict::new(py);
        about.set_item("spp", self.spp)?;
        about.set_item("seconds", self.seconds)?;
        about.set_item("error", self.error)?;
        about.set_item("stopped", self.stopped)?;
        about.set_item("metadata", self.metadata(py)?)?;
        about.set_item("offset", self.rest.offset)?;
        about.set_item("frame", self.rest.frame.map(|w| (w.min, w.max)))?;
        Ok(about)
    }

    /// Texts and numbers that a file keeps beside the picture, by name; a copy.
    #[getter]
    fn metadata<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        metadata::to_python(py, &self.rest.metadata)
    }

    /// For `pickle` and `copy`.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let planes = PyDict::new(py);
        for plane in &self.planes {
            planes.set_item(&plane.name, &plane.array)?;
        }
        Ok((py.get_type::<Self>().into_any(), (planes, self.about(py)?)))
    }

    /// Names of the planes, such as R, G, B, albedo.R, N.X, Z.
    #[getter]
    fn channels(&self) -> Vec<&str> {
        self.planes.iter().map(|p| p.name.as_str()).collect()
    }

    /// Names of the layers; the picture itself is "".
    #[getter]
    fn layers(&self) -> Vec<&str> {
        self.layer_names()
    }

    /// Height, width, and 3 for the colours of the picture.
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        (self.height, self.width, 3)
    }

    /// A plane by its name, without copying: what is written into it is saved.
    fn __getitem__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyArray2<f32>>> {
        let plane = self.planes.iter().find(|p| p.name == name);
        plane.map(|p| p.array.clone_ref(py)).ok_or_else(|| {
            PyKeyError::new_err(format!("there is no channel '{name}'; there are {}", self.channels().join(", ")))
        })
    }

    /// All planes of a layer, by the name it is rendered with or that of its channels, in one array of height × width ×
    /// channels, a copy.
    #[pyo3(signature = (name = ""))]
    fn layer<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let planes = self.of_layer(name);
        if planes.is_empty() {
            let known = self.layer_names().iter().map(|n| format!("'{n}'")).collect::<Vec<_>>().join(", ");
            return Err(PyKeyError::new_err(format!("there is no layer '{name}'; there are {known}")));
        }
        let mut all = Array3::zeros((self.height, self.width, planes.len()));
        for (c, plane) in planes.iter().enumerate() {
            let array = plane.array.bind(py).try_readonly()?;
            all.slice_mut(numpy::ndarray::s![.., .., c]).assign(&array.as_array());
        }
        Ok(all.into_pyarray(py))
    }

    /// The picture's colours, as NumPy asks for them.
    #[pyo3(signature = (dtype = None, copy = None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if copy == Some(false) {
            return Err(PyValueError::new_err("planes lie one after the other: an array of colours is a copy"));
        }
        let colors: Vec<_> = ["R", "G", "B"].iter().map(|n| self.__getitem__(py, n)).collect::<PyResult<_>>()?;
        let mut all = Array3::zeros((self.height, self.width, 3));
        for (c, plane) in colors.iter().enumerate() {
            all.slice_mut(numpy::ndarray::s![.., .., c]).assign(&plane.bind(py).try_readonly()?.as_array());
        }
        let array = all.into_pyarray(py).into_any();
        match dtype {
            Some(dtype) => array.call_method1("astype", (dtype,)),
            None => Ok(array),
        }
    }

    /// Writes a file, its format by extension; the file appears whole or not at all. Files that were read for the
    /// picture are not written over but with `overwrite`.
    #[pyo3(signature = (path, *, tonemap = None, exposure = None, half = false, overwrite = false))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        tonemap: Option<&str>,
        exposure: Option<f32>,
        half: bool,
        overwrite: bool,
    ) -> PyResult<()> {
        if !overwrite {
            guard::claim(&path, self.files.iter().map(PathBuf::as_path))?;
        }
        let options = write_options(tonemap, exposure, half)?;
        let picture = self.picture(py, |_| true)?;
        py.detach(|| image::write(&path, &picture, &options)).map_err(|e| match e {
            image::Error::Io { .. } => PyIOError::new_err(e.to_string()),
            e => PyValueError::new_err(e.to_string()),
        })
    }

    /// The bytes of a PNG file.
    #[pyo3(signature = (*, tonemap = None, exposure = None))]
    fn png<'py>(&self, py: Python<'py>, tonemap: Option<&str>, exposure: Option<f32>) -> PyResult<Bound<'py, PyBytes>> {
        let options = write_options(tonemap, exposure, false)?;
        let picture = self.picture(py, |name| !name.contains('.') && matches!(name, "R" | "G" | "B" | "A"))?;
        let bytes = py.detach(|| image::encode(FileKind::Png, &picture, &options));
        Ok(PyBytes::new(py, &bytes.map_err(|e| PyValueError::new_err(e.to_string()))?))
    }

    /// Display values of the picture: height × width × 3 numbers from 0 to 255, after exposure and tone curve.
    #[pyo3(signature = (*, tonemap = None, exposure = None))]
    fn to_uint8<'py>(
        &self,
        py: Python<'py>,
        tonemap: Option<&str>,
        exposure: Option<f32>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let options = write_options(tonemap, exposure, false)?;
        let picture = self.picture(py, |name| matches!(name, "R" | "G" | "B"))?;
        let shown = py.detach(|| image::display8(&picture, &options));
        let shown = shown.map_err(|e| PyValueError::new_err(e.to_string()))?;
        let array = Array3::from_shape_vec((self.height, self.width, 3), shown);
        Ok(array.map_err(|e| PyValueError::new_err(e.to_string()))?.into_pyarray(py))
    }

    /// Figures of the picture against a reference; one of another size is resampled by area.
    fn compare<'py>(&self, py: Python<'py>, reference: &Self) -> PyResult<Bound<'py, PyDict>> {
        let wanted = |name: &str| matches!(name, "R" | "G" | "B") || name.starts_with("variance.");
        let (own, other) = (self.picture(py, wanted)?, reference.picture(py, wanted)?);
        let found = py.detach(|| Comparison::of(&own, &other)).map_err(PyValueError::new_err)?;
        if let Some([w, h]) = found.resampled_from {
            let (width, height) = (self.width, self.height);
            message::warn(
                py,
                &format!("the reference has {w} x {h} pixels, and is resampled by area to {width} x {height}"),
            )?;
        }
        found.to_python(py)
    }

    /// The picture without its noise, by `nlm`, `atrous` or `oidn`, guided by the layers that it has. It keeps its
    /// layers, and the noisy picture as the layer `raw`.
    #[pyo3(signature = (method = "nlm", *, half = None, strength = None))]
    fn denoise(&self, py: Python<'_>, method: &str, half: Option<&Self>, strength: Option<f32>) -> PyResult<Self> {
        let denoiser = Denoiser::named(method)?;
        if denoiser != Denoiser::Nlm && (half.is_some() || strength.is_some()) {
            return Err(PyValueError::new_err("half and strength are of the denoiser nlm"));
        }
        let noisy = self.picture(py, |_| true)?;
        let half = half.map(|half| half.picture(py, |_| true)).transpose()?;
        let denoised = py.detach(|| denoiser.picture(&noisy, half.as_ref(), strength.unwrap_or(1.0)));
        let denoised = denoised.map_err(PyValueError::new_err)?;
        if !denoised.missing.is_empty() {
            let missing: Vec<&str> = denoised.missing.iter().map(|layer| layer.name()).collect();
            let what = format!("the layers {} are missing, which would guide better", missing.join(", "));
            message::warn(py, &what)?;
        }
        Self::new(py, denoised.picture, self.facts())
    }

    /// The picture with the lights of groups weighted, by their names; of a render with the layer `light_groups`.
    fn mix(&self, py: Python<'_>, weights: HashMap<String, Weight>) -> PyResult<Self> {
        let weights = weights.into_iter().map(|(name, weight)| (name, weight.rgb())).collect();
        let whole = self.picture(py, |_| true)?;
        let mixed = py.detach(|| mix::mixed(&whole, &weights)).map_err(PyValueError::new_err)?;
        Self::new(py, mixed, self.facts())
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.png(py, None, None)
    }

    fn __repr__(&self) -> String {
        let stopped = self.stopped.map(|s| format!(", stopped by {s}")).unwrap_or_default();
        format!(
            "<steradian.Image {} x {}, {:.4} spp{stopped}: {}>",
            self.width,
            self.height,
            self.spp,
            self.channels().join(" ")
        )
    }
}

/// A picture from a file, as linear planes; every channel of an EXR file is kept.
#[pyfunction]
pub fn read_image(py: Python<'_>, path: PathBuf) -> PyResult<Image> {
    let picture =
        py.detach(|| image::read(&path, &Limits::default())).map_err(|e| PyValueError::new_err(e.to_string()))?;
    Image::new(py, picture, Facts { files: [path].into(), ..Facts::default() })
}
