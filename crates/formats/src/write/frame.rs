//! Field of view of cameras, as a window on the plane at distance one or across parallel rays.

use steradian_scene::{Format, Node, SceneDesc, Value};

/// Width and height of the film.
pub(crate) fn size(desc: &SceneDesc) -> [i64; 2] {
    let film = desc.film.map(|f| desc.node(f));
    let default = if desc.format == Format::Mitsuba { [768, 576] } else { [1280, 720] };
    let of = |name: &str, default: i64| film.and_then(|f| f.int(name)).unwrap_or(default).max(1);
    [of("width", default[0]), of("height", default[1])]
}

/// The window `x0 x1 y0 y1` of a perspective or orthographic camera, and the aspect of its pixels' frame.
pub(crate) fn window(desc: &SceneDesc, node: &Node) -> ([f64; 4], f64) {
    let [w, h] = size(desc);
    let aspect = node.float("frame_aspect").filter(|a| *a > 0.0).unwrap_or(w as f64 / h as f64);
    let unit = if aspect >= 1.0 { [aspect, 1.0] } else { [1.0, 1.0 / aspect] };
    let is_perspective = node.kind == "perspective";
    let half = if is_perspective {
        let t = (0.5 * node.float("fov").unwrap_or(90.0).to_radians()).tan();
        let x = match node.string("fov_axis").unwrap_or("smaller") {
            "x" => t,
            "y" => t * aspect,
            "larger" => t * aspect.min(1.0),
            "diagonal" => t * aspect / aspect.hypot(1.0),
            _ => t * unit[0],
        };
        [x, x / aspect]
    } else if desc.format == Format::Mitsuba {
        [1.0, 1.0 / aspect]
    } else {
        unit
    };
    let mut window = [-half[0], half[0], -half[1], half[1]];
    if let Some(Value::Floats(s)) = node.get("screen_window")
        && let [x0, x1, y0, y1] = s[..]
    {
        // In units of the shorter half axis.
        let k = if is_perspective { half[0] / unit[0] } else { 1.0 };
        window = [x0, x1, y0, y1].map(|v| v * k);
    }
    let (dx, dy) = (node.float("principal_x").unwrap_or(0.0), node.float("principal_y").unwrap_or(0.0));
    let (ww, wh) = (window[1] - window[0], window[3] - window[2]);
    ([window[0] - dx * ww, window[1] - dx * ww, window[2] + dy * wh, window[3] + dy * wh], aspect)
}
