//! Every parameter of every kind of material, set to what it should not be: a value outside of its range is told of
//! with its place, and whatever is made of it scatters finite light.

use super::prepare;
use steradian_bsdf::TransportMode;
use steradian_compile::{Options, compile};
use steradian_core::{Scene, material::scattering};
use steradian_math::{
    Vec2, Vec3,
    hash::HashRng,
    spectra::ColorMode,
    warp::{cosine_hemisphere, uniform_sphere},
};
use steradian_scene::{
    ColorSpace, Diagnostic, Family, Format, Node, NodeId, SceneDesc, Shape, Span, SpectrumValue, Value,
};
use steradian_schema::{Model, Parameter, Type, material::MATERIALS};
use steradian_texture::TextureContext;

const NUMBERS: [f64; 16] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e300,
    1e39,
    3e38,
    1e30,
    -1e30,
    1e9,
    7.0,
    -1.0,
    -1e-3,
    0.0,
    1e-30,
    1e-45,
    0.999_999_9,
];
const INTEGERS: [i64; 6] = [i64::MIN, -1, 0, 1, 1 << 31, i64::MAX];
/// Ways to write a number where a spectrum or a texture may stand.
const FORMS: usize = 5;

/// A value, and the numbers in it.
type Written = (Value, Vec<f64>);

fn written(d: &mut SceneDesc, v: f64, form: usize, span: Span) -> Written {
    let value = match form % FORMS {
        0 => Value::Float(v),
        1 => Value::Spectrum(SpectrumValue::Constant(v)),
        2 => {
            let rgb = SpectrumValue::Rgb([v, 0.5, 0.5], ColorSpace::Srgb);
            return (Value::Spectrum(rgb), vec![v, 0.5]);
        }
        3 => {
            let (lambdas, values) = (vec![400.0, 700.0], vec![0.5, v as f32]);
            return (Value::Spectrum(SpectrumValue::Sampled { lambdas, values }), vec![f64::from(v as f32), 0.5]);
        }
        _ => {
            let mut texture = Node::new(Family::Texture, "constant", Some(span));
            texture.set("value", v, Some(span));
            Value::Node(d.add(texture))
        }
    };
    (value, vec![v])
}

/// Number of values that a parameter is tried with, and each of them by its index.
fn trials(kind: Type) -> usize {
    match kind {
        Type::Number | Type::Vector => NUMBERS.len(),
        Type::Texture | Type::Scalar | Type::Spectrum => 2 * NUMBERS.len(),
        Type::List => 3 * NUMBERS.len(),
        Type::Integer => INTEGERS.len(),
        _ => 0,
    }
}

fn trial(d: &mut SceneDesc, kind: Type, i: usize, turn: usize, span: Span) -> Written {
    let v = NUMBERS[i % NUMBERS.len()];
    match kind {
        Type::Number => (Value::Float(v), vec![v]),
        Type::Vector => (Value::Vec3([v, 0.5, 0.5]), vec![v, 0.5]),
        Type::List => (Value::Floats(vec![v; [2, 3, 6][i / NUMBERS.len()]]), vec![]),
        Type::Integer => (Value::Int(INTEGERS[i]), vec![INTEGERS[i] as f64]),
        // As it is, and in another form, of which not every spectrum has the last.
        _ if i < NUMBERS.len() => written(d, v, 0, span),
        _ => written(d, v, 1 + turn % if kind != Type::Spectrum { FORMS - 1 } else { FORMS - 2 }, span),
    }
}

/// A sphere of a material with one parameter given, and the words of the sources that it stands at.
fn description(
    e: &Model,
    p: &Parameter,
    format: Format,
    value: impl FnOnce(&mut SceneDesc, Span) -> Value,
) -> SceneDesc {
    let mut d = SceneDesc { format, ..SceneDesc::default() };
    let file = d.sources.add("scene", *b"material parameter");
    let (place, own) = (Span::new(file, 0, 8), Span::new(file, 9, 18));
    let mut node = Node::new(Family::Material, e.kind, Some(place));
    let inner = d.add(Node::new(Family::Material, "diffuse", None));
    d.add(Node::new(Family::Material, "conductor", None).with("alpha_u", 0.3));
    prepare(&mut node, e, [inner, NodeId(1)], Some(p));
    let value = value(&mut d, own);
    node.set(p.name, value, Some(own));
    let material = d.add(node);
    let sphere = d.add(Node::new(Family::Shape, "sphere", None));
    d.shapes.push(Shape { material: Some(material), ..Shape::new(sphere) });
    let camera = d.add(Node::new(Family::Camera, "perspective", None));
    d.cameras.push(camera);
    d
}

