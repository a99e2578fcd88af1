//! Spectra: `rgb`, `blackbody`, tables of samples, names of measured spectra, and files of samples.

use super::{
    dict::Dict,
    param::{Param, Type, Values},
    scene::Scene,
};
use crate::files;
use steradian_math::spectra;
use steradian_scene::{ColorSpace, Span, SpectrumValue, names};

/// Role of a spectrum, which bounds its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A reflectance or a transmittance: in [0, 1].
    Albedo,
    /// Any quantity without an upper bound.
    Unbounded,
    /// Emission.
    Illuminant,
}

/// The types a spectrum can be written with.
pub(super) const TYPES: [Type; 3] = [Type::Rgb, Type::Spectrum, Type::Blackbody];

/// pbrt's names for the responses of cameras; there are three spectra `NAME_r`, `NAME_g`, `NAME_b`, which only films
/// use.
fn is_known(name: &str) -> bool {
    spectra::named::names().any(|n| n == name)
}

/// The spectrum of that parameter with its place; `None` when absent or at fault.
pub(super) fn find(scene: &mut Scene, dict: &Dict, name: &'static str, role: Role) -> Option<(SpectrumValue, Span)> {
    let p = dict.find(&mut scene.report, name, &TYPES)?;
    Some((value(scene, p, role)?, p.value_span))
}

/// The spectrum that a parameter holds; faults are reported.
fn value(scene: &mut Scene, p: &Param, role: Role) -> Option<SpectrumValue> {
    match (&p.values, p.ty) {
        (Values::Floats(v), Type::Rgb) => match v[..] {
            [r, g, b] => rgb(scene, p, [r, g, b], role),
            _ => {
                let message = format!("parameter '{}' takes 3 numbers, found {}", p.name, v.len());
                scene.report.error(p.value_span, message);
                None
            }
        },
        (Values::Floats(v), Type::Blackbody) => match v[..] {
            [kelvin] if kelvin > 0.0 => Some(SpectrumValue::Blackbody(kelvin)),
            [_] => {
                scene.report.error(p.value_span, format!("the temperature of '{}' must be above 0 K", p.name));
                None
            }
            _ => {
                let message = format!("a blackbody takes one temperature in kelvin, found {} numbers", v.len());
                scene.report.error(p.value_span, message);
                None
            }
        },
        (Values::Floats(v), _) => samples(scene, p, v),
        (Values::Texts(v), _) => match &v[..] {
            [name] => named(scene, p, name),
            _ => {
                scene.report.error(p.value_span, format!("parameter '{}' takes one spectrum", p.name));
                None
            }
        },
        _ => None,
    }
}

fn rgb(scene: &mut Scene, p: &Param, mut c: [f64; 3], role: Role) -> Option<SpectrumValue> {
    if c.iter().any(|&v| v < 0.0) {
        scene.report.error(p.value_span, format!("parameter '{}' has a component below 0", p.name));
        return None;
    }
    if role == Role::Albedo && c.iter().any(|&v| v > 1.0) {
        let message = format!("parameter '{}' reflects more than it receives; it is cut to 1", p.name);
        scene.report.warn(p.value_span, message);
        c = c.map(|v| v.min(1.0));
    }
    Some(SpectrumValue::Rgb(c, p.space))
}

/// Pairs of wavelength and value.
fn samples(scene: &mut Scene, p: &Param, v: &[f64]) -> Option<SpectrumValue> {
    if !v.len().is_multiple_of(2) {
        let message = format!("parameter '{}': a spectrum is pairs of wavelength and value, found {}", p.name, v.len());
        scene.report.error(p.value_span, message);
        return None;
    }
    let lambdas: Vec<f32> = v.iter().step_by(2).map(|&x| x as f32).collect();
    let values: Vec<f32> = v.iter().skip(1).step_by(2).map(|&x| x as f32).collect();
    if let Some(i) = lambdas.windows(2).position(|w| w[0] >= w[1]) {
        let message =
            format!("parameter '{}': wavelengths must increase, but {} follows {}", p.name, lambdas[i + 1], lambdas[i]);
        scene.report.error(p.value_span, message);
        return None;
    }
    if !lambdas.iter().chain(&values).all(|x| x.is_finite()) {
        scene.report.error(p.value_span, format!("parameter '{}' holds a number too large", p.name));
        return None;
    }
    if lambdas.len() == 1 {
        scene.report.warn(p.value_span, format!("parameter '{}' is not zero at a single wavelength only", p.name));
    }
    Some(SpectrumValue::Sampled { lambdas, values })
}

/// A spectrum known by name, or else a file.
fn named(scene: &mut Scene, p: &Param, name: &str) -> Option<SpectrumValue> {
    if is_known(name) {
        return Some(SpectrumValue::Named(name.into()));
    }
    let path = match scene.search.find(name) {
        Ok(path) => path,
        Err(fault) => {
            // A word without an extension was meant as a name.
            let (message, help) = match name.contains('.') {
                true => (fault.to_string(), None),
                false => (format!("unknown spectrum '{name}'"), names::did_you_mean(name, spectra::named::names())),
            };
            scene.report.error_help(p.value_span, message, help);
            return None;
        }
    };
    if let Some(known) = scene.spectra.get(&path) {
        return known.clone();
    }
    scene.report.sources.note(&path);
    let read = files::read(&path, &scene.options.limits).map_err(|e| e.to_string()).and_then(|bytes| {
        let curve = spectra::parse::parse_spd(&String::from_utf8_lossy(&bytes));
        curve.map_err(|e| format!("cannot read the spectrum '{}': {e}", path.display()))
    });
    let value = match read {
        Ok(curve) => Some(SpectrumValue::Sampled { lambdas: curve.lambda().to_vec(), values: curve.values().to_vec() }),
        Err(message) => {
            scene.report.error(p.value_span, message);
            None
        }
    };
    scene.spectra.insert(path, value.clone());
    value
}

/// The white of a colour space: what lights emit when the file does not say.
pub(super) fn white(space: ColorSpace) -> SpectrumValue {
    SpectrumValue::Rgb([1.0; 3], space)
}
