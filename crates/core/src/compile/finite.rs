//! No parameter may hold a NaN or an infinity: readers refuse them in files, this refuses them in scenes made in code.

use super::Compiler;
use steradian_scene::{Param, SpectrumValue, Value};

impl Compiler<'_> {
    /// Reports every parameter of the description with a number that is not finite.
    pub(super) fn check_numbers(&mut self) {
        for node in &self.desc.nodes {
            for p in node.params.iter().filter(|p| !is_finite(p)) {
                let what =
                    format!("parameter '{}' of {} '{}' is not a finite number", p.name, node.family.noun(), node.kind);
                self.error(p.span.or(node.span), what);
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
