//! Constant values of materials and skies are held in the ranges that the schema states, and reported where they were
//! not.

use super::Compiler;
use std::borrow::Cow;
use steradian_math::spectra;
use steradian_scene::{Node, Param, SpectrumValue, Value};

impl Compiler<'_> {
    /// The node with every constant number and spectrum inside its range, without what is refused. What is not finite
    /// stands there as a number, to be reported as such.
    pub(super) fn within_ranges<'n>(&mut self, node: &'n Node) -> Cow<'n, Node> {
        let mut held = Cow::Borrowed(node);
        let Some(model) = self.model_of(node) else { return Cow::Borrowed(node) };
        for p in model.all() {
            let Some(given) = node.param(p.name).and_then(|given| self.constant_of(given)) else { continue };
            let numbers = numbers(&given.value);
            let (low, high) = p.range;
            let Some(bad) = numbers.iter().copied().find(|v| !(low..=high).contains(v)) else { continue };
            let said = |v: f64| {
                let noun = node.family.noun();
                format!("parameter '{}' of {noun} '{}' is {v}; it must be {}", p.name, node.kind, p.range_text())
            };
            let span = given.span.or(node.span);
            let refused = |v: &&f64| !(low..=high).contains(*v) && p.outside.refuses(**v);
            if let Some(infinite) = numbers.iter().find(|v| !v.is_finite()) {
                held.to_mut().set(p.name, Value::Float(*infinite), given.span);
            } else if let Some(refused) = numbers.iter().find(refused) {
                self.error(span, said(*refused));
                held.to_mut().params.retain(|given| given.name != p.name);
            } else {
                self.diagnostics.warn(&self.desc.sources, span, format!("{} and is held there", said(bad)));
                held.to_mut().set(p.name, mapped(&given.value, |v| v.clamp(low, high)), given.span);
            }
        }
        held
    }

    /// The parameter itself, or the value of the texture it names, where that is the same everywhere.
    fn constant_of<'p>(&self, mut given: &'p Param) -> Option<&'p Param>
    where
        Self: 'p,
    {
        for _ in 0..=self.desc.nodes.len() {
            let Value::Node(id) = given.value else { return Some(given) };
            let texture = self.node(id);
            if texture.kind != "constant" {
                return None;
            }
            given = texture.param("value")?;
        }
        None
    }
}

/// The numbers that a constant value is made of.
fn numbers(value: &Value) -> Vec<f64> {
    let wide = |values: &[f32]| values.iter().map(|v| f64::from(*v)).collect();
    match value {
        Value::Float(v) | Value::Spectrum(SpectrumValue::Constant(v)) => vec![*v],
        Value::Int(v) => vec![*v as f64],
        Value::Vec3(v) => v.to_vec(),
        Value::Spectrum(SpectrumValue::Rgb(rgb, _)) => rgb.to_vec(),
        Value::Spectrum(SpectrumValue::Sampled { values, .. }) => wide(values),
        Value::Spectrum(SpectrumValue::Named(word)) => spectra::named(word).map_or_else(Vec::new, |c| wide(c.values())),
        _ => Vec::new(),
    }
}

/// The value with a function of each of its numbers in their place.
fn mapped(value: &Value, f: impl Fn(f64) -> f64) -> Value {
    let narrow = |values: &[f32]| values.iter().map(|v| f(f64::from(*v)) as f32).collect::<Vec<_>>();
    match value {
        Value::Float(v) => Value::Float(f(*v)),
        Value::Int(v) => Value::Int(f(*v as f64) as i64),
        Value::Vec3(v) => Value::Vec3(v.map(f)),
        Value::Spectrum(s) => Value::Spectrum(match s {
            SpectrumValue::Constant(v) => SpectrumValue::Constant(f(*v)),
            SpectrumValue::Rgb(rgb, space) => SpectrumValue::Rgb(rgb.map(&f), *space),
            SpectrumValue::Sampled { lambdas, values } => {
                SpectrumValue::Sampled { lambdas: lambdas.clone(), values: narrow(values) }
            }
            SpectrumValue::Named(word) => match spectra::named(word) {
                Some(c) => SpectrumValue::Sampled { lambdas: c.lambda().into(), values: narrow(c.values()) },
                None => s.clone(),
            },
            SpectrumValue::Blackbody(_) => s.clone(),
        }),
        _ => value.clone(),
    }
}
