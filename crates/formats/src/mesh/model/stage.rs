//! Camera, film, ground and light for a model that comes without, by the user's words where there are any
//! ([`Options::defines`]).

use super::{background::Background, finish, sky, studio, upright};
use crate::{Import, Options, files::SearchPath};
use glam::DMat3;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_math::{DMat4, DVec3};
use steradian_scene::{ColorSpace, Family, Format, Mesh, Node, SceneDesc, Shape, SpectrumValue, Transform, Value};

/// Horizontal angle of view in degrees.
const FOV: f64 = 40.0;
const WIDTH: i64 = 1024;
const HEIGHT: i64 = 768;
/// Room around the model, as a factor on the distance.
const MARGIN: f64 = 1.08;
/// Default view direction: azimuth to the right of the front, and elevation above the horizon, in degrees.
const AZIMUTH: f64 = 28.810_793_742_973_065;
const ELEVATION: f64 = 19.314_867_909_262_31;
/// Places of the corners of a box that turns.
const TURNS: usize = 64;
/// Reflectance of the ground: in the studio as bright as the wall behind, elsewhere.
const GROUND_IN_STUDIO: [f64; 3] = [0.11, 0.118, 0.131];
const GROUND: [f64; 3] = [0.3; 3];
/// Radius of the ground, share of it from which on it fades, and how far it lies below the model, in diagonals of the
/// box.
const GROUND_RADIUS: f64 = 4.0;
const GROUND_CORE: f64 = 0.2;
const GROUND_GAP: f64 = 1e-3;
const GROUND_TO_HORIZON: f64 = 2000.0;
/// Diagonal of the largest model that gets a ground.
const LARGEST: f64 = 1e30;

/// Words for skies with a sun, and the lights that these are.
const SKIES: [(&str, &str); 2] = [("clear", "sky"), ("atmosphere", "atmosphere")];
/// Factor on their light, so that by default the ground is as bright under them as under that picture.
const SUN_SCALE: f64 = 2.85;

/// Share of the light of lamps that surfaces get from all sides, where there are lamps and no sky.
const DIM: f64 = 0.06;

