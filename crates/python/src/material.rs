//! Materials and spectra as functions on arrays.

use crate::{
    batch::{self, matrix},
    faults::{Models, Watch, models},
    message, own,
};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2,
    ndarray::{Array1, ArrayView1, ArrayView2},
};
use pyo3::{
    exceptions::{PyKeyError, PyValueError},
    prelude::*,
};
use std::sync::Arc;
use steradian::{
    ColorMode, CompileOptions, Scene,
    bsdf::{BsdfEval, BsdfSample},
    instruments::{Specimen, TransportMode, laws::laws},
    math::{
        Spectrum, Vec2, Vec3,
        hash::{ONE_MINUS_EPSILON, combine32, unit_f32},
        sobol::shuffled_scrambled_sobol_4d,
        spectra,
    },
    specimen,
};

/// Rows that one thread takes at least.
const ROWS_AT_ONCE: usize = 64;
/// Most samples of an albedo.
const MOST_SAMPLES: u32 = 1 << 24;

/// Directions, weights, densities, relative indices of refraction, and whether lobes are specular.
type Samples<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<bool>>,
);

/// A material under glass. Directions point away from the surface, whose shading normal is +z, and have length one.
#[pyclass(frozen, module = "steradian")]
pub struct Material {
    scene: Arc<Scene>,
    models: Models,
    index: u32,
    wavelengths: Option<[f32; 4]>,
}

impl Material {
    /// A material of a scene by its name.
    pub fn named(scene: Arc<Scene>, models: Models, name: &str) -> PyResult<Self> {
        match scene.material_names().iter().rposition(|n| n == name) {
            Some(index) => Ok(Self { scene, models, index: index as u32, wavelengths: None }),
            None => {
                let known = scene.material_names().join(", ");
                Err(PyKeyError::new_err(format!("there is no material '{name}'; there are {known}")))
            }
        }
    }

    /// A row of lanes for each value.
    fn lanes<'py>(
        &self,
        py: Python<'py>,
        specimen: Specimen<'_>,
        values: impl ExactSizeIterator<Item = Spectrum>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let lanes = if self.scene.mode() == ColorMode::Spectral { 4 } else { 3 };
        matrix(py, (values.len(), lanes), values.flat_map(|v| specimen.lanes(v)).collect())
    }

    /// Something for each of so many rows.
    fn each<T: Send>(&self, py: Python<'_>, rows: usize, of: impl Fn(usize) -> T + Sync + Send) -> PyResult<Vec<T>> {
        let faults = Watch::begin(&self.models);
        let found = batch::each(py, rows, ROWS_AT_ONCE, of);
        faults.fault().map(|()| found)
    }

    fn specimen(&self, uv: [f32; 2]) -> Specimen<'_> {
        let specimen = Specimen::new(&self.scene, self.index).at(Vec2::from(uv));
        match self.wavelengths {
            Some(lambda) => specimen.with_wavelengths(lambda),
            None => specimen,
        }
    }
}

/// Directions of length one, by rows; or zero, which samples have that drew none.
fn directions(name: &str, array: ArrayView2<'_, f32>, or_none: bool) -> PyResult<Vec<Vec3>> {
    if array.ncols() != 3 {
        return Err(PyValueError::new_err(format!("{name} has {} columns, not 3", array.ncols())));
    }
    let all: Vec<Vec3> = array.rows().into_iter().map(|r| Vec3::new(r[0], r[1], r[2])).collect();
    match all.iter().position(|w| !(w.is_normalized() || or_none && *w == Vec3::ZERO)) {
        Some(i) => Err(PyValueError::new_err(format!("row {i} of {name} is not of length one"))),
        None => Ok(all),
    }
}

/// Pairs of directions.
fn pairs(wo: &PyReadonlyArray2<'_, f32>, wi: &PyReadonlyArray2<'_, f32>) -> PyResult<(Vec<Vec3>, Vec<Vec3>)> {
    let (wo, wi) = (directions("wo", wo.as_array(), false)?, directions("wi", wi.as_array(), true)?);
    if wo.len() != wi.len() {
        return Err(PyValueError::new_err(format!("wo has {} rows, wi {}", wo.len(), wi.len())));
    }
    Ok((wo, wi))
}

