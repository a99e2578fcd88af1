//! State of the view for pages.

use crate::{
    denoiser::{self, Library},
    document::Document,
    frame::LAYERS,
    look::{Look, StartExposure, quality},
    names::labels,
    protocol::{
        AboutScene, COLORS, CameraState, Choices, Denoiser, Exposure, Message, Named, ServerMessage, Settings,
        Severity, Size, State, ToneChoice, ToneParameter, text_of,
    },
    surroundings,
};
use std::{
    path::Path,
    sync::{Arc, LazyLock},
};
use steradian::{
    Layer, Scene, Viewpoint,
    image::tone::CURVES,
    load::suited_tone,
    math::{DVec3, Ray, Transform},
    registry,
    scene::{self, Family, Format, Node, Value},
};

/// Messages that pages are told, at most.
const MOST_MESSAGES: usize = 50;
/// A camera whose sides are this level is taken to stand upright: the sine of its roll.
const LEVEL: f64 = 1e-3;

/// The state as JSON.
pub fn of(generation: u32, document: &Document, look: &Look, scene: &Scene, library: &Library) -> Arc<str> {
    let film = scene.film();
    let [undo, redo] = document.edits();
    let asked = &look.settings;
    let settings = Settings {
        integrator: asked.integrator.clone().unwrap_or_default(),
        spp: asked.spp.flatten().unwrap_or(scene.settings().spp),
        sampler: asked.sampler.clone().flatten(),
        color: asked.color.clone().unwrap_or_else(|| COLORS[0].into()),
        seed: asked.seed.flatten(),
        max_depth: asked.max_depth.flatten(),
        denoise: look.denoiser(),
        light_groups: asked.light_groups.unwrap_or(false),
    };
    let state = State {
        generation,
        scene: about(document, look, scene),
        film: Size { width: film.width, height: film.height },
        region: look.region,
        camera: camera(document, look, scene),
        settings,
        choices: &CHOICES,
        surroundings: surroundings::of(document),
        layers: look.layers.iter().map(|l| l.name().to_owned()).collect(),
        tone: tone(document, look),
        exposure: match look.exposure {
            Some(StartExposure::Auto) => Exposure::Auto,
            None if matches!(document.desc.format, Format::Model | Format::Gltf) => Exposure::Needed,
            _ => Exposure::Given,
        },
        paused: look.paused,
        undo,
        redo,
        command: command(document, look, library.as_deref().ok()),
        save_name: saved_name(document),
    };
    ServerMessage::State(Box::new(state)).text().into()
}

/// Tone curve to begin with, with its exposure.
fn tone(document: &Document, look: &Look) -> String {
    let name = look.tone.as_deref().unwrap_or_else(|| suited_tone(document.desc.format));
    with_exposure(name, look.exposure)
}

/// Text of a tone curve with its exposure, where that is a number.
pub fn with_exposure(name: &str, exposure: Option<StartExposure>) -> String {
    let Some(StartExposure::Stops(stops)) = exposure else { return name.into() };
    let separator = if name.contains(':') { ',' } else { ':' };
    format!("{name}{separator}exposure={stops}")
}

/// Message of what the integrator leaves out of the scene.
fn left_out(look: &Look, scene: &Scene) -> Option<Message> {
    let render = quality(look).render(scene).ok()?;
    let text = render.left_out(scene)?.of(render.name);
    Some(Message { severity: Severity::Warning, text })
}

fn about(document: &Document, look: &Look, scene: &Scene) -> AboutScene {
    let name = document.source.name.to_string_lossy();
    let file = document.desc.path.as_deref();
    let said = |d: &scene::Diagnostic| Message {
        severity: match d.severity {
            scene::Severity::Error => Severity::Error,
            scene::Severity::Warning => Severity::Warning,
            scene::Severity::Note => Severity::Note,
        },
        text: text_of(d),
    };
    AboutScene {
        name: file.and_then(Path::file_name).map_or(name.clone(), |f| f.to_string_lossy()).into_owned(),
        path: file.map(|f| f.to_string_lossy().into_owned()),
        faces: document.desc.face_count(),
        lights: scene.lights().lights.len(),
        materials: scene.materials().len(),
        messages: left_out(look, scene)
            .into_iter()
            .chain(document.diagnostics.iter().map(said))
            .take(MOST_MESSAGES)
            .collect(),
    }
}

/// The node of the camera that is looked through.
fn node<'d>(document: &'d Document, look: &Look) -> Option<&'d Node> {
    document.desc.camera(look.camera.as_deref()).map(|id| document.desc.node(id))
}