/// Surroundings of a model.
#[derive(Clone, Debug)]
enum Sky {
    /// None: lamps alone give light.
    None,
    /// A picture of a formula, by its name.
    Formula(&'static str, fn(DVec3) -> [f64; 3]),
    /// A plain sky with a sun, as a picture.
    Outdoor,
    /// A picture.
    Picture(PathBuf),
    /// A kind of light, with the height of its sun in degrees.
    Sun(&'static str, f64),
}

impl Sky {
    /// The sky of a name, or of a file that the user names.
    fn of(word: &str, options: &Options, sun: f64) -> Result<Self, String> {
        if let Some((_, kind)) = SKIES.iter().find(|(name, _)| *name == word) {
            return Ok(Self::Sun(kind, sun));
        }
        if let Some((name, radiance)) = studio::FORMULAS.iter().find(|(name, _)| *name == word) {
            return Ok(Self::Formula(name, *radiance));
        }
        match word {
            "none" => Ok(Self::None),
            "outdoor" => Ok(Self::Outdoor),
            // As the user writes it, from where the program is run.
            _ => match SearchPath::new(Some(Path::new("")), options).find(word) {
                Ok(file) => Ok(Self::Picture(file)),
                Err(e) => {
                    let names = studio::FORMULAS.iter().map(|f| f.0).chain(SKIES.map(|s| s.0));
                    let names = names.collect::<Vec<_>>().join(", ");
                    Err(format!("'sky': {e}; the skies that need no file are {names}, outdoor and none"))
                }
            },
        }
    }

    /// The sky without the user's word.
    fn usual() -> Self {
        let [(name, radiance), ..] = studio::FORMULAS;
        Self::Formula(name, radiance)
    }
}

/// Azimuth of the sun from the front to the right, and its height above the horizon, in radians: as in the picture of
/// `sky=outdoor`.
fn usual_sun() -> [f64; 2] {
    let [x, y, z] = sky::SUN;
    [x.atan2(z), y.atan2(x.hypot(z))]
}

/// The direction of an axis of a name, such as `z` or `-y`.
fn axis(text: &str) -> Option<DVec3> {
    let (name, sign) = text.strip_prefix('-').map_or((text, 1.0), |name| (name, -1.0));
    let axes = [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)];
    axes.into_iter().find(|(known, _)| *known == name).map(|(_, axis)| sign * axis)
}

/// User options of a model's surroundings.
struct StageOptions {
    ground: bool,
    /// True if the user asked for it: it is there under models with light or a camera of their own, too.
    ground_is_asked_for: bool,
    /// True if only the shadow on the ground is seen.
    ground_is_shadow: bool,
    /// Azimuth of the viewer from the front to the right, and elevation above the horizon, in degrees.
    azimuth: f64,
    elevation: f64,
    /// True if the user gave an azimuth: the distance is then the one for all sides.
    is_turned: bool,
    /// Sky that the user names.
    sky: Option<Sky>,
    /// View behind the model, in place of the sky.
    background: Option<Background>,
    /// Turn of the sky from the front to the right, in degrees, and factor on its light.
    turn: f64,
    strength: f64,
    /// From the model's axes to those of the world, where +y is up and +z is the front.
    axes: DMat3,
}

impl StageOptions {
    /// Reads the options; up is `usual_up` where they do not say it.
    fn of(options: &Options, usual_up: DVec3) -> Result<Self, String> {
        let word = |name: &str| options.defines.get(name).map(String::as_str);
        let angle = |name: &str, default: f64, most: f64| match word(name) {
            None => Ok(default),
            Some(text) => text
                .parse()
                .ok()
                .filter(|v: &f64| v.abs() <= most)
                .ok_or_else(|| format!("'{name}' is an angle in degrees from -{most} to {most}, not '{text}'")),
        };
        let ground = match word("ground") {
            None => word("background") != Some("none"),
            Some("true" | "shadow") => true,
            Some("false") => false,
            Some(other) => return Err(format!("'ground' is 'true', 'false' or 'shadow', not '{other}'")),
        };
        let sun = angle("sun", usual_sun()[1].to_degrees(), 90.0)?;
        let sky = word("sky").map(|word| Sky::of(word, options, sun)).transpose()?;
        let background = word("background").map_or(Ok(None), Background::of)?;
        let strength = match word("strength") {
            None => 1.0,
            Some(text) => text.parse().ok().filter(|v| (0.0..=1e6).contains(v)).ok_or_else(|| {
                format!("'strength' is a factor on the light of the sky from 0 to 1000000, not '{text}'")
            })?,
        };
        if word("sun").is_some() && !matches!(sky, Some(Sky::Sun(..))) {
            let skies = SKIES.map(|(name, _)| format!("sky={name}")).join(" or ");
            return Err(format!("'sun' is the height of the sun of {skies}"));
        }
        let up = match word("up") {
            None => usual_up,
            Some(text) => axis(text).ok_or_else(|| {
                format!("'up' is the axis 'x', 'y' or 'z', or one of them with a minus, not '{text}'")
            })?,
        };
        let front = match word("front") {
            None if up.z == 0.0 => DVec3::Z,
            None => -up.z * DVec3::Y,
            Some(text) => axis(text).ok_or_else(|| {
                format!("'front' is the axis 'x', 'y' or 'z', or one of them with a minus, not '{text}'")
            })?,
        };
        if up.dot(front) != 0.0 {
            return Err("'front' is along the axis that is up ('up'): it is one of the other two".into());
        }
        // Rows: what becomes x, y and z.
        let turn = DMat3::from_cols(up.cross(front), up, front).transpose();
        let hand = match word("handedness") {
            None | Some("right") => DMat3::IDENTITY,
            Some("left") => DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)),
            Some(other) => return Err(format!("'handedness' is 'right' or 'left', not '{other}'")),
        };
        Ok(Self {
            ground,
            ground_is_asked_for: options.defines.contains_key("ground"),
            ground_is_shadow: word("ground") == Some("shadow"),
            azimuth: angle("azimuth", AZIMUTH, 360.0)?,
            elevation: angle("elevation", ELEVATION, 89.0)?,
            is_turned: word("azimuth").is_some(),
            sky,
            background,
            turn: angle("turn", 0.0, 360.0)?,
            strength,
            axes: hand * turn,
        })
    }
}

/// Sets up what is needed to see a model. Its +y is up and its +z the front, as most exporters have it, unless the user
/// defines `up`, `front` or `handedness=left`. A model that lies on its side so, and stands with z up, is turned.
pub(super) fn set(import: &mut Import, options: &Options, knows_up: bool) {
    let Import { desc, diagnostics } = &mut *import;
    let is_turned = !knows_up && !options.defines.contains_key("up") && upright::lies_on_its_side(&desc.meshes);
    if is_turned {
        let what = "the model lies on its side with y up, so z is taken as up (-D up=y keeps the file's axes)";
        diagnostics.note(&desc.sources, None, what);
    }
    let stage = match StageOptions::of(options, if is_turned { DVec3::Z } else { DVec3::Y }) {
        Ok(stage) => stage,
        Err(fault) => return diagnostics.error(&desc.sources, None, fault),
    };
    let mut corners = bounding_box(desc.meshes.iter().map(Arc::as_ref));
    if stage.axes != DMat3::IDENTITY {
        let axes = Transform::linear(stage.axes);
        desc.shapes.iter_mut().for_each(|s| s.world_from_object = axes * s.world_from_object);
        let [a, b] = corners.map(|c| stage.axes * c);
        corners = [a.min(b), a.max(b)];
    }
    if let Some(Err(fault)) = options.defines.get("material").map(|word| finish::apply(desc, word)) {
        return diagnostics.error(&desc.sources, None, fault);
    }
    let emits = desc.shapes.iter().any(|s| s.emission.is_some());
    add_missing(desc, &stage, corners, emits);
}

