//! The sky as it is written: two lights of one group, the sun where place and time say, and messages.

use steradian_compile::{Compiled, Options, compile};
use steradian_core::light::Light;
use steradian_math::{Vec3, spectra::Wavelengths};
use steradian_scene::{ColorSpace, Family, Format, Node, SceneDesc, Severity, SpectrumValue, Value};

fn compiled(parameters: &[(&str, Value)]) -> Compiled {
    compiled_as("sky", parameters)
}

fn compiled_as(kind: &str, parameters: &[(&str, Value)]) -> Compiled {
    let mut d = SceneDesc { format: Format::Native, ..SceneDesc::default() };
    let mut node = Node::new(Family::Light, kind, None);
    for (name, value) in parameters {
        node.set(*name, value.clone(), None);
    }
    let id = d.add(node);
    d.lights.push(id);
    let camera = d.add(Node::new(Family::Camera, "perspective", None));
    d.cameras.push(camera);
    compile(&d, &Options::default())
}

/// Radiance from a direction, and the number of lights.
fn seen(parameters: &[(&str, Value)], w: [f32; 3]) -> (f32, usize) {
    seen_of("sky", parameters, w)
}

fn seen_of(kind: &str, parameters: &[(&str, Value)], w: [f32; 3]) -> (f32, usize) {
    let scene = compiled_as(kind, parameters).scene.expect("a scene");
    let lights = &scene.lights().lights;
    let radiance = lights.iter().map(|l| match l {
        Light::Environment(e) => e.radiance(Vec3::ZERO, Vec3::from(w).normalize(), &Wavelengths::RGB).to_rgb()[1],
        other => panic!("{other:?}"),
    });
    (radiance.sum(), lights.len())
}

/// The sun stands where Mitsuba 3.9.1 has it in Tokyo at these hours (whose own +x is south), and is dimmed and turned.
#[test]
fn the_sun_is_where_place_and_time_say() {
    for (hour, [south, west, up]) in
        [(9.0, [0.095_695_2, -0.614_786, 0.782_867]), (15.0, [0.051_385_4, 0.691_748, 0.720_308])]
    {
        let (hour, at) = (("hour", Value::Float(hour)), [-south, -west, up]);
        let (sun, lights) = seen(std::slice::from_ref(&hour), at);
        assert!(sun > 1e4 && lights == 2, "{sun} {lights}");
        assert!(seen(std::slice::from_ref(&hour), [south, west, up]).0 < 1.0);
        let (alone, lights) = seen(&[hour.clone(), ("sky_scale", 0.0.into())], at);
        assert!((alone / sun - 1.0).abs() < 1e-3 && lights == 1);
        let half = seen(&[hour.clone(), ("scale", 0.5.into())], at).0;
        assert!((half / sun - 0.5).abs() < 1e-6);
        let (without, lights) = seen(&[hour.clone(), ("sun_scale", 0.0.into())], at);
        assert!(without < 1.0 && without > 0.0 && lights == 1);
        let turn =
            steradian_scene::Transform::from_rows([1., 0., 0., 0., 0., 0., -1., 0., 0., 1., 0., 0., 0., 0., 0., 1.]);
        let turned = seen(&[hour, ("to_world", Value::Transform(turn))], [-south, -up, -west]).0;
        assert!((turned / sun - 1.0).abs() < 1e-3, "{turned} {sun}");
    }
    let given = [("sun_direction", Value::Vec3([0.0, 3.0, 4.0]))];
    assert!(seen(&given, [0.0, 3.0, 4.0]).0 > 1e4 && seen(&given, [3.0, 0.0, 4.0]).0 < 1.0);
}

/// Values that mean nothing are errors that say what was expected; a night is said.
#[test]
fn bad_values_are_told() {
    let messages = |parameters: &[(&str, Value)], severity| {
        let c = compiled(parameters);
        c.diagnostics.iter().filter(|d| d.severity == severity).map(|d| d.message.clone()).collect::<Vec<_>>()
    };
    let bad: &[(&str, Value, &str)] = &[
        ("turbidity", 0.5.into(), "in [1, 10]"),
        ("turbidity", 11.0.into(), "in [1, 10]"),
        ("turbidity", f64::NAN.into(), "not a finite number"),
        ("turbidity", "hazy".into(), "a number"),
        ("albedo", Value::Spectrum(SpectrumValue::Rgb([0.2, 1.5, 0.1], ColorSpace::Srgb)), "in [0, 1]"),
        ("latitude", 91.0.into(), "in [-90, 90]"),
        ("month", Value::Int(13), "in [1, 12]"),
        ("day", Value::Int(0), "in [1, 31]"),
        ("hour", (-1.0).into(), "in [0, 24]"),
        ("sun_scale", (-1.0).into(), "at least 0"),
        ("sun_aperture", 0.0.into(), "in [0.01, 89]"),
        ("sun_aperture", 90.0.into(), "in [0.01, 89]"),
        ("sun_direction", Value::Vec3([0.0; 3]), "direction of the sun is zero"),
        ("sun_rgb", "bright".into(), "exact, mitsuba"),
    ];
    for (name, value, expected) in bad {
        let said = messages(&[(name, value.clone())], Severity::Error);
        assert!(said.len() == 1 && said[0].contains(expected), "{name} {value:?}: {said:?}");
    }
    let both = [("sun_direction", Value::Vec3([0.0, 0.0, 1.0])), ("hour", 3.0.into())];
    assert_eq!(messages(&both, Severity::Error), ["'sun_direction' excludes 'hour'"]);
    let said = messages(&[("hour", 1.0.into())], Severity::Warning);
    assert!(said.iter().any(|m| m.contains("below the horizon")), "{said:?}");
}