/// True if the camera can be put elsewhere.
pub fn is_movable(document: &Document, look: &Look) -> bool {
    node(document, look).is_some_and(|n| !matches!(n.kind.as_str(), "irradiance_meter" | "radiance_meter"))
}

/// Viewpoint of the camera.
pub fn viewpoint(document: &Document, look: &Look, scene: &Scene) -> Option<Viewpoint> {
    let camera = camera(document, look, scene);
    let point = Viewpoint { eye: camera.eye.into(), target: camera.target.into(), up: camera.up.into() };
    (camera.movable && point.is_sound()).then_some(point)
}

fn camera(document: &Document, look: &Look, scene: &Scene) -> CameraState {
    let Some(node) = node(document, look) else { return CameraState::default() };
    let place = match node.get("to_world") {
        Some(Value::Transform(place)) => *place,
        _ => Transform::IDENTITY,
    };
    let point = look.view.map(|v| v.point).or_else(|| upright(&place, scene));
    let point = point.unwrap_or(Viewpoint { eye: DVec3::ZERO, target: DVec3::Z, up: DVec3::Y });
    let number = |name: &str| match node.get(name) {
        Some(Value::Float(v)) => Some(*v),
        Some(Value::Int(v)) => Some(*v as f64),
        _ => None,
    };
    let has_focus = node.family.parameters(&node.kind).into_iter().flatten().any(|p| p.name == "focal_distance");
    let is_perspective = node.kind == "perspective";
    let fov = look.view.and_then(|v| v.fov).or_else(|| number("fov")).unwrap_or(90.0);
    let ids = labels(&document.desc);
    let own = document.desc.camera(look.camera.as_deref()).map(|id| ids[id.0 as usize].clone());
    CameraState {
        name: own.clone(),
        names: document.desc.cameras.iter().map(|id| ids[id.0 as usize].clone()).collect(),
        kind: node.kind.clone(),
        eye: point.eye.to_array(),
        target: point.target.to_array(),
        up: point.up.to_array(),
        fov: is_perspective.then_some(fov),
        handedness: if place.swaps_handedness() { 1 } else { -1 },
        moved: look.view.is_some(),
        movable: is_movable(document, look),
        id: own.unwrap_or_default(),
        unit: place.vector(DVec3::Z).length(),
        lens: has_focus.then(|| number("lens_radius").unwrap_or(0.0).max(0.0)),
    }
}

/// The transform of an environment map that stands upright for the camera, and is not mirrored.
pub fn environment_to_world(document: &Document, look: &Look, scene: &Scene) -> Transform {
    let camera = camera(document, look, scene);
    let up = DVec3::from(camera.up).try_normalize().unwrap_or(DVec3::Y);
    let own = if document.desc.format == Format::Pbrt { DVec3::Z } else { DVec3::Y };
    // Where the two are opposite, about any axis across them.
    let axis = own.cross(up).try_normalize().unwrap_or(DVec3::X);
    let turned = Transform::rotate(axis, own.dot(up).clamp(-1.0, 1.0).acos());
    let is_mirrored = (camera.handedness > 0) == (document.desc.format == Format::Pbrt);
    if is_mirrored { turned * Transform::scale(DVec3::new(-1.0, 1.0, 1.0)) } else { turned }
}

/// Viewpoint of a camera, with what is in the middle of its picture as target, and as `up` the axis of the world that
/// its picture shows upright, if one is.
fn upright(place: &Transform, scene: &Scene) -> Option<Viewpoint> {
    let ahead = Viewpoint::of(place, 1.0)?;
    let forward = (ahead.target - ahead.eye).normalize();
    let ray = Ray::new(scene.from_file(ahead.eye), forward.as_vec3());
    let bounds = scene.bounds();
    let to_middle = (scene.to_file(bounds.center()) - ahead.eye).dot(forward);
    let across = f64::from(bounds.diagonal().length());
    let hit = scene.intersect(&ray).map(|hit| f64::from(hit.t)).filter(|t| *t > 1e-6 * across);
    let far = if to_middle > 1e-3 * across { to_middle } else { across };
    let distance = hit.or(Some(far)).filter(|d| d.is_finite() && *d > 0.0).unwrap_or(1.0);
    let side = forward.cross(ahead.up).normalize();
    let axes = [DVec3::Y, DVec3::Z, DVec3::X];
    let level = |axis: &DVec3| axis.dot(side).abs() < LEVEL && axis.dot(forward).abs() < 0.9999;
    let upwards = axes.into_iter().filter(level).max_by(|a, b| a.dot(ahead.up).abs().total_cmp(&b.dot(ahead.up).abs()));
    let up = upwards.map_or(ahead.up, |axis| axis * axis.dot(ahead.up).signum());
    Some(Viewpoint { target: ahead.eye + forward * distance, up, ..ahead })
}

