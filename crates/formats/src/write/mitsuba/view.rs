//! Sensors with film, filter and sampler; the integrator.

use super::{Element, Writer, matrix};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Family, Node, NodeId, Value};

/// Image frame of a camera.
struct Frame {
    /// Width by height.
    aspect: f64,
    /// Half the picture's width and height, the shorter one being one.
    unit: [f64; 2],
    /// The principal point, as parts of the picture from its middle.
    principal: [f64; 2],
    /// The window on the screen: its ends along x and y.
    window: Option<[f64; 4]>,
    /// The lens's radius, zero for a pinhole.
    lens: f64,
}

/// A perspective sensor without its place.
fn perspective(node: &Node, frame: &Frame) -> Element {
    let Frame { aspect, unit, principal, window, lens } = *frame;
    let mut out = Element::plugin("sensor", if lens > 0.0 { "thinlens" } else { "perspective" });
    let fov = node.float("fov").unwrap_or(90.0);
    let axis = node.string("fov_axis").unwrap_or("smaller");
    let mut offset = principal;
    match window {
        None => {
            out.float("fov", fov);
            out.string("fov_axis", axis);
        }
        Some([x0, x1, y0, y1]) => {
            // The window is in units of the shorter half axis.
            let t = (0.5 * fov.to_radians()).tan();
            let half_x = match axis {
                "x" => t,
                "y" => t * aspect,
                "larger" => t * unit[0] / unit[0].max(unit[1]),
                "diagonal" => t * aspect / aspect.hypot(1.0),
                _ => t * unit[0],
            };
            let half = half_x / unit[0] * 0.5 * (x1 - x0);
            out.float("fov", 2.0 * half.atan().to_degrees());
            out.string("fov_axis", "x");
            offset[0] -= 0.5 * (x0 + x1) / (x1 - x0);
            offset[1] += 0.5 * (y0 + y1) / (y1 - y0);
        }
    }
    for (name, v) in [("principal_point_offset_x", -offset[0]), ("principal_point_offset_y", -offset[1])] {
        if v != 0.0 {
            out.float(name, v);
        }
    }
    if lens > 0.0 {
        out.float("aperture_radius", lens);
        out.float("focus_distance", node.float("focal_distance").unwrap_or(1e6));
    }
    out
}