/// Adds what a scene lacks: a camera that frames the box of its shapes, a studio where it has no light of its own, and
/// a ground where it has neither, unless the user defines `ground`. A sky that the user names is always there.
/// Documents with lamps and no sky get dim light from all sides, and a note says so.
pub(crate) fn complete(import: &mut Import, options: &Options, corners: [DVec3; 2], has_lights: bool, dim: bool) {
    let Import { desc, diagnostics } = import;
    let stage = match StageOptions::of(options, DVec3::Y) {
        Ok(stage) => stage,
        Err(fault) => return diagnostics.error(&desc.sources, None, fault),
    };
    let angles = ["azimuth", "elevation"].into_iter().filter(|name| options.defines.contains_key(*name));
    for name in angles.filter(|_| !desc.cameras.is_empty()) {
        let what = format!("the document has a camera of its own, so '{name}' has no effect");
        diagnostics.unused(&desc.sources, None, what, None);
    }
    let corners = options.framing.unwrap_or(corners);
    let has_lamps = !desc.lights.is_empty();
    add_missing(desc, &stage, corners, has_lights);
    if stage.sky.is_none() && dim && has_lamps && add_dim_light(desc, &stage, corners) {
        let what =
            "the document has lamps and no sky: shadows get a little light from all sides (not with -D sky=none)";
        diagnostics.note(&desc.sources, None, what);
    }
}

fn add_missing(desc: &mut SceneDesc, stage: &StageOptions, corners: [DVec3; 2], has_lights: bool) {
    let is_lit = has_lights || !desc.lights.is_empty();
    let viewer = viewer(desc, stage);
    let has_camera = !desc.cameras.is_empty();
    if !has_camera {
        add_camera(desc, stage, corners);
    }
    if stage.ground && (stage.ground_is_asked_for || !has_camera && !is_lit) {
        add_ground(desc, stage, corners);
    }
    if let Some(sky) = stage.sky.clone().or_else(|| (!is_lit).then(Sky::usual)) {
        add_sky(desc, stage, &sky, viewer);
    }
    if let Some(background) = stage.background {
        background.add(desc);
    }
}

/// Reflectance of the ground: in the studio as bright as the wall behind it, before a background as bright as that.
fn ground_reflectance(stage: &StageOptions) -> [f64; 3] {
    let irradiance = match stage.sky.clone().unwrap_or_else(Sky::usual) {
        Sky::Formula("studio", _) if stage.background.is_none() => return GROUND_IN_STUDIO,
        Sky::Formula(_, radiance) => studio::irradiance(radiance),
        Sky::Outdoor => sky::irradiance(),
        _ => return GROUND,
    };
    stage.background.map_or(GROUND, |background| background.ground(irradiance.map(|e| e * stage.strength)))
}

/// Irradiance that the lamps of a document give its middle, of green, whatever is between.
fn lamp_light(desc: &SceneDesc, [low, high]: [DVec3; 2]) -> f64 {
    let middle = (low + high) * 0.5;
    let nearest = ((high - low).length() * 0.25).max(1e-6);
    let green = |value: Option<&Value>| match value {
        Some(Value::Spectrum(SpectrumValue::Rgb(rgb, _))) => rgb[1].max(0.3 * rgb[0]).max(0.1 * rgb[2]),
        _ => 0.0,
    };
    let one = |light: &Node| match light.kind.as_str() {
        "distant" => green(light.get("radiance")),
        kind => {
            let place = match light.get("position") {
                Some(Value::Vec3(place)) => DVec3::from_array(*place),
                _ => light.transform("to_world").map_or(middle, |t| t.point(DVec3::ZERO)),
            };
            let distance = (place - middle).length().max(nearest);
            if matches!(kind, "point" | "spot") { green(light.get("intensity")) / (distance * distance) } else { 0.0 }
        }
    };
    desc.lights.iter().map(|&light| one(desc.node(light))).sum()
}

