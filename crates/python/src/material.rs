//! Materials and spectra as functions on arrays.

use crate::message;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2,
    ndarray::{Array2, ArrayView2},
};
use pyo3::{
    exceptions::{PyKeyError, PyValueError},
    prelude::*,
};
use std::sync::Arc;
use steradian::{
    ColorMode, CompileOptions, Scene,
    instruments::{Specimen, TransportMode},
    math::{Vec2, Vec3, spectra},
    specimen,
};

/// A material under glass. Directions point away from the surface, whose shading normal is +z, and have length one.
#[pyclass(frozen, module = "steradian")]
pub struct Material {
    scene: Arc<Scene>,
    index: u32,
    wavelengths: Option<[f32; 4]>,
}

impl Material {
    /// A material of a scene by its name.
    pub fn named(scene: Arc<Scene>, name: &str) -> PyResult<Self> {
        match scene.material_names().iter().rposition(|n| n == name) {
            Some(index) => Ok(Self { scene, index: index as u32, wavelengths: None }),
            None => {
                let known = scene.material_names().join(", ");
                Err(PyKeyError::new_err(format!("there is no material '{name}'; there are {known}")))
            }
        }
    }

    fn specimen(&self, uv: [f32; 2]) -> Specimen<'_> {
        let specimen = Specimen::new(&self.scene, self.index).at(Vec2::from(uv));
        match self.wavelengths {
            Some(lambda) => specimen.with_wavelengths(lambda),
            None => specimen,
        }
    }
}

/// Directions of length one, by rows.
fn directions(name: &str, array: ArrayView2<'_, f32>) -> PyResult<Vec<Vec3>> {
    if array.ncols() != 3 {
        return Err(PyValueError::new_err(format!("{name} has {} columns, not 3", array.ncols())));
    }
    let all: Vec<Vec3> = array.rows().into_iter().map(|r| Vec3::new(r[0], r[1], r[2])).collect();
    match all.iter().position(|w| !w.is_normalized()) {
        Some(i) => Err(PyValueError::new_err(format!("row {i} of {name} is not of length one"))),
        None => Ok(all),
    }
}

/// Pairs of directions.
fn pairs(wo: &PyReadonlyArray2<'_, f32>, wi: &PyReadonlyArray2<'_, f32>) -> PyResult<(Vec<Vec3>, Vec<Vec3>)> {
    let (wo, wi) = (directions("wo", wo.as_array())?, directions("wi", wi.as_array())?);
    if wo.len() != wi.len() {
        return Err(PyValueError::new_err(format!("wo has {} rows, wi {}", wo.len(), wi.len())));
    }
    Ok((wo, wi))
}

#[pymethods]
impl Material {
    /// A material by kind, with parameters as words of the command line.
    #[staticmethod]
    #[pyo3(signature = (kind, parameters, *, wavelengths = None))]
    fn describe(kind: &str, parameters: Vec<(String, String)>, wavelengths: Option<[f32; 4]>) -> PyResult<Self> {
        let desc = specimen::describe(kind, &parameters).map_err(PyValueError::new_err)?;
        let mode = if wavelengths.is_some() { ColorMode::Spectral } else { ColorMode::Rgb };
        let options = CompileOptions { mode: Some(mode), size: Some((8, 8)), ..CompileOptions::default() };
        let compiled = steradian::compile(&desc, &options);
        let Some(scene) = compiled.scene else { return Err(message::error(&compiled.diagnostics)) };
        // The specimen is the first shape.
        let index = scene.geometries()[0].material;
        Ok(Self { scene: Arc::new(scene), index, wavelengths })
    }

    /// `f·|cosθ_i|` of pairs of directions, sr⁻¹, and the density of sampling `wi`: N × 3 colours (N × 4
    /// wavelengths), N densities.
    #[pyo3(signature = (wo, wi, *, uv = [0.5, 0.5]))]
    #[allow(clippy::type_complexity)]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        wo: PyReadonlyArray2<'py, f32>,
        wi: PyReadonlyArray2<'py, f32>,
        uv: [f32; 2],
    ) -> PyResult<(Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<f32>>)> {
        let (wo, wi) = pairs(&wo, &wi)?;
        let (values, densities) = py.detach(|| {
            let specimen = self.specimen(uv);
            let evaluated = wo.iter().zip(&wi).map(|(wo, wi)| specimen.eval(*wo, *wi, TransportMode::Radiance));
            let (mut values, mut densities) = (Vec::new(), Vec::new());
            for e in evaluated {
                values.extend(specimen.lanes(e.value));
                densities.push(e.pdf);
            }
            (values, densities)
        });
        let lanes = if self.scene.mode() == ColorMode::Spectral { 4 } else { 3 };
        let values = Array2::from_shape_vec((wo.len(), lanes), values);
        let values = values.map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok((values.into_pyarray(py), densities.into_pyarray(py)))
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
