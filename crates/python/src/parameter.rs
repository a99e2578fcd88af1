//! Parameters of a node: the schema's words, with the value that is set.

use crate::convert::to_python;
use pyo3::prelude::*;
use steradian::{scene::Node, schema};

/// A parameter of a node.
#[pyclass(frozen, get_all, module = "steradian")]
pub struct Parameter {
    /// The node's name.
    node: String,
    /// The parameter's.
    name: String,
    /// Value that is set; None where the default counts.
    value: Option<Py<PyAny>>,
    /// Default value; empty where the schema does not know the parameter.
    default: &'static str,
    /// Type of its values, in words.
    r#type: String,
    /// Unit; empty for pure numbers.
    unit: &'static str,
    /// Least and greatest number, or None.
    range: Option<(f64, f64)>,
    /// Description of the parameter.
    doc: String,
}

#[pymethods]
impl Parameter {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let value = self.value.as_ref().map(|v| v.bind(py).repr().map(|r| r.to_string())).transpose()?;
        let set = value.map_or(format!("default {}", self.default), |v| format!("= {v}"));
        Ok(format!("<steradian.Parameter '{}.{}' {set} ({}): {}>", self.node, self.name, self.r#type, self.doc))
    }
}

/// All that can be set of a node, and what is set that the schema does not know.
pub fn all_of(py: Python<'_>, ids: &[String], node: &Node, id: &str) -> PyResult<Vec<Parameter>> {
    let value = |name: &str| node.get(name).map(|v| to_python(py, v, ids).map(Bound::unbind)).transpose();
    let known: Vec<&schema::Parameter> = node.family.parameters(&node.kind).into_iter().flatten().collect();
    let described = known.iter().map(|p| {
        Ok(Parameter {
            node: id.into(),
            name: p.name.into(),
            value: value(p.name)?,
            default: p.default,
            r#type: p.values(),
            unit: p.unit,
            range: Some(p.range).filter(|r| *r != (f64::NEG_INFINITY, f64::INFINITY)),
            doc: p.meaning(),
        })
    });
    let others = node.params.iter().filter(|set| known.iter().all(|p| p.name != set.name)).map(|set| {
        Ok(Parameter {
            node: id.into(),
            name: set.name.clone(),
            value: value(&set.name)?,
            default: "",
            r#type: String::new(),
            unit: "",
            range: None,
            doc: String::new(),
        })
    });
    described.chain(others).collect()
}
