//! `Film` and `PixelFilter`.

use super::{build::Build, dict::Dict, param::Type, scene::Scene};
use steradian_scene::{ColorSpace, Family, NodeId, names};

pub(super) const FILMS: [&str; 3] = ["rgb", "gbuffer", "spectral"];
pub(super) const FILTERS: [(&str, &str); 5] =
    [("box", "box"), ("triangle", "tent"), ("gaussian", "gaussian"), ("mitchell", "mitchell"), ("sinc", "lanczos")];

/// Translates the film; `exposure` is how long the camera's shutter is open.
pub(super) fn film(scene: &mut Scene, dict: &Dict, exposure: f64) -> Option<NodeId> {
    let kind = dict.kind.as_str();
    if !FILMS.contains(&kind) {
        let help = match kind {
            "image" => Some("'image' is of pbrt-v3; pbrt-v4 calls it 'rgb'".into()),
            _ => names::did_you_mean(kind, FILMS),
        };
        scene.report.error_help(dict.span, format!("unknown film '{kind}'"), help);
        return None;
    }
    if dict.space != ColorSpace::Srgb {
        scene.report.approximated(dict.span, "the picture is made for sRGB, not for the film's colour space");
    }
    let mut b = Build::new(scene, dict, Family::Film, kind);
    b.int("xresolution", "width", 1280);
    b.int("yresolution", "height", 720);
    for (from, to) in [("xresolution", "width"), ("yresolution", "height")] {
        if b.node.int(to).is_none_or(|v| v <= 0) {
            b.error(from, format!("the film is empty: '{from}' must be above 0"));
        }
    }
    crop(&mut b);
    b.text("filename", "filename", None);
    b.positive("iso", "iso", 100.0);
    b.positive("exposuretime", "exposure_time", exposure);
    b.text("sensor", "sensor", "cie1931");
    b.float("whitebalance", "white_balance", None);
    // A camera's response is balanced for 6500 K unless the file says otherwise.
    if b.node.string("sensor") != Some("cie1931") && b.node.float("white_balance").unwrap_or(0.0) == 0.0 {
        b.set("white_balance", 6500.0);
    }
    b.positive("maxcomponentvalue", "max_component", None);
    // A camera with a lens system reads the size of the film.
    if b.scene.desc.cameras.iter().any(|c| b.scene.desc.node(*c).kind == "realistic") {
        b.dict.float(&mut b.scene.report, "diagonal");
    } else {
        b.no_effect("diagonal", Type::Float, "it is the size of the film behind a 'realistic' camera");
    }
    b.no_effect("savefp16", Type::Bool, "the precision of a picture's file is set where it is written");
    match kind {
        "gbuffer" => {
            let frames = &[("camera", "camera"), ("world", "world")];
            b.choice("coordinatesystem", "coordinatesystem", frames, "camera");
            let lost = "of the layers of a 'gbuffer' film, dzdx, dzdy and RelativeVariance are left out";
            b.scene.report.dropped(dict.span, lost);
            if b.node.string("coordinatesystem") != Some("world") {
                let what = "positions and normals of a 'gbuffer' film are in world space, not in camera space";
                b.scene.report.approximated(dict.span, what);
            }
        }
        "spectral" => {
            b.int("nbuckets", "buckets", 16);
            b.float("lambdamin", "lambda_min", 360.0);
            b.float("lambdamax", "lambda_max", 830.0);
        }
        _ => {}
    }
    Some(b.finish())
}

/// `pixelbounds` in pixels or `cropwindow` in fractions, of which the latter goes first.
fn crop(b: &mut Build) {
    let (Some(width), Some(height)) = (b.node.int("width"), b.node.int("height")) else { return };
    let mut bounds = None;
    if let Some(p) = b.dict.ints(&mut b.scene.report, "pixelbounds") {
        match *p {
            [x0, x1, y0, y1] => bounds = Some(("pixelbounds", [x0, x1, y0, y1].map(i64::from))),
            _ => b.error("pixelbounds", format!("four integers x0 x1 y0 y1 are needed, found {}", p.len())),
        }
    }
    if let Some(c) = b.dict.floats(&mut b.scene.report, "cropwindow", Type::Float) {
        match *c {
            [x0, x1, y0, y1] => {
                let pixel = |fraction: f64, size: i64| (fraction.clamp(0.0, 1.0) * size as f64).ceil() as i64;
                let (x0, x1) = (x0.min(x1), x0.max(x1));
                let (y0, y1) = (y0.min(y1), y0.max(y1));
                let crop = [pixel(x0, width), pixel(x1, width), pixel(y0, height), pixel(y1, height)];
                bounds = Some(("cropwindow", crop));
            }
            _ => b.error("cropwindow", format!("four numbers x0 x1 y0 y1 are needed, found {}", c.len())),
        }
    }
    let Some((name, [x0, x1, y0, y1])) = bounds else { return };
    let inside = [x0.max(0), x1.min(width), y0.max(0), y1.min(height)];
    if inside[0] >= inside[1] || inside[2] >= inside[3] {
        return b.error(name, format!("'{name}' leaves no pixel of the {width}×{height} film"));
    }
    if inside != [x0, x1, y0, y1] {
        let span = b.dict.span_of(name);
        b.scene.report.warn(span, format!("'{name}' reaches beyond the {width}×{height} film and is cut to it"));
    }
    b.set("crop", inside.to_vec());
}

/// Translates the reconstruction filter.
pub(super) fn filter(scene: &mut Scene, dict: &Dict) -> Option<NodeId> {
    let given = dict.kind.as_str();
    let Some(&(_, kind)) = FILTERS.iter().find(|(theirs, _)| *theirs == given) else {
        let help = names::did_you_mean(given, FILTERS.iter().map(|f| f.0));
        scene.report.error_help(dict.span, format!("unknown pixel filter '{given}'"), help);
        return None;
    };
    let mut b = Build::new(scene, dict, Family::Filter, kind);
    let radius = match kind {
        "box" => 0.5,
        "gaussian" => 1.5,
        "lanczos" => 4.0,
        _ => 2.0,
    };
    b.positive("xradius", "radius_x", radius);
    b.positive("yradius", "radius_y", radius);
    match kind {
        "gaussian" => b.positive("sigma", "sigma", 0.5),
        "mitchell" => {
            b.float("B", "b", 1.0 / 3.0);
            b.float("C", "c", 1.0 / 3.0);
        }
        "lanczos" => b.positive("tau", "tau", 3.0),
        _ => {}
    }
    Some(b.finish())
}
