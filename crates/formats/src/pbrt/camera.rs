//! `Camera`.

use super::{build::Build, dict::Dict, param::Type, scene::Scene, state::State};
use steradian_scene::{Family, Movement, NodeId, names};

pub(super) const KINDS: [&str; 4] = ["perspective", "orthographic", "spherical", "realistic"];

/// Shapes of a lens's stop that have names.
const STOPS: [&str; 4] = ["gaussian", "square", "pentagon", "star"];

/// Translates the camera; the transforms of `state` take the world to camera space. What is behind a lens is the film.
pub(super) fn translate(scene: &mut Scene, dict: &Dict, state: &State, film: Option<&Dict>) -> Option<NodeId> {
    let medium = state.exterior.as_ref();
    let movement = scene.movement(state);
    let given = dict.kind.as_str();
    if !KINDS.contains(&given) {
        let help = names::did_you_mean(given, KINDS);
        scene.report.error_help(dict.span, format!("unknown camera '{given}'"), help);
        return None;
    }
    let mut b = Build::new(scene, dict, Family::Camera, given);
    let [Some(to_world), Some(end)] = state.ctm.map(|ctm| ctm.inverse()) else {
        b.scene.report.error(dict.span, "the transform in force at the camera cannot be inverted");
        return None;
    };
    b.set("to_world", to_world);
    if let Some(Movement { times, .. }) = movement {
        b.set("to_world_end", end);
        b.set("motion_times", times.to_vec());
    }
    match given {
        "perspective" => {
            b.positive("fov", "fov", 90.0);
            if b.node.float("fov").is_some_and(|v| v >= 180.0) {
                b.error("fov", "parameter 'fov' must be below 180 degrees");
            }
            b.set("fov_axis", "smaller");
            lens(&mut b);
            window(&mut b);
        }
        "orthographic" => {
            lens(&mut b);
            window(&mut b);
        }
        "spherical" => {
            let mappings = [("equalarea", "equalarea"), ("equirectangular", "equirectangular")];
            b.choice("mapping", "mapping", &mappings, "equalarea");
            // pbrt reads these too, and follows none.
            for name in ["lensradius", "focaldistance", "frameaspectratio", "screenwindow"] {
                b.no_effect(name, Type::Float, "the camera sees all directions, and all distances sharply");
            }
        }
        _ => realistic(&mut b, film),
    }
    for (from, to, default) in [("shutteropen", "shutter_open", 0.0), ("shutterclose", "shutter_close", 1.0)] {
        b.float(from, to, default);
    }
    if exposure(&b) <= 0.0 {
        b.error("shutterclose", "the shutter closes before it opens");
    }
    let id = b.finish();
    if let Some(medium) = medium {
        scene.set_medium_later(id, medium.clone());
    }
    Some(id)
}

fn exposure(b: &Build) -> f64 {
    b.node.float("shutter_close").unwrap_or(1.0) - b.node.float("shutter_open").unwrap_or(0.0)
}

fn lens(b: &mut Build) {
    b.float("lensradius", "lens_radius", 0.0);
    b.positive("focaldistance", "focal_distance", 1e6);
    if b.node.float("lens_radius").is_some_and(|r| r < 0.0) {
        b.error("lensradius", "parameter 'lensradius' must not be below 0");
    }
}

/// The part of the image plane that is seen.
fn window(b: &mut Build) {
    b.positive("frameaspectratio", "frame_aspect", None);
    let Some(w) = b.dict.floats(&mut b.scene.report, "screenwindow", Type::Float) else { return };
    match *w {
        [x0, x1, y0, y1] if x0 < x1 && y0 < y1 => b.set("screen_window", w.to_vec()),
        [_, _, _, _] => b.error("screenwindow", "the screen window is empty; its order is x0 x1 y0 y1"),
        _ => b.error("screenwindow", format!("a screen window has four numbers, found {}", w.len())),
    }
}

/// A camera of lens elements.
fn realistic(b: &mut Build, film: Option<&Dict>) {
    b.required_file("lensfile", "file");
    b.positive("aperturediameter", "aperture_diameter", 1.0);
    b.positive("focusdistance", "focus_distance", 10.0);
    let named = b.dict.text(&mut b.scene.report, "aperture").map(|(name, _)| name);
    match named.and_then(|name| STOPS.into_iter().find(|s| *s == name)) {
        Some(shape) => b.set("aperture", shape),
        None => _ = b.file("aperture", "aperture_file"),
    }
    let diagonal = film.and_then(|film| film.float(&mut b.scene.report, "diagonal"));
    b.set("film_diagonal", diagonal.unwrap_or(35.0));
}