/// Simulated air has the sun at the same place, two lights of which each can be left out, light after sunset, and the
/// colour of the ground in RGB.
#[test]
fn simulated_air() {
    let at = |parameters: &[(&str, Value)], w| seen_of("atmosphere", parameters, w);
    let (hour, toward) = (("hour", Value::Float(9.0)), [-0.095_695_2, 0.614_786, 0.782_867]);
    let (sun, lights) = at(std::slice::from_ref(&hour), toward);
    assert!(sun > 1e4 && lights == 2, "{sun} {lights}");
    let (sky, lights) = at(&[hour.clone(), ("sun_scale", 0.0.into())], toward);
    assert!(sky < 1.0 && sky > 0.0 && lights == 1, "{sky} {lights}");
    let (once, _) = at(&[hour.clone(), ("sun_scale", 0.0.into()), ("scattering", "single".into())], [0.0, 0.0, 1.0]);
    let (all, _) = at(&[hour, ("sun_scale", 0.0.into())], [0.0, 0.0, 1.0]);
    assert!(once < 0.95 * all && once > 0.3 * all, "{once} {all}");
    let evening = [("sun_direction", Value::Vec3([1.0, 0.0, -0.07]))];
    let (dusk, lights) = at(&evening, [0.0, 0.0, 1.0]);
    assert!(dusk > 0.0 && dusk < 1e-3 && lights == 1, "{dusk} {lights}");
    let green = |rgb| {
        let noon = ("sun_direction", Value::Vec3([0.0, 0.6, 0.8]));
        let ground = ("albedo", Value::Spectrum(SpectrumValue::Rgb(rgb, ColorSpace::Srgb)));
        at(&[noon, ground, ("sun_scale", 0.0.into())], [1.0, 0.0, 0.05]).0
    };
    assert!(green([0.0, 0.9, 0.0]) > 1.1 * green([0.9, 0.0, 0.9]));
}

/// As for the sky; and what air may be made of.
#[test]
fn bad_air_is_told() {
    let messages = |parameters: &[(&str, Value)], severity| {
        let c = compiled_as("atmosphere", parameters);
        c.diagnostics.iter().filter(|d| d.severity == severity).map(|d| d.message.clone()).collect::<Vec<_>>()
    };
    let bad: &[(&str, Value, &str)] = &[
        ("altitude", 60_000.0.into(), "in [0, 50000]"),
        ("pressure", (-1.0).into(), "in [0, 5000]"),
        ("ozone", f64::NAN.into(), "not a finite number"),
        ("aerosol", 6.0.into(), "in [0, 5]"),
        ("aerosol_albedo", 1.1.into(), "in [0, 1]"),
        ("aerosol_height", 0.0.into(), "in [100, 20000]"),
        ("g", 1.0.into(), "in [-0.9, 0.9]"),
        ("scattering", "twice".into(), "multiple, single"),
        ("sun_direction", Value::Vec3([0.0; 3]), "direction of the sun is zero"),
    ];
    for (name, value, expected) in bad {
        let said = messages(&[(name, value.clone())], Severity::Error);
        assert!(said.len() == 1 && said[0].contains(expected), "{name} {value:?}: {said:?}");
    }
    let both = [("sun_direction", Value::Vec3([0.0, 0.0, 1.0])), ("hour", 3.0.into())];
    assert_eq!(messages(&both, Severity::Error), ["'sun_direction' excludes 'hour'"]);
    let said = messages(&[("hour", 0.0.into())], Severity::Warning);
    assert!(said.iter().any(|m| m.contains("lower than -18°")), "{said:?}");
    assert!(messages(&[("sun_direction", Value::Vec3([1.0, 0.0, -0.2]))], Severity::Warning).is_empty());
}
