//! Tone curves of the page's shader against those of the library, which the command line writes pictures with.

mod glsl;

use glsl::{Scope, Shader, Value};
use steradian::image::tone::{CURVES, Tone};

/// The page's curves.
const PAGE: &str = include_str!("../../../../web/src/tone.ts");

/// Text between a beginning and an end.
fn between<'t>(text: &'t str, begin: &str, end: &str) -> &'t str {
    let (_, rest) = text.split_once(begin).unwrap_or_else(|| panic!("'{begin}' is not there"));
    rest.split_once(end).unwrap_or_else(|| panic!("'{end}' is not there")).0
}

/// Names of the shader's curves; a curve's number there is its place here.
fn names() -> Vec<&'static str> {
    between(PAGE, "CURVES = [", "]")
        .split(',')
        .map(|name| name.trim().trim_matches('\''))
        .filter(|n| !n.is_empty())
        .collect()
}

#[test]
fn the_page_has_the_curves_of_the_library() {
    assert_eq!(names(), CURVES.iter().map(|curve| curve.name).collect::<Vec<_>>());
}

/// Every curve, with its default parameters and with others, over the range of radiance. Rounding alone differs: both
/// compute with 24 bits of which AgX's sums of both signs lose five.
#[test]
fn the_page_displays_what_the_library_writes() {
    let shader = Shader::parse(between(PAGE, "TONE_GLSL = `", "`"));
    let levels = [0.0, 1e-6, 1e-3, 0.02, 0.07, 0.18, 0.5, 0.77, 1.0, 3.0, 20.0, 1e4, 1e9];
    let maximum = 8.0;
    for (number, name) in names().into_iter().enumerate() {
        let curve = CURVES.iter().find(|curve| curve.name == name).unwrap();
        for factor in [1.0, 0.75, 1.5] {
            let values: Vec<f32> = curve.parameters.iter().map(|p| p.default * factor).collect();
            let mut tone = Tone::of(curve);
            for (parameter, value) in curve.parameters.iter().zip(&values) {
                tone.set(parameter.name, *value).unwrap();
            }
            let value = |k: usize| values.get(k).copied().unwrap_or(1.0);
            let uniforms = [
                ("curve", Value::Number(number as f32)),
                ("values", Value::Vector([value(0), value(1), 0.0])),
                ("maximum", Value::Number(maximum)),
            ];
            let uniforms: Scope = uniforms.map(|(name, value)| (name.to_owned(), value)).into();
            let map = tone.mapper(maximum);
            for k in 0..levels.len() * levels.len() {
                let (i, j) = (k % levels.len(), k / levels.len());
                let rgb = [levels[i], levels[j], levels[(i + 2 * j) % levels.len()]];
                let expected = map(rgb).map(|v| v.clamp(0.0, 1.0));
                let Value::Vector(shown) = shader.call("toneCurve", &[Value::Vector(rgb)], &uniforms) else {
                    panic!("a colour has three components")
                };
                for (a, b) in shown.iter().zip(expected) {
                    assert!((a - b).abs() < 4e-6, "{name} {values:?} of {rgb:?}: {shown:?}, not {expected:?}");
                }
            }
        }
    }
}