/// Adds dim light from all sides to a document with lamps; false where that would be none.
fn add_dim_light(desc: &mut SceneDesc, stage: &StageOptions, corners: [DVec3; 2]) -> bool {
    let radiance = DIM * lamp_light(desc, corners) / std::f64::consts::PI * stage.strength;
    if !(radiance > 0.0 && radiance.is_finite()) {
        return false;
    }
    let mut sky = Node::new(Family::Light, "environment", None).with("radiance", radiance);
    sky.name = Some("sky".into());
    let sky = desc.add(sky);
    desc.lights.push(sky);
    true
}

fn add_camera(desc: &mut SceneDesc, stage: &StageOptions, corners: [DVec3; 2]) {
    let camera = Node::new(Family::Camera, "perspective", None)
        .with("fov", FOV)
        .with("fov_axis", "x")
        .with("to_world", frame(corners, stage));
    let camera = desc.add(camera);
    desc.cameras.push(camera);
    let film = desc.add(Node::new(Family::Film, "rgb", None).with("width", WIDTH).with("height", HEIGHT));
    desc.film = Some(film);
}

/// Azimuth of the viewer in degrees: that of the document's camera, where it has one and nothing moves.
fn viewer(desc: &SceneDesc, stage: &StageOptions) -> f64 {
    let camera = desc.cameras.first().filter(|_| desc.animations.is_empty()).map(|&camera| desc.node(camera));
    let forward = camera.and_then(|camera| camera.transform("to_world")).map(|place| place.vector(DVec3::Z));
    match forward.filter(|f| f.is_finite() && f.x.hypot(f.z) > 1e-3 * f.y.abs()) {
        Some(forward) => (-forward.x).atan2(-forward.z).to_degrees(),
        None => stage.azimuth,
    }
}

/// The sky, which stays where it is for the viewer, from whichever side the model is seen; a picture that the user
/// names stays where it is in the world.
fn add_sky(desc: &mut SceneDesc, stage: &StageOptions, sky: &Sky, viewer: f64) {
    let picture = |file: PathBuf, turn: f64| {
        let light = Node::new(Family::Light, "environment", None).with("file", file).with("parametrization", "latlong");
        match turn {
            0.0 => light,
            _ => light.with("to_world", Transform::linear(DMat3::from_rotation_y(turn.to_radians()))),
        }
    };
    let turn = viewer - AZIMUTH + stage.turn;
    let mut made = |name: &str, bytes: Vec<u8>, turn: f64| {
        let file = PathBuf::from(name);
        desc.embedded.insert(file.clone(), bytes.into());
        picture(file, turn)
    };
    let mut light = match sky {
        Sky::None => return,
        Sky::Picture(file) => picture(file.clone(), stage.turn),
        Sky::Formula(name, radiance) => {
            made(&format!("{name} of the viewer"), studio::pfm(radiance), viewer + stage.turn)
        }
        Sky::Outdoor => made("sky of the viewer", sky::pfm(), turn),
        Sky::Sun(kind, height) => {
            let (azimuth, height) = (turn.to_radians() + usual_sun()[0], height.to_radians());
            let sun = [azimuth.sin() * height.cos(), height.sin(), azimuth.cos() * height.cos()];
            // The sun is given in the world; the sky's own +z is up.
            let axes = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);
            Node::new(Family::Light, *kind, None)
                .with("sun_direction", Value::Vec3(sun))
                .with("to_world", Transform::linear(axes))
        }
    };
    let scale = stage.strength * if matches!(sky, Sky::Sun(..)) { SUN_SCALE } else { 1.0 };
    if scale != 1.0 {
        light.set("scale", scale, None);
    }
    light.name = Some("sky".into());
    let light = desc.add(light);
    desc.lights.push(light);
}

