//! Sensors with their films, reconstruction filters and samplers.

use super::{
    graph::{Category, ObjectId, Prop, Raw},
    reader::Reader,
    texture::Role,
    told::NOISE,
    values,
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Family, Node, Value};

/// Mitsuba's cameras have local +x on the left of the picture, Steradian's on the right.
pub(super) fn mirrored_x() -> Transform {
    Transform::scale(DVec3::new(-1.0, 1.0, 1.0))
}

impl Reader<'_> {
    /// Adds a sensor. The first also gives the scene its film, filter and sampler.
    pub fn sensor(&mut self, object: ObjectId) {
        self.graph.objects[object].visited = true;
        let kind = match self.plugin(object) {
            "perspective" | "thinlens" => "perspective",
            "orthographic" => "orthographic",
            "radiancemeter" => return self.radiance_meter(object),
            "irradiancemeter" => {
                return self
                    .error(self.span(object), "an 'irradiancemeter' stands in the shape whose irradiance it measures");
            }
            known if self.is_known(object) => {
                let message = format!("there is no sensor '{known}'");
                let help = Some(
                    "sensors are 'perspective', 'thinlens', 'orthographic', 'radiancemeter' and 'irradiancemeter'"
                        .to_owned(),
                );
                let span = self.span(object);
                self.graph.objects[object].visited = false;
                return self.diagnostics.error_help(&self.desc.sources, Some(span), message, help);
            }
            _ => return self.unknown_plugin(object),
        };
        let mut node = self.node(Family::Camera, kind, object);
        if kind == "perspective" {
            self.perspective(&mut node, object);
        }
        self.clipping(&mut node, object);
        let to_world = self.transform(object, "to_world") * mirrored_x();
        node.set("to_world", to_world, Some(self.value_span(object, "to_world")));
        self.exposed(node, object);
    }

    /// Adds a sensor that knows its place, with its shutter and medium.
    pub(super) fn exposed(&mut self, mut node: Node, object: ObjectId) {
        for name in ["shutter_open", "shutter_close"] {
            if let Some(time) = self.float(object, name) {
                node.set(name, time, Some(self.value_span(object, name)));
            }
        }
        if let Some(&(_, medium)) = self.graph.children(object, Category::Medium).first()
            && let Some(medium) = self.medium(medium)
        {
            node.set("medium", medium, None);
        }
        if self.graph.has(object, "srf") {
            let span = self.value_span(object, "srf");
            self.ignore(object, &["srf"]);
            self.dropped(span, "the sensor's response 'srf' is left out");
        }
        let camera = self.desc.add(node);
        self.desc.cameras.push(camera);
        self.recording(object);
    }

    /// The film and sampler of the first sensor are those of the scene.
    fn recording(&mut self, object: ObjectId) {
        let films = self.graph.children(object, Category::Film);
        let samplers = self.graph.children(object, Category::Sampler);
        if self.desc.cameras.len() > 1 {
            if !films.is_empty() {
                self.note(self.span(object), "all sensors share the film and the sampler of the first");
            }
            return;
        }
        self.film(films.first().map(|f| f.1));
        self.orthographic_window(object);
        self.sampler(samplers.first().map(|s| s.1));
    }

    /// Mitsuba's orthographic camera sees -1…1 along x, whatever the shape of the film.
    fn orthographic_window(&mut self, object: ObjectId) {
        let Some(&camera) = self.desc.cameras.last() else { return };
        let size = self.desc.film.map(|f| self.desc.node(f)).and_then(|f| f.float("width").zip(f.float("height")));
        if let (Some((width, height)), "orthographic") = (size, self.plugin(object)) {
            let y = height / width;
            self.desc.node_mut(camera).set("screen_window", vec![-1.0, 1.0, -y, y], None);
        }
    }

    /// Default film and sampler of a scene without a sensor.
    pub fn default_recording(&mut self) {
        self.film(None);
        self.sampler(None);
    }

    fn perspective(&mut self, node: &mut Node, object: ObjectId) {
        self.field_of_view(node, object);
        for (name, property) in
            [("principal_x", "principal_point_offset_x"), ("principal_y", "principal_point_offset_y")]
        {
            // Mitsuba's offsets move the window over the scene: the principal point goes the other way.
            if let Some(offset) = self.float(object, property) {
                node.set(name, -offset, Some(self.value_span(object, property)));
            }
        }
        if self.plugin(object) != "thinlens" {
            return;
        }
        let focus = self.float(object, "focus_distance");
        let (radius, span) = (self.float(object, "aperture_radius"), self.value_span(object, "aperture_radius"));
        match radius {
            Some(r) if r >= 0.0 => {
                node.set("lens_radius", r, Some(span));
            }
            Some(_) => self.error(span, "'aperture_radius' cannot be negative"),
            None => self.error(span, "the sensor 'thinlens' needs 'aperture_radius'"),
        }
        let far = self.float(object, "far_clip").unwrap_or(1e4);
        let span = self.value_span(object, "focus_distance");
        let distance = focus.unwrap_or(far);
        if distance <= 0.0 {
            return self.error(span, "'focus_distance' must be above zero");
        }
        node.set("focal_distance", distance, Some(span));
    }

    /// `fov` along `fov_axis`, or the `focal_length` of a 35 mm camera, which is an angle across the diagonal.
    pub fn field_of_view(&mut self, node: &mut Node, object: ObjectId) {
        let axis = self.choice(object, "fov_axis", &["x", "y", "diagonal", "smaller", "larger"]);
        let focal_span = self.value_span(object, "focal_length");
        let focal_length = self.graph.take(object, "focal_length").map(|p| p.value);
        let (fov, axis, span) = match self.float(object, "fov") {
            Some(fov) => {
                if focal_length.is_some() {
                    self.error(focal_span, "'fov' excludes 'focal_length'");
                }
                (fov, axis, self.value_span(object, "fov"))
            }
            None => {
                if self.graph.has(object, "fov_axis") {
                    self.no_effect(object, &["fov_axis"], "a 'focal_length' is across the diagonal");
                }
                let millimetres = match focal_length {
                    None => Ok(50.0),
                    Some(Raw::String(text)) => values::number(text.trim().trim_end_matches("mm")),
                    Some(Raw::Float(v)) => Ok(v),
                    Some(Raw::Int(v)) => Ok(v as f64),
                    Some(other) => Err(format!("a length like '50mm' is needed, not {}", other.noun())),
                };
                let millimetres = millimetres.unwrap_or_else(|e| {
                    self.error(focal_span, format!("'focal_length': {e}"));
                    50.0
                });
                // The frame of 35 mm film measures 36 × 24 mm.
                let diagonal = 36f64.hypot(24.0);
                let fov = 2.0 * (diagonal / (2.0 * millimetres)).atan().to_degrees();
                (fov, "diagonal", focal_span)
            }
        };
        if !(fov > 0.0 && fov < 180.0) {
            return self.error(span, "the field of view lies between 0 and 180 degrees");
        }
        node.set("fov", fov, Some(span)).set("fov_axis", axis, None);
    }

    fn clipping(&mut self, node: &mut Node, object: ObjectId) {
        let near = self.float(object, "near_clip").unwrap_or(1e-2);
        let far = self.float(object, "far_clip").unwrap_or(1e4);
        if !(near > 0.0 && near < far) {
            let span = self.value_span(object, "near_clip");
            return self.error(span, "the clipping distances need 0 < near_clip < far_clip");
        }
        node.set("near", near, Some(self.value_span(object, "near_clip")));
        node.set("far", far, Some(self.value_span(object, "far_clip")));
        if self.plugin(object) != "thinlens" {
            self.no_effect(object, &["focus_distance"], "without a lens all is in focus");
        }
    }

    fn film(&mut self, object: Option<ObjectId>) {
        let Some(object) = object else {
            let film = Node::new(Family::Film, "rgb", None).with("width", 768i64).with("height", 576i64);
            self.desc.film = Some(self.desc.add(film));
            return self.filter(None);
        };
        let kind = match self.plugin(object) {
            "specfilm" => "spectral",
            _ if self.is_known(object) => "rgb",
            _ => return self.unknown_plugin(object),
        };
        let mut node = self.node(Family::Film, kind, object);
        let size = [("width", 768), ("height", 576)].map(|(name, default)| {
            let value = self.int(object, name).unwrap_or(default);
            if !(1..=i64::from(u32::MAX)).contains(&value) {
                self.error(self.value_span(object, name), format!("the film's {name} must be positive"));
                return default;
            }
            node.set(name, value, Some(self.value_span(object, name)));
            value
        });
        self.crop(&mut node, object, size);
        self.developed(object);
        if kind == "spectral" {
            self.bands(&mut node, object);
        }
        let filters = self.graph.children(object, Category::Filter);
        self.desc.film = Some(self.desc.add(node));
        self.filter(filters.first().map(|f| f.1));
    }

    /// Says what comes of settings of a film that are about its file and its development.
    fn developed(&mut self, object: ObjectId) {
        let file = ["file_format", "component_format", "banner", "attach_log", "has_variance"];
        self.no_effect(object, &file, "it is about the file, not the picture");
        self.no_effect(object, &["compensate"], "sums are exact enough without");
        self.no_effect(object, &["high_quality_edges", "sample_border"], "it is about the noise along the edges");
        if let Some(format) = self.string(object, "pixel_format").filter(|f| !f.eq_ignore_ascii_case("rgb")) {
            let span = self.value_span(object, "pixel_format");
            if format.eq_ignore_ascii_case("rgba") {
                let said = "the alpha channel of 'rgba' is not written by itself; --transparent writes it";
                self.note(span, said);
            } else {
                self.dropped(span, format!("pictures have R, G and B; the 'pixel_format' '{format}' is left out"));
            }
        }
        let why = "'--exposure' and '--tonemap' develop pictures";
        self.left_out(object, "gamma", &["-1"], why);
        self.left_out(object, "exposure", &["0"], why);
        self.left_out(object, "tonemap_method", &["gamma"], why);
        self.left_out(object, "key", &["0.18"], why);
        self.left_out(object, "burn", &["0"], why);
    }

    /// The bands of a `specfilm`, which are spectra of any name, in the order of their names.
    fn bands(&mut self, node: &mut Node, object: ObjectId) {
        let span = self.span(object);
        // The filter is asked for afterwards.
        self.graph.children(object, Category::Filter);
        let is_band = |p: &&mut Prop| !p.used && matches!(p.value, Raw::Spectrum(_) | Raw::Rgb(_) | Raw::Object(_));
        let take = |p: &mut Prop| {
            p.used = true;
            p.clone()
        };
        let mut props: Vec<Prop> = self.graph.objects[object].props.iter_mut().filter(is_band).map(take).collect();
        props.sort_by(|a, b| a.name.cmp(&b.name));
        if props.is_empty() {
            return self.error(span, "a 'specfilm' needs a spectrum for each of its bands");
        }
        let mut bands = Vec::new();
        for prop in props {
            let name = prop.name.clone();
            let Some((value, at)) = self.spectral_of(object, prop, Role::Unbounded) else { continue };
            let band = Node { name: Some(name), ..Node::new(Family::Texture, "constant", Some(at)) };
            bands.push(self.desc.add(band.with("value", value)));
        }
        node.set("bands", Value::Nodes(bands), Some(span));
    }

    fn crop(&mut self, node: &mut Node, object: ObjectId, [width, height]: [i64; 2]) {
        let mut edge = |offset_name, size_name, extent: i64| {
            let offset = self.int(object, offset_name).unwrap_or(0);
            let size = self.int(object, size_name).unwrap_or(extent);
            let given = self.graph.has(object, offset_name) || self.graph.has(object, size_name);
            let end = offset.checked_add(size).filter(|&end| offset >= 0 && size > 0 && end <= extent);
            if end.is_none() {
                let at = if self.graph.has(object, size_name) { size_name } else { offset_name };
                self.error(self.value_span(object, at), "the crop window does not lie within the film");
            }
            (given, offset, end.unwrap_or(extent))
        };
        let (given_x, x0, x1) = edge("crop_offset_x", "crop_width", width);
        let (given_y, y0, y1) = edge("crop_offset_y", "crop_height", height);
        if given_x || given_y {
            node.set("crop", Value::Ints(vec![x0, x1, y0, y1]), None);
        }
    }

    fn filter(&mut self, object: Option<ObjectId>) {
        let gaussian = |sigma: f64, node: Node| {
            node.with("sigma", sigma).with("radius_x", 4.0 * sigma).with("radius_y", 4.0 * sigma)
        };
        let Some(object) = object else {
            let node = gaussian(0.5, Node::new(Family::Filter, "gaussian", None));
            self.desc.filter = Some(self.desc.add(node));
            return;
        };
        let plugin = self.plugin(object).to_owned();
        self.graph.objects[object].visited = true;
        let kind = if plugin == "catmullrom" { "catmull_rom" } else { plugin.as_str() };
        let node = self.node(Family::Filter, kind, object);
        let sized = |node: Node, radius: f64| node.with("radius_x", radius).with("radius_y", radius);
        let node = match plugin.as_str() {
            "box" => sized(node, self.float(object, "radius").unwrap_or(0.5)),
            "tent" => sized(node, self.float(object, "radius").unwrap_or(1.0)),
            "gaussian" => gaussian(self.float(object, "stddev").unwrap_or(0.5), node),
            "mitchell" => {
                let b = self.float(object, "B").or_else(|| self.float(object, "b")).unwrap_or(1.0 / 3.0);
                let c = self.float(object, "C").or_else(|| self.float(object, "c")).unwrap_or(1.0 / 3.0);
                sized(node, 2.0).with("b", b).with("c", c)
            }
            "catmullrom" => sized(node, 2.0),
            "lanczos" => {
                let lobes = self.int(object, "lobes").unwrap_or(3) as f64;
                sized(node, lobes).with("tau", lobes)
            }
            _ => return self.unknown_plugin(object),
        };
        if node.float("radius_x").is_some_and(|r| !(r > 0.0 && r <= 100.0)) {
            return self.error(self.span(object), "the size of the filter must be positive and at most 100 pixels");
        }
        self.desc.filter = Some(self.desc.add(node));
    }

    fn sampler(&mut self, object: Option<ObjectId>) {
        let Some(object) = object else {
            let node = Node::new(Family::Sampler, "independent", None).with("samples", 4i64);
            self.desc.sampler = Some(self.desc.add(node));
            return;
        };
        let kind = match self.plugin(object) {
            "independent" => "independent",
            "stratified" => "stratified",
            "multijitter" | "orthogonal" => "multijitter",
            "halton" | "hammersley" => "halton",
            _ if self.is_known(object) => "sobol",
            _ => return self.unknown_plugin(object),
        };
        let mut node = self.node(Family::Sampler, kind, object);
        let samples = self.int(object, "sample_count").unwrap_or(4);
        if !(1..=i64::from(u32::MAX)).contains(&samples) {
            return self.error(self.value_span(object, "sample_count"), "'sample_count' must be positive");
        }
        node.set("samples", samples, Some(self.value_span(object, "sample_count")));
        if let Some(seed) = self.int(object, "seed") {
            node.set("seed", seed, Some(self.value_span(object, "seed")));
        }
        self.no_effect(object, &["jitter", "strength", "dimension", "scramble"], NOISE);
        self.desc.sampler = Some(self.desc.add(node));
    }
}
