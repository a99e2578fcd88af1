//! `LightSource` and `AreaLightSource`.
//!
//! pbrt scales every light so that its spectrum has a photometric integral of one: `normalize` says so. An absent
//! spectrum is the white of the colour space.

use super::{
    build::Build,
    dict::Dict,
    param::Type,
    scene::Scene,
    spectrum::{self, Role},
    state::NameRef,
};
use steradian_math::{DVec3, spectra::photometry::photometric_from_y};
use steradian_scene::{Family, NodeId, SpectrumValue, Transform, names};

pub(super) const KINDS: [&str; 6] = ["point", "spot", "distant", "infinite", "goniometric", "projection"];

/// Translates a light that stands alone; `ctm` takes its space to the world.
pub(super) fn translate(scene: &mut Scene, dict: &Dict, ctm: Transform, medium: Option<&NameRef>) -> Option<NodeId> {
    let kind = match dict.kind.as_str() {
        "infinite" => "environment",
        kind if KINDS.contains(&kind) => kind,
        unknown => {
            let help = names::did_you_mean(unknown, KINDS);
            scene.report.error_help(dict.span, format!("unknown light source '{unknown}'"), help);
            return None;
        }
    };
    let white = spectrum::white(dict.space);
    let mut b = Build::new(scene, dict, Family::Light, kind);
    match kind {
        "point" => {
            emission(&mut b, "I", "intensity", white);
            let from = b.dict.vec3(&mut b.scene.report, "from", Type::Point3).unwrap_or_default();
            b.set("position", ctm.point(DVec3::from(from)).to_array());
            target(&mut b, "power");
        }
        "spot" => spot(&mut b, ctm, white),
        "distant" => {
            emission(&mut b, "L", "radiance", white);
            if let Some((_, direction)) = from_to(&mut b) {
                b.set("direction", ctm.vector(direction).normalize_or_zero().to_array());
            }
            target(&mut b, "illuminance");
        }
        "goniometric" => {
            emission(&mut b, "I", "intensity", white);
            b.required_file("filename", "file");
            // The distribution's pole is local +y: pbrt swaps y and z before it looks a direction up.
            let swap_yz = [1., 0., 0., 0., 0., 0., 1., 0., 0., 1., 0., 0., 0., 0., 0., 1.];
            b.set("to_world", ctm * Transform::from_rows(swap_yz));
            target(&mut b, "power");
        }
        "projection" => {
            b.required_file("filename", "file");
            b.positive("fov", "fov", 90.0);
            b.set("fov_axis", "smaller");
            scale(&mut b);
            b.set("to_world", ctm);
            target(&mut b, "power");
        }
        _ => environment(&mut b, ctm, white),
    }
    let id = b.finish();
    if let Some(medium) = medium {
        scene.set_medium_later(id, medium.clone());
    }
    Some(id)
}

/// The spectrum, its scale and the normalisation.
fn emission(b: &mut Build, from: &'static str, to: &str, white: SpectrumValue) {
    b.spectrum(from, to, Role::Illuminant, white);
    scale(b);
}

fn scale(b: &mut Build) {
    b.float("scale", "scale", 1.0);
    b.set("normalize", true);
}

/// A photometric quantity to reach; not positive means none. pbrt's unit is that of a spectrum whose CIE Y is 1, which
/// is 72 983 lm or lx.
fn target(b: &mut Build, name: &'static str) {
    b.float(name, name, None);
    match b.node.float(name) {
        Some(v) if v > 0.0 => b.set(name, v * photometric_from_y(1.0)),
        Some(_) => b.node.params.retain(|p| p.name != name),
        None => {}
    }
}

/// The points `from` and `to` as an origin and a direction in light space.
fn from_to(b: &mut Build) -> Option<(DVec3, DVec3)> {
    let from = DVec3::from(b.dict.vec3(&mut b.scene.report, "from", Type::Point3).unwrap_or_default());
    let to = DVec3::from(b.dict.vec3(&mut b.scene.report, "to", Type::Point3).unwrap_or([0.0, 0.0, 1.0]));
    match (to - from).try_normalize() {
        Some(direction) => Some((from, direction)),
        None => {
            b.error("to", "'from' and 'to' are the same point");
            None
        }
    }
}

fn spot(b: &mut Build, ctm: Transform, white: SpectrumValue) {
    emission(b, "I", "intensity", white);
    let cone = b.dict.float_or(&mut b.scene.report, "coneangle", 30.0);
    let delta = b.dict.float_or(&mut b.scene.report, "conedeltaangle", 5.0);
    if cone <= 0.0 || cone > 180.0 {
        b.error("coneangle", "parameter 'coneangle' must be above 0 and at most 180 degrees");
    }
    b.set("cone_angle", cone);
    b.set("falloff_start", (cone - delta).clamp(0.0, cone.max(0.0)));
    b.set("falloff", "smoothstep");
    if let Some((origin, axis)) = from_to(b) {
        let (x, y) = axis.any_orthonormal_pair();
        let frame =
            steradian_math::DMat4::from_cols(x.extend(0.0), y.extend(0.0), axis.extend(0.0), origin.extend(1.0));
        b.set("to_world", ctm * Transform { matrix: frame });
    }
    target(b, "power");
}

fn environment(b: &mut Build, ctm: Transform, white: SpectrumValue) {
    let radiance = b.dict.has("L", &spectrum::TYPES);
    b.spectrum("L", "radiance", Role::Illuminant, None);
    let file = b.file("filename", "file");
    if radiance && file {
        b.error("filename", "an infinite light has either 'L' or 'filename', not both");
    }
    if file {
        b.set("parametrization", "auto");
    } else if !radiance {
        b.set("radiance", white);
    }
    scale(b);
    b.set("to_world", ctm);
    if let Some(portal) = b.dict.floats(&mut b.scene.report, "portal", Type::Point3) {
        match portal.len() {
            12 => b.set("portal", portal.to_vec()),
            n => b.error("portal", format!("a portal has four corners, found {}", n / 3)),
        }
    }
    target(b, "illuminance");
}

/// Translates the light that shapes emit.
pub(super) fn area(scene: &mut Scene, dict: &Dict) -> Option<NodeId> {
    if dict.kind != "diffuse" {
        let help = names::did_you_mean(&dict.kind, ["diffuse"]);
        scene.report.error_help(dict.span, format!("unknown area light source '{}'", dict.kind), help);
        return None;
    }
    let mut b = Build::new(scene, dict, Family::Light, "area");
    let radiance = b.dict.has("L", &spectrum::TYPES);
    b.spectrum("L", "radiance", Role::Illuminant, None);
    let file = b.file("filename", "file");
    if radiance && file {
        b.error("filename", "an area light has either 'L' or 'filename', not both");
    }
    if !radiance {
        b.set("radiance", spectrum::white(dict.space));
    }
    scale(&mut b);
    b.bool("twosided", "two_sided", false);
    target(&mut b, "power");
    Some(b.finish())
}
