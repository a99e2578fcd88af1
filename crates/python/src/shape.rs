//! Meshes and places of a scene's shapes.

use crate::{
    SceneError,
    mesh::{array, from_arrays, matrix},
    scene::Scene,
};
use numpy::PyArray2;
use pyo3::{exceptions::PyAttributeError, prelude::*, types::PyDict};
use steradian::scene::{Attribute, Domain, NodeId, SceneDesc, Shape, Transform};

/// The shapes of a node.
fn shapes_of(desc: &SceneDesc, node: NodeId) -> impl Iterator<Item = &Shape> {
    desc.shapes.iter().chain(desc.groups.iter().flat_map(|g| &g.shapes)).filter(move |s| s.node == node)
}

/// The number of the mesh of a node's shape.
fn mesh_of(desc: &SceneDesc, id: NodeId, node: &str) -> PyResult<usize> {
    shapes_of(desc, id).find_map(|s| s.mesh).filter(|m| *m < desc.meshes.len()).ok_or_else(|| {
        PyAttributeError::new_err(format!("'{node}' is a {}, which has no mesh", desc.node(id).family.noun()))
    })
}

/// The arrays of a shape's mesh, in its own space; those that are empty are not there.
#[pyfunction]
pub fn mesh<'py>(py: Python<'py>, scene: &Scene, node: &str) -> PyResult<Bound<'py, PyDict>> {
    let mesh = scene.look(py, node, |desc, id| Ok(desc.meshes[mesh_of(desc, id, node)?].clone()))?;
    let all = PyDict::new(py);
    let vectors = [("positions", &mesh.positions), ("normals", &mesh.normals), ("tangents", &mesh.tangents)];
    for (name, rows) in vectors.into_iter().filter(|(_, rows)| !rows.is_empty()) {
        all.set_item(name, array(py, rows)?)?;
    }
    if !mesh.uvs.is_empty() {
        all.set_item("uvs", array(py, &mesh.uvs)?)?;
    }
    if !mesh.triangles.is_empty() {
        all.set_item("triangles", array(py, &mesh.triangles)?)?;
    }
    if !mesh.patches.is_empty() {
        all.set_item("patches", array(py, &mesh.patches)?)?;
    }
    let attribute = |a: &Attribute| {
        let domain = if a.domain == Domain::Face { "face" } else { "vertex" };
        let channels = a.channels.max(1);
        let values = matrix(py, (a.data.len() / channels, channels), a.data.clone())?;
        Ok((a.name.clone(), domain, values))
    };
    all.set_item("attributes", mesh.attributes.iter().map(attribute).collect::<PyResult<Vec<_>>>()?)?;
    Ok(all)
}

/// Gives a shape another mesh; so to all shapes that share it.
#[pyfunction]
pub fn set_mesh(py: Python<'_>, scene: &Scene, node: &str, parts: &Bound<'_, PyDict>) -> PyResult<()> {
    let mesh = from_arrays(parts)?;
    mesh.validate().map_err(|e| SceneError::new_err(format!("the mesh of '{node}' is faulty: {e}")))?;
    scene.edit(py, node, |desc, id| {
        let index = mesh_of(desc, id, node)?;
        desc.meshes[index] = mesh.into();
        Ok(())
    })
}

/// Placement of a shape: its transform into the world, or its group, 4 × 4.
#[pyfunction]
pub fn placement<'py>(py: Python<'py>, scene: &Scene, node: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let place = scene.look(py, node, |desc, id| {
        shapes_of(desc, id).next().map(|s| s.world_from_object).ok_or_else(|| not_placed(desc, id, node))
    })?;
    matrix(py, (4, 4), place.matrix.transpose().to_cols_array().to_vec())
}

/// Puts a shape elsewhere.
#[pyfunction]
pub fn set_placement(py: Python<'_>, scene: &Scene, node: &str, rows: [f64; 16]) -> PyResult<()> {
    let place = Transform::from_rows(rows);
    if !place.is_finite() || place.inverse().is_none() {
        return Err(SceneError::new_err(format!("the transform of '{node}' has no inverse")));
    }
    scene.edit(py, node, |desc, id| {
        if shapes_of(desc, id).next().is_none() {
            return Err(not_placed(desc, id, node));
        }
        let shapes = desc.shapes.iter_mut().chain(desc.groups.iter_mut().flat_map(|g| &mut g.shapes));
        shapes.filter(|s| s.node == id).for_each(|s| s.world_from_object = place);
        Ok(())
    })
}

fn not_placed(desc: &SceneDesc, id: NodeId, node: &str) -> PyErr {
    PyAttributeError::new_err(format!("'{node}' is a {}, which is no shape in a place", desc.node(id).family.noun()))
}
