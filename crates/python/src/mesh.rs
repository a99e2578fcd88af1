//! Meshes as arrays.

use numpy::{Element, IntoPyArray, PyArray2, PyReadonlyArray2, ndarray::Array2};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};
use steradian::scene::{Attribute, Domain, Mesh};

/// A mesh from its arrays: those of one row for each vertex, triangle or patch by the language's names, and
/// `attributes` as lists of name, `vertex` or `face`, and array.
pub fn from_arrays(parts: &Bound<'_, PyDict>) -> PyResult<Mesh> {
    let attributes: Vec<(String, String, PyReadonlyArray2<'_, f32>)> = match parts.get_item("attributes")? {
        Some(all) => all.extract()?,
        None => Vec::new(),
    };
    let attribute = |(name, domain, array): (String, String, PyReadonlyArray2<'_, f32>)| Attribute {
        name,
        domain: if domain == "face" { Domain::Face } else { Domain::Vertex },
        channels: array.as_array().ncols(),
        data: array.as_array().iter().copied().collect(),
    };
    Ok(Mesh {
        positions: rows(parts, "positions")?,
        normals: rows(parts, "normals")?,
        uvs: rows(parts, "uvs")?,
        tangents: rows(parts, "tangents")?,
        triangles: rows(parts, "triangles")?.into(),
        patches: rows(parts, "patches")?,
        attributes: attributes.into_iter().map(attribute).collect(),
    })
}

fn rows<T: Element + Copy, const N: usize>(parts: &Bound<'_, PyDict>, name: &str) -> PyResult<Vec<[T; N]>> {
    let Some(array) = parts.get_item(name)? else { return Ok(Vec::new()) };
    let array: PyReadonlyArray2<'_, T> = array.extract()?;
    if array.as_array().ncols() != N {
        return Err(PyValueError::new_err(format!("{name} has {} columns, not {N}", array.as_array().ncols())));
    }
    Ok(array.as_array().rows().into_iter().map(|row| std::array::from_fn(|i| row[i])).collect())
}

/// Rows as an array of N columns.
pub fn array<'py, T: Element + Copy, const N: usize>(
    py: Python<'py>,
    rows: &[[T; N]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    matrix(py, (rows.len(), N), rows.as_flattened().to_vec())
}

/// Numbers by rows as an array.
pub fn matrix<T: Element>(py: Python<'_>, shape: (usize, usize), data: Vec<T>) -> PyResult<Bound<'_, PyArray2<T>>> {
    let array = Array2::from_shape_vec(shape, data).map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(array.into_pyarray(py))
}
