//! Values of parameters as Python has them.

use pyo3::{
    IntoPyObjectExt,
    prelude::*,
    types::{PyDict, PyList},
};
use steradian::scene::{ColorSpace, SpectrumValue, Value};

/// Converts a value to Python: numbers, texts, lists, and dictionaries in the form of Steradian's own language. Nodes
/// are named by `ids`.
pub fn to_python<'py>(py: Python<'py>, value: &Value, ids: &[String]) -> PyResult<Bound<'py, PyAny>> {
    let reference = |id: steradian::scene::NodeId| entry(py, "ref", ids[id.0 as usize].as_str().into_bound_py_any(py)?);
    match value {
        Value::Bool(v) => v.into_bound_py_any(py),
        Value::Int(v) => v.into_bound_py_any(py),
        Value::Float(v) => v.into_bound_py_any(py),
        Value::String(v) => v.into_bound_py_any(py),
        Value::Path(v) => entry(py, "file", v.to_string_lossy().into_bound_py_any(py)?),
        Value::Vec3(v) => v.into_bound_py_any(py),
        Value::Floats(v) if v.len() == 3 => entry(py, "floats", v.into_bound_py_any(py)?),
        Value::Floats(v) => v.into_bound_py_any(py),
        Value::Ints(v) => entry(py, "ints", v.into_bound_py_any(py)?),
        Value::Transform(t) => entry(py, "matrix", t.matrix.transpose().to_cols_array().into_bound_py_any(py)?),
        Value::Spectrum(s) => spectrum(py, s),
        Value::Node(id) => reference(*id),
        Value::Nodes(all) => {
            let list: Vec<_> = all.iter().map(|id| reference(*id)).collect::<PyResult<_>>()?;
            Ok(PyList::new(py, list)?.into_any())
        }
    }
}

/// A dictionary of one entry.
fn entry<'py>(py: Python<'py>, name: &str, value: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let dict = PyDict::new(py);
    dict.set_item(name, value)?;
    Ok(dict.into_any())
}

fn spectrum<'py>(py: Python<'py>, s: &SpectrumValue) -> PyResult<Bound<'py, PyAny>> {
    match s {
        SpectrumValue::Constant(v) => entry(py, "spectrum", v.into_bound_py_any(py)?),
        SpectrumValue::Named(v) => entry(py, "spectrum", v.into_bound_py_any(py)?),
        SpectrumValue::Blackbody(v) => entry(py, "blackbody", v.into_bound_py_any(py)?),
        SpectrumValue::Rgb(v, space) => {
            let dict = entry(py, "rgb", v.into_bound_py_any(py)?)?;
            let name = match space {
                ColorSpace::Srgb => return Ok(dict),
                ColorSpace::DciP3 => "dci-p3",
                ColorSpace::Rec2020 => "rec2020",
                ColorSpace::Aces => "aces",
            };
            dict.set_item("space", name)?;
            Ok(dict)
        }
        SpectrumValue::Sampled { lambdas, values } => {
            let dict = entry(py, "wavelengths", lambdas.into_bound_py_any(py)?)?;
            dict.set_item("values", values.into_bound_py_any(py)?)?;
            Ok(dict)
        }
    }
}
