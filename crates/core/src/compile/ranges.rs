//! Constant values of materials are held in the ranges that the catalogue of materials states, and reported where they were not.

use super::Compiler;
use crate::material::catalog::{self, Parameter};
use std::borrow::Cow;
use steradian_scene::{Node, SpectrumValue, Value};

impl Compiler<'_> {
    /// The node with every constant number and spectrum inside its range.
    pub(super) fn within_ranges<'n>(&mut self, node: &'n Node) -> Cow<'n, Node> {
        let mut held = Cow::Borrowed(node);
        let parameters = catalog::entry(&node.kind).map_or(&[][..], |e| e.parameters);
        for p in parameters.iter().filter(|p| !p.refuses) {
            let Some(given) = node.param(p.name) else { continue };
            let Some((value, outside)) = hold(&given.value, p) else { continue };
            let what = format!(
                "parameter '{}' of material '{}' is {outside}; it must be {} and is held there",
                p.name,
                node.kind,
                p.range_text()
            );
            self.diagnostics.warn(&self.desc.sources, given.span.or(node.span), what);
            held.to_mut().set(p.name, value, given.span);
        }
        held
    }
}

/// The value held in the range, and what was outside of it; `None` where nothing was. Numbers that are not finite are for others to report.
fn hold(value: &Value, p: &Parameter) -> Option<(Value, f64)> {
    let (low, high) = p.range;
    let outside = |v: &f64| v.is_finite() && !(low..=high).contains(v);
    let fit = |v: f64| if v.is_finite() { v.clamp(low, high) } else { v };
    match value {
        Value::Float(v) => outside(v).then(|| (Value::Float(fit(*v)), *v)),
        Value::Int(v) => {
            let v = *v as f64;
            outside(&v).then(|| (Value::Int(fit(v) as i64), v))
        }
        Value::Spectrum(SpectrumValue::Constant(v)) => {
            outside(v).then(|| (Value::Spectrum(SpectrumValue::Constant(fit(*v))), *v))
        }
        Value::Spectrum(SpectrumValue::Rgb(rgb, space)) => {
            let bad = *rgb.iter().find(|v| outside(v))?;
            Some((Value::Spectrum(SpectrumValue::Rgb(rgb.map(fit), *space)), bad))
        }
        Value::Spectrum(SpectrumValue::Sampled { lambdas, values }) => {
            let bad = values.iter().map(|v| f64::from(*v)).find(|v| outside(v))?;
            let values = values.iter().map(|v| fit(f64::from(*v)) as f32).collect();
            Some((Value::Spectrum(SpectrumValue::Sampled { lambdas: lambdas.clone(), values }), bad))
        }
        _ => None,
    }
}