impl Writer<'_> {
    fn size(&self) -> [i64; 2] {
        let film = self.x.desc.film.map(|f| self.x.node(f));
        let of = |name: &str, default: i64| film.and_then(|f| f.int(name)).unwrap_or(default);
        [of("width", 1280).max(1), of("height", 720).max(1)]
    }

    /// A sensor with everything that Mitsuba puts into it.
    pub(super) fn camera(&mut self, id: NodeId) -> Option<Element> {
        let node = self.x.node(id);
        let frame = self.frame(node);
        let mut to_world = match node.get("to_world") {
            Some(Value::Transform(t)) => *t,
            _ => Transform::IDENTITY,
        };
        let mut out = match node.kind.as_str() {
            "perspective" => perspective(node, &frame),
            "orthographic" => {
                to_world = self.orthographic(node, &frame, to_world);
                Element::plugin("sensor", "orthographic")
            }
            other => {
                self.x.dropped(node, format!("the camera '{other}' cannot be expressed and is left out"));
                return None;
            }
        };
        if let Some(name) = &node.name {
            out = out.with("id", self.x.name(Some(name), "sensor"));
        }
        let near = node.float("near").filter(|n| *n > 0.0).unwrap_or(1e-2);
        let distance = to_world.point(DVec3::ZERO).length() + self.reach;
        out.float("near_clip", near);
        // Mitsuba's default may cut what is seen here.
        out.float("far_clip", node.float("far").unwrap_or(1e4f64.max(2.0 * distance).max(2.0 * near)));
        for name in ["shutter_open", "shutter_close"] {
            if let Some(time) = node.float(name) {
                out.float(name, time);
            }
        }
        // Mitsuba's cameras have +x on the left.
        let mirrored = Transform::scale(DVec3::new(-1.0, 1.0, 1.0));
        out.push(matrix("to_world", &(to_world * mirrored)));
        if let Some(&Value::Node(medium)) = node.get("medium")
            && let Some(id) = self.medium(medium)
        {
            out.push(Element::new("ref").named("medium").with("id", id));
        }
        let (film, sampler) = (self.film(), self.sampler());
        Some(out.child(film).child(sampler))
    }

    /// Image frame of a camera.
    fn frame(&mut self, node: &Node) -> Frame {
        let [width, height] = self.size();
        let aspect = width as f64 / height as f64;
        if node.float("frame_aspect").is_some_and(|a| (a / aspect - 1.0).abs() > 1e-3) {
            self.x.approximated(node, "pixels are square in Mitsuba; 'frame_aspect' is left out");
        }
        let unit = if aspect >= 1.0 { [aspect, 1.0] } else { [1.0, 1.0 / aspect] };
        let principal = [node.float("principal_x").unwrap_or(0.0), node.float("principal_y").unwrap_or(0.0)];
        let window = match node.get("screen_window") {
            Some(Value::Floats(w)) if w.len() == 4 => Some([w[0], w[1], w[2], w[3]]),
            _ => None,
        };
        if let Some([x0, x1, y0, y1]) = window
            && ((x1 - x0) / (y1 - y0) / aspect - 1.0).abs() > 1e-3
        {
            self.x.approximated(node, "pixels are square in Mitsuba; the height of 'screen_window' is left out");
        }
        Frame { aspect, unit, principal, window, lens: node.float("lens_radius").unwrap_or(0.0) }
    }

    /// The place of an orthographic sensor, which sees the camera's window.
    fn orthographic(&mut self, node: &Node, frame: &Frame, to_world: Transform) -> Transform {
        let Frame { aspect, unit, principal, window, lens } = *frame;
        if lens > 0.0 {
            self.x.without(node, &["lens_radius"]);
        }
        let is_one = self.is_one_sided();
        let half = if is_one { [1.0, 1.0 / aspect] } else { unit };
        let [x0, x1, y0, y1] = window.unwrap_or([-half[0], half[0], -half[1], half[1]]);
        let center =
            DVec3::new(0.5 * (x0 + x1) - principal[0] * (x1 - x0), 0.5 * (y0 + y1) + principal[1] * (y1 - y0), 0.0);
        // Mitsuba sees -1…1 along x.
        let size = DVec3::new(0.5 * (x1 - x0), 0.5 * (x1 - x0), 1.0);
        to_world * Transform::translate(center) * Transform::scale(size)
    }

    fn film(&mut self) -> Element {
        let [width, height] = self.size();
        let mut out = Element::plugin("film", "hdrfilm");
        out.integer("width", width);
        out.integer("height", height);
        out.string("pixel_format", "rgb");
        if let Some(film) = self.x.desc.film.map(|f| self.x.node(f)) {
            if let Some(Value::Ints(c)) = film.get("crop")
                && let [x0, x1, y0, y1] = c[..]
            {
                for (name, v) in
                    [("crop_offset_x", x0), ("crop_offset_y", y0), ("crop_width", x1 - x0), ("crop_height", y1 - y0)]
                {
                    out.integer(name, v);
                }
            }
            if film.float("max_component").is_some_and(|v| v.is_finite() && v < f64::from(f32::MAX)) {
                self.x.without(film, &["max_component"]);
            }
            self.x.without(film, &["full_well", "sensor", "white_balance"]);
            if film.kind == "spectral" {
                self.x.dropped(film, "the bands of the film are left out");
            }
        }
        let filter = self.filter();
        out.child(filter)
    }

    fn filter(&mut self) -> Element {
        let node = match self.x.desc.filter {
            Some(id) => self.x.node(id).clone(),
            None => Node::new(Family::Filter, "box", None),
        };
        let radius = node.float("radius_x");
        let is = |value: Option<f64>, wanted: f64| value.is_none_or(|v| (v - wanted).abs() < 1e-6);
        let mut exact = is(node.float("radius_y"), radius.unwrap_or(node.float("radius_y").unwrap_or(0.0)));
        let plain = |plugin: &str| Element::plugin("rfilter", plugin);
        let out = match node.kind.as_str() {
            "box" => {
                exact &= is(radius, 0.5);
                plain("box")
            }
            "tent" => {
                let mut out = plain("tent");
                out.float("radius", radius.unwrap_or(1.0));
                out
            }
            "gaussian" => {
                let sigma = node.float("sigma").unwrap_or(0.5);
                exact &= is(radius, 4.0 * sigma);
                let mut out = plain("gaussian");
                out.float("stddev", sigma);
                out
            }
            "mitchell" => {
                exact &= is(radius, 2.0);
                let mut out = plain("mitchell");
                out.float("B", node.float("b").unwrap_or(1.0 / 3.0));
                out.float("C", node.float("c").unwrap_or(1.0 / 3.0));
                out
            }
            "catmull_rom" => {
                exact &= is(radius, 2.0);
                plain("catmullrom")
            }
            "lanczos" => {
                let tau = node.float("tau").unwrap_or(3.0);
                exact &= is(radius, tau) && tau.fract() == 0.0;
                let mut out = plain("lanczos");
                out.integer("lobes", tau.round().clamp(1.0, 16.0) as i64);
                out
            }
            _ => {
                exact = false;
                plain("gaussian")
            }
        };
        if !exact {
            self.x.approximated(
                &node,
                format!("the filter '{}' is replaced by Mitsuba's nearest; means stay", node.kind),
            );
        }
        out
    }

    fn sampler(&mut self) -> Element {
        let node = self.x.desc.sampler.map(|s| self.x.node(s));
        let plugin = match node.map_or("independent", |n| n.kind.as_str()) {
            "independent" => "independent",
            "stratified" => "stratified",
            _ => "multijitter",
        };
        let mut out = Element::plugin("sampler", plugin);
        out.integer("sample_count", node.and_then(|n| n.int("samples")).unwrap_or(16).clamp(1, 1 << 20));
        if let Some(seed) = node.and_then(|n| n.int("seed")).filter(|s| (0..1 << 31).contains(s)) {
            out.integer("seed", seed);
        }
        out
    }

    pub(super) fn integrator(&mut self) -> Element {
        let node = self.x.desc.integrator.map(|i| self.x.node(i));
        let kind = node.map_or("path", |n| n.kind.as_str());
        let direct = kind == "direct";
        let plugin = if direct {
            "direct"
        } else if self.passes || kind == "volpath" {
            "volpath"
        } else {
            "path"
        };
        if let Some(node) = node.filter(|_| kind == "ao") {
            self.x.approximated(node, "Mitsuba 3 has no ambient occlusion; 'path' stands for it");
        } else if let Some(node) = node.filter(|_| !matches!(kind, "path" | "volpath" | "direct")) {
            self.x.note(node, format!("Mitsuba's '{plugin}' stands for the integrator '{kind}'"));
        }
        let mut out = Element::plugin("integrator", plugin);
        if !direct {
            let events = node.and_then(|n| n.int("max_depth")).unwrap_or(-1);
            // Mitsuba counts the segments of a path.
            out.integer("max_depth", if events < 0 { -1 } else { events.saturating_add(1).min(1 << 30) });
            if let Some(depth) = node.and_then(|n| n.int("rr_depth")).filter(|d| *d > 0) {
                out.integer("rr_depth", depth.min(1 << 30));
            }
        }
        if let Some(true) = node.and_then(|n| n.bool("hide_emitters")) {
            out.boolean("hide_emitters", true);
        }
        out
    }
}