/// Choices for pages, whatever the scene.
static CHOICES: LazyLock<Choices> = LazyLock::new(choices);

/// Tone curves that can be chosen.
pub fn tones() -> &'static [ToneChoice] {
    &CHOICES.tones
}

fn choices() -> Choices {
    let family = |name: &str| registry().into_iter().find(|f| f.0 == name).map(|f| f.1).unwrap_or_default();
    let named = |(name, doc): (&'static str, &'static str)| Named { name, doc };
    let tone = |curve: &steradian::image::tone::Curve| ToneChoice {
        name: curve.name,
        doc: curve.doc,
        encoding: curve.encoding,
        parameters: (curve.parameters.iter())
            .map(|p| ToneParameter { name: p.name, doc: p.doc, default: p.default, range: p.range })
            .collect(),
    };
    Choices {
        integrators: Family::Integrator.models().iter().map(|i| Named { name: i.kind, doc: i.doc }).collect(),
        samplers: family("samplers").into_iter().map(named).collect(),
        denoisers: &denoiser::CHOICES,
        colors: &COLORS,
        tones: CURVES.iter().map(tone).collect(),
        layers: LAYERS.iter().map(|l| Named { name: l.name(), doc: l.doc() }).collect(),
    }
}

/// The command that renders the same picture. Of an edited scene it is that of the file that saving makes.
fn command(document: &Document, look: &Look, library: Option<&Path>) -> String {
    let asked = &look.settings;
    let is_file =
        !document.is_edited() && look.view.is_none_or(|v| v.fov.is_none()) && document.source.reading.within.is_none();
    let name = match is_file {
        true => document.source.name.to_string_lossy().into_owned(),
        false => saved_name(document),
    };
    let mut words = vec!["steradian".into(), "render".into(), name];
    if is_file {
        let defines = document.source.reading.defines.iter();
        words.extend(defines.flat_map(|(name, value)| ["-D".into(), format!("{name}={value}")]));
    }
    let mut option = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            words.push(format!("--{name}"));
            words.extend(Some(value).filter(|v| !v.is_empty()));
        }
    };
    option("integrator", asked.integrator.clone());
    option("spp", quality(look).spp.map(|n| n.to_string()));
    option("sampler", asked.sampler.clone().flatten());
    option("seed", asked.seed.flatten().map(|n| n.to_string()));
    option("max-depth", asked.max_depth.flatten().map(|n| n.to_string()));
    option("color", asked.color.clone().filter(|c| c != COLORS[0]));
    option("size", asked.width.zip(asked.height).map(|(w, h)| format!("{w}x{h}")));
    option("crop", look.region.map(|r| r.map(|n| n.to_string()).join(",")));
    option("camera", look.camera.clone());
    let denoiser = look.denoiser();
    if let Some(denoiser) = denoiser {
        option(&format!("denoise={}", denoiser.name()), Some(String::new()));
    }
    option("oidn", library.filter(|_| denoiser == Some(Denoiser::Oidn)).map(|path| path.to_string_lossy().into()));
    option("aov", asked.light_groups.filter(|on| *on).map(|_| Layer::LIGHT_GROUPS.name().into()));
    if is_file && let Some(view) = look.view {
        let Viewpoint { eye, target, up } = view.point;
        let numbers = [eye, target, up].map(|v| v.to_array().map(|n| n.to_string()).join(","));
        option("look-at", Some(numbers.join(",")));
    }
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// File name of an edited scene when it is saved.
pub fn saved_name(document: &Document) -> String {
    let name = document.source.name.to_string_lossy();
    let stem = match name.strip_prefix("builtin:") {
        Some(builtin) => builtin.into(),
        None => document.source.name.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    format!("{}-edited.steradian", if stem.is_empty() { "scene" } else { &stem })
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./:,=+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_as_shells_take_them() {
        for (word, shell) in [
            ("a.pbrt", "a.pbrt"),
            ("my scene.xml", "'my scene.xml'"),
            ("it's", r"'it'\''s'"),
            ("$(x)", "'$(x)'"),
            ("", "''"),
        ] {
            assert_eq!(quoted(word), shell);
        }
    }
}
