//! Integrators of a Python program's own: a function that gives the radiance along all camera rays of a pass.

use crate::{batch, faults};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods, ndarray::Array1};
use pyo3::{
    exceptions::{PyRuntimeError, PyValueError},
    prelude::*,
};
use std::{
    cell::Cell,
    collections::BTreeMap,
    fmt,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use steradian::{
    Plan, Scene, Session,
    engine::{Asked, Counters, Feature, Method, Pass, Passes, Refusal, Run, Support},
    film::PassFilm,
    math::Vec3,
};

/// Rays of a call at most.
const MOST_RAYS: usize = 1 << 16;

/// A function of a [`Wave`].
struct Function(Py<PyAny>);

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Function")
    }
}

/// The method of a function.
#[derive(Clone, Debug)]
struct Own {
    function: Arc<Function>,
    name: &'static str,
}

thread_local! {
    /// True while this thread calls the function of an integrator.
    static INSIDE: Cell<bool> = const { Cell::new(false) };
}

/// A call of the function of an integrator.
struct Inside;

impl Inside {
    fn begin() -> Self {
        INSIDE.set(true);
        Self
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        INSIDE.set(false);
    }
}

/// Refuses renders by functions in functions, which might call themselves without end.
pub fn refuse_inside(method: &str) -> PyResult<()> {
    match INSIDE.get() && functions().contains_key(method) {
        true => Err(PyRuntimeError::new_err(format!("integrators of a program cannot render with '{method}'"))),
        false => Ok(()),
    }
}

/// Functions by the names of their integrators.
static FUNCTIONS: Mutex<BTreeMap<&str, Arc<Function>>> = Mutex::new(BTreeMap::new());

fn functions() -> MutexGuard<'static, BTreeMap<&'static str, Arc<Function>>> {
    FUNCTIONS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps the function of an integrator, in place of an earlier one of the name.
pub fn keep(name: &'static str, function: Py<PyAny>) {
    functions().insert(name, Arc::new(Function(function)));
}

/// The method of a request by its name.
pub fn make(asked: &Asked<'_>) -> Result<Arc<dyn Method>, Refusal> {
    let name = asked.options.name();
    let function = functions().get_key_value(name).map(|(name, function)| (*name, Arc::clone(function)));
    match function {
        Some((name, function)) => Ok(Arc::new(Own { function, name })),
        None => Err(Refusal(format!("the integrator '{name}' is no more"))),
    }
}

impl Method for Own {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::LightGroups | Feature::Bounces | Feature::Bands => Support::Refuses("functions give one colour"),
            Feature::Transparency | Feature::TransparencyBehindMedia => Support::Refuses("functions give no opacity"),
            Feature::Adaptivity => Support::Refuses("functions are called for whole pictures"),
            _ => Support::Exact,
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Passes::new(scene, self.clone(), plan)))
    }
}

impl Pass for Own {
    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let crop = run.scene.film().crop;
        let mut counters = Counters::default();
        let all: Vec<[u32; 2]> = (crop.y0..crop.y1).flat_map(|y| (crop.x0..crop.x1).map(move |x| [x, y])).collect();
        for pixels in all.chunks(MOST_RAYS) {
            if run.is_cancelled() || faults::is_over(self.name) {
                return None;
            }
            let colors = Python::attach(|py| {
                let _inside = Inside::begin();
                let colors = self.radiance(py, run, number, pixels);
                colors.map_err(|why| faults::raise(py, self.name, &why)).ok()
            })?;
            for ([x, y], rgb) in pixels.iter().zip(colors) {
                let weight = run.camera_sample(*x, *y, number).weight;
                counters.samples += 1;
                counters.rays += 1;
                match rgb.is_finite() {
                    true => film.add(*x, *y, rgb * weight),
                    false => counters.nonfinite += 1,
                }
            }
        }
        Some(counters)
    }
}

impl Own {
    /// Linear Rec.709 radiance along the camera rays of pixels.
    fn radiance(&self, py: Python<'_>, run: &Run<'_>, number: u32, pixels: &[[u32; 2]]) -> PyResult<Vec<Vec3>> {
        let n = pixels.len();
        let wave = Wave::new(py, run, number, pixels)?;
        let result = self.function.0.bind(py).call1((wave,))?;
        let array = batch::numbers(&result, "the integrator")?;
        if array.shape() != [n, 3] && array.shape() != [n] {
            let what = format!("the integrator gave an array of shape {:?}, where ({n}, 3) is needed", array.shape());
            return Err(PyValueError::new_err(what));
        }
        let data = array.to_vec()?;
        Ok(match data.len() == n {
            true => data.into_iter().map(Vec3::splat).collect(),
            false => data.chunks_exact(3).map(Vec3::from_slice).collect(),
        })
    }
}

/// Camera rays that an integrator of Python is called with.
#[pyclass(frozen, module = "steradian")]
pub struct Wave {
    /// Origins, (n, 3).
    #[pyo3(get)]
    origins: Py<PyArray2<f32>>,
    /// Unit directions, (n, 3).
    #[pyo3(get)]
    directions: Py<PyArray2<f32>>,
    /// Moments of the exposure in [0, 1), (n,).
    #[pyo3(get)]
    times: Py<PyArray1<f32>>,
    /// Number of the sample of each pixel, from zero.
    #[pyo3(get)]
    sample: u32,
    samplers: Vec<steradian::core::sampler::PixelSampler>,
}

impl Wave {
    fn new(py: Python<'_>, run: &Run<'_>, number: u32, pixels: &[[u32; 2]]) -> PyResult<Self> {
        let n = pixels.len();
        let (mut origins, mut directions) = (Vec::with_capacity(3 * n), Vec::with_capacity(3 * n));
        let (mut times, mut samplers) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for [x, y] in pixels {
            let sample = run.camera_sample(*x, *y, number);
            // In the coordinates of the file, which rays of scenes have, too.
            origins.extend(run.scene.to_file(sample.ray.origin).as_vec3().to_array());
            directions.extend(sample.ray.direction.to_array());
            times.push(sample.ray.time);
            samplers.push(sample.sampler);
        }
        Ok(Self {
            origins: batch::matrix(py, (n, 3), origins)?.unbind(),
            directions: batch::matrix(py, (n, 3), directions)?.unbind(),
            times: Array1::from_vec(times).into_pyarray(py).unbind(),
            sample: number,
            samplers,
        })
    }
}

#[pymethods]
impl Wave {
    /// Random numbers in [0, 1), (n, count), of a purpose: the same purpose gives the same numbers, and numbers of
    /// different purposes are independent. They are stratified over the samples of a pixel.
    #[pyo3(signature = (purpose, count = 2))]
    fn random<'py>(&self, py: Python<'py>, purpose: u32, count: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
        if !(1..=2).contains(&count) || purpose >= 1000 {
            return Err(PyValueError::new_err(
                "random(purpose, count) has a purpose below 1000, and a count of 1 or 2",
            ));
        }
        // After the dimensions of the film.
        let dimension = steradian::engine::dimension::at(purpose, steradian::engine::dimension::DIRECTION);
        let numbers = self.samplers.iter().flat_map(|sampler| match count {
            1 => vec![sampler.get_1d(dimension)],
            _ => sampler.get_2d(dimension).to_array().to_vec(),
        });
        batch::matrix(py, (self.samplers.len(), count), numbers.collect())
    }

    fn __len__(&self) -> usize {
        self.samplers.len()
    }

    fn __repr__(&self) -> String {
        format!("<steradian.Wave: {} camera rays of sample {}>", self.samplers.len(), self.sample)
    }
}