/// True if a message tells of the parameter, with its position.
fn tells(d: &Diagnostic, p: &Parameter, numbers: &[f64]) -> bool {
    let named = [p.name, "'value'"].iter().any(|n| d.message.contains(n))
        || numbers.iter().any(|v| d.message.contains(&(*v as f32).to_string()));
    named && d.location.as_ref().is_some_and(|l| l.line == 1 && l.path == "scene")
}

/// Checks that all light scattered by the sphere's material is finite.
fn is_finite(scene: &Scene) -> Result<(), String> {
    let id = scene.geometries().first().map_or(0, |g| g.material);
    let mut rng = HashRng::new(7);
    for i in 0..8 {
        let at = TextureContext::new(Vec3::ZERO, Vec2::new(rng.next_f32(), rng.next_f32()));
        let mut lambda = scene.mode().wavelengths(|| rng.next_f32());
        let Some(s) = scattering(scene.materials(), scene.textures(), id, &at, i % 2 == 0, rng.next_f32(), &mut lambda)
        else {
            return Ok(());
        };
        let mut pair = || Vec2::new(rng.next_f32(), rng.next_f32());
        let (wo, wi, u) = (cosine_hemisphere(pair()), uniform_sphere(pair()), pair());
        let wo = if s.bsdf.has_transmission() && i % 2 == 1 { -wo } else { wo };
        for mode in [TransportMode::Radiance, TransportMode::Importance] {
            let value = s.bsdf.eval(wo, wi, mode);
            if !value.value.is_finite()
                || !value.pdf.is_finite()
                || value.value.to_array().into_iter().fold(0.0, f32::min) < 0.0
            {
                return Err(format!("{value:?} of {:?}", s.bsdf));
            }
            let sample = s.bsdf.sample(wo, u.x, u, mode);
            if let Some(sample) = sample.filter(|s| !(s.weight.is_finite() && s.pdf > 0.0 && s.wi.is_finite())) {
                return Err(format!("{sample:?} of {:?}", s.bsdf));
            }
        }
    }
    Ok(())
}

#[test]
fn every_bad_value_is_told_of_and_none_spreads() {
    let mut turn = 0;
    let mut faults = Vec::new();
    for e in MATERIALS {
        for p in e.parameters {
            for i in 0..trials(p.kind) {
                turn += 1;
                let format = [Format::Native, Format::Pbrt, Format::Mitsuba][turn % 3];
                let mode = [ColorMode::Rgb, ColorMode::Spectral][turn / 3 % 2];
                let (mut numbers, mut value_text) = (Vec::new(), String::new());
                let d = description(e, p, format, |d, span| {
                    let (value, inside) = trial(d, p.kind, i, turn, span);
                    (numbers, value_text) = (inside, format!("{value:?}, {mode:?}, {format:?}"));
                    value
                });
                let compiled = compile(&d, &Options { mode: Some(mode), ..Options::default() });
                let legal = numbers.iter().all(|v| (p.range.0..=p.range.1).contains(v) && v.is_finite());
                let mut fault = |what: String| faults.push(format!("{}: {} = {value_text}: {what}", e.kind, p.name));
                if !legal && !compiled.diagnostics.iter().any(|d| tells(d, p, &numbers)) {
                    let said: Vec<_> = compiled.diagnostics.iter().map(|d| &d.message).collect();
                    fault(format!("not told of; said was {said:?}"));
                }
                match &compiled.scene {
                    Some(scene) => _ = is_finite(scene).map_err(fault),
                    None if !compiled.diagnostics.has_errors() => fault("no scene and no error".into()),
                    None => {}
                }
            }
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults[..faults.len().min(60)].join("\n"));
}

/// A number without an end to its range is one that nothing checks.
#[test]
fn every_number_has_a_range() {
    let numeric = |k: Type| k.is_numeric() || k == Type::Vector;
    for e in MATERIALS {
        for p in e.all().filter(|p| numeric(p.kind)) {
            assert!(p.range.0.is_finite() && p.range.1.is_finite(), "{}: {}", e.kind, p.name);
        }
    }
}