/// Rows of three numbers in [0, 1], with a fourth that is given or a hash of them; none is one.
fn numbers(array: ArrayView2<'_, f32>) -> PyResult<Vec<[f32; 4]>> {
    if !matches!(array.ncols(), 3 | 4) {
        return Err(PyValueError::new_err(format!("u has {} columns, not 3, or 4 for mixtures", array.ncols())));
    }
    let one = |(row, r): (usize, ArrayView1<'_, f32>)| {
        if !r.iter().all(|v| (0.0..=1.0).contains(v)) {
            return Err(PyValueError::new_err(format!("row {row} of u is not within 0 and 1")));
        }
        let hashed = || unit_f32(r.iter().fold(0, |seed, v| combine32(seed, v.to_bits())));
        let choice = r.get(3).copied().unwrap_or_else(hashed);
        // Single precision rounds numbers below one up to it.
        Ok([r[0], r[1], r[2], choice].map(|v| v.min(ONE_MINUS_EPSILON)))
    };
    array.rows().into_iter().enumerate().map(one).collect()
}

fn column<'py>(py: Python<'py>, values: impl Iterator<Item = f32>) -> Bound<'py, PyArray1<f32>> {
    Array1::from_iter(values).into_pyarray(py)
}

#[pymethods]
impl Material {
    /// A material by kind, with parameters as words of the command line.
    #[staticmethod]
    #[pyo3(signature = (kind, parameters, *, wavelengths = None))]
    fn describe(
        py: Python<'_>,
        kind: &str,
        parameters: Vec<(String, String)>,
        wavelengths: Option<[f32; 4]>,
    ) -> PyResult<Self> {
        let desc = specimen::describe_of(own::registry().kinds(), kind, &parameters).map_err(PyValueError::new_err)?;
        let mode = if wavelengths.is_some() { ColorMode::Spectral } else { ColorMode::Rgb };
        let options = CompileOptions { mode: Some(mode), size: Some((8, 8)), ..own::compiling() };
        let models = models(&desc);
        let faults = Watch::begin(&models);
        let compiled = py.detach(|| steradian::compile(&desc, &options));
        faults.fault()?;
        let Some(scene) = compiled.scene else { return Err(message::error(&compiled.diagnostics)) };
        // The specimen is the first shape.
        let index = scene.geometries()[0].material;
        Ok(Self { scene: Arc::new(scene), models, index, wavelengths })
    }

