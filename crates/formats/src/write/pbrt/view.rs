//! Integrator, sampler, filter, film and camera.

use super::{Directive, Writer, place};
use crate::write::frame;
use steradian_scene::{Family, Node, Value};

/// Path depth written for paths of unlimited length.
const ENDLESS: i64 = 1000;

impl Writer<'_> {
    pub(super) fn integrator(&mut self) {
        let node = self.x.desc.integrator.map(|i| self.x.node(i));
        let given = node.map_or("path", |n| n.kind.as_str());
        let usual = if self.passes { "volpath" } else { "path" };
        let kind = match given {
            "path" | "volpath" | "bdpt" | "sppm" => given,
            "light" => "lightpath",
            "mmlt" | "pssmlt" => "mlt",
            "ao" => return self.ambient_occlusion(node),
            _ => usual,
        };
        let mut out = Directive::new("Integrator", &[kind]);
        let depth = match node.and_then(|n| n.int("max_depth")) {
            _ if given == "direct" => 1,
            None if node.is_some() && self.x.desc.format == steradian_scene::Format::Pbrt => 5,
            Some(depth) if depth >= 0 => depth.min(1 << 20),
            _ => ENDLESS,
        };
        out.integers("maxdepth", [depth]);
        if let Some(node) = node {
            if kind == usual && !matches!(given, "path" | "volpath" | "direct") {
                self.x.note(node, format!("pbrt's '{kind}' stands for the integrator '{given}'"));
            }
            if node.bool("hide_emitters").unwrap_or(false) {
                self.x.dropped(node, "'hide_emitters' is left out: pbrt's camera sees its lights");
            }
            if let Some(n) = node.int("photons").filter(|n| *n > 0 && kind == "sppm") {
                out.integers("photonsperiteration", [n]);
            }
            if let Some(r) = node.float("radius").filter(|_| kind == "sppm") {
                out.float("radius", r);
            }
            if kind == "mlt" {
                // pbrt's chains do not count the samples of the sampler.
                out.integers("mutationsperpixel", [node.int("samples").unwrap_or(self.samples())]);
                if let Some(p) = node.float("large_step") {
                    out.float("largestepprobability", p);
                }
            }
        }
        self.put(&out);
    }

    fn ambient_occlusion(&mut self, node: Option<&Node>) {
        let mut out = Directive::new("Integrator", &["ambientocclusion"]);
        if let Some(distance) = node.and_then(|n| n.float("distance")) {
            out.float("maxdistance", distance);
        }
        self.put(&out);
    }

    /// Samples per pixel of the sampler.
    fn samples(&self) -> i64 {
        let node = self.x.desc.sampler.map(|s| self.x.node(s));
        node.and_then(|n| n.int("samples")).unwrap_or(16).clamp(1, 1 << 30)
    }

    pub(super) fn sampler(&mut self) {
        let node = self.x.desc.sampler.map(|s| self.x.node(s));
        let samples = self.samples();
        let kind = match node.map_or("zsobol", |n| n.kind.as_str()) {
            known @ ("sobol" | "halton" | "independent" | "stratified") => known,
            "pmj02" => "pmj02bn",
            _ => "zsobol",
        };
        let mut out = Directive::new("Sampler", &[kind]);
        if kind == "stratified" {
            let x = (samples as f64).sqrt().floor().max(1.0) as i64;
            let x = (1..=x).rev().find(|x| samples % x == 0).unwrap_or(1);
            out.integers("xsamples", [x]);
            out.integers("ysamples", [samples / x]);
        } else {
            out.integers("pixelsamples", [samples]);
        }
        if let Some(seed) = node.and_then(|n| n.int("seed")).filter(|s| (1..1 << 31).contains(s)) {
            out.integers("seed", [seed]);
        }
        self.put(&out);
    }

    pub(super) fn filter(&mut self) {
        let node = match self.x.desc.filter {
            Some(id) => self.x.node(id).clone(),
            None => Node::new(Family::Filter, "box", None),
        };
        let (kind, radius) = match node.kind.as_str() {
            "tent" => ("triangle", 1.0),
            "gaussian" => ("gaussian", 1.5),
            "mitchell" | "catmull_rom" => ("mitchell", 2.0),
            "lanczos" => ("sinc", 3.0),
            "blackman_harris" => {
                self.x
                    .approximated(&node, "pbrt has no filter 'blackman_harris'; 'gaussian' stands for it, means stay");
                ("gaussian", 1.5)
            }
            _ => ("box", 0.5),
        };
        let mut out = Directive::new("PixelFilter", &[kind]);
        out.float("xradius", node.float("radius_x").unwrap_or(radius));
        out.float("yradius", node.float("radius_y").unwrap_or(radius));
        match node.kind.as_str() {
            "gaussian" => out.float("sigma", node.float("sigma").unwrap_or(0.5)),
            "mitchell" => {
                out.float("B", node.float("b").unwrap_or(1.0 / 3.0));
                out.float("C", node.float("c").unwrap_or(1.0 / 3.0));
            }
            "catmull_rom" => {
                out.float("B", 0.0);
                out.float("C", 0.5);
            }
            "lanczos" => out.float("tau", node.float("tau").unwrap_or(3.0)),
            _ => {}
        }
        self.put(&out);
    }

    pub(super) fn film(&mut self) {
        let [width, height] = frame::size(self.x.desc);
        let film = self.x.desc.film.map(|f| self.x.node(f));
        let has_bands = film.is_some_and(|film| film.kind == "spectral" && film.get("bands").is_none());
        let mut out = Directive::new("Film", &[if has_bands { "spectral" } else { "rgb" }]);
        out.integers("xresolution", [width]);
        out.integers("yresolution", [height]);
        out.string("filename", &format!("{}.exr", self.x.beside.stem.clone()));
        if let Some(film) = film {
            if let Some(Value::Ints(crop)) = film.get("crop") {
                out.integers("pixelbounds", crop.iter().copied());
            }
            if let Some(most) = film.float("max_component").filter(|v| v.is_finite() && *v > 0.0) {
                out.float("maxcomponentvalue", most);
            }
            if let Some(sensor) = film.string("sensor").filter(|name| *name != "cie1931") {
                out.string("sensor", sensor);
            }
            if let Some(kelvin) = film.float("white_balance").filter(|v| *v != 0.0) {
                out.float("whitebalance", kelvin);
            }
            if has_bands {
                out.integers("nbuckets", [film.int("buckets").unwrap_or(16)]);
                out.float("lambdamin", film.float("lambda_min").unwrap_or(360.0));
                out.float("lambdamax", film.float("lambda_max").unwrap_or(830.0));
            }
            self.x.without(film, &["full_well", "bands"]);
        }
        self.put(&out);
    }

    pub(super) fn camera(&mut self) {
        let desc = self.x.desc;
        let Some(&id) = desc.cameras.first() else { return };
        let node = self.x.node(id);
        for &other in &desc.cameras[1..] {
            self.x.dropped(self.x.desc.node(other), "pbrt has one camera; the others are left out");
        }
        if let Some(&Value::Node(medium)) = node.get("medium")
            && let Some(name) = self.medium(medium)
        {
            self.line(&Directive::new("MediumInterface", &["", &name]).text(0));
        }
        let Some(inverse) = place(node, "to_world").inverse() else { return };
        let end = node.get("to_world_end").and_then(|_| place(node, "to_world_end").inverse());
        self.moving_transform(&inverse, end.as_ref());
        let kind = match node.kind.as_str() {
            known @ ("perspective" | "orthographic" | "spherical") => known,
            other => {
                self.x.dropped(node, format!("the camera '{other}' cannot be expressed and is left out"));
                return;
            }
        };
        let mut out = Directive::new("Camera", &[kind]);
        if kind == "spherical" {
            out.string("mapping", node.string("mapping").unwrap_or("equalarea"));
        } else {
            let (window, aspect) = frame::window(desc, node);
            let unit = if aspect >= 1.0 { [aspect, 1.0] } else { [1.0, 1.0 / aspect] };
            let k = if kind == "perspective" {
                // The field of view is that of the shorter axis.
                let half = 0.5 * (window[1] - window[0]).abs() / unit[0];
                out.float("fov", 2.0 * half.atan().to_degrees());
                half
            } else {
                1.0
            };
            let window = window.map(|v| v / k);
            let usual = [-unit[0], unit[0], -unit[1], unit[1]];
            if window.iter().zip(usual).any(|(a, b)| (a - b).abs() > 1e-6) {
                out.floats("float", "screenwindow", window);
            }
            if node.get("frame_aspect").is_some() {
                out.float("frameaspectratio", aspect);
            }
            if let Some(lens) = node.float("lens_radius").filter(|r| *r > 0.0) {
                out.float("lensradius", lens);
                out.float("focaldistance", node.float("focal_distance").unwrap_or(1e6));
            }
        }
        self.put(&out);
    }
}
