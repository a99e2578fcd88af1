//! Metadata of a picture beside its planes, in Python's words.

use pyo3::{
    IntoPyObjectExt,
    exceptions::PyValueError,
    prelude::*,
    types::{PyBool, PyDict},
};
use steradian::image::{Metadata, Value};

/// Texts, numbers, and matrices as lists of 16 numbers by rows.
pub fn to_python<'py>(py: Python<'py>, metadata: &Metadata) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (name, value) in &metadata.entries {
        let value = match value {
            Value::Text(v) => v.into_bound_py_any(py)?,
            Value::Float(v) => v.into_bound_py_any(py)?,
            Value::Int(v) => v.into_bound_py_any(py)?,
            Value::Matrix(v) => v.to_vec().into_bound_py_any(py)?,
        };
        all.set_item(name, value)?;
    }
    Ok(all)
}

/// Metadata from a dictionary of these.
pub fn from_python(all: &Bound<'_, PyDict>) -> PyResult<Metadata> {
    let mut metadata = Metadata::default();
    for (name, value) in all {
        let name: String = name.extract()?;
        let found = if value.is_instance_of::<PyBool>() {
            None
        } else if let Ok(v) = value.extract::<i32>() {
            Some(Value::Int(v))
        } else if let Ok(v) = value.extract::<f32>() {
            Some(Value::Float(v))
        } else if let Ok(v) = value.extract::<String>() {
            Some(Value::Text(v))
        } else {
            value.extract::<[f32; 16]>().ok().map(Value::Matrix)
        };
        let wanted = || format!("metadata '{name}' is a text, a number, or a list of 16 numbers");
        metadata.set(name.clone(), found.ok_or_else(|| PyValueError::new_err(wanted()))?);
    }
    Ok(metadata)
}