    /// `f·|cosθ_i|` of pairs of directions, sr⁻¹, and the density of sampling `wi`: N × 3 colours (N × 4
    /// wavelengths), N densities.
    #[pyo3(signature = (wo, wi, *, uv = [0.5, 0.5]))]
    #[expect(clippy::type_complexity, reason = "used once")]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: PyReadonlyArray2<'py, f32>,
        wi: PyReadonlyArray2<'py, f32>,
        uv: [f32; 2],
    ) -> PyResult<(Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<f32>>)> {
        let (wo, wi) = pairs(&wo, &wi)?;
        let specimen = self.specimen(uv);
        let found = self.each(py, wo.len(), |i| match wi[i] {
            Vec3::ZERO => BsdfEval::ZERO,
            wi => specimen.eval(wo[i], wi, TransportMode::Radiance),
        })?;
        let values = self.lanes(py, specimen, found.iter().map(|e| e.value))?;
        Ok((values, column(py, found.iter().map(|e| e.pdf))))
    }

    /// Draws directions by N × 3 numbers in [0, 1]: of the lobe, then two of the direction; a fourth is of the part of
    /// a mixture, by default a hash of the others. Gives directions, weights `f·|cosθ_i|/pdf`, densities (zero where
    /// nothing was drawn), relative indices of refraction, and whether the lobe is specular.
    #[pyo3(signature = (wo, u, *, uv = [0.5, 0.5]))]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        wo: PyReadonlyArray2<'py, f32>,
        u: PyReadonlyArray2<'py, f32>,
        uv: [f32; 2],
    ) -> PyResult<Samples<'py>> {
        let (wo, u) = (directions("wo", wo.as_array(), false)?, numbers(u.as_array())?);
        if wo.len() != u.len() {
            return Err(PyValueError::new_err(format!("wo has {} rows, u {}", wo.len(), u.len())));
        }
        let specimen = self.specimen(uv);
        let found = self.each(py, wo.len(), |i| {
            let [lobe, x, y, choice] = u[i];
            let drawn = specimen.sample(wo[i], choice, lobe, Vec2::new(x, y), TransportMode::Radiance);
            drawn.filter(|s| s.pdf > 0.0)
        })?;
        let of = |value: fn(&BsdfSample) -> f32, none: f32| {
            column(py, found.iter().map(move |s| s.as_ref().map_or(none, value)))
        };
        let wi = found.iter().flat_map(|s| s.map_or([0.0; 3], |s| s.wi.to_array())).collect();
        let weights = found.iter().map(|s| s.map_or(Spectrum::ZERO, |s| s.weight));
        let specular = found.iter().map(|s| s.is_some_and(|s| s.lobe.is_specular()));
        Ok((
            matrix(py, (found.len(), 3), wi)?,
            self.lanes(py, specimen, weights)?,
            of(|s| s.pdf, 0.0),
            of(|s| s.eta, 1.0),
            Array1::from_iter(specular).into_pyarray(py),
        ))
    }

    /// The part of the light from each direction that is scattered, of so many samples: N × 3 (N × 4).
    #[pyo3(signature = (wo, *, samples = 1024, uv = [0.5, 0.5]))]
    fn albedo<'py>(
        &self,
        py: Python<'py>,
        wo: PyReadonlyArray2<'py, f32>,
        samples: u32,
        uv: [f32; 2],
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        if !(1..=MOST_SAMPLES).contains(&samples) {
            let wanted = format!("samples are whole numbers from 1 to {MOST_SAMPLES}, not {samples}");
            return Err(PyValueError::new_err(wanted));
        }
        let wo = directions("wo", wo.as_array(), false)?;
        let specimen = self.specimen(uv);
        let found = self.each(py, wo.len(), |i| {
            let mut sums = [0.0; 4];
            for k in 0..samples {
                let [choice, lobe, x, y] = shuffled_scrambled_sobol_4d(k, 7);
                let drawn = specimen.sample(wo[i], choice, lobe, Vec2::new(x, y), TransportMode::Importance);
                let Some(drawn) = drawn else { continue };
                sums.iter_mut().zip(drawn.weight.to_array()).for_each(|(sum, w)| *sum += f64::from(w));
            }
            Spectrum::new(sums.map(|sum| (sum / f64::from(samples)) as f32))
        })?;
        self.lanes(py, specimen, found.into_iter())
    }

    /// The laws of scattering that `steradian material --laws` tests: law, angle in degrees, or none, found, expected,
    /// p (or none), holds.
    #[pyo3(signature = (*, samples = 20_000, uv = [0.5, 0.5]))]
    #[expect(clippy::type_complexity, reason = "used once")]
    fn laws(
        &self,
        py: Python<'_>,
        samples: u32,
        uv: [f32; 2],
    ) -> PyResult<Vec<(&'static str, Option<f64>, f64, f64, Option<f64>, bool)>> {
        if !(1..=MOST_SAMPLES).contains(&samples) {
            let wanted = format!("samples are whole numbers from 1 to {MOST_SAMPLES}, not {samples}");
            return Err(PyValueError::new_err(wanted));
        }
        batch::refuse_inside("test laws")?;
        let faults = Watch::begin(&self.models);
        let found = py.detach(|| laws(&self.specimen(uv), samples));
        faults.fault()?;
        Ok(found.laws.iter().map(|l| (l.law, l.angle, l.found, l.expected, l.p, l.holds)).collect())
    }

    fn __repr__(&self) -> String {
        format!("<steradian.Material '{}'>", self.scene.material_names()[self.index as usize])
    }
}

/// A spectrum known by name at wavelengths in nm.
#[pyfunction]
pub fn spectrum<'py>(
    py: Python<'py>,
    name: &str,
    wavelengths: PyReadonlyArray1<'py, f32>,
) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let curve = spectra::named(name).ok_or_else(|| {
        PyKeyError::new_err(format!("there is no spectrum '{name}'; they have pbrt's names (metal-Au-eta)"))
    })?;
    let values: Vec<f32> = wavelengths.as_array().iter().map(|l| curve.eval(*l)).collect();
    Ok(values.into_pyarray(py))
}