/// A grey disk under the model, which catches its shadow and fades into what is behind. There is none under models so
/// large that places on it could not be told in single precision.
fn add_ground(desc: &mut SceneDesc, stage: &StageOptions, [low, high]: [DVec3; 2]) {
    let diagonal = (high - low).length().max(1e-6);
    if diagonal > LARGEST {
        return;
    }
    let center = (low + high) * 0.5;
    let origin = DVec3::new(center.x, low.y - GROUND_GAP * diagonal, center.z);
    // The disk's +z is the world's +y.
    let axes = [DVec3::X, DVec3::NEG_Z, DVec3::Y].map(|axis| axis.extend(0.0));
    let to_world = Transform { matrix: DMat4::from_cols(axes[0], axes[1], axes[2], origin.extend(1.0)) };
    let mut material = desc.add(
        Node::new(Family::Material, "diffuse", None)
            .with("reflectance", SpectrumValue::Rgb(ground_reflectance(stage), ColorSpace::Srgb)),
    );
    // Skies that are black below the horizon have the ground reach there.
    let radius = if stage.background.is_none() && matches!(stage.sky, Some(Sky::Sun(..) | Sky::None)) {
        GROUND_TO_HORIZON
    } else {
        // A disk's v is 0 at its rim and 1 at its middle.
        let inward = desc.add(Node::new(Family::Texture, "gradient", None).with("type", "v"));
        let opacity = Node::new(Family::Texture, "curve", None)
            .with("input", inward)
            .with("places", vec![0.0, 1.0 - GROUND_CORE])
            .with("values", vec![0.0, 1.0])
            .with("interpolation", "smooth");
        let opacity = desc.add(opacity);
        let mask = Node::new(Family::Material, "mask", None).with("opacity", opacity).with("material", material);
        material = desc.add(mask);
        GROUND_RADIUS
    };
    let mut disk = Node::new(Family::Shape, "disk", None).with("radius", radius * diagonal);
    if stage.ground_is_shadow {
        disk.set("shadow_catcher", true, None);
    }
    disk.name = Some("ground".into());
    let disk = desc.add(disk);
    desc.shapes.push(Shape { world_from_object: to_world, material: Some(material), ..Shape::new(disk) });
}

/// Removes the ground that was added to a model, if any: pictures without a background have none.
pub fn leave_out_ground(desc: &mut SceneDesc) {
    let SceneDesc { shapes, nodes, format, .. } = desc;
    let is_added = |shape: &Shape| {
        let node = nodes.get(shape.node.0 as usize);
        node.is_some_and(|node| node.kind == "disk" && node.name.as_deref() == Some("ground"))
    };
    if matches!(format, Format::Model | Format::Gltf) && shapes.last().is_some_and(is_added) {
        shapes.pop();
    }
}

/// The least and the greatest coordinates of the vertices of faces.
fn bounding_box<'a>(meshes: impl Iterator<Item = &'a Mesh>) -> [DVec3; 2] {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for mesh in meshes {
        let used = mesh.triangles.as_flattened().iter().chain(mesh.patches.as_flattened());
        for p in used.filter_map(|&i| mesh.positions.get(i as usize)) {
            let p = DVec3::from(p.map(f64::from));
            (low, high) = (low.min(p), high.max(p));
        }
    }
    [low, high]
}

/// Length of the diagonal of the bounding box, at least the smallest positive number.
pub(super) fn diagonal<'a>(meshes: impl Iterator<Item = &'a Mesh>) -> f64 {
    let [low, high] = bounding_box(meshes);
    (high - low).length().max(f64::MIN_POSITIVE)
}

/// A camera that looks from where the viewer stands, as near as it can be with the whole box in view; with the box in
/// view from all sides, where the user names one: pictures of a turntable have one distance.
fn frame([low, high]: [DVec3; 2], stage: &StageOptions) -> Transform {
    let (center, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let half = half.max(DVec3::splat((half.max_element() * 1e-3).max(1e-6)));
    let (azimuth, elevation) = (stage.azimuth.to_radians(), stage.elevation.to_radians());
    let forward = -DVec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let tan_x = (FOV.to_radians() * 0.5).tan();
    let tan_y = tan_x * HEIGHT as f64 / WIDTH as f64;
    // In place of corners, those of a box that turns.
    let radius = DVec3::new(half.x, 0.0, half.z).length();
    let turned = |i: usize| {
        let angle = std::f64::consts::TAU * (i / 2) as f64 / TURNS as f64;
        let height = if i.is_multiple_of(2) { half.y } else { -half.y };
        DVec3::new(radius * angle.cos(), height, radius * angle.sin())
    };
    // A corner c is in view where |c·right| ≤ (distance + c·forward) tan_x, and the same along `up`.
    let corner = |i: usize| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        half * DVec3::new(sign(0), sign(1), sign(2))
    };
    let needed = |c: DVec3| (c.dot(right).abs() / tan_x).max(c.dot(up).abs() / tan_y) - c.dot(forward);
    let distance = if stage.is_turned {
        (0..2 * TURNS).map(|i| needed(turned(i))).fold(0.0, f64::max)
    } else {
        (0..8).map(|i| needed(corner(i))).fold(0.0, f64::max)
    };
    let origin = center - forward * distance * MARGIN;
    Transform { matrix: DMat4::from_cols(right.extend(0.0), up.extend(0.0), forward.extend(0.0), origin.extend(1.0)) }
}
