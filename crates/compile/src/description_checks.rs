//! Checks of any description before it is compiled: references lead somewhere, and no parameter is a NaN or an
//! infinity. Readers see to that for files; this does for scenes made in code.

use super::Compiler;
use steradian_scene::{NodeId, Param, Shape, SpectrumValue, Value};

impl Compiler<'_> {
    /// Reports every parameter with a number that is not finite, and everything that refers to a node or a mesh that is
    /// not there.
    pub(super) fn check_soundness(&mut self) {
        let desc = self.desc;
        let count = desc.nodes.len();
        let is_there = |id: &NodeId| (id.0 as usize) < count;
        for node in &desc.nodes {
            for p in &node.params {
                let fault = match &p.value {
                    _ if !is_finite(p) => "is not a finite number",
                    Value::Node(id) if !is_there(id) => "refers to a node that does not exist",
                    Value::Nodes(ids) if !ids.iter().all(is_there) => "refers to a node that does not exist",
                    _ => continue,
                };
                let what = format!("parameter '{}' of {} '{}' {fault}", p.name, node.family.noun(), node.kind);
                self.error(p.span.or(node.span), what);
            }
        }
        let singles = [desc.film, desc.filter, desc.sampler, desc.integrator].into_iter().flatten();
        let roots = desc.lights.iter().chain(&desc.cameras).copied().chain(singles);
        if !roots.into_iter().all(|id| is_there(&id)) {
            self.error(
                None,
                "a light, camera, film, filter, sampler or integrator of the description is a node that does not exist",
            );
        }
        for (i, shape) in desc.shapes.iter().chain(desc.groups.iter().flat_map(|g| &g.shapes)).enumerate() {
            let Shape { node, material, emission, interior, exterior, mesh, .. } = shape;
            let nodes = [Some(*node), *material, *emission, *interior, *exterior];
            if !nodes.iter().flatten().all(is_there) {
                self.error(None, format!("shape {i} of the description refers to a node that does not exist"));
            } else if mesh.is_some_and(|m| m >= desc.meshes.len()) {
                self.error(
                    desc.node(*node).span,
                    format!("shape {i} of the description refers to a mesh that does not exist"),
                );
            }
        }
    }
}

fn is_finite(p: &Param) -> bool {
    let all = |v: &[f64]| v.iter().all(|v| v.is_finite());
    match &p.value {
        // What clamps nothing.
        Value::Float(v) if p.name == "max_component" => *v == f64::INFINITY || v.is_finite(),
        Value::Float(v) => v.is_finite(),
        Value::Vec3(v) => all(v),
        Value::Floats(v) => all(v),
        Value::Transform(t) => t.matrix.is_finite(),
        Value::Spectrum(s) => match s {
            SpectrumValue::Constant(v) | SpectrumValue::Blackbody(v) => v.is_finite(),
            SpectrumValue::Rgb(v, _) => all(v),
            SpectrumValue::Sampled { lambdas, values } => lambdas.iter().chain(values).all(|v| v.is_finite()),
            SpectrumValue::Named(_) => true,
        },
        Value::Bool(_)
        | Value::Int(_)
        | Value::String(_)
        | Value::Path(_)
        | Value::Ints(_)
        | Value::Node(_)
        | Value::Nodes(_) => true,
    }
}
